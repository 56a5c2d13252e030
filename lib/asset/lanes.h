/* Means of normals, several side by side: plain loops over arrays, which compilers make vectors. */
#ifndef GTX_ASSET_LANES_H
#define GTX_ASSET_LANES_H

#include <stdint.h>

enum { GTX_LANES = 16 };

/* What gtx_normal_sum is, of each lane. Of up to 9 normals the sums fit. */
typedef struct gtx_lane_sums {
    int16_t a[GTX_LANES], b[GTX_LANES], z[GTX_LANES];
} gtx_lane_sums;

/* Adds normals, the first byte the low one, where `take` is not 0. */
static inline void gtx_lanes_add(gtx_lane_sums *sums, const uint16_t *code, const uint8_t *take)
{
    for (int l = 0; l < GTX_LANES; ++l) {
        const int16_t mask = take[l] ? -1 : 0;
        const int16_t a = (int16_t)(2 * (code[l] & 255) - 255);
        const int16_t b = (int16_t)(2 * (code[l] >> 8) - 255);
        const int16_t p = (int16_t)(a < 0 ? -a : a), q = (int16_t)(b < 0 ? -b : b);
        sums->a[l] = (int16_t)(sums->a[l] + (a & mask));
        sums->b[l] = (int16_t)(sums->b[l] + (b & mask));
        sums->z[l] = (int16_t)(sums->z[l] + ((255 - (p > q ? p : q)) & mask));
    }
}

/* As gtx_normal_mean. Floats do: dividend and divisor are exact, and no quotient that is not whole
 * is nearer to a whole number than 1 / 9180. */
static inline void gtx_lanes_mean(const gtx_lane_sums *sums, uint16_t *code)
{
    for (int l = 0; l < GTX_LANES; ++l) {
        const int32_t a = sums->a[l], b = sums->b[l], p = a < 0 ? -a : a, q = b < 0 ? -b : b;
        const int32_t size = (p > q ? p : q) + sums->z[l], divisor = size ? 2 * size : 1;
        int32_t x = (int32_t)((float)(256 * size + 255 * a) / (float)divisor);
        int32_t y = (int32_t)((float)(256 * size + 255 * b) / (float)divisor);
        x = size ? x > 255 ? 255 : x : 128;
        y = size ? y > 255 ? 255 : y : 128;
        code[l] = (uint16_t)(x | y << 8);
    }
}

#endif
