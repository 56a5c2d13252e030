/* Making an asset from maps in memory. */
#include "asset/check.h"
#include "asset/lod.h"

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
    if ((desc->lod_levels && !desc->lod) || desc->lod_levels > GTX_MAX_LODS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "lod_levels is at most 8, and 0 without them");
    return GTX_OK;
}

static gtx_result check_levels(const gtx_asset_desc *desc, gtx_error *error)
{
    for (uint32_t k = 0; k < desc->mip_count; ++k)
        if (!desc->normal[k] || (desc->color && !desc->color[k]) ||
            (desc->material && !desc->material[k]) || (desc->emission && !desc->emission[k]))
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "level %u of a map is missing", k);
    for (uint32_t k = 0; k < desc->lod_levels; ++k)
        if (!desc->lod[k].first || !desc->lod[k].indices || !desc->lod[k].positions)
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "an array of LOD mesh %u is missing", k);
    for (uint32_t k = 0; k < desc->lod_levels; ++k)
        if (!(desc->lod[k].flags & GTX_LOD_NORMALS) != !desc->lod[k].normals)
            return gtx_fail(error, GTX_ERROR_ARGUMENT,
                            "LOD mesh %u has normals without their flag, or the flag alone", k);
    return GTX_OK;
}

static gtx_info info_of(const gtx_asset_desc *desc)
{
    gtx_info info = {
        .version_major = GTX_FORMAT_MAJOR,
        .version_minor = GTX_FORMAT_MINOR,
        .patch_count = desc->patch_count,
        .page_count = desc->page_count,
        .page_width = desc->page_width,
        .page_height = desc->page_height,
        .mip_count = desc->mip_count,
        .height_bits = desc->height_bits,
        .has_color = desc->color != NULL,
        .has_material = desc->material != NULL,
        .has_emission = desc->emission != NULL,
        .lod_levels = desc->lod_levels,
        .unit = desc->unit == 0 ? 1 : desc->unit,
        .source_triangles = desc->source_triangles,
    };
    info.emission_scale = desc->emission_scale;
    if (desc->emission_scale == 0)
        info.emission_scale = desc->emission ? 1 : 0;
    memcpy(info.bounds_min, desc->bounds_min, sizeof info.bounds_min);
    memcpy(info.bounds_max, desc->bounds_max, sizeof info.bounds_max);
    memcpy(info.anchor, desc->anchor, sizeof info.anchor);
    return info;
}

static void copy_levels(gtx_asset *asset, gtx_section_kind kind, const uint8_t *const *levels)
{
    for (uint32_t k = 0; k < gtx_map_levels(&asset->info, kind); ++k)
        memcpy(*gtx_asset_map(asset, kind, k), levels[k],
               (size_t)gtx_shape_size(gtx_section_shape(&asset->info, kind, k)));
}

static void copy_maps(gtx_asset *asset, const gtx_asset_desc *desc)
{
    const uint8_t *const height = desc->height;
    memcpy(asset->patches, desc->patches, asset->info.patch_count * sizeof(gtx_patch));
    copy_levels(asset, GTX_SECTION_HEIGHT, &height);
    copy_levels(asset, GTX_SECTION_TRIM, &desc->trim);
    copy_levels(asset, GTX_SECTION_NORMAL, desc->normal);
    copy_levels(asset, GTX_SECTION_COLOR, desc->color);
    copy_levels(asset, GTX_SECTION_MATERIAL, desc->material);
    copy_levels(asset, GTX_SECTION_EMISSION, desc->emission);
    for (uint32_t k = 0; k < desc->lod_levels; ++k)
        gtx_lod_store(&desc->lod[k], desc->patch_count, asset->lod[k]);
    if (asset->meta)
        memcpy(asset->meta, desc->meta, asset->meta_size);
}

/* Every rule that content can break. */
static void check_content(gtx_check *check, const gtx_asset *asset)
{
    gtx_occupancy occupancy;
    gtx_check_patches(check, asset, 0, &occupancy);
    if (!gtx_check_over(check))
        gtx_check_maps(check, asset, &occupancy, NULL, &(gtx_map_places){0});
    gtx_occupancy_free(&occupancy, &asset->allocator);
    for (uint32_t k = 0; k < asset->info.lod_levels && !gtx_check_over(check); ++k)
        gtx_check_lod(check, asset, k, 0);
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
    gtx_check_emission(&check, &info);
    if (desc->meta_size > GTX_META_LIMIT)
        gtx_break(&check, GTX_RULE_META, 0, "it has %zu bytes", desc->meta_size);
    if (check.broken)
        return check.result;
    result = check_levels(desc, error);
    if (result)
        return result;

    gtx_allocator allocator = gtx_allocator_or_default(desc->allocator);
    gtx_sizes sizes = {.meta = desc->meta_size};
    for (uint32_t k = 0; k < desc->lod_levels; ++k)
        sizes.lod[k] = gtx_lod_size(desc->patch_count, desc->lod[k].vertex_count,
                                    desc->lod[k].triangle_count) +
                       gtx_lod_normals_size(desc->lod[k].flags, desc->lod[k].vertex_count);
    gtx_asset *asset = gtx_asset_new(&allocator, &info, &sizes, false);
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
