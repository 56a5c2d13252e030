/* A mesh as polygons to draw, fine enough that its textures are seen. */
#pragma once

#include "host/polygons.h"
#include "mesh/mesh.hpp"

#include <array>

namespace gtx {

struct Polygons {
    Vector<gtx_polygon_vertex> vertices;      /* relative to `centre` */
    Vector<uint32_t> indices;
    Vector<std::array<uint8_t, 4>> emissions; /* sRGB, of each vertex; empty: none emits anything */
    bool has_materials = false;               /* metallic, roughness, occlusion or emission */
};

/* Textured triangles are cut into smaller ones, which take colour and normal at their corners; what
 * a mask cuts away is left out. Two-sided triangles have 255 in the last byte of their vertices'
 * materials. Throws Error: LIMIT. */
Polygons make_polygons(const Mesh &mesh, const Vec3d &centre);

} // namespace gtx
