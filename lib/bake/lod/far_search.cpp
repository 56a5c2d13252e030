/* Splits triangles until none may be farther than the farthest point that is known. */
#include "bake/lod/cover.hpp"
#include "mesh/edges.hpp"

#include <algorithm>
#include <utility>

namespace gtx::baking {

/* Where a square as wide as the error asked for has so many triangles of the surface, looks at
 * points take less than looks at all that lies over a triangle. Instructions of the dragon's cook:
 * 0.4 % more at an eighth, 3 % without a limit. */
constexpr double MANY = 8;

void Reached::raise(size_t triangle, double away)
{
    float most = away_[triangle].load(std::memory_order_relaxed);
    while (away > double(most) &&
           !away_[triangle].compare_exchange_weak(most, rounded_up(away),
                                                  std::memory_order_relaxed)) {
    }
}

static double radius_of(const Corners &c, const Vec3d &middle)
{
    return std::max({length(c[0] - middle), length(c[1] - middle), length(c[2] - middle)});
}

bool FarSearch::is_covered_whole(const Corners &c)
{
    CoverParts parts;
    const uint32_t last = near, over = covering(c, to, most(), near, beyonds, &parts);
    if (over == NO_PATCH)
        return false;
    for (size_t i = 0; i < parts.count; ++i)
        tell(parts.triangle[i], parts.away[i]);
    near = over;
    if (near != last)
        remember(last);
    return true;
}

/* Each part is convex, and so are distances: corners tell. */
bool FarSearch::is_covered_by_two(const FarCorner &a, const FarCorner &b, const FarCorner &c)
{
    if (near >= to.size())
        return false;
    const Vec3d at[3] = {a.at, b.at, c.at};
    const std::array<double, 3> inside[3] = {nearest.inside(at[0]), nearest.inside(at[1]),
                                             nearest.inside(at[2])};
    int side = 0;
    double least = 0;
    for (int k = 0; k < 3; ++k)
        for (int n = 0; n < 3; ++n)
            if (inside[n][k] < least) {
                least = inside[n][k];
                side = k;
            }
    const uint32_t other = to.beside(near)[side];
    if (!(least < 0) || other >= to.size())
        return false;
    const Corners corners = to.corners(other);
    const NearTriangle beside(corners[0], corners[1], corners[2]);
    const double more = beyonds ? beyonds->at(other) : 0;
    const double limit = most() - beyond, limit_beside = most() - more;
    double here = 0, there = 0;
    for (int n = 0; n < 3; ++n) {
        const int after = n == 2 ? 0 : n + 1;
        const double from = inside[n][side], to_next = inside[after][side];
        if (from >= 0)
            here = std::max(here, nearest.distance2(at[n]));
        else
            there = std::max(there, beside.distance2(at[n]));
        if ((from < 0) != (to_next < 0)) {
            const Vec3d cut = at[n] + (at[after] - at[n]) * (from / (from - to_next));
            here = std::max(here, nearest.distance2(cut));
            there = std::max(there, beside.distance2(cut));
        }
        if (!(limit >= 0 && limit_beside >= 0 && here <= limit * limit &&
              there <= limit_beside * limit_beside))
            return false;
    }
    tell(near, std::sqrt(here) + beyond);
    tell(other, std::sqrt(there) + more);
    if (inside[0][side] + inside[1][side] + inside[2][side] < 0) /* more of it is there */
        remember(std::exchange(near, other));
    return true;
}

bool FarSearch::is_within(FarCorner &a, FarCorner &b, FarCorner &c)
{
    cancel_point();
    if (is_covered(a, b, c) || was_covered(a, b, c) || is_covered_by_two(a, b, c))
        return true;
    const Corners corners = {a.at, b.at, c.at};
    const Vec3d middle = (a.at + b.at + c.at) / 3;
    const double radius = radius_of(corners, middle), enough = free - radius;
    if (enough > 0) {
        const double away = distance(middle, enough);
        if (away + beyond <= enough) {
            tell_near(corners, away + radius);
            return true;
        }
        if (is_covered(a, b, c))
            return true;
        if (away + beyond > free || away + beyond + radius <= LOOSE * free)
            return false;
    } else if (free * free < MANY * to.mean_area() && is_covered_whole(corners)) {
        return true;
    }
    FarCorner x = {(b.at + c.at) / 2}, y = {(c.at + a.at) / 2}, z = {(a.at + b.at) / 2};
    return is_within(x, y, z) && is_within(a, z, y) && is_within(z, b, x) &&
           is_within(y, x, c);
}

void FarSearch::look(FarCorner &a, FarCorner &b, FarCorner &c)
{
    cancel_point();
    if (is_covered(a, b, c) || was_covered(a, b, c) || is_covered_by_two(a, b, c))
        return;
    const Corners corners = {a.at, b.at, c.at};
    const Vec3d middle = (a.at + b.at + c.at) / 3;
    const double radius = radius_of(corners, middle), enough = most() - radius;
    if (enough > 0) {
        const double away = distance(middle, enough);
        if (away <= enough) {
            tell_near(corners, away + radius);
            return;
        }
        if (away > found)
            farthest = {middle, near};
        found = std::max(found, away);
        if (away + radius <= most()) {
            tell_near(corners, away + radius);
            return;
        }
        if (is_covered(a, b, c))
            return;
    } else if (most() * most() < MANY * to.mean_area() &&
               is_covered_whole(corners)) {
        return;
    }
    FarCorner x = {(b.at + c.at) / 2}, y = {(c.at + a.at) / 2}, z = {(a.at + b.at) / 2};
    look(x, y, z);
    look(a, z, y);
    look(z, b, x);
    look(y, x, c);
}

SortedSurface::SortedSurface(Vector<Vec3d> positions,
                             Vector<std::array<uint32_t, 3>> triangles, Task &task, double done,
                             bool in_order)
    : positions_(std::move(positions)), triangles_(std::move(triangles)),
      shapes_{positions_, triangles_}, tree_(shapes_, task, done, in_order),
      given_(tree_.renumber())
{
    Vector<Vec3d> places;
    Vector<std::array<uint32_t, 3>> ordered;
    Vector<uint32_t> name(positions_.size(), NO_VERTEX);
    places.reserve(positions_.size());
    ordered.reserve(triangles_.size());
    for (uint32_t t : given_) {
        ordered.push_back(triangles_[t]);
        for (uint32_t &v : ordered.back()) {
            if (name[v] == NO_VERTEX) {
                name[v] = uint32_t(places.size());
                places.push_back(positions_[v]);
            }
            v = name[v];
        }
    }
    double area = 0;
    for (const auto &[a, b, c] : ordered)
        area += length(cross(places[b] - places[a], places[c] - places[a])) / 2;
    mean_area_ = area / double(std::max<size_t>(ordered.size(), 1));
    positions_ = std::move(places);
    triangles_ = std::move(ordered);
    beside_ = triangle_neighbours(positions_.size(), triangles_);
}

} // namespace gtx::baking
