/* What the sections of an asset are: types, formats, sizes, order and hashes. */
#include "asset/order.h"

typedef struct kind_row {
    char type[5];
    uint32_t flags;
    uint32_t format;              /* VkFormat; of 8-bit heights */
    uint32_t texel;               /* bytes; of 8-bit heights */
    bool levels;
} kind_row;

#define MUST 1u
#define FORMAT_R16_UINT 74u

static const kind_row kinds[] = {
    [GTX_SECTION_PATCHES] = {"PTCH", MUST, 0, 0, false},
    [GTX_SECTION_HEIGHT] = {"HGHT", MUST, 13, 1, false},
    [GTX_SECTION_TRIM] = {"TRIM", MUST, 9, 1, false},
    [GTX_SECTION_NORMAL] = {"NRML", MUST, 16, 2, true},
    [GTX_SECTION_COLOR] = {"COLR", 0, 43, 4, true},
    [GTX_SECTION_MATERIAL] = {"MATL", 0, 37, 4, true},
    [GTX_SECTION_EMISSION] = {"EMIT", 0, 29, 3, true},
    [GTX_SECTION_LOD] = {"LODM", 0, 0, 0, false},
    [GTX_SECTION_UNKNOWN] = {"BLKS", 0, 0, 0, false}, /* of what assets keep */
    [GTX_SECTION_META] = {"META", 0, 0, 0, false},
};

gtx_section_kind gtx_section_kind_of(const uint8_t type[4])
{
    for (int kind = GTX_SECTION_PATCHES; kind <= GTX_SECTION_META; ++kind)
        if (kind != GTX_SECTION_UNKNOWN && !memcmp(kinds[kind].type, type, 4))
            return (gtx_section_kind)kind;
    return GTX_SECTION_UNKNOWN;
}

uint32_t gtx_section_levels(gtx_section_kind kind, uint32_t mip_count)
{
    if (kind == GTX_SECTION_LOD)
        return GTX_MAX_LODS;
    return kinds[kind].levels ? mip_count : 1;
}

uint32_t gtx_map_levels(const gtx_info *info, gtx_section_kind kind)
{
    switch (kind) {
    case GTX_SECTION_HEIGHT:
    case GTX_SECTION_TRIM: return 1;
    case GTX_SECTION_NORMAL: return info->mip_count;
    case GTX_SECTION_COLOR: return info->has_color ? info->mip_count : 0;
    case GTX_SECTION_MATERIAL: return info->has_material ? info->mip_count : 0;
    case GTX_SECTION_EMISSION: return info->has_emission ? info->mip_count : 0;
    default: return 0;
    }
}

gtx_map_shape gtx_section_shape(const gtx_info *info, gtx_section_kind kind, uint32_t level)
{
    if (!gtx_section_is_image(kind))
        return (gtx_map_shape){0};
    uint32_t texel = kinds[kind].texel;
    if (kind == GTX_SECTION_HEIGHT)
        texel = info->height_bits / 8;
    return (gtx_map_shape){info->page_count, info->page_width >> level, info->page_height >> level,
                       texel};
}

gtx_section gtx_section_describe(const gtx_info *info, gtx_section_kind kind, uint32_t level)
{
    gtx_section section = {.kind = kind, .flags = kinds[kind].flags, .level = level,
                           .format = kinds[kind].format};
    memcpy(section.type, kinds[kind].type, 4);
    if (kind == GTX_SECTION_HEIGHT && info->height_bits == 16)
        section.format = FORMAT_R16_UINT;
    section.size = gtx_shape_size(gtx_section_shape(info, kind, level));
    if (kind == GTX_SECTION_PATCHES)
        section.size = (uint64_t)info->patch_count * sizeof(gtx_patch);
    return section;
}

uint32_t gtx_asset_sections(const gtx_asset *asset, gtx_section out[GTX_MAX_KNOWN_SECTIONS])
{
    uint32_t count = 0;
    for (int kind = GTX_SECTION_PATCHES; kind <= GTX_SECTION_META; ++kind) {
        uint32_t level = gtx_section_levels((gtx_section_kind)kind, asset->info.mip_count);
        while (level-- > 0) {
            const void *data = gtx_asset_data(asset, (gtx_section_kind)kind, level);
            if (!data)
                continue;
            gtx_section *section = &out[count++];
            *section = gtx_section_describe(&asset->info, (gtx_section_kind)kind, level);
            if (kind == GTX_SECTION_META)
                section->size = asset->meta_size;
            if (kind == GTX_SECTION_UNKNOWN)
                section->size = asset->blocks_size;
            if (kind == GTX_SECTION_LOD)
                section->size = asset->lod_size[level];
            section->hash = gtx_hash_section(asset, section, data);
        }
    }
    if (asset->lod[0]) {
        const gtx_section patches = out[0];
        out[0] = out[1]; /* the coarsest LOD mesh, which can be shown alone */
        out[1] = patches;
    }
    return count;
}

uint8_t **gtx_asset_map(gtx_asset *asset, gtx_section_kind kind, uint32_t level)
{
    switch (kind) {
    case GTX_SECTION_HEIGHT: return &asset->height;
    case GTX_SECTION_TRIM: return &asset->trim;
    case GTX_SECTION_NORMAL: return &asset->normal[level];
    case GTX_SECTION_COLOR: return &asset->color[level];
    case GTX_SECTION_MATERIAL: return &asset->material[level];
    case GTX_SECTION_EMISSION: return &asset->emission[level];
    default: return NULL;
    }
}

void *gtx_asset_data(const gtx_asset *asset, gtx_section_kind kind, uint32_t level)
{
    uint8_t **map = gtx_asset_map((gtx_asset *)asset, kind, level);
    if (map)
        return *map;
    if (kind == GTX_SECTION_PATCHES)
        return asset->patches;
    if (kind == GTX_SECTION_LOD)
        return asset->lod[level];
    if (kind == GTX_SECTION_UNKNOWN)
        return asset->blocks;
    return kind == GTX_SECTION_META ? asset->meta : NULL;
}

uint64_t gtx_content_hash(const gtx_section *sections, uint32_t count)
{
    gtx_hash hash;
    gtx_hash_begin(&hash);
    for (uint32_t i = 0; i < count; ++i) {
        if (sections[i].kind == GTX_SECTION_META)
            continue;
        uint8_t bytes[8];
        gtx_store_u64(bytes, sections[i].hash);
        gtx_hash_add(&hash, bytes, 8);
    }
    return gtx_hash_end(&hash);
}
