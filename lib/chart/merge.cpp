/* Merges neighbouring charts, those with the longest common border first.
 *
 * Splitting takes a cluster apart wherever it folds, and knows nothing of its neighbours: what it
 * leaves often folds nowhere together with a piece of another cluster. The longer the outlines of
 * all charts are, the more texels along them stay empty. */
#include "chart/merge.hpp"

#include <algorithm>
#include <map>
#include <queue>

namespace gtx {

namespace {

/* Least cosine of smoothed normals with the common axis, but for STEEP_SHARE of the area. Half: RMS
 * +7 % (bunny); double: patches +7 % (truck), empty +4 points (Spot). */
constexpr double MERGED_FACING = 0.4;
/* The same share before the axis is known, with the mean of all normals for it: what is far off
 * is not worth the search. Half: patches +4 %; double: bytes +1 % (truck). */
constexpr double STEEP_GUESS = 10 * STEEP_SHARE;
/* The sum of normals in a merged chart's area: less across an edge of a designed model. Half:
 * patches +9 % (Spot); above 1 nothing merges: patches +9 %, texels +12 % (truck). */
constexpr double MIN_CONE = 0.75;
/* Common border, of one chart's outline. Half: patches +4 %, double: +8 % (truck). */
constexpr double MIN_BORDER = 0.15;
/* Area of the smaller chart in the larger's: less hardly turns its axis. Half: 2 holes, RMS +23 %;
 * double: patches +2 % (truck). */
constexpr double MIN_SHARE = 0.02;
/* Of the smaller chart, what a merge may set apart, a small island at most. Double: texels +4 %
 * (truck). */
constexpr double LOOSE_SHARE = 0.1;
/* Offers that are tried side by side, on however many threads: a constant, for bytes depend on it.
 * Half: RMS -10 %, texels +1 % (truck); double: the same but for a few bytes. */
constexpr size_t BATCH = 8;

/* Two charts, the lower number first, as they were at some age. */
struct Offer {
    double border;
    uint32_t a, b, age;

    bool operator<(const Offer &o) const
    {
        return border != o.border ? border < o.border : a != o.a ? a > o.a : b > o.b;
    }
};

/* What two charts have in common. A pair that was refused is not tried again after either has
 * grown: what folds with a part of a chart nearly always folds with the whole. */
struct Border {
    double length = 0;      /* in roots of triangles' sizes */
    bool refused = false;
};

/* The outcome of an offer. */
struct Trial {
    bool fits = false;
    Region both;
    Frame frame;
    Vector<Region> loose;      /* walls and the like, left out of both */
};

class Merger {
public:
    Merger(const Surface &surface, const Bounds &bounds, Vector<Region> &regions,
           Vector<Frame> &frames)
        : surface_(surface), bounds_(bounds), regions_(regions), frames_(frames),
          border_(regions.size()), outline_(regions.size()), texels_(regions.size()),
          age_(regions.size()), owner_(surface.whole.size()), place_(surface.whole.size())
    {
    }

    Vector<Region> run(Task &task);

private:
    void measure();
    void offer(uint32_t a, uint32_t b);
    Vector<Offer> best_offers();
    bool too_steep(const Offer &offer, const Vec3d &z, double most) const;
    Region join(const Offer &offer);
    Trial try_offer(const Offer &offer, Task &task);
    void adopt(const Offer &offer, Trial &trial);
    double texels(const Region &region) const
    {
        return texels_of(surface_, region, bounds_.pitch);
    }

    const Surface &surface_;
    const Bounds &bounds_;
    Vector<Region> &regions_;
    Vector<Frame> &frames_;
    Vector<std::map<uint32_t, Border>> border_;      /* of a chart with others */
    Vector<double> outline_, texels_;
    Vector<uint32_t> age_;
    Vector<uint32_t> owner_;      /* of a triangle: its chart */
    Vector<uint32_t> place_;      /* likewise in the region that is being made */
    std::priority_queue<Offer> queue_;
    Vector<Region> loose_;
};

void Merger::measure()
{
    for (uint32_t i = 0; i < regions_.size(); ++i) {
        texels_[i] = texels(regions_[i]);
        for (uint32_t t : regions_[i].triangles)
            owner_[t] = i;
    }
    for (uint32_t t = 0; t < owner_.size(); ++t)
        for (uint32_t n : surface_.whole.neighbours[t])
            if (n != NO_TRIANGLE && owner_[n] != owner_[t]) {
                double width = std::sqrt(double(std::min(surface_.facets[t].size,
                                                         surface_.facets[n].size)));
                border_[owner_[t]][owner_[n]].length += width;
                outline_[owner_[t]] += width;
            }
}

void Merger::offer(uint32_t a, uint32_t b)
{
    const auto [less, more] = std::minmax(texels_[a], texels_[b]);
    const Border &border = border_[a][b];
    if (!border.refused && less >= SMALL_ISLAND_TEXELS && less >= MIN_SHARE * more &&
        border.length >= MIN_BORDER * std::min(outline_[a], outline_[b]))
        queue_.push({border.length, std::min(a, b), std::max(a, b), age_[a] + age_[b]});
}

bool Merger::too_steep(const Offer &offer, const Vec3d &z, double most) const
{
    double steep = 0, size = 0;
    for (uint32_t i : {offer.a, offer.b})
        for (uint32_t t : regions_[i].triangles) {
            const Facet &facet = surface_.facets[t];
            size += double(facet.size);
            if (dot(Vec3d(facet.normal), z) < MERGED_FACING)
                steep += double(facet.size);
        }
    return steep > most * size;
}

/* The best offers that stand, no chart in two of them. */
Vector<Offer> Merger::best_offers()
{
    Vector<Offer> out, later;
    while (!queue_.empty() && out.size() < BATCH) {
        const Offer best = queue_.top();
        queue_.pop();
        if (age_[best.a] + age_[best.b] != best.age || !border_[best.a].count(best.b))
            continue;
        const bool apart = std::none_of(out.begin(), out.end(), [&](const Offer &o) {
            return o.a == best.a || o.a == best.b || o.b == best.a || o.b == best.b;
        });
        (apart ? out : later).push_back(best);
    }
    for (const Offer &offer : later)
        queue_.push(offer);
    return out;
}

Region Merger::join(const Offer &offer)
{
    const Vector<uint32_t> &a = regions_[offer.a].triangles, &b = regions_[offer.b].triangles;
    Region out;
    std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out.triangles));
    for (uint32_t i = 0; i < out.size(); ++i)
        place_[out.triangles[i]] = i;
    for (uint32_t t : out.triangles) {
        std::array<uint32_t, 3> own = surface_.whole.neighbours[t];
        for (uint32_t &n : own)
            if (n != NO_TRIANGLE)
                n = owner_[n] == offer.a || owner_[n] == offer.b ? place_[n] : NO_TRIANGLE;
        out.neighbours.push_back(own);
    }
    return out;
}

