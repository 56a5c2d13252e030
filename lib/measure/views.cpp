/* The orthographic views around a mesh: 26 fixed ones, and random ones. */
#include "measure/sample.hpp"
#include "measure/view.hpp"

#include <algorithm>

namespace gtx {

Extent extent_of(const Mesh &mesh)
{
    Extent extent;
    if (mesh.positions.empty())
        return extent;
    Vec3d low = mesh.positions[0], high = low;
    for (const Vec3d &p : mesh.positions)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    extent.centre = (low + high) * 0.5;
    extent.diagonal = length(high - low);
    for (const Vec3d &p : mesh.positions)
        extent.radius = std::max(extent.radius, length(p - extent.centre));
    return extent;
}

static View view_along(const Extent &extent, uint32_t size, const Vec3d &toward)
{
    View view;
    view.toward = normalize(toward);
    const Vec3d up = toward.x != 0 || toward.z != 0 ? Vec3d(0, 1, 0) : Vec3d(0, 0, 1);
    view.right = normalize(cross(up, view.toward));
    view.up = cross(view.toward, view.right);
    view.middle = extent.centre + view.toward * (2 * extent.radius);
    view.pixel = 2 * extent.radius / (0.96 * size);
    view.size = size;
    return view;
}

/* A point of the unit ball, not too near to its centre. */
static Vec3d random_direction(Random &random)
{
    constexpr double NEAREST = 0.1;
    for (;;) {
        Vec3d p;
        for (int k = 0; k < 3; ++k)
            p[k] = 2 * random.next() - 1;
        const double r = length(p);
        if (r <= 1 && r >= NEAREST)
            return p;
    }
}

Vector<View> comparison_views(const Extent &extent, uint32_t size, uint32_t random, uint32_t seed)
{
    Vector<View> views;
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x)
                if (x || y || z)
                    views.push_back(view_along(extent, size, Vec3d(x, y, z)));
    Random numbers(seed);
    for (uint32_t i = 0; i < random; ++i)
        views.push_back(view_along(extent, size, random_direction(numbers)));
    return views;
}

} // namespace gtx
