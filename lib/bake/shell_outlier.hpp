/* Points that a simplified surface leaves outside. */
#pragma once

#include "bake/shell_fan.hpp"
#include "mesh/vec.hpp"

namespace gtx::baking {

struct Outlier {
    double height = 0; /* above the nearest point of the surface; 0: inside */
    Vec3d way;         /* from there */
    double share = 0;  /* of a vertex's movement, by which the surface there follows it */
};

/* A point and the `count` triangles of `star`, which have a vertex in common. */
Outlier find_outlier(const std::vector<Vec3d> &positions, const std::vector<Triangle> &triangles,
                     const uint32_t *star, size_t count, uint32_t vertex, const Vec3d &point);

} // namespace gtx::baking
