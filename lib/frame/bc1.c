/* BC1 of what is opaque: two ends of 5, 6 and 5 bits, and four steps between them (Khronos Data
 * Format Specification 1.3, section 18.1). */
#include "frame/ends.h"

#include <math.h>

enum { STEPS = 4, COLORS = 3 };

static const uint8_t bits[COLORS] = {5, 6, 5};

/* The ends as codes, each texel's step from the first to the second, and what is lost. */
typedef struct bc1 {
    uint8_t end[2][COLORS];
    uint8_t step[GTX_BLOCK_TEXELS];
    float error;
} bc1;

static uint8_t code_of(float value, int c)
{
    const float most = (float)((1 << bits[c]) - 1);
    return (uint8_t)fminf(fmaxf(floorf(value * most / 255 + 0.5f), 0), most);
}

static float value_of(uint8_t code, int c)
{
    return (float)(code << (8 - bits[c]) | code >> (2 * bits[c] - 8));
}

static void fit(const gtx_texels *texels, const uint8_t *weights, bc1 *b)
{
    float shade[STEPS][COLORS];
    for (int c = 0; c < COLORS; ++c)
        for (int s = 0; s < STEPS; ++s)
            shade[s][c] = ((float)(STEPS - 1 - s) * value_of(b->end[0][c], c) +
                           (float)s * value_of(b->end[1][c], c)) / (STEPS - 1);
    b->error = 0;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        float least = INFINITY;
        for (int s = 0; s < STEPS; ++s) {
            float off = 0;
            for (int c = 0; c < COLORS; ++c) {
                const float d = (float)texels->at[i][c] - shade[s][c];
                off += d * d;
            }
            if (off < least) {
                least = off;
                b->step[i] = (uint8_t)s;
            }
        }
        b->error += (float)weights[i] * least;
    }
}

static bool try_ends(const gtx_texels *texels, const uint8_t *weights, gtx_ends ends, bc1 *best)
{
    bc1 b;
    for (int e = 0; e < 2; ++e)
        for (int c = 0; c < COLORS; ++c)
            b.end[e][c] = code_of(ends[e][c], c);
    fit(texels, weights, &b);
    const bool better = b.error < best->error;
    *best = better ? b : *best;
    return better;
}

static uint32_t packed(const uint8_t end[COLORS])
{
    return (uint32_t)end[0] << 11 | (uint32_t)end[1] << 5 | end[2];
}

/* Steps are those of four colours where the first end's number is the greater one. */
static void write(const bc1 *b, uint8_t out[8])
{
    static const uint8_t codes[STEPS] = {0, 2, 3, 1}, turned[STEPS] = {1, 3, 2, 0};
    const uint32_t ends[2] = {packed(b->end[0]), packed(b->end[1])};
    const bool turn = ends[0] < ends[1];
    uint32_t steps = 0;
    for (uint32_t i = 0; i < GTX_BLOCK_TEXELS && ends[0] != ends[1]; ++i)
        steps |= (uint32_t)(turn ? turned : codes)[b->step[i]] << 2 * i;
    for (int e = 0; e < 2; ++e) {
        out[2 * e] = (uint8_t)ends[e ^ turn];
        out[2 * e + 1] = (uint8_t)(ends[e ^ turn] >> 8);
    }
    for (int k = 0; k < 4; ++k)
        out[4 + k] = (uint8_t)(steps >> 8 * k);
}

void gtx_bc1_encode(const gtx_texels *texels, const uint8_t weights[GTX_BLOCK_TEXELS],
                    uint8_t out[8])
{
    enum { MAX_ROUNDS = 4 };
    static const float share[STEPS] = {0, 1 / 3.0f, 2 / 3.0f, 1};
    gtx_texels opaque = *texels;
    gtx_ends ends;
    bc1 best = {.error = INFINITY};
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i)
        opaque.at[i][3] = 255;
    gtx_first_ends(&opaque, weights, ends);
    try_ends(&opaque, weights, ends, &best);
    for (int i = 0; i < MAX_ROUNDS && best.error > 0; ++i)
        if (!gtx_solve_ends(&opaque, weights, best.step, share, ends) ||
            !try_ends(&opaque, weights, ends, &best))
            break;
    write(&best, out);
}
