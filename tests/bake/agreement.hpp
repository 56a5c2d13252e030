/* How far two assets of the same charts agree, texel by texel at the same place of the surface. */
#pragma once

#include "mesh/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace agreement {

using gtx::Vec3d;

struct Agreement {
    uint64_t both = 0, either = 0;                  /* texels that both cover; that one does */
    uint64_t height = 0, normal = 0, color = 0;     /* of both, more than one code apart */

    double share(uint64_t differing) const { return 1 - double(differing) / double(both); }
    double least() const { return share(std::max({height, normal, color})); }
};

/* The maps of an asset of 8-bit heights. */
struct Pages {
    gtx_info info;
    const gtx_patch *patches;
    const uint8_t *height, *normal, *color;         /* color may be null */

    explicit Pages(const gtx_asset *asset) : patches(gtx_patches(asset))
    {
        gtx_get_info(asset, &info);
        auto map = [&](gtx_map of) {
            return static_cast<const uint8_t *>(gtx_map_data(asset, of, 0, nullptr));
        };
        height = map(GTX_MAP_HEIGHT);
        normal = map(GTX_MAP_NORMAL);
        color = map(GTX_MAP_COLOR);
    }
    /* The index of a patch's texel; outside of its rectangle `none`. */
    static constexpr size_t none = SIZE_MAX;
    size_t covered(const gtx_patch &p, int i, int j) const
    {
        if (i < 0 || j < 0 || i >= p.rect[2] || j >= p.rect[3])
            return none;
        size_t row = size_t(p.page) * info.page_height + p.rect[1] + size_t(j);
        size_t at = row * info.page_width + p.rect[0] + size_t(i);
        return height[at] ? at : none;
    }
    uint64_t all_covered(const gtx_patch &p) const
    {
        uint64_t count = 0;
        for (int j = 0; j < p.rect[3]; ++j)
            for (int i = 0; i < p.rect[2]; ++i)
                count += covered(p, i, j) != none;
        return count;
    }
};

/* From one patch's texels to those of another of the same frame: maps may begin elsewhere. */
struct Shift {
    int x = 0, y = 0;
    double z = 0;                                   /* from one's lowest height to the other's */
    bool same_pitch = false;

    Shift(const gtx_patch &p, const gtx_patch &q)
    {
        auto vec = [](const float v[3]) { return Vec3d(v[0], v[1], v[2]); };
        Vec3d a = vec(p.axis_x), b = vec(p.axis_y), c = vec(p.axis_z);
        Vec3d off = vec(p.origin) - vec(q.origin);
        double det = dot(cross(a, b), c), px = double(p.extent_x) / p.rect[2];
        double py = double(p.extent_y) / p.rect[3];
        x = int(std::lround(dot(cross(b, c), off) / det / px));
        y = int(std::lround(dot(cross(c, a), off) / det / py));
        z = dot(cross(a, b), off) / det;
        same_pitch = std::fabs(px * q.rect[2] / q.extent_x - 1) < 1e-4 &&
                     std::fabs(py * q.rect[3] / q.extent_y - 1) < 1e-4;
    }
};

inline bool far(const uint8_t *a, const uint8_t *b, size_t channels)
{
    for (size_t k = 0; k < channels; ++k)
        if (std::abs(a[k] - b[k]) > 1)
            return true;
    return false;
}

inline void add_patch(const Pages &a, const gtx_patch &p, const Pages &b, const gtx_patch &q,
                      Agreement &out)
{
    const Shift shift(p, q);
    const double step = std::max(p.extent_z, q.extent_z) / 254;
    uint64_t both = 0, either = 0;
    for (int j = 0; j < p.rect[3]; ++j) {
        for (int i = 0; i < p.rect[2]; ++i) {
            const size_t x = a.covered(p, i, j);
            const size_t y = shift.same_pitch ? b.covered(q, i + shift.x, j + shift.y) : a.none;
            either += x != a.none;
            if (x == a.none || y == b.none)
                continue;
            ++both;
            double over = (a.height[x] - 1) / 254. * p.extent_z + shift.z;
            over -= (b.height[y] - 1) / 254. * q.extent_z;
            out.height += std::fabs(over) > 1.001 * step;
            out.normal += far(a.normal + 2 * x, b.normal + 2 * y, 2);
            out.color += a.color && far(a.color + 4 * x, b.color + 4 * y, 4);
        }
    }
    either += b.all_covered(q);
    out.both += both;
    out.either += either - both;
}

inline bool is_same(const gtx_patch &p, const gtx_patch &q)
{
    double apart = 0;
    for (int k = 0; k < 3; ++k)
        apart = std::max({apart, std::fabs(double(p.axis_x[k]) - q.axis_x[k]),
                          std::fabs(double(p.axis_y[k]) - q.axis_y[k]),
                          std::fabs(double(p.axis_z[k]) - q.axis_z[k])});
    return apart < 1e-6 && p.source_triangles == q.source_triangles;
}

/* Patches are in the same order, but for some that one asset has alone: those of surface that
 * heights a code apart leave uncovered. */
inline Agreement measure(const gtx_asset *one, const gtx_asset *other)
{
    const Pages a(one), b(other);
    Agreement out;
    uint32_t next = 0;
    for (uint32_t i = 0; i < a.info.patch_count; ++i) {
        uint32_t same = next;
        while (same < b.info.patch_count && !is_same(a.patches[i], b.patches[same]))
            ++same;
        if (same == b.info.patch_count) {
            out.either += a.all_covered(a.patches[i]);
            continue;
        }
        for (; next < same; ++next)
            out.either += b.all_covered(b.patches[next]);
        add_patch(a, a.patches[i], b, b.patches[next++], out);
    }
    for (; next < b.info.patch_count; ++next)
        out.either += b.all_covered(b.patches[next]);
    return out;
}

} // namespace agreement
