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
 * With OpenGL also, where rays are cast by tiles (gtx_tiling): buffer texture 0 on unit 8.
 * It does not touch the framebuffer binding, viewport, scissor, stencil or clip control.
 *
 * OpenGL ES is recognised by its version string; there is nothing to set. It encodes what is
 * written to an sRGB framebuffer, so bind another kind: colours are sRGB bytes already. Before ES
 * 3.2, GTX_VIEW_RESTORE_STATE assumes that blending and colour mask are equal on all draw buffers.
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

/* What drawing costs, for GTX_METHOD_AUTO to compare: a triangle of an LOD mesh and a pixel that it
 * covers; a patch that is cast and a pixel that its proxy covers; a triangle of a displaced grid,
 * whose pixels cost what those of LOD meshes do. In any unit; all 0 = as measured with llvmpipe, on
 * which only the finer LOD meshes may cost more than casting. */
typedef struct gtx_costs {
    float lod_triangle, lod_pixel;
    float cast_patch, cast_pixel;
    float grid_triangle;          /* 0 = twice lod_triangle */
} gtx_costs;

/* Casting by tiles: for each tile of 4 x 4 pixels the patches of an instance that may cover it are
 * listed, nearest first, and each pixel casts one ray, which stops at the nearest hit. It applies
 * to what GTX_METHOD_CAST and AUTO cast in views that give viewport_width, one instance at a time,
 * in every pass, but not with an engine's own shading. Everything else, and all of OpenGL ES, is
 * cast in the fragments of proxies. */
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
    gtx_costs costs;                                     /* finite, none below 0 */
    gtx_tiling tiles;
    uint32_t reserved[3];
} gtx_renderer_desc;

/* The context must be current, here and in all functions that take a renderer. Leaves program 0,
 * vertex array 0 and array buffer 0. The renderer comes from the descriptor's allocator, and is
 * freed by gtx_renderer_destroy.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL (a function or version is missing), SHADER. */
GTX_API gtx_result gtx_renderer_create(const gtx_renderer_desc *desc, gtx_renderer **out,
                                       gtx_error *error);
/* Frees the renderer and its GL objects; destroy its models, shadings and rays first. NULL
 * is fine. */
GTX_API void gtx_renderer_destroy(gtx_renderer *renderer);

typedef struct gtx_model_desc {
    const gtx_allocator *allocator;   /* of the model; NULL = malloc */
    const gtx_jobs *jobs;             /* used during the call; may be NULL */
    uint32_t borrow;                  /* 1: maps are not copied; the asset must stay open until the
                                         model is uploaded or destroyed */
    gtx_limits limits;                /* memory, until the upload, and cells */
    uint32_t reserved[4];
} gtx_model_desc;

/* Derives what the GPU needs, without GL: any thread. Keeps no reference to the asset unless it
 * borrows its maps. `desc` may be NULL. The model comes from the descriptor's allocator, and is
 * freed by gtx_model_destroy, most of it already by the upload. Errors: ARGUMENT, NOT_ZEROED,
 * MEMORY, LIMIT. */
GTX_API gtx_result gtx_model_prepare(const gtx_asset *asset, const gtx_model_desc *desc,
                                     gtx_model **out, gtx_error *error);

/* Uploads up to `max_bytes` (0 = everything) and sets *done to 1 once the model can be drawn.
 * Leaves texture unit 0 active without a 2D or 2D array texture, array and pixel unpack buffers 0,
 * and pixel unpacking at its defaults. A call sends at most one row of a map more than `max_bytes`.
 * Errors: ARGUMENT, LIMIT (texture size), GL (out of memory: what was sent is freed, and the next
 * call starts over). */
GTX_API gtx_result gtx_model_upload(gtx_renderer *renderer, gtx_model *model, uint64_t max_bytes,
                                    uint32_t *done, gtx_error *error);

/* Prepares and uploads in one call, with the renderer's allocator and jobs; gtx_model_destroy frees
 * the model, and the defaults of limits. Errors: as gtx_model_prepare and gtx_model_upload. */
GTX_API gtx_result gtx_model_create(gtx_renderer *renderer, const gtx_asset *asset,
                                    gtx_model **out, gtx_error *error);

