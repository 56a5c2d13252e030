/* UASTC: blocks of 4 x 4 texels in 19 modes, a subset of ASTC. Sections are those of chapter 25 of
 * the Khronos Data Format Specification 1.4. */
#include "image/basis.h"
#include "image/bits.h"

#include <string.h>

enum { SOLID = 8, MODES = 19, TEXELS = 16 };

/* Table "Mode Index encoding", and what follows from the tables of 25.4. */
static const struct mode {
    uint8_t code, code_bits;
    uint8_t hints;                   /* bits that only serve to encode anew, before the pattern */
    uint8_t pattern_bits, selects;   /* selects: the channel of the second plane is told */
    uint8_t subsets, planes, channels;   /* channels: 2 is grey and alpha */
    uint8_t end_bits, radix;         /* radix: 3 or 5 where trits or quints stand above the bits */
    uint8_t weight_bits;
} modes[MODES] = {
    {0x01, 4, 15, 0, 0, 1, 1, 3, 6, 3, 4}, {0x35, 6, 15, 0, 0, 1, 1, 3, 8, 0, 2},
    {0x1d, 5, 15, 5, 0, 2, 1, 3, 4, 0, 3}, {0x03, 5, 15, 4, 0, 3, 1, 3, 2, 3, 2},
    {0x13, 5, 15, 5, 0, 2, 1, 3, 3, 5, 2}, {0x0b, 5, 15, 0, 0, 1, 1, 3, 8, 0, 3},
    {0x1b, 5, 15, 0, 1, 1, 2, 3, 5, 5, 2}, {0x07, 5, 15, 5, 0, 2, 1, 3, 3, 5, 2},
    {0x17, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0},  {0x0f, 5, 23, 5, 0, 2, 1, 4, 4, 0, 2},
    {0x02, 3, 17, 0, 0, 1, 1, 4, 4, 3, 4}, {0x00, 2, 17, 0, 1, 1, 2, 4, 4, 3, 2},
    {0x06, 3, 17, 0, 0, 1, 1, 4, 6, 3, 3}, {0x1f, 5, 23, 0, 1, 1, 2, 4, 8, 0, 1},
    {0x0d, 5, 23, 0, 0, 1, 1, 4, 8, 0, 2}, {0x05, 7, 23, 0, 0, 1, 1, 2, 8, 0, 4},
    {0x15, 6, 23, 5, 0, 2, 1, 2, 8, 0, 2}, {0x25, 6, 23, 0, 0, 1, 2, 2, 8, 0, 2},
    {0x09, 4, 15, 0, 0, 1, 1, 3, 5, 0, 5}};

/* Which texels are of the second subset, a bit each, or of which one of three, two bits each. */
static const uint16_t halves_of_mode_7[] = {
    0x00f0, 0x4444, 0x0133, 0xcc80, 0xf0ff, 0x2222, 0xffc8, 0xccce, 0x3c03, 0x00ee,
    0x7700, 0x3003, 0x00ce, 0xff80, 0x6fff, 0x1333, 0x11ff, 0x136c, 0x00ef};
static const uint16_t halves[] = {
    0xcccc, 0x8888, 0x1111, 0xecc8, 0x377f, 0xfeec, 0x0137, 0x137f, 0xc800, 0x0013,
    0xfe80, 0x17ff, 0x0017, 0x00ff, 0xfff0, 0x0fff, 0xff71, 0x8eff, 0x08ce, 0x008c,
    0x7310, 0xceff, 0x7331, 0x088c, 0xceef, 0x6666, 0xf00f, 0x5555, 0x0f0f, 0x36c9};
static const uint32_t thirds[] = {
    0xa5a50000, 0xaa005555, 0xaa000055, 0x0000aa55, 0x25252525, 0x94949494,
    0x58585858, 0x56560202, 0x92929292, 0x55aa0055, 0xa05050a0};

/* Two bits a texel; UINT32_MAX where the table has no such pattern. */
static uint32_t pattern(uint32_t number, uint32_t mode)
{
    const int is_7 = mode == 7;
    const uint16_t *table = is_7 ? halves_of_mode_7 : halves;
    const size_t count = (is_7 ? sizeof halves_of_mode_7 : sizeof halves) / sizeof *table;
    uint32_t out = 0;
    if (modes[mode].subsets == 3)
        return number < sizeof thirds / sizeof *thirds ? thirds[number] : UINT32_MAX;
    if (number >= count)
        return UINT32_MAX;
    for (uint32_t i = 0; i < TEXELS; ++i)
        out |= (uint32_t)(table[number] >> i & 1) << 2 * i;
    return out;
}

/* ---- end points ---- */

/* "Unquantizing endpoints": ASTC's way, for the five kinds of numbers that there are. */
static uint8_t unquantized(uint32_t high, uint32_t bits, const struct mode *m)
{
    const uint32_t invert = bits & 1 ? 0x1ff : 0, b = bits >> 1;
    uint32_t step, offset;
    switch (8 * m->radix + m->end_bits) {
    case 8 * 3 + 2: step = 93; offset = b << 8 | b << 4 | b << 2 | b << 1; break;
    case 8 * 3 + 4: step = 22; offset = b << 6 | b; break;
    case 8 * 3 + 6: step = 5; offset = b << 4 | b >> 4; break;
    case 8 * 5 + 3: step = 26; offset = b << 7 | b << 1 | b >> 1; break;
    case 8 * 5 + 5: step = 6; offset = b << 5 | b >> 3; break;
    default: /* bits alone, repeated downwards */
        return (uint8_t)(bits << (8 - m->end_bits) | bits >> (2 * m->end_bits - 8));
    }
    const uint32_t value = (high * step + offset) ^ invert;
    return (uint8_t)((invert & 0x80) | value >> 2);
}

