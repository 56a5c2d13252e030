/* What is to be drawn: a camera with its light, by which method, in which pass; and placed models.
 * frame.h, render.h and vulkan.h take it alike. */
#ifndef GEOTEX_VIEW_H
#define GEOTEX_VIEW_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An asset made ready for a GPU, or on it. */
typedef struct gtx_model gtx_model;

typedef enum gtx_method {
    GTX_METHOD_AUTO = 0,          /* what is fastest within the error budget, patch by patch where
                                     that pays: LOD meshes, displaced grids, or cast */
    GTX_METHOD_CAST = 1,          /* exact: walks the cells and solves their bilinear patches */
    GTX_METHOD_PAPER = 2,         /* linear then binary search, balanced by slant (paper, 4.1) */
    GTX_METHOD_LOD = 3,           /* triangles of an LOD mesh, which the asset must have */
    GTX_METHOD_GRID = 4           /* triangles of the height fields, each patch at its own level:
                                     displaced grids (Cook, Shade Trees, SIGGRAPH 1984) */
} gtx_method;

/* What a draw writes besides depth, by fragment output location. The programs of the forward pass
 * are compiled with the renderer, those of another pass by its first draw, even one of no
 * instances. */
typedef enum gtx_pass {
    GTX_PASS_FORWARD = 0,         /* 0: lit colour, in sRGB; linear with GTX_VIEW_LINEAR */
    GTX_PASS_DEPTH = 1,           /* nothing, colour is masked; the same depth, bit for bit. For a
                                     shadow map viewport_height is the map's height */
    GTX_PASS_ID = 2,              /* 0, unsigned integers (RGBA32UI, or RG32UI for the first two):
                                     the instance's id, the patch, and x and y of the hit cell's
                                     low texel in the patch */
    GTX_PASS_GBUFFER = 3          /* 0: albedo in sRGB bytes, alpha (RGBA8); 1: world-space normal
                                     * 0.5 + 0.5 (RGB10_A2 or finer); 2: occlusion, roughness,
                                     metallic, lit (RGBA8; 1, 1, 0, 1 without a material);
                                     3: linear emission (R11F_G11F_B10F). Any may be missing */
} gtx_pass;

/* An engine's own fragment main, which finds the surface by a call and shades it as it likes. */
typedef struct gtx_shading gtx_shading;

enum { /* gtx_view.flags */
    GTX_VIEW_REVERSED_Z = 1,          /* nearer is greater: depth func GREATER */
    GTX_VIEW_DEPTH_ZERO_TO_ONE = 2,   /* clip z in 0..1 (glClipControl), not -1..1 */
    GTX_VIEW_RESTORE_STATE = 4,       /* read the touched state first and put it back */
    GTX_VIEW_SHADING_BY_TILES = 8,    /* an engine's own shading is cast by tiles, too, where others
                                         are (gtx_tiling) and it has what draws so: a program
                                         (gtx_shading_tile_program), or a pipeline */
    GTX_VIEW_BY_SAMPLES = 32,         /* cast once a sample, not by tiles: multisampling smooths the
                                         outlines of casts as those of polygons. In OpenGL where the
                                         context has sample shading; in Vulkan with the device's
                                         feature sampleRateShading */
    GTX_VIEW_LINEAR = 16              /* lit colours, and albedos of a G-buffer, are written as
                                         linear light, without a bound above: into floats, or what
                                         encodes (sRGB formats; in OpenGL, FRAMEBUFFER_SRGB on) */
};

/* What the other one of two eyes has of its own. */
typedef struct gtx_eye {
    float view[16], projection[16];   /* as in gtx_view, and of the same clip space */
} gtx_eye;

