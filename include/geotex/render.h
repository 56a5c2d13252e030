/* Drawing assets with OpenGL 3.3 core or OpenGL ES 3.0, or later, beside the engine's own polygons.
 *
 * The host owns the context, the framebuffer and the function loader; geotex links no GL. Every
 * draw writes true depth computed from the engine's own matrices, so patches and polygons drawn
 * before or after share one z-buffer.
 *
 * State. gtx_draw leaves a fixed state behind, and reads none back unless
 * GTX_VIEW_RESTORE_STATE is set:
 *   program 0, vertex array 0, array and element buffers 0, active texture unit 0, textures (2D and
 *   2D array) and samplers 0 on units 0..7, depth test on, depth func LESS (GREATER when reversed),
 *   depth mask on, cull face off, cull mode BACK, front face CCW, blend off, colour mask all on.
 * Of OpenGL also, where gtx_tiling has it: buffer texture 0 on unit 8.
 * It does not touch the framebuffer binding, viewport, scissor, stencil or clip control.
 *
 * OpenGL ES is recognised by its version string; there is nothing to tell. It encodes what is
 * written to an sRGB framebuffer, so bind another kind: colours are sRGB bytes already. Before 3.2
 * GTX_VIEW_RESTORE_STATE takes blending and colour mask for the same at all draw buffers.
 *
 * Where the context has KHR_debug, every object carries a label and a draw is a debug group. */
#ifndef GEOTEX_RENDER_H
#define GEOTEX_RENDER_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A renderer: programs and shared objects of one context (or share group). */
typedef struct gtx_renderer gtx_renderer;
/* An asset on the GPU. */
typedef struct gtx_model gtx_model;

typedef void (*gtx_gl_proc)(void);

/* What drawing a model takes, for GTX_METHOD_AUTO to compare: a triangle of its LOD mesh and a
 * pixel that this covers; a patch that is cast and a pixel that its proxy covers. In any unit; all
 * 0 = as measured with llvmpipe, where of an LOD mesh that is fine enough the finer levels alone
 * can lose. */
typedef struct gtx_costs {
    float lod_triangle, lod_pixel;
    float cast_patch, cast_pixel;
} gtx_costs;

/* Casting by tiles: what an instance has in each square of 4 x 4 pixels is listed, nearest first,
 * and a pixel casts its ray once and to the nearest patch alone. It takes what GTX_METHOD_CAST and
 * AUTO cast in views that tell their viewport_width, of instances one by one, in every pass but
 * with an engine's own shading; anything else, and OpenGL ES, is cast in fragments of proxies. */
typedef enum gtx_tiling {
    GTX_TILES_AUTO = 0,           /* where it is known to be faster: with llvmpipe */
    GTX_TILES_NEVER = 1,
    GTX_TILES_ALWAYS = 2          /* wherever the context can */
} gtx_tiling;

typedef struct gtx_renderer_desc {
    gtx_gl_proc (*load)(const char *name, void *user);   /* required: the host's GL loader */
    void *load_user;
    void (*log)(const char *message, void *user);        /* shader logs, and a line on the context;
                                                            may be NULL */
    void *log_user;
    const gtx_allocator *allocator;
    const gtx_jobs *jobs;                                /* copied, for gtx_model_create; may be
                                                            NULL */
    gtx_costs costs;                                     /* none below 0 */
    gtx_tiling tiles;
    uint32_t reserved[3];
} gtx_renderer_desc;

/* Needs the context current, as do all functions below but gtx_model_prepare. Leaves program 0,
 * vertex array 0 and array buffer 0. The renderer is of the descriptor's allocator, and freed by
 * gtx_renderer_destroy.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL (a function or version is missing), SHADER. */
GTX_API gtx_result gtx_renderer_create(const gtx_renderer_desc *desc, gtx_renderer **out,
                                       gtx_error *error);
GTX_API void gtx_renderer_destroy(gtx_renderer *renderer);

typedef struct gtx_model_desc {
    const gtx_allocator *allocator;   /* of the model; NULL = malloc */
    const gtx_jobs *jobs;             /* used during the call; may be NULL */
    uint32_t borrow;                  /* 1: the asset stays open until the model is uploaded, or
                                         destroyed: its maps are not copied */
    uint32_t reserved[4];
} gtx_model_desc;

/* Derives what the GPU needs, without GL: any thread. Keeps no reference to the asset, unless it
 * borrows its maps. `desc` may be NULL. The model is of the descriptor's allocator, and freed by
 * gtx_model_destroy; most of it once it is uploaded. Errors: ARGUMENT, NOT_ZEROED, MEMORY. */
GTX_API gtx_result gtx_model_prepare(const gtx_asset *asset, const gtx_model_desc *desc,
                                     gtx_model **out, gtx_error *error);

/* Uploads up to `max_bytes` (0 = everything) and sets *done to 1 once the model can be drawn.
 * Leaves the active texture unit 0 with no 2D and 2D array texture, array and pixel unpack buffers
 * 0, and pixel unpacking at its defaults.
 * A call sends less than `max_bytes` and one row of a map.
 * Errors: ARGUMENT, LIMIT (texture size), GL (out of memory: what was sent is given back, and the
 * next call begins anew). */
