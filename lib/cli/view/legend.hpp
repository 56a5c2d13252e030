/* What the colours of a picture mean. */
#pragma once

#include "cli/view/debug_views.hpp"
#include "host/text.h"

namespace gtx {

struct Legend {
    struct Entry {
        std::array<uint8_t, 3> color;
        std::string text;
    };
    Vector<Entry> entries;
    Vector<std::array<uint8_t, 3>> ramp;      /* from the lowest value up; may be empty */
    std::string low, high;                    /* at its ends */
    std::string title;                        /* what it tells; may be empty */
    bool empty() const { return entries.empty() && ramp.empty(); }
};

/* Of a debug view, or else of the colour map that an asset's META tells of; empty where colours
 * are the model's own. */
Legend legend_of(const Scene &scene, DebugView debug);

/* Of lines of equal height. */
Legend::Entry contours_legend(double step);

/* Both onto a picture of so many pixels: a line in the upper left corner; the legend in the lower
 * left one. */
void add_label(gtx_shapes &shapes, uint32_t width, uint32_t height, const std::string &label);
void add_legend(gtx_shapes &shapes, uint32_t width, uint32_t height, const Legend &legend);

} // namespace gtx
