/* The header of a PLY file. Internal to lib/mesh. */
#pragma once

#include "mesh/import/import.hpp"

namespace gtx {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

unsigned ply_size(PlyType type);
/* What a colour channel of full strength is in that type; 32 bits hold bytes in practice. */
double ply_full(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type; /* of the value, or of a list's items */
    bool is_list;
    PlyType count_type; /* of a list's length, an integer */
};

struct PlyElement {
    std::string name;
    uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    bool ascii = false, big_endian = false;
    std::vector<PlyElement> elements;
    size_t size = 0; /* in bytes */
    size_t lines = 0;
};

/* Throws Error: INPUT. */
PlyHeader read_ply_header(std::string_view bytes);

} // namespace gtx
