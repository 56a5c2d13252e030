/* Times what `gtx bench` compares, and judges its pictures. */
#include "cli/bench/scene.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>

namespace gtx {

const char *const bench_method_names[BENCH_METHODS] = {
    "mesh", "mesh_stream", "simplified", "paper", "cast", "lod", "auto", "cast_depth", "auto_depth",
    "cast_fragment", "grid", "grid_depth", "floor",
    "cast_own", "lod_own", "auto_own", "grid_own", "paper_vulkan", "cast_vulkan", "lod_vulkan",
    "auto_vulkan", "cast_fragment_vulkan", "grid_vulkan"};

namespace {

constexpr double SLOW = 2000; /* milliseconds: a method that takes longer is measured once */

/* How the pictures of a method compare with the mesh's. */
struct Quality {
    uint64_t both = 0, either = 0, covered = 0, holes = 0;
    double square = 0; /* of differences of colour */
    TruthError truth;

    double iou() const { return either ? double(both) / double(either) : 1; }
    double psnr() const { return 10 * std::log10(255. * 255. * 3 * double(either) / square); }
};

/* What a method is held against, a picture a turn. */
struct Wanted {
    Vector<Picture> mesh;
    Vector<Truth> truth; /* none where it was not asked for */
};

class Bench {
public:
    Bench(const std::string &asset_path, const Mesh &mesh, const BenchOptions &options)
        : scene(asset_path, mesh, options), options_(options)
    {
    }
    void measure(const std::array<uint32_t, 2> &size, uint32_t instances,
                 const std::function<void(const BenchRow &)> &tell);

    BenchScene scene;

private:
    double time(BenchMethod method, const Shot &shot);
    Wanted wanted_of(Shot one);
    Quality judge(BenchMethod method, const Shot &one, const Wanted &wanted);
    void choose_error(const Shot &one, const Wanted &wanted);
    void choose_level(const Shot &one, const Wanted &wanted, const Quality &least);
    void judge_all(const std::array<uint32_t, 2> &size, uint32_t instances,
                   Vector<BenchRow> &rows);
    const char *reason_to_skip(const BenchRow &row) const;
    void time_all(Vector<BenchRow> &rows);

