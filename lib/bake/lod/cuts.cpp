/* Large triangles at straight cuts: where one reaches across farther than the maps of its patch do,
 * it is split along the cut, and so are those that share the edges. */
#include "bake/lod/parts.hpp"

#include <algorithm>
#include <tuple>

namespace gtx::baking {

using Triangle = std::array<uint32_t, 3>;

/* A corner so near to a cut lies on it, in texels. Bunny: error +10 % at half and at double. */
constexpr double ON_CUT = 0.05;
/* A triangle that reaches no farther across is not split, in texels: far enough that one with its
 * centre on this side always has an edge that crosses. Bunny: error +7 % at half, +12 % at
 * double. */
constexpr double REACH = 0.25;

ChartCuts::ChartCuts(const Chart &chart, const Vec3d &anchor)
{
    const Frame &f = chart.frame;
    const double det = dot(cross(f.x, f.y), f.z);
    const Vec3d dual[] = {cross(f.y, f.z) / det, cross(f.z, f.x) / det};
    for (int axis = 0; axis < 2; ++axis) {
        any_ = any_ || std::isfinite(chart.clip_low[axis]) || std::isfinite(chart.clip_high[axis]);
        if (!chart.cells[axis])
            continue;
        const double cell = f.extent[axis] / chart.cells[axis];
        row_[axis] = dual[axis] / cell;
        shift_[axis] = dot(row_[axis], anchor - f.origin);
        size_[axis] = chart.cells[axis];
        low_[axis] = chart.clip_low[axis] / cell;
        high_[axis] = chart.clip_high[axis] / cell;
    }
}

double ChartCuts::outside(const std::array<double, 2> &place) const
{
    return std::max(std::max(-place[0], place[0] - size_[0]),
                    std::max(-place[1], place[1] - size_[1]));
}

/* An edge, and the share of the way from its lower vertex at which it is split. */
struct EdgeSplit {
    uint32_t low, high;
    double at;

    std::tuple<uint32_t, uint32_t, double, double> rank() const
    {
        return {low, high, std::fabs(at - 0.5), at};
    }
    bool same_edge(const EdgeSplit &o) const { return low == o.low && high == o.high; }
};

class Splitter {
public:
    Splitter(const Vector<ChartCuts> &cuts, const Vector<PatchRegion> &regions,
             LodSource &source)
        : cuts_(cuts), regions_(regions), source_(source)
    {
    }

    void find_open(Task &task);
    void find_sharers(const Partition &partition, const Maps &maps);
    /* Splits once. False when there was nothing to split. */
    bool round();

private:
    using Shared = std::pair<uint32_t, uint32_t>; /* a triangle of the mesh, a patch of it */

    bool held(uint32_t triangle) const;
    void find_splits(uint32_t triangle);
    uint32_t split_vertex(uint32_t a, uint32_t b) const;
    void divide(uint32_t triangle);
    uint32_t patch_at(uint32_t origin, const Vec3d &centre) const;

