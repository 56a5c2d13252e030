/* Means of normals, several side by side: plain loops over arrays that compilers vectorise. */
#ifndef GTX_ASSET_LANES_H
#define GTX_ASSET_LANES_H

#include "base/bytes.h"

enum { GTX_LANES = 16 };

/* What gtx_normal_sum is, of each lane; lane l is number l + 1, between two that stay empty. Of up
 * to 9 normals the sums fit. */
typedef struct gtx_lane_sums {
    int16_t a[GTX_LANES + 2], b[GTX_LANES + 2], z[GTX_LANES + 2];
} gtx_lane_sums;

/* Normals copied from bytes, or to be copied there: the first byte is the low one. */
static inline void gtx_lanes_order(uint16_t *code)
{
    for (int l = 0; GTX_BIG_ENDIAN && l < GTX_LANES; ++l)
        code[l] = gtx_first_low_u16(code[l]);
}

/* Adds normals, the first byte the low one, where `ring` has 1 to `most`. */
static inline void gtx_lanes_add(gtx_lane_sums *restrict sums, const uint16_t *restrict code,
                                 const uint8_t *restrict ring, uint8_t most)
{
    for (int l = 0; l < GTX_LANES; ++l) {
        const int16_t mask = (uint8_t)(ring[l] - 1) < most ? -1 : 0;
        const int16_t a = (int16_t)(2 * (code[l] & 255) - 255);
        const int16_t b = (int16_t)(2 * (code[l] >> 8) - 255);
        const int16_t p = (int16_t)(a < 0 ? -a : a), q = (int16_t)(b < 0 ? -b : b);
        sums->a[l + 1] = (int16_t)(sums->a[l + 1] + (a & mask));
        sums->b[l + 1] = (int16_t)(sums->b[l + 1] + (b & mask));
        sums->z[l + 1] = (int16_t)(sums->z[l + 1] + ((255 - (p > q ? p : q)) & mask));
    }
}

/* Sums of each lane and its neighbours. */
static inline void gtx_lanes_spread(const gtx_lane_sums *restrict from,
                                    gtx_lane_sums *restrict sums)
{
    for (int l = 0; l < GTX_LANES; ++l) {
        sums->a[l + 1] = (int16_t)(from->a[l] + from->a[l + 1] + from->a[l + 2]);
        sums->b[l + 1] = (int16_t)(from->b[l] + from->b[l + 1] + from->b[l + 2]);
        sums->z[l + 1] = (int16_t)(from->z[l] + from->z[l + 1] + from->z[l + 2]);
    }
}

/* As gtx_normal_mean, where `ring` has `mark`; the other codes stay. Floats do: of 9 normals the
 * divisor is at most 4590, so that no quotient is nearer below a whole number than 1 / 4590, and
 * none is off by half of that. */
static inline void gtx_lanes_mean(const gtx_lane_sums *restrict sums, const uint8_t *restrict ring,
                                  uint8_t mark, uint16_t *restrict code)
{
    for (int l = 0; l < GTX_LANES; ++l) {
        const int32_t a = sums->a[l + 1], b = sums->b[l + 1];
        const int32_t p = a < 0 ? -a : a, q = b < 0 ? -b : b;
        const int32_t size = (p > q ? p : q) + sums->z[l + 1];
        const float share = 1 / (float)(size ? 2 * size : 1), half = 0.5f / 4590;
        int32_t x = (int32_t)((float)(256 * size + 255 * a) * share + half);
        int32_t y = (int32_t)((float)(256 * size + 255 * b) * share + half);
        x = size ? x > 255 ? 255 : x : 128;
        y = size ? y > 255 ? 255 : y : 128;
        code[l] = ring[l] == mark ? (uint16_t)(x | y << 8) : code[l];
    }
}

#endif
