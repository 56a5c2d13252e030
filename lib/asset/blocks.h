/* Block-compressed maps of an asset, stored beside the uncompressed ones: the BLKS section
 * (format/gtx.md, section 2.1). */
#ifndef GTX_ASSET_BLOCKS_H
#define GTX_ASSET_BLOCKS_H

#include "asset/section.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Of both the numbers are those of the file: gtx_map, and VkFormat. */
typedef struct gtx_block_map {
    uint32_t map, format;
} gtx_block_map;

enum { GTX_MAX_BLOCK_MAPS = 12, GTX_BLOCKS_ALIGN = 16 };

/* Bytes of a level of all pages, where blocks take `block` bytes. */
static inline uint64_t gtx_blocks_level_size(const gtx_info *info, uint32_t level, uint32_t block)
{
    const uint64_t wide = ((info->page_width >> level) + 3) / 4;
    return wide * (((info->page_height >> level) + 3) / 4) * info->page_count * block;
}

/* Bytes of a section of these; 0 where a format is none of its map's, the asset has no such map, or
 * they are not in order. */
uint64_t gtx_blocks_size(const gtx_info *info, const gtx_block_map *maps, uint32_t count);
/* Bytes of the largest section that there can be. */
uint64_t gtx_blocks_most(const gtx_info *info);
/* Bytes of one map's blocks in a section; 0 where it is none. */
uint64_t gtx_blocks_room(const gtx_info *info, gtx_block_map map);
/* Writes the head of a section; blocks of the first map follow it. Returns its bytes. */
size_t gtx_blocks_begin(const gtx_block_map *maps, uint32_t count, uint8_t *out);
/* What a section has: their number, 0 where it is none that holds. */
uint32_t gtx_blocks_load(const gtx_info *info, const uint8_t *bytes, uint64_t size,
                         gtx_block_map out[GTX_MAX_BLOCK_MAPS]);

/* Blocks of all levels of a map, the largest first; NULL where the asset has none by that
 * format. */
const uint8_t *gtx_find_blocks(const gtx_asset *asset, gtx_map map, uint32_t format);
/* Has the asset keep a section, which comes from its allocator, or none, in place of its own. */
void gtx_keep_blocks(gtx_asset *asset, uint8_t *bytes, size_t size);

#ifdef __cplusplus
}
#endif
#endif
