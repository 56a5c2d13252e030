/* Making an asset from maps in memory. */
#include "asset/check.h"

#include "base/alloc.h"

#include <string.h>

static gtx_result check_arguments(const gtx_asset_desc *desc, gtx_asset **out, gtx_error *error)
{
    if (!desc || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "gtx_create needs a descriptor and a result");
    gtx_result result = gtx_check_reserved(desc->reserved, 6, error);
    if (result)
        return result;
    if (!desc->patches || !desc->height || !desc->trim || !desc->normal)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "gtx_create needs patches and all maps");
    if (desc->height_bits != 8 && desc->height_bits != 16)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "height_bits is 8 or 16, not %u",
                        desc->height_bits);
    if (!desc->meta && desc->meta_size)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "meta_size is given without meta");
    return GTX_OK;
}

static gtx_result check_levels(const gtx_asset_desc *desc, gtx_error *error)
{
    for (uint32_t k = 0; k < desc->mip_count; ++k)
        if (!desc->normal[k] || (desc->color && !desc->color[k]))
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "level %u of a map is missing", k);
    return GTX_OK;
}

static gtx_info info_of(const gtx_asset_desc *desc)
{
    gtx_info info = {
        .version_major = 0,
        .version_minor = 1,
        .patch_count = desc->patch_count,
        .page_count = desc->page_count,
        .page_width = desc->page_width,
        .page_height = desc->page_height,
        .mip_count = desc->mip_count,
        .height_bits = desc->height_bits,
        .has_color = desc->color != NULL,
        .unit = desc->unit == 0 ? 1 : desc->unit,
        .source_triangles = desc->source_triangles,
    };
    memcpy(info.bounds_min, desc->bounds_min, sizeof info.bounds_min);
    memcpy(info.bounds_max, desc->bounds_max, sizeof info.bounds_max);
    memcpy(info.anchor, desc->anchor, sizeof info.anchor);
    return info;
}

static void copy_maps(gtx_asset *asset, const gtx_asset_desc *desc)
{
    const gtx_info *info = &asset->info;
    size_t texels = gtx_page_texels(asset, 0) * info->page_count;
    memcpy(asset->patches, desc->patches, info->patch_count * sizeof(gtx_patch));
    memcpy(asset->height, desc->height, texels * (info->height_bits / 8));
    memcpy(asset->trim, desc->trim, texels);
    for (uint32_t k = 0; k < info->mip_count; ++k) {
        texels = gtx_page_texels(asset, k) * info->page_count;
        memcpy(asset->normal[k], desc->normal[k], texels * 2);
        if (info->has_color)
            memcpy(asset->color[k], desc->color[k], texels * 4);
    }
    if (asset->meta)
        memcpy(asset->meta, desc->meta, asset->meta_size);
}

/* Every rule that content can break. */
static void check_content(gtx_check *check, const gtx_asset *asset)
{
    gtx_occupancy occupancy;
    gtx_check_patches(check, asset, 0, &occupancy);
    if (!gtx_check_over(check))
        gtx_check_maps(check, asset, &occupancy, 0, 0, false);
    gtx_occupancy_free(&occupancy, &asset->allocator);
    if (!gtx_check_over(check) && asset->meta)
        gtx_check_meta(check, asset->meta, asset->meta_size, 0);
}

gtx_result gtx_create(const gtx_asset_desc *desc, gtx_asset **out, gtx_error *error)
{
    gtx_result result = check_arguments(desc, out, error);
    if (result)
        return result;
    *out = NULL;

    gtx_check check = {.error = error};
    gtx_info info = info_of(desc);
    gtx_check_info(&check, &info);
    if (desc->meta_size > GTX_META_LIMIT)
        gtx_break(&check, GTX_RULE_META, 0, "it has %zu bytes", desc->meta_size);
    if (check.broken)
        return check.result;
    result = check_levels(desc, error);
    if (result)
        return result;

    gtx_allocator allocator = gtx_allocator_or_default(desc->allocator);
    gtx_asset *asset = gtx_asset_new(&allocator, &info, desc->meta_size);
    if (!asset)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory for the maps of an asset");
    copy_maps(asset, desc);
    check_content(&check, asset);
    if (gtx_check_over(&check)) {
        gtx_close(asset);
        return check.result;
    }
    gtx_section sections[GTX_MAX_KNOWN_SECTIONS];
    asset->info.content_hash = gtx_content_hash(sections, gtx_asset_sections(asset, sections));
    *out = asset;
    return GTX_OK;
}