    const BenchOptions &options_;
    const double began_ = milliseconds();
    /* By height of the window and method: instances and milliseconds of the first frame. */
    std::map<std::pair<uint32_t, BenchMethod>, std::pair<uint32_t, double>> last_;
};

double Bench::time(BenchMethod method, const Shot &shot)
{
    const double start = milliseconds();
    scene.draw(method, shot);
    return milliseconds() - start;
}

void compare(const Picture &mesh, const Picture &picture, size_t width, Quality &quality)
{
    for (size_t p = 0; p < mesh.depth.size(); ++p) {
        const bool wanted = mesh.covers(p), covered = picture.covers(p);
        quality.both += wanted && covered;
        quality.either += wanted || covered;
        quality.covered += covered;
        quality.holes += !covered && is_inside(mesh, p, width);
        for (size_t k = 0; k < 3 && (wanted || covered); ++k)
            quality.square +=
                std::pow(double(mesh.color[4 * p + k]) - picture.color[4 * p + k], 2);
    }
}

Quality Bench::judge(BenchMethod method, const Shot &one, const Wanted &wanted)
{
    const Target target(scene.gl, one.width, one.height);
    Quality quality;
    for (int turn = 0; turn < BENCH_TURNS; ++turn) {
        const Picture picture =
            scene.picture(method, Shot{one.width, one.height, 1, turn}, target);
        compare(wanted.mesh[size_t(turn)], picture, one.width, quality);
        if (!wanted.truth.empty())
            quality.truth.add(wanted.truth[size_t(turn)], picture);
    }
    return quality;
}

/* The largest error at which AUTO's outline is as good as is asked for, or the least there is. */
void Bench::choose_error(const Shot &one, const Wanted &wanted)
{
    for (size_t i = std::size(bench_errors); i-- > 0;) {
        scene.max_error = bench_errors[i];
        if (judge(BenchMethod::AUTO, one, wanted).iou() >= options_.min_iou)
            break;
    }
}

/* The coarsest level that covers and looks as well. */
void Bench::choose_level(const Shot &one, const Wanted &wanted, const Quality &least)
{
    size_t good = 0, bad = scene.levels.indices.size(); /* quality falls from level to level */
    while (bad - good > 1) {
        scene.level = (good + bad) / 2;
        const Quality q = judge(BenchMethod::MESH_LOD, one, wanted);
        (q.iou() >= least.iou() && q.psnr() >= least.psnr() ? good : bad) = scene.level;
    }
    scene.level = good;
}

Wanted Bench::wanted_of(Shot one)
{
    Wanted out;
    const Target target(scene.gl, one.width, one.height);
    for (one.turn = 0; one.turn < BENCH_TURNS; ++one.turn) {
        out.mesh.push_back(scene.picture(BenchMethod::MESH, one, target));
        if (options_.truth)
            out.truth.push_back(scene.truth(one, target));
    }
    return out;
}

/* Judges every method by one instance at its share of the window; it warms up, too. */
void Bench::judge_all(const std::array<uint32_t, 2> &size, uint32_t instances,
                      Vector<BenchRow> &rows)
{
    const uint32_t columns = uint32_t(std::ceil(std::sqrt(instances)));
    const Shot one = {std::max(1u, size[0] / columns), std::max(1u, size[1] / columns), 1, 0};
    const Wanted wanted = wanted_of(one);
    if (options_.min_iou > 0)
        choose_error(one, wanted);
    for (BenchRow &row : rows) {
        row.max_error = is_mesh(row.method) ? 0 : scene.max_error;
        if (row.method == BenchMethod::MESH_LOD)
            choose_level(one, wanted, judge(BenchMethod::AUTO, one, wanted));
        const Quality q = judge(row.method, one, wanted);
        row.iou = q.iou();
        row.psnr = is_depth_pass(row.method) ? NAN : q.psnr();
        row.pixels = q.covered / BENCH_TURNS;
        row.holes = q.holes;
        row.truth = q.truth;
        row.triangles = scene.triangles(row.method);
        const Target target(scene.gl, one.width, one.height);
        scene.count(row.method, one, row.rays, row.hits);
        row.rays /= BENCH_TURNS;
        row.hits /= BENCH_TURNS;
    }
}

/* Ten times the instances of a mesh take ten times as long. */
const char *Bench::reason_to_skip(const BenchRow &row) const
{
    const BenchMethod method = without_vulkan(row.method);
    if ((method == BenchMethod::LOD || method == BenchMethod::LOD_OWN) && !scene.info.lod_levels)
        return "the asset has no LOD mesh";
    const double left = 1000 * options_.budget - (milliseconds() - began_);
    const auto last = last_.find({row.size[1], row.method});
    double expected = 0;
    if (last != last_.end() && is_mesh(row.method))
        expected = last->second.second * row.instances / last->second.first;
    return left < expected ? "past the budget" : nullptr;
}

/* Times at each azimuth. */
using Turns = std::array<Vector<double>, BENCH_TURNS>;

/* The median at each azimuth, averaged over those that have any: from one to the next times may
 * differ twofold, and one median of all would take those of either kind by chance. */
double mean_median(Turns turns)
{
    double sum = 0;
    int count = 0;
    for (Vector<double> &times : turns)
        if (!times.empty()) {
            const size_t n = times.size();
            std::sort(times.begin(), times.end());
            sum += 0.5 * (times[(n - 1) / 2] + times[n / 2]);
            ++count;
        }
    return sum / count;
}

double least(const Turns &turns)
{
    double out = INFINITY;
    for (const Vector<double> &times : turns)
        for (double time : times)
            out = std::min(out, time);
    return out;
}

void Bench::time_all(Vector<BenchRow> &rows)
{
    struct Times {
        BenchRow *row;
        Turns wall, work;
    };
    Vector<Times> quick;
    for (BenchRow &row : rows) {
        const Shot shot = {row.size[0], row.size[1], row.instances, 0};
        if (row.skipped)
            continue;
        const std::clock_t work = std::clock();
        row.median = row.least = time(row.method, shot);
        row.work = 1e3 * double(std::clock() - work) / CLOCKS_PER_SEC;
        row.frames = 1;
        last_[{row.size[1], row.method}] = {row.instances, row.median};
        if (row.median <= SLOW)
            quick.push_back({&row, {}, {}});
    }
    for (uint32_t frame = 0; frame < options_.frames; ++frame)
        for (Times &t : quick) {
            const BenchRow &row = *t.row;
            const int turn = int(frame) % BENCH_TURNS;
            const std::clock_t work = std::clock();
            t.wall[turn].push_back(
                time(row.method, {row.size[0], row.size[1], row.instances, turn}));
            t.work[turn].push_back(1e3 * double(std::clock() - work) / CLOCKS_PER_SEC);
        }
    for (Times &t : quick) {
        t.row->frames = options_.frames;
        t.row->median = mean_median(t.wall);
        t.row->least = least(t.wall);
        t.row->work = mean_median(t.work);
    }
}

void Bench::measure(const std::array<uint32_t, 2> &size, uint32_t instances,
                    const std::function<void(const BenchRow &)> &tell)
{
    Vector<BenchRow> rows;
    for (BenchMethod method : options_.methods) {
        rows.emplace_back();
        rows.back().size = size;
        rows.back().instances = instances;
        rows.back().method = method;
        rows.back().skipped = reason_to_skip(rows.back());
    }
    Vector<BenchRow> judged, skipped;
    for (BenchRow &row : rows)
        (row.skipped ? skipped : judged).push_back(row);
    if (!judged.empty()) {
        judge_all(size, instances, judged);
        const Target target(scene.gl, size[0], size[1]);
        time_all(judged);
    }
    for (const Vector<BenchRow> *part : {&judged, &skipped})
        for (const BenchRow &row : *part)
            tell(row);
}

} // namespace

void run_bench(const std::string &asset_path, const Mesh &mesh, const BenchOptions &options,
               const std::function<void(const BenchSetup &)> &begin,
               const std::function<void(const BenchRow &)> &tell)
{
    Bench bench(asset_path, mesh, options);
    begin(bench.scene.setup);
    for (uint32_t instances : options.instances)
        for (const std::array<uint32_t, 2> &size : options.sizes)
            bench.measure(size, instances, tell);
}

} // namespace gtx
