/* The steps of partitioning: cluster, split what is not a height map, set the density, report. */
#include "chart/cuts/agglomerate.hpp"
#include "chart/attach.hpp"
#include "chart/cuts/cut.hpp"
#include "chart/layers/peel.hpp"
#include "chart/merge.hpp"
#include "chart/report.hpp"
#include "chart/settle.hpp"
#include "chart/pgp/pgp.hpp"
#include "chart/split.hpp"
#include "chart/texture_density.hpp"
#include "chart/vsa.hpp"

#include <algorithm>

namespace gtx {

namespace {

/* A limit: half-edges are counted in ints. */
constexpr size_t MAX_TRIANGLES = 300000000;
/* Of a chart that is two-sided. Where any share counted, 448 of the dragon's 449 patches were, with
 * this 13; half and double change a few bytes. */
constexpr double TWO_SIDED_AREA = 0.05;

/* AUTO: part of the texels of cuts below which layers are taken. An engine takes 0.83, a leaf 0.86,
 * a truck 0.95, the bunny 1.03. */
constexpr double WORTH_PEELING = 0.96;
/* AUTO, DEFAULT: the loss of outlines from which layers of finer texels are taken: cuts of an
 * engine lose 0.018, a truck 0.004, closed scans at most 0.0007, a tower with holes 0.002. Half
 * takes that tower too, double an engine alone. And the resolutions to try, times the usual one,
 * until one takes at most about so many times the texels of cuts: an engine gets 2.4 times the
 * texels and 1.04 times the bytes, DamagedHelmet 2.7 and 2.25. At 2 and 2.3 an engine gets 3.3 M
 * texels and an IoU of 0.9947, at this 0.9955; the helmet, at 2, 1.6 times the bytes and 5 times
 * the walls. */
constexpr double MUCH_LOST = 0.003;
constexpr double FINER[] = {2, 1.75, 1.5, 1.25}, MAX_TEXELS = 2.5;
/* Likewise where texels are this part of the diagonal, for less: a box loses 0.0024 and its texels
 * are 0.015, Spot's control mesh 0.0023 and 0.0039; a bottle, whose loss of 0.0028 is nowhere a
 * pixel, 0.0026, and half takes that, too. So many texels are taken anyway: at half Spot's control
 * mesh gets 192 for 256, and 4,814 wall pixels for 745. */
constexpr double LOST_OF_COARSE = 0.0022, COARSE = 0.003, FREE_TEXELS = 1 << 19;
/* A limit: bytes that cooking takes for a texel, with some to spare. What would pass the limit of
 * memory is found out before, where all processors agree: of 2,000 loose triangles' layers 64 bits
 * took .006 % too much, and 32 bits not. */
constexpr double TEXEL_MEMORY = 128;
/* Of a texel, how far an outline is off along borders and sharp edges: one less the IoU that
 * compare measures is 0.011 of an engine (estimated 0.018), 0.005 of a truck (0.004), 0.0006 of the
 * bunny (0.0002). */
constexpr double OUTLINE_TEXELS = 0.04;

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

/* A region has them from the last edge on. */
Vector<std::array<uint32_t, 3>> from_first_edges(Vector<std::array<uint32_t, 3>> neighbours)
{
    for (std::array<uint32_t, 3> &own : neighbours)
        own = {own[1], own[2], own[0]};
    return neighbours;
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

void find_two_sided(const Mesh &mesh, Task &task, Partition &out)
{
    task.parallel(out.charts.size(), [&](size_t i) {
        out.charts[i].two_sided = is_two_sided(mesh, out.charts[i]);
    }, 1, 1);
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
    const bool layers = out.method == PartitionMethod::LAYERS;
    const bool cut = layers || out.method == PartitionMethod::CUTS;
    const uint32_t wanted = chart_count(surface.mesh, options);
    Vector<Region> regions = split_region(surface.whole, out.initial_chart, count);
    report_initial(surface, regions, task, out);
    report_edges(surface, out);

    Bounds bounds = {INFINITY, cut_pitch(surface, wanted, options), true};
    if (layers) /* of the normals that peeling has left */
        bounds.directions = peel_directions(surface);
    const auto split = cut ? split_for_count : split_for_length;
    Vector<Frame> frames = split(surface, options, regions, bounds, task);
    out.pitch = bounds.pitch;

    task.begin("frame");
    if (cut)
        merge_all(surface, regions, frames, bounds, task);
    if (surface.manifold)
        out.neighbours = from_first_edges(std::move(surface.whole.neighbours));
    surface.whole.neighbours = {};
    attach_islands(surface, bounds, regions, frames, task);
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
    find_two_sided(surface.mesh, task, out);
}

} // namespace

const Mesh &Partition::charted(const Mesh &source_mesh) const
{
    return mesh.triangles.empty() ? source_mesh : mesh;
}

double Partition::outline_loss() const
{
    return std::min(1., OUTLINE_TEXELS * report.edge_length * pitch / report.area);
}

/* Numbers labels from 0 without a gap, in their order; returns how many there are. */
static uint32_t number_labels(Vector<uint32_t> &labels)
{
    Vector<uint32_t> number(*std::max_element(labels.begin(), labels.end()) + 1, 0);
    for (uint32_t label : labels)
        number[label] = 1;
    uint32_t count = 0;
    for (uint32_t &n : number)
        n = n ? count++ : 0;
    for (uint32_t &label : labels)
        label = number[label];
    return count;
}

/* The paper's density: the longest side gets the resolution. */
static void make_relief_charts(const Surface &surface, const ChartOptions &options, Task &task,
                               Partition &out)
{
    out.initial_chart = see_from_sides(surface, options.resolution, task);
    const Vector<Vec3d> sides = object_directions();
    Vector<Region> regions = split_region(surface.whole, out.initial_chart,
                                          uint32_t(sides.size()) + 1);
    report_unseen(surface, regions.back(), out);
    regions.pop_back();
    Vector<Frame> frames(sides.size());
    for (size_t i = 0; i < sides.size(); ++i)
        if (regions[i].size())
            frames[i] = make_frame(surface.mesh, regions[i].triangles, sides[i]);
    drop_empty(regions, frames);
    if (regions.empty())
        throw Error(GTX_ERROR_EMPTY, "no side of its box sees any of the model");
    out.complete = false;
    out.junk = surface.junk;
    out.pitch = texel_size(frames, surface.mesh, options);
    report_initial(surface, regions, task, out);
    out.report.initial_charts = number_labels(out.initial_chart);
    report_edges(surface, out);
    task.begin("frame");
    report_final(surface, regions, frames, task, out);
    out.charts = whole_charts(std::move(regions), frames, out);
    find_two_sided(surface.mesh, task, out);
}

static Partition partition_by(PartitionMethod method, const Mesh &mesh,
                              const ChartOptions &options, Task &task)
{
    task.begin("partition");
    uint32_t count = chart_count(mesh, options);
    const double pitch = expected_pitch(mesh, count);
    Surface surface = make_surface(mesh, pitch, task);
    Partition out;
    out.method = method;
    out.resolution = options.resolution;
    if (method == PartitionMethod::RELIEF) {
        make_relief_charts(surface, options, task, out);
        return out;
    }
    if (method == PartitionMethod::PGP) {
        CutMesh cut = square_cells(surface, count, options.adaptive, task);
        out.mesh = std::move(cut.mesh);
        out.source = std::move(cut.source);
        out.initial_chart = std::move(cut.label);
        make_charts(make_surface(out.mesh, pitch, task), options, count, task, out);
        return out;
    }
    out.initial_chart =
        method == PartitionMethod::VSA ? cluster(surface, surface.whole, count, task)
        : method == PartitionMethod::LAYERS
            ? peel(surface, peel_directions(surface), pitch, count, task)
            : agglomerate(surface, count, task);
    make_charts(std::move(surface), options, count, task, out);
    return out;
}

/* Texels of the patches, about. */
static double texels_of_patches(const Partition &partition, const ChartOptions &options)
{
    double sum = 0;
    for (const Chart &chart : partition.charts) {
        double texels = 1;
        for (int a = 0; a < 2; ++a) {
            const double cells = chart.cells[a] ? chart.cells[a]
                                                : chart.frame.extent[a] / partition.pitch;
            texels *= std::ceil((cells + RIM) / options.grain) * options.grain;
        }
        sum += texels * chart.finer * chart.finer;
    }
    return sum;
}

static Partition make_textured(PartitionMethod method, const Mesh &mesh,
                               const ChartOptions &options, Task &task)
{
    Partition out = partition_by(method, mesh, options, task);
    follow_textures(mesh, options, out, task);
    return out;
}

/* Whether it loses so much of its outlines that finer texels are worth it. */
static bool loses_outlines(const Mesh &mesh, const Partition &partition)
{
    Vec3d low = mesh.positions[0], high = low;
    for (const Vec3d &p : mesh.positions)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    const bool coarse = partition.pitch > COARSE * length(high - low);
    return partition.outline_loss() > (coarse ? LOST_OF_COARSE : MUCH_LOST);
}

/* Layers of texels that are so much finer as the bound on all of them allows; without charts if
 * none is. Texels go at most with the square of the resolution, so what they say of a finer one
 * spares those that must be too many, too. */
static Partition finer_layers(const Mesh &mesh, const ChartOptions &options, double cut_texels,
                              Task &task)
{
    const double room = double(task.limits.of(GTX_LIMITED_MEMORY)) / TEXEL_MEMORY;
    double most_finer = INFINITY;
    for (double finer : FINER) {
        if (finer > most_finer)
            continue;
        ChartOptions tried = options;
        tried.resolution = unsigned(finer * options.resolution);
        task.limits.work_again();
        Partition out = make_textured(PartitionMethod::LAYERS, mesh, tried, task);
        out.for_outlines = true;
        const double times = texels_of_patches(out, tried) /
                             std::min(std::max(MAX_TEXELS * cut_texels, FREE_TEXELS), room);
        if (times <= 1)
            return out;
        most_finer = finer / std::sqrt(times);
    }
    return {};
}

/* None, either, where they take more than is allowed: nobody asked for them. */
static Partition allowed_finer_layers(const Mesh &mesh, const ChartOptions &options,
                                      double cut_texels, Task &task)
{
    const size_t warnings = task.warnings.size();
    try {
        return finer_layers(mesh, options, cut_texels, task);
    } catch (const Error &error) {
        if (error.result != GTX_ERROR_LIMIT)
            throw;
    }
    task.warnings.resize(warnings);
    task.limits.work_again();
    return {};
}

Partition make_partition(const Mesh &mesh, const ChartOptions &options, Task &task)
{
    if (!mesh.triangle_count())
        throw Error(GTX_ERROR_EMPTY, "the mesh has no triangle to partition");
    if (mesh.triangle_count() > MAX_TRIANGLES)
        throw Error(GTX_ERROR_LIMIT, "the mesh has more than 300 million triangles");
    if (!chooses(options.method))
        return make_textured(options.method, mesh, options, task);
    Partition cuts = partition_by(PartitionMethod::CUTS, mesh, options, task);
    const double of_relief = texels_of_patches(cuts, options);
    follow_textures(mesh, options, cuts, task);
    if (options.free_resolution && loses_outlines(mesh, cuts)) {
        const double cut_texels = texels_of_patches(cuts, options);
        Partition layers = allowed_finer_layers(mesh, options, cut_texels, task);
        if (!layers.charts.empty())
            return layers;
    }
    if (options.method == PartitionMethod::DEFAULT)
        return cuts;
    Partition layers = partition_by(PartitionMethod::LAYERS, mesh, options, task);
    if (texels_of_patches(layers, options) >= WORTH_PEELING * of_relief)
        return cuts;
    follow_textures(mesh, options, layers, task);
    return layers;
}

} // namespace gtx
