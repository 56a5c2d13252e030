/* Image operations on the surface of an asset: blur, boost, patterns, operations of one's own,
 * and edits while it is drawn.
 *
 * An edit spreads an asset out as one *height field* a patch: a grid of points with normals. A
 * texel of a height field belongs to the patch (it is inside its outline), or is borrowed: the
 * surface there belongs to a neighbour, and moves as that one's points do. So all patches see one
 * surface, across their borders, and what moves it opens no seam. (In the paper, section 6.3, every
 * patch is filtered by itself; GTX_EDIT_PER_PATCH does the same, for comparison.)
 *
 * What would turn part of a patch's surface away from its axis_z, where no height map can show
 * it, is held back there, and less and less around: the tip of a claw is rounded off a little
 * less than its flanks.
 *
 * Points may move in any direction. They are put back on texels at the end: outlines, colours
 * and materials go where the surface goes. Nothing is resampled twice, however many operations
 * there are.
 *
 * The rules of geotex.h hold here too. An operation that fails leaves the edit as it was. Levels
 * of an LOD mesh do not follow: edited assets have none until gtx_cook_lod_meshes makes them
 * one. */
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

/* Spreads the asset out. `asset` is not changed, and must stay open until gtx_edit_end; `desc`
 * may be NULL. Takes some 100 bytes a texel.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, EMPTY (no texel has a height). */
GTX_API gtx_result gtx_edit_begin(const gtx_asset *asset, const gtx_edit_desc *desc, gtx_edit **out,
                                  gtx_error *error);
/* Frees the edit, and the asset that gtx_edit_refresh showed. NULL is fine. */
GTX_API void gtx_edit_end(gtx_edit *edit);

/* The size of a texel, in object units: the median of the patches. */
GTX_API float gtx_edit_texel_size(const gtx_edit *edit);

enum { /* gtx_edit_blur.flags */
    GTX_EDIT_WORLD = 1,           /* radius in object units, not in texels */
    GTX_EDIT_PER_PATCH = 2        /* the paper's way: every patch by itself, heights along its z */
};

/* A Gaussian over the surface, of points and of normals. Distances are those along the surface,
 * whatever the patches' frames: heat flows for a time of radius^2 / 2 (Desbrun et al., "Implicit
 * Fairing of Irregular Meshes using Diffusion and Curvature Flow", SIGGRAPH 1999). */
typedef struct gtx_edit_blur {
    float radius;                 /* standard deviation, > 0 */
    uint32_t flags;
    uint32_t reserved[6];
} gtx_edit_blur;

/* Replaces the surface by its blur. A plane stays, a sphere shrinks by a factor of
 * exp(-(radius / its own)^2). Works in some 200 bytes a texel.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (the radius is larger than the largest patch). */
GTX_API gtx_result gtx_edit_gaussian(gtx_edit *edit, const gtx_edit_blur *blur, gtx_error *error);

/* High-boost: surface + amount * (surface - its blur). 0 < amount <= 16.
 * Errors: likewise. */
GTX_API gtx_result gtx_edit_high_boost(gtx_edit *edit, const gtx_edit_blur *blur, float amount,
                                       gtx_error *error);

/* An image of heights, 0..1 where nothing else is said; rows from the top. */
typedef struct gtx_edit_image {
    const float *values;          /* width * height, finite */
    uint32_t width, height;       /* 2..16384 */
} gtx_edit_image;

/* Raises the surface along its normals by height * image, in object units; height may be negative.
 * The image is repeated every `size` object units and laid on from the three axes at once, each to
 * the share that the surface faces it.
 * Errors: ARGUMENT, MEMORY. */
GTX_API gtx_result gtx_edit_pattern(gtx_edit *edit, const gtx_edit_image *image, float height,
                                    float size, gtx_error *error);

