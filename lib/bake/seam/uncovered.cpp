/* Makes what no height field shows be shown: by one whose trim ends too early, or by a chart of its
 * own.
 *
 * A chart loses surface of its own where a cell would bridge two height fields, and where a wall
 * leans back from its axis that is too small to be split off. Whoever looks there from the side
 * sees through. So the source is looked up in the height fields as readers decode them, and what is
 * in none of them, nor lies hidden in one a little beyond its outline, gets patches of its own,
 * with as much around it as their borders need. */
#include "bake/seam/decoded.hpp"
#include "bake/seam/seam.hpp"
#include "chart/frame.hpp"

#include <algorithm>
#include <tuple>
#include <unordered_set>

namespace gtx::baking {

/* A height field shows what it lies no deeper below than this, nor, when it is another chart's,
 * higher above, in texels along the source's normal. */
constexpr double MAX_BELOW = 0.5, MAX_ABOVE = 1;
/* Texels outside its outline to which a height field shows what faces its axis as much, from the
 * side too; a wall shows well inside the outline only. */
constexpr double SEEN = 0.15, MIN_FACING = 0.15, INSIDE = 0.1;
/* What faces away from its own chart by more is twisted inside out: seen from nowhere. */
constexpr double TWISTED = -0.4;
/* A height field that is as near as this along the normal is let show that ends so many texels
 * early. */
constexpr double MAX_OFF = 0.25, MAX_EASED = 1;
/* What faces its axis less is steep: cells miss it, and where another height field is right there,
 * that shows it too. */
constexpr double STEEP = 0.35;
/* Samples along a texel. A needle may be as long as its chart: it gets as many as a triangle whose
 * sides are so many texels longer than those of a square of its area. */
constexpr double SAMPLES = 2, NEEDLE = 8;
/* Square texels of surface that are worth a patch: less is hardly a pixel. */
constexpr double MIN_AREA = 0.05;
/* Texels of surface around it that its patch shows too, and how far the normals of one patch may
 * differ. */
constexpr double RING = 1.25, MIN_COSINE = 0.5;
/* Patches that are added at most: one to so many that there are. */
constexpr size_t ONE_TO = 6;

namespace {

/* A triangle that is not seen, of which chart, and how many square texels of it are not. */
struct Lost {
    uint32_t triangle, chart;
    double area;
};

/* A cell of a patch that would show something if its trim were lower by so many codes. */
struct Eased {
    size_t patch, corner;
    int by;
};

class Search {
public:
    Search(const Job &job, const Partition &partition, const std::vector<PatchMaps> &patches)
        : job_(job), partition_(partition), fields_(patches, job.options.height_bits)
    {
        for (size_t i = 0; i < fields_.size(); ++i)
            chart_.push_back(uint32_t(fields_[i].maps - patches.data()));
    }

    std::vector<Lost> run(Task &task);
    /* What would show if its trim ended less early. */
    const std::vector<Eased> &eased() const { return eased_; }

private:
    double lost_share(const Decoded &own, const Chart &chart, uint32_t triangle,
                      std::vector<Eased> &eased) const;
    bool shown_eased(const Vec3d &point, const Vec3d &normal, std::vector<Eased> &eased) const;
    bool shown_by(const Decoded &field, const Vec3d &point, const Vec3d &normal,
                  double most_above) const;
    bool shown(const Vec3d &point, const Vec3d &normal, double least_facing) const;

