/* Every triangle against a ray (Moeller, Trumbore 1997). */
#include "cli/view/lod_rays.hpp"

#include <cmath>

namespace gtx {

LodRays::LodRays(const gtx_asset *asset)
{
    gtx_info info;
    gtx_lod_mesh mesh;
    gtx_get_info(asset, &info);
    if (!info.lod_levels || gtx_get_lod_mesh(asset, 0, &mesh))
        return;
    for (uint32_t i = 0; i < 3 * mesh.vertex_count; ++i)
        positions_.push_back(mesh.origin[i % 3] + mesh.step * float(mesh.positions[i]));
    corners_.assign(mesh.indices, mesh.indices + 3 * size_t(mesh.triangle_count));
}

uint64_t LodRays::bytes() const
{
    return positions_.capacity() * sizeof positions_[0] + corners_.capacity() * sizeof corners_[0];
}

static void cross(const float a[3], const float b[3], float out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

float LodRays::distance(const float origin[3], const float direction[3],
                        const float place[3]) const
{
    float nearest = INFINITY;
    for (size_t t = 0; t < corners_.size(); t += 3) {
        const float *a = &positions_[3 * size_t(corners_[t])];
        float side[2][3], from[3], p[3], q[3];
        for (int k = 0; k < 3; ++k) {
            for (int e = 0; e < 2; ++e)
                side[e][k] = positions_[3 * size_t(corners_[t + size_t(e) + 1]) + size_t(k)] - a[k];
            from[k] = origin[k] - place[k] - a[k];
        }
        cross(direction, side[1], p);
        cross(from, side[0], q);
        const float d = dot(side[0], p), u = dot(from, p) / d, v = dot(direction, q) / d,
                    along = dot(side[1], q) / d;
        if (u >= 0 && v >= 0 && u + v <= 1 && along >= 0 && along < nearest) /* not NaN */
            nearest = along;
    }
    return nearest;
}

} // namespace gtx
