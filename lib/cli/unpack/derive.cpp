/* What follows from the heights of an unpacked asset, derived from them again. */
#include "cli/unpack/unpacked.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace gtx {

/* The points of the patch's coded texels. */
static std::vector<std::array<double, 3>> coded_points(const gtx_asset_desc &d, const gtx_patch &p)
{
    std::vector<std::array<double, 3>> points;
    const uint8_t *codes = static_cast<const uint8_t *>(d.height);
    const uint32_t w = p.rect[2], h = p.rect[3];
    if (p.page >= d.page_count || p.rect[0] + w > d.page_width || p.rect[1] + h > d.page_height)
        return points; /* gtx_create will say so */
    for (uint32_t j = 0; j < h; ++j) {
        for (uint32_t i = 0; i < w; ++i) {
            const size_t row = size_t(p.page) * d.page_height + p.rect[1] + j;
            const size_t at = row * d.page_width + p.rect[0] + i;
            const unsigned code = d.height_bits == 8 ? codes[at]
                                                     : codes[2 * at] | codes[2 * at + 1] << 8;
            if (!code)
                continue;
            const double a = (i + 0.5) / w * p.extent_x, b = (j + 0.5) / h * p.extent_y;
            const double c = (code - 1) / (d.height_bits == 8 ? 254. : 65534.) * p.extent_z;
            std::array<double, 3> point;
            for (int k = 0; k < 3; ++k)
                point[k] = p.origin[k] + a * p.axis_x[k] + b * p.axis_y[k] + c * p.axis_z[k];
            points.push_back(point);
        }
    }
    return points;
}

void derive_again(Unpacked &unpacked)
{
    gtx_asset_desc &d = unpacked.desc;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (gtx_patch &p : unpacked.patches) {
        const auto points = coded_points(d, p);
        double from[3] = {INFINITY, INFINITY, INFINITY}, to[3] = {-INFINITY, -INFINITY, -INFINITY};
        for (const auto &point : points)
            for (int k = 0; k < 3; ++k) {
                from[k] = std::min(from[k], point[k]);
                to[k] = std::max(to[k], point[k]);
            }
        p.coverage = float(double(points.size()) / (double(p.rect[2]) * p.rect[3]));
        if (points.empty())
            continue;
        double square = 0;
        for (int k = 0; k < 3; ++k) {
            p.sphere[k] = float((from[k] + to[k]) / 2);
            low[k] = std::min(low[k], from[k]);
            high[k] = std::max(high[k], to[k]);
        }
        for (const auto &point : points)
            square = std::max(square, std::pow(point[0] - p.sphere[0], 2) +
                                          std::pow(point[1] - p.sphere[1], 2) +
                                          std::pow(point[2] - p.sphere[2], 2));
        p.sphere[3] = float(std::sqrt(square) * (1 + 1e-6)) + 1e-30f;
    }
    for (int k = 0; k < 3 && low[0] <= high[0]; ++k) {
        d.bounds_min[k] = float(low[k]);
        d.bounds_max[k] = float(high[k]);
    }
    if (d.lod_levels)
        unpacked.warnings.push_back("the LOD mesh does not follow the heights and was left out");
    d.lod_levels = 0;
    unpacked.warnings.push_back("coverage, spheres and bounds were computed anew from the heights");
}

} // namespace gtx
