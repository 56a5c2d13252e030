/* Rays in shaders: what is derived is sent to textures of OpenGL. */
#include "render/rays.h"

#include "base/error.h"
#include "render/renderer.h"

gtx_result gtx_rays_create(gtx_renderer *renderer, const gtx_rays_desc *desc, gtx_rays **out,
                           gtx_error *error)
{
    if (!renderer || !desc || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "rays need a renderer and assets");
    *out = NULL;
    gtx_rays *rays = NULL;
    gtx_ray_maps maps = {NULL, NULL};
    gtx_result result = gtx_rays_derive(&renderer->allocator, desc, &rays, &maps, error);
    if (result)
        return result;
    result = gtx_rays_upload(&renderer->gl, rays, &maps, error);
    gtx_rays_free_maps(rays, &maps);
    if (!result)
        result = gtx_rays_place(renderer, rays, NULL, 0, error);
    if (result)
        gtx_rays_destroy(renderer, rays);
    else
        *out = rays;
    return result;
}

void gtx_rays_destroy(gtx_renderer *renderer, gtx_rays *rays)
{
    if (!rays)
        return;
    renderer->gl.DeleteTextures(GTX_RAY_TEXTURES, rays->textures);
    gtx_rays_free(rays);
}

gtx_result gtx_rays_place(gtx_renderer *renderer, gtx_rays *rays,
                          const gtx_ray_instance *instances, uint32_t count, gtx_error *error)
{
    if (!renderer || !rays || (count && !instances) || count > rays->max_instances)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "placing needs a renderer, rays and as many instances as they allow");
    size_t texels = 0;
    gtx_result result = gtx_rays_plan(rays, instances, count, &texels, error);
    for (uint32_t i = 0; !result && i < rays->member_count; ++i) {
        const gtx_ray_member *m = &rays->members[i];
        if (m->fresh)
            gtx_rays_send(&renderer->gl, rays, GTX_RAY_NODES, m->nodes, gtx_ray_fresh_texels(m),
                          m->fresh);
    }
    if (!result)
        gtx_rays_send(&renderer->gl, rays, GTX_RAY_NODES, 0, texels, rays->front);
    gtx_rays_planned(rays, !result);
    return result;
}

gtx_result gtx_rays_update(gtx_renderer *renderer, gtx_rays *rays, uint32_t asset,
                           const gtx_asset *edited, uint32_t patch, gtx_error *error)
{
    if (!renderer || !rays || !edited || asset >= rays->member_count)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an update needs a renderer, rays, one of their assets and an edited one");
    gtx_ray_patch p = {0, 0, {NULL, NULL}};
    gtx_result result = gtx_rays_derive_patch(rays, asset, edited, patch, &p, error);
    if (result)
        return result;
    gtx_rays_send(&renderer->gl, rays, GTX_RAY_CELLS, p.first, p.texels, p.maps.cells);
    gtx_rays_send(&renderer->gl, rays, GTX_RAY_TRIM, p.first, p.texels, p.maps.trim);
    gtx_rays_free_patch(rays, &p);
    return GTX_OK;
}
