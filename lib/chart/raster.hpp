/* Triangles at the centres of a grid of texels. */
#pragma once

#include "mesh/task.hpp"
#include "mesh/vec.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

/* The part of a row of `count` texels, the first of which is `first` from a triangle's corner,
 * where the triangle can lie: wide of that by more than rounding does, so that a test of each of
 * them decides. A sliver covers few of the texels of its box. */
struct Row {
    double first;
    int from, to;

    Row(double first, int count) : first(first), from(0), to(count) {}

    /* To where (d * slope + rest) / area >= least, d from the corner, all sums of products up to
     * `size`. */
    void narrow(double slope, double rest, double area, double least, double size)
    {
        constexpr double ROUNDING = 1e-12;
        const double limit = (least * area - rest) / slope - first;
        const double wide = 1 + ROUNDING * size / std::fabs(slope);
        if (!(std::fabs(limit) + wide < 1e9))
            return;
        if ((slope > 0) == (area > 0))
            from = std::max(from, int(std::floor(limit - wide)));
        else
            to = std::min(to, int(std::ceil(limit + wide)) + 1);
    }
};

/* That of a triangle with sides u and v from its corner, `dy` above it, where both of its weights
 * are at least `least` and their sum as little above 1. */
inline Row narrow_row(double first, int count, double dy, const double u[2], const double v[2],
                      double area, double least)
{
    constexpr int SHORT = 8; /* not worth it */
    Row row(first, count);
    if (count <= SHORT)
        return row;
    const double reach = std::fabs(first) + count + std::fabs(dy);
    const double size = reach * (std::fabs(u[0]) + std::fabs(u[1]) + std::fabs(v[0]) +
                                 std::fabs(v[1])) + std::fabs(area);
    row.narrow(v[1], -dy * v[0], area, least, size);
    row.narrow(-u[1], dy * u[0], area, least, size);
    row.narrow(u[1] - v[1], dy * (v[0] - u[0]), area, least - 1, size);
    return row;
}

/* The first and the last of `count` texels with a centre from low to high; false if there is
 * none. */
inline bool centres_between(double low, double high, int count, int &first, int &last)
{
    low = std::max(0., low - 0.5);
    high = std::clamp(high - 0.5, -1., count - 1.);
    first = int(low);
    first += first < low;
    last = int(high);
    last -= last > high;
    return first <= last;
}

/* Calls visit(i, j, depth) for the texel centres in a triangle, edges included. Corners are in
 * texels, texel (i, j) from i to i + 1 and j to j + 1; depths are the corners' z. */
template <class Visit>
void raster_centres(const Vec3d corner[3], int width, int height, Visit visit)
{
    cancel_point();
    const Vec3d &a = corner[0], &b = corner[1], &c = corner[2];
    int i0, i1, j0, j1; /* most triangles of fine models are between the centres */
    if (!centres_between(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), width, i0, i1) ||
        !centres_between(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), height, j0, j1))
        return;
    double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0)
        return;
    const double u[2] = {b.x - a.x, b.y - a.y}, v[2] = {c.x - a.x, c.y - a.y};
    const double side = area > 0 ? 1 : -1;
    for (int j = j0; j <= j1; ++j) {
        const double y = j + 0.5 - a.y;
        const Row row = narrow_row(i0 + 0.5 - a.x, i1 - i0 + 1, y, u, v, area, 0);
        for (int i = i0 + row.from; i < i0 + row.to; ++i) {
            const double x = i + 0.5 - a.x;
            const double of_b = x * v[1] - y * v[0], of_c = u[0] * y - u[1] * x;
            if (side * of_b < 0 || side * of_c < 0)
                continue;
            const double wb = of_b / area, wc = of_c / area;
            if (wb + wc > 1)
                continue;
            visit(i, j, a.z + wb * (b.z - a.z) + wc * (c.z - a.z));
        }
    }
}

} // namespace gtx
