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
 * With GTX_VIEW_BY_SAMPLES: sample shading off; its minimum fraction is 1, and is not restored.
 * It does not touch the framebuffer binding, viewport, scissor, stencil or clip control.
 *
 * OpenGL ES is recognised by its version string; there is nothing to set. ES always encodes what is
 * written to an sRGB framebuffer, and stock colours are sRGB already: bind another kind of
 * framebuffer, or set GTX_VIEW_LINEAR. Before ES 3.2, GTX_VIEW_RESTORE_STATE assumes that blending
 * and colour mask are equal on all draw buffers.
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
    void (*log)(const char *message, void *user);        /* shader logs, and a line about the
                                                            context; may be NULL */
    void *log_user;
    const gtx_allocator *allocator;
    const gtx_jobs *jobs;                                /* for gtx_model_create; copied; may be
                                                            NULL */
    gtx_costs costs;                                     /* finite, none below 0 */
    gtx_tiling tiles;
    uint32_t compress;        /* 1: gtx_model_create compresses, by gtx_renderer_compression */
    uint32_t reserved[2];
} gtx_renderer_desc;

/* Makes a renderer. The context must be current, here and in all functions that take a renderer.
 * Leaves program 0, vertex array 0 and array buffer 0 bound. The renderer is allocated from the
 * descriptor's allocator; free it with gtx_renderer_destroy.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL (a function or version is missing), SHADER. */
GTX_API gtx_result gtx_renderer_create(const gtx_renderer_desc *desc, gtx_renderer **out,
                                       gtx_error *error);
/* Frees the renderer and its GL objects; destroy its models, shadings and rays first. NULL
 * is fine. */
GTX_API void gtx_renderer_destroy(gtx_renderer *renderer);

/* The block compression that the context supports, for gtx_model_desc.compress: BC with OpenGL 4.2
 * or the extensions, else ETC2 with OpenGL ES 3.0, else NONE. */
GTX_API gtx_compression gtx_renderer_compression(const gtx_renderer *renderer);

/* Uploads up to `max_bytes` (0 = everything), or at most one row of a map more, and sets *done to 1
 * once the model can be drawn. Leaves texture unit 0 active with 2D and 2D array textures 0, array
 * and pixel unpack buffers 0, and pixel unpacking at its defaults.
 * Errors: ARGUMENT, LIMIT (texture size), UNSUPPORTED (a block compression that the context does
 * not support), GL (out of memory: the upload is undone, and the next call starts over). */
GTX_API gtx_result gtx_model_upload(gtx_renderer *renderer, gtx_model *model, uint64_t max_bytes,
                                    uint32_t *done, gtx_error *error);

/* gtx_model_prepare and gtx_model_upload in one call, with the renderer's allocator and jobs and
 * the default limits; free the model with gtx_model_destroy. Errors: as both. */
GTX_API gtx_result gtx_model_create(gtx_renderer *renderer, const gtx_asset *asset,
                                    gtx_model **out, gtx_error *error);

/* Updates one patch from an edited asset: its maps at all levels, and the record, bounds and
 * proxies derived from them. `edited` must have the pages, maps and rectangles of the asset that
 * the model was made from; no reference to it is kept. State is left as by gtx_model_upload. Call
 * it for each edited patch; the model is consistent again after the last. Allocates from the
 * model's allocator.
 * Errors: ARGUMENT, MEMORY (the model is unchanged), GL (out of memory). */
GTX_API gtx_result gtx_model_update(gtx_renderer *renderer, gtx_model *model,
                                    const gtx_asset *edited, uint32_t patch, gtx_error *error);

/* Frees the model and its GL objects. `renderer` may be NULL for a model that was never uploaded. A
 * NULL model is fine. */
GTX_API void gtx_model_destroy(gtx_renderer *renderer, gtx_model *model);

/* Compiles an engine's own fragment main. `text` is GLSL that is compiled after
 * geotex_fragment.glsl, which declares the functions to call, and for LOD meshes and displaced
 * grids after geotex_lod_fragment.glsl, with GTX_LOD defined. geotex_material.glsl and
 * geotex_rays.glsl (see gtx_rays_bind) are included too. `text` must have no #version, may use
 * texture units 8 to 12 for its samplers, and is not kept. A line `#pragma geotex tiles` promises
 * that it gets everything about a fragment from geotex's functions; only then is it cast by tiles,
 * where the renderer does so and the view asks for it (GTX_VIEW_SHADING_BY_TILES). A line `#pragma
 * geotex vertices` promises that the main discards nothing that is found and that, where
 * GTX_OWN_VERTICES is defined, the text is `vec4 gtx_at_vertex(vec3 point, vec3 normal, vec3 eye,
 * vec4 albedo, float deviation)` and what that calls, which gives what the main writes (all in
 * world space; `normal` is turned to the eye, which is a unit vector, and `deviation` that of a
 * gtx_surface): LOD meshes that have normals, and fine or even triangles of displaced grids, are
 * then shaded at their vertices, in the vertex shader, where a model has no materials. Compilers'
 * messages number its lines from 1, as string 1. The shading is allocated from the renderer's
 * allocator; free it with gtx_shading_destroy.
 * Errors: ARGUMENT, MEMORY, SHADER (the renderer's log says why). */