    const Job &job_;
    const Partition &partition_;
    const HeightFields fields_;
    std::vector<uint32_t> chart_; /* of a height field */
    std::vector<Eased> eased_;
};

bool Search::shown_by(const Decoded &field, const Vec3d &point, const Vec3d &normal,
                      double most_above) const
{
    const double facing = dot(normal, field.axis[2]);
    double above, trim;
    if (facing < 0 || !field.field_above(point, above, trim) ||
        trim > (facing < MIN_FACING ? -INSIDE : SEEN))
        return false;
    const double off = above * facing / job_.pitch;
    return off >= -MAX_BELOW && off <= most_above;
}

/* By a height field that faces it so much. */
bool Search::shown(const Vec3d &point, const Vec3d &normal, double least_facing) const
{
    return fields_.any_near(point, 0, [&](const Decoded &field) {
        return dot(normal, field.axis[2]) >= least_facing &&
               shown_by(field, point, normal, MAX_ABOVE);
    });
}

/* Whether a height field is right there, and hidden by its trim alone: the one that is hidden
 * least. */
bool Search::shown_eased(const Vec3d &point, const Vec3d &normal,
                         std::vector<Eased> &eased) const
{
    const Decoded *found = nullptr;
    double least = MAX_EASED;
    fields_.any_near(point, 0, [&](const Decoded &field) {
        const double facing = dot(normal, field.axis[2]);
        double above, trim;
        if (facing >= MIN_FACING && field.field_above(point, above, trim) && trim <= least &&
            std::abs(above * facing) <= MAX_OFF * job_.pitch) {
            least = trim;
            found = &field;
        }
        return false;
    });
    if (!found)
        return false;
    const int by = int(std::ceil((least - SEEN) * 16)) + 1;
    eased.push_back({chart_[fields_.index(*found)], found->place_of(point).cell, by});
    return true;
}

/* What a material cuts away is not lost. */
static bool is_masked(const Mesh &mesh, uint32_t triangle)
{
    const Appearance &a = mesh.appearance;
    return !a.material.empty() && a.materials[a.material[triangle]].alpha_cutoff > 0;
}

/* How much of a triangle no height field shows, 0..1, what shows once it is eased aside. */
double Search::lost_share(const Decoded &own, const Chart &chart, uint32_t triangle,
                          std::vector<Eased> &eased) const
{
    const Mesh &mesh = job_.mesh;
    Vec3d corner[3];
    for (int k = 0; k < 3; ++k)
        corner[k] = mesh.position(triangle, k) - job_.anchor;
    const Vec3d e = corner[1] - corner[0], f = corner[2] - corner[0];
    const double square = std::max({dot(e, e), dot(f, f), dot(f - e, f - e)});
    const double longest = std::sqrt(square) / job_.pitch;
    const Vec3d normal = normalize(cross(e, f));
    if (!(dot(normal, own.axis[2]) > TWISTED) || is_masked(mesh, triangle))
        return 0;
    const bool steep = dot(normal, own.axis[2]) < STEEP;
    const double sides = NEEDLE + std::sqrt(length(cross(e, f)) / 2) / job_.pitch;
    const int parts = std::max(1, int(std::ceil(SAMPLES * std::min(longest, sides))));
    int lost = 0;
    for (int j = 0; j < parts; ++j) {
        for (int i = 0; i + j < parts; ++i) {
            const Vec3d point = corner[0] + e * ((i + 1 / 3.) / parts) + f * ((j + 1 / 3.) / parts);
            const bool here = shown_by(own, point, normal, INFINITY);
            if (here && !steep)
                continue;
            const Vec3d local = chart.frame.local(point + job_.anchor);
            const bool mine = local.x >= chart.clip_low[0] && local.x <= chart.clip_high[0] &&
                              local.y >= chart.clip_low[1] && local.y <= chart.clip_high[1];
            lost += mine && !shown(point, normal, steep ? STEEP : 0) &&
                    !shown_eased(point, normal, eased) && !here;
        }
    }
    return lost / (parts * (parts + 1) / 2.);
}

std::vector<Lost> Search::run(Task &task)
{
    std::vector<std::vector<Lost>> of_field(fields_.size());
    std::vector<std::vector<Eased>> eased(fields_.size());
    task.parallel(fields_.size(), [&](size_t s) {
        const Chart &chart = partition_.charts[chart_[s]];
        for (uint32_t t : chart.triangles) {
            const double share = lost_share(fields_[s], chart, t, eased[s]);
            if (!(share > 0))
                continue;
            const double area = length(job_.mesh.area_vector(t)) / (2 * job_.pitch * job_.pitch);
            of_field[s].push_back({t, chart_[s], share * area});
        }
    });
    for (const std::vector<Eased> &some : eased)
        eased_.insert(eased_.end(), some.begin(), some.end());
    std::vector<Lost> out;
    for (const std::vector<Lost> &some : of_field)
        out.insert(out.end(), some.begin(), some.end());
    std::sort(out.begin(), out.end(), [](const Lost &a, const Lost &b) {
        return std::tie(a.triangle, a.chart) < std::tie(b.triangle, b.chart);
    });
    auto same = [](const Lost &a, const Lost &b) { return a.triangle == b.triangle; };
    out.erase(std::unique(out.begin(), out.end(), same), out.end());
    return out;
}

/* Gathers lost triangles that lie together into charts. */
class Gatherer {
public:
    Gatherer(const Job &job, const Partition &partition, const std::vector<Lost> &lost)
        : job_(job), partition_(partition), lost_(lost), taken_(lost.size(), 0)
    {
    }

