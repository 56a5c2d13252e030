/* How far normals stray from those of their mip levels: what a mean normal alone has forgotten. */
#include "frame/model.h"

#include "asset/asset.h"
#include "base/vec.h"

#include <math.h>

/* Texels looked at, of a patch: enough for a tenth of what the mean of all says, and a few
 * microseconds. */
enum { SAMPLES = 256 };

/* Past it a surface is crumpled rather than rough, and a second order of its light says nothing. */
static const float max_deviation = 0.5f;
static const float least_deviation = 1e-3f; /* GTX_LEAST_DEVIATION of geotex_view.glsl */

typedef struct normals {
    const uint8_t *first;     /* of the patch's rectangle at a level */
    size_t row;               /* bytes */
    uint32_t width, height, level;
    const uint8_t *marks;     /* as gtx_asset.marks, from the rectangle on, or NULL */
} normals;

static normals normals_of(const gtx_asset *asset, const gtx_patch *p, uint32_t level)
{
    const size_t width = asset->info.page_width >> level, height = asset->info.page_height >> level;
    const size_t row = p->page * height + (p->rect[1] >> level);
    const size_t first = row * width + (p->rect[0] >> level);
    return (normals){asset->normal[level] + 2 * first, 2 * width, p->rect[2] >> level,
                     p->rect[3] >> level, level, asset->marks ? asset->marks + first : NULL};
}

/* As geotex_surface.glsl looks a normal up at a place in texels of the level, not normalised: codes
 * are mixed, then decoded. */
static gtx_vec3 look_up(const normals *n, float x, float y)
{
    const float u = fminf(fmaxf(x - 0.5f, 0), (float)(n->width - 1));
    const float v = fminf(fmaxf(y - 0.5f, 0), (float)(n->height - 1));
    const uint32_t i = (uint32_t)u, j = (uint32_t)v;
    const float fu = u - (float)i, fv = v - (float)j;
    const uint8_t *low = n->first + j * n->row + 2 * (size_t)i;
    const uint8_t *high = j + 1 < n->height ? low + n->row : low;
    const size_t next = i + 1 < n->width ? 2 : 0;
    float code[2];
    for (int k = 0; k < 2; ++k) {
        const float below = (float)low[k] + fu * ((float)low[k + next] - (float)low[k]);
        const float above = (float)high[k] + fu * ((float)high[k + next] - (float)high[k]);
        code[k] = (below + fv * (above - below)) / 127.5f - 1;
    }
    const float p = (code[0] + code[1]) / 2, q = (code[0] - code[1]) / 2;
    return gtx_v3(p, q, 1 - fabsf(p) - fabsf(q));
}

/* Where in its pixel the normal of a sample is looked up: the R2 sequence (Roberts 2018). */
static float jitter(int sample, float step)
{
    const float at = (float)sample * step;
    return at - floorf(at) - 0.5f;
}

/* The value that as many are below as above; leaves them in another order (Hoare's selection). */
static float median_of(float *values, int count)
{
    const int middle = count / 2;
    for (int low = 0, high = count - 1; low < high;) {
        const float pivot = values[middle];
        int i = low, j = high;
        while (i <= j) {
            while (values[i] < pivot)
                ++i;
            while (pivot < values[j])
                --j;
            if (i > j)
                break;
            const float swapped = values[i];
            values[i++] = values[j];
            values[j--] = swapped;
        }
        if (j < middle)
            low = i;
        if (middle < i)
            high = j;
    }
    return values[middle];
}

/* 1 - the mean cosine, which for directions that stray little is their variance along an axis. It
 * is the median by ln 2 where slopes are normally distributed, and no more is taken: where a few
 * grooves cross a pane, the mean of all would frost the glass. */
static float variance(const gtx_grid *finest, const normals *own, const normals *coarse)
{
    const uint32_t texels = own->width * own->height;
    /* Odd, so that it meets every place of a coarser texel: rectangles are even. */
    const uint32_t step = texels / SAMPLES | 1;
    const float scale = 1.0f / (float)(1u << coarse->level);
    int count = 0;
    float sum = 0, found[2 * SAMPLES];
    for (uint32_t at = 0; at < texels; at += step) {
        const uint32_t column = at % own->width, line = at / own->width;
        if (own->marks ? !own->marks[line * (own->row / 2) + column] : !finest->code[at])
            continue;
        const float x = (float)column + 0.5f, y = (float)line + 0.5f;
        const gtx_vec3 n = look_up(own, x, y);
        const gtx_vec3 m = look_up(coarse, x * scale + jitter(count, 0.7548777f),
                                   y * scale + jitter(count, 0.5698403f));
        found[count] = 1 - gtx_v3_dot(n, m) / sqrtf(gtx_v3_dot(n, n) * gtx_v3_dot(m, m));
        sum += found[count++];
    }
    if (!count)
        return 0;
    const float most = median_of(found, count) / 0.69314718f;
    return fmaxf(fminf(sum / (float)count, most), 0);
}

void gtx_normal_deviation(const gtx_asset *asset, uint32_t patch, const gtx_grid *finest,
                          float (*deviation)[4])
{
    const gtx_patch *p = &asset->patches[patch];
    const normals own = normals_of(asset, p, 0);
    for (uint32_t k = 0; k < GTX_MAX_MIPS; ++k) {
        float found = least_deviation;
        if (k > 0 && k < asset->info.mip_count) {
            const normals coarse = normals_of(asset, p, k);
            found = sqrtf(variance(finest, &own, &coarse));
        }
        deviation[k / 4][k % 4] = fminf(fmaxf(found, least_deviation), max_deviation);
    }
}