GTX_API gtx_result gtx_shading_create(gtx_renderer *renderer, const char *text, gtx_shading **out,
                                      gtx_error *error);
/* A NULL shading is fine. */
GTX_API void gtx_shading_destroy(gtx_renderer *renderer, gtx_shading *shading);
/* The GL names of the shading's programs, one for each way in which something is drawn, for setting
 * the engine's own uniforms between draws: in all of them. The first is that which casts in
 * fragments. Returns how many they are. */
enum { GTX_SHADING_PROGRAMS = 10 };
GTX_API uint32_t gtx_shading_programs(const gtx_shading *shading,
                                      uint32_t out[GTX_SHADING_PROGRAMS]);

/* Draws the instances into the bound framebuffer, which must have a depth buffer: writes depth and
 * the outputs of view->pass. In the forward pass a model with materials or emission is shaded by
 * metallic-roughness (glTF 2.0, appendix B), any other by Lambert. A near instance is drawn patch
 * by patch, nearest first, without patches out of view. Successive instances of one model that are
 * far away are one instanced draw, and so are those drawn by LOD meshes. Memory for the largest
 * number of instances and patches so far is kept until gtx_renderer_destroy.
 *
 * What a frame costs. By tiles, a pixel visits at most gtx_ray_cells of each instance over it. The
 * same holds for patches that are cast from boxes: those near the camera, and those with more than
 * 512 texels along a side. From hulls, each front face that a ray passes starts a cast of at most
 * width + height cells of the patch: most rays pass one face, but one that skims a patch may pass a
 * face per 16 cells along it. The paper's search takes its steps in each patch over a pixel. A
 * pixel also tests each slab in its tile's list; if the lists of an instance would have more
 * entries than 64 per tile of the viewport plus 8 per slab in view, it is cast in fragments
 * instead.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL, SHADER (a pass's first draw), UNSUPPORTED
 * (GTX_METHOD_LOD with an asset that has no LOD mesh). */
GTX_API gtx_result gtx_draw(gtx_renderer *renderer, const gtx_view *view,
                            const gtx_instance *instances, uint32_t count, gtx_error *error);

/* ---- rays in shaders --------------------------------------------------------------------- */

/* Derives and uploads the gtx_rays of rays.h; there are no instances yet. They are allocated from
 * the descriptor's allocator, or else the renderer's; free them with gtx_rays_destroy. State is
 * left as by gtx_model_upload.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (limits, texture size), GL (out of memory). */
GTX_API gtx_result gtx_rays_create(gtx_renderer *renderer, const gtx_rays_desc *desc,
                                   gtx_rays **out, gtx_error *error);
/* NULL rays are fine. */
GTX_API void gtx_rays_destroy(gtx_renderer *renderer, gtx_rays *rays);

/* Replaces all instances and rebuilds their hierarchy: call it whenever some have moved. State is
 * left as by gtx_model_upload. Errors: ARGUMENT, MEMORY; nothing is changed then. */
GTX_API gtx_result gtx_rays_place(gtx_renderer *renderer, gtx_rays *rays,
                                  const gtx_ray_instance *instances, uint32_t count,
                                  gtx_error *error);

/* Updates one patch from an edited asset, like gtx_model_update: call it for each. `edited` must
 * have the rectangles of assets[asset] of the descriptor; no reference to it is kept. Rays see the
 * new patches from the next gtx_rays_place on, which rebuilds that asset's hierarchy. State is left
 * as by gtx_model_upload. Errors: ARGUMENT, MEMORY; nothing is changed then. */
GTX_API gtx_result gtx_rays_update(gtx_renderer *renderer, gtx_rays *rays, uint32_t asset,
                                   const gtx_asset *edited, uint32_t patch, gtx_error *error);

/* Binds the textures to units 13, 14 and 15, which gtx_draw does not touch, and sets the uniforms
 * of `program`: a shading's, or one of the engine's own that includes geotex_rays.glsl; 0 only
 * binds. Leaves unit 0 active, and program 0 current if one was given. With NULL rays nothing is
 * bound, and nothing occludes. */
GTX_API void gtx_rays_bind(gtx_renderer *renderer, const gtx_rays *rays, uint32_t program);

#ifdef __cplusplus
}
#endif
#endif
