/* Editing the surface of an asset: blur, high-boost, patterns, operations of your own, and edits
 * while the asset is drawn.
 *
 * An edit unpacks each patch's height field into a grid of points with normals. A texel of it
 * belongs to the patch if it is inside the patch's outline; otherwise it is borrowed: the surface
 * there belongs to a neighbouring patch, and moves with that patch's points. So the surface stays
 * continuous across patches, and no operation opens a seam. (In the paper, section 6.3, every patch
 * is filtered by itself; GTX_EDIT_PER_PATCH does the same, for comparison.)
 *
 * A height map cannot show surface that is turned away from its axis_z. A fold limiter holds
 * changes back that would turn it so: fully where it would, and less with distance. The tip of a
 * claw is then rounded a little less than its flanks.
 *
 * Points may move in any direction. They are resampled to texels once, at the end, however many
 * operations there were; outlines, colours and materials move with the surface.
 *
 * The rules of geotex.h hold here too. An operation that fails leaves the edit as it was. LOD
 * meshes do not follow: an edited asset has none until gtx_cook_lod_meshes makes them. */
#ifndef GEOTEX_EDIT_H
#define GEOTEX_EDIT_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An asset that is being edited. */
typedef struct gtx_edit gtx_edit;

typedef struct gtx_edit_desc {
    const gtx_allocator *allocator;
    uint32_t reserved[6];
} gtx_edit_desc;

/* Begins an edit; free it with gtx_edit_end. `asset` is not changed, and must stay open until then.
 * `desc` may be NULL. Takes some 100 bytes per texel.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, EMPTY (no texel has a height). */
GTX_API gtx_result gtx_edit_begin(const gtx_asset *asset, const gtx_edit_desc *desc, gtx_edit **out,
                                  gtx_error *error);
/* Frees the edit and the asset of gtx_edit_refresh. NULL is fine. */
GTX_API void gtx_edit_end(gtx_edit *edit);

/* The median texel size of the patches, in object units. */
GTX_API float gtx_edit_texel_size(const gtx_edit *edit);

enum { /* gtx_edit_blur.flags */
    GTX_EDIT_WORLD = 1,           /* the radius is in object units, not in texels */
    GTX_EDIT_PER_PATCH = 2        /* as in the paper: each patch by itself, heights along its z */
};

/* A Gaussian blur of points and normals over the surface. Distances are measured along the surface,
 * whatever the patches' frames: it is a heat flow for a time of radius^2 / 2 (Desbrun et al.,
 * "Implicit Fairing of Irregular Meshes using Diffusion and Curvature Flow", SIGGRAPH 1999). */
typedef struct gtx_edit_blur {
    float radius;                 /* standard deviation, > 0 */
    uint32_t flags;
    uint32_t reserved[6];
} gtx_edit_blur;

/* Replaces the surface by its blur. A plane stays as it is; a sphere of radius R shrinks by a
 * factor of exp(-(radius / R)^2). Takes some 200 bytes per texel during the call.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (the radius is larger than the largest patch). */
GTX_API gtx_result gtx_edit_gaussian(gtx_edit *edit, const gtx_edit_blur *blur, gtx_error *error);

/* High-boost: surface + amount * (surface - its blur). 0 < amount <= 16.
 * Errors: as gtx_edit_gaussian. */
GTX_API gtx_result gtx_edit_high_boost(gtx_edit *edit, const gtx_edit_blur *blur, float amount,
                                       gtx_error *error);

/* An image of heights, 0..1 unless said otherwise; rows from the top. */
typedef struct gtx_edit_image {
    const float *values;          /* width * height, finite */
    uint32_t width, height;       /* 2..16384 */
} gtx_edit_image;

/* Raises the surface along its normals by height * image, in object units; height may be negative.
 * The image repeats every `size` object units and is projected along all three axes, blended by how
 * much the surface faces each.
 * Errors: ARGUMENT, MEMORY. */
GTX_API gtx_result gtx_edit_pattern(gtx_edit *edit, const gtx_edit_image *image, float height,
                                    float size, gtx_error *error);

