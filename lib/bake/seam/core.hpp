/* What of a chart's triangles is its own to show: they reach beyond the lines that it is cut at. */
#pragma once

#include "chart/chart.hpp"
#include "chart/frame.hpp"

namespace gtx::baking {

inline bool in_core(const Chart &chart, const FrameInverse &inverse, const Vec3d &point)
{
    const Vec3d local = inverse(point);
    return local.x >= chart.clip_low[0] && local.x <= chart.clip_high[0] &&
           local.y >= chart.clip_low[1] && local.y <= chart.clip_high[1];
}

/* Whether all of a triangle lies beyond the same cut, and by more than rounding does: many do, for
 * a chart has what its overlap is taken from. */
inline bool beyond_cut(const Chart &chart, const FrameInverse &inverse, const Mesh &mesh,
                       uint32_t triangle, double pitch)
{
    constexpr double ROUNDING = 1e-2;
    bool below[2] = {true, true}, above[2] = {true, true};
    for (int k = 0; k < 3; ++k) {
        const Vec3d local = inverse(mesh.position(triangle, k));
        for (int a = 0; a < 2; ++a) {
            below[a] = below[a] && local[a] < chart.clip_low[a] - ROUNDING * pitch;
            above[a] = above[a] && local[a] > chart.clip_high[a] + ROUNDING * pitch;
        }
    }
    return below[0] || below[1] || above[0] || above[1];
}

} // namespace gtx::baking