/* One camera and one light.
 *
 * Levels of height fields. Each patch of an instance is cast at the coarsest level of its height
 * field whose distance from level 0, measured by gtx_model_prepare, is at most `max_error` pixels
 * at the point of the patch's sphere that is nearest to the camera. Coverage only grows from level
 * to level, and neighbours of different levels meet within that error. Pixels are square.
 * GTX_METHOD_PAPER always draws level 0.
 *
 * LOD meshes. GTX_METHOD_LOD draws an instance by the coarsest LOD mesh whose error is at most
 * `max_error` pixels where the asset's bounds are nearest to the camera, or by the finest one if
 * none is; `level` then counts LOD meshes. They write no depth of their own, so that the depth test
 * comes first and multisampling smooths edges; `viewport_height` also sets the mip level of their
 * maps. GTX_METHOD_AUTO draws the same LOD mesh where no part of the instance could be drawn by a
 * coarser one, unless casting costs less wherever that mesh is just fine enough (gtx_costs).
 *
 * Patch by patch. Otherwise, or if part of it is beside the picture, AUTO draws each patch in view
 * by the coarsest LOD mesh that is fine enough where the patch is nearest, or else as a displaced
 * grid or cast, whichever costs less; so, too, by tiles, two-sided patches of which that mesh has
 * many triangles. No patch is drawn coarser than before when it is nearer. Where ways meet, the
 * coarser goes on beneath the finer by a ring of triangles. It casts if `viewport_height` is
 * unknown, or if `level` is given. With AUTO and LOD patches taken by gtx_model_update have no LOD
 * mesh from then on.
 *
 * Displaced grids. GTX_METHOD_GRID draws height fields as right triangles over cells of level 0,
 * from two over 8 x 8 cells to two over each: halved until they keep to max_error where they are,
 * and to a 16th of it at outlines, where neighbours meet; `level` n says two over squares of
 * 2^(n - 1) cells. They are found anew in each draw, a few ten nanoseconds each. Blocks of 8 x 8
 * cells that are out of view, and triangles that face away, are not drawn. They write no depth of
 * their own. A GPU displaces whole blocks in the vertex shader instead, of the coarsest
 * level within max_error, and finds no triangle. */
typedef struct gtx_view {
    float view[16], projection[16];   /* column-major; world -> eye -> clip */
    float light_direction[3];         /* world space, towards the light; zero = headlight */
    float ambient;                    /* share of colour without light; 0 = 0.2 */
    gtx_method method;
    uint32_t flags;
    float depth_range[2];             /* of glDepthRange; both 0 = 0..1 */
    uint32_t viewport_height;         /* pixels; 0 = unknown: level 0, unless `level` is given */
    float max_error;                  /* pixels; 0 = 0.5 */
    uint32_t level;                   /* 0 = by the error, n = level n - 1 or the coarsest */
    gtx_pass pass;
    const gtx_shading *shading;       /* in place of the forward pass's; not with PAPER */
    uint32_t search_steps[2];         /* of PAPER: linear (1..1000), then binary (0..100); both 0 =
                                         balanced by how slanted the view is */
    uint32_t viewport_width;          /* pixels; 0 = unknown. If given, this and viewport_height are
                                         the size of glViewport, for gtx_tiling */
    const gtx_eye *other;             /* NULL, or the second view of what draws two at once
                                         (multiview: gtx_vk_target.view_mask): a patch in view of
                                         either is drawn, at the finer level of both, cast or by LOD
                                         meshes, not by tiles nor as a displaced grid */
    uint32_t reserved[1];
} gtx_view;

/* A placed model. `transform` is affine and takes the asset's coordinates (relative to its anchor)
 * to the world; its linear part must be invertible. `tint` multiplies the colour; all 0 = white.
 * `id` is what GTX_PASS_ID writes and a shading reads. */
typedef struct gtx_instance {
    const gtx_model *model;
    float transform[16];
    float tint[4];
    uint32_t id;
    uint32_t reserved[3];
} gtx_instance;

/* What drawing costs, for GTX_METHOD_AUTO to compare: a triangle of an LOD mesh and a pixel that it
 * covers; a patch that is cast and a pixel that its proxy covers; a triangle of a displaced grid,
 * whose pixels cost what those of LOD meshes do. In any unit; all 0 = as measured, with llvmpipe,
 * on which only the finer LOD meshes may cost more than casting, or on a GPU, where polygons cost
 * less wherever there are few to a pixel. */
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
