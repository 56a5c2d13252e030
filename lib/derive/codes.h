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

/* How often a distance at an outline counts: neighbours drawn at levels of their own part by the
 * sum of their errors, and what is too little to be seen opens a hole there. At half of it one
 * pixel of the pictures of tests/world/test_seams is a hole; at double there are more triangles
 * for nothing. */
#define GTX_BORDER_COUNTS 16

/* Of a code along the frame's Z in object space, square to a height field with these slopes, in
 * codes a texel: the share of the step that leads away from the plane of its tangents. `step` has
 * object units a texel along x and y, and a code. */
double gtx_square_to(const gtx_patch *patch, const double step[3], double dx, double dy);

#endif
