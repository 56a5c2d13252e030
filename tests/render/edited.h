/* An asset with one patch edited. */
#ifndef GTX_TESTS_EDITED_H
#define GTX_TESTS_EDITED_H

#include "stage.h"

/* The asset with the colours of one patch turned blue, and its heights halved when asked to. */
static inline gtx_asset *edited(const gtx_asset *asset, uint32_t patch, int halve)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    size_t height_size, color_size[8];
    uint8_t *color[8];
    const uint8_t *normal[8];
    const uint8_t *source = gtx_map_data(asset, GTX_MAP_HEIGHT, 0, &height_size);
    uint8_t *height = malloc(height_size);
    memcpy(height, source, height_size);
    for (uint32_t k = 0; k < info.mip_count; ++k) {
        normal[k] = gtx_map_data(asset, GTX_MAP_NORMAL, k, NULL);
        const void *from = gtx_map_data(asset, GTX_MAP_COLOR, k, &color_size[k]);
        color[k] = malloc(color_size[k]);
        memcpy(color[k], from, color_size[k]);
        const gtx_patch *p = &gtx_patches(asset)[patch];
        for (uint32_t y = p->rect[1] >> k; y < (uint32_t)(p->rect[1] + p->rect[3]) >> k; ++y)
            for (uint32_t x = p->rect[0] >> k; x < (uint32_t)(p->rect[0] + p->rect[2]) >> k; ++x) {
                const size_t texel = (size_t)y * (info.page_width >> k) + x;
                memcpy(color[k] + 4 * texel, (uint8_t[4]){30, 60, 250, 255}, 4);
                if (k == 0 && halve && height[texel])
                    height[texel] = (uint8_t)(height[texel] / 2 + 1);
            }
    }
    gtx_patch *patches = malloc(info.patch_count * sizeof *patches);
    memcpy(patches, gtx_patches(asset), info.patch_count * sizeof *patches);
    for (uint32_t i = 0; i < info.patch_count; ++i)
        patches[i].sphere[3] *= 2; /* around the sunken texels too */
    gtx_asset_desc desc = {
        .patches = patches, .patch_count = info.patch_count, .page_count = info.page_count,
        .page_width = info.page_width, .page_height = info.page_height,
        .mip_count = info.mip_count, .height_bits = info.height_bits, .height = height,
        .trim = gtx_map_data(asset, GTX_MAP_TRIM, 0, NULL), .normal = normal,
        .color = (const uint8_t *const *)color, .unit = 1};
    memcpy(desc.bounds_min, info.bounds_min, sizeof desc.bounds_min);
    memcpy(desc.bounds_max, info.bounds_max, sizeof desc.bounds_max);
    gtx_asset *out = NULL;
    gtx_error error = {0};
    must(gtx_create(&desc, &out, &error), &error);
    for (uint32_t k = 0; k < info.mip_count; ++k)
        free(color[k]);
    free(height);
    free(patches);
    return out;
}

#endif
