/* Cell files: the triangles of one tile, with all attributes of their corners. */
#pragma once

#include "base/hash.h"
#include "world/plan.hpp"

#include <fstream>

namespace gtx {

/* The header of a cell file. */
struct CellHeader {
    CornerTraits traits;
    uint64_t count = 0;
    uint64_t hash = 0;               /* of the triangles' bytes */
    uint64_t key = 0;                /* of its inputs, if a merge made it */
    double deviation = 0;            /* upper bound on the distance from the source, measured */

    Vec3d low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

    void add(const Corners3 &corners);
    void add(const Vec3d &p);        /* to the box alone */
    bool touches(const CellHeader &other) const;
    bool has(const Vec3d &p) const   /* in its box */
    {
        return low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y && low.z <= p.z &&
               p.z <= high.z;
    }
    static constexpr size_t BYTES = 96;
    std::string bytes() const;
};

/* The largest coordinate of corners, so that what is computed from distances stays finite. */
constexpr double FARTHEST = 1e60;
bool are_near(const Corners3 &corners);

/* A triangle takes 3 * traits.bytes(). */
void encode_triangle(const CornerTraits &traits, const Corners3 &corners, uint8_t *out);
void decode_triangle(const CornerTraits &traits, const uint8_t *bytes, Corners3 &out);

/* Writes a cell file in memory, for simplified surfaces. */
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

/* Reads one triangle after another. Throws Error: READ; INPUT if the file is not a cell file, or
 * not complete. */
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
