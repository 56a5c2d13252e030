/* The 26 orthographic views around a mesh. */
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

Vector<View> comparison_views(const Extent &extent, uint32_t size)
{
    Vector<View> views;
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                if (!x && !y && !z)
                    continue;
                View view;
                view.toward = normalize(Vec3d(x, y, z));
                Vec3d up = x || z ? Vec3d(0, 1, 0) : Vec3d(0, 0, 1);
                view.right = normalize(cross(up, view.toward));
                view.up = cross(view.toward, view.right);
                view.middle = extent.centre + view.toward * (2 * extent.radius);
                view.pixel = 2 * extent.radius / (0.96 * size);
                view.size = size;
                views.push_back(view);
            }
    return views;
}

} // namespace gtx
