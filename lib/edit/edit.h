/* The inside of a gtx_edit, for the files of this room. */
#ifndef GTX_EDIT_INSIDE_H
#define GTX_EDIT_INSIDE_H

#include <geotex/edit.h>

#include "asset/asset.h"

#include <stdbool.h>

/* Rings of texels added around those with a code, and texels by which a height field is larger on
 * each side than its rectangle: moved by half a texel it still covers every visible cell. */
enum { GTX_EDIT_MARGIN = 3 };

/* What a borrowed texel follows: a place in a cell of a neighbouring patch's height field. */
typedef struct gtx_correspondence {
    uint32_t texel;
    uint32_t patch, source;   /* the neighbour; the texel at the cell's low corner */
    float u, v;               /* 0..1 in the cell */
} gtx_correspondence;

/* A patch's height field that is being edited: its span of texels in the edit's arrays, and its
 * state as a whole. (Callers' own operations see it as gtx_edit_field.) */
typedef struct gtx_field_span {
    uint32_t width, height;
    size_t first;             /* texel of the edit; width * height from there on */
    double to_grid[3][3];     /* rows: from a move in object units to x and y in texels, and height
                                 in object units */
    size_t first_correspondence, correspondence_count;   /* sorted by texel */
    size_t first_loose, loose_count; /* nearest to the surface first */
    float low[3], high[3];    /* around the points */
    bool touched;             /* by the current operation: it, or a neighbour */
    bool moved, shown;        /* since the beginning; written by gtx_edit_refresh since then */
} gtx_field_span;

/* The pending change of a texel: move of the point, change of the detail, value. Padded to the
 * length of vector registers. */
typedef float gtx_change[8];
enum { GTX_CHANGE_MOVE = 0, GTX_CHANGE_DETAIL = 3, GTX_CHANGE_VALUE = 6 };

struct gtx_edit {
    gtx_allocator allocator;
    const gtx_asset *source;
    uint32_t count;           /* of height fields */
    gtx_field_span *fields;
    size_t texels;            /* of all height fields */
    float texel_size;
    uint8_t *kind;
    float (*rest)[3];         /* where points were */
    float (*point)[3];
    float (*normal)[3];
    float (*detail)[3];       /* difference of the normal map from the normals of the points */
    float *height;            /* at rest, along z, object units */
    float *trim;              /* signed distance to the outline, texels, positive outside */
    float *value, *next;
    gtx_change *changes;      /* all 0 between operations */
    gtx_correspondence *correspondences;
    size_t correspondence_count;
    uint32_t *loose;          /* texels of their height fields */
    uint8_t *ring;            /* steps from own or borrowed texels; 255: no surface */
    size_t loose_count;
    gtx_asset *live;          /* the asset of gtx_edit_refresh */
    uint32_t *changed;        /* its changed patches */
};

/* The height of a texel's point along its patch's z, object units. */
static inline double gtx_edit_height(const gtx_edit *edit, const gtx_field_span *field, size_t at)
{
    double height = edit->height[at];
    for (int k = 0; k < 3; ++k)
        height += field->to_grid[2][k] * ((double)edit->point[at][k] - edit->rest[at][k]);
    return height;
}

/* A file calls functions of files that are named above it, none of those below. */

/* field.c: reads the asset's maps into the height fields and continues them past the coded
 * texels. */
gtx_result gtx_edit_read_fields(gtx_edit *edit, gtx_error *error);

/* follow.c: copies the changes of owners to borrowed texels, and those of texels beside them to
 * loose ones, in touched height fields. */
void gtx_edit_follow(const gtx_edit *edit, gtx_change *changes);
/* Counts steps from own and borrowed texels, and orders the loose ones by them. */
void gtx_edit_order_loose(gtx_edit *edit, gtx_field_span *field);

/* correspondences.c: finds the owners of borrowed texels. Errors: MEMORY. */
gtx_result gtx_edit_find_correspondences(gtx_edit *edit, gtx_error *error);

/* normals.c: computes details and boxes from points and normals. */
void gtx_edit_begin_details(gtx_edit *edit);
/* Updates normals and box of a height field whose points have moved; then, once all are updated,
 * its borrowed normals. */
void gtx_edit_renew_normals(gtx_edit *edit, gtx_field_span *field);
void gtx_edit_borrow_normals(gtx_edit *edit, const gtx_field_span *field);

