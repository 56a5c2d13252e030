/* Rays in shaders, for whoever has them on a GPU: their textures, and what edits and instances that
 * move replace in these. Texels are addressed through rows and layers, as in an array. */
#include "frame/rays.h"

#include "base/error.h"
#include "frame/units.h"

_Static_assert((int)UNIT_RAYS == (int)GTX_RAYS_BINDING, "geotex_rays.glsl says where they are");

uint32_t gtx_rays_texture(const gtx_rays *rays, uint32_t which, gtx_texture *out)
{
    static const gtx_texture kinds[GTX_RAY_TEXTURES + 1] = {
        [GTX_RAY_NODES] = {.format = GTX_FORMAT_RGBA32_FLOAT, .texel_size = 16},
        [GTX_RAY_CELLS] = {.format = GTX_FORMAT_RGBA8_UINT, .texel_size = 4, .is_array = 1},
        [GTX_RAY_TRIM] = {.format = GTX_FORMAT_R8, .texel_size = 1, .is_array = 1},
        [GTX_RAY_TEXTURES] = {.format = GTX_FORMAT_RGBA16_UINT, .texel_size = 8, .is_array = 1}};
    const size_t layer = (size_t)GTX_RAY_ROW * GTX_RAY_LAYER_ROWS;
    if (!out)
        return 0;
    *out = (gtx_texture){.width = 0};
    if (!rays || which >= GTX_RAY_TEXTURES)
        return 0;
    const bool fine = which == GTX_RAY_CELLS && rays->bits == 16;
    const size_t texels = which == GTX_RAY_NODES ? rays->nodes : rays->cells;
    *out = kinds[fine ? GTX_RAY_TEXTURES : which];
    out->layers = out->is_array && texels > layer ? (uint32_t)(texels / layer) : 1;
    out->width = GTX_RAY_ROW;
    out->height = (uint32_t)(texels / out->layers / GTX_RAY_ROW);
    out->levels = 1;
    out->texels[0] = which == GTX_RAY_CELLS  ? rays->maps.cells
                     : which == GTX_RAY_TRIM ? rays->maps.trim
                                             : NULL;
    return 1;
}

void gtx_rays_uploaded(gtx_rays *rays)
{
    if (rays)
        gtx_rays_free_maps(rays);
}

/* Sends `count` texels, from texel `first` of a texture on. */
static void send(const gtx_rays *rays, gtx_ray_texture texture, size_t first, size_t count,
                 const void *data, const gtx_sink *sink)
{
    gtx_texture kind;
    const uint8_t *next = data;
    gtx_rays_texture(rays, texture, &kind);
    while (count) {
        const size_t x = first % GTX_RAY_ROW, y = first / GTX_RAY_ROW;
        const size_t left = GTX_RAY_LAYER_ROWS - y % GTX_RAY_LAYER_ROWS, room = GTX_RAY_ROW - x;
        size_t width = count < room ? count : room, rows = 1;
        if (width == GTX_RAY_ROW)
            rows = count / GTX_RAY_ROW < left ? count / GTX_RAY_ROW : left;
        const gtx_texture_piece t = {
            .binding = GTX_RAYS_BINDING + (uint32_t)texture,
            .layer = kind.is_array ? (uint32_t)(y / GTX_RAY_LAYER_ROWS) : 0, .x = (uint32_t)x,
            .y = (uint32_t)(kind.is_array ? y % GTX_RAY_LAYER_ROWS : y), .width = (uint32_t)width,
            .height = (uint32_t)rows, .data = next, .row_bytes = width * kind.texel_size};
        sink->texels(&t, sink->user);
        first += width * rows;
        count -= width * rows;
        next += width * rows * kind.texel_size;
    }
}

gtx_result gtx_rays_arrange(gtx_rays *rays, const gtx_ray_instance *instances, uint32_t count,
                            const gtx_sink *sink, gtx_error *error)
{
    if (!rays || (count && !instances) || count > rays->max_instances || !sink || !sink->texels)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "placing needs rays, as many instances as they allow and a sink");
    size_t texels = 0;
    gtx_result result = gtx_rays_plan(rays, instances, count, &texels, error);
    for (uint32_t i = 0; !result && i < rays->member_count; ++i) {
        const gtx_ray_member *m = &rays->members[i];
        if (m->fresh)
            send(rays, GTX_RAY_NODES, m->nodes, gtx_ray_fresh_texels(m), m->fresh, sink);
    }
    if (!result)
        send(rays, GTX_RAY_NODES, 0, texels, rays->front, sink);
    gtx_rays_planned(rays, !result);
    return result;
}

gtx_result gtx_rays_edit(gtx_rays *rays, uint32_t asset, const gtx_asset *edited, uint32_t patch,
                         const gtx_sink *sink, gtx_error *error)
{
    if (!rays || !edited || asset >= rays->member_count || !sink || !sink->texels)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an update needs rays, one of their assets, an edited one and a sink");
    gtx_ray_patch p = {0, 0, {NULL, NULL}};
    gtx_result result = gtx_rays_derive_patch(rays, asset, edited, patch, &p, error);
    if (result)
        return result;
    send(rays, GTX_RAY_CELLS, p.first, p.texels, p.maps.cells, sink);
    send(rays, GTX_RAY_TRIM, p.first, p.texels, p.maps.trim, sink);
    gtx_rays_free_patch(rays, &p);
    return GTX_OK;
}
