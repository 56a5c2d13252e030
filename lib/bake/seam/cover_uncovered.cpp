/* Lets what no height field shows be shown: by one whose trim ends too early, or by a chart of its
 * own.
 *
 * A chart misses surface of its own where a cell would bridge two height fields, and where a wall
 * leans back from its axis that is too small to be split off. Whoever looks there from the side
 * sees through. What is in no height field, nor hidden in one a little beyond its outline, gets
 * patches of its own, with as much around it as their borders need. */
#include "bake/seam/seam.hpp"
#include "bake/seam/uncovered.hpp"
#include "chart/frame.hpp"

#include <algorithm>
#include <unordered_set>

namespace gtx::baking {

/* Square texels of surface that are worth a patch: less is hardly a pixel. Spot's control mesh: 2 %
 * fewer patches at double. */
constexpr double MIN_AREA = 0.05;
/* And of a component of the source that fits one patch: a smaller one is dust. A tile of
 * cesium_143_draco has 30 hole pixels for 2 where all of these are. Engine, dragon and
 * Nefertiti: not a byte at half and at double. */
constexpr double DUST = 1;
/* Texels of surface around it that its patch shows too, and how far the normals of one patch may
 * differ; below 1 % at half and at double. */
constexpr double RING = 1.25, MIN_COSINE = 0.5;
/* Patches that are added at most, for each that there is: a limit. At a sixth, what is hidden uses
 * it up before what is seen: 583 hole pixels on a tile of thin walls, and one at this. */
constexpr size_t MAX_ADDED = 1;

namespace {

/* Gathers uncovered triangles that lie together into charts. */
class Gatherer {
public:
    Gatherer(const Job &job, const Partition &partition, const Vector<Uncovered> &uncovered)
        : job_(job), partition_(partition), uncovered_(uncovered), taken_(uncovered.size(), 0)
    {
    }

    /* From this one on; the uncovered area of the chart, none where that is all of its component,
     * and dust. */
    Chart gather(size_t first, double &area);
    bool taken(size_t i) const { return taken_[i]; }

private:
    size_t find(uint32_t triangle) const
    {
        auto at = std::lower_bound(uncovered_.begin(), uncovered_.end(), triangle,
                                   [](const Uncovered &a, uint32_t b) { return a.triangle < b; });
        return at != uncovered_.end() && at->triangle == triangle
                   ? size_t(at - uncovered_.begin())
                   : uncovered_.size();
    }
    Vec3d centre(uint32_t t) const
    {
        const Mesh &mesh = job_.mesh;
        return (mesh.position(t, 0) + mesh.position(t, 1) + mesh.position(t, 2)) / 3;
    }

    const Job &job_;
    const Partition &partition_;
    const Vector<Uncovered> &uncovered_;
    Vector<uint8_t> taken_;
};

Chart Gatherer::gather(size_t first, double &area)
{
    struct Reached {
        uint32_t triangle;
        Vec3d from;              /* the uncovered surface it was reached from */
    };
    const uint32_t seed = uncovered_[first].triangle;
    const Vec3d axis = normalize(job_.mesh.area_vector(seed));
    Vector<Reached> queue = {{seed, centre(seed)}};
    std::unordered_set<uint32_t> seen = {seed};
    Chart chart;
    Vec3d sum;
    area = 0;
    bool goes_on = false;
    for (size_t next = 0; next < queue.size(); ++next) {
        const Reached at = queue[next];
        const size_t here = find(at.triangle);
        if (here < uncovered_.size() && !taken_[here]) {
            taken_[here] = 1;
            area += uncovered_[here].area;
        }
        chart.triangles.push_back(at.triangle);
        sum += job_.mesh.area_vector(at.triangle);
        for (uint32_t n : job_.neighbours[at.triangle]) {
            if (n == NO_TRIANGLE || !seen.insert(n).second)
                continue;
            const Vec3d middle = centre(n);
            const size_t there = find(n);
            if (!(dot(normalize(job_.mesh.area_vector(n)), axis) >= MIN_COSINE))
                goes_on = true;
            else if (there < uncovered_.size() && !taken_[there])
                queue.push_back({n, middle});
            else if (length(middle - at.from) <= RING * job_.pitch)
                queue.push_back({n, at.from});
            else
                goes_on = true;
        }
    }
    if (!goes_on && length(sum) / 2 < DUST * job_.pitch * job_.pitch)
        area = 0;
    std::sort(chart.triangles.begin(), chart.triangles.end());
    chart.frame = make_frame(job_.mesh, chart.triangles, normalize(sum));
    chart.two_sided = partition_.charts[uncovered_[first].chart].two_sided;
    return chart;
}

/* The largest ones, in the order in which they are found. */
Vector<Chart> gather_charts(const Job &job, const Partition &partition,
                            const Vector<Uncovered> &uncovered)
{
    Gatherer gatherer(job, partition, uncovered);
    Vector<Chart> charts;
    Vector<std::pair<double, size_t>> size;      /* largest first */
    for (size_t i = 0; i < uncovered.size(); ++i) {
        double area;
        if (gatherer.taken(i))
            continue;
        Chart chart = gatherer.gather(i, area);
        if (area < MIN_AREA)
            continue;
        size.emplace_back(-area, charts.size());
        charts.push_back(std::move(chart));
    }
    std::sort(size.begin(), size.end());
    size.resize(std::min(size.size(), 1 + partition.charts.size() * MAX_ADDED));
    std::sort(size.begin(), size.end(), [](auto &a, auto &b) { return a.second < b.second; });
    Vector<Chart> out;
    for (const auto &[area, i] : size)
        out.push_back(std::move(charts[i]));
    return out;
}

/* Lowers the trim of the corners of cells, not into the patch's own chart. */
void relax_trims(const Vector<RelaxedTrim> &cells, Vector<PatchMaps> &patches)
{
    constexpr int MIN_CODE = GTX_TRIM_OUTLINE + 1;
    Vector<Vector<uint8_t>> before(patches.size());
    for (const RelaxedTrim &relaxed : cells) {
        PatchMaps &maps = patches[relaxed.patch];
        Vector<uint8_t> &old = before[relaxed.patch];
        if (old.empty())
            old = maps.trim;
        const size_t w = maps.record.rect[2], cell = relaxed.cell;
        for (size_t at : {cell, cell + 1, cell + w, cell + w + 1})
            if (old[at] > MIN_CODE)
                maps.trim[at] = std::min(maps.trim[at],
                                         uint8_t(std::max(MIN_CODE, old[at] - relaxed.by)));
    }
    for (size_t i = 0; i < patches.size(); ++i)
        if (!before[i].empty())
            fill_trim(patches[i]);
}

} // namespace

Vector<Chart> cover_uncovered(const Job &job, const Partition &partition,
                              Vector<PatchMaps> &patches, Task &task)
{
    const Gaps gaps = find_gaps(job, partition, patches, task);
    relax_trims(gaps.relaxed, patches);
    return gather_charts(job, partition, gaps.uncovered);
}

} // namespace gtx::baking
