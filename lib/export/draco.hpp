/* Triangles as KHR_draco_mesh_compression has them. Inside of the room. */
#pragma once

#include "mesh/task.hpp"
#include "mesh/vec.hpp"

#include <array>

namespace gtx {

/* One attribute of all vertices, to be told apart in `bits` steps from `low` to `low` + `range`. */
struct DracoValues {
    enum Kind { POSITION, NORMAL, TANGENT, TEXCOORD } kind; /* also its number in the stream */
    int components;
    Vector<float> values;
    int bits;
    Vec3f low;                     /* of tangents and normals unused */
    float range;
};

struct DracoStream {
    Bytes bytes;
    size_t vertices = 0, triangles = 0; /* that a decoder gets: some vertices are split, triangles
                                           * without area dropped */
};

/* Vertices in the places that the stream tells are where quantising puts them. The same input gives
 * the same bytes. Throws Error: INTERNAL (the encoder fails), LIMIT. */
DracoStream encode_draco(const Vector<DracoValues> &attributes, size_t vertices,
                         const Vector<std::array<uint32_t, 3>> &triangles);

} // namespace gtx
