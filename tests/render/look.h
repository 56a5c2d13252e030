/* Assets of one colour, material and emission all over. */
#ifndef GTX_TESTS_LOOK_H
#define GTX_TESTS_LOOK_H

#include "stage.h"

typedef struct look {
    uint8_t color[4], material[4], emission[3];
} look;

/* The asset again with one colour, material and emission all over; closes the first. */
static inline gtx_asset *repaint(gtx_asset *asset, const look *l)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    const uint8_t *normal[8], *levels[3][8];
    const uint8_t *texel[3] = {l->color, l->material, l->emission};
    const size_t sizes[3] = {4, 4, 3};
    for (uint32_t k = 0; k < info.mip_count; ++k) {
        const size_t count = (size_t)(info.page_width >> k) * (info.page_height >> k);
        normal[k] = gtx_map_data(asset, GTX_MAP_NORMAL, k, NULL);
        for (int m = 0; m < 3; ++m) {
            uint8_t *map = malloc(count * sizes[m]);
            for (size_t i = 0; i < count * sizes[m]; ++i)
                map[i] = texel[m][i % sizes[m]];
            levels[m][k] = map;
        }
    }
    const int shines = l->emission[0] | l->emission[1] | l->emission[2];
    gtx_asset_desc desc = {
        .patches = gtx_patches(asset), .patch_count = info.patch_count,
        .page_count = info.page_count, .page_width = info.page_width,
        .page_height = info.page_height, .mip_count = info.mip_count,
        .height_bits = info.height_bits, .height = gtx_map_data(asset, GTX_MAP_HEIGHT, 0, NULL),
        .trim = gtx_map_data(asset, GTX_MAP_TRIM, 0, NULL), .normal = normal, .color = levels[0],
        .material = levels[1], .emission = shines ? levels[2] : NULL, .unit = 1};
    memcpy(desc.bounds_min, info.bounds_min, sizeof desc.bounds_min);
    memcpy(desc.bounds_max, info.bounds_max, sizeof desc.bounds_max);
    gtx_asset *out = NULL;
    gtx_error error = {0};
    must(gtx_create(&desc, &out, &error), &error);
    for (int m = 0; m < 3; ++m)
        for (uint32_t k = 0; k < info.mip_count; ++k)
            free((void *)(uintptr_t)levels[m][k]);
    gtx_close(asset);
    return out;
}

#endif
