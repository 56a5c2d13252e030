/* Rays in shaders, whatever graphics interface casts them. render.h has them in OpenGL, vulkan.h in
 * Vulkan. An engine that submits frames itself (frame.h) creates their textures, for bindings 13 to
 * 15, and copies texels, and again what gtx_rays_arrange replaces when instances move:
 *
 *     gtx_rays_prepare(&desc, &rays, &error);                        any thread
 *     gtx_rays_texture                                               create, and copy
 *     gtx_rays_uploaded(rays);                                       frees what was copied
 *     gtx_rays_arrange(rays, instances, count, &sink, &error);       as often as they move
 *
 * The rules of geotex.h hold here too. */
#ifndef GEOTEX_RAYS_H
#define GEOTEX_RAYS_H

#include <geotex/frame.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The patches of several assets, stored so that any shader can cast rays into them: heights and
 * outlines in textures of their own (5 bytes per texel, 9 with 16-bit heights), a hierarchy over
 * blocks of their cells, and above it one over their instances. geotex_rays.glsl says what there is
 * to call: hard and soft shadows and ambient occlusion across all patches of all instances. It
 * needs no more than OpenGL 3.3, OpenGL ES 3.0 or Vulkan 1.0, and is part of every fragment main of
 * an engine's own. Height fields are cast at level 0. */
typedef struct gtx_rays gtx_rays;

/* Their textures: nodes, cells, outlines; at these bindings in shaders. */
enum { GTX_RAYS_BINDING = 13, GTX_RAYS_TEXTURES = 3 };

typedef struct gtx_rays_desc {
    const gtx_asset *const *assets;   /* not kept */
    uint32_t asset_count;
    uint32_t max_instances;           /* up to 2^20 */
    gtx_limits limits;                /* memory of all, cells of each asset */
    const gtx_allocator *allocator;   /* NULL = malloc; with gtx_rays_create, the renderer's */
    uint32_t reserved[4];
} gtx_rays_desc;

/* `asset` is an index into gtx_rays_desc.assets; `transform` is as in gtx_instance. */
typedef struct gtx_ray_instance {
    uint32_t asset;
    float transform[16];
} gtx_ray_instance;

/* Derives them, without a graphics interface: any thread. No instance is placed yet, and
 * gtx_rays_arrange must come before shaders read what is uploaded. Freed by gtx_rays_free. Errors:
 * ARGUMENT, NOT_ZEROED, MEMORY, LIMIT. */
GTX_API gtx_result gtx_rays_prepare(const gtx_rays_desc *desc, gtx_rays **out, gtx_error *error);
/* `which` is below GTX_RAYS_TEXTURES; else it is false, and zeros. Read by texel alone. The first
 * one has no texels yet. */
GTX_API uint32_t gtx_rays_texture(const gtx_rays *rays, uint32_t which, gtx_texture *out);
/* Says that all is copied: frees it. */
GTX_API void gtx_rays_uploaded(gtx_rays *rays);
/* Of what no renderer of render.h has created. NULL is fine. */
GTX_API void gtx_rays_free(gtx_rays *rays);

/* Replaces all instances, as often as they move; their hierarchy is rebuilt. Only sink->texels is
 * called. Errors: ARGUMENT, MEMORY: nothing has moved. */
GTX_API gtx_result gtx_rays_arrange(gtx_rays *rays, const gtx_ray_instance *instances,
                                    uint32_t count, const gtx_sink *sink, gtx_error *error);
/* Takes one patch from an edited asset, like gtx_model_edit: call it for each. `edited` has the
 * rectangles of assets[asset] of the descriptor, and is not kept. Rays meet the new patches from
 * the next gtx_rays_arrange on, which rebuilds that asset's hierarchy. Errors: ARGUMENT, MEMORY:
 * nothing has changed. */
GTX_API gtx_result gtx_rays_edit(gtx_rays *rays, uint32_t asset, const gtx_asset *edited,
                                 uint32_t patch, const gtx_sink *sink, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
