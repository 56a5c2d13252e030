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
 * With OpenGL also, where rays are cast by tiles (gtx_tiling): buffer texture 0 on unit 16.
 * With GTX_VIEW_BY_SAMPLES: sample shading off, and its least share 1, which is not restored.
 * It does not touch the framebuffer binding, viewport, scissor, stencil or clip control.
 *
 * OpenGL ES is recognised by its version string; there is nothing to set. It encodes what is
 * written to an sRGB framebuffer, so bind another kind, or set GTX_VIEW_LINEAR: colours are sRGB
 * bytes already. Before ES
 * 3.2, GTX_VIEW_RESTORE_STATE assumes that blending and colour mask are equal on all draw buffers.
 *
 * Where the context has KHR_debug, every object carries a label and a draw is a debug group. */
#ifndef GEOTEX_RENDER_H
#define GEOTEX_RENDER_H

#include <geotex/rays.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A renderer: programs and shared objects of one context (or share group). */
typedef struct gtx_renderer gtx_renderer;

typedef void (*gtx_gl_proc)(void);

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
    uint32_t compress;        /* 1: gtx_model_create compresses, as gtx_renderer_compression says */
    uint32_t reserved[2];
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

/* The blocks that the context reads: BC with OpenGL 4.2 or its extensions, ETC2 with OpenGL ES 3.0
 * else. For gtx_model_desc.compress. */
GTX_API gtx_compression gtx_renderer_compression(const gtx_renderer *renderer);

/* Uploads up to `max_bytes` (0 = everything) and sets *done to 1 once the model can be drawn.
 * Leaves texture unit 0 active without a 2D or 2D array texture, array and pixel unpack buffers 0,
 * and pixel unpacking at its defaults. A call sends at most one row of a map more than `max_bytes`.
 * Errors: ARGUMENT, LIMIT (texture size), UNSUPPORTED (blocks that the context does not read), GL
 * (out of memory: what was sent is freed, and the next call starts over). */
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

/* `text` is GLSL that is put behind geotex_fragment.glsl, which says what there is to call, and for
 * LOD meshes and displaced grids behind geotex_lod_fragment.glsl, with GTX_LOD defined.
 * geotex_material.glsl and geotex_rays.glsl are there too; the rays are those of gtx_rays_bind.
 * `text` has no #version, its samplers have units 8 to 12, and it is not kept. Compilers count
 * its lines from 1, in string 1 where they tell strings apart. The shading comes from the
 * renderer's allocator, and is freed by gtx_shading_destroy.
 * Errors: ARGUMENT, MEMORY, SHADER (the renderer's log says why). */
GTX_API gtx_result gtx_shading_create(gtx_renderer *renderer, const char *text, gtx_shading **out,
                                      gtx_error *error);
/* A NULL shading is fine. */
GTX_API void gtx_shading_destroy(gtx_renderer *renderer, gtx_shading *shading);
/* The GL name of its program that casts, or with GTX_METHOD_LOD and GTX_METHOD_GRID of those that
 * draw LOD meshes and displaced grids, for setting the engine's own uniforms between draws: AUTO
 * takes all three. */
GTX_API uint32_t gtx_shading_program(const gtx_shading *shading, gtx_method method);
/* The same of its program that casts by tiles, which GTX_VIEW_SHADING_BY_TILES asks for: made
 * where the text has the line `#pragma geotex tiles`, which says that it takes what it knows of a
 * fragment from functions alone. 0 elsewhere, and where the renderer has no tiles. */
GTX_API uint32_t gtx_shading_tile_program(const gtx_shading *shading);

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

/* The gtx_rays of rays.h, derived and uploaded; no instance is placed yet. The rays come from the
 * descriptor's allocator, or else the renderer's, and are freed by gtx_rays_destroy. They are part
 * of every gtx_shading. State is left as by gtx_model_upload.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (limits, texture size), GL (out of memory). */
GTX_API gtx_result gtx_rays_create(gtx_renderer *renderer, const gtx_rays_desc *desc,
                                   gtx_rays **out, gtx_error *error);
/* NULL rays are fine. */
GTX_API void gtx_rays_destroy(gtx_renderer *renderer, gtx_rays *rays);

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

#ifdef __cplusplus
}
#endif
#endif