/* Takes one patch from an edited asset: its maps at all levels, and the record, bounds and proxies
 * derived from them. `edited` has the pages, maps and rectangles of the asset that the model was
 * made from, and is not kept. State is left as by gtx_model_upload. Call it for each edited patch;
 * the model is consistent again after the last. Works in memory of the model's allocator.
 * Errors: ARGUMENT, MEMORY (nothing has changed), GL (out of memory). */
GTX_API gtx_result gtx_model_update(gtx_renderer *renderer, gtx_model *model,
                                    const gtx_asset *edited, uint32_t patch, gtx_error *error);

/* Frees the model and its GL objects. `renderer` may be NULL for a model that was never uploaded. A
 * NULL model is fine. */
GTX_API void gtx_model_destroy(gtx_renderer *renderer, gtx_model *model);

/* Bytes of the model's textures and buffers on the GPU; `color` is colour, material, emission. */
typedef struct gtx_model_size {
    uint64_t geometry, color;
} gtx_model_size;
/* Known from gtx_model_prepare on; zeros for NULL. */
GTX_API gtx_model_size gtx_model_gpu_size(const gtx_model *model);

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
    GTX_PASS_FORWARD = 0,         /* 0: lit colour, in sRGB bytes */
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

/* `text` is GLSL that is put behind geotex_fragment.glsl, which says what there is to call, and for
 * LOD meshes and displaced grids behind geotex_lod_fragment.glsl, with GTX_LOD defined.
 * geotex_material.glsl and geotex_rays.glsl are there too; the rays are those of gtx_rays_bind.
 * `text` has no #version, its samplers start at unit 8, and it is not kept. The shading comes from
 * the renderer's allocator, and is freed by gtx_shading_destroy.
 * Errors: ARGUMENT, MEMORY, SHADER (the renderer's log says why). */
GTX_API gtx_result gtx_shading_create(gtx_renderer *renderer, const char *text, gtx_shading **out,
                                      gtx_error *error);
/* A NULL shading is fine. */
GTX_API void gtx_shading_destroy(gtx_renderer *renderer, gtx_shading *shading);
/* The GL name of its program that casts, or with GTX_METHOD_LOD and GTX_METHOD_GRID of those that
 * draw LOD meshes and displaced grids, for setting the engine's own uniforms between draws: AUTO
 * takes all three. */
GTX_API uint32_t gtx_shading_program(const gtx_shading *shading, gtx_method method);

enum { /* gtx_view.flags */
    GTX_VIEW_REVERSED_Z = 1,          /* nearer is greater: depth func GREATER */
    GTX_VIEW_DEPTH_ZERO_TO_ONE = 2,   /* clip z in 0..1 (glClipControl), not -1..1 */
    GTX_VIEW_RESTORE_STATE = 4        /* read the touched state first and put it back */
};

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
 * maps. GTX_METHOD_AUTO takes the same LOD mesh, or the finest one if its error is at most 1.5
 * times the allowed one, and draws it unless casting costs less (gtx_costs).
 *
 * Patch by patch. If none is fine enough for all of an instance, or part of it is beside the
 * picture, AUTO draws each patch in view by the coarsest LOD mesh that is fine enough where the
 * patch is nearest, or else as a displaced grid or cast, whichever costs less. Where ways meet, the
 * coarser goes on beneath the finer by a ring of triangles. It casts if `viewport_height` is
 * unknown, or if `level` is given. With AUTO and LOD patches taken by gtx_model_update have no LOD
 * mesh from then on.
 *
 * Displaced grids. GTX_METHOD_GRID draws height fields as right triangles over cells of level 0,
 * from two over 8 x 8 cells to two over each: halved until they keep to max_error where they are,
 * and to a fourth of it at outlines, where neighbours meet; `level` n says two over squares of
 * 2^(n - 1) cells. They are found anew in each draw, a few ten nanoseconds each. Blocks of 8 x 8
 * cells that are out of view, and triangles that face away, are not drawn. They write no depth of
 * their own. */
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

