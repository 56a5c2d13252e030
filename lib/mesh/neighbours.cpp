/* Which triangles of a cleaned mesh share an edge. */
#include "mesh/edges.hpp"

namespace gtx {

Vector<std::array<uint32_t, 3>> triangle_neighbours(const Mesh &mesh)
{
    Vector<std::array<uint32_t, 3>> neighbours(
        mesh.triangles.size(), {NO_TRIANGLE, NO_TRIANGLE, NO_TRIANGLE});
    for_each_edge(mesh, [&](const EdgeEntry *edge, size_t count) {
        if (count != 2)
            return;
        uint32_t a = edge[0].half_edge, b = edge[1].half_edge;
        neighbours[a / 3][a % 3] = b / 3;
        neighbours[b / 3][b % 3] = a / 3;
    });
    return neighbours;
}

} // namespace gtx
