/* Finer texels for charts whose textures have more detail than their relief. */
#pragma once

#include "chart/chart.hpp"

namespace gtx {

/* Sets `finer` of the charts, and `more_texels` of the partition. Without textures it changes
 * nothing. Deterministic for any thread count. */
void follow_textures(const Mesh &mesh, const ChartOptions &options, Partition &partition,
                     Task &task);

} // namespace gtx
