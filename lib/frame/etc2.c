/* ETC2 of three channels: two halves with a colour and a table of brighter and darker each, as
 * ETC1 has them, or a plane (Khronos Data Format Specification 1.3, sections 21.1 and 21.1.7). */
#include "frame/etc.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { TABLES = 8, CHANNELS = 3 };

static const int tables[TABLES][2] = {{2, 8},   {5, 17},  {9, 29},   {13, 42},
                                      {18, 60}, {24, 80}, {33, 106}, {47, 183}};

typedef struct etc2 {
    uint64_t bits;
    float error;
} etc2;

static float clamp_byte(float value)
{
    return fminf(fmaxf(value, 0), 255);
}

static int nearest(float value, int most)
{
    return (int)fminf(fmaxf(floorf(value * (float)most / 255 + 0.5f), 0), (float)most);
}

static uint64_t place(int value, int at)
{
    return (uint64_t)(unsigned)value << at;
}

/* A texel's half. */
static int half_of(int i, int flip)
{
    return (flip ? i / 4 : i % 4) / 2;
}

/* What a half loses by a colour, with its best table; adds the codes of its texels. */
static float fit_half(const gtx_texels *texels, const uint8_t *weights, int flip, int half,
                      const float color[CHANNELS], int *table, uint64_t *codes)
{
    float best = INFINITY;
    uint64_t best_codes = 0;
    for (int t = 0; t < TABLES; ++t) {
        float error = 0;
        uint64_t all = 0;
        for (int i = 0; i < GTX_BLOCK_TEXELS && error < best; ++i) {
            float least = INFINITY;
            uint64_t code = 0;
            if (half_of(i, flip) != half)
                continue;
            for (unsigned k = 0; k < 4; ++k) {
                const float shift = (float)(k & 2 ? -tables[t][k & 1] : tables[t][k & 1]);
                float off = 0;
                for (int c = 0; c < CHANNELS; ++c) {
                    const float d = clamp_byte(color[c] + shift) - (float)texels->at[i][c];
                    off += d * d;
                }
                if (off < least) {
                    least = off;
                    code = k;
                }
            }
            const int at = i % 4 * 4 + i / 4; /* columns */
            all |= (code & 1) << at | code >> 1 << (16 + at);
            error += (float)weights[i] * least;
        }
        if (error < best) {
            best = error;
            best_codes = all;
            *table = t;
        }
    }
    *codes |= best_codes;
    return best;
}

/* The mean of a half's texels, and of those alone that weigh nothing if there are no others. */
static void mean_of(const gtx_texels *texels, const uint8_t *weights, int flip, int half,
                    float mean[CHANNELS])
{
    float sum = 0;
    memset(mean, 0, CHANNELS * sizeof *mean);
    for (int pass = 0; pass < 2 && !(sum > 0); ++pass)
        for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
            const float w = half_of(i, flip) == half ? (pass ? 1 : weights[i]) : 0;
            sum += w;
            for (int c = 0; c < CHANNELS; ++c)
                mean[c] += w * texels->at[i][c];
        }
    for (int c = 0; c < CHANNELS; ++c)
        mean[c] /= sum;
}

/* Colours of 5 bits whose second is near the first, or of 4 bits each. */
static void try_halves(const gtx_texels *texels, const uint8_t *weights, int flip, bool near,
                       etc2 *best)
{
    etc2 e = {place(near, 33) | place(flip, 32), 0};
    int first[CHANNELS] = {0};
    for (int half = 0; half < 2; ++half) {
        float mean[CHANNELS], color[CHANNELS];
        int table = 0;
        mean_of(texels, weights, flip, half, mean);
        for (int c = 0; c < CHANNELS; ++c) {
            int v = nearest(mean[c], near ? 31 : 15);
            if (near && half) {
                const int d = v - first[c];
                v = first[c] + (d < -4 ? -4 : d > 3 ? 3 : d);
                e.bits |= place((v - first[c]) & 7, 56 - 8 * c);
            } else {
                e.bits |= place(v, near ? 59 - 8 * c : 60 - 8 * c - 4 * half);
                first[c] = v;
            }
            color[c] = (float)(near ? v << 3 | v >> 2 : v * 17);
        }
        e.error += fit_half(texels, weights, flip, half, color, &table, &e.bits);
        e.bits |= place(table, 37 - 3 * half);
    }
    if (e.error < best->error)
        *best = e;
}

