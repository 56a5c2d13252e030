/* The edges of a coarse surface, and a finer one's that go over them. */
#pragma once

#include "bake/lod/fan.hpp"
#include "bake/lod/far_search.hpp"

namespace gtx::baking {

/* Of a fine edge over the coarse surface, and of its end around a vertex there: limits. */
constexpr uint32_t MAX_CUTS = 16, MAX_AROUND = 6;
/* Of the length of a coarse edge. */
constexpr int32_t WHOLE = 1 << 20;

/* Where a fine edge goes from over one coarse triangle to over the next. */
struct Cut {
    uint32_t from, to;
    uint32_t low, high;          /* the coarse edge */
    int32_t at;                  /* on it, from the lower vertex */
    float away;                  /* of the point there */

    bool is_back(const Cut &o) const
    {
        return from == o.to && to == o.from && low == o.low && high == o.high;
    }
    bool has(uint32_t vertex) const { return low == vertex || high == vertex; }
    Cut turned() const { return {to, from, low, high, at, away}; }
};

/* The coarse triangle below a point, and how far it is; NO_PATCH: none was found. */
struct OverPlace {
    uint32_t over = NO_PATCH;
    float away = 0;
};

class CoarseEdges {
public:
    CoarseEdges(const SortedSurface &coarse, Task &task);

    /* Of a point, from a triangle close by, or none. */
    OverPlace place(const Vec3d &point, uint32_t near) const;
    /* Where a point goes over a side. */
    Cut cut(uint32_t triangle, int side, const Vec3d &point) const;
    /* Over which side a way around a vertex leaves a triangle. */
    int side_around(uint32_t triangle, uint32_t vertex, bool left) const;
    /* Adds where an edge goes over others, at most MAX_CUTS + MAX_AROUND. False where that was not
     * found. */
    bool follow(const Vec3d &start, const OverPlace &from, const Vec3d &end, const OverPlace &to,
                Vector<Cut> &cuts) const;

private:
    /* Across a side of a triangle, in the plane halfway between it and the next: from both it is
     * the same but for its sign. */
    struct Side {
        Vec3d in;
        double at = 0;

        double inside(const Vec3d &point) const { return dot(in, point) - at; }
    };

    void find_sides(size_t triangle);
    uint32_t over(const Vec3d &point, uint32_t near) const;
    OverPlace place_below(const Vec3d &point, uint32_t near) const;
    bool go_around(uint32_t triangle, uint32_t last, const Vec3d &point, double most,
                   Vector<Cut> &cuts) const;

    const SortedSurface &coarse_;
    Vector<std::array<Side, 3>> sides_;      /* of the triangles */
};

} // namespace gtx::baking
