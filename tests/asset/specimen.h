/* A small asset that tests bend. */
#ifndef GTX_TESTS_SPECIMEN_H
#define GTX_TESTS_SPECIMEN_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/codec.h"
#include "asset/golden.h"

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct specimen {
    gtx_patch patches[2];
    uint8_t height[256], trim[256], normal[512];
    const uint8_t *levels[1];
    gtx_asset_desc desc;
} specimen;

static inline void make_specimen(specimen *s)
{
    *s = (specimen){0};
    for (uint32_t i = 0; i < 2; ++i)
        s->patches[i] = (gtx_patch){.extent_x = 1, .axis_x = {1, 0, 0}, .extent_y = 1,
                                    .axis_y = {0, 1, 0}, .extent_z = 1, .axis_z = {0, 0, 1},
                                    .coverage = 1, .rect = {(uint16_t)(8 * i), 0, 8, 8},
                                    .sphere = {0.5f, 0.5f, 0.5f, 1}};
    for (uint32_t y = 0; y < 8; ++y)
        memset(s->height + 16 * y, 100, 16);
    s->levels[0] = s->normal;
    s->desc = (gtx_asset_desc){.patches = s->patches, .patch_count = 2, .page_count = 1,
                               .page_width = 16, .page_height = 16, .mip_count = 1,
                               .height_bits = 8, .height = s->height, .trim = s->trim,
                               .normal = s->levels, .bounds_max = {1, 1, 1}};
}

#endif
