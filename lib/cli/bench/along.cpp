/* Measures frame times along a path. */
#include "cli/bench/along.hpp"

#include "cli/bench/scene.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace gtx {

constexpr double SLOW = 2000; /* milliseconds: a method that takes longer is measured once */

namespace {

class Along {
public:
    Along(BenchScene &scene, const ViewPath &path, const BenchOptions &options)
        : scene_(scene), path_(path), options_(options)
    {
    }
    PathReport measure(const std::array<uint32_t, 2> &size);

private:
    void judge(Vector<PathCell> &cells, const gtx_view &view, const Target &target);
    void time(PathCell &cell, BenchMethod method, const gtx_view &view);
    Vector<PathCell> measure_view(const gtx_view &view, const Target &target);
    bool is_wanted(BenchMethod method) const;
    bool is_past_budget() const;

    BenchScene &scene_;
    const ViewPath &path_;
    const BenchOptions &options_;
    Vector<BenchMethod> methods_;
    const double began_ = milliseconds();
};

void compare(const Picture &truth, const Picture &picture, size_t width, PathCell &cell)
{
    uint64_t both = 0, either = 0;
    for (size_t p = 0; p < truth.depth.size(); ++p) {
        both += truth.covers(p) && picture.covers(p);
        either += truth.covers(p) || picture.covers(p);
        cell.pixels += picture.covers(p);
        cell.holes += !picture.covers(p) && is_inside(truth, p, width);
    }
    cell.iou = either ? double(both) / double(either) : 1;
    cell.enclosed = enclosed_holes(truth, picture, width);
    cell.outline = outline_error(truth, picture, width);
}

/* Draws every method once; it warms up, too. */
void Along::judge(Vector<PathCell> &cells, const gtx_view &view, const Target &target)
{
    const Picture mesh = scene_.picture(BenchMethod::MESH, view, target);
    const Truth truth = options_.truth ? scene_.truth(view, target) : Truth();
    const bool floor = std::count(methods_.begin(), methods_.end(), BenchMethod::FLOOR) > 0;
    if (floor)
        scene_.set_floor(scene_.picture(BenchMethod::AUTO, view, target), view);
    for (size_t m = 0; m < methods_.size(); ++m) {
        if (methods_[m] == BenchMethod::MESH_LOD)
            scene_.level = coarsest_level(scene_.parts, view, options_.max_error);
        const Picture picture = scene_.picture(methods_[m], view, target);
        compare(mesh, picture, view.viewport_width, cells[m]);
        if (options_.truth)
            cells[m].truth.add(truth, picture);
        cells[m].triangles = scene_.triangles(methods_[m]);
    }
}

void Along::time(PathCell &cell, BenchMethod method, const gtx_view &view)
{
    const std::clock_t work = std::clock();
    const double start = milliseconds();
    scene_.draw(method, view);
    const double ms = milliseconds() - start;
    const double used = 1e3 * double(std::clock() - work) / CLOCKS_PER_SEC;
    cell.ms = cell.ms > 0 ? std::min(cell.ms, ms) : ms;
    cell.work = cell.work > 0 ? std::min(cell.work, used) : used;
}

Vector<PathCell> Along::measure_view(const gtx_view &view, const Target &target)
{
    Vector<PathCell> cells(methods_.size());
    judge(cells, view, target);
    for (uint32_t r = 0; r < options_.repeats; ++r)
        for (size_t m = 0; m < methods_.size(); ++m)
            if (cells[m].ms <= SLOW)
                time(cells[m], methods_[m], view);
    return cells;
}

bool Along::is_wanted(BenchMethod method) const
{
    return method != BenchMethod::LOD || scene_.info.lod_levels;
}

bool Along::is_past_budget() const
{
    return milliseconds() - began_ > 1000 * options_.budget;
}

double median(Vector<double> values)
{
    const size_t n = values.size();
    std::sort(values.begin(), values.end());
    return n ? 0.5 * (values[(n - 1) / 2] + values[n / 2]) : 0;
}

PathRow sum_up(BenchMethod method, const Vector<PathCell> &cells, const Vector<PathCell> *mesh)
{
    PathRow row;
    row.method = method;
    constexpr double MIN_TIME = 1e-3; /* milliseconds: the clock's own step */
    Vector<double> times, works, ratios, work_ratios;
    for (size_t v = 0; v < cells.size(); ++v) {
        times.push_back(cells[v].ms);
        works.push_back(cells[v].work);
        row.mean += cells[v].ms / double(cells.size());
        ratios.push_back(mesh ? cells[v].ms / (*mesh)[v].ms : 0);
        work_ratios.push_back(mesh ? cells[v].work / std::max(MIN_TIME, (*mesh)[v].work) : 0);
        row.work_worst = std::max(row.work_worst, work_ratios.back());
        row.order.push_back(v);
        row.iou = std::min(row.iou, cells[v].iou);
        row.holes = std::max(row.holes, cells[v].holes);
        row.enclosed = std::max(row.enclosed, cells[v].enclosed);
        row.outline = std::max(row.outline, cells[v].outline);
        row.truth.add(cells[v].truth);
    }
    row.median = median(times);
    row.work = median(works);
    row.ratio = median(ratios);
    row.work_ratio = median(work_ratios);
    std::stable_sort(row.order.begin(), row.order.end(),
                     [&](size_t a, size_t b) { return ratios[a] > ratios[b]; });
    row.worst = ratios.empty() ? 0 : ratios[row.order[0]];
    return row;
}

PathReport Along::measure(const std::array<uint32_t, 2> &size)
{
    PathReport report = {size, &path_, 0, {}, {}};
    methods_.clear();
    for (BenchMethod method : options_.methods)
        if (is_wanted(method))
            methods_.push_back(method);
    report.cells.resize(methods_.size());
    const Target target(scene_.gl, size[0], size[1]);
    for (size_t v = 0; v < path_.views.size() && !is_past_budget(); ++v) {
        const gtx_view view = scene_.view_of(path_, v, size[0], size[1]);
        const Vector<PathCell> cells = measure_view(view, target);
        for (size_t m = 0; m < cells.size(); ++m)
            report.cells[m].push_back(cells[m]);
        ++report.measured;
    }
    const auto mesh = std::find(methods_.begin(), methods_.end(), BenchMethod::MESH);
    for (size_t m = 0; m < methods_.size(); ++m)
        report.rows.push_back(sum_up(
            methods_[m], report.cells[m],
            mesh == methods_.end() ? nullptr : &report.cells[size_t(mesh - methods_.begin())]));
    return report;
}

} // namespace

void run_path(const std::string &asset_path, const Mesh &mesh, const ViewPath &path,
              const BenchOptions &options,
              const std::function<void(const BenchSetup &)> &begin,
              const std::function<void(const PathReport &)> &tell)
{
    BenchScene scene(asset_path, mesh, options);
    begin(scene.setup);
    Along along(scene, path, options);
    for (const std::array<uint32_t, 2> &size : options.sizes)
        tell(along.measure(size));
}

} // namespace gtx
