/* The inside of a gtx_edit, for the files of this room. */
#ifndef GTX_EDIT_INSIDE_H
#define GTX_EDIT_INSIDE_H

#include <geotex/edit.h>

#include "asset/asset.h"

#include <stdbool.h>

/* Rings of texels around those with a code, and texels that a height field is larger on each side:
 * what moves by half a texel still covers every cell that shows. */
enum { GTX_EDIT_MARGIN = 3 };

/* A texel that is a neighbour's: a place in a cell of that one's height field. */
typedef struct gtx_correspondence {
    uint32_t texel;
    uint32_t patch, source;   /* of the neighbour; the cell's low corner in its height field */
    float u, v;               /* 0..1 in the cell */
} gtx_correspondence;

/* A patch's height field whose points move: its span of texels in the edit's arrays, and what is
 * known of it as a whole. (An operation of a caller's own sees it as gtx_edit_field.) */
typedef struct gtx_field_span {
    uint32_t width, height;
    size_t first;             /* texel of the edit; width * height from there on */
    double to_grid[3][3];     /* rows: from a move in object units to texels, and to object units of
                                 height */
    size_t first_correspondence, correspondence_count;   /* sorted by texel */
    size_t first_loose, loose_count; /* nearest to the surface first */
    float low[3], high[3];    /* around the points */
    bool touched;             /* by the operation at hand: it, or a neighbour */
    bool moved, shown;        /* since the beginning; as gtx_edit_refresh has shown it */
} gtx_field_span;

/* What an operation changes at a texel, before it is done: the point's move, the detail's change,
 * the value. As long as a vector register, or two. */
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
    float (*detail)[3];       /* what the normal map has beyond the points' own normals */
    float *height;            /* at rest, object units along z */
    float *trim;              /* texels outside the outline */
    float *value, *next;
    gtx_change *changes;      /* all 0 between operations */
    gtx_correspondence *correspondences;
    size_t correspondence_count;
    uint32_t *loose;          /* texels of their height fields */
    uint8_t *ring;            /* steps from texels that are own or borrowed; 255: no surface */
    size_t loose_count;
    gtx_asset *live;          /* what gtx_edit_refresh shows */
    uint32_t *changed;        /* patches */
};

/* How high a texel's point stands, object units along its patch's z. */
static inline double gtx_edit_height(const gtx_edit *edit, const gtx_field_span *field, size_t at)
{
    double height = edit->height[at];
    for (int k = 0; k < 3; ++k)
        height += field->to_grid[2][k] * ((double)edit->point[at][k] - edit->rest[at][k]);
    return height;
}

/* Files call those of files that are named above them, and nothing below. */

/* field.c: reads the asset's maps into the height fields and continues them past the coded
 * texels. */
gtx_result gtx_edit_read_fields(gtx_edit *edit, gtx_error *error);

/* follow.c: gives borrowed texels what their owners have, loose ones what is beside them; in
 * touched height fields. */
void gtx_edit_follow(const gtx_edit *edit, gtx_change *changes);
/* Counts steps from own and borrowed texels, and orders the loose ones by them. */
void gtx_edit_order_loose(gtx_edit *edit, gtx_field_span *field);

/* correspondences.c: finds whose the texels are that are not their patch's own. Errors: MEMORY. */
gtx_result gtx_edit_find_correspondences(gtx_edit *edit, gtx_error *error);

/* normals.c: fills in details and boxes, once points and normals are there. */
void gtx_edit_begin_details(gtx_edit *edit);
/* Normals and box of a height field whose points have moved; then, once all have theirs, the
 * normals that it borrows. */
void gtx_edit_renew_normals(gtx_edit *edit, gtx_field_span *field);
void gtx_edit_borrow_normals(gtx_edit *edit, const gtx_field_span *field);

/* fold_limit.c: takes back from edit->changes, with the neighbours in mind, what would turn cells
 * away from their patch's z. Errors: MEMORY. */
gtx_result gtx_edit_limit_folds(gtx_edit *edit, gtx_error *error);

