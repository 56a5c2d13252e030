/* Points that a simplified surface leaves outside, and how it is drawn out to them. */
#pragma once

#include "bake/lod/fan.hpp"
#include "mesh/near_shapes.hpp"
#include "mesh/task.hpp"
#include "mesh/vec.hpp"

#include <functional>

namespace gtx::baking {

/* Vertex v has the triangles around[start[v]] to around[start[v + 1] - 1], and stands for the
 * points points[first[v]] to points[first[v + 1] - 1] of what was simplified. */
struct Simplified {
    const Vector<Vec3d> &positions;
    const Vector<Triangle> &triangles;
    const Vector<uint32_t> &start, &around;
    Vector<uint32_t> first;
    Vector<Vec3d> points;
};

/* Draws the surface out to where no point is farther outside than `most`, as far as `move` lets it,
 * which changes the position of a vertex, or does not and returns false. The task is then done to
 * the share given. */
void draw_out(const Simplified &surface, double most,
              const std::function<bool(uint32_t, const Vec3d &)> &move, Task &task, double done);

} // namespace gtx::baking
