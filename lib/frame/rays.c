/* Rays in shaders: the patches of a set of assets in textures of their own, and the boxes of blocks
 * of their cells that hierarchies are built over. geotex_rays.glsl reads them. */
#include "frame/rays.h"

#include "asset/patch.h"
#include "base/alloc.h"
#include "base/error.h"
#include "derive/crowd.h"
#include "frame/model.h"

#include <string.h>

/* What floats count to, and what ints of shaders do: a height field's first texel is a multiple of
 * GTX_RAY_FIELD_ALIGN, and told as a float. */
static const size_t MAX_NODES = 1u << 24, MAX_TEXELS = 1u << 30;

static size_t align(size_t n, size_t to)
{
    return (n + to - 1) / to * to;
}

static size_t texels_of(const gtx_patch *patch)
{
    return (size_t)patch->rect[2] * patch->rect[3];
}

static uint32_t blocks_of(const gtx_patch *patch)
{
    return gtx_blocks_of(patch->rect[2] - 1u) * gtx_blocks_of(patch->rect[3] - 1u);
}

/* Counts what all assets take. A hierarchy has two nodes a block at most. */
static gtx_result measure(gtx_rays *rays, const gtx_rays_desc *desc, gtx_error *error)
{
    rays->front_texels =
        GTX_RAY_HEAD_TEXELS +
        (2 * GTX_RAY_NODE_TEXELS + GTX_RAY_INSTANCE_TEXELS) * (size_t)rays->max_instances;
    rays->nodes = align(rays->front_texels, GTX_RAY_ROW);
    rays->bits = 8;
    for (uint32_t a = 0; a < desc->asset_count; ++a) {
        const gtx_asset *asset = desc->assets[a];
        const gtx_info *info = &asset->info;
        gtx_ray_member *m = &rays->members[a];
        size_t blocks = 0;
        for (uint32_t i = 0; i < info->patch_count; ++i) {
            rays->cells += align(texels_of(&asset->patches[i]), GTX_RAY_FIELD_ALIGN);
            blocks += blocks_of(&asset->patches[i]);
        }
        m->nodes = rays->nodes;
        rays->nodes += 2 * GTX_RAY_NODE_TEXELS * blocks +
                       GTX_RAY_FIELD_TEXELS * (size_t)info->patch_count;
        if (rays->nodes > MAX_NODES || rays->cells > MAX_TEXELS)
            return gtx_fail(error, GTX_ERROR_LIMIT, "the assets are too large to cast into");
        m->layout = gtx_model_layout(asset);
        m->height_bits = info->height_bits;
        m->patch_count = info->patch_count;
        m->block_count = (uint32_t)blocks;
        rays->bits = m->height_bits > rays->bits ? m->height_bits : rays->bits;
    }
    rays->cells = align(rays->cells, GTX_RAY_ROW);
    rays->nodes = align(rays->nodes, GTX_RAY_ROW);
    if (rays->cells > (size_t)GTX_RAY_ROW * GTX_RAY_LAYER_ROWS)
        rays->cells = align(rays->cells, (size_t)GTX_RAY_ROW * GTX_RAY_LAYER_ROWS);
    return GTX_OK;
}

/* Maps until they are uploaded; for each node its texels, and a hierarchy and boxes of half as
 * many blocks while it is built. */
static uint64_t bytes_of(const gtx_rays *rays)
{
    const uint64_t texel = 4 * sizeof(float), cell = rays->bits / 2 + 1;
    const uint64_t node = GTX_RAY_NODE_TEXELS * texel + sizeof(gtx_node) + sizeof(gtx_box);
    return cell * rays->cells + texel * rays->front_texels +
           (sizeof *rays->boxes + sizeof *rays->places) * (uint64_t)rays->max_instances +
           node * (rays->nodes / GTX_RAY_NODE_TEXELS);
}

static bool reserve(gtx_rays *rays)
{
    const gtx_allocator *hooks = &rays->allocator;
    bool all = true;
    for (uint32_t a = 0; a < rays->member_count; ++a) {
        gtx_ray_member *m = &rays->members[a];
        m->boxes = gtx_alloc_array(hooks, m->block_count, sizeof *m->boxes);
        m->blocks = gtx_alloc_array(hooks, m->block_count, sizeof *m->blocks);
        m->fields = gtx_alloc_array(hooks, m->patch_count, sizeof *m->fields);
        all = all && m->boxes && m->blocks && m->fields;
    }
    rays->front = gtx_alloc_array(hooks, rays->front_texels, sizeof *rays->front);
    rays->boxes = gtx_alloc_array(hooks, rays->max_instances, sizeof *rays->boxes);
    rays->places = gtx_alloc_array(hooks, rays->max_instances, sizeof *rays->places);
    return all && rays->front && (!rays->max_instances || (rays->boxes && rays->places));
}

