/* From clusters to charts that are height maps, at a common texel density. */
#pragma once

#include "chart/split.hpp"

namespace gtx {

/* Patches wanted: what was asked for, within reason. */
uint32_t chart_count(const Mesh &mesh, const ChartOptions &options);

/* The pitch asked for, or that at which a patch gets its share of texels. */
double cut_pitch(const Surface &surface, size_t patches, const ChartOptions &options);

/* The pitch at which the longest side gets the resolution, unless more charts than wanted came out
 * so alike that together they would take more than full rectangles in the wanted number. */
double texel_size(const Vector<Frame> &frames, const Mesh &mesh, const ChartOptions &options);

/* Splits until every region is a chart; `frames` gets theirs. Returns whether any was split. */
bool split_all(const Surface &surface, Vector<Region> &regions, Vector<Frame> &frames,
               const Bounds &bounds, Task &task);

/* Splits the clusters until each is a chart, at the pitch asked for, or else one that is fine
 * enough for all of them, but not finer than a sliver chart, whose rectangle is all rim, can pay
 * for. */
Vector<Frame> split_for_count(const Surface &surface, const ChartOptions &options,
                              Vector<Region> &regions, Bounds &bounds, Task &task);

/* Splits the clusters of the paper's method until each is a chart, and finds the pitch. */
Vector<Frame> split_for_length(const Surface &surface, const ChartOptions &options,
                               Vector<Region> &regions, Bounds &bounds, Task &task);

} // namespace gtx
