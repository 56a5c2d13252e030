/* Joins small islands of surface to a larger chart. */
#pragma once

#include "chart/split.hpp"

namespace gtx {

/* Moves charts of a few texels into charts that they touch, where these stay free of folds and
 * texels are saved. Target charts keep their axes, and may then have several connected pieces. What
 * is smaller than a texel or two and faces away becomes junk there. */
void attach_islands(Surface &surface, const Bounds &bounds, Vector<Region> &regions,
                    Vector<Frame> &frames, Task &task);

} // namespace gtx