enum { /* gtx_edit_field.kind */
    GTX_TEXEL_NONE = 0,           /* no surface; the other arrays are undefined here */
    GTX_TEXEL_OWN = 1,            /* the patch's own: operations act here */
    GTX_TEXEL_BORROWED = 2,       /* a neighbouring patch's: follows that patch */
    GTX_TEXEL_LOOSE = 3           /* beyond an open border: follows the patch's own texels */
};

/* A patch's height field: arrays of width * height, row by row, for the patch's rectangle and a
 * margin of some texels on each side. */
typedef struct gtx_edit_field {
    uint32_t patch, width, height;
    const uint8_t *kind;
    float (*point)[3];            /* relative to the anchor; may be moved */
    const float (*normal)[3];     /* unit; follows the points after the operation */
    const float *value;           /* a number for operations to use, 0 at first */
    float *next;                  /* the next `value`; holds a copy of `value` at first */
} gtx_edit_field;

typedef void (*gtx_edit_fn)(const gtx_edit_field *field, void *user);

/* An operation of your own: calls `fn` for every height field, on the calling thread, then updates
 * borrowed and loose texels. `fn` may read any texel (there are at least 3 borrowed ones beyond the
 * outline), and may write `point` and `next` of the patch's own texels.
 * Errors: ARGUMENT (a value or a point is not finite), MEMORY. */
GTX_API gtx_result gtx_edit_apply(gtx_edit *edit, gtx_edit_fn fn, void *user, gtx_error *error);

/* A mark on the surface: a crater, a footprint. Texels less than `radius` from the centre whose
 * normals face against `direction`, at any angle below 90 degrees, move along it by depth times the
 * image; a zeroed image stands for a round bowl. The image spans 2 * radius; its top points along
 * `up`. */
typedef struct gtx_edit_stamp_desc {
    float centre[3], radius;      /* relative to the anchor; object units */
    float direction[3], depth;    /* of any length but 0; depth may be negative */
    float up[3];                  /* zero: any */
    gtx_edit_image image;
    uint32_t reserved[4];
} gtx_edit_stamp_desc;

/* Presses the stamp into every patch that it meets; meeting none is fine.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY. */
GTX_API gtx_result gtx_edit_stamp(gtx_edit *edit, const gtx_edit_stamp_desc *stamp,
                                  gtx_error *error);

/* Sets the heights of a rectangle (x, y, width, height, in texels of the patch) of one patch:
 * `heights` are as in the map, in units of the patch's extent_z in the source asset, and may leave
 * 0..1. Empty and borrowed texels stay as they are; what neighbours borrow from the patch follows.
 * Errors: ARGUMENT (the rectangle is empty or leaves the patch, a height is not finite), MEMORY. */
GTX_API gtx_result gtx_edit_set_heights(gtx_edit *edit, uint32_t patch, const uint32_t rectangle[4],
                                        const float *heights, gtx_error *error);

/* Makes an asset of the edited surface, allocated from the edit's allocator; free it with
 * gtx_close. Unchanged patches keep their bytes. If a patch has outgrown its rectangle, pages are
 * packed anew.
 * Errors: ARGUMENT, MEMORY, LIMIT (a patch would be larger than a page may be, all patches 16 times
 * as large as they were, or numbers larger or smaller than the rules of the format allow). */
GTX_API gtx_result gtx_edit_finish(const gtx_edit *edit, gtx_asset **out, gtx_error *error);

/* The same for an asset that is being drawn: rectangles stay where they are, and only patches that
 * have changed since the last call are written. *asset belongs to the edit, is valid until
 * gtx_edit_end and is changed by the next call; its content_hash is 0. *patches gets the indices of
 * the *count patches that changed, valid until the next call: pass each to gtx_model_update, and to
 * gtx_rays_update if shaders cast rays into it. Surface that moves out of its patch's rectangle is
 * lost; sideways there is room for a texel or two.
 * Errors: ARGUMENT, MEMORY. */
GTX_API gtx_result gtx_edit_refresh(gtx_edit *edit, const gtx_asset **asset,
                                    const uint32_t **patches, uint32_t *count, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
