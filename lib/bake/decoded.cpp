/* Decodes the maps of a patch again: what a reader sees at a point. */
#include "bake/decoded.hpp"

namespace gtx::baking {

Decoded::Decoded(const PatchMaps &patch, unsigned height_bits)
    : maps(&patch), w(patch.record.rect[2]), h(patch.record.rect[3])
{
    const gtx_patch &r = patch.record;
    const float *from[3] = {r.axis_x, r.axis_y, r.axis_z};
    for (int k = 0; k < 3; ++k)
        axis[k] = {from[k][0], from[k][1], from[k][2]};
    origin = {r.origin[0], r.origin[1], r.origin[2]};
    const double det = dot(cross(axis[0], axis[1]), axis[2]);
    for (int k = 0; k < 3; ++k)
        dual[k] = cross(axis[(k + 1) % 3], axis[(k + 2) % 3]) / det;
    pitch[0] = double(r.extent_x) / w;
    pitch[1] = double(r.extent_y) / h;
    step = r.extent_z / (height_bits == 8 ? 254. : 65534.);
    place = double(r.sphere[0]) + r.sphere[1] + r.sphere[2];
}

bool Decoded::sheet_above(const Vec3d &point, double &above, double &trim) const
{
    const double u = across(0, point), v = across(1, point);
    if (!(u >= 0 && v >= 0 && u < w - 1 && v < h - 1))
        return false;
    const int i = int(u), j = int(v);
    const double x = u - i, y = v - j;
    const double weight[4] = {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
    const size_t corner[4] = {at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)};
    double code = 0;
    trim = 0;
    for (int k = 0; k < 4; ++k) {
        if (!maps->height[corner[k]])
            return false;
        code += weight[k] * maps->height[corner[k]];
        trim += weight[k] * (maps->trim[corner[k]] - 128.) / 16;
    }
    above = height(code) - dot(dual[2], point - origin);
    return true;
}

} // namespace gtx::baking
