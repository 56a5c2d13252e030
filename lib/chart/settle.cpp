/* Splits clusters until each is a chart, and finds the texel pitch of the model. */
#include "chart/settle.hpp"
#include "base/exact.h"

#include <algorithm>

namespace gtx {

namespace {

/* VSA and PGP: no chart's side exceeds the (area-weighted) median side by more than this factor,
 * for the longest side sets the density of the whole model. Half: patches +23 % (truck); double: a
 * few bytes. */
constexpr double LONGEST_SIDE = 2.5;
/* VSA and PGP: texels of `resolution` that are left to the overlap. Half: texels +10 %; double:
 * texels -13 % (truck). */
constexpr unsigned OVERLAP_TEXELS = 8;
/* At a resolution of 128, least texels of a chart, on average: a model may be of thousands of small
 * components. Binding for those alone; half and double change nothing on scans. */
constexpr double CHART_TEXELS = 100;
/* Likewise, most texels of its rectangle: of a sliver chart that is nearly all empty. */
constexpr double MAX_TEXELS = 4 * PATCH_TEXELS;

uint32_t default_count(const Mesh &mesh)
{
    return uint32_t(std::lround(10 * gtx_pow(double(mesh.triangle_count()), 0.28)));
}

double side_texels(const ChartOptions &options)
{
    return double(std::max(options.resolution, 2 * OVERLAP_TEXELS) - OVERLAP_TEXELS);
}

double long_side(const Frame &frame)
{
    return std::max(frame.extent[0], frame.extent[1]);
}

double side_limit(const Surface &surface, const Vector<Region> &regions, Task &task)
{
    Vector<std::pair<double, double>> sides(regions.size());      /* length, area */
    for_each_region(regions, task, [&](size_t i) {
        const Vector<uint32_t> &triangles = regions[i].triangles;
        const Vec3d z = median_axis(surface.mesh, triangles, &surface.normal);
        Frame frame = make_frame(surface.mesh, triangles, z);
        sides[i].first = long_side(frame);
        for (uint32_t t : triangles)
            sides[i].second += surface.facets[t].size;
    }, 0.72, 0.75);
    std::sort(sides.begin(), sides.end());
    double half = 0;
    size_t middle = 0;
    while (middle + 1 < sides.size() &&
           (half += sides[middle].second) < 0.5 * double(surface.whole.size()))
        ++middle;
    return std::min(sides.back().first, LONGEST_SIDE * sides[middle].first);
}

/* The pitch at which rectangles with a rim of `RIM` texels take `texels` together. */
double pitch_for(const Vector<Frame> &frames, double texels)
{
    double area = 0, sides = 0, rims = RIM * RIM * double(frames.size());
    for (const Frame &frame : frames) {
        area += frame.extent[0] * frame.extent[1];
        sides += RIM * (frame.extent[0] + frame.extent[1]);
    }
    /* area / p^2 + sides / p + rims = texels */
    double left = std::max(texels - rims, 0.5 * texels);
    return (sides + std::sqrt(sides * sides + 4 * area * left)) / (2 * left);
}

/* Charts that will have a patch each: peeled off along few directions, small islands of one
 * share. */
double paying_charts(const Surface &surface, const Vector<Region> &regions, const Bounds &bounds)
{
    if (bounds.directions.empty())
        return double(regions.size());
    return double(std::count_if(regions.begin(), regions.end(), [&](const Region &region) {
        return texels_of(surface, region, bounds.pitch) >= SMALL_ISLAND_TEXELS;
    }));
}

} // namespace

uint32_t chart_count(const Mesh &mesh, const ChartOptions &options)
{
    size_t triangles = mesh.triangle_count(), most = options.charts ? triangles : triangles / 2;
    size_t wanted = options.charts ? options.charts : default_count(mesh);
    return uint32_t(std::max<size_t>(1, std::min(wanted, most)));
}

double cut_pitch(const Surface &surface, size_t patches, const ChartOptions &options)
{
    if (options.pitch > 0)
        return options.pitch;
    return std::sqrt(surface.area / (PATCH_TEXELS * double(patches))) * 128 / options.resolution;
}

double texel_size(const Vector<Frame> &frames, const Mesh &mesh, const ChartOptions &options)
{
    double longest = 0, area = 0;
    for (const Frame &frame : frames) {
        longest = std::max(longest, long_side(frame));
        area += frame.extent[0] * frame.extent[1];
    }
    double side = side_texels(options);
    double wanted = std::max(options.charts, default_count(mesh));
    return std::max(longest / side, std::sqrt(area / wanted) / side);
}

bool split_all(const Surface &surface, Vector<Region> &regions, Vector<Frame> &frames,
               const Bounds &bounds, Task &task)
{
    size_t before = regions.size();
    Vector<Region> charts, pending = std::move(regions);
    frames.clear();
    while (!pending.empty()) {
        Vector<Verdict> verdicts(pending.size());
        for_each_region(pending, task, [&](size_t i) {
            verdicts[i] = judge(surface, pending[i], bounds, task);
        }, 0.75, 1);
        Vector<Region> next;
        for (size_t i = 0; i < pending.size(); ++i) {
            for (Region &piece : verdicts[i].pieces)
                next.push_back(std::move(piece));
            if (!verdicts[i].pieces.empty())
                continue;
            charts.push_back(std::move(pending[i]));
            frames.push_back(verdicts[i].frame);
        }
        pending = std::move(next);
    }
    regions = std::move(charts);
    return regions.size() != before;
}

Vector<Frame> split_for_count(const Surface &surface, const ChartOptions &options,
                              Vector<Region> &regions, Bounds &bounds, Task &task)
{
    const double wanted = chart_count(surface.mesh, options);
    const double scale = double(options.resolution) * options.resolution / (128 * 128);
    Vector<Frame> frames;
    for (;;) {
        split_all(surface, regions, frames, bounds, task);
        if (options.pitch > 0)
            return frames;
        double charts = paying_charts(surface, regions, bounds);
        double least = scale * CHART_TEXELS * std::max(charts, 1.);
        double most = scale * MAX_TEXELS * std::max(charts, wanted);
        double fine = std::min(bounds.pitch, std::sqrt(surface.area / least));
        double pitch = std::max(fine, pitch_for(frames, most));
        if (pitch >= bounds.pitch) {
            bounds.pitch = pitch;
            return frames;
        }
        bounds.pitch = pitch; /* a finer texel sees other folds */
    }
}

Vector<Frame> split_for_length(const Surface &surface, const ChartOptions &options,
                               Vector<Region> &regions, Bounds &bounds, Task &task)
{
    Vector<Frame> frames;
    bounds = {side_limit(surface, regions, task), 0, false};
    bounds.pitch = bounds.side / side_texels(options);
    while (split_all(surface, regions, frames, bounds, task)) {
        double pitch = texel_size(frames, surface.mesh, options);
        if (pitch == bounds.pitch)
            break;
        bounds.pitch = pitch; /* another texel sees other folds */
    }
    return frames;
}

} // namespace gtx