enum { /* gtx_edit_field.kind */
    GTX_TEXEL_NONE = 0,           /* no surface; the other arrays mean nothing here */
    GTX_TEXEL_OWN = 1,            /* the patch's own: an operation acts here */
    GTX_TEXEL_BORROWED = 2,       /* a neighbour's: follows by itself */
    GTX_TEXEL_LOOSE = 3           /* past a border without neighbour: follows by itself */
};

/* A patch's height field: arrays of width * height, row by row. It is the patch's rectangle and
 * some texels more on each side. */
typedef struct gtx_edit_field {
    uint32_t patch, width, height;
    const uint8_t *kind;
    float (*point)[3];            /* relative to the anchor; may be moved */
    const float (*normal)[3];     /* unit; follows the points after the operation */
    const float *value;           /* a number of the operations' own, 0 at first */
    float *next;                  /* what `value` will be: a copy of it now */
} gtx_edit_field;

typedef void (*gtx_edit_fn)(const gtx_edit_field *field, void *user);

/* An operation of one's own: calls `fn` for every height field, then makes borrowed texels follow.
 * `fn` reads any texel and writes `point` and `next` at own ones: neighbours' texels are there to
 * read, 3 past the outline at least. Values and points that are not finite end it: ARGUMENT,
 * nothing changed.
 * Errors: ARGUMENT, MEMORY. */
GTX_API gtx_result gtx_edit_apply(gtx_edit *edit, gtx_edit_fn fn, void *user, gtx_error *error);

/* A mark on the surface: a crater, a footprint. Texels that are less than `radius` from the
 * centre and face against `direction` by any angle below 90 degrees move along it by depth times
 * the image; a zero image is a round bowl. The image spans 2 * radius; its top points along
 * `up`. */
typedef struct gtx_edit_stamp_desc {
    float centre[3], radius;      /* relative to the anchor; object units */
    float direction[3], depth;    /* of any length but 0; depth may be negative */
    float up[3];                  /* zero: any */
    gtx_edit_image image;
    uint32_t reserved[4];
} gtx_edit_stamp_desc;

/* Errors: ARGUMENT, NOT_ZEROED, MEMORY. A stamp that meets no surface is fine. */
GTX_API gtx_result gtx_edit_stamp(gtx_edit *edit, const gtx_edit_stamp_desc *stamp,
                                  gtx_error *error);

/* Sets the heights of a rectangle of one patch, x, y, width and height in texels of the patch:
 * `heights` are as in the map (0..1 of the asset's extent_z), and may leave that range. Empty
 * texels stay so; texels that belong to a neighbour stay with it, and the neighbours' borrowed
 * ones follow.
 * Errors: ARGUMENT (the rectangle is empty or leaves the patch, a height is not finite), MEMORY. */
GTX_API gtx_result gtx_edit_set_heights(gtx_edit *edit, uint32_t patch, const uint32_t rectangle[4],
                                        const float *heights, gtx_error *error);

/* Makes an asset of the edited surface, with the edit's allocator, which gtx_close frees.
 * Patches that did not change keep their bytes. Where a patch has outgrown its rectangle, pages
 * are laid out anew.
 * Errors: ARGUMENT, MEMORY, LIMIT (a patch would be larger than a page may be). */
GTX_API gtx_result gtx_edit_finish(const gtx_edit *edit, gtx_asset **out, gtx_error *error);

/* The same while it is drawn: rectangles stay where they are, and only patches that have changed
 * since the last call are done again. *asset belongs to the edit, is valid until gtx_edit_end
 * and is changed by the next call; its content_hash is 0. *patches gets the `*count` indices of
 * changed patches, valid until the next call: give each to gtx_model_update, and to
 * gtx_rays_update where shaders cast rays into it. What moved out of its rectangle is lost:
 * sideways there is room for a texel or two.
 * Errors: ARGUMENT, MEMORY. */
GTX_API gtx_result gtx_edit_refresh(gtx_edit *edit, const gtx_asset **asset,
                                    const uint32_t **patches, uint32_t *count, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
