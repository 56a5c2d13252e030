/* Triangles at the centres of a grid of texels. */
#pragma once

#include "mesh/vec.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

/* Calls visit(i, j, depth) for the texel centres in a triangle, edges included. Corners are in
 * texels, texel (i, j) from i to i + 1 and j to j + 1; depths are the corners' z. */
template <class Visit>
void raster_centres(const Vec3d corner[3], int width, int height, Visit visit)
{
    const Vec3d &a = corner[0], &b = corner[1], &c = corner[2];
    double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0)
        return;
    auto first = [](double x) { return int(std::max(0., std::ceil(x - 0.5))); };
    auto last = [](double x, int size) {
        return int(std::floor(std::clamp(x - 0.5, -1., size - 1.)));
    };
    int i0 = first(std::min({a.x, b.x, c.x})), i1 = last(std::max({a.x, b.x, c.x}), width);
    int j0 = first(std::min({a.y, b.y, c.y})), j1 = last(std::max({a.y, b.y, c.y}), height);
    for (int j = j0; j <= j1; ++j)
        for (int i = i0; i <= i1; ++i) {
            double x = i + 0.5, y = j + 0.5;
            double wb = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
            double wc = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
            if (wb < 0 || wc < 0 || wb + wc > 1)
                continue;
            visit(i, j, a.z + wb * (b.z - a.z) + wc * (c.z - a.z));
        }
}

} // namespace gtx
