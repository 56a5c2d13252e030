/* The sRGB transfer function (IEC 61966-2-1) by table. */
#include "mesh/material/srgb.hpp"
#include "base/exact.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gtx {

static float decode(double s)
{
    return float(s <= 0.04045 ? s / 12.92 : gtx_pow((s + 0.055) / 1.055, 2.4));
}

namespace {
struct Tables {
    std::array<float, 256> light;   /* of a code */
    std::array<float, 255> between; /* light at which code i gives way to i + 1 */
    Tables()
    {
        for (size_t i = 0; i < 256; ++i)
            light[i] = decode(double(i) / 255);
        for (size_t i = 0; i < 255; ++i)
            between[i] = decode((double(i) + 0.5) / 255);
    }
};
} // namespace

static const Tables &tables()
{
    static const Tables t;
    return t;
}

float srgb_to_linear(uint8_t code)
{
    return tables().light[code];
}

uint8_t linear_to_srgb(float light)
{
    const auto &between = tables().between;
    return uint8_t(std::lower_bound(between.begin(), between.end(), light) - between.begin());
}

} // namespace gtx
