/* One chart -> the maps of its patch (paper, section 5.3). */
#include "bake/field/shade.hpp"

#include "asset/fill.h"

#include <algorithm>

namespace gtx::baking {

static Crop crop_support(const Grid &grid, const Vector<uint8_t> &support, int grain)
{
    int low[2] = {grid.w, grid.h}, high[2] = {0, 0};
    for (int j = 0; j < grid.h; ++j) {
        for (int i = 0; i < grid.w; ++i) {
            if (!support[size_t(j) * grid.w + i])
                continue;
            low[0] = std::min(low[0], i);
            high[0] = std::max(high[0], i + 1);
            low[1] = std::min(low[1], j);
            high[1] = std::max(high[1], j + 1);
        }
    }
    auto round_up = [&](int size) { return (std::max(size, 2) + grain - 1) / grain * grain; };
    Crop crop;
    crop.w = round_up(high[0] - low[0]);
    crop.h = round_up(high[1] - low[1]);
    crop.x = low[0] - (crop.w - (high[0] - low[0])) / 2;
    crop.y = low[1] - (crop.h - (high[1] - low[1])) / 2;
    return crop;
}

static gtx_patch make_record(const Job &job, const Chart &chart, const Grid &grid, const Crop &crop,
                             double low, double high)
{
    gtx_patch record = {};
    const Frame &f = chart.frame;
    double a = grid.corner[0] + crop.x * grid.pitch[0], b = grid.corner[1] + crop.y * grid.pitch[1];
    store(record.origin, (grid.origin - job.anchor) + f.x * a + f.y * b + f.z * low);
    store(record.axis_x, f.x);
    store(record.axis_y, f.y);
    store(record.axis_z, f.z);
    double extent_x = crop.w * grid.pitch[0], extent_y = crop.h * grid.pitch[1];
    record.extent_x = float(extent_x);
    record.extent_y = float(extent_y);
    record.extent_z = float(std::max(high - low, std::max(extent_x, extent_y) / 4096));
    record.rect[2] = uint16_t(crop.w);
    record.rect[3] = uint16_t(crop.h);
    unsigned dilation = job.options.dilation;
    record.dilation = uint16_t(dilation ? dilation : 1u << (job.options.mips - 1));
    record.flags = chart.two_sided ? GTX_PATCH_TWO_SIDED : 0;
    record.source_triangles = uint32_t(chart.source_triangles);
    return record;
}

void measure_patch(unsigned height_bits, PatchMaps &maps)
{
    const gtx_code_map codes = {maps.height.data(), maps.record.rect[2], 2, height_bits};
    const gtx_patch_span span = gtx_measure_patch(&maps.record, &codes);
    maps.low = {span.low[0], span.low[1], span.low[2]};
    maps.high = {span.high[0], span.high[1], span.high[2]};
    maps.coded = span.coded;
}

void fill_trim(PatchMaps &maps)
{
    uint32_t w = maps.record.rect[2], h = maps.record.rect[3];
    Vector<uint8_t> ring(maps.height.size());
    for (size_t i = 0; i < ring.size(); ++i) {
        ring[i] = maps.height[i] != 0;
        if (!ring[i])
            maps.trim[i] = GTX_FAR_TRIM;
    }
    gtx_fill area = {maps.trim.data(), ring.data(), w, w, h};
    gtx_fill_trim(&area);
}

uint8_t trim_code(float distance)
{
    return gtx_nearest_trim(std::max(distance, DEEPEST_TRIM));
}

/* Trims and distances that are the same, in texels. */
constexpr float ROUNDING = 1e-3f;

/* `ending` is that of each edge of the outline. */
static void quantise(const ChartField &s, const Vector<Ending> &ending, const Crop &crop,
                     double low, unsigned height_bits, PatchMaps &maps)
{
    const Grid &grid = s.flat.grid;
    const double steps = gtx_height_steps(height_bits) / double(maps.record.extent_z);
    maps.height.assign(size_t(crop.w) * crop.h, 0);
    maps.trim.resize(maps.height.size());
    maps.ending.resize(maps.height.size());
    maps.room.assign(maps.height.size(), 0);
    for (int j = 0; j < crop.h; ++j) {
        for (int i = 0; i < crop.w; ++i) {
            int x = crop.x + i, y = crop.y + j;
            int near_x = std::clamp(x, 0, grid.w - 1), near_y = std::clamp(y, 0, grid.h - 1);
            size_t from = size_t(near_y) * grid.w + near_x, to = size_t(j) * crop.w + i;
            maps.trim[to] = trim_code(s.trim[from]);
            maps.ending[to] = ending[s.outline.nearest[from]];
            /* where overlap or a cut ends it before */
            const float to_all = s.cover.triangle[from] == NO_TRIANGLE ? s.outline.distance[from]
                                                                       : -s.outline.distance[from];
            if (maps.ending[to] == AT_CREASE && s.trim[from] > to_all + ROUNDING)
                maps.ending[to] = AT_CHART;
            if (x != near_x || y != near_y || !s.support[from])
                continue;
            maps.height[to] = uint16_t(
                gtx_nearest_code((s.cover.height[from] - low) * steps, height_bits));
            maps.room[to] = float(std::max(s.ceiling[from] - s.cover.height[from], 0.));
        }
    }
    fill_trim(maps);
}

/* Turns of a short loop, that take as long as what is done for a texel of the grid. */
constexpr size_t TEXEL_TURNS = 96;

static ChartField lay_field(const Job &job, FlatChart flat, Extractor *extractor)
{
    ChartField s;
    s.flat = std::move(flat);
    cancel_point(TEXEL_TURNS * s.flat.grid.texels());
    if (extractor)
        s.rendering = extractor->render(job.mesh, s.flat);
    Cover core = extractor ? core_of(s.flat, s.rendering) : raster_core(s.flat);
    Outline core_outline = find_outline(job.neighbours, s.flat, s.flat.core);
    s.cover = core;
    Paths paths(job.mesh, job.neighbours, s.flat);
    raster_overlap(s.flat, core_outline, paths, s.cover);
    s.outline = find_outline(job.neighbours, s.flat, s.flat.triangles.size());
    s.trim = trim_distances(s.flat, core, s.cover, core_outline, s.outline, job.sharp);
    if (job.needs.mask)
        trim_mask(job.mesh, job.neighbours, s.flat, s.trim);
    s.support = find_support(s.flat.grid, s.trim);
    extrapolate(paths, s);
    cut_discontinuities(core_outline, paths, s);
    return s;
}

static PatchMaps encode_field(const Job &job, const Chart &chart, const ChartField &s)
{
    PatchMaps maps;
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < s.support.size(); ++i) {
        if (s.support[i]) {
            low = std::min(low, s.cover.height[i]);
            high = std::max(high, s.cover.height[i]);
        }
    }
    if (low > high) /* a mask has left nothing */
        return maps;
    Crop crop = crop_support(s.flat.grid, s.support, 1 << (job.options.mips - 1));
    maps.record = make_record(job, chart, s.flat.grid, crop, low, high);
    const Vector<Ending> ending = find_endings(job, s, maps.creases);
    quantise(s, ending, crop, low, job.options.height_bits, maps);
    measure_patch(job.options.height_bits, maps);
    Shades shades = shade_texels(job, s, crop, maps.height);
    shade_walls(maps, job.options.height_bits, shades);
    build_mips(std::move(shades), job.options.mips, job.needs, maps);
    return maps;
}

