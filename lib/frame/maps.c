/* The maps of a model: an asset's own, copies, blocks, or a texel that says all. */
#include "frame/compress.h"
#include "frame/model.h"

#include "asset/blocks.h"
#include "base/alloc.h"

#include <string.h>

uint8_t *gtx_model_add_level(gtx_model *model, gtx_level level)
{
    gtx_level *l = &model->levels[model->level_count++];
    const bool looks = level.unit == UNIT_COLORS || level.unit == UNIT_MATERIALS ||
                       level.unit == UNIT_EMISSIONS;
    *l = level;
    if (!l->borrowed)
        l->data = gtx_alloc_raw(&model->allocator, gtx_level_size(l), 1);
    *(looks ? &model->size.color : &model->size.geometry) += gtx_level_size(l);
    return l->data;
}

/* A model in the making, and what its levels are made from. */
typedef struct making {
    gtx_model *model;
    const gtx_asset *asset;
    const gtx_model_desc *desc;
    const void **sources;
} making;

/* A single texel. */
static bool add_texel(const making *m, uint32_t unit, const void *texel, gtx_format format,
                      uint32_t size)
{
    gtx_model *model = m->model;
    model->formats[unit] = format;
    m->sources[model->level_count] = texel;
    return gtx_model_add_level(model, (gtx_level){.unit = unit, .width = 1, .height = 1,
                                                  .layers = 1, .texel_size = size});
}

/* Levels that are a map's, or are to be copies or blocks of them. */
static bool add_maps(const making *m, gtx_map map, uint32_t unit, uint32_t count)
{
    const gtx_info *info = &m->asset->info;
    const bool compress = unit != UNIT_NORMALS || m->desc->compress_normals;
    const gtx_storage s = gtx_storage_of(
        unit, compress ? m->desc->compress : GTX_COMPRESS_NONE,
        unit == UNIT_COLORS && m->desc->compress && gtx_is_opaque(m->asset));
    const uint8_t *blocks =
        s.block_size ? gtx_find_blocks(m->asset, map, gtx_block_number(s.format)) : NULL;
    const bool borrow = m->desc->borrow && (blocks || !s.block_size);
    for (uint32_t k = 0; k < count; ++k) {
        const void *texels = gtx_map_data(m->asset, map, k, NULL);
        if (!texels) /* an optional map */
            return true;
        const void *source = blocks ? blocks : texels;
        m->model->formats[unit] = s.format;
        m->sources[m->model->level_count] = borrow ? NULL : source;
        if (blocks)
            blocks += gtx_blocks_level_size(info, k, s.block_size);
        if (!gtx_model_add_level(m->model, (gtx_level){.unit = unit, .level = k,
                                             .width = info->page_width >> k,
                                             .height = info->page_height >> k,
                                             .layers = info->page_count,
                                             .texel_size = s.texel_size,
                                             .block_size = s.block_size,
                                             .data = borrow ? (uint8_t *)source : NULL,
                                             .borrowed = borrow, .encoded = source != texels}))
            return false;
    }
    return true;
}

/* A single texel, where that says all. */
static bool add_materials(const making *m)
{
    gtx_model *model = m->model;
    if (!model->flat_material)
        return add_maps(m, GTX_MAP_MATERIAL, UNIT_MATERIALS, m->asset->info.mip_count);
    return add_texel(m, UNIT_MATERIALS, model->constant_material, GTX_FORMAT_RGBA8, 4);
}

bool gtx_model_add_maps(gtx_model *model, const gtx_asset *asset, const gtx_model_desc *desc,
                        const void **sources)
{
    const making m = {model, asset, desc, sources};
    const uint32_t mips = asset->info.mip_count;
    const bool trim = asset->bare ? add_texel(&m, UNIT_TRIM, asset->trim, GTX_FORMAT_R8, 1)
                                  : add_maps(&m, GTX_MAP_TRIM, UNIT_TRIM, 1);
    return trim &&
           add_maps(&m, GTX_MAP_NORMAL, UNIT_NORMALS, mips) &&
           add_maps(&m, GTX_MAP_COLOR, UNIT_COLORS, mips) && add_materials(&m) &&
           add_maps(&m, GTX_MAP_EMISSION, UNIT_EMISSIONS, mips);
}

static void compress_level(const gtx_model *model, const gtx_asset *asset,
                           const gtx_level *l, const uint8_t *source, uint32_t piece,
                           uint32_t pieces)
{
    static const uint32_t channels[UNIT_COUNT] = {[UNIT_NORMALS] = 2, [UNIT_COLORS] = 4,
                                                  [UNIT_MATERIALS] = 4, [UNIT_EMISSIONS] = 3};
    const uint32_t rows = gtx_level_rows(l);
    gtx_block_rows r = {.format = model->formats[l->unit], .level = l->level,
                        .width = l->width, .height = l->height, .texels = source,
                        .channels = channels[l->unit],
                        .first = (uint32_t)((uint64_t)rows * piece / pieces),
                        .end = (uint32_t)((uint64_t)rows * (piece + 1) / pieces),
                        .right = (l->width + 3) / 4};
    for (r.page = 0; r.page < l->layers; ++r.page) {
        r.out = l->data + ((size_t)r.page * rows + r.first) * gtx_level_row_size(l);
        gtx_compress_rows(asset, &r);
    }
}

void gtx_model_begin_level(gtx_model *model, const gtx_asset *asset, uint32_t index,
                           const uint8_t *source, uint32_t piece, uint32_t pieces)
{
    const gtx_level *l = &model->levels[index];
    const size_t size = gtx_level_size(l), first = size * piece / pieces;
    const size_t count = size * (piece + 1) / pieces - first;
    if (source && l->block_size && !l->encoded)
        compress_level(model, asset, l, source, piece, pieces);
    else if (source)
        memcpy(l->data + first, source + first, count);
    else if (!l->borrowed)
        memset(l->data + first, 0, count);
}
