/* An asset in memory: allocation and what the public accessors show of it. */
#include "asset/asset.h"

#include "asset/section.h"
#include "base/alloc.h"

/* Records are used in memory as they lie in the file, but for the order of bytes. */
_Static_assert(sizeof(gtx_patch) == 128 && offsetof(gtx_patch, page) == 64 &&
                   offsetof(gtx_patch, sphere) == 80 && offsetof(gtx_patch, reserved) == 100,
               "gtx_patch has the layout of the file record");

static uint64_t map_size(const gtx_info *info, gtx_section_kind kind, uint32_t level)
{
    return gtx_shape_size(gtx_section_shape(info, kind, level));
}

uint64_t gtx_asset_bytes(const gtx_info *info, const gtx_sizes *sizes)
{
    uint64_t bytes = sizeof(gtx_asset) + sizes->meta;
    for (uint32_t k = 0; k < GTX_MAX_LODS; ++k)
        bytes += sizes->lod[k];
    bytes += (uint64_t)info->patch_count * sizeof(gtx_patch);
    for (gtx_section_kind kind = GTX_SECTION_FIRST_IMAGE; kind <= GTX_SECTION_LAST_IMAGE; ++kind)
        for (uint32_t k = 0; k < gtx_map_levels(info, kind); ++k)
            bytes += map_size(info, kind, k);
    return bytes;
}

/* False when memory is out. */
static bool new_maps(gtx_asset *asset, bool clear)
{
    for (gtx_section_kind kind = GTX_SECTION_FIRST_IMAGE; kind <= GTX_SECTION_LAST_IMAGE; ++kind) {
        for (uint32_t k = 0; k < gtx_map_levels(&asset->info, kind); ++k) {
            const size_t size = (size_t)map_size(&asset->info, kind, k);
            uint8_t *map = (clear ? gtx_alloc_array : gtx_alloc_raw)(&asset->allocator, size, 1);
            *gtx_asset_map(asset, kind, k) = map;
            if (!map)
                return false;
        }
    }
    return true;
}

/* False when memory is out. */
static bool new_lod(gtx_asset *asset, const gtx_sizes *sizes, bool clear)
{
    for (uint32_t k = 0; k < GTX_MAX_LODS; ++k) {
        asset->lod_size[k] = (size_t)sizes->lod[k];
        if (sizes->lod[k])
            asset->lod[k] = (clear ? gtx_alloc_array : gtx_alloc_raw)(
                &asset->allocator, asset->lod_size[k], 1);
        if (sizes->lod[k] && !asset->lod[k])
            return false;
    }
    return true;
}

gtx_asset *gtx_asset_new(const gtx_allocator *allocator, const gtx_info *info,
                         const gtx_sizes *sizes, bool clear)
{
    if (gtx_asset_bytes(info, sizes) > SIZE_MAX)
        return NULL;
    gtx_asset *asset = gtx_alloc_array(allocator, 1, sizeof *asset);
    if (!asset)
        return NULL;
    asset->allocator = *allocator;
    asset->info = *info;
    asset->patches = gtx_alloc_array(allocator, info->patch_count, sizeof(gtx_patch));
    bool whole = asset->patches && new_maps(asset, clear) && new_lod(asset, sizes, clear);
    if (whole && sizes->meta) {
        asset->meta_size = (size_t)sizes->meta;
        asset->meta = gtx_alloc_array(allocator, asset->meta_size, 1);
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
    for (gtx_section_kind kind = GTX_SECTION_FIRST_IMAGE; kind <= GTX_SECTION_LAST_IMAGE; ++kind)
        for (uint32_t k = 0; k < gtx_map_levels(info, kind); ++k)
            gtx_free_array(&allocator, *gtx_asset_map(asset, kind, k),
                           (size_t)map_size(info, kind, k), 1);
    for (uint32_t k = 0; k < GTX_MAX_LODS; ++k)
        gtx_free_array(&allocator, asset->lod[k], asset->lod_size[k], 1);
    gtx_free_array(&allocator, asset->blocks, asset->blocks_size, 1);
    gtx_free_array(&allocator, asset->meta, asset->meta_size, 1);
    gtx_free_array(&allocator, asset->marks,
                   (size_t)info->page_count * info->page_width * info->page_height, 1);
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
        [GTX_MAP_HEIGHT] = GTX_SECTION_HEIGHT,     [GTX_MAP_TRIM] = GTX_SECTION_TRIM,
        [GTX_MAP_NORMAL] = GTX_SECTION_NORMAL,     [GTX_MAP_COLOR] = GTX_SECTION_COLOR,
        [GTX_MAP_MATERIAL] = GTX_SECTION_MATERIAL, [GTX_MAP_EMISSION] = GTX_SECTION_EMISSION};
    const void *data = NULL;
    if (map <= GTX_MAP_EMISSION && level < gtx_map_levels(&asset->info, kinds[map]))
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
