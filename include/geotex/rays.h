/* Rays in shaders without a graphics API; render.h has them in OpenGL, vulkan.h in Vulkan. An
 * engine that submits frames itself (frame.h) creates their textures, for bindings 13 to 15, copies
 * their texels, and copies again what gtx_rays_arrange replaces when instances move:
 *
 *     gtx_rays_prepare(&desc, &rays, &error);                        any thread
 *     gtx_rays_texture                                               create, and copy
 *     gtx_rays_uploaded(rays);                                       frees what was copied
 *     gtx_rays_arrange(rays, instances, count, &sink, &error);       as often as they move
 *
 * The rules of geotex.h apply here too. */
#ifndef GEOTEX_RAYS_H
#define GEOTEX_RAYS_H

#include <geotex/frame.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The patches of several assets, stored so that any shader can cast rays into them: heights and
 * outlines in textures of their own (5 bytes per texel, 9 with 16-bit heights), a hierarchy over
 * blocks of cells per asset, and one over the instances. geotex_rays.glsl declares the functions:
 * hard and soft shadows and ambient occlusion across all patches of all instances. It needs OpenGL
 * 3.3, OpenGL ES 3.0 or Vulkan 1.0, and is included in every gtx_shading. Height fields are cast at
 * level 0. */
typedef struct gtx_rays gtx_rays;

/* Their textures, nodes, cells and outlines, at bindings 13, 14 and 15. */
enum { GTX_RAYS_BINDING = 13, GTX_RAYS_TEXTURES = 3 };

typedef struct gtx_rays_desc {
    const gtx_asset *const *assets;   /* not kept */
    uint32_t asset_count;
    uint32_t max_instances;           /* up to 2^20 */
    gtx_limits limits;                /* of memory of all assets, of cells of each */
    const gtx_allocator *allocator;   /* NULL = malloc; with gtx_rays_create, the renderer's */
    uint32_t reserved[4];
} gtx_rays_desc;

/* An asset placed in the world: an index into gtx_rays_desc.assets; `transform` as in
 * gtx_instance. */
typedef struct gtx_ray_instance {
    uint32_t asset;
    float transform[16];
} gtx_ray_instance;

/* Derives the textures, without calling a graphics API: any thread. There are no instances yet;
 * call gtx_rays_arrange before shaders read the textures. Free with gtx_rays_free. Errors:
 * ARGUMENT, NOT_ZEROED, MEMORY, LIMIT. */
GTX_API gtx_result gtx_rays_prepare(const gtx_rays_desc *desc, gtx_rays **out, gtx_error *error);
/* Gives texture `which`, below GTX_RAYS_TEXTURES, and returns 1; else returns 0 and gives zeros.
 * Shaders fetch texels only. Texture 0 has no texels until gtx_rays_arrange sends some. */
GTX_API uint32_t gtx_rays_texture(const gtx_rays *rays, uint32_t which, gtx_texture *out);
/* Frees the texels, once all have been copied. */
GTX_API void gtx_rays_uploaded(gtx_rays *rays);
/* Frees rays that were not made with gtx_rays_create of render.h. NULL is fine. */
GTX_API void gtx_rays_free(gtx_rays *rays);

/* Replaces all instances and rebuilds their hierarchy: call it whenever some have moved. Only
 * sink->texels is called. Errors: ARGUMENT, MEMORY; nothing is changed then. */
GTX_API gtx_result gtx_rays_arrange(gtx_rays *rays, const gtx_ray_instance *instances,
                                    uint32_t count, const gtx_sink *sink, gtx_error *error);
/* Updates one patch from an edited asset, like gtx_model_edit: call it for each. `edited` must have
 * the rectangles of assets[asset] of the descriptor; no reference to it is kept. Rays see the new
 * patches from the next gtx_rays_arrange on, which rebuilds that asset's hierarchy. Errors:
 * ARGUMENT, MEMORY; nothing is changed then. */
GTX_API gtx_result gtx_rays_edit(gtx_rays *rays, uint32_t asset, const gtx_asset *edited,
                                 uint32_t patch, const gtx_sink *sink, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
