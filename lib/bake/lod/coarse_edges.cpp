/* Walks over a coarse surface: to what is below a point, and along an edge above it. */
#include "bake/lod/coarse_edges.hpp"

#include <algorithm>
#include <cmath>

namespace gtx::baking {

/* Steps to a point from the last one's place: a limit. */
constexpr int MAX_STEPS = 64;

CoarseEdges::CoarseEdges(const SortedSurface &coarse, Task &task)
    : coarse_(coarse), sides_(coarse.size())
{
    const size_t chunk = 2048;
    task.parallel((coarse.size() + chunk - 1) / chunk, [&](size_t n) {
        cancel_point(chunk);
        for (size_t t = n * chunk; t < std::min(coarse.size(), (n + 1) * chunk); ++t)
            find_sides(t);
    }, 1, 1);
}

static Vec3d up(const Corners &c)
{
    return normalize(cross(c[1] - c[0], c[2] - c[0]));
}

void CoarseEdges::find_sides(size_t triangle)
{
    const std::array<uint32_t, 3> &v = coarse_.vertices(triangle);
    const std::array<uint32_t, 3> &beside = coarse_.beside(triangle);
    const Vec3d own = up(coarse_.corners(triangle));
    for (int side = 0; side < 3; ++side) {
        const int next = side == 2 ? 0 : side + 1;
        const bool first = v[side] < v[next];
        const Vec3d &low = coarse_.corner(triangle, first ? side : next),
                    &high = coarse_.corner(triangle, first ? next : side);
        const bool any = beside[side] < coarse_.size();
        const Vec3d both = any ? own + up(coarse_.corners(beside[side])) : own;
        const Vec3d in = cross(both, high - low);
        const double at = dot(in, low);
        sides_[triangle][side] = first ? Side{in, at} : Side{in * -1, -at};
    }
}

/* The coarse triangle below a point, from one close by; none where that is beyond a border. */
uint32_t CoarseEdges::over(const Vec3d &point, uint32_t near) const
{
    uint32_t last = NO_PATCH;
    for (int n = 0; n < MAX_STEPS && near < coarse_.size(); ++n) {
        const std::array<uint32_t, 3> &beside = coarse_.beside(near);
        int side = 0;
        while (side < 3 && ((beside[side] == last && last < coarse_.size()) ||
                            sides_[near][side].inside(point) >= 0))
            ++side;
        if (side == 3)
            return near;
        last = near;
        near = beside[side];
    }
    return NO_PATCH;
}

OverPlace CoarseEdges::place_below(const Vec3d &point, uint32_t near) const
{
    const uint32_t below = over(point, near);
    if (below == NO_PATCH)
        return {};
    const auto [a, b, c] = coarse_.corners(below);
    return {below, Reached::rounded_up(std::sqrt(triangle_distance2(point, a, b, c)))};
}

/* What is far from the triangle below it has another that is nearer. */
OverPlace CoarseEdges::place(const Vec3d &point, uint32_t near) const
{
    const OverPlace below = place_below(point, near);
    if (below.over != NO_PATCH && double(below.away) * double(below.away) <= coarse_.mean_area())
        return below;
    near = NO_PATCH;
    coarse_.tree().distance2(point, &near);
    return place_below(point, near);
}

Cut CoarseEdges::cut(uint32_t triangle, int side, const Vec3d &point) const
{
    const std::array<uint32_t, 3> &v = coarse_.vertices(triangle);
    const int next = side == 2 ? 0 : side + 1, low = v[side] < v[next] ? side : next;
    const Vec3d &from = coarse_.corner(triangle, low);
    const Vec3d along = coarse_.corner(triangle, side + next - low) - from, way = point - from;
    const double square = dot(along, along);
    const double at = square > 0 ? std::clamp(dot(way, along) / square, 0.0, 1.0) : 0;
    const Vec3d off = way - along * at;
    return {triangle, coarse_.beside(triangle)[side], v[low], v[side + next - low],
            int32_t(at * WHOLE), Reached::rounded_up(std::sqrt(dot(off, off)))};
}

int CoarseEdges::side_around(uint32_t triangle, uint32_t vertex, bool left) const
{
    const int at = corner_of(coarse_.vertices(triangle), vertex);
    return left ? at : (at + 2) % 3;
}

/* A point near a vertex may be over several triangles around it: from one to the last, if their
 * edges are as near. */
bool CoarseEdges::go_around(uint32_t triangle, uint32_t last, const Vec3d &point, double most,
                            Vector<Cut> &cuts) const
{
    for (uint32_t vertex : coarse_.vertices(triangle)) {
        if (corner_of(coarse_.vertices(last), vertex) < 0)
            continue;
        uint32_t at[2] = {triangle, triangle}; /* to the right, to the left */
        for (uint32_t n = 0; n < MAX_AROUND; ++n)
            for (int left = 0; left < 2; ++left) {
                if (at[left] < coarse_.size())
                    at[left] = coarse_.beside(at[left])[side_around(at[left], vertex, left)];
                if (at[left] != last)
                    continue;
                for (uint32_t here = triangle; here != last; here = cuts.back().to) {
                    cuts.push_back(cut(here, side_around(here, vertex, left), point));
                    if (double(cuts.back().away) > most)
                        return false;
                }
                return true;
            }
    }
    return false;
}

/* From the lower vertex to the higher, so that both triangles of an edge have the same cuts. */
bool CoarseEdges::follow(const Vec3d &start, const OverPlace &from, const Vec3d &end,
                         const OverPlace &to, Vector<Cut> &cuts) const
{
    uint32_t here = from.over, before = NO_PATCH;
    double reached = 0;
    if (here == NO_PATCH || to.over == NO_PATCH)
        return false;
    for (uint32_t n = 0; here != to.over; ++n) {
        const std::array<uint32_t, 3> &beside = coarse_.beside(here);
        int out = -1;
        double first = INFINITY;
        for (int side = 0; side < 3; ++side) {
            const double at_end = sides_[here][side].inside(end);
            if (at_end >= 0 || beside[side] == before)
                continue;
            const double at_start = sides_[here][side].inside(start);
            const double at = at_start > 0 ? at_start / (at_start - at_end) : 0;
            if (at < first) {
                first = at;
                out = side;
            }
        }
        if (out < 0)
            return go_around(here, to.over, end, 2 * double(to.away), cuts);
        if (n == MAX_CUTS || beside[out] >= coarse_.size())
            return false;
        reached = std::max(reached, first);
        cuts.push_back(cut(here, out, start + (end - start) * reached));
        before = here;
        here = beside[out];
    }
    return true;
}

} // namespace gtx::baking
