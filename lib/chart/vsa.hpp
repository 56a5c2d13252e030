/* Variational shape approximation: clustering triangles by their normals. */
#pragma once

#include "chart/surface.hpp"

namespace gtx {

/* A cluster's representative, and the local triangle it grows from. */
struct Cluster {
    Vec3f normal, centre;
    uint32_t seed = 0;
    float error = 0;      /* sum of its triangles' errors */
    uint32_t worst = 0;   /* local triangle that fits least */
};

/* Partitions a region into `count` connected clusters, or one a connected piece when that is
 * more. Returns a label a triangle and their number in `count`. */
Vector<uint32_t> cluster(const Surface &surface, const Region &region, uint32_t &count,
                         Task &task);

/* Two connected clusters in a connected region, grown first from the local triangles a != b. */
Vector<uint32_t> cluster_pair(const Surface &surface, const Region &region, uint32_t a,
                              uint32_t b);

} // namespace gtx
