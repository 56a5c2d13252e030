/* Holes, walls, leaks, silhouettes, depth and shading of assets against their source. */
#include "measure/distribution.hpp"
#include "measure/figures.hpp"

#include <algorithm>
#include <mutex>

namespace gtx {

/* Pixels that the runtime's levels may be off, and how many sizes of images are looked at. */
static const double DETAIL_PIXELS = 0.5;
static const uint32_t DETAIL_SIZES = 5, MIN_SIZE = 16;

/* The figures of level 0 that are means and distributions: figures[view]. */
static void summarise(const Vector<Figures> &figures, const Distribution &depths,
                      const Distribution &angles, CompareReport &report)
{
    double depth_square = 0, angle_sum = 0, color_square = 0, pixels = 0;
    for (const Figures &f : figures) {
        report.turned_pixels += f.turned;
        depth_square += f.depth_square;
        angle_sum += f.angle_sum;
        color_square += f.color_square;
        pixels += double(f.either);
    }
    const double count = double(std::max<uint64_t>(depths.count(), 1));
    report.depth_rms = std::sqrt(depth_square / count);
    report.depth_p99 = depths.percentile_99();
    report.depth_max = depths.most();
    report.normal_mean_deg = angle_sum / double(std::max<uint64_t>(angles.count(), 1));
    report.normal_p99_deg = angles.percentile_99();
    report.psnr_db = 10 * std::log10(255. * 255. * 3 * pixels / color_square);
}

/* Adds what a view lists, and keeps but its sums. */
static void gather(Figures &figures, Distribution &depths, Distribution &angles)
{
    for (float depth : figures.depth)
        figures.depth_square += double(depth) * double(depth);
    for (float angle : figures.angle)
        figures.angle_sum += double(angle);
    depths.add(figures.depth);
    angles.add(figures.angle);
    Vector<float>().swap(figures.depth);
    Vector<float>().swap(figures.angle);
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
        sum.wall_pixels += f.walls;
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
static Vector<Scene> make_scenes(const ShownAt &shown, const Extent &extent,
                                 const CompareOptions &options)
{
    Vector<Scene> scenes;
    auto views_of = [&](uint32_t size) {
        Vector<View> all = comparison_views(extent, size, options.random_views, options.seed);
        for (View &view : all)
            view.culls = options.cut;
        return all;
    };
    Vector<View> views = views_of(options.size);
    const Assets finest = shown(0);
    for (uint32_t level = 0; level < options.levels; ++level)
        scenes.push_back({views, AssetView(finest, level), level, level == 0,
                          options.faults != nullptr});
    const uint32_t sizes = options.details ? DETAIL_SIZES : 0;
    for (uint32_t k = 0; k < sizes && options.size >> k >= MIN_SIZE; ++k) {
        views = views_of(options.size >> k);
        const double pixel = views[0].pixel;
        scenes.push_back({views, AssetView(shown(pixel), 0, DETAIL_PIXELS * pixel),
                          CHOSEN_LEVELS, false, options.faults != nullptr});
    }
    return scenes;
}

/* Adds what was measured of one scene to the report. */
static void report_scene(const Scene &scene, const Vector<Figures> &figures, bool is_level,
                         Distribution &depths, Distribution &angles, CompareReport &report)
{
    if (!is_level) {
        DetailReport detail;
        detail.size = scene.views[0].size;
        add_up(figures, detail, detail.surface_pixels);
        report.details.push_back(detail);
        return;
    }
    LevelReport level;
    uint64_t surface = 0;
    level.level = scene.level;
    const double least = add_up(figures, level, surface);
    report.levels.push_back(level);
    if (!scene.appearance)
        return;
    report.surface_pixels = surface;
    report.hole_pixels = level.hole_pixels;
    report.wall_pixels = level.wall_pixels;
    report.leak_pixels = level.leak_pixels;
    report.silhouette_iou = level.silhouette_iou;
    report.silhouette_iou_min = least;
    summarise(figures, depths, angles, report);
}

CompareReport compare(const gtx_asset *asset, const Mesh &mesh, const CompareOptions &options,
                      Task &task)
{
    return compare([asset](double) { return Assets{asset}; }, mesh, options, task);
}

CompareReport compare(const ShownAt &shown, const Mesh &mesh, const CompareOptions &options,
                      Task &task)
{
    const Comparison all = {mesh, extent_of(mesh)};
    if (!(all.extent.radius > 0))
        throw Error(GTX_ERROR_EMPTY, "the source has no extent to measure against");
    const Vector<Scene> scenes = make_scenes(shown, all.extent, options);
    const size_t views = scenes[0].views.size();
    Vector<Vector<Figures>> figures(scenes.size(), Vector<Figures>(views));
    Distribution depths, angles;
    std::mutex gathering;
    task.parallel(views, [&](size_t v) {
        MeshImage image;
        uint32_t size = 0;
        for (size_t s = 0; s < scenes.size(); ++s) {
            const View &view = scenes[s].views[v];
            if (view.size != size)
                image = rasterise(mesh, view);
            size = view.size;
            measure_view(all, scenes[s], uint32_t(v), image, figures[s][v]);
            if (!scenes[s].appearance)
                continue;
            const std::lock_guard<std::mutex> lock(gathering);
            gather(figures[s][v], depths, angles);
        }
    }, 0, options.surface ? 0.8 : 1);

    CompareReport report;
    report.views = uint32_t(views);
    for (size_t s = 0; s < scenes.size(); ++s) {
        for (const Figures &f : figures[s])
            if (options.faults)
                options.faults->insert(options.faults->end(), f.faults.begin(), f.faults.end());
        report_scene(scenes[s], figures[s], s < options.levels, depths, angles, report);
    }
    if (options.surface) {
        report.error = surface_error(shown(0), mesh, {}, task);
        report.seams = measure_seams(shown(0), mesh, task);
    }
    return report;
}

} // namespace gtx