/* Where what is derived of a patch goes: cells and outline, which lie from texel `first` of the
 * textures on, its record, and the boxes of its blocks. */
typedef struct room {
    size_t first;
    uint8_t *cells, *trim;
    gtx_ray_field *field;
    gtx_box *boxes;
} room;

static gtx_result derive_patch(const gtx_rays *rays, const gtx_asset *asset, uint32_t index,
                               const room *out, gtx_error *error)
{
    const gtx_patch *p = &asset->patches[index];
    const gtx_patch_frame frame = gtx_patch_frame_of(p, asset->info.height_bits);
    float (*record)[4] = *out->field, *cells = record[GTX_RAY_FIELD_CELLS];
    gtx_grid grid;
    gtx_result result = gtx_grid_build(asset, index, 0, &rays->allocator, &grid, error);
    if (result)
        return result;
    gtx_grid_cells(&grid, rays->bits, p->rect[2], out->cells);
    gtx_grid_boxes(asset, index, &grid, out->boxes);
    gtx_grid_free(&grid, &rays->allocator);
    for (uint32_t y = 0; y < p->rect[3]; ++y) {
        const size_t row = (size_t)p->page * asset->info.page_height + p->rect[1] + y;
        memcpy(out->trim + (size_t)y * p->rect[2],
               asset->trim + row * asset->info.page_width + p->rect[0], p->rect[2]);
    }
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 4; ++k)
            record[GTX_RAY_FIELD_TO_GRID + r][k] = (float)frame.to_grid[r][k];
    cells[0] = p->rect[2];
    cells[1] = p->rect[3];
    cells[2] = (float)(out->first / GTX_RAY_FIELD_ALIGN);
    cells[3] = p->flags & GTX_PATCH_TWO_SIDED ? 1 : 0;
    return GTX_OK;
}

/* All patches of an asset. Moves `next` on behind their cells. */
static gtx_result derive_asset(gtx_rays *rays, const gtx_asset *asset, gtx_ray_member *m,
                               room *next, gtx_error *error)
{
    uint32_t block = 0;
    for (uint32_t i = 0; i < m->patch_count; ++i) {
        const gtx_patch *p = &asset->patches[i];
        const size_t texels = align(texels_of(p), GTX_RAY_FIELD_ALIGN);
        const uint32_t wide = gtx_blocks_of(p->rect[2] - 1u);
        next->field = &m->fields[i];
        next->boxes = m->boxes + block;
        gtx_result result = derive_patch(rays, asset, i, next, error);
        if (result)
            return result;
        for (uint32_t b = 0; b < blocks_of(p); ++b, ++block) {
            m->blocks[block][0] = (float)(b % wide + (b / wide << GTX_RAY_BLOCK_BITS));
            m->blocks[block][1] = (float)i;
        }
        next->first += texels;
        next->cells += texels * (rays->bits / 2);
        next->trim += texels;
    }
    m->offset = gtx_ray_offset(asset);
    m->edited = true;
    return GTX_OK;
}

void gtx_rays_free_maps(gtx_rays *rays)
{
    gtx_free_array(&rays->allocator, rays->maps.cells, rays->cells, rays->bits / 2);
    gtx_free_array(&rays->allocator, rays->maps.trim, rays->cells, 1);
    rays->maps = (gtx_ray_maps){NULL, NULL};
}

static gtx_result fill(gtx_rays *rays, const gtx_rays_desc *desc, gtx_error *error)
{
    const gtx_allocator *hooks = &rays->allocator;
    gtx_ray_maps *maps = &rays->maps;
    maps->cells = gtx_alloc_array(hooks, rays->cells, rays->bits / 2);
    maps->trim = gtx_alloc_array(hooks, rays->cells, 1);
    room next = {.cells = maps->cells, .trim = maps->trim};
    gtx_result result = GTX_OK;
    if (!reserve(rays) || !maps->cells || !maps->trim)
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory to cast into %u assets",
                          desc->asset_count);
    for (uint32_t i = 0; !result && i < desc->asset_count; ++i)
        result = derive_asset(rays, desc->assets[i], &rays->members[i], &next, error);
    return result;
}

