/* What a level's solid cells span, and rows of its nodes as floats. */
#ifndef GTX_DERIVE_CODES_H
#define GTX_DERIVE_CODES_H

#include "derive/derive.h"

#include <stdbool.h>

/* At most so many nodes at once. */
enum { GTX_CODES_RUN = 256 };

/* Codes of the nodes x0 to x0 + count - 1 of row y; NaN, which is neither greater nor less than
 * anything, where no solid cell has a corner. */
void gtx_load_codes(const gtx_grid *grid, uint32_t x0, uint32_t count, uint32_t y, float *out);

/* The solid cells lie in low to high - 1; false when there are none. */
bool gtx_solid_extent(const gtx_grid *grid, uint32_t low[2], uint32_t high[2]);

#endif
