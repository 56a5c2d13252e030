/* What to draw: a camera with its light, the method, the pass, and placed models. Shared by
 * frame.h, render.h and vulkan.h. */
#ifndef GEOTEX_VIEW_H
#define GEOTEX_VIEW_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An asset prepared for drawing, or uploaded to a GPU. */
typedef struct gtx_model gtx_model;

typedef enum gtx_method {
    GTX_METHOD_AUTO = 0,          /* the fastest within max_error, patch by patch where that pays:
                                     LOD meshes, displaced grids, or casting */
    GTX_METHOD_CAST = 1,          /* exact ray casting: walks the cells and intersects their
                                     bilinear patches */
    GTX_METHOD_PAPER = 2,         /* linear, then binary search, balanced by the slant of the view
                                     (paper, 4.1) */
    GTX_METHOD_LOD = 3,           /* triangles of an LOD mesh, which the asset must have */
    GTX_METHOD_GRID = 4           /* triangles over the height fields, adapted to max_error:
                                     displaced grids (Cook, "Shade Trees", SIGGRAPH 1984) */
} gtx_method;

/* What a draw writes besides depth, by fragment output location. The programs of the forward pass
 * are compiled when the renderer is created, those of another pass by its first draw, even if that
 * has no instances. */
typedef enum gtx_pass {
    GTX_PASS_FORWARD = 0,         /* 0: lit colour, in sRGB; linear with GTX_VIEW_LINEAR */
    GTX_PASS_DEPTH = 1,           /* none, colour is masked. The depth is that of the other passes,
                                     bit for bit. For a shadow map, viewport_height is the map's */
    GTX_PASS_ID = 2,              /* 0, unsigned integers (RGBA32UI, or RG32UI for the first two):
                                     the instance's id, the patch, and x and y of the hit cell's
                                     low texel in the patch */
    GTX_PASS_GBUFFER = 3          /* 0: albedo in sRGB bytes, alpha (RGBA8); 1: world-space normal
                                     * 0.5 + 0.5 (RGB10_A2 or finer); 2: occlusion, roughness,
                                     metallic, lit (RGBA8; 1, 1, 0, 1 without a material);
                                     3: linear emission (R11F_G11F_B10F). Any may be missing */
} gtx_pass;

/* An engine's own fragment shader, compiled around geotex's function that finds the surface. */
typedef struct gtx_shading gtx_shading;

enum { /* gtx_view.flags */
    GTX_VIEW_REVERSED_Z = 1,          /* nearer is greater: depth func GREATER */
    GTX_VIEW_DEPTH_ZERO_TO_ONE = 2,   /* clip z in 0..1 (glClipControl), not -1..1 */
    GTX_VIEW_RESTORE_STATE = 4,       /* OpenGL: save the state that the draw changes, restore it */
    GTX_VIEW_SHADING_BY_TILES = 8,    /* also cast by tiles with an engine's own shading, where
                                         tiles are used (gtx_tiling) and the shading has a program
                                         or pipeline for it */
    GTX_VIEW_SHADING_SOLID = 64,      /* an engine's own shading discards nothing that gtx_find
                                         finds: what it hides need not be drawn */
    GTX_VIEW_BY_SAMPLES = 32,         /* cast once per sample, not by tiles, so that multisampling
                                         smooths the outlines of casts as it does those of polygons.
                                         OpenGL: where the context has sample shading; Vulkan: with
                                         the device's feature sampleRateShading */
    GTX_VIEW_LINEAR = 16              /* write lit colours, and the albedo of a G-buffer, as
                                         unclamped linear light: to float formats, or to sRGB
                                         formats that encode it (OpenGL: FRAMEBUFFER_SRGB on) */
};

/* The matrices of the second eye of a stereo view. */
typedef struct gtx_eye {
    float view[16], projection[16];   /* as in gtx_view, and of the same clip space */
} gtx_eye;

