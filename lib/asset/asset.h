/* The struct of a gtx_asset, for the rooms that derive, write and edit. */
#ifndef GTX_ASSET_ASSET_H
#define GTX_ASSET_ASSET_H

#include "asset/patch.h"
#include "base/bytes.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GTX_MAX_MIPS 8
#define GTX_MAX_SECTIONS 256
#define GTX_MAX_LODS 8
#define GTX_MAX_PATCHES (1u << 20)
#define GTX_MAX_PAGES 2048
#define GTX_MAX_PAGE_SIDE 16384

/* Maps are decoded, rows without padding; maps that the asset lacks are NULL. */
struct gtx_asset {
    gtx_allocator allocator;
    gtx_info info;
    gtx_patch *patches;
    uint8_t *height, *trim;
    uint8_t *normal[GTX_MAX_MIPS], *color[GTX_MAX_MIPS];
    uint8_t *material[GTX_MAX_MIPS], *emission[GTX_MAX_MIPS];
    uint8_t *lod[GTX_MAX_LODS]; /* in the layout of a section: lib/asset/lod.h */
    size_t lod_size[GTX_MAX_LODS];
    uint8_t *blocks;          /* in the layout of a BLKS section: lib/asset/blocks.h; or NULL */
    size_t blocks_size;
    char *meta;
    size_t meta_size;
    bool bare;                /* opened from the beginning of a file: it has no heights */
    uint8_t *marks;           /* if bare, 1 for texels that have a height in the file; or NULL */
};

/* Texels of a page at a level, and of all pages. */
static inline size_t gtx_page_texels(const gtx_asset *asset, uint32_t level)
{
    return (size_t)(asset->info.page_width >> level) * (asset->info.page_height >> level);
}

/* The height code at texel (x, y) of a patch; 0 = empty. No bounds check. */
static inline uint32_t gtx_height_code(const gtx_asset *asset, const gtx_patch *patch, uint32_t x,
                                       uint32_t y)
{
    size_t row = (size_t)patch->page * asset->info.page_height + patch->rect[1] + y;
    size_t texel = row * asset->info.page_width + patch->rect[0] + x;
    if (asset->info.height_bits == 8)
        return asset->height[texel];
    if (GTX_BIG_ENDIAN)
        return (uint32_t)asset->height[2 * texel] << 8 | asset->height[2 * texel + 1];
    return asset->height[2 * texel] | (uint32_t)asset->height[2 * texel + 1] << 8;
}

/* The height codes of a patch. */
static inline gtx_code_map gtx_codes_of(const gtx_asset *asset, const gtx_patch *patch)
{
    const size_t width = asset->info.page_width, bytes = asset->info.height_bits / 8;
    const size_t row = (size_t)patch->page * asset->info.page_height + patch->rect[1];
    gtx_code_map codes = {asset->height + (row * width + patch->rect[0]) * bytes, width,
                          (uint32_t)bytes, asset->info.height_bits};
    return codes;
}

/* The trim code at texel (x, y) of a patch. No bounds check. */
static inline uint32_t gtx_trim_code(const gtx_asset *asset, const gtx_patch *patch, uint32_t x,
                                     uint32_t y)
{
    size_t row = (size_t)patch->page * asset->info.page_height + patch->rect[1] + y;
    return asset->trim[row * asset->info.page_width + patch->rect[0] + x];
}

#ifdef __cplusplus
}
#endif
#endif