/* Draws the instances into the bound framebuffer, which must have a depth buffer: writes depth and
 * what view->pass says. In the forward pass a model with materials or emission is shaded by
 * metallic-roughness (glTF 2.0, appendix B), any other by Lambert. A near instance is cast patch by
 * patch, nearest first, without those out of view. In a run of instances of one model, those far
 * away are one instanced draw, and so are those drawn by LOD meshes. Room for the largest number of
 * instances and patches so far is kept in the renderer's allocator until gtx_renderer_destroy.
 *
 * What a frame costs. By tiles a pixel visits at most gtx_ray_cells of each instance over it; so it
 * does in fragments of patches that are cast by their boxes, those near the camera and those with
 * more than 512 texels a side. Hulls cast anew from each front face that a ray passes, and visit no
 * more than width + height of the patch: most rays pass one face, but one that skims a patch may
 * pass a face for each 16 of the cells along it. The paper's search takes its steps in each patch
 * over a pixel. A pixel also tests each slab that its tile lists: all lists have at most 64 entries
 * for each tile of the viewport and 8 for each slab in view, or it is cast in fragments.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL, SHADER (a pass's first draw), UNSUPPORTED
 * (GTX_METHOD_LOD with an asset that has no LOD mesh). */
GTX_API gtx_result gtx_draw(gtx_renderer *renderer, const gtx_view *view,
                            const gtx_instance *instances, uint32_t count, gtx_error *error);

/* ---- rays in shaders --------------------------------------------------------------------- */

/* The patches of several assets, stored so that any shader can cast rays into them: heights and
 * outlines in textures of their own (5 bytes per texel, 9 with 16-bit heights), a hierarchy over
 * blocks of their cells, and above it one over their instances. geotex_rays.glsl says what there is
 * to call: hard and soft shadows and ambient occlusion across all patches of all instances. It
 * needs no more than OpenGL 3.3 or OpenGL ES 3.0, and is part of every gtx_shading. Height fields
 * are cast at level 0. */
typedef struct gtx_rays gtx_rays;

typedef struct gtx_rays_desc {
    const gtx_asset *const *assets;   /* not kept */
    uint32_t asset_count;
    uint32_t max_instances;           /* up to 2^20 */
    gtx_limits limits;                /* memory of all, cells of each asset */
    uint32_t reserved[4];
} gtx_rays_desc;

/* Derives and uploads; no instance is placed yet. The rays come from the renderer's allocator, and
 * are freed by gtx_rays_destroy. State is left as by gtx_model_upload.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (limits, texture size), GL (out of memory). */
GTX_API gtx_result gtx_rays_create(gtx_renderer *renderer, const gtx_rays_desc *desc,
                                   gtx_rays **out, gtx_error *error);
/* NULL rays are fine. */
GTX_API void gtx_rays_destroy(gtx_renderer *renderer, gtx_rays *rays);

/* `asset` is an index into gtx_rays_desc.assets; `transform` is as in gtx_instance. */
typedef struct gtx_ray_instance {
    uint32_t asset;
    float transform[16];
} gtx_ray_instance;

/* Replaces all instances, as often as they move; their hierarchy is rebuilt. State is left as by
 * gtx_model_upload. Errors: ARGUMENT, MEMORY (nothing has moved). */
GTX_API gtx_result gtx_rays_place(gtx_renderer *renderer, gtx_rays *rays,
                                  const gtx_ray_instance *instances, uint32_t count,
                                  gtx_error *error);

/* Takes one patch from an edited asset, like gtx_model_update: call it for each. `edited` has the
 * rectangles of assets[asset] of the descriptor, and is not kept. Rays meet the new patches from
 * the next gtx_rays_place on, which rebuilds that asset's hierarchy. State is left as by
 * gtx_model_upload. Errors: ARGUMENT, MEMORY (nothing has changed). */
GTX_API gtx_result gtx_rays_update(gtx_renderer *renderer, gtx_rays *rays, uint32_t asset,
                                   const gtx_asset *edited, uint32_t patch, gtx_error *error);

/* Binds the textures to units 13, 14 and 15, which gtx_draw does not touch, and sets the uniforms
 * of `program`: a shading's, or one of the engine's own that includes geotex_rays.glsl; 0 only
 * binds. Leaves unit 0 active, and program 0 if one was given. NULL rays bind nothing: then nothing
 * occludes. */
GTX_API void gtx_rays_bind(gtx_renderer *renderer, const gtx_rays *rays, uint32_t program);

/* The text of an installed shader file such as "geotex_cast.glsl", for engines that write their own
 * mains; its first lines say which files come before it. NULL if there is none of that name. Static
 * storage. Any thread. */
GTX_API const char *gtx_shader_source(const char *name);

#ifdef __cplusplus
}
#endif
#endif
