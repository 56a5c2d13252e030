/* The section of block-compressed maps: the formats that it may hold, and their layout. */
#include "asset/blocks.h"

#include "base/alloc.h"
#include "base/bytes.h"

/* In the order of the section. */
static const struct kind {
    gtx_map map;
    uint32_t format, block; /* bytes of one */
} kinds[] = {{GTX_MAP_NORMAL, 141, 16},   /* BC5 */
             {GTX_MAP_NORMAL, 155, 16},   /* EAC, two channels */
             {GTX_MAP_COLOR, 132, 8},     /* BC1, sRGB */
             {GTX_MAP_COLOR, 146, 16},    /* BC7, sRGB */
             {GTX_MAP_COLOR, 148, 8},     /* ETC2, sRGB */
             {GTX_MAP_COLOR, 152, 16},    /* ETC2 with alpha, sRGB */
             {GTX_MAP_MATERIAL, 145, 16}, /* BC7 */
             {GTX_MAP_MATERIAL, 151, 16}, /* ETC2 with alpha */
             {GTX_MAP_EMISSION, 132, 8},
             {GTX_MAP_EMISSION, 146, 16},
             {GTX_MAP_EMISSION, 148, 8}};

enum { KINDS = sizeof kinds / sizeof *kinds };
_Static_assert((int)KINDS <= (int)GTX_MAX_BLOCK_MAPS, "a section may have all");

static bool has_map(const gtx_info *info, gtx_map map)
{
    return map == GTX_MAP_NORMAL || (map == GTX_MAP_COLOR && info->has_color) ||
           (map == GTX_MAP_MATERIAL && info->has_material) ||
           (map == GTX_MAP_EMISSION && info->has_emission);
}

static uint64_t head_size(uint32_t count)
{
    return (4 + 8 * (uint64_t)count + GTX_BLOCKS_ALIGN - 1) / GTX_BLOCKS_ALIGN * GTX_BLOCKS_ALIGN;
}

/* Of all levels, in whole steps: the next map's begin aligned. */
static uint64_t map_size(const gtx_info *info, uint32_t block)
{
    uint64_t size = 0;
    for (uint32_t k = 0; k < info->mip_count; ++k)
        size += gtx_blocks_level_size(info, k, block);
    return (size + GTX_BLOCKS_ALIGN - 1) / GTX_BLOCKS_ALIGN * GTX_BLOCKS_ALIGN;
}

uint64_t gtx_blocks_size(const gtx_info *info, const gtx_block_map *maps, uint32_t count)
{
    uint64_t size = head_size(count);
    uint32_t i = 0;
    for (uint32_t k = 0; k < KINDS && i < count; ++k) {
        if ((uint32_t)kinds[k].map != maps[i].map || kinds[k].format != maps[i].format)
            continue;
        if (!has_map(info, kinds[k].map))
            return 0;
        size += map_size(info, kinds[k].block);
        ++i;
    }
    return i == count && count > 0 ? size : 0;
}

uint64_t gtx_blocks_room(const gtx_info *info, gtx_block_map map)
{
    for (uint32_t k = 0; k < KINDS; ++k)
        if ((uint32_t)kinds[k].map == map.map && kinds[k].format == map.format)
            return map_size(info, kinds[k].block);
    return 0;
}

uint64_t gtx_blocks_most(const gtx_info *info)
{
    uint64_t size = head_size(KINDS);
    for (uint32_t k = 0; k < KINDS; ++k)
        size += has_map(info, kinds[k].map) ? map_size(info, kinds[k].block) : 0;
    return size;
}

size_t gtx_blocks_begin(const gtx_block_map *maps, uint32_t count, uint8_t *out)
{
    const size_t size = (size_t)head_size(count);
    memset(out, 0, size);
    gtx_store_u32(out, count);
    for (uint32_t i = 0; i < count; ++i) {
        gtx_store_u32(out + 4 + 8 * i, maps[i].map);
        gtx_store_u32(out + 8 + 8 * i, maps[i].format);
    }
    return size;
}

uint32_t gtx_blocks_load(const gtx_info *info, const uint8_t *bytes, uint64_t size,
                         gtx_block_map out[GTX_MAX_BLOCK_MAPS])
{
    const uint32_t count = size >= 4 ? gtx_load_u32(bytes) : 0;
    if (count < 1 || count > KINDS || size < head_size(count))
        return 0;
    for (uint32_t i = 0; i < count; ++i)
        out[i] = (gtx_block_map){gtx_load_u32(bytes + 4 + 8 * i), gtx_load_u32(bytes + 8 + 8 * i)};
    return gtx_blocks_size(info, out, count) == size ? count : 0;
}

const uint8_t *gtx_find_blocks(const gtx_asset *asset, gtx_map map, uint32_t format)
{
    gtx_block_map maps[GTX_MAX_BLOCK_MAPS];
    const uint32_t count = asset->blocks ? gtx_blocks_load(&asset->info, asset->blocks,
                                                           asset->blocks_size, maps)
                                         : 0;
    const uint8_t *at = asset->blocks + (count ? head_size(count) : 0);
    for (uint32_t i = 0, k = 0; i < count; ++k) {
        if ((uint32_t)kinds[k].map != maps[i].map || kinds[k].format != maps[i].format)
            continue;
        if (kinds[k].map == map && kinds[k].format == format)
            return at;
        at += map_size(&asset->info, kinds[k].block);
        ++i;
    }
    return NULL;
}

void gtx_keep_blocks(gtx_asset *asset, uint8_t *bytes, size_t size)
{
    gtx_free_array(&asset->allocator, asset->blocks, asset->blocks_size, 1);
    asset->blocks = bytes;
    asset->blocks_size = bytes ? size : 0;
}
