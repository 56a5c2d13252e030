/* A camera anywhere, for viewpoints that are not on an orbit. */
#include "cli/bench/scene.hpp"

#include <algorithm>

namespace gtx {

/* Of the near plane, in diagonals of the bounds, where the eye is among them: near enough for feet
 * that stand on the surface, and depth in floats is still finer than a pixel at the far end. */
constexpr double NEAR = 0.0005;

/* Across `back`, the upright axis where that can be told. */
static Vec3d right_of(const Vec3d &up, const Vec3d &back)
{
    Vec3d right = cross(up, back);
    if (!(length(right) > 1e-6))
        right = cross(std::fabs(back.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1), back);
    return normalize(right);
}

gtx_view BenchScene::view_of(const ViewPath &path, size_t which, uint32_t width,
                             uint32_t height) const
{
    const Vec3d anchor(info.anchor[0], info.anchor[1], info.anchor[2]);
    const Vec3d eye = path.views[which].eye - anchor;
    const Vec3d back = normalize(path.views[which].eye - path.views[which].target);
    const Vec3d right = right_of(path.up, back);
    const Vec3d axes[3] = {right, cross(back, right), back};
    gtx_view view = {};
    for (int row = 0; row < 3; ++row) {
        for (int k = 0; k < 3; ++k)
            view.view[4 * k + row] = float(axes[row][k]);
        view.view[12 + row] = float(-dot(axes[row], eye));
        view.light_direction[row] = float(back[row]);
    }
    view.view[15] = 1;
    Vec3d outside, across; /* from the eye to the box, and to the far corner */
    for (int k = 0; k < 3; ++k) {
        const double low = double(info.bounds_min[k]), high = double(info.bounds_max[k]);
        outside[k] = std::max({low - eye[k], eye[k] - high, 0.});
        across[k] = std::max(std::fabs(eye[k] - low), std::fabs(eye[k] - high));
    }
    /* planes are flat: what is that near may lie at the corner of the window */
    const double slope = std::tan(path.field * 3.141592653589793 / 360);
    const double aspect = double(width) / height;
    const double corner = std::sqrt(1 + slope * slope * (1 + aspect * aspect));
    const double near = std::max(length(outside) / corner, 2 * NEAR * double(radius_));
    const double far = std::max(length(across), 2 * near);
    view.projection[0] = float(1 / (slope * aspect));
    view.projection[5] = float(1 / slope);
    view.projection[10] = float((near + far) / (near - far));
    view.projection[14] = float(2 * near * far / (near - far));
    view.projection[11] = -1;
    view.ambient = 0.2f;
    view.viewport_width = width;
    view.viewport_height = height;
    view.max_error = float(max_error);
    return view;
}

} // namespace gtx
