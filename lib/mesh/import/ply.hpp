/* The header of a PLY file and the values behind it. Internal to lib/mesh. */
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
    Vector<PlyProperty> properties;
};

struct PlyHeader {
    bool ascii = false, big_endian = false;
    Vector<PlyElement> elements;
    size_t size = 0; /* in bytes */
    size_t lines = 0;
};

/* Throws Error: INPUT. */
PlyHeader read_ply_header(std::string_view bytes);

/* Values in the order of the file. Messages name the element, row or line at hand. */
class PlyValues {
public:
    PlyValues(std::string_view bytes, const PlyHeader &header, Task &task)
        : begin_(bytes.data()), at_(begin_ + header.size), end_(begin_ + bytes.size()),
          ascii_(header.ascii), big_endian_(header.big_endian), lines_(header.lines), task_(task)
    {
    }
    /* Before anything is allocated for it: does the file have room for that many rows? */
    void begin(const PlyElement &element);
    void begin_row(uint64_t row);
    double value(PlyType type);
    /* The length, after checking that the file is long enough to hold the items. */
    uint64_t list_length(const PlyProperty &property);
    void skip(const PlyProperty &property);

private:
    size_t left() const { return size_t(end_ - at_); }
    double ascii_value();

    const char *begin_, *at_, *end_;
    const bool ascii_, big_endian_;
    size_t lines_;
    const PlyElement *element_ = nullptr;
    uint64_t row_ = 0;
    Task &task_;
};

} // namespace gtx
