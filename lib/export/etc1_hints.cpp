/* ETC1 (Khronos Data Format Specification 1.4, chapter 21) of a block's texels, as far as the hints
 * of UASTC need it. */
#include "export/etc1_hints.hpp"

#include <algorithm>
#include <cstdlib>

namespace gtx {

/* Distances of a table, from the darkest. */
static constexpr int STEPS[8][4] = {{-8, -2, 2, 8},       {-17, -5, 5, 17},    {-29, -9, 9, 29},
                                    {-42, -13, 13, 42},   {-60, -18, 18, 60},  {-80, -24, 24, 80},
                                    {-106, -33, 33, 106}, {-183, -47, 47, 183}};

static int expanded(int code, int bits)
{
    return bits == 5 ? code << 3 | code >> 2 : code << 4 | code;
}

static int rounded(int value, int bits)
{
    const int most = (1 << bits) - 1;
    return std::clamp((value * most + 127) / 255, 0, most);
}

static bool is_second(unsigned texel, uint32_t flip)
{
    return (flip ? texel / 4 : texel % 4) >= 2;
}

/* The best table of one half with a base colour, and its error. */
static uint64_t find_table(const UastcTexels &texels, uint32_t flip, bool second, const int base[3],
                           uint32_t &table)
{
    uint64_t least = UINT64_MAX;
    for (uint32_t k = 0; k < 8; ++k) {
        uint64_t error = 0;
        for (unsigned i = 0; i < UASTC_TEXELS; ++i) {
            if (is_second(i, flip) != second)
                continue;
            int nearest = INT32_MAX;
            for (int step : STEPS[k]) {
                int here = 0;
                for (unsigned c = 0; c < 3; ++c) {
                    const int d = std::clamp(base[c] + step, 0, 255) - texels[i][c];
                    here += d * d;
                }
                nearest = std::min(nearest, here);
            }
            error += uint64_t(nearest);
        }
        if (error < least) {
            least = error;
            table = k;
        }
    }
    return least;
}

Etc1Hints etc1_hints(const UastcTexels &texels)
{
    Etc1Hints best = {};
    uint64_t least = UINT64_MAX;
    for (uint32_t flip = 0; flip < 2; ++flip) {
        int mean[2][3] = {}, base[2][3];
        Etc1Hints hints = {flip, 1, {0, 0}};
        for (unsigned i = 0; i < UASTC_TEXELS; ++i)
            for (unsigned c = 0; c < 3; ++c)
                mean[is_second(i, flip)][c] += texels[i][c];
        for (unsigned c = 0; c < 3; ++c) {
            for (auto &half : mean)
                half[c] = (half[c] + 4) / 8;
            const int apart = rounded(mean[1][c], 5) - rounded(mean[0][c], 5);
            hints.differential &= apart >= -4 && apart <= 3;
        }
        const int bits = hints.differential ? 5 : 4;
        uint64_t error = 0;
        for (unsigned half = 0; half < 2; ++half) {
            for (unsigned c = 0; c < 3; ++c)
                base[half][c] = expanded(rounded(mean[half][c], bits), bits);
            error += find_table(texels, flip, half, base[half], hints.table[half]);
        }
        if (error < least) {
            least = error;
            best = hints;
        }
    }
    return best;
}

Etc1Solid etc1_solid(const std::array<uint8_t, 3> &color)
{
    Etc1Solid best = {};
    int least = INT32_MAX;
    for (int bits : {5, 4})
        for (uint32_t k = 0; k < 8; ++k)
            for (uint32_t s = 0; s < 4; ++s) {
                Etc1Solid solid = {bits == 5, k, s, {}};
                int error = 0;
                for (unsigned c = 0; c < 3; ++c) {
                    const int code = rounded(std::clamp(color[c] - STEPS[k][s], 0, 255), bits);
                    const int d = std::clamp(expanded(code, bits) + STEPS[k][s], 0, 255) - color[c];
                    solid.base[c] = uint8_t(code);
                    error += d * d;
                }
                if (error < least) {
                    least = error;
                    best = solid;
                }
            }
    return best;
}

} // namespace gtx
