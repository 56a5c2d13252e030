/* Blocks of an asset's maps, made before it is loaded. */
#include "frame/compress.h"
#include "frame/model.h"

#include "asset/blocks.h"
#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

/* A section in the making: what the asset has, and what a model of it has. */
typedef struct section {
    gtx_block_map maps[GTX_MAX_BLOCK_MAPS];
    uint32_t count;
} section;

static gtx_map map_of(uint32_t unit)
{
    return unit == UNIT_NORMALS     ? GTX_MAP_NORMAL
           : unit == UNIT_COLORS    ? GTX_MAP_COLOR
           : unit == UNIT_MATERIALS ? GTX_MAP_MATERIAL
                                    : GTX_MAP_EMISSION;
}

static bool is_before(const gtx_block_map *a, const gtx_block_map *b)
{
    return a->map != b->map ? a->map < b->map : a->format < b->format;
}

/* In order, and once. */
static void add_map(section *s, gtx_block_map map)
{
    uint32_t i = s->count;
    while (i > 0 && is_before(&map, &s->maps[i - 1]))
        --i;
    if (i > 0 && !is_before(&s->maps[i - 1], &map))
        return;
    memmove(s->maps + i + 1, s->maps + i, (s->count - i) * sizeof *s->maps);
    s->maps[i] = map;
    s->count += 1;
}

/* The levels of a model that a map's blocks are; the largest comes first. */
static void copy_levels(const gtx_model *model, const gtx_block_map *map, uint8_t *out)
{
    for (uint32_t i = 0; i < model->level_count; ++i) {
        const gtx_level *l = &model->levels[i];
        if (!l->block_size || (uint32_t)map_of(l->unit) != map->map ||
            gtx_block_number(model->formats[l->unit]) != map->format)
            continue;
        memcpy(out, l->data, gtx_level_size(l));
        out += gtx_level_size(l);
    }
}

static gtx_result add(gtx_asset *asset, const gtx_model *model, gtx_error *error)
{
    section s = {.count = asset->blocks ? gtx_blocks_load(&asset->info, asset->blocks,
                                                          asset->blocks_size, s.maps)
                                        : 0};
    for (uint32_t i = 0; i < model->level_count; ++i) {
        const gtx_level *l = &model->levels[i];
        if (l->block_size)
            add_map(&s, (gtx_block_map){map_of(l->unit),
                                        gtx_block_number(model->formats[l->unit])});
    }
    const uint64_t size = s.count ? gtx_blocks_size(&asset->info, s.maps, s.count) : 0;
    if (!size)
        return GTX_OK; /* no map that there are blocks for */
    uint8_t *bytes = size > SIZE_MAX ? NULL
                                     : gtx_alloc_array(&asset->allocator, (size_t)size, 1);
    if (!bytes)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for blocks of an asset's maps");
    uint8_t *at = bytes + gtx_blocks_begin(s.maps, s.count, bytes);
    for (uint32_t i = 0; i < s.count; ++i) {
        const size_t room = (size_t)gtx_blocks_room(&asset->info, s.maps[i]);
        const uint8_t *kept = gtx_find_blocks(asset, (gtx_map)s.maps[i].map, s.maps[i].format);
        if (kept)
            memcpy(at, kept, room);
        else
            copy_levels(model, &s.maps[i], at);
        at += room;
    }
    gtx_keep_blocks(asset, bytes, (size_t)size);
    gtx_section sections[GTX_MAX_KNOWN_SECTIONS];
    asset->info.content_hash = gtx_content_hash(sections, gtx_asset_sections(asset, sections));
    return GTX_OK;
}

gtx_result gtx_add_blocks(gtx_asset *asset, const gtx_model_desc *desc, gtx_error *error)
{
    gtx_model *model;
    if (!asset || !desc || desc->compress == GTX_COMPRESS_NONE)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "adding blocks needs an asset and their kind");
    gtx_result result = gtx_model_prepare(asset, desc, &model, error);
    if (result)
        return result;
    result = add(asset, model, error);
    gtx_model_free(model);
    return result;
}
