/* EAC: a base, and for each texel one of 8 offsets of a table, times a factor (Khronos Data Format
 * Specification 1.3, sections 21.3 and 21.5). */
#include "frame/etc.h"

#include <math.h>
#include <stdbool.h>

enum { TABLES = 16, OFFSETS = 8 };

static const int8_t tables[TABLES][OFFSETS] = {
    {-3, -6, -9, -15, 2, 5, 8, 14}, {-3, -7, -10, -13, 2, 6, 9, 12},
    {-2, -5, -8, -13, 1, 4, 7, 12}, {-2, -4, -6, -13, 1, 3, 5, 12},
    {-3, -6, -8, -12, 2, 5, 7, 11}, {-3, -7, -9, -11, 2, 6, 8, 10},
    {-4, -7, -8, -11, 3, 6, 7, 10}, {-3, -5, -8, -11, 2, 4, 7, 10},
    {-2, -6, -8, -10, 1, 5, 7, 9},  {-2, -5, -8, -10, 1, 4, 7, 9},
    {-2, -4, -8, -10, 1, 3, 7, 9},  {-2, -5, -7, -10, 1, 4, 6, 9},
    {-3, -4, -7, -10, 2, 3, 6, 9},  {-1, -2, -3, -10, 0, 1, 2, 9},
    {-4, -6, -8, -9, 3, 5, 7, 8},   {-3, -5, -7, -9, 2, 4, 6, 8}};

/* Values are counted in bytes; of 11 bits a base is half a step of 8 up, and a factor of 0 is an
 * eighth. */
typedef struct eac {
    int base, factor, table;
    uint8_t code[GTX_BLOCK_TEXELS];
    float error;
} eac;

static float value_of(bool wide, int base, int factor, int offset)
{
    const int step = factor ? 8 * factor * offset : offset;
    if (!wide)
        return fminf(fmaxf((float)(base + factor * offset), 0), 255);
    return fminf(fmaxf((float)(8 * base + 4 + step), 0), 2047) * (255.0f / 2047);
}

static void try_one(const uint8_t *texels, const uint8_t *weights, bool wide, eac e, eac *best)
{
    float values[OFFSETS];
    for (int k = 0; k < OFFSETS; ++k)
        values[k] = value_of(wide, e.base, e.factor, tables[e.table][k]);
    e.error = 0;
    for (int i = 0; i < GTX_BLOCK_TEXELS && e.error < best->error; ++i) {
        float least = INFINITY;
        for (int k = 0; k < OFFSETS; ++k) {
            const float off = values[k] - (float)texels[i];
            if (off * off < least) {
                least = off * off;
                e.code[i] = (uint8_t)k;
            }
        }
        e.error += (float)weights[i] * least;
    }
    if (e.error < best->error)
        *best = e;
}

/* The base that puts a table's middle at the values' middle, and the factor that spans them, of
 * each table, and those next to them. */
static void encode(const uint8_t *texels, const uint8_t *weights, bool wide, uint8_t out[8])
{
    int high = 0, low = 255;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        high = weights[i] && texels[i] > high ? texels[i] : high;
        low = weights[i] && texels[i] < low ? texels[i] : low;
    }
    eac best = {.error = INFINITY};
    for (int table = 0; table < TABLES && best.error > 0; ++table) {
        const int least = tables[table][3], most = tables[table][7];
        const int factor = (high - low + (most - least) / 2) / (most - least);
        for (int f = factor - 1; f <= factor + 1; ++f) {
            const int base = (high + low - f * (most + least)) / 2;
            for (int b = base - 1; b <= base + 1; ++b)
                if (f >= !wide && f <= 15 && b >= 0 && b <= 255)
                    try_one(texels, weights, wide, (eac){.base = b, .factor = f, .table = table},
                            &best);
        }
    }
    uint64_t bits = (uint64_t)best.base << 56 | (uint64_t)best.factor << 52 |
                    (uint64_t)best.table << 48;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) /* columns, the first one highest */
        bits |= (uint64_t)best.code[i] << (45 - 3 * (i % 4 * 4 + i / 4));
    for (int i = 0; i < 8; ++i)
        out[i] = (uint8_t)(bits >> (56 - 8 * i));
}

void gtx_eac_r11_encode(const uint8_t texels[GTX_BLOCK_TEXELS],
                        const uint8_t weights[GTX_BLOCK_TEXELS], uint8_t out[8])
{
    encode(texels, weights, true, out);
}

void gtx_eac_alpha_encode(const uint8_t texels[GTX_BLOCK_TEXELS],
                          const uint8_t weights[GTX_BLOCK_TEXELS], uint8_t out[8])
{
    encode(texels, weights, false, out);
}
