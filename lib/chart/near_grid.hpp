/* Which small charts have a vertex near a point. */
#pragma once

#include "chart/surface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gtx {

/* A vertex is near in the point's cell of a grid, or in one around. */
class NearGrid {
public:
    explicit NearGrid(double step) : step_(step), filter_(1 << 16) {}

    void add(const Vec3d &point, uint32_t candidate)
    {
        entries_.emplace_back(cell_of(point), candidate);
    }
    /* Once, after the last has been added. */
    void dilate();
    /* Calls visit(candidate); where too many are near, for none. */
    template <class Visit> void each_near(const Vec3d &point, Visit visit) const;

private:
    /* A limit on time: where more charts than this come together no surface goes on. An engine of
     * 82 nodes has up to 123 and takes 58; a car takes 256. */
    static constexpr ptrdiff_t MAX_NEAR = 256;

    /* The low 21 bits of each coordinate: cells that are two million apart are one, which only has
     * more tried. */
    using Cell = uint64_t;
    using Entry = std::pair<Cell, uint32_t>;

    static Cell pack(uint64_t x, uint64_t y, uint64_t z)
    {
        constexpr uint64_t LOW = (1 << 21) - 1;
        return (x & LOW) << 42 | (y & LOW) << 21 | (z & LOW);
    }
    Vector<Entry> moved(int axis, uint64_t by) const;
    static uint64_t coordinate(Cell cell, int axis) { return cell >> (42 - 21 * axis); }
    Cell cell_of(const Vec3d &p) const
    {
        constexpr uint64_t MIDDLE = 1 << 20; /* few cells are so far from 0 that bits are cut */
        return pack(MIDDLE + uint64_t(int64_t(std::floor(p.x / step_))),
                    MIDDLE + uint64_t(int64_t(std::floor(p.y / step_))),
                    MIDDLE + uint64_t(int64_t(std::floor(p.z / step_))));
    }
    static uint16_t hash(Cell cell) { return uint16_t(cell * 0x9e3779b97f4a7c15 >> 48); }

    double step_;
    Vector<Entry> entries_;      /* ascending, once dilated */
    Vector<bool> filter_;        /* by hash: most points are near no candidate */
};

template <class Visit> void NearGrid::each_near(const Vec3d &point, Visit visit) const
{
    const Cell cell = cell_of(point);
    if (!filter_[hash(cell)])
        return;
    const auto first = std::lower_bound(entries_.begin(), entries_.end(), Entry(cell, 0));
    auto last = first;
    while (last != entries_.end() && last->first == cell && last - first <= MAX_NEAR)
        ++last;
    for (auto at = first; at != last && last - first <= MAX_NEAR; ++at)
        visit(at->second);
}

} // namespace gtx
