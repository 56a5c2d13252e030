/* Assets whose maps of colour, material and emission vary, by a number. */
#ifndef GTX_TESTS_PAINTED_H
#define GTX_TESTS_PAINTED_H

#include "stage.h"

#include <stdbool.h>

/* A soft pattern of waves, other ones in each channel, and with some noise. */
static inline uint8_t paint_at(uint32_t seed, uint32_t channel, uint32_t x, uint32_t y)
{
    const double a = 0.11 + 0.03 * channel + 0.01 * (seed % 7);
    const uint32_t noise = (x * 73856093u ^ y * 19349663u ^ (seed + channel) * 83492791u) >> 7;
    return (uint8_t)(128 + 90 * sin(a * x + seed) * cos(a * y - channel) + noise % 5);
}

/* A copy of the asset: maps of its own in the patch, in all if that is UINT32_MAX; else those of
 * the asset, which has them then. Materials vary unless told not to. */
static inline gtx_asset *painted(const gtx_asset *asset, uint32_t seed, uint32_t patch,
                                 bool same_material)
{
    static const gtx_map maps[3] = {GTX_MAP_COLOR, GTX_MAP_MATERIAL, GTX_MAP_EMISSION};
    static const uint32_t sizes[3] = {4, 4, 3};
    gtx_info info;
    gtx_get_info(asset, &info);
    const uint8_t *normal[8], *levels[3][8];
    for (uint32_t k = 0; k < info.mip_count; ++k) {
        const uint32_t width = info.page_width >> k, height = info.page_height >> k;
        normal[k] = gtx_map_data(asset, GTX_MAP_NORMAL, k, NULL);
        for (int m = 0; m < 3; ++m) {
            uint8_t *map = malloc((size_t)width * height * sizes[m]);
            const uint8_t *old = gtx_map_data(asset, maps[m], k, NULL);
            for (uint32_t i = 0; i < width * height * sizes[m]; ++i) {
                const uint32_t c = i % sizes[m], x = i / sizes[m] % width, y = i / sizes[m] / width;
                const uint16_t *r = patch == UINT32_MAX ? NULL : gtx_patches(asset)[patch].rect;
                const bool inside = !r || (x << k >= r[0] && x << k < r[0] + (uint32_t)r[2] &&
                                           y << k >= r[1] && y << k < r[1] + (uint32_t)r[3]);
                map[i] = !inside                   ? old[i]
                         : m == 1 && same_material ? (uint8_t)(50 * c + 60)
                         : c == 3                  ? 255
                                                   : paint_at(seed + m, c, x << k, y << k);
            }
            levels[m][k] = map;
        }
    }
    gtx_asset_desc desc = {
        .patches = gtx_patches(asset), .patch_count = info.patch_count,
        .page_count = info.page_count, .page_width = info.page_width,
        .page_height = info.page_height, .mip_count = info.mip_count,
        .height_bits = info.height_bits, .height = gtx_map_data(asset, GTX_MAP_HEIGHT, 0, NULL),
        .trim = gtx_map_data(asset, GTX_MAP_TRIM, 0, NULL), .normal = normal, .color = levels[0],
        .material = levels[1], .emission = levels[2], .unit = 1, .emission_scale = 0.2f};
    memcpy(desc.bounds_min, info.bounds_min, sizeof desc.bounds_min);
    memcpy(desc.bounds_max, info.bounds_max, sizeof desc.bounds_max);
    gtx_asset *out = NULL;
    gtx_error error = {0};
    must(gtx_create(&desc, &out, &error), &error);
    for (int m = 0; m < 3; ++m)
        for (uint32_t k = 0; k < info.mip_count; ++k)
            free((void *)(uintptr_t)levels[m][k]);
    return out;
}

#endif
