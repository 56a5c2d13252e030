/* Height grids as surfaces of triangles. */
#include "grid/grid.hpp"

namespace gtx {

Vec3d grid_node(const HeightGrid &grid, size_t node)
{
    const auto at = grid.place(double(node % grid.nx), double(node / grid.nx));
    return {at[0], double(grid.values[node]), -at[1]};
}

void for_each_triangle(const HeightGrid &grid, uint32_t row, const OnNodes &call)
{
    const size_t first = size_t(row) * grid.nx;
    for (size_t node = first; node + 1 < first + grid.nx; ++node) {
        size_t known[4], count = 0;
        for (size_t corner : {node, node + 1, node + 1 + grid.nx, node + grid.nx})
            if (!std::isnan(grid.values[corner]))
                known[count++] = corner;
        for (size_t k = 2; k < count; ++k)
            call({known[0], known[k - 1], known[k]});
    }
}

void require_lengths(const HeightGrid &grid)
{
    if (grid.in_degrees)
        throw Error(GTX_ERROR_INPUT, "the grid" + std::string(IN_DEGREES));
}

Mesh mesh_of(const HeightGrid &grid, Task &task)
{
    require_lengths(grid);
    Mesh mesh;
    Vector<uint32_t> vertex(grid.count(), NO_TRIANGLE);
    auto vertex_of = [&](size_t node) {
        if (vertex[node] == NO_TRIANGLE) {
            vertex[node] = uint32_t(mesh.positions.size());
            mesh.positions.push_back(grid_node(grid, node));
        }
        return vertex[node];
    };
    for (uint32_t row = 0; row + 1 < grid.ny; ++row) {
        task.advance(double(row) / grid.ny);
        for_each_triangle(grid, row, [&](const std::array<size_t, 3> &nodes) {
            mesh.triangles.push_back({vertex_of(nodes[0]), vertex_of(nodes[1]),
                                      vertex_of(nodes[2])});
        });
        task.limits.require(GTX_LIMITED_TRIANGLES, "the grid", mesh.triangles.size());
        if (mesh.triangles.size() >= NO_TRIANGLE)
            throw Error(GTX_ERROR_LIMIT, "more triangles than 32 bits can count");
    }
    return mesh;
}

} // namespace gtx