GTX_API gtx_result gtx_model_upload(gtx_renderer *renderer, gtx_model *model, uint64_t max_bytes,
                                    uint32_t *done, gtx_error *error);

/* Both at once, with the renderer's allocator and jobs. */
GTX_API gtx_result gtx_model_create(gtx_renderer *renderer, const gtx_asset *asset,
                                    gtx_model **out, gtx_error *error);

/* Takes one patch from an edited asset: its maps at all levels, and the record, bounds and proxy
 * that follow. `edited` has the pages, maps and rectangles of the asset that the model was made of,
 * and is not kept. State is left as by gtx_model_upload. Of several edited patches each is taken by
 * a call; the model is whole again after the last. Works in memory of the model's allocator.
 * Errors: ARGUMENT, MEMORY (nothing has changed), GL (out of memory). */
GTX_API gtx_result gtx_model_update(gtx_renderer *renderer, gtx_model *model,
                                    const gtx_asset *edited, uint32_t patch, gtx_error *error);

/* `renderer` may be NULL for a model that was never uploaded. A NULL model is fine. */
GTX_API void gtx_model_destroy(gtx_renderer *renderer, gtx_model *model);

/* Bytes of the model's textures and buffers on the GPU; `color` is colour, material, emission. */
typedef struct gtx_model_size {
    uint64_t geometry, color;
} gtx_model_size;
GTX_API gtx_model_size gtx_model_gpu_size(const gtx_model *model);

typedef enum gtx_method {
    GTX_METHOD_AUTO = 0,          /* what is fastest within the error budget: LOD mesh or cast */
    GTX_METHOD_CAST = 1,          /* exact: cells walked, bilinear patches solved */
    GTX_METHOD_PAPER = 2,         /* linear then binary search, balanced by slant (paper, 4.1) */
    GTX_METHOD_LOD = 3            /* polygons of an LOD mesh, which the asset must have */
} gtx_method;

/* What a draw writes, besides depth: location, what. The programs of the forward pass are compiled
 * with the renderer, those of another by the first draw in it; one of no instances will do. */
typedef enum gtx_pass {
    GTX_PASS_FORWARD = 0,         /* 0: lit colour, in sRGB bytes */
    GTX_PASS_DEPTH = 1,           /* nothing, colour is masked: the same depth, bit for bit; for
                                     shadow maps, whose height viewport_height then is */
    GTX_PASS_ID = 2,              /* 0, unsigned integers (RGBA32UI, or RG32UI for the first two):
                                     the instance's id, the patch, and the texel at the low corner
                                     of the cell in it: x, y */
    GTX_PASS_GBUFFER = 3          /* 0: albedo in sRGB bytes, alpha (RGBA8); 1: world-space normal
                                     * 0.5 + 0.5 (RGB10_A2 or finer); 2: occlusion, roughness,
                                     metallic, lit (RGBA8; 1, 1, 0, 1 without a material);
                                     3: linear emission (R11F_G11F_B10F). Any may be left out */
} gtx_pass;

/* An engine's own fragment main, which finds the surface by a call and does as it likes with it. */
typedef struct gtx_shading gtx_shading;

/* `text` is GLSL that follows geotex_fragment.glsl, which says what there is to call; for LOD
 * meshes it follows geotex_lod_fragment.glsl, with GTX_LOD defined. geotex_material.glsl comes
 * before, and geotex_rays.glsl, whose rays gtx_rays_bind provides. It has no #version, its samplers
 * begin at unit 8, and it is not kept. The shading is of the renderer's allocator, freed by
 * gtx_shading_destroy. Errors: ARGUMENT, MEMORY, SHADER (the renderer's log says why). */
GTX_API gtx_result gtx_shading_create(gtx_renderer *renderer, const char *text, gtx_shading **out,
                                      gtx_error *error);
/* A NULL shading is fine. */
GTX_API void gtx_shading_destroy(gtx_renderer *renderer, gtx_shading *shading);
/* The name of its program that casts, or with GTX_METHOD_LOD of the one that draws LOD meshes, to
 * set uniforms of its own between draws. */
GTX_API uint32_t gtx_shading_program(const gtx_shading *shading, gtx_method method);

enum { /* gtx_view.flags */
    GTX_VIEW_REVERSED_Z = 1,          /* nearer is greater: depth func GREATER */
    GTX_VIEW_DEPTH_ZERO_TO_ONE = 2,   /* clip z in 0..1 (glClipControl), not -1..1 */
    GTX_VIEW_RESTORE_STATE = 4        /* read the touched state first and put it back */
};

