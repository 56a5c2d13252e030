/* An asset in memory: allocation and what the public accessors show of it. */
#include "asset/asset.h"

#include "asset/section.h"
#include "base/alloc.h"

/* Records and 16-bit codes are used in memory as they lie in the file. */
_Static_assert(sizeof(gtx_patch) == 128 && offsetof(gtx_patch, page) == 64 &&
                   offsetof(gtx_patch, sphere) == 80 && offsetof(gtx_patch, reserved) == 100,
               "gtx_patch has the layout of the file record");
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "geotex needs a little-endian processor"
#endif

static uint64_t map_size(const gtx_info *info, gtx_section_kind kind, uint32_t level)
{
    return gtx_shape_size(gtx_section_shape(info, kind, level));
}

uint64_t gtx_asset_bytes(const gtx_info *info, size_t meta_size)
{
    uint64_t bytes = sizeof(gtx_asset) + meta_size;
    bytes += (uint64_t)info->patch_count * sizeof(gtx_patch);
    bytes += map_size(info, GTX_SECTION_HEIGHT, 0) + map_size(info, GTX_SECTION_TRIM, 0);
    for (uint32_t k = 0; k < info->mip_count; ++k) {
        bytes += map_size(info, GTX_SECTION_NORMAL, k);
        bytes += info->has_color ? map_size(info, GTX_SECTION_COLOR, k) : 0;
    }
    return bytes;
}

static uint8_t *new_map(const gtx_asset *asset, gtx_section_kind kind, uint32_t level)
{
    return gtx_alloc_array(&asset->allocator, (size_t)map_size(&asset->info, kind, level), 1);
}

gtx_asset *gtx_asset_new(const gtx_allocator *allocator, const gtx_info *info, size_t meta_size)
{
    if (gtx_asset_bytes(info, meta_size) > SIZE_MAX)
        return NULL;
    gtx_asset *asset = gtx_alloc_array(allocator, 1, sizeof *asset);
    if (!asset)
        return NULL;
    asset->allocator = *allocator;
    asset->info = *info;
    asset->patches = gtx_alloc_array(allocator, info->patch_count, sizeof(gtx_patch));
    asset->height = new_map(asset, GTX_SECTION_HEIGHT, 0);
    asset->trim = new_map(asset, GTX_SECTION_TRIM, 0);
    bool whole = asset->patches && asset->height && asset->trim;
    for (uint32_t k = 0; k < info->mip_count; ++k) {
        asset->normal[k] = new_map(asset, GTX_SECTION_NORMAL, k);
        whole = whole && asset->normal[k];
        if (info->has_color) {
            asset->color[k] = new_map(asset, GTX_SECTION_COLOR, k);
            whole = whole && asset->color[k];
        }
    }
    if (meta_size) {
        asset->meta = gtx_alloc_array(allocator, meta_size, 1);
        asset->meta_size = meta_size;
        whole = whole && asset->meta;
    }
    if (whole)
        return asset;
    gtx_close(asset);
    return NULL;
}

void gtx_close(gtx_asset *asset)
{
    if (!asset)
        return;
    const gtx_info *info = &asset->info;
    gtx_allocator allocator = asset->allocator;
    gtx_free_array(&allocator, asset->patches, info->patch_count, sizeof(gtx_patch));
    for (int kind = GTX_SECTION_HEIGHT; kind <= GTX_SECTION_COLOR; ++kind)
        for (uint32_t k = 0; k < (kind >= GTX_SECTION_NORMAL ? info->mip_count : 1); ++k)
            gtx_free_array(&allocator, gtx_asset_data(asset, (gtx_section_kind)kind, k),
                           (size_t)map_size(info, (gtx_section_kind)kind, k), 1);
    gtx_free_array(&allocator, asset->meta, asset->meta_size, 1);
    gtx_free_array(&allocator, asset, 1, sizeof *asset);
}

void gtx_get_info(const gtx_asset *asset, gtx_info *out)
{
    *out = asset->info;
}

const gtx_patch *gtx_patches(const gtx_asset *asset)
{
    return asset->patches;
}

const void *gtx_map_data(const gtx_asset *asset, gtx_map map, uint32_t level, size_t *size)
{
    static const gtx_section_kind kinds[] = {
        [GTX_MAP_HEIGHT] = GTX_SECTION_HEIGHT, [GTX_MAP_TRIM] = GTX_SECTION_TRIM,
        [GTX_MAP_NORMAL] = GTX_SECTION_NORMAL, [GTX_MAP_COLOR] = GTX_SECTION_COLOR};
    const void *data = NULL;
    if (map <= GTX_MAP_COLOR && level < (map >= GTX_MAP_NORMAL ? asset->info.mip_count : 1))
        data = gtx_asset_data(asset, kinds[map], level);
    if (size)
        *size = data ? (size_t)map_size(&asset->info, kinds[map], level) : 0;
    return data;
}

const char *gtx_meta(const gtx_asset *asset, size_t *size)
{
    if (size)
        *size = asset->meta_size;
    return asset->meta;
}
