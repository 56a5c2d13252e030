/* Holes, leaks, silhouettes, depth and shading of an asset against its source, view by view. */
#include "measure/cast.hpp"
#include "measure/measure.hpp"
#include "measure/sample.hpp"

#include <algorithm>

namespace gtx {

/* Tolerances: pixels, height steps and fractions of the diagonal. */
static const double HOLE_PIXELS = 2, HOLE_STEPS = 4, HOLE_DIAGONAL = 0.001, FLAT_DIAGONAL = 0.01;
/* Pixels that the runtime's levels may be off, and how many sizes of images are looked at. */
static const double DETAIL_PIXELS = 0.5;
static const uint32_t DETAIL_SIZES = 5, MIN_SIZE = 16;

namespace {

/* Of one view at one level. Sums are made within a view and added up in the order of the views, so
 * that they do not depend on the threads. */
struct Figures {
    uint64_t surface = 0, holes = 0, leaks = 0, both = 0, either = 0;
    /* At level 0 only. */
    Vector<float> depth, angle;
    double color_square = 0;
    Vector<HoleSample> samples;
};

/* Views of one size, and the asset as it is looked at there. */
struct Scene {
    Vector<View> views;
    AssetView asset;
    uint32_t level = 0;
    bool appearance = false;      /* all figures, not holes and silhouettes alone */
    bool samples = false;         /* holes are listed, too */
};

/* What all views share. */
struct Comparison {
    const Mesh &mesh;
    Extent extent;
};

/* The source around a pixel: whether all nine are seen from the front, and their depths. */
struct Around {
    bool surface = false;
    float nearest = 0, deepest = 0;
};

/* A pixel whose nine all show the source, while the asset is deeper there by more than it may. */
struct Suspect {
    uint32_t i, j;
    gtx_hit hit;
    float deepest;
    double tolerance;
};

/* One view at one level while it is measured. */
struct Look {
    const Comparison &all;
    const Scene &scene;
    uint32_t view_index;
    const View &view;
    const MeshImage &image;
    const AssetView &asset;
    Figures &out;
    Vector<Suspect> suspects = {};

