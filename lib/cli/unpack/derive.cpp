/* What follows from the heights of an unpacked asset, derived from them again. */
#include "cli/unpack/unpacked.hpp"

#include "asset/patch.h"

#include <algorithm>

namespace gtx {

void derive_again(Unpacked &unpacked)
{
    gtx_asset_desc &d = unpacked.desc;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    const uint32_t bytes = d.height_bits / 8;
    for (gtx_patch &p : unpacked.patches) {
        if (p.page >= d.page_count || p.rect[0] + p.rect[2] > d.page_width ||
            p.rect[1] + p.rect[3] > d.page_height)
            continue; /* gtx_create will say so */
        const size_t row = size_t(p.page) * d.page_height + p.rect[1];
        const size_t first = (row * d.page_width + p.rect[0]) * bytes;
        const gtx_code_map codes = {static_cast<const uint8_t *>(d.height) + first, d.page_width,
                                    bytes, d.height_bits};
        const gtx_patch_span span = gtx_measure_patch(&p, &codes);
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], span.low[k]);
            high[k] = std::max(high[k], span.high[k]);
        }
    }
    for (int k = 0; k < 3 && low[0] <= high[0]; ++k) {
        d.bounds_min[k] = float(low[k]);
        d.bounds_max[k] = float(high[k]);
    }
    if (d.lod_levels)
        unpacked.warnings.push_back({GTX_WARNING_LOD_DROPPED,
                                     "the LOD mesh does not follow the heights and was left out"});
    d.lod_levels = 0;
    unpacked.warnings.push_back({GTX_WARNING_BOUNDS_DERIVED, "coverage, spheres and bounds were "
                                                             "computed anew from the heights"});
}

} // namespace gtx
