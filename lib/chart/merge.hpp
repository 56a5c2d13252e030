/* Merges charts that together are still one height map. */
#pragma once

#include "chart/split.hpp"

namespace gtx {

/* Merges neighbours among charts that fold nowhere, where they fold nowhere together. Returns what
 * had to be set apart for that: connected, and for the caller to split. */
Vector<Region> merge_charts(const Surface &surface, const Bounds &bounds,
                            Vector<Region> &regions, Vector<Frame> &frames,
                            Task &task);

} // namespace gtx