    void pixel(uint32_t i, uint32_t j, const gtx_hit &hit);
    void holes();
    void hole(const Suspect &suspect);
    void appearance(uint32_t i, uint32_t j, const gtx_hit &hit, bool depths_agree);
    void leaks(const Vector<Crossing> &crossings);
};

} // namespace

static Around look_around(const MeshImage &image, uint32_t size, uint32_t i, uint32_t j)
{
    Around around;
    if (i == 0 || j == 0 || i + 1 >= size || j + 1 >= size)
        return around;
    around.nearest = std::numeric_limits<float>::infinity();
    for (uint32_t b = j - 1; b <= j + 1; ++b)
        for (uint32_t a = i - 1; a <= i + 1; ++a) {
            size_t at = size_t(b) * size + a;
            if (!image.front[at])
                return around;
            around.nearest = std::min(around.nearest, image.depth[at]);
            around.deepest = std::max(around.deepest, image.depth[at]);
        }
    around.surface = true;
    return around;
}

/* Headlight Lambert, in 8-bit sRGB. */
static void shade(const Fragment &fragment, const Vec3d &toward, double out[3])
{
    double light = 0.2 + 0.8 * std::max(0., dot(fragment.normal, toward));
    for (int k = 0; k < 3; ++k)
        out[k] = std::round(std::clamp(fragment.color[k] * light, 0., 255.));
}

/* Sum of squared differences of the two images, black where nothing is. */
static double color_difference(const Fragment *source, const Fragment *asset, const Vec3d &toward)
{
    double a[3] = {0, 0, 0}, b[3] = {0, 0, 0}, sum = 0;
    if (source)
        shade(*source, toward, a);
    if (asset)
        shade(*asset, toward, b);
    for (int k = 0; k < 3; ++k)
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

static double degrees_between(const Vec3d &a, const Vec3d &b)
{
    return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / 3.14159265358979323846;
}

void Look::hole(const Suspect &s)
{
    ++out.holes;
    if (!scene.samples)
        return;
    size_t at = size_t(s.j) * view.size + s.i;
    out.samples.push_back({scene.level, view.size, view_index, s.i, s.j, image.triangle[at],
                           s.hit.patch, double(s.hit.t) - s.deepest,
                           view.at(s.i, s.j) - view.toward * double(image.depth[at])});
}

/* Whether the source, too, shows something as deep: past an outline that runs between the centres
 * of pixels, where no more than that has moved. */
static bool shows_as_deep(const MeshImage &close, const Suspect &s)
{
    for (size_t at = 0; at < close.depth.size(); ++at)
        if (!close.front[at] || s.hit.t - close.depth[at] <= s.tolerance)
            return true;
    return false;
}

/* Suspects are looked at more closely, so many at a time that their images take little room. */
void Look::holes()
{
    constexpr size_t AT_ONCE = 4096;
    for (size_t first = 0; first < suspects.size(); first += AT_ONCE) {
        const size_t end = std::min(first + AT_ONCE, suspects.size());
        Vector<std::array<uint32_t, 2>> pixels;
        for (size_t k = first; k < end; ++k)
            pixels.push_back({suspects[k].i, suspects[k].j});
        const Vector<MeshImage> close = rasterise_close(all.mesh, view, pixels);
        for (size_t k = first; k < end; ++k)
            if (!shows_as_deep(close[k - first], suspects[k]))
                hole(suspects[k]);
    }
}

void Look::appearance(uint32_t i, uint32_t j, const gtx_hit &hit, bool depths_agree)
{
    bool in_source = image.triangle[size_t(j) * view.size + i] != NO_HIT;
    bool in_asset = hit.patch != NO_HIT;
    Fragment source = {}, seen = {};
    if (in_source)
        source = fragment_at(all.mesh, view, image, i, j);
    if (in_asset)
        seen = asset.fragment(hit);
    out.color_square += color_difference(in_source ? &source : nullptr, in_asset ? &seen : nullptr,
                                         view.toward);
    if (depths_agree)
        out.angle.push_back(float(degrees_between(source.normal, seen.normal)));
}

void Look::pixel(uint32_t i, uint32_t j, const gtx_hit &hit)
{
    const size_t at = size_t(j) * view.size + i;
    const bool in_source = image.triangle[at] != NO_HIT, in_asset = hit.patch != NO_HIT;
    out.both += in_source && in_asset;
    out.either += in_source || in_asset;
    if (!in_source && !in_asset)
        return;

    const double diagonal = all.extent.diagonal;
    double tolerance = std::max(HOLE_PIXELS * view.pixel, HOLE_DIAGONAL * diagonal);
    if (in_asset)
        tolerance = std::max(tolerance, HOLE_STEPS * asset.height_step(hit.patch));
    const double error = double(hit.t) - image.depth[at]; /* meaningless unless in both */
    const Around around = look_around(image, view.size, i, j);
    if (around.surface) {
        ++out.surface;
        if (!in_asset || hit.t - around.deepest > tolerance)
            suspects.push_back({i, j, hit, around.deepest, tolerance});
    }
    if (!scene.appearance)
        return;
    if (around.surface && in_asset && around.deepest - around.nearest < FLAT_DIAGONAL * diagonal)
        out.depth.push_back(float(std::abs(error) / diagonal));
    appearance(i, j, hit, in_source && in_asset && std::abs(error) <= tolerance);
}

/* A leak counts where its 3x3 is covered. */
void Look::leaks(const Vector<Crossing> &crossings)
{
    const uint32_t size = view.size;
    for (uint32_t j = 1; j + 1 < size; ++j)
        for (uint32_t i = 1; i + 1 < size; ++i) {
            if (crossings[size_t(j) * size + i] != Crossing::leak)
                continue;
            bool covered = true;
            for (uint32_t b = j - 1; b <= j + 1; ++b)
                for (uint32_t a = i - 1; a <= i + 1; ++a)
                    covered &= crossings[size_t(b) * size + a] != Crossing::none;
            out.leaks += covered;
        }
}

static void measure_view(const Comparison &all, const Scene &scene, uint32_t view_index,
                         const MeshImage &image, Figures &out)
{
    const View &view = scene.views[view_index];
    Look look = {all, scene, view_index, view, image, scene.asset, out};
    Vector<gtx_hit> hits;
    Vector<Crossing> row, crossings;
    crossings.reserve(size_t(view.size) * view.size);
    for (uint32_t j = 0; j < view.size; ++j) {
        cancel_point();
        look.asset.cast_row(view, j, hits, row);
        crossings.insert(crossings.end(), row.begin(), row.end());
        for (uint32_t i = 0; i < view.size; ++i)
            look.pixel(i, j, hits[i]);
    }
    look.holes();
    look.leaks(crossings);
}

/* The figures of level 0 that come from lists: figures[view]. */
static void summarise(const Vector<Figures> &figures, CompareReport &report)
{
    Vector<float> depth, angle;
    double depth_square = 0, angle_sum = 0, color_square = 0, pixels = 0;
    for (const Figures &f : figures) {
        depth.insert(depth.end(), f.depth.begin(), f.depth.end());
        angle.insert(angle.end(), f.angle.begin(), f.angle.end());
        color_square += f.color_square;
        pixels += double(f.either);
    }
    for (float d : depth) {
        depth_square += double(d) * d;
        report.depth_max = std::max(report.depth_max, double(d));
    }
    for (float a : angle)
        angle_sum += a;
    report.depth_rms = depth.empty() ? 0 : std::sqrt(depth_square / double(depth.size()));
    report.depth_p99 = percentile_99(depth);
    report.normal_mean_deg = angle.empty() ? 0 : angle_sum / double(angle.size());
    report.normal_p99_deg = percentile_99(angle);
    report.psnr_db = 10 * std::log10(255. * 255. * 3 * pixels / color_square);
}

/* The figures that are sums; returns the least silhouette IoU of a view. */
template <class Report>
static double add_up(const Vector<Figures> &figures, Report &sum, uint64_t &surface)
{
    uint64_t both = 0, either = 0;
    double least = 1;
    for (const Figures &f : figures) {
        surface += f.surface;
        sum.hole_pixels += f.holes;
        sum.leak_pixels += f.leaks;
        both += f.both;
        either += f.either;
        if (f.either)
            least = std::min(least, double(f.both) / double(f.either));
    }
    sum.silhouette_iou = either ? double(both) / double(either) : 1;
    return least;
}

/* Every level at the size asked for, then what the runtime would draw, at ever smaller sizes. */
static Vector<Scene> make_scenes(const gtx_asset *asset, const Extent &extent,
                                 const CompareOptions &options)
{
    Vector<Scene> scenes;
    Vector<View> views = comparison_views(extent, options.size);
    for (uint32_t level = 0; level < options.levels; ++level)
        scenes.push_back({views, AssetView(asset, level), level, level == 0,
                          options.holes != nullptr});
    for (uint32_t k = 0; k < DETAIL_SIZES && options.size >> k >= MIN_SIZE; ++k) {
        views = comparison_views(extent, options.size >> k);
        scenes.push_back({views, AssetView(asset, 0, DETAIL_PIXELS * views[0].pixel),
                          CHOSEN_LEVELS, false, options.holes != nullptr});
    }
    return scenes;
}

CompareReport compare(const gtx_asset *asset, const Mesh &mesh, const CompareOptions &options,
                      Task &task)
{
    const Comparison all = {mesh, extent_of(mesh)};
    if (!(all.extent.radius > 0))
        throw Error(GTX_ERROR_EMPTY, "the source has no extent to measure against");
    const Vector<Scene> scenes = make_scenes(asset, all.extent, options);
    const size_t views = scenes[0].views.size();
    Vector<Vector<Figures>> figures(scenes.size(), Vector<Figures>(views));
    task.parallel(views, [&](size_t v) {
        MeshImage image;
        uint32_t size = 0;
        for (size_t s = 0; s < scenes.size(); ++s) {
            const View &view = scenes[s].views[v];
            if (view.size != size)
                image = rasterise(mesh, view);
            size = view.size;
            measure_view(all, scenes[s], uint32_t(v), image, figures[s][v]);
        }
    }, 0, options.surface ? 0.8 : 1);

    CompareReport report;
    report.views = uint32_t(views);
    for (size_t s = 0; s < scenes.size(); ++s) {
        for (const Figures &f : figures[s])
            if (options.holes)
                options.holes->insert(options.holes->end(), f.samples.begin(), f.samples.end());
        if (s >= options.levels) {
            DetailReport detail;
            detail.size = scenes[s].views[0].size;
            add_up(figures[s], detail, detail.surface_pixels);
            report.details.push_back(detail);
            continue;
        }
        LevelReport level;
        uint64_t surface = 0;
        level.level = scenes[s].level;
        double least = add_up(figures[s], level, surface);
        report.levels.push_back(level);
        if (scenes[s].appearance) {
            report.surface_pixels = surface;
            report.hole_pixels = level.hole_pixels;
            report.leak_pixels = level.leak_pixels;
            report.silhouette_iou = level.silhouette_iou;
            report.silhouette_iou_min = least;
            summarise(figures[s], report);
        }
    }
    if (options.surface) {
        report.error = surface_error(asset, mesh, {}, task);
        report.seams = measure_seams(asset, mesh, task);
    }
    return report;
}

} // namespace gtx
