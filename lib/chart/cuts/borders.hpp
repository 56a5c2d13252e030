/* Borders of clusters: moved to where normals fit best, straightened, around one piece each. */
#pragma once

#include "chart/surface.hpp"

namespace gtx {

/* Lets triangles change to the neighbouring cluster whose mean normal is nearest to theirs. Spikes
 * that noise leaves along the borders would cost texels in every patch there: they go last. */
void move_borders(const Surface &surface, size_t count, Vector<uint32_t> &labels, Task &task);

/* Gives each piece of a cluster but the largest to the neighbour with which it shares most
 * edges. */
void absorb_islands(const Surface &surface, size_t count, Vector<uint32_t> &labels);

} // namespace gtx
