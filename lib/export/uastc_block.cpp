/* Packing of UASTC blocks, bit by bit (Khronos Data Format Specification 1.4, chapter 25). */
#include "export/uastc_block.hpp"

#include "export/etc1_hints.hpp"

#include <algorithm>
#include <cstdlib>

namespace gtx {

/* ---- numbers of a mode ---- */

/* ASTC's way from the digit and the bits of an end point to 0..255. */
static uint8_t end_of(const Mode &m, uint32_t digit, uint32_t bits)
{
    const uint32_t invert = bits & 1 ? 0x1ff : 0, b = bits >> 1;
    uint32_t step = 0, offset = 0;
    switch (8 * m.radix + m.end_bits) {
    case 8 * 3 + 6: step = 5; offset = b << 4 | b >> 4; break;
    case 8 * 5 + 3: step = 26; offset = b << 7 | b << 1 | b >> 1; break;
    case 8 * 5 + 5: step = 6; offset = b << 5 | b >> 3; break;
    default: return uint8_t(bits << (8 - m.end_bits) | bits >> (2 * m.end_bits - 8));
    }
    const uint32_t value = (digit * step + offset) ^ invert;
    return uint8_t((invert & 0x80) | value >> 2);
}

uint32_t weight_of(uint32_t bits, int n)
{
    uint32_t value = 0;
    for (int shift = 6 - n; shift > -n; shift -= n)
        value |= shift >= 0 ? bits << shift : bits >> -shift;
    return value + (value > 32);
}

UastcEnds::UastcEnds(const Mode &m)
{
    std::array<int, 256> far;
    far.fill(1 << 10);
    for (uint32_t digit = 0; digit < std::max<uint32_t>(m.radix, 1); ++digit)
        for (uint32_t bits = 0; bits < 1u << m.end_bits; ++bits) {
            const int here = end_of(m, digit, bits);
            for (int v = 0; v < 256; ++v)
                if (std::abs(here - v) < far[size_t(v)]) {
                    far[size_t(v)] = std::abs(here - v);
                    code[v] = uint16_t(digit << 8 | bits);
                    value[v] = uint8_t(here);
                }
        }
}

const UastcEnds &ends_of(const Mode &m)
{
    static const UastcEnds tables[] = {UastcEnds(SINGLE[0]), UastcEnds(SINGLE[1]),
                                       UastcEnds(SINGLE[2]), UastcEnds(PAIR[0]),
                                       UastcEnds(PAIR[1]),   UastcEnds(APART)};
    const Mode *const modes[] = {&SINGLE[0], &SINGLE[1], &SINGLE[2], &PAIR[0], &PAIR[1], &APART};
    for (size_t i = 0; i < std::size(modes); ++i)
        if (modes[i] == &m)
            return tables[i];
    return tables[0];
}

/* ---- bits ---- */

namespace {

constexpr uint32_t SOLID = 0x17, SOLID_BITS = 5;

class Bits {
public:
    void put(uint32_t value, unsigned count)
    {
        for (unsigned k = 0; k < count; ++k, ++at_)
            out[at_ / 8] = uint8_t(out[at_ / 8] | (value >> k & 1) << at_ % 8);
    }
    UastcBlock out = {};

private:
    unsigned at_ = 0;
};

/* 5 trits in 8 bits, 3 quints in 7, the last ones in fewer. */
void put_digits(Bits &bits, unsigned radix, const uint8_t *digits, unsigned count)
{
    static const uint8_t trit_bits[] = {0, 2, 4, 5, 7, 8}, quint_bits[] = {0, 3, 5, 7};
    const unsigned most = radix == 3 ? 5 : 3;
    for (unsigned at = 0; radix && at < count; at += most) {
        const unsigned here = std::min(count - at, most);
        uint32_t packed = 0;
        for (unsigned i = here; i-- > 0;)
            packed = packed * radix + digits[at + i];
        bits.put(packed, (radix == 3 ? trit_bits : quint_bits)[here]);
    }
}

/* The first texel of each subset has a weight of the lower half: where it has not, ends change
 * places. */
void settle_anchors(UastcFit &fit)
{
    const uint32_t top = (1u << fit.mode->weight_bits) - 1;
    for (unsigned s = 0; s < fit.mode->subsets; ++s)
        for (unsigned plane = 0; plane < fit.mode->planes; ++plane) {
            unsigned first = 0;
            while (fit.subset_of(first) != s)
                ++first;
            if (fit.weights[plane][first] <= top / 2)
                continue;
            for (unsigned i = 0; i < UASTC_TEXELS; ++i)
                if (fit.subset_of(i) == s)
                    fit.weights[plane][i] = uint8_t(top - fit.weights[plane][i]);
            for (unsigned c = 0; c < CHANNELS; ++c)
                if (fit.plane_of(c) == plane)
                    std::swap(fit.ends[s][0][c], fit.ends[s][1][c]);
        }
}

} // namespace

UastcBlock pack(UastcFit fit, const UastcTexels &texels)
{
    const Mode &m = *fit.mode;
    settle_anchors(fit);
    Bits bits;
    bits.put(m.code, m.code_bits);
    bits.put(0, 2); /* of BC1: found by the transcoder */
    const Etc1Hints hints = etc1_hints(texels);
    bits.put(hints.flip, 1);
    bits.put(hints.differential, 1);
    bits.put(hints.table[0], 3);
    bits.put(hints.table[1], 3);
    bits.put(Etc1Hints::NO_BIAS, 5);
    bits.put(fit.pattern, m.pattern_bits);
    if (m.planes == 2)
        bits.put(fit.apart, 2);
    uint8_t digits[4 * CHANNELS], low[4 * CHANNELS];
    const unsigned count = 2 * CHANNELS * m.subsets;
    for (unsigned i = 0; i < count; ++i) {
        const uint16_t code =
            ends_of(m).code[fit.ends[i / 6][i & 1][i / 2 % CHANNELS]];
        digits[i] = uint8_t(code >> 8);
        low[i] = uint8_t(code);
    }
    put_digits(bits, m.radix, digits, count);
    for (unsigned i = 0; i < count; ++i)
        bits.put(low[i], m.end_bits);
    uint32_t seen = 0;
    for (unsigned i = 0; i < UASTC_TEXELS; ++i) {
        const unsigned subset = fit.subset_of(i);
        for (unsigned plane = 0; plane < m.planes; ++plane)
            bits.put(fit.weights[plane][i], m.weight_bits - !(seen >> subset & 1));
        seen |= 1u << subset;
    }
    return bits.out;
}

UastcBlock pack_solid(const std::array<uint8_t, 3> &color)
{
    Bits bits;
    bits.put(SOLID, SOLID_BITS);
    for (uint8_t channel : color)
        bits.put(channel, 8);
    bits.put(255, 8);
    const Etc1Solid solid = etc1_solid(color);
    bits.put(solid.differential, 1);
    bits.put(solid.table, 3);
    bits.put(solid.selector, 2);
    for (uint8_t base : solid.base)
        bits.put(base, 5);
    return bits.out;
}

} // namespace gtx