    const Vector<ChartCuts> &cuts_;
    const Vector<PatchRegion> &regions_;
    LodSource &source_;
    Vector<Shared> sharers_;          /* of the triangles that were open at first, ascending */
    Vector<uint32_t> origin_;         /* of each triangle: that of the mesh */
    Vector<uint32_t> open_;           /* those that may have to be split */
    Vector<uint8_t> is_open_;
    Vector<EdgeSplit> splits_;        /* of this round, by edge */
    Vector<uint8_t> is_end_;          /* vertices of edges that are split */
    uint32_t first_new_ = 0;          /* vertex of the first split */
};

bool Splitter::held(uint32_t triangle) const
{
    const PatchRegion &region = regions_[source_.patch[triangle]];
    std::array<double, 2> at[3];
    for (int k = 0; k < 3; ++k)
        at[k] = region.place(source_.positions[source_.triangles[triangle][k]]);
    return region.holds(at);
}

void Splitter::find_open(Task &task)
{
    const size_t count = source_.triangles.size(), chunk = 4096;
    is_open_.assign(count, 0);
    task.parallel((count + chunk - 1) / chunk, [&](size_t n) {
        for (size_t t = n * chunk; t < std::min(count, (n + 1) * chunk); ++t) {
            const uint32_t patch = source_.patch[t];
            is_open_[t] = patch != NO_PATCH && cuts_[patch].any() && !held(uint32_t(t));
        }
    }, 0, 0);
    origin_.resize(count);
    for (uint32_t t = 0; t < count; ++t) {
        origin_[t] = t;
        if (is_open_[t])
            open_.push_back(t);
    }
}

void Splitter::find_sharers(const Partition &partition, const Maps &maps)
{
    for (uint32_t p = 0; p < cuts_.size(); ++p)
        if (cuts_[p].any())
            for (uint32_t t : partition.charts[maps.charts[p]].triangles)
                if (is_open_[t])
                    sharers_.push_back({t, p});
    std::sort(sharers_.begin(), sharers_.end());
}

uint32_t Splitter::patch_at(uint32_t origin, const Vec3d &centre) const
{
    uint32_t nearest = NO_PATCH;
    double least = INFINITY;
    auto at = std::lower_bound(sharers_.begin(), sharers_.end(), Shared(origin, 0));
    for (; at != sharers_.end() && at->first == origin; ++at) {
        const ChartCuts &cuts = cuts_[at->second];
        const double outside = cuts.outside(cuts.place(centre));
        if (outside < least) {
            least = outside;
            nearest = at->second;
        }
    }
    return nearest;
}

/* Where the edges of a triangle cross a cut that it reaches across. */
void Splitter::find_splits(uint32_t triangle)
{
    const Triangle &t = source_.triangles[triangle];
    const ChartCuts &cuts = cuts_[source_.patch[triangle]];
    for (int side = 0; side < 4; ++side) {
        double beyond[3];
        for (int k = 0; k < 3; ++k)
            beyond[k] = cuts.beyond(cuts.place(source_.positions[t[k]]), side / 2, side % 2);
        if (std::max({beyond[0], beyond[1], beyond[2]}) <= REACH)
            continue;
        for (int k = 0; k < 3; ++k) {
            const int n = (k + 1) % 3;
            const auto [least, most] = std::minmax(beyond[k], beyond[n]);
            if (least >= -ON_CUT || most <= ON_CUT)
                continue;
            const int low = t[k] < t[n] ? k : n, high = t[k] < t[n] ? n : k;
            splits_.push_back({t[low], t[high], beyond[low] / (beyond[low] - beyond[high])});
        }
    }
}

/* The new vertex on an edge, or NO_VERTEX. */
uint32_t Splitter::split_vertex(uint32_t a, uint32_t b) const
{
    const EdgeSplit edge = {std::min(a, b), std::max(a, b), 0};
    if (!is_end_[a] || !is_end_[b])
        return NO_VERTEX;
    auto at = std::lower_bound(splits_.begin(), splits_.end(), edge,
                               [](const EdgeSplit &x, const EdgeSplit &y) {
        return std::tie(x.low, x.high) < std::tie(y.low, y.high);
    });
    return at != splits_.end() && at->same_edge(edge)
               ? first_new_ + uint32_t(at - splits_.begin())
               : NO_VERTEX;
}

/* A fan around the vertex on its first edge that is split: no triangle of it is flat. */
void Splitter::divide(uint32_t triangle)
{
    const Triangle t = source_.triangles[triangle];
    uint32_t ring[6];
    int count = 0, first = -1;
    for (int k = 0; k < 3; ++k) {
        ring[count++] = t[k];
        const uint32_t on_edge = split_vertex(t[k], t[(k + 1) % 3]);
        if (on_edge == NO_VERTEX)
            continue;
        first = first < 0 ? count : first;
        ring[count++] = on_edge;
    }
    if (first < 0)
        return;
    for (int i = 1; i + 1 < count; ++i) {
        uint32_t part = triangle;
        if (i > 1) {
            part = uint32_t(source_.triangles.size());
            source_.triangles.emplace_back();
            source_.patch.push_back(source_.patch[triangle]);
            origin_.push_back(origin_[triangle]);
            is_open_.push_back(is_open_[triangle]);
        }
        source_.triangles[part] = {ring[first], ring[(first + i) % count],
                                   ring[(first + i + 1) % count]};
        if (is_open_[part]) {
            source_.patch[part] = patch_at(origin_[part], source_.centre(part));
            open_.push_back(part);
        }
    }
}

bool Splitter::round()
{
    splits_.clear();
    for (uint32_t t : open_)
        if (!held(t))
            find_splits(t);
    std::sort(splits_.begin(), splits_.end(), [](const EdgeSplit &a, const EdgeSplit &b) {
        return a.rank() < b.rank();
    });
    auto same_edge = [](const EdgeSplit &a, const EdgeSplit &b) { return a.same_edge(b); };
    splits_.erase(std::unique(splits_.begin(), splits_.end(), same_edge), splits_.end());
    first_new_ = uint32_t(source_.positions.size());
    is_end_.assign(first_new_ + splits_.size(), 0);
    for (const EdgeSplit &s : splits_) {
        const Vec3d from = source_.positions[s.low], way = source_.positions[s.high] - from;
        source_.positions.push_back(from + way * s.at);
        is_end_[s.low] = is_end_[s.high] = 1;
    }
    open_.clear();
    const size_t count = splits_.empty() ? 0 : source_.triangles.size();
    for (uint32_t t = 0; t < count; ++t) {
        const Triangle &v = source_.triangles[t];
        if (is_end_[v[0]] + is_end_[v[1]] + is_end_[v[2]] > 1)
            divide(t);
    }
    return !splits_.empty();
}

void split_at_cuts(const Partition &partition, const Maps &maps, const Vector<ChartCuts> &cuts,
                   const Vector<PatchRegion> &regions, LodSource &source, Task &task)
{
    Splitter splitter(cuts, regions, source);
    splitter.find_open(task);
    splitter.find_sharers(partition, maps);
    while (splitter.round())
        cancel_point();
}

} // namespace gtx::baking
