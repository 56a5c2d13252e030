/* Charts that are one height map together become one. */
#pragma once

#include "chart/split.hpp"

namespace gtx {

/* Merges neighbours among charts that fold nowhere, where they fold nowhere together. Returns what
 * had to be set apart for that: connected, and for the caller to split. */
std::vector<Region> merge_charts(const Surface &surface, const Bounds &bounds,
                                 std::vector<Region> &regions, std::vector<Frame> &frames,
                                 Task &task);

} // namespace gtx
