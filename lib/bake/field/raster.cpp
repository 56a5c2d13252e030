/* Samples the true surface of a chart at the texel centres of its grid. */
#include "bake/field/chart_field.hpp"
#include "chart/raster.hpp"

#include <algorithm>

namespace gtx::baking {

/* Calls visit(texel, c) for the texel centres in a triangle. Edges belong to both sides, so that
 * no centre falls between two triangles. */
template <class Visit> static void raster(const FlatTriangle &t, const Grid &grid, Visit visit)
{
    cancel_point();
    const Vec3d *p = t.corner;
    double ux = p[1].x - p[0].x, uy = p[1].y - p[0].y;
    double vx = p[2].x - p[0].x, vy = p[2].y - p[0].y;
    double area = ux * vy - uy * vx;
    if (area == 0)
        return;
    auto low = [](double a, double b, double c) {
        return int(std::ceil(std::max(std::min({a, b, c}) - 1e-9, 0.)));
    };
    auto high = [](double a, double b, double c, int size) {
        return int(std::floor(std::clamp(std::max({a, b, c}) + 1e-9, -1., size - 1.)));
    };
    int x0 = low(p[0].x, p[1].x, p[2].x), x1 = high(p[0].x, p[1].x, p[2].x, grid.w);
    int y0 = low(p[0].y, p[1].y, p[2].y), y1 = high(p[0].y, p[1].y, p[2].y, grid.h);
    const double u[2] = {ux, uy}, v[2] = {vx, vy};
    for (int y = y0; y <= y1; ++y) {
        const Row row = narrow_row(x0 - p[0].x, x1 - x0 + 1, y - p[0].y, u, v, area, -1e-9);
        for (int x = x0 + row.from; x < x0 + row.to; ++x) {
            double dx = x - p[0].x, dy = y - p[0].y;
            double b1 = (dx * vy - dy * vx) / area, b2 = (ux * dy - uy * dx) / area;
            if (b1 < -1e-9 || b2 < -1e-9 || b1 + b2 > 1 + 1e-9)
                continue;
            double c = p[0].z + b1 * (p[1].z - p[0].z) + b2 * (p[2].z - p[0].z);
            visit(size_t(y) * grid.w + x, c);
        }
    }
}

Cover raster_core(const FlatChart &chart)
{
    Cover cover;
    cover.height.assign(chart.grid.texels(), 0);
    cover.triangle.assign(chart.grid.texels(), NO_TRIANGLE);
    for (size_t t = 0; t < chart.core; ++t) {
        if (!chart.triangles[t].front)
            continue;
        raster(chart.triangles[t], chart.grid, [&](size_t texel, double c) {
            if (cover.triangle[texel] == NO_TRIANGLE || c > cover.height[texel]) {
                cover.height[texel] = c;
                cover.triangle[texel] = uint32_t(t);
            }
        });
    }
    return cover;
}

void raster_overlap(const FlatChart &chart, const Outline &core, Paths &paths, Cover &cover)
{
    /* Texels around the border within which surface must lead on from it. Less than 0.3 % at
     * half or double on any model. */
    constexpr double REACH = 2.5;
    const Grid &grid = chart.grid;
    double jump = JUMP * grid.coarse_pitch();
    for (size_t t = chart.core; t < chart.triangles.size(); ++t) {
        if (!chart.triangles[t].front)
            continue;
        raster(chart.triangles[t], grid, [&](size_t texel, double c) {
            uint32_t &triangle = cover.triangle[texel];
            if (triangle != NO_TRIANGLE && triangle < chart.core)
                return;
            const OutlineEdge &edge = core.edges[core.nearest[texel]];
            double u = double(texel % grid.w), v = double(texel / grid.w);
            Vec3d border = edge.from + (edge.to - edge.from) * nearest_parameter(edge, u, v);
            double off = std::fabs(c - border.z);
            /* Of several layers the one nearest to the border's depth continues it. */
            if (triangle != NO_TRIANGLE && off >= std::fabs(cover.height[texel] - border.z))
                return;
            /* What no short way leads to is another height field that passes above or below. */
            double reach = REACH + core.distance[texel];
            if (off > jump && !paths.joined(edge.triangle, uint32_t(t), u, v, reach))
                return;
            cover.height[texel] = c;
            triangle = uint32_t(t);
        });
    }
}

} // namespace gtx::baking