Trial Merger::try_offer(const Offer &offer, Task &task)
{
    Trial trial;
    Vec3d sum;
    double size = 0;
    for (uint32_t i : {offer.a, offer.b})
        for (uint32_t t : regions_[i].triangles) {
            sum += Vec3d(surface_.facets[t].normal) * double(surface_.facets[t].size);
            size += double(surface_.facets[t].size);
        }
    if (length(sum) < MIN_CONE * size || too_steep(offer, normalize(sum), STEEP_GUESS))
        return trial;
    trial.both = join(offer);
    const Vec3d z = chart_axis(surface_, trial.both.triangles, bounds_);
    Verdict verdict;
    if (too_steep(offer, z, STEEP_SHARE) ||
        !fits_along(surface_, trial.both, z, bounds_, task, verdict))
        return trial;
    trial.frame = verdict.frame;
    if (!verdict.pieces.empty()) {
        auto main = std::max_element(verdict.pieces.begin(), verdict.pieces.end(),
                                     [&](const Region &a, const Region &b) {
                                         return texels(a) < texels(b);
                                     });
        const double less = std::min(texels_[offer.a], texels_[offer.b]);
        if (texels(trial.both) - texels(*main) > std::min(SMALL_ISLAND_TEXELS, LOOSE_SHARE * less))
            return trial;
        trial.both = std::move(*main);
        verdict.pieces.erase(main);
        trial.frame = make_frame(surface_.mesh, trial.both.triangles, z);
        trial.loose = std::move(verdict.pieces);
    }
    trial.fits = true;
    return trial;
}

/* The second of two charts is now the first's. */
void Merger::adopt(const Offer &offer, Trial &trial)
{
    const auto &[length, a, b, age] = offer;
    for (uint32_t t : regions_[b].triangles)
        owner_[t] = a;
    for (const Region &region : trial.loose)
        for (uint32_t t : region.triangles)
            owner_[t] = NO_TRIANGLE;
    std::move(trial.loose.begin(), trial.loose.end(), std::back_inserter(loose_));
    frames_[a] = trial.frame;
    regions_[a] = std::move(trial.both);
    regions_[b] = {};
    outline_[a] += outline_[b] - 2 * length;
    texels_[a] += texels_[b];
    ++age_[a];
    ++age_[b];
    border_[a].erase(b);
    border_[b].erase(a);
    for (const auto &[other, border] : border_[b]) {
        Border &ours = border_[a][other];
        ours.length += border.length;
        ours.refused |= border.refused;
        border_[other][a] = ours;
        border_[other].erase(b);
    }
    border_[b].clear();
    for (const auto &[other, border] : border_[a])
        this->offer(a, other);
}

Vector<Region> Merger::run(Task &task)
{
    measure();
    for (uint32_t a = 0; a < regions_.size(); ++a)
        for (const auto &[b, border] : border_[a])
            if (a < b)
                offer(a, b);
    for (Vector<Offer> best; !(best = best_offers()).empty();) {
        Vector<Trial> trials(best.size());
        task.parallel(best.size(), [&](size_t i) { trials[i] = try_offer(best[i], task); }, 0, 0);
        for (size_t i = 0; i < best.size(); ++i) {
            const auto [a, b] = std::pair(best[i].a, best[i].b);
            if (trials[i].fits)
                adopt(best[i], trials[i]);
            else
                border_[a][b].refused = border_[b][a].refused = true;
        }
    }
    drop_empty(regions_, frames_);
    return std::move(loose_);
}

} // namespace

Vector<Region> merge_charts(const Surface &surface, const Bounds &bounds,
                            Vector<Region> &regions, Vector<Frame> &frames,
                            Task &task)
{
    return Merger(surface, bounds, regions, frames).run(task);
}

} // namespace gtx