/* One camera and one light.
 *
 * Level of detail. Each patch of an instance is cast at the coarsest level of its height field
 * whose distance from level 0, measured by gtx_model_prepare, is at most `max_error` pixels at the
 * point of the patch's sphere that is nearest to the camera. Coverage only grows from level to
 * level, and neighbours of different levels meet within that error. Pixels are square.
 * GTX_METHOD_PAPER always draws level 0.
 *
 * The LOD mesh. GTX_METHOD_LOD draws an instance as the coarsest LOD mesh whose error is
 * at most `max_error` pixels where the asset's bounds are nearest to the camera, or as the finest
 * when there is none; `level` counts LOD meshes. It writes no depth of its own, so that
 * the depth test comes first and multisampling smooths its edges; `viewport_height` also tells the
 * mip level of its maps. GTX_METHOD_AUTO draws the same level if there is one within the error, or
 * else the finest if that is within one and a half times the error, if gtx_costs has it for
 * cheaper, and casts otherwise, as it does when `viewport_height` is unknown or `level` given.
 * Patches taken by gtx_model_update are cast from then on, by either method. */
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
    uint32_t viewport_width;          /* pixels; 0 = unknown. Given, this and viewport_height
                                         are the size of glViewport: see gtx_tiling */
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

/* Draws the instances into the bound framebuffer, which has a depth buffer: what view->pass says,
 * and depth. In the forward pass a model with materials or emission is shaded by metallic-roughness
 * (glTF 2.0, appendix B), another by Lambert. An instance that is cast is drawn patch by patch,
 * nearest first, those out of view left out; of a run of instances of one model those far away are
 * one instanced draw, as are runs that are not cast. Room for the most instances and patches so far
 * is kept, of the renderer's allocator, until gtx_renderer_destroy.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL, SHADER (a pass's first draw), UNSUPPORTED
 * (GTX_METHOD_LOD, and an asset without). */
GTX_API gtx_result gtx_draw(gtx_renderer *renderer, const gtx_view *view,
                            const gtx_instance *instances, uint32_t count, gtx_error *error);

/* ---- rays in shaders --------------------------------------------------------------------- */

/* The patches of some assets where any shader can cast rays at them: heights and outlines in
 * textures of their own (5 bytes a texel, 9 with 16-bit heights), a hierarchy over blocks of their
 * cells, and one over their instances above it. geotex_rays.glsl says what there is to call:
 * shadows, hard and soft, and ambient occlusion across all patches of all instances. It needs no
 * more than OpenGL 3.3 or OpenGL ES 3.0, and is part of every gtx_shading. Height fields are those
 * of level 0. */
typedef struct gtx_rays gtx_rays;

typedef struct gtx_rays_desc {
    const gtx_asset *const *assets;   /* not kept */
    uint32_t asset_count;
    uint32_t max_instances;           /* up to 2^20 */
    uint32_t reserved[4];
} gtx_rays_desc;

/* Derives and uploads; no instance is placed yet. Of the renderer's allocator, freed by
 * gtx_rays_destroy. State is left as by gtx_model_upload.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (texture size), GL (out of memory). */
GTX_API gtx_result gtx_rays_create(gtx_renderer *renderer, const gtx_rays_desc *desc,
                                   gtx_rays **out, gtx_error *error);
/* NULL rays are fine. */
GTX_API void gtx_rays_destroy(gtx_renderer *renderer, gtx_rays *rays);

/* `asset` counts those of the descriptor; `transform` as in gtx_instance. */
typedef struct gtx_ray_instance {
    uint32_t asset;
    float transform[16];
} gtx_ray_instance;

/* Puts these instances in place of those before, as often as they move; their hierarchy is built
 * anew. State is left as by gtx_model_upload. Errors: ARGUMENT, MEMORY (nothing has moved). */
GTX_API gtx_result gtx_rays_place(gtx_renderer *renderer, gtx_rays *rays,
                                  const gtx_ray_instance *instances, uint32_t count,
                                  gtx_error *error);

/* Takes one patch from an edited asset, which has the rectangles of number `asset` of the
 * descriptor and is not kept: as gtx_model_update, a call for each. Rays meet what was taken,
 * whole, from the next gtx_rays_place on, which builds that asset's hierarchy anew. State is left
 * as by gtx_model_upload. Errors: ARGUMENT, MEMORY (nothing has changed). */
GTX_API gtx_result gtx_rays_update(gtx_renderer *renderer, gtx_rays *rays, uint32_t asset,
                                   const gtx_asset *edited, uint32_t patch, gtx_error *error);

/* Binds the textures to units 13, 14 and 15, where gtx_draw leaves them, and tells the program, a
 * shading's or one of the engine's own that includes geotex_rays.glsl; 0 binds alone. Leaves the
 * active unit 0, program 0 when one was told. NULL rays bind nothing: then nothing occludes. */
GTX_API void gtx_rays_bind(gtx_renderer *renderer, const gtx_rays *rays, uint32_t program);

/* The text of an installed shader file such as "geotex_cast.glsl", for engines that write their
 * own mains; NULL when there is none of that name. Static storage. */
GTX_API const char *gtx_shader_source(const char *name);

#ifdef __cplusplus
}
#endif
#endif
