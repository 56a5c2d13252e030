/* A UASTC block as numbers of one of its modes. Inside of the room. */
#pragma once

#include "export/uastc_encode.hpp"

namespace gtx {

constexpr unsigned CHANNELS = 3, MAX_SUBSETS = 2;

/* Of table "Mode Index encoding": opaque modes, and how many values an end point and a weight
 * have. Radix 3 and 5: trits and quints above the bits. */
struct Mode {
    uint8_t code, code_bits, pattern_bits, subsets, planes, end_bits, radix, weight_bits;
};
inline constexpr Mode SINGLE[] = {{0x01, 4, 0, 1, 1, 6, 3, 4}, {0x0b, 5, 0, 1, 1, 8, 0, 3},
                           {0x09, 4, 0, 1, 1, 5, 0, 5}};
inline constexpr Mode PAIR[] = {{0x1d, 5, 5, 2, 1, 4, 0, 3}, {0x13, 5, 5, 2, 1, 3, 5, 2}};
inline constexpr Mode APART = {0x1b, 5, 0, 1, 2, 5, 5, 2};

/* Texels of the second subset, a bit each: the patterns of modes 2 and 4. */
inline constexpr uint16_t HALVES[] = {
    0xcccc, 0x8888, 0x1111, 0xecc8, 0x377f, 0xfeec, 0x0137, 0x137f, 0xc800, 0x0013,
    0xfe80, 0x17ff, 0x0017, 0x00ff, 0xfff0, 0x0fff, 0xff71, 0x8eff, 0x08ce, 0x008c,
    0x7310, 0xceff, 0x7331, 0x088c, 0xceef, 0x6666, 0xf00f, 0x5555, 0x0f0f, 0x36c9};

/* For each value the end point of a mode that is nearest: digit << 8 | bits, and its own value. */
struct UastcEnds {
    uint16_t code[256];
    uint8_t value[256];
    explicit UastcEnds(const Mode &m);
};
const UastcEnds &ends_of(const Mode &m);

/* Of n bits, as 0..64; and the value so far between two. */
uint32_t weight_of(uint32_t bits, int n);
inline uint8_t between(uint32_t low, uint32_t high, uint32_t weight)
{
    return uint8_t((257 * (low * (64 - weight) + high * weight) + 32) >> 14);
}

struct UastcFit {
    const Mode *mode = nullptr;
    uint32_t pattern = 0, apart = 0; /* apart: the channel of the second plane */
    uint8_t ends[MAX_SUBSETS][2][CHANNELS];    /* as asked for, to be looked up in Ends */
    uint8_t weights[2][UASTC_TEXELS];          /* codes, of each plane */
    uint32_t error = ~0u;

    unsigned subset_of(unsigned i) const
    {
        return mode->subsets == 2 ? HALVES[pattern] >> i & 1 : 0;
    }
    unsigned plane_of(unsigned channel) const
    {
        return mode->planes == 2 && channel == apart;
    }
};

/* Whatever the ends' order and the weights are. */
UastcBlock pack(UastcFit fit, const UastcTexels &texels);
UastcBlock pack_solid(const std::array<uint8_t, 3> &color);

} // namespace gtx
