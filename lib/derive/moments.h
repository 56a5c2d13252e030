/* Sums over a block of a level's cells, for planes of least squares. */
#ifndef GTX_DERIVE_MOMENTS_H
#define GTX_DERIVE_MOMENTS_H

#include "derive/derive.h"

/* Over solid cells: how many, and sums of products of their places in the block and the codes of
 * their low corners. All of them are whole. */
typedef struct gtx_moments {
    double n, x, y, z, xx, xy, yy, xz, yz;
} gtx_moments;

enum { GTX_MAX_MOMENTS = 16 };

/* Of the cells low to high - 1, at most GTX_MAX_MOMENTS on a side. */
gtx_moments gtx_moments_of(const gtx_grid *grid, const uint32_t low[2], const uint32_t high[2]);

#endif