/* changes.c: an operation touches height fields, all of them or those whose boxes, grown by
 * `slack`, meet a box; it changes own texels, and is done: the others follow. Errors: MEMORY
 * (nothing has changed). */
void gtx_edit_touch_all(gtx_edit *edit);
void gtx_edit_touch(gtx_edit *edit, const float low[3], const float high[3], float slack);
gtx_result gtx_edit_done(gtx_edit *edit, gtx_error *error);
/* The parts of it: moves the points of touched height fields by edit->changes as they are; sets
 * changes to 0, and touches nothing. */
void gtx_edit_commit(gtx_edit *edit);
void gtx_edit_forget(gtx_edit *edit);

/* heat_flow.c: what a Gaussian of `radius` object units changes, into edit->changes; all height
 * fields are touched. Errors: MEMORY. */
gtx_result gtx_edit_heat_flow(gtx_edit *edit, double radius, gtx_error *error);
/* per_patch.c: the same of heights and normals, patch by patch; nothing is left to follow. */
gtx_result gtx_edit_blur_per_patch(gtx_edit *edit, double radius, gtx_error *error);

/* warp.c: a height field put back on texels. */
typedef struct gtx_texel {
    float height;             /* object units along z */
    float trim;
    float normal[3];
    float from[2];            /* where on the source's texels its surface was */
    uint8_t covered, coded;
} gtx_texel;

/* Texels of a patch as those of its source's rectangle: the first, and how many. */
typedef struct gtx_window {
    int32_t low[2];
    uint32_t size[2];
} gtx_window;

/* The texels that the shown part of a height field takes; of size 0 when nothing shows. */
gtx_window gtx_edit_window(const gtx_edit *edit, const gtx_field_span *field);
/* Fills the texels of a window, all 0, row by row. */
void gtx_edit_warp(const gtx_edit *edit, const gtx_field_span *field, const gtx_window *window,
                   gtx_texel *out);

/* maps.c: writes a patch, whose record has its page and rectangle, into the maps of `out`, which
 * has the source's levels. Frame, coverage and sphere follow. Errors: MEMORY (nothing has
 * changed). */
gtx_result gtx_edit_write_patch(const gtx_edit *edit, uint32_t patch, const gtx_window *window,
                                gtx_asset *out, gtx_error *error);
/* The patch as it was. */
void gtx_edit_copy_patch(const gtx_edit *edit, uint32_t patch, gtx_asset *out);
/* The address of a texel of a patch in an image of an asset. */
uint8_t *gtx_edit_texel(const gtx_asset *asset, const gtx_patch *patch, int kind, uint32_t level,
                        uint32_t x, uint32_t y);

/* Writes what is known of the texels of a patch, and by rule what is not (format/gtx.md, 4.8). The
 * arrays have its rectangle's texels, row by row, and are used up. */
typedef struct gtx_patch_texels {
    uint8_t *occupied;        /* 1 where there is a height code */
    uint8_t *normals;         /* 2 bytes each, of level 0 */
    uint8_t *trims;           /* codes */
    uint8_t *ring, *codes;    /* scratch, of 1 and 2 bytes */
} gtx_patch_texels;
void gtx_edit_write_trim(const gtx_patch_texels *texels, const gtx_patch *to, gtx_asset *out);
/* All levels; after the trim. */
void gtx_edit_write_normals(const gtx_patch_texels *texels, const gtx_patch *to, gtx_asset *out);

/* finish.c: what trims and normals hold outside all patches; bounds around these; and a copy that
 * keeps to the rules of the format: LIMIT where they do not hold, of numbers too large for them. */
void gtx_edit_fill_far(gtx_asset *asset);
void gtx_edit_write_bounds(gtx_asset *asset);
gtx_result gtx_edit_copy_checked(const gtx_asset *asset, gtx_asset **out, gtx_error *error);

/* pages.c: finds places for the rectangles, whose sizes are there, in multiples of 2^(mip_count-1)
 * texels. Errors: MEMORY, LIMIT. */
gtx_result gtx_edit_place(gtx_patch *patches, const gtx_allocator *hooks, gtx_info *info,
                          gtx_error *error);

#endif
