/* The surface of assets as small shapes: their cells, trimmed. */
#pragma once

#include "mesh/nearest.hpp"

#include <geotex/geotex.h>

namespace gtx {

/* Shapes for NearestTree, relative to the first asset's anchor. An untrimmed cell is the four
 * triangles around its centre, which lie within a sixteenth of its twist of the bilinear patch. A
 * cell that the outline crosses is cut into 2x2, and the eight triangles of those are clipped where
 * the trim, linear along their sides, passes the limit. */
class Cells {
public:
    explicit Cells(const Vector<const gtx_asset *> &assets);

    size_t size() const { return cells_.size(); }
    size_t looks(size_t i) const { return cells_[i].crossed ? 12 : 4; }
    Box box(size_t i) const;
    double distance2(size_t i, const Vec3d &p, double bound) const;

    /* The area of cell i that is drawn, estimated on a 4x4 grid. */
    double shown_area(size_t i) const;
    /* The point at (u, v) in 0..1 of cell i, and its trim in texels. */
    Vec3d point(size_t i, double u, double v) const;
    double trim(size_t i, double u, double v) const;
    /* The patch of cell i, numbered on from asset to asset; a patch's height step and the longer
     * side of its texels, object units. */
    uint32_t patch(size_t i) const { return cells_[i].patch; }
    double height_step(uint32_t patch) const { return length(frames_[patch].z); }
    double texel(uint32_t patch) const
    {
        return std::max(length(frames_[patch].x), length(frames_[patch].y));
    }

private:
    struct Cell {
        uint32_t patch;
        uint16_t x, y;
        uint16_t code[4];        /* of (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1) */
        uint8_t trim[4];
        bool crossed;            /* by the outline */
    };
    /* Texel coordinates and codes to object space. */
    struct Frame {
        Vec3d origin, x, y, z;
    };
    Vec3d corner(size_t i, int k) const;
    double crossed_distance2(size_t i, const Vec3d &p, double bound) const;
    void add_patch(const gtx_asset *asset, uint32_t index, const Vec3d &offset);

    Vector<Frame> frames_;
    Vector<Cell> cells_;
};

} // namespace gtx
