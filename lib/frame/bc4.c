/* BC4: two bytes and 8 values from one to the other (Khronos Data Format Specification 1.3,
 * section 18.5). */
#include "frame/bc.h"

#include <math.h>
#include <stdbool.h>

enum { STEPS = 7 };

/* Two ends, `high` above `low`, each texel's step from high to low, and what is lost by them. */
typedef struct bc4 {
    int high, low;
    uint8_t step[GTX_BLOCK_TEXELS];
    float error;
} bc4;

static void fit(const uint8_t *texels, const uint8_t *weights, bc4 *b)
{
    const float range = (float)(b->high - b->low), scale = STEPS / range;
    b->error = 0;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        const float down = (float)(b->high - texels[i]);
        const float step = fminf(fmaxf(floorf(down * scale + 0.5f), 0), STEPS);
        const float off = down - step * range / STEPS;
        b->step[i] = (uint8_t)step;
        b->error += (float)weights[i] * off * off;
    }
}

/* Takes ends that lose less. */
static bool try_ends(const uint8_t *texels, const uint8_t *weights, int high, int low, bc4 *best)
{
    bc4 b = {.high = high, .low = low};
    if (high <= low || high > 255 || low < 0)
        return false;
    fit(texels, weights, &b);
    if (!(b.error < best->error))
        return false;
    *best = b;
    return true;
}

/* The ends that lose least with the steps as they are, by least squares, and those about them. */
static bool refine(const uint8_t *texels, const uint8_t *weights, bc4 *best)
{
    float aa = 0, ab = 0, bb = 0, at = 0, bt = 0;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        const float w = weights[i], b = (float)best->step[i] / STEPS, a = 1 - b;
        aa += w * a * a;
        ab += w * a * b;
        bb += w * b * b;
        at += w * a * texels[i];
        bt += w * b * texels[i];
    }
    const float det = aa * bb - ab * ab;
    if (!(det > 1e-6f))
        return false;
    const float high = (at * bb - bt * ab) / det, low = (bt * aa - at * ab) / det;
    bool better = false;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            better |= try_ends(texels, weights, (int)lrintf(high) + i, (int)lrintf(low) + j, best);
    return better;
}

static void write(const bc4 *b, uint8_t out[8])
{
    uint64_t bits = 0;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        const uint64_t code = b->step[i] == 0 ? 0 : b->step[i] == STEPS ? 1 : b->step[i] + 1u;
        bits |= code << (3 * i);
    }
    out[0] = (uint8_t)b->high;
    out[1] = (uint8_t)b->low;
    for (int i = 0; i < 6; ++i)
        out[2 + i] = (uint8_t)(bits >> (8 * i));
}

void gtx_bc4_encode(const uint8_t texels[GTX_BLOCK_TEXELS],
                    const uint8_t weights[GTX_BLOCK_TEXELS], uint8_t out[8])
{
    enum { MAX_ROUNDS = 4, NEAR = 2 };
    int high = 0, low = 255;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        high = weights[i] && texels[i] > high ? texels[i] : high;
        low = weights[i] && texels[i] < low ? texels[i] : low;
    }
    if (high == low) /* ends must differ */
        high < 255 ? ++high : --low;
    bc4 best = {.high = high, .low = low};
    fit(texels, weights, &best);
    for (int i = 0; i < MAX_ROUNDS && best.error > 0 && refine(texels, weights, &best); ++i)
        ;
    high = best.high;
    low = best.low;
    for (int i = -NEAR; i <= NEAR && best.error > 0; ++i)
        for (int j = -NEAR; j <= NEAR; ++j)
            try_ends(texels, weights, high + i, low + j, &best);
    write(&best, out);
}