/* The digits above the bits, packed 5 trits to 8 bits or 3 quints to 7, the last ones to fewer. */
static void take_digits(gtx_bits *bits, uint32_t radix, uint32_t count, uint8_t *digits)
{
    static const uint8_t trit_bits[] = {0, 2, 4, 5, 7, 8}, quint_bits[] = {0, 3, 5, 7};
    const uint32_t most = radix == 3 ? 5 : 3;
    memset(digits, 0, count);
    for (uint32_t at = 0; radix && at < count; at += most) {
        const uint32_t here = count - at < most ? count - at : most;
        uint32_t packed = gtx_take_bits(bits, (radix == 3 ? trit_bits : quint_bits)[here]);
        for (uint32_t i = 0; i < here; ++i, packed /= radix)
            digits[at + i] = (uint8_t)(packed % radix);
    }
}

/* Per subset the low and the high end of each channel, as RGBA. */
static void take_ends(gtx_bits *bits, const struct mode *m, uint8_t ends[3][2][4])
{
    uint8_t digits[18];
    const uint32_t count = 2u * m->channels * m->subsets;
    take_digits(bits, m->radix, count, digits);
    memset(ends, 255, 3 * 2 * 4);
    for (uint32_t i = 0; i < count; ++i) {
        const uint8_t value = unquantized(digits[i], gtx_take_bits(bits, m->end_bits), m);
        const uint32_t subset = i / (2u * m->channels), channel = i / 2 % m->channels;
        uint8_t *end = ends[subset][i & 1];
        if (m->channels != 2)
            end[channel] = value;
        else if (channel)
            end[3] = value;
        else
            memset(end, value, 3);
    }
}

/* ---- weights ---- */

/* Of n bits, as 0..64. */
static uint32_t weight_of(uint32_t bits, uint32_t n)
{
    uint32_t value = 0;
    for (int shift = 6 - (int)n; shift > -(int)n; shift -= (int)n)
        value |= shift >= 0 ? bits << shift : bits >> -shift;
    return value + (value > 32);
}

/* The first texel of each subset has a bit less, which is 0. */
static void take_weights(gtx_bits *bits, const struct mode *m, uint32_t subset_of,
                         uint8_t weights[2][TEXELS])
{
    uint32_t seen = 0;
    for (uint32_t i = 0; i < TEXELS; ++i) {
        const uint32_t subset = subset_of >> 2 * i & 3;
        const uint32_t count = m->weight_bits - !(seen >> subset & 1);
        seen |= 1u << subset;
        for (uint32_t plane = 0; plane < m->planes; ++plane)
            weights[plane][i] = (uint8_t)weight_of(gtx_take_bits(bits, count), m->weight_bits);
    }
}

/* As transcoders do, of sRGB colours too: what GPUs make of those differs by 1 at most. */
static uint8_t between(uint32_t low, uint32_t high, uint32_t weight)
{
    return (uint8_t)((257 * (low * (64 - weight) + high * weight) + 32) >> 14);
}

/* MODES where there is no such mode. */
static uint32_t take_mode(gtx_bits *bits)
{
    for (uint32_t i = 0; i < MODES; ++i) {
        gtx_bits ahead = *bits;
        if (gtx_take_bits(&ahead, modes[i].code_bits) == modes[i].code) {
            *bits = ahead;
            return i;
        }
    }
    return MODES;
}

static void fill(uint8_t texels[64], uint8_t r, uint8_t g, uint8_t b, uint8_t a)
{
    for (uint32_t i = 0; i < TEXELS; ++i, texels += 4) {
        texels[0] = r;
        texels[1] = g;
        texels[2] = b;
        texels[3] = a;
    }
}

void gtx_uastc_decode(const uint8_t *block, uint8_t texels[64])
{
    gtx_bits bits = {block, GTX_UASTC_BLOCK, 0, 0};
    const uint32_t mode = take_mode(&bits);
    uint8_t ends[3][2][4], weights[2][TEXELS];
    uint32_t subset_of = 0;
    if (mode == SOLID) {
        uint8_t c[4];
        for (int k = 0; k < 4; ++k)
            c[k] = (uint8_t)gtx_take_bits(&bits, 8);
        fill(texels, c[0], c[1], c[2], c[3]);
        return;
    }
    if (mode < MODES) {
        bits.at += modes[mode].hints;
        if (modes[mode].pattern_bits)
            subset_of = pattern(gtx_take_bits(&bits, modes[mode].pattern_bits), mode);
    }
    if (mode == MODES || subset_of == UINT32_MAX) {
        fill(texels, 255, 0, 255, 255);
        return;
    }
    const struct mode *m = &modes[mode];
    const uint32_t second = m->selects ? gtx_take_bits(&bits, 2) : 3;
    take_ends(&bits, m, ends);
    take_weights(&bits, m, subset_of, weights);
    for (uint32_t i = 0; i < TEXELS; ++i)
        for (uint32_t c = 0; c < 4; ++c) {
            uint8_t(*end)[4] = ends[subset_of >> 2 * i & 3];
            texels[4 * i + c] = between(end[0][c], end[1][c],
                                        weights[m->planes == 2 && c == second][i]);
        }
}
