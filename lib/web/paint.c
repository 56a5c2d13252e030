/* Colours of an asset, painted while it is drawn. Built by emscripten alone; see web.mk. */
#include "asset/asset.h"

#include <emscripten/emscripten.h>

#include <stdbool.h>
#include <stdlib.h>

#define WEB_API EMSCRIPTEN_KEEPALIVE

typedef struct brush {
    float place[3], radius, color[3], strength; /* colour: sRGB, 0..255 */
} brush;

static double squared_distance(const brush *b, const double point[3])
{
    double sum = 0;
    for (int k = 0; k < 3; ++k)
        sum += (point[k] - b->place[k]) * (point[k] - b->place[k]);
    return sum;
}

/* Texels without a height are where the one before them in the row is: what is drawn looks them up,
 * too, from close by. */
static bool paint_texels(gtx_asset *asset, const gtx_patch *p, const brush *b)
{
    const gtx_info *info = &asset->info;
    const double reach = (double)b->radius * b->radius;
    bool touched = false;
    for (uint32_t y = 0; y < p->rect[3]; ++y) {
        uint32_t code = 1 + (uint32_t)gtx_height_steps(info->height_bits) / 2;
        const size_t row = ((size_t)p->page * info->page_height + p->rect[1] + y) *
                           info->page_width + p->rect[0];
        for (uint32_t x = 0; x < p->rect[2]; ++x) {
            const uint32_t there = gtx_height_code(asset, p, x, y);
            uint8_t *texel = asset->color[0] + 4 * (row + x);
            double point[3];
            code = there ? there : code;
            gtx_texel_point(p, x, y, gtx_code_height(code, info->height_bits), point);
            const double near = 1 - squared_distance(b, point) / reach;
            if (!(near > 0))
                continue;
            for (int k = 0; k < 3; ++k) {
                const double all = b->color[k] - texel[k];
                texel[k] = (uint8_t)(texel[k] + b->strength * near * all + 0.5);
            }
            touched = true;
        }
    }
    return touched;
}

/* Each texel of a level from four of the finer one. */
static void coarsen(gtx_asset *asset, const gtx_patch *p)
{
    const gtx_info *info = &asset->info;
    for (uint32_t k = 1; k < info->mip_count; ++k) {
        const uint32_t width = info->page_width >> k, height = info->page_height >> k;
        for (uint32_t y = p->rect[1] >> k; y < (p->rect[1] + p->rect[3]) >> k; ++y)
            for (uint32_t x = p->rect[0] >> k; x < (p->rect[0] + p->rect[2]) >> k; ++x) {
                const size_t row = 8 * (size_t)width; /* bytes of the finer level */
                const uint8_t *from = asset->color[k - 1] +
                                      ((size_t)p->page * height + y) * 2 * row + 8 * (size_t)x;
                uint8_t *to = asset->color[k] + 4 * (((size_t)p->page * height + y) * width + x);
                for (int c = 0; c < 4; ++c)
                    to[c] = (uint8_t)((from[c] + from[c + 4] + from[row + c] + from[row + c + 4] +
                                       2) / 4);
            }
    }
}

/* `brush` is one: at its place it is strongest. Gives the number of patches that it meets, and of
 * each its page and rectangle; valid until the next call. 0 without memory. */
WEB_API const uint32_t *gtxw_paint(gtx_asset *asset, const brush *b)
{
    static uint32_t *out;
    free(out);
    out = malloc((1 + 5 * (size_t)asset->info.patch_count) * sizeof *out);
    if (!out)
        return NULL;
    out[0] = 0;
    for (uint32_t i = 0; i < asset->info.patch_count && asset->color[0]; ++i) {
        const gtx_patch *p = &asset->patches[i];
        const double sphere[3] = {(double)p->sphere[0], (double)p->sphere[1], (double)p->sphere[2]};
        const double reach = (double)p->sphere[3] + b->radius;
        if (squared_distance(b, sphere) > reach * reach || !paint_texels(asset, p, b))
            continue;
        coarsen(asset, p);
        uint32_t *row = out + 1 + 5 * out[0]++;
        row[0] = p->page;
        for (int k = 0; k < 4; ++k)
            row[1 + k] = p->rect[k];
    }
    return out;
}

WEB_API const uint8_t *gtxw_colors(const gtx_asset *asset, uint32_t level)
{
    return asset->color[level];
}