gtx_result gtx_rays_prepare(const gtx_rays_desc *desc, gtx_rays **out, gtx_error *error)
{
    if (!out || !desc || !desc->asset_count || !desc->assets ||
        desc->max_instances > GTX_MAX_PATCHES)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "rays need assets, and at most %u instances",
                        GTX_MAX_PATCHES);
    *out = NULL;
    gtx_result result =
        gtx_check_reserved(desc->reserved, sizeof desc->reserved / sizeof *desc->reserved, error);
    if (!result)
        result = gtx_check_limits(&desc->limits, error);
    for (uint32_t i = 0; !result && i < desc->asset_count; ++i)
        result = desc->assets[i]
                     ? gtx_check_crowd(desc->assets[i], &desc->limits, error)
                     : gtx_fail(error, GTX_ERROR_ARGUMENT, "asset %u is missing", i);
    if (result)
        return result;
    const gtx_allocator hooks = gtx_allocator_or_default(desc->allocator);
    gtx_rays *rays = gtx_alloc_array(&hooks, 1, sizeof *rays);
    if (!rays)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for rays");
    rays->allocator = hooks;
    rays->max_instances = desc->max_instances;
    rays->member_count = desc->asset_count;
    rays->members = gtx_alloc_array(&hooks, rays->member_count, sizeof *rays->members);
    result = rays->members ? measure(rays, desc, error)
                           : gtx_fail(error, GTX_ERROR_MEMORY, "no memory to cast into %u assets",
                                      desc->asset_count);
    if (!result)
        result = gtx_check_derived(rays->cells, &desc->limits, "a set of rays", bytes_of(rays),
                                   error);
    if (!result)
        result = fill(rays, desc, error);
    if (result)
        gtx_rays_free(rays);
    else
        *out = rays;
    return result;
}

void gtx_rays_free(gtx_rays *rays)
{
    if (!rays)
        return;
    gtx_rays_free_maps(rays);
    const gtx_allocator hooks = rays->allocator;
    for (uint32_t i = 0; rays->members && i < rays->member_count; ++i) {
        const gtx_ray_member *m = &rays->members[i];
        gtx_free_array(&hooks, m->boxes, m->block_count, sizeof *m->boxes);
        gtx_free_array(&hooks, m->blocks, m->block_count, sizeof *m->blocks);
        gtx_free_array(&hooks, m->fields, m->patch_count, sizeof *m->fields);
    }
    gtx_free_array(&hooks, rays->members, rays->member_count, sizeof *rays->members);
    gtx_free_array(&hooks, rays->front, rays->front_texels, sizeof *rays->front);
    gtx_free_array(&hooks, rays->boxes, rays->max_instances, sizeof *rays->boxes);
    gtx_free_array(&hooks, rays->places, rays->max_instances, sizeof *rays->places);
    gtx_free_array(&hooks, rays, 1, sizeof *rays);
}

static bool is_alike(const gtx_ray_member *m, const gtx_asset *asset)
{
    const gtx_info *info = &asset->info;
    return info->height_bits == m->height_bits && info->patch_count == m->patch_count &&
           gtx_model_layout(asset) == m->layout;
}

void gtx_rays_free_patch(const gtx_rays *rays, gtx_ray_patch *patch)
{
    gtx_free_array(&rays->allocator, patch->maps.cells, patch->texels, rays->bits / 2);
    gtx_free_array(&rays->allocator, patch->maps.trim, patch->texels, 1);
}

gtx_result gtx_rays_derive_patch(gtx_rays *rays, uint32_t asset, const gtx_asset *edited,
                                 uint32_t patch, gtx_ray_patch *out, gtx_error *error)
{
    gtx_ray_member *m = &rays->members[asset];
    if (!is_alike(m, edited) || patch >= m->patch_count)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "patch %u is not one of an asset with the rectangles of that cast into",
                        patch);
    out->first = (size_t)m->fields[patch][GTX_RAY_FIELD_CELLS][2] * GTX_RAY_FIELD_ALIGN;
    out->texels = texels_of(&edited->patches[patch]);
    uint32_t block = 0;
    for (uint32_t i = 0; i < patch; ++i)
        block += blocks_of(&edited->patches[i]);
    out->maps.cells = gtx_alloc_array(&rays->allocator, out->texels, rays->bits / 2);
    out->maps.trim = gtx_alloc_array(&rays->allocator, out->texels, 1);
    const room to = {out->first, out->maps.cells, out->maps.trim, &m->fields[patch],
                     m->boxes + block};
    gtx_result result =
        out->maps.cells && out->maps.trim
            ? derive_patch(rays, edited, patch, &to, error)
            : gtx_fail(error, GTX_ERROR_MEMORY, "no memory for an update");
    if (result) {
        gtx_rays_free_patch(rays, out);
        return result;
    }
    m->offset = gtx_ray_offset(edited);
    m->edited = true;
    return GTX_OK;
}