/* A channel as a plane o + x h + y v, by least squares with so much towards flatness that a block
 * of few texels has an answer. */
static void fit_plane(const gtx_texels *texels, const uint8_t *weights, int c, float out[3])
{
    float a[3][4] = {{0, 0, 0, 0}, {0, 1e-3f, 0, 0}, {0, 0, 1e-3f, 0}};
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        const float row[4] = {1, (float)(i % 4), (float)(i / 4), texels->at[i][c]};
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 4; ++k)
                a[j][k] += (float)weights[i] * row[j] * row[k];
    }
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
            const float share = i == j ? 0 : a[i][j] / a[j][j];
            for (int k = j; k < 4; ++k)
                a[i][k] -= share * a[j][k];
        }
    for (int j = 0; j < 3; ++j)
        out[j] = a[j][3] / a[j][j];
}

/* Bits that say nothing are so that red and green look like those of two halves and blue does
 * not. */
static uint64_t mark_plane(uint64_t bits)
{
    static const int spare[] = {63, 55, 47, 46, 45, 42};
    for (unsigned choice = 0; choice < 64; ++choice) {
        uint64_t b = bits;
        bool within[CHANNELS];
        for (unsigned k = 0; k < 6; ++k)
            b |= (uint64_t)(choice >> k & 1) << spare[k];
        for (int c = 0; c < CHANNELS; ++c) {
            const int v = (int)(b >> (59 - 8 * c) & 31), d = (int)(b >> (56 - 8 * c) & 7);
            const int sum = v + (d > 3 ? d - 8 : d);
            within[c] = sum >= 0 && sum <= 31;
        }
        if (within[0] && within[1] && !within[2])
            return b;
    }
    return 0;
}

static void try_plane(const gtx_texels *texels, const uint8_t *weights, etc2 *best)
{
    int code[CHANNELS][3], value[CHANNELS][3];
    float error = 0;
    for (int c = 0; c < CHANNELS; ++c) {
        float p[3];
        fit_plane(texels, weights, c, p);
        for (int k = 0; k < 3; ++k) {
            const int v = nearest(k ? p[0] + 4 * p[k] : p[0], c == 1 ? 127 : 63);
            code[c][k] = v;
            value[c][k] = c == 1 ? v << 1 | v >> 6 : v << 2 | v >> 4;
        }
        for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
            const int o = value[c][0];
            const int at = i % 4 * (value[c][1] - o) + i / 4 * (value[c][2] - o) + 4 * o + 2;
            const int shown = at < 0 ? 0 : at >> 2 > 255 ? 255 : at >> 2;
            const float off = (float)(shown - texels->at[i][c]);
            error += (float)weights[i] * off * off;
        }
    }
    if (!(error < best->error))
        return;
    const int *r = code[0], *g = code[1], *b = code[2];
    const uint64_t bits =
        place(r[0], 57) | place(g[0] >> 6, 56) | place(g[0] & 63, 49) | place(b[0] >> 5, 48) |
        place(b[0] >> 3 & 3, 43) | place(b[0] & 7, 39) | place(r[1] >> 1, 34) | place(1, 33) |
        place(r[1] & 1, 32) | place(g[1], 25) | place(b[1], 19) | place(r[2], 13) |
        place(g[2], 6) | place(b[2], 0);
    const uint64_t marked = mark_plane(bits);
    if (marked)
        *best = (etc2){marked, error};
}

void gtx_etc2_encode(const gtx_texels *texels, const uint8_t weights[GTX_BLOCK_TEXELS],
                     uint8_t out[8])
{
    etc2 best = {.error = INFINITY};
    for (int way = 0; way < 4; ++way)
        try_halves(texels, weights, way & 1, way >> 1, &best);
    try_plane(texels, weights, &best);
    for (int i = 0; i < 8; ++i)
        out[i] = (uint8_t)(best.bits >> (56 - 8 * i));
}
