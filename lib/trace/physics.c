/* Points on the surface: the ground below a point, and the colour of a hit. */
#include "trace/caster.h"

#include <math.h>

gtx_result gtx_drop(const gtx_caster *caster, const float up[3], float step,
                    const float (*points)[3], gtx_hit *hits, size_t count, uint32_t flags)
{
    if (!caster || !up || (count && (!points || !hits)) || !(step >= 0) || isinf(step) ||
        flags & ~(uint32_t)GTX_RAY_FLAGS)
        return GTX_ERROR_ARGUMENT;
    const double length = sqrt((double)up[0] * up[0] + (double)up[1] * up[1] +
                               (double)up[2] * up[2]);
    if (!(length > 0) || isinf(length))
        return GTX_ERROR_ARGUMENT;
    gtx_ray ray = {.t_min = -step};
    for (int k = 0; k < 3; ++k)
        ray.direction[k] = (float)(-up[k] / length);
    for (size_t i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k)
            ray.origin[k] = points[i][k];
        const gtx_result result = gtx_raycast(caster, &ray, &hits[i], 1, flags);
        if (result)
            return result;
    }
    return GTX_OK;
}

static float linear(uint8_t srgb)
{
    const double c = srgb / 255.0;
    return (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
}

/* As the GPU reads it: texels are decoded before they are mixed. */
static void look_up(const gtx_asset *asset, const gtx_hit *hit, float out[4])
{
    const gtx_patch *p = &asset->patches[hit->patch];
    const float right = p->rect[2] - 1.0f, top = p->rect[3] - 1.0f;
    const float x = fminf(fmaxf(hit->x, 0), right), y = fminf(fmaxf(hit->y, 0), top);
    const uint32_t i = (uint32_t)fminf(x, right - 1), j = (uint32_t)fminf(y, top - 1);
    const float u = x - (float)i, v = y - (float)j;
    const float weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    for (int c = 0; c < 4; ++c)
        out[c] = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        const size_t row = (size_t)p->page * asset->info.page_height + p->rect[1] + j + (k >> 1);
        const size_t texel = row * asset->info.page_width + p->rect[0] + i + (k & 1);
        const uint8_t *from = asset->color[0] + 4 * texel;
        for (int c = 0; c < 4; ++c)
            out[c] += weight[k] * (c < 3 ? linear(from[c]) : from[c] / 255.0f);
    }
}

gtx_result gtx_hit_colors(const gtx_asset *asset, const gtx_hit *hits, float (*colors)[4],
                          size_t count)
{
    if (!asset || (count && (!hits || !colors)))
        return GTX_ERROR_ARGUMENT;
    for (size_t i = 0; i < count; ++i)
        if (hits[i].patch != UINT32_MAX && (hits[i].patch >= asset->info.patch_count ||
                                            isnan(hits[i].x) || isnan(hits[i].y)))
            return GTX_ERROR_ARGUMENT;
    for (size_t i = 0; i < count; ++i) {
        if (asset->color[0] && hits[i].patch != UINT32_MAX)
            look_up(asset, &hits[i], colors[i]);
        else
            for (int c = 0; c < 4; ++c)
                colors[i][c] = 1;
    }
    return GTX_OK;
}
