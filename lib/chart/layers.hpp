/* Layers of a chart: what its own triangles cover twice along the axis of projection. */
#pragma once

#include "chart/frame.hpp"

namespace gtx {

/* Two layers at one texel centre: local triangles, and how far apart they are. */
struct DoubleSample {
    uint32_t front, back;
    float depth;
};

struct Layers {
    size_t samples = 0;                 /* texel centres covered */
    size_t doubled = 0;                 /* of those, twice */
    std::vector<DoubleSample> folds;    /* the doubled ones that no junk rule excuses */
};

/* Rasterises all triangles of a region, both facings, at the texel centres of its frame. */
Layers find_layers(const Surface &surface, const Region &region, const Frame &frame, double pitch);

} // namespace gtx
