/* Cell files: triangles of one tile, each corner with all that it has. */
#pragma once

#include "base/hash.h"
#include "world/plan.hpp"

#include <fstream>

namespace gtx {

/* What a cell file says of itself, in its first bytes. */
struct CellHeader {
    CornerTraits traits;
    uint64_t count = 0;
    uint64_t hash = 0;               /* of the triangles' bytes */
    uint64_t key = 0;                /* of what they were made from, where a merge made them */
    double deviation = 0;            /* from the source, at most, as measured */

    Vec3d low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

    void add(const Corners3 &corners);
    bool touches(const CellHeader &other) const;
    static constexpr size_t BYTES = 96;
    std::string bytes() const;
};

/* Farther out than this no tile has corners: what is computed from distances stays finite. */
constexpr double FARTHEST = 1e60;
bool are_near(const Corners3 &corners);

/* A triangle takes 3 * traits.bytes(). */
void encode_triangle(const CornerTraits &traits, const Corners3 &corners, uint8_t *out);
void decode_triangle(const CornerTraits &traits, const uint8_t *bytes, Corners3 &out);

/* A whole cell file in memory, for what others simplified. */
class CellWriter {
public:
    explicit CellWriter(const CornerTraits &traits) { header.traits = traits; }
    void add(const Corners3 &corners);
    /* The bytes of the file. */
    const std::string &finish();
    CellHeader header;

private:
    std::string bytes_ = std::string(CellHeader::BYTES, 0);
};

/* Reads one triangle after another. Throws Error: READ, INPUT where the file is none, or is not
 * whole. */
class CellReader {
public:
    explicit CellReader(const std::string &path);
    const CellHeader &header() const { return header_; }
    bool next(Corners3 &out);

private:
    std::ifstream file_;
    std::string path_;
    CellHeader header_;
    Vector<uint8_t> block_;
    size_t at_ = 0, end_ = 0;
    uint64_t left_ = 0;
};

} // namespace gtx