/* fold_limit.c: reduces edit->changes, across patches, where they would turn cells away from their
 * patch's z. Errors: MEMORY. */
gtx_result gtx_edit_limit_folds(gtx_edit *edit, gtx_error *error);

/* changes.c: an operation first touches height fields, all of them or those whose boxes, enlarged
 * by `slack`, overlap a box; then it writes the changes of own texels, and ends with gtx_edit_done,
 * which updates the other texels and moves the points. Errors: MEMORY (nothing has changed). */
void gtx_edit_touch_all(gtx_edit *edit);
void gtx_edit_touch(gtx_edit *edit, const float low[3], const float high[3], float slack);
gtx_result gtx_edit_done(gtx_edit *edit, gtx_error *error);
/* The parts of gtx_edit_done: commit moves the points of touched height fields by edit->changes,
 * forget zeroes the changes and ends the operation. */
void gtx_edit_commit(gtx_edit *edit);
void gtx_edit_forget(gtx_edit *edit);

/* heat_flow.c: writes the changes of a Gaussian of `radius` object units to edit->changes; all
 * height fields must be touched. Errors: MEMORY. */
gtx_result gtx_edit_heat_flow(gtx_edit *edit, double radius, gtx_error *error);
/* per_patch.c: the same for heights and normals, patch by patch; borrowed texels included. */
gtx_result gtx_edit_blur_per_patch(gtx_edit *edit, double radius, gtx_error *error);

/* warp.c: a texel of a resampled height field. */
typedef struct gtx_texel {
    float height;             /* object units along z */
    float trim;
    float normal[3];
    float from[2];            /* position of its surface in the source, texels */
    uint8_t covered, coded;
} gtx_texel;

/* A rectangle of texels, relative to the patch's rectangle in the source. */
typedef struct gtx_window {
    int32_t low[2];
    uint32_t size[2];
} gtx_window;

/* The window that the visible part of a height field covers; of size 0 if nothing is visible. */
gtx_window gtx_edit_window(const gtx_edit *edit, const gtx_field_span *field);
/* Fills the texels of a window, which must be zeroed, row by row. */
void gtx_edit_warp(const gtx_edit *edit, const gtx_field_span *field, const gtx_window *window,
                   gtx_texel *out);

/* maps.c: writes a patch, whose record has its page and rectangle, into the maps of `out`, which
 * has the source's levels, and sets its frame, coverage and sphere. Errors: MEMORY (nothing has
 * changed). */
gtx_result gtx_edit_write_patch(const gtx_edit *edit, uint32_t patch, const gtx_window *window,
                                gtx_asset *out, gtx_error *error);
/* Copies an unchanged patch. */
void gtx_edit_copy_patch(const gtx_edit *edit, uint32_t patch, gtx_asset *out);
/* The address of a texel of a patch in an image of an asset. */
uint8_t *gtx_edit_texel(const gtx_asset *asset, const gtx_patch *patch, int kind, uint32_t level,
                        uint32_t x, uint32_t y);

/* Texels of a patch to be written, row by row; the writers complete those without a height by the
 * rules of format/gtx.md, 4.8, and overwrite the arrays. */
typedef struct gtx_patch_texels {
    uint8_t *occupied;        /* 1 where there is a height code */
    uint8_t *normals;         /* 2 bytes each, of level 0 */
    uint8_t *trims;           /* codes */
    uint8_t *ring, *codes;    /* scratch, of 1 and 2 bytes */
} gtx_patch_texels;
void gtx_edit_write_trim(const gtx_patch_texels *texels, const gtx_patch *to, gtx_asset *out);
/* All levels; after the trim. */
void gtx_edit_write_normals(const gtx_patch_texels *texels, const gtx_patch *to, gtx_asset *out);

/* finish.c: fills trims and normals outside all patches; computes the asset's bounds; and copies an
 * asset with all rules of the format checked: LIMIT if numbers have become too large for them. */
void gtx_edit_fill_far(gtx_asset *asset);
void gtx_edit_write_bounds(gtx_asset *asset);
gtx_result gtx_edit_copy_checked(const gtx_asset *asset, gtx_asset **out, gtx_error *error);

/* pages.c: packs the patches' rectangles, whose sizes are given, into pages, in multiples of
 * 2^(mip_count-1) texels. Errors: MEMORY, LIMIT. */
gtx_result gtx_edit_place(gtx_patch *patches, const gtx_allocator *hooks, gtx_info *info,
                          gtx_error *error);

#endif
