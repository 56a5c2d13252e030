/* Bottom-up clustering: triangles merged into few large clusters of like normals. */
#pragma once

#include "chart/surface.hpp"

namespace gtx {

/* Partitions the surface into as few connected clusters as their cones of normals allow. Returns a
 * label a triangle and their number in `count`. Deterministic for any thread count. */
Vector<uint32_t> agglomerate(const Surface &surface, uint32_t &count, Task &task);

} // namespace gtx
