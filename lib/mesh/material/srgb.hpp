/* The sRGB transfer function (IEC 61966-2-1) by table. */
#pragma once

#include <cstdint>

namespace gtx {

float srgb_to_linear(uint8_t code);
/* The code whose light is nearest as sRGB counts; inverse of the above. Clamps; NaN is 0. */
uint8_t linear_to_srgb(float light);

} // namespace gtx
