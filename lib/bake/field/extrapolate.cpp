/* Continues the height field past the true surface: every cell that shows has its corners. */
#include "bake/field/chart_field.hpp"

#include <algorithm>

namespace gtx::baking {

Vector<uint8_t> find_support(const Grid &grid, const Vector<float> &trim)
{
    Vector<uint8_t> support(grid.texels(), 0);
    for (int j = 0; j + 1 < grid.h; ++j) {
        for (int i = 0; i + 1 < grid.w; ++i) {
            size_t a = size_t(j) * grid.w + i, b = a + grid.w;
            if (shown(std::min({trim[a], trim[a + 1], trim[b], trim[b + 1]})))
                support[a] = support[a + 1] = support[b] = support[b + 1] = 1;
        }
    }
    return support;
}

struct Slope {
    double u = 0, v = 0; /* object units of depth a texel */
};

/* Never as steep as a depth discontinuity: a sliver at the border would shoot away. */
static Slope clamped(Slope s, double pitch)
{
    double size = length(s.u, s.v), most = JUMP * pitch;
    return size > most ? Slope{s.u * most / size, s.v * most / size} : s;
}

static Slope triangle_slope(const FlatTriangle &t)
{
    Vec3d e = t.corner[1] - t.corner[0], f = t.corner[2] - t.corner[0];
    double area = e.x * f.y - e.y * f.x;
    if (std::fabs(area) < 1e-12)
        return {};
    return {(e.z * f.y - f.z * e.y) / area, (f.z * e.x - e.z * f.x) / area};
}

/* The slope of the covered texels around (u, v) by weighted least squares. A triangle of its own
 * tells less: at the border of a scan it is often a sliver. Falls back to it where the texels lie
 * on a line. Texels of another height field do not count. */
static Slope fitted_slope(const FlatChart &chart, const Cover &cover, const Vec3d &at,
                          uint32_t triangle, Paths &paths)
{
    constexpr int REACH = 2; /* truck: 2 % more texels at half; 0.7 % RMS more at double */
    const Grid &grid = chart.grid;
    double jump = JUMP * grid.coarse_pitch();
    int ci = int(std::floor(at.x + 0.5)), cj = int(std::floor(at.y + 0.5));
    double suu = 0, suv = 0, svv = 0, suz = 0, svz = 0;
    for (int j = std::max(cj - REACH, 0); j <= std::min(cj + REACH, grid.h - 1); ++j) {
        for (int i = std::max(ci - REACH, 0); i <= std::min(ci + REACH, grid.w - 1); ++i) {
            size_t texel = size_t(j) * grid.w + i;
            if (cover.triangle[texel] == NO_TRIANGLE)
                continue;
            double u = i - at.x, v = j - at.y, z = cover.height[texel] - at.z;
            if (std::fabs(z) > jump * std::max(1., length(u, v)) &&
                !paths.joined(triangle, cover.triangle[texel], at.x, at.y, REACH + 1))
                continue;
            double m = 1 / (0.5 + u * u + v * v);
            suu += m * u * u;
            suv += m * u * v;
            svv += m * v * v;
            suz += m * u * z;
            svz += m * v * z;
        }
    }
    /* The plane passes through the border point itself: the surface must go on from there. */
    double det = suu * svv - suv * suv;
    if (det <= 1e-3 * (suu + svv) * (suu + svv))
        return triangle_slope(chart.triangles[triangle]);
    return {(suz * svv - svz * suv) / det, (svz * suu - suz * suv) / det};
}

void extrapolate(Paths &paths, ChartField &field)
{
    const Grid &grid = field.flat.grid;
    const Outline &outline = field.outline;
    const Cover sampled = field.cover; /* fit to the surface alone, not to what is filled in here */
    for (size_t texel = 0; texel < field.support.size(); ++texel) {
        if (!field.support[texel] || sampled.triangle[texel] != NO_TRIANGLE)
            continue;
        double u = double(texel % grid.w), v = double(texel / grid.w);
        const OutlineEdge &edge = outline.edges[outline.nearest[texel]];
        Vec3d border = edge.from + (edge.to - edge.from) * nearest_parameter(edge, u, v);
        Slope slope = clamped(fitted_slope(field.flat, sampled, border, edge.triangle, paths),
                              grid.coarse_pitch());
        field.cover.height[texel] =
            border.z + slope.u * (u - border.x) + slope.v * (v - border.y);
    }
}

} // namespace gtx::baking
