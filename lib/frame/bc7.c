/* BC7, mode 6: two ends of 7 bits a channel and one that its four share, and 16 steps between them
 * (Khronos Data Format Specification 1.3, section 20). */
#include "frame/bc.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { STEPS = 16, CHANNELS = 4 };

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
static bool try_ends(const gtx_texels *texels, const uint8_t *weights,
                     float ends[2][CHANNELS], bc7 *best)
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

/* The ends that lose least with the steps as they are: least squares. False where all steps are
 * one. */
static bool solve(const gtx_texels *texels, const uint8_t *weights, const bc7 *b,
                  float ends[2][CHANNELS])
{
    float aa = 0, ab = 0, bb = 0, at[CHANNELS] = {0}, bt[CHANNELS] = {0};
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        const float w = weights[i], y = shares[b->step[i]] / 64.0f, x = 1 - y;
        aa += w * x * x;
        ab += w * x * y;
        bb += w * y * y;
        for (int c = 0; c < CHANNELS; ++c) {
            at[c] += w * x * texels->at[i][c];
            bt[c] += w * y * texels->at[i][c];
        }
    }
    const float det = aa * bb - ab * ab;
    if (!(det > 1e-6f))
        return false;
    for (int c = 0; c < CHANNELS; ++c) {
        ends[0][c] = (at[c] * bb - bt[c] * ab) / det;
        ends[1][c] = (bt[c] * aa - at[c] * ab) / det;
    }
    return true;
}

/* The direction along which texels stray most from their mean, by the power method. */
static void find_axis(const gtx_texels *texels, const uint8_t *weights,
                      float mean[CHANNELS], float axis[CHANNELS])
{
    enum { TURNS = 6 };
    float sum = 0, spread[CHANNELS][CHANNELS] = {{0}};
    memset(mean, 0, CHANNELS * sizeof *mean);
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        sum += weights[i];
        for (int c = 0; c < CHANNELS; ++c)
            mean[c] += (float)weights[i] * texels->at[i][c];
    }
    for (int c = 0; c < CHANNELS; ++c)
        mean[c] /= sum;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i)
        for (int c = 0; c < CHANNELS; ++c)
            for (int d = 0; d < CHANNELS; ++d)
                spread[c][d] += (float)weights[i] * ((float)texels->at[i][c] - mean[c]) *
                                ((float)texels->at[i][d] - mean[d]);
    int widest = 0;
    for (int c = 1; c < CHANNELS; ++c)
        widest = spread[c][c] > spread[widest][widest] ? c : widest;
    memcpy(axis, spread[widest], CHANNELS * sizeof *axis);
    for (int turn = 0; turn < TURNS; ++turn) {
        float next[CHANNELS] = {0}, most = 0;
        for (int c = 0; c < CHANNELS; ++c) {
            for (int d = 0; d < CHANNELS; ++d)
                next[c] += spread[c][d] * axis[d];
            most = fmaxf(most, fabsf(next[c]));
        }
        for (int c = 0; c < CHANNELS; ++c)
            axis[c] = most > 0 ? next[c] / most : 0;
    }
}

static void first_ends(const gtx_texels *texels, const uint8_t *weights,
                       float ends[2][CHANNELS])
{
    float mean[CHANNELS], axis[CHANNELS], square = 0, least = 0, most = 0;
    find_axis(texels, weights, mean, axis);
    for (int c = 0; c < CHANNELS; ++c)
        square += axis[c] * axis[c];
    for (int i = 0; square > 0 && i < GTX_BLOCK_TEXELS; ++i) {
        float along = 0;
        for (int c = 0; c < CHANNELS; ++c)
            along += axis[c] * ((float)texels->at[i][c] - mean[c]) / square;
        least = weights[i] && along < least ? along : least;
        most = weights[i] && along > most ? along : most;
    }
    for (int c = 0; c < CHANNELS; ++c) {
        ends[0][c] = mean[c] + least * axis[c];
        ends[1][c] = mean[c] + most * axis[c];
    }
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
    enum { MOST = 3 };
    float ends[2][CHANNELS];
    bc7 best = {.error = INFINITY};
    first_ends(texels, weights, ends);
    try_ends(texels, weights, ends, &best);
    for (int i = 0; i < MOST && best.error > 0; ++i)
        if (!solve(texels, weights, &best, ends) || !try_ends(texels, weights, ends, &best))
            break;
    write(&best, out);
}
