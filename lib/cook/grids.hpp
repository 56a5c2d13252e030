/* Height grids of the C API as those of lib/grid. */
#pragma once

#include "grid/grid.hpp"

#include <geotex/cook.h>

namespace gtx {

/* The nodes of a grid, with other values. */
HeightGrid lattice(const gtx_height_grid &from, const float *values);

/* Throws Error(ARGUMENT) unless its fields but the numbers of nodes are valid. */
void require_placed(const gtx_height_grid &grid);

} // namespace gtx
