/* Levels for models of a few pixels: triangles larger than patches are, each looked up in the patch
 * that lies best under its middle. */
#include "bake/lod/fan.hpp"
#include "bake/lod/parts.hpp"

#include <algorithm>
#include <numeric>

namespace gtx::baking {

/* A patch that is turned further from a triangle does not tell how that is lit. A few bytes at half
 * and at double. */
constexpr double MIN_COSINE = 0.3;

/* How well a patch shows a triangle: the cosine between them, less the way from the triangle's
 * middle to the patch as a share of the triangle's size. -INFINITY where it does not. */
static double suits(const gtx_patch &patch, const PatchRegion &region, const Vec3d &middle,
                    const Vec3d &area)
{
    const double size = length(area);
    const Vec3d z = loaded(patch.axis_z);
    const double facing = size > 0 ? dot(area, z) / size : 0;
    if (facing < MIN_COSINE || !region.holds(region.place(middle)))
        return -INFINITY;
    const Vec3d from = middle - loaded(patch.origin);
    const Vec3d across = cross(loaded(patch.axis_x), loaded(patch.axis_y));
    const double height = dot(across, from) / dot(across, z);
    const double away = std::max({0.0, -height, height - double(patch.extent_z)});
    return facing - away / std::sqrt(size);
}

Vector<uint32_t> find_far_homes(const Simplifier &simplified, const Maps &maps,
                                const Vector<PatchRegion> &regions, Task &task)
{
    const auto &triangles = simplified.triangles();
    Vector<uint32_t> homes = simplified.patch();
    task.parallel(triangles.size(), [&](size_t n) {
        const auto &[a, b, c] = triangles[n];
        const Vector<Vec3d> &at = simplified.positions();
        const Vec3d middle = (at[a] + at[b] + at[c]) / 3;
        const Vec3d area = cross(at[b] - at[a], at[c] - at[a]);
        const uint16_t flags = maps.patches[homes[n]].flags;
        double best = -INFINITY;
        for (uint32_t p = 0; p < regions.size(); ++p) {
            if (maps.patches[p].flags != flags)
                continue;
            const double well = suits(maps.patches[p], regions[p], middle, area);
            if (well <= best)
                continue;
            best = well;
            homes[n] = p;
        }
    }, 1, 1);
    return homes;
}

/* Connected parts of a surface, each named by the lowest of its vertices. */
class Components {
public:
    Components(const Vector<Triangle> &triangles, size_t vertices) : lowest_(vertices)
    {
        std::iota(lowest_.begin(), lowest_.end(), 0u);
        for (const Triangle &t : triangles) {
            const uint32_t a = of(t[0]), b = of(t[1]), c = of(t[2]);
            lowest_[a] = lowest_[b] = lowest_[c] = std::min({a, b, c});
        }
    }
    uint32_t of(uint32_t vertex)
    {
        while (lowest_[vertex] != vertex)
            vertex = lowest_[vertex] = lowest_[lowest_[vertex]];
        return vertex;
    }

private:
    Vector<uint32_t> lowest_;
};

Vector<double> part_sizes(const Vector<Vec3d> &positions, const Vector<Triangle> &triangles)
{
    Components components(triangles, positions.size());
    Vector<Vec3d> low(positions.size(), {INFINITY, INFINITY, INFINITY});
    Vector<Vec3d> high(positions.size(), {-INFINITY, -INFINITY, -INFINITY});
    for (uint32_t v = 0; v < positions.size(); ++v) {
        const uint32_t of = components.of(v);
        for (int k = 0; k < 3; ++k) {
            low[of][k] = std::min(low[of][k], positions[v][k]);
            high[of][k] = std::max(high[of][k], positions[v][k]);
        }
    }
    Vector<double> sizes(triangles.size());
    for (size_t t = 0; t < triangles.size(); ++t) {
        const uint32_t of = components.of(triangles[t][0]);
        sizes[t] = length(high[of] - low[of]);
    }
    return sizes;
}

} // namespace gtx::baking