/* One camera and one light.
 *
 * Levels of height fields. Each patch of an instance is cast at the coarsest level of its height
 * field whose distance from level 0, measured by gtx_model_prepare, is at most `max_error` pixels
 * at the point of the patch's sphere that is nearest to the camera. A coarser level covers at least
 * what a finer one does, so patches of different levels meet within that error. Pixels are assumed
 * to be square. GTX_METHOD_PAPER always draws level 0.
 *
 * LOD meshes. GTX_METHOD_LOD draws an instance by the coarsest LOD mesh whose error is at most
 * `max_error` pixels where the asset's bounds are nearest to the camera, or by the finest one if
 * none is; `level` then selects an LOD mesh. Their fragments do not write depth, so early depth
 * tests work and multisampling smooths edges; `viewport_height` also sets the mip level of their
 * maps. GTX_METHOD_AUTO draws the same LOD mesh if no part of the instance could be drawn by a
 * coarser one, unless casting would cost less wherever that mesh is only just fine enough
 * (gtx_costs).
 *
 * Patch by patch. Otherwise, or if part of the instance is out of view, AUTO draws each visible
 * patch by the coarsest LOD mesh that is fine enough at its nearest point, or else as a displaced
 * grid or by casting, whichever costs less. By tiles it also casts two-sided patches of which the
 * LOD mesh has many triangles. A patch never gets coarser as it comes nearer. Where patches drawn
 * in different ways meet, the coarser one continues beneath the finer by a ring of triangles. AUTO
 * casts everything if `viewport_height` is unknown or `level` is given. A patch that
 * gtx_model_update has replaced is no longer drawn by LOD meshes.
 *
 * Displaced grids. GTX_METHOD_GRID draws height fields as right triangles, from two per 8 x 8 cells
 * down to two per cell of level 0: halved until their error is within max_error, and at outlines,
 * where patches meet, within 1/16 of it; `level` n means two per 2^(n - 1) x 2^(n - 1) cells. A
 * cell, whose surface is bilinear, gets four triangles where two are off by more than max_error,
 * and 16, which are off by a sixteenth of that, where four are, too. The triangles are built in
 * each draw, in a few tens of nanoseconds each. Blocks of 8 x 8 cells that are out of view, and
 * triangles that face away, are not drawn. Fragments do not write depth. On a GPU the vertex shader
 * displaces whole blocks instead, at the coarsest level within max_error, with two triangles per
 * cell of level 0 at the finest, and no triangles are built. */
typedef struct gtx_view {
    float view[16], projection[16];   /* column-major; world -> eye -> clip */
    float light_direction[3];         /* world space, towards the light; zero = from the camera */
    float ambient;                    /* share of the colour that needs no light; 0 = 0.2 */
    gtx_method method;
    uint32_t flags;
    float depth_range[2];             /* of glDepthRange; both 0 = 0..1 */
    uint32_t viewport_height;         /* pixels; 0 = unknown: level 0, unless `level` is given */
    float max_error;                  /* pixels; 0 = 0.5 */
    uint32_t level;                   /* 0 = by max_error; n = level n - 1, or the coarsest */
    gtx_pass pass;
    const gtx_shading *shading;       /* instead of the stock one of the forward pass; or NULL. Not
                                         with PAPER */
    uint32_t search_steps[2];         /* of PAPER: linear (1..1000), then binary (0..100); both 0 =
                                         balanced by how slanted the view is */
    uint32_t viewport_width;          /* pixels; 0 = unknown. If given, this and viewport_height are
                                         the size of glViewport, for gtx_tiling */
    const gtx_eye *other;             /* the second eye of a multiview draw
                                         (gtx_vk_target.view_mask), or NULL. A patch in view of
                                         either eye is drawn, at the finer of their levels, by LOD
                                         meshes or cast, but not by tiles nor as a displaced grid */
    uint32_t reserved[1];
} gtx_view;

/* A placed model. `transform` is column-major, affine and invertible, and maps the asset's
 * coordinates (relative to its anchor) to the world. `tint` multiplies the colour; all 0 = white.
 * GTX_PASS_ID writes `id`, and an engine's own shading can read it. */
typedef struct gtx_instance {
    const gtx_model *model;
    float transform[16];
    float tint[4];
    uint32_t id;
    uint32_t reserved[3];
} gtx_instance;

/* Relative costs of drawing, which GTX_METHOD_AUTO compares: of a triangle of an LOD mesh and of a
 * pixel that it covers; of a cast patch and of a pixel that its proxy covers; of a triangle of a
 * displaced grid, whose pixels cost as much as those of LOD meshes. In any unit; all 0 = as
 * measured with llvmpipe, where only the finer LOD meshes may cost more than casting, or on a GPU,
 * where polygons cost less unless there are many per pixel. */
typedef struct gtx_costs {
    float lod_triangle, lod_pixel;
    float cast_patch, cast_pixel;
    float grid_triangle;          /* 0 = twice lod_triangle */
} gtx_costs;

/* Casting by tiles: for each tile of 4 x 4 pixels the patches of an instance that may cover it are
 * listed, nearest first, and each pixel casts one ray, which stops at the nearest hit. It applies
 * to what GTX_METHOD_CAST and AUTO cast in views that give viewport_width, one instance at a time,
 * in every pass, but with an engine's own shading only where GTX_VIEW_SHADING_BY_TILES is set.
 * Everything else, and all of OpenGL ES, is cast in the fragments of proxies. */
typedef enum gtx_tiling {
    GTX_TILES_AUTO = 0,           /* where it is known to be faster: with llvmpipe */
    GTX_TILES_NEVER = 1,
    GTX_TILES_ALWAYS = 2          /* wherever the context can */
} gtx_tiling;

#ifdef __cplusplus
}
#endif
#endif
