/* A patch's sheet as a reader decodes it. */
#pragma once

#include "bake/patch_maps.hpp"

namespace gtx::baking {

/* Texel (i, j) lies at u = i, v = j, heights along the axis. Points are relative to the anchor. */
struct Decoded {
    const PatchMaps *maps;
    Vec3d origin, axis[3], dual[3];
    double pitch[2], step;       /* of a texel, and of a code */
    double place;                /* of its sphere, along (1, 1, 1) */
    int w, h;

    Decoded(const PatchMaps &patch, unsigned height_bits);
    Vec3d point(double u, double v, double height) const
    {
        return origin + axis[0] * ((u + 0.5) * pitch[0]) + axis[1] * ((v + 0.5) * pitch[1]) +
               axis[2] * height;
    }
    size_t at(int i, int j) const { return size_t(j) * size_t(w) + size_t(i); }
    double height(double code) const { return (code - 1) * step; }
    double texel() const { return std::max(pitch[0], pitch[1]); }
    /* How far above a point the sheet is, along the axis, and the trim there; false where it has
     * no cell. */
    bool sheet_above(const Vec3d &point, double &above, double &trim) const;
    /* The first corner of the cell that it is in there. */
    size_t cell(const Vec3d &point) const
    {
        return at(int(across(0, point)), int(across(1, point)));
    }

private:
    /* Texels along an axis. */
    double across(int k, const Vec3d &point) const
    {
        return dot(dual[k], point - origin) / pitch[k] - 0.5;
    }
};

} // namespace gtx::baking
