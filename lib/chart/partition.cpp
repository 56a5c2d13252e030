/* The order of partitioning: cluster, split what is no height map, set the density, report. */
#include "chart/cuts/agglomerate.hpp"
#include "chart/attach.hpp"
#include "chart/cuts/cut.hpp"
#include "chart/layers/peel.hpp"
#include "chart/merge.hpp"
#include "chart/pgp/pgp.hpp"
#include "chart/split.hpp"
#include "chart/vsa.hpp"

#include <algorithm>

namespace gtx {

namespace {

/* VSA and PGP: no chart's side exceeds the (area-weighted) median side by more than this factor,
 * for the longest side sets the density of the whole model. Half: patches +23 % (truck); double: a
 * few bytes. */
constexpr double LONGEST_SIDE = 2.5;
/* A limit: half-edges are counted in ints. */
constexpr size_t MAX_TRIANGLES = 300000000;
/* VSA and PGP: texels of `resolution` that are left to the overlap. Half: texels +10 %; double:
 * texels -13 % (truck). */
constexpr unsigned OVERLAP_TEXELS = 8;
/* At a resolution of 128, least texels of a chart, on average: a model may be of thousands of small
 * components. Binding for those alone; half and double change nothing on scans. */
constexpr double CHART_TEXELS = 100;
/* Likewise, most texels of its rectangle: of a sliver chart that is nearly all empty. */
constexpr double MAX_TEXELS = 4 * PATCH_TEXELS;
/* Of a chart that is two-sided. Where any share counted, 448 of the dragon's 449 patches were, with
 * this 13; half and double change a few bytes. */
constexpr double TWO_SIDED_AREA = 0.05;

uint32_t default_count(const Mesh &mesh)
{
    return uint32_t(std::lround(10 * std::pow(double(mesh.triangle_count()), 0.28)));
}

uint32_t chart_count(const Mesh &mesh, const ChartOptions &options)
{
    size_t triangles = mesh.triangle_count(), most = options.charts ? triangles : triangles / 2;
    size_t wanted = options.charts ? options.charts : default_count(mesh);
    return uint32_t(std::max<size_t>(1, std::min(wanted, most)));
}

double side_texels(const ChartOptions &options)
{
    return double(std::max(options.resolution, 2 * OVERLAP_TEXELS) - OVERLAP_TEXELS);
}

double long_side(const Frame &frame)
{
    return std::max(frame.extent[0], frame.extent[1]);
}

/* The longest side gets the resolution, unless more charts than wanted came out so alike that
 * together they would take more than full rectangles in the wanted number. */
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

/* The pitch asked for, or that at which a patch gets its share of texels. */
double cut_pitch(const Surface &surface, size_t patches, const ChartOptions &options)
{
    if (options.pitch > 0)
        return options.pitch;
    return std::sqrt(surface.area / (PATCH_TEXELS * double(patches))) * 128 / options.resolution;
}

/* A triangle in pieces counts once. */
void report_initial(const Surface &surface, const Vector<Region> &regions, Task &task,
                    Partition &out)
{
    Vector<Vector<uint32_t>> inverted(regions.size());
    for_each_region(regions, task, [&](size_t i) {
        Vec3d z = median_axis(surface.mesh, regions[i].triangles);
        for (uint32_t t : regions[i].triangles)
            if (dot(surface.mesh.area_vector(t), z) <= 0)
                inverted[i].push_back(out.source_of(t));
    }, 0.7, 0.72);
    out.report.initial_charts = regions.size();
    Vector<uint32_t> all;
    for (const Vector<uint32_t> &some : inverted) {
        all.insert(all.end(), some.begin(), some.end());
        out.report.initial_folding += !some.empty();
    }
    std::sort(all.begin(), all.end());
    out.report.initial_inverted = uint64_t(std::unique(all.begin(), all.end()) - all.begin());
}

double side_limit(const Surface &surface, const Vector<Region> &regions, Task &task)
{
    Vector<std::pair<double, double>> sides(regions.size());      /* length, area */
    for_each_region(regions, task, [&](size_t i) {
        const Vector<uint32_t> &triangles = regions[i].triangles;
        Frame frame = make_frame(surface.mesh, triangles, median_axis(surface.mesh, triangles));
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

/* Splits until every region is a chart; `frames` gets theirs. Returns whether any was split. */
bool split_all(const Surface &surface, Vector<Region> &regions, Vector<Frame> &frames,
               const Bounds &bounds, Task &task)
{
    size_t before = regions.size();
    Vector<Region> charts, pending = std::move(regions);
    frames.clear();
    while (!pending.empty()) {
        Vector<Verdict> verdicts(pending.size());
        for_each_region(pending, task, [&](size_t i) {
            verdicts[i] = judge(surface, pending[i], bounds);
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

void report_final(const Surface &surface, const Vector<Region> &regions,
                  const Vector<Frame> &frames, Task &task, Partition &out)
{
    struct Count {
        uint64_t inverted, samples, doubled;
        bool folding;
    };
    Vector<Count> counts(regions.size());
    for_each_region(regions, task, [&](size_t i) {
        Layers layers = find_layers(surface, regions[i], frames[i], out.pitch);
        counts[i] = {0, layers.samples, layers.doubled, !layers.folds.empty()};
        for (uint32_t t : regions[i].triangles)
            counts[i].inverted += is_inverted(surface, t, frames[i].z, out.pitch);
    });
    uint64_t samples = 0, doubled = 0;
    for (const Count &c : counts) {
        out.report.inverted_triangles += c.inverted;
        out.report.folding_charts += c.inverted > 0 || c.folding;
        samples += c.samples;
        doubled += c.doubled;
    }
    out.report.second_layer_fraction = samples ? double(doubled) / double(samples) : 0;
    double area = 0;
    for (size_t t = 0; t < surface.junk.size(); ++t)
        if (surface.junk[t]) {
            ++out.report.junk_triangles;
            area += surface.facets[t].size;
        }
    out.report.junk_area_fraction = area / double(surface.junk.size());
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

/* Splits the clusters until each is a chart, at the pitch asked for, or else one that is fine
 * enough for all of them, but not finer than a sliver chart, whose rectangle is all rim, can pay
 * for. */
Vector<Frame> split_for_count(const Surface &surface, const ChartOptions &options,
                              Vector<Region> &regions, Bounds &bounds, Task &task)
{
    const double wanted = chart_count(surface.mesh, options);
    const double scale = std::pow(options.resolution / 128., 2);
    Vector<Frame> frames;
    for (;;) {
        split_all(surface, regions, frames, bounds, task);
        if (options.pitch > 0)
            return frames;
        double charts = double(regions.size());
        double least = scale * CHART_TEXELS * charts;
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

/* Splits the clusters of the paper's method until each is a chart, and finds the pitch. */
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

/* Merges what splitting took apart too far. */
void merge_all(const Surface &surface, Vector<Region> &regions, Vector<Frame> &frames,
               const Bounds &bounds, Task &task)
{
    Vector<Region> loose = merge_charts(surface, bounds, regions, frames, task);
    Vector<Frame> loose_frames;
    split_all(surface, loose, loose_frames, bounds, task);
    std::move(loose.begin(), loose.end(), std::back_inserter(regions));
    frames.insert(frames.end(), loose_frames.begin(), loose_frames.end());
}

/* Whether more of it has two sides than the small islands that a scan has everywhere. */
bool is_two_sided(const Mesh &mesh, const Chart &chart)
{
    double both = 0, area = 0;
    for (uint32_t t : chart.triangles) {
        double of_triangle = length(mesh.area_vector(t));
        area += of_triangle;
        both += !mesh.flags.empty() && mesh.flags[t] & TRIANGLE_TWO_SIDED ? of_triangle : 0;
    }
    return both > TWO_SIDED_AREA * area;
}

Vector<Chart> whole_charts(Vector<Region> regions, const Vector<Frame> &frames,
                           const Partition &partition)
{
    Vector<Chart> out(regions.size());
    for (size_t i = 0; i < regions.size(); ++i) {
        for (uint32_t t : regions[i].triangles)
            out[i].source_triangles += !t || partition.source_of(t) != partition.source_of(t - 1);
        out[i].triangles = std::move(regions[i].triangles);
        out[i].frame = frames[i];
        std::sort(out[i].triangles.begin(), out[i].triangles.end());
    }
    return out;
}

/* Charts, splitting what folds, from the first `count` of them. */
void make_charts(Surface surface, const ChartOptions &options, uint32_t count, Task &task,
                 Partition &out)
{
    const bool layers = options.method == PartitionMethod::LAYERS;
    const bool cut = layers || options.method == PartitionMethod::CUTS;
    const uint32_t wanted = chart_count(surface.mesh, options);
    Vector<Region> regions = split_region(surface.whole, out.initial_chart, count);
    report_initial(surface, regions, task, out);

    Bounds bounds = {INFINITY, cut_pitch(surface, wanted, options), true};
    if (layers)
        bounds.directions = peel_directions(surface);
    const auto split = cut ? split_for_count : split_for_length;
    Vector<Frame> frames = split(surface, options, regions, bounds, task);
    out.pitch = bounds.pitch;

    task.begin("frame");
    if (cut)
        merge_all(surface, regions, frames, bounds, task);
    surface.whole.neighbours = {};
    attach_islands(surface, bounds, regions, frames);
    const unsigned side = std::max(options.resolution / options.grain, 1u) * options.grain;
    if (layers)
        gather_charts(surface, bounds, options.grain, side, regions, frames);
    out.junk = surface.junk;
    report_final(surface, regions, frames, task, out);
    CutPlan plan = {wanted,
                    bounds.pitch,
                    side,
                    options.grain,
                    {options.overlap[0], options.overlap[1]},
                    options.height_steps,
                    options.one_density};
    out.charts = cut ? cut_charts(surface, std::move(regions), frames, plan, task)
                     : whole_charts(std::move(regions), frames, out);
    for (Chart &chart : out.charts)
        chart.two_sided = is_two_sided(surface.mesh, chart);
}

} // namespace

const Mesh &Partition::charted(const Mesh &source_mesh) const
{
    return mesh.triangles.empty() ? source_mesh : mesh;
}

Partition make_partition(const Mesh &mesh, const ChartOptions &options, Task &task)
{
    if (!mesh.triangle_count())
        throw Error(GTX_ERROR_EMPTY, "the mesh has no triangle to partition");
    if (mesh.triangle_count() > MAX_TRIANGLES)
        throw Error(GTX_ERROR_LIMIT, "the mesh has more than 300 million triangles");
    task.begin("partition");
    uint32_t count = chart_count(mesh, options);
    const double pitch = expected_pitch(mesh, count);
    Surface surface = make_surface(mesh, pitch, task);
    Partition out;
    if (options.method == PartitionMethod::PGP) {
        CutMesh cut = square_cells(surface, count, options.adaptive, task);
        out.mesh = std::move(cut.mesh);
        out.source = std::move(cut.source);
        out.initial_chart = std::move(cut.label);
        make_charts(make_surface(out.mesh, pitch, task), options, count, task, out);
        return out;
    }
    switch (options.method) {
    case PartitionMethod::VSA:
        out.initial_chart = cluster(surface, surface.whole, count, task);
        break;
    case PartitionMethod::LAYERS:
        out.initial_chart = peel(surface, peel_directions(surface), count);
        break;
    default: out.initial_chart = agglomerate(surface, count, task);
    }
    make_charts(std::move(surface), options, count, task, out);
    return out;
}

} // namespace gtx
