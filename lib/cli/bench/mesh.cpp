/* Simplifies the source mesh step by step and orders every level for the vertex cache. */
#include "cli/bench/mesh.hpp"

#include <meshoptimizer.h>

namespace gtx {

/* Triangles of a level beside the last one's, and where simplifying ends. */
constexpr double STEP = 0.7;
constexpr size_t MIN_TRIANGLES = 64;

MeshLevels make_mesh_levels(const Mesh &mesh, const Vec3d &centre, bool simplified)
{
    Polygons polygons = make_polygons(mesh, centre);
    MeshLevels out;
    const size_t corners = polygons.indices.size(), size = sizeof(gtx_polygon_vertex);
    Vector<uint32_t> remap(polygons.vertices.size());
    size_t unique = meshopt_generateVertexRemap(remap.data(), polygons.indices.data(), corners,
                                                polygons.vertices.data(), remap.size(), size);
    Vector<uint32_t> finest(corners);
    meshopt_remapIndexBuffer(finest.data(), polygons.indices.data(), corners, remap.data());
    out.vertices.resize(unique);
    meshopt_remapVertexBuffer(out.vertices.data(), polygons.vertices.data(), remap.size(), size,
                              remap.data());
    meshopt_optimizeVertexCache(finest.data(), finest.data(), corners, unique);
    meshopt_optimizeVertexFetch(out.vertices.data(), finest.data(), corners, out.vertices.data(),
                                unique, size);
    out.indices.push_back(std::move(finest));
    while (simplified) {
        const Vector<uint32_t> &last = out.indices.back();
        Vector<uint32_t> next(last.size());
        size_t wanted = size_t(double(last.size() / 3) * STEP) * 3;
        next.resize(meshopt_simplify(next.data(), last.data(), last.size(),
                                     out.vertices[0].position, unique, size, wanted, 1.f));
        if (next.size() < 3 * MIN_TRIANGLES || next.size() == last.size())
            break;
        meshopt_optimizeVertexCache(next.data(), next.data(), next.size(), unique);
        out.indices.push_back(std::move(next));
    }
    return out;
}

} // namespace gtx
