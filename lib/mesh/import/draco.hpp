/* A Draco stream decoded, for .drc files and for glTF. Internal to lib/mesh. */
#pragma once

#include "mesh/import/import.hpp"

namespace gtx {

enum class DracoRole { position, normal, color, other };

struct DracoAttribute {
    uint32_t id = 0; /* Draco's unique id, which glTF refers to */
    DracoRole role = DracoRole::other;
    int components = 0;
    double full = 1;            /* what stands for 1 if the values are normalised integers */
    Vector<double> values;      /* point after point */
};

struct DracoMesh {
    size_t points = 0;
    Vector<std::array<uint32_t, 3>> triangles;      /* of points */
    Vector<DracoAttribute> attributes;
};

/* The sizes in the header of a mesh; whatever the bytes are, they are read within them. */
struct DracoClaims {
    uint64_t faces = 0, points = 0;
};
DracoClaims draco_claims(std::string_view bytes);

/* Texture coordinates only when they are wanted.
 * Throws Error: INPUT, UNSUPPORTED (a point cloud), LIMIT. */
DracoMesh decode_draco(std::string_view bytes, bool with_uv, Task &task);

} // namespace gtx
