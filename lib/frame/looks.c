/* Looks for what spares a model a map or a channel: a material that is the same everywhere is not
 * looked up, and opaque colours are compressed without alpha. */
#include "frame/model.h"

#include <string.h>

static const uint8_t none[4] = {0};

bool gtx_is_material(const uint8_t *texels, size_t count, const uint8_t material[4])
{
    for (size_t i = 0; i < count; ++i)
        if (memcmp(texels + 4 * i, material, 4) != 0 && memcmp(texels + 4 * i, none, 4) != 0)
            return false;
    return true;
}

/* Between patches there is nothing. */
static bool fills_heights(const uint8_t *texels, size_t count, const uint8_t *heights,
                          size_t height_size)
{
    static const uint8_t empty[2] = {0};
    for (size_t i = 0; i < count; ++i)
        if (memcmp(texels + 4 * i, none, 4) == 0 &&
            memcmp(heights + height_size * i, empty, height_size) != 0)
            return false;
    return true;
}

/* The first texel that is not empty. */
static const uint8_t *find_material(const uint8_t *texels, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        if (memcmp(texels + 4 * i, none, 4) != 0)
            return texels + 4 * i;
    return texels;
}

bool gtx_find_constant_material(const gtx_asset *asset, uint8_t out[4])
{
    const gtx_info *info = &asset->info;
    const uint8_t *heights = gtx_map_data(asset, GTX_MAP_HEIGHT, 0, NULL), *material = NULL;
    for (uint32_t k = 0; k < info->mip_count; ++k) {
        size_t size;
        const uint8_t *texels = gtx_map_data(asset, GTX_MAP_MATERIAL, k, &size);
        if (!texels)
            return false;
        if (k == 0)
            material = find_material(texels, size / 4);
        if (!gtx_is_material(texels, size / 4, material))
            return false;
        if (k == 0 && memcmp(material, none, 4) != 0 &&
            !fills_heights(texels, size / 4, heights, info->height_bits / 8))
            return false;
    }
    if (!material)
        return false;
    memcpy(out, material, 4);
    return true;
}

bool gtx_is_opaque(const gtx_asset *asset)
{
    static const uint8_t empty[2] = {0};
    const gtx_info *info = &asset->info;
    const size_t size = info->height_bits / 8;
    const uint8_t *heights = gtx_map_data(asset, GTX_MAP_HEIGHT, 0, NULL);
    size_t bytes;
    const uint8_t *texels = gtx_map_data(asset, GTX_MAP_COLOR, 0, &bytes);
    for (size_t i = 0; texels && i < bytes / 4; ++i)
        if (texels[4 * i + 3] != UINT8_MAX && memcmp(heights + size * i, empty, size) != 0)
            return false;
    return texels != NULL;
}
