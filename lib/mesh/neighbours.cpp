/* Which triangles share an edge. */
#include "mesh/edges.hpp"

namespace gtx {

Vector<std::array<uint32_t, 3>> triangle_neighbours(
    size_t vertices, const Vector<std::array<uint32_t, 3>> &triangles)
{
    Vector<std::array<uint32_t, 3>> neighbours(
        triangles.size(), {NO_TRIANGLE, NO_TRIANGLE, NO_TRIANGLE});
    for_each_edge(triangles, 0, vertices, [&](const EdgeEntry *edge, size_t count) {
        if (count != 2)
            return;
        const uint32_t a = edge[0].half_edge, b = edge[1].half_edge;
        if (triangles[a / 3][a % 3] == triangles[b / 3][b % 3])
            return; /* turned over */
        neighbours[a / 3][a % 3] = b / 3;
        neighbours[b / 3][b % 3] = a / 3;
    });
    return neighbours;
}

} // namespace gtx
