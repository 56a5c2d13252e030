/* How far a point lies outside the triangles around a vertex. */
#include "bake/shell_outlier.hpp"

namespace gtx::baking {

/* By which shares of its corners a triangle is nearest to a point. */
static std::array<double, 3> nearest_shares(const std::array<Vec3d, 3> &c, const Vec3d &point)
{
    const Vec3d x = c[1] - c[0], y = c[2] - c[0], p = point - c[0];
    const double xx = dot(x, x), xy = dot(x, y), yy = dot(y, y), px = dot(p, x), py = dot(p, y);
    const double whole = xx * yy - xy * xy, b = yy * px - xy * py, d = xx * py - xy * px;
    if (whole > 0 && b >= 0 && d >= 0 && b + d <= whole)
        return {(whole - b - d) / whole, b / whole, d / whole};
    std::array<double, 3> best = {1, 0, 0};
    double least = INFINITY;
    for (int k = 0; k < 3; ++k) {
        const int n = (k + 1) % 3;
        const Vec3d edge = c[n] - c[k], from = point - c[k];
        const double size = dot(edge, edge);
        const double at = size > 0 ? std::clamp(dot(from, edge) / size, 0.0, 1.0) : 0;
        const Vec3d way = from - edge * at;
        if (dot(way, way) >= least)
            continue;
        least = dot(way, way);
        best = {0, 0, 0};
        best[k] = 1 - at;
        best[n] = at;
    }
    return best;
}

Outlier find_outlier(const std::vector<Vec3d> &positions, const std::vector<Triangle> &triangles,
                     const uint32_t *star, size_t count, uint32_t vertex, const Vec3d &point)
{
    Outlier out;
    Vec3d facing;
    double least = INFINITY;
    for (size_t i = 0; i < count; ++i) {
        const Triangle &t = triangles[star[i]];
        const std::array<Vec3d, 3> c = {positions[t[0]], positions[t[1]], positions[t[2]]};
        const std::array<double, 3> share = nearest_shares(c, point);
        const Vec3d way = point - (c[0] * share[0] + c[1] * share[1] + c[2] * share[2]);
        facing += cross(c[1] - c[0], c[2] - c[0]);
        if (dot(way, way) >= least)
            continue;
        least = dot(way, way);
        out.way = way;
        out.share = share[corner_of(t, vertex)];
    }
    out.height = dot(out.way, facing) > 0 ? std::sqrt(least) : 0;
    return out;
}

} // namespace gtx::baking