    /* From this one on; the lost area of the chart, none where that is all of its component: dust
     * that was never anyone's surface. */
    Chart gather(size_t first, double &area);
    bool taken(size_t lost) const { return taken_[lost]; }

private:
    size_t find(uint32_t triangle) const
    {
        auto at = std::lower_bound(lost_.begin(), lost_.end(), triangle,
                                   [](const Lost &a, uint32_t b) { return a.triangle < b; });
        return at != lost_.end() && at->triangle == triangle ? size_t(at - lost_.begin())
                                                             : lost_.size();
    }
    Vec3d centre(uint32_t t) const
    {
        const Mesh &mesh = job_.mesh;
        return (mesh.position(t, 0) + mesh.position(t, 1) + mesh.position(t, 2)) / 3;
    }

    const Job &job_;
    const Partition &partition_;
    const std::vector<Lost> &lost_;
    std::vector<uint8_t> taken_;
};

Chart Gatherer::gather(size_t first, double &area)
{
    struct Reached {
        uint32_t triangle;
        Vec3d from;              /* the lost surface it was reached from */
    };
    const Vec3d axis = normalize(job_.mesh.area_vector(lost_[first].triangle));
    std::vector<Reached> queue = {{lost_[first].triangle, centre(lost_[first].triangle)}};
    std::unordered_set<uint32_t> seen = {queue[0].triangle};
    Chart chart;
    Vec3d sum;
    area = 0;
    bool goes_on = false;
    for (size_t next = 0; next < queue.size(); ++next) {
        const Reached at = queue[next];
        const size_t lost = find(at.triangle);
        if (lost < lost_.size() && !taken_[lost]) {
            taken_[lost] = 1;
            area += lost_[lost].area;
        }
        chart.triangles.push_back(at.triangle);
        sum += job_.mesh.area_vector(at.triangle);
        for (uint32_t n : job_.neighbours[at.triangle]) {
            if (n == NO_TRIANGLE || !seen.insert(n).second)
                continue;
            const Vec3d middle = centre(n);
            const size_t of = find(n);
            if (!(dot(normalize(job_.mesh.area_vector(n)), axis) >= MIN_COSINE))
                goes_on = true;
            else if (of < lost_.size() && !taken_[of])
                queue.push_back({n, middle});
            else if (length(middle - at.from) <= RING * job_.pitch)
                queue.push_back({n, at.from});
            else
                goes_on = true;
        }
    }
    if (!goes_on)
        area = 0;
    std::sort(chart.triangles.begin(), chart.triangles.end());
    chart.frame = make_frame(job_.mesh, chart.triangles, normalize(sum));
    chart.two_sided = partition_.charts[lost_[first].chart].two_sided;
    return chart;
}

} // namespace

/* Lowers the trim of the corners of cells, not into the patch's own chart. */
static void ease(const std::vector<Eased> &cells, std::vector<PatchMaps> &patches)
{
    constexpr int MIN_CODE = 129;
    std::vector<std::vector<uint8_t>> before(patches.size());
    for (const Eased &cell : cells) {
        PatchMaps &maps = patches[cell.patch];
        std::vector<uint8_t> &old = before[cell.patch];
        if (old.empty())
            old = maps.trim;
        const size_t w = maps.record.rect[2];
        for (size_t at : {cell.corner, cell.corner + 1, cell.corner + w, cell.corner + w + 1})
            if (old[at] > MIN_CODE)
                maps.trim[at] = std::min(maps.trim[at],
                                         uint8_t(std::max(MIN_CODE, old[at] - cell.by)));
    }
    for (size_t i = 0; i < patches.size(); ++i)
        if (!before[i].empty())
            fill_trim(patches[i]);
}

std::vector<Chart> cover_uncovered(const Job &job, const Partition &partition,
                                   std::vector<PatchMaps> &patches, Task &task)
{
    Search search(job, partition, patches);
    const std::vector<Lost> lost = search.run(task);
    ease(search.eased(), patches);
    Gatherer gatherer(job, partition, lost);
    std::vector<Chart> charts;
    std::vector<std::pair<double, size_t>> size; /* largest first */
    for (size_t i = 0; i < lost.size(); ++i) {
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
    size.resize(std::min(size.size(), 1 + partition.charts.size() / ONE_TO));
    std::sort(size.begin(), size.end(), [](auto &a, auto &b) { return a.second < b.second; });
    std::vector<Chart> out;
    for (const auto &[area, i] : size)
        out.push_back(std::move(charts[i]));
    return out;
}

} // namespace gtx::baking
