/* BC7, mode 6: two ends of 7 bits a channel and one that its four share, and 16 steps between them
 * (Khronos Data Format Specification 1.3, section 20). */
#include "frame/ends.h"

#include <math.h>
#include <string.h>

enum { STEPS = 16, CHANNELS = GTX_CHANNELS };

static const uint8_t shares[STEPS] = {0,  4,  9,  13, 17, 21, 26, 30,
                                      34, 38, 43, 47, 51, 55, 60, 64};

/* The ends as bytes, each texel's step, and what is lost by them. */
typedef struct bc7 {
    uint8_t end[2][CHANNELS];
    uint8_t step[GTX_BLOCK_TEXELS];
    float error;
} bc7;

/* The byte nearest to a value whose lowest bit is `bit`. */
static uint8_t byte_of(float value, int bit)
{
    const float half = floorf((value - (float)bit) / 2 + 0.5f);
    return (uint8_t)(2 * (int)fminf(fmaxf(half, 0), 127) + bit);
}

static void fit(const gtx_texels *texels, const uint8_t *weights, bc7 *b)
{
    float way[CHANNELS], square = 0, shade[STEPS][CHANNELS];
    for (int c = 0; c < CHANNELS; ++c) {
        way[c] = (float)(b->end[1][c] - b->end[0][c]);
        square += way[c] * way[c];
        for (int s = 0; s < STEPS; ++s)
            shade[s][c] = (float)((b->end[0][c] * (64 - shares[s]) + b->end[1][c] * shares[s] + 32)
                                  >> 6);
    }
    const float scale = square > 0 ? (STEPS - 1) / square : 0;
    b->error = 0;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        float along = 0;
        for (int c = 0; c < CHANNELS; ++c)
            along += way[c] * (float)(texels->at[i][c] - b->end[0][c]);
        const int s = (int)fminf(fmaxf(floorf(along * scale + 0.5f), 0), STEPS - 1);
        float off = 0;
        for (int c = 0; c < CHANNELS; ++c) {
            const float d = (float)texels->at[i][c] - shade[s][c];
            off += d * d;
        }
        b->step[i] = (uint8_t)s;
        b->error += (float)weights[i] * off;
    }
}

/* What is opaque stays so: the shared bits are 1 then. */
static bool is_opaque(const gtx_texels *texels, const uint8_t *weights)
{
    bool all = true;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i)
        all = all && (!weights[i] || texels->at[i][3] == 255);
    return all;
}

/* Takes ends that lose less, with each choice of the shared bits. */
static bool try_ends(const gtx_texels *texels, const uint8_t *weights, gtx_ends ends, bc7 *best)
{
    bool better = false;
    for (int bits = is_opaque(texels, weights) ? 3 : 0; bits < 4; ++bits) {
        bc7 b;
        for (int e = 0; e < 2; ++e)
            for (int c = 0; c < CHANNELS; ++c)
                b.end[e][c] = byte_of(ends[e][c], bits >> e & 1);
        fit(texels, weights, &b);
        if (b.error < best->error) {
            *best = b;
            better = true;
        }
    }
    return better;
}

/* Bits of a block, the lowest first. */
typedef struct writer {
    uint8_t *out;
    int at;
} writer;

static void put(writer *w, uint32_t value, int count)
{
    for (int i = 0; i < count; ++i, ++w->at)
        w->out[w->at / 8] |= (uint8_t)((value >> i & 1) << w->at % 8);
}

/* The first step's highest bit is not written: it must be 0. */
static void write(const bc7 *b, uint8_t out[16])
{
    const int first = b->step[0] >= STEPS / 2; /* of the ends */
    writer w = {out, 0};
    memset(out, 0, 16);
    put(&w, 1 << 6, 7);
    for (int c = 0; c < CHANNELS; ++c)
        for (int e = 0; e < 2; ++e)
            put(&w, b->end[e ^ first][c] >> 1, 7);
    for (int e = 0; e < 2; ++e)
        put(&w, b->end[e ^ first][0] & 1, 1);
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i)
        put(&w, first ? STEPS - 1u - b->step[i] : b->step[i], i ? 4 : 3);
}

void gtx_bc7_encode(const gtx_texels *texels, const uint8_t weights[GTX_BLOCK_TEXELS],
                    uint8_t out[16])
{
    enum { MAX_ROUNDS = 3 };
    gtx_ends ends;
    float share[STEPS];
    bc7 best = {.error = INFINITY};
    for (int s = 0; s < STEPS; ++s)
        share[s] = shares[s] / 64.0f;
    gtx_first_ends(texels, weights, ends);
    try_ends(texels, weights, ends, &best);
    for (int i = 0; i < MAX_ROUNDS && best.error > 0; ++i)
        if (!gtx_solve_ends(texels, weights, best.step, share, ends) ||
            !try_ends(texels, weights, ends, &best))
            break;
    write(&best, out);
}
