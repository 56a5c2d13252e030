/* The polygons that an asset is measured against: the source mesh and its simplifications. */
#pragma once

#include "cli/view/polygons.hpp"

namespace gtx {

/* The mesh and ever coarser ones of the same vertices: indices[0] is the source. Everything is in
 * vertex-cache order. */
struct MeshLevels {
    Vector<gtx_polygon_vertex> vertices;
    Vector<Vector<uint32_t>> indices;
};

/* `simplified`: with coarser levels, each of about 0.7 times the triangles (Garland and Heckbert
 * 1997, as meshoptimizer has it). Throws Error: LIMIT. */
MeshLevels make_mesh_levels(const Mesh &mesh, const Vec3d &centre, bool simplified);

} // namespace gtx
