/* Height grids of the C API as those of lib/grid. */
#pragma once

#include "grid/grid.hpp"

#include <geotex/cook.h>

namespace gtx {

/* The lattice of a grid, with some values of its nodes. */
HeightGrid lattice(const gtx_height_grid &from, const float *values);

/* Throws Error(ARGUMENT) where it could not be one. */
void require_lattice(const gtx_height_grid &grid);

} // namespace gtx