/* A few cells less, or more, along a side that rounding to a multiple of `grain` would fill up with
 * empty texels. Planned cuts decide likewise in chart/cuts, before the outline is known: there less
 * than 3/8 of a grain goes, here up to 3 texels, which at 4 mip levels is one more. Truck: 3 % more
 * texels at half; 7 % fewer at double, for 9 % RMS. */
static bool refit(const ChartField &field, int grain, Chart &chart)
{
    constexpr int MAX_LESS = 3;
    const Crop crop = crop_support(field.flat.grid, field.support, 1);
    bool changed = false;
    for (int axis = 0; axis < 2; ++axis) {
        const int over = (axis ? crop.h : crop.w) % grain, cells = int(chart.cells[axis]);
        if (!over || cells <= grain)
            continue;
        chart.cells[axis] = unsigned(over <= MAX_LESS ? cells - over : cells + grain - over);
        changed = true;
    }
    return changed;
}

/* A height field with `finer` times as many cells along its sides, or so many that they fill
 * them. */
static ChartField lay_fitted(const Job &job, const Chart &chart, double finer)
{
    Extractor *extractor = job.options.extractor;
    FlatChart flat = flatten(job.mesh, job.neighbours, chart, job.pitch, finer);
    flat.of = job.charts;
    ChartField field = lay_field(job, std::move(flat), nullptr); /* cells do not depend on a
                                                                     driver */
    Chart fitted = chart;
    for (unsigned &cells : fitted.cells)
        cells = unsigned(std::ceil(cells * finer));
    const bool again = refit(field, 1 << (job.options.mips - 1), fitted);
    if (again)
        flatten_again(job.mesh, fitted, field.flat);
    return again || extractor ? lay_field(job, std::move(field.flat), extractor)
                              : std::move(field);
}

/* A chart whose relief is finer than the model's pitch gets a finer one. Measured on the truck:
 * ALLOWED at half a hole and 6 % more texels, at double 4 % fewer; FINER at double 83 % more. */
PatchMaps bake_chart(const Job &job, const Chart &chart)
{
    constexpr double ALLOWED = 0.01, FINER = 1.4;
    ChartField field = lay_fitted(job, chart, chart.finer);
    if (fit_heights(job, field) > ALLOWED && chart.finer < FINER) {
        field = lay_fitted(job, chart, FINER);
        fit_heights(job, field);
    }
    return encode_field(job, chart, field);
}

} // namespace gtx::baking
