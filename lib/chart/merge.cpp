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

constexpr double LEAST_COSINE = 0.4;  /* of smoothed normals with the common axis */
constexpr double STEEP_AREA = 0.01;   /* of both charts, where it may be less */
constexpr double STEEP_GUESS = 0.1;   /* likewise while the mean of all normals is the axis */
constexpr double LEAST_CONE = 0.75;   /* of their area, the sum of normals: less across an edge */
constexpr double LEAST_BORDER = 0.15; /* of one chart's outline: common */
constexpr double LEAST_TEXELS = 64;   /* of a chart: smaller ones are crumbs */
constexpr double LEAST_SHARE = 0.02;  /* of the larger chart: less hardly turns its axis */
constexpr double LOOSE_TEXELS = 64, LOOSE_SHARE = 0.1; /* of the smaller chart: set apart at most */

/* Two charts, the lower number first, as they were at some age. */
struct Offer {
    double border;
    uint32_t a, b, age;

    bool operator<(const Offer &o) const
    {
        return border != o.border ? border < o.border : a != o.a ? a > o.a : b > o.b;
    }
};

class Merger {
public:
    Merger(const Surface &surface, const Bounds &bounds, std::vector<Region> &regions,
           std::vector<Frame> &frames)
        : surface_(surface), bounds_(bounds), regions_(regions), frames_(frames),
          border_(regions.size()), outline_(regions.size()), texels_(regions.size()),
          age_(regions.size()), place_(surface.whole.size(), NO_TRIANGLE)
    {
    }

    std::vector<Region> run();

private:
    void measure();
    void offer(uint32_t a, uint32_t b);
    bool too_steep(const Offer &offer, const Vec3d &z, double most) const;
    Region join(const Region &a, const Region &b);
    bool merge(const Offer &offer);
    void adopt(const Offer &offer);
    double texels(const Region &region) const;

    const Surface &surface_;
    const Bounds &bounds_;
    std::vector<Region> &regions_;
    std::vector<Frame> &frames_;
    std::vector<std::map<uint32_t, double>> border_; /* of a chart with others: triangles' sizes */
    std::vector<double> outline_, texels_;
    std::vector<uint32_t> age_;
    std::vector<uint32_t> place_; /* of a triangle in the region that is being made */
    std::priority_queue<Offer> queue_;
    std::vector<Region> loose_;
};

double Merger::texels(const Region &region) const
{
    double size = 0, mean = surface_.area / double(surface_.facets.size());
    for (uint32_t t : region.triangles)
        size += double(surface_.facets[t].size);
    return size * mean / (bounds_.pitch * bounds_.pitch);
}

void Merger::measure()
{
    std::vector<uint32_t> owner(surface_.whole.size());
    for (uint32_t i = 0; i < regions_.size(); ++i) {
        texels_[i] = texels(regions_[i]);
        for (uint32_t t : regions_[i].triangles)
            owner[t] = i;
    }
    for (uint32_t t = 0; t < owner.size(); ++t)
        for (uint32_t n : surface_.whole.neighbours[t])
            if (n != NO_TRIANGLE && owner[n] != owner[t]) {
                double width = std::sqrt(double(std::min(surface_.facets[t].size,
                                                         surface_.facets[n].size)));
                border_[owner[t]][owner[n]] += width;
                outline_[owner[t]] += width;
            }
}

void Merger::offer(uint32_t a, uint32_t b)
{
    const double border = border_[a][b], less = std::min(texels_[a], texels_[b]);
    if (less >= LEAST_TEXELS && less >= LEAST_SHARE * std::max(texels_[a], texels_[b]) &&
        border >= LEAST_BORDER * std::min(outline_[a], outline_[b]))
        queue_.push({border, std::min(a, b), std::max(a, b), age_[a] + age_[b]});
}

bool Merger::too_steep(const Offer &offer, const Vec3d &z, double most) const
{
    double steep = 0, size = 0;
    for (uint32_t i : {offer.a, offer.b})
        for (uint32_t t : regions_[i].triangles) {
            const Facet &facet = surface_.facets[t];
            size += double(facet.size);
            if (dot(Vec3d(facet.normal), z) < LEAST_COSINE)
                steep += double(facet.size);
        }
    return steep > most * size;
}

Region Merger::join(const Region &a, const Region &b)
{
    Region out;
    std::merge(a.triangles.begin(), a.triangles.end(), b.triangles.begin(), b.triangles.end(),
               std::back_inserter(out.triangles));
    for (uint32_t i = 0; i < out.size(); ++i)
        place_[out.triangles[i]] = i;
    for (uint32_t t : out.triangles) {
        std::array<uint32_t, 3> own = surface_.whole.neighbours[t];
        for (uint32_t &n : own)
            n = n == NO_TRIANGLE ? n : place_[n];
        out.neighbours.push_back(own);
    }
    for (uint32_t t : out.triangles)
        place_[t] = NO_TRIANGLE;
    return out;
}

bool Merger::merge(const Offer &offer)
{
    Vec3d sum;
    double size = 0;
    for (uint32_t i : {offer.a, offer.b})
        for (uint32_t t : regions_[i].triangles) {
            sum += Vec3d(surface_.facets[t].normal) * double(surface_.facets[t].size);
            size += double(surface_.facets[t].size);
        }
    if (length(sum) < LEAST_CONE * size || too_steep(offer, normalize(sum), STEEP_GUESS))
        return false;
    Region both = join(regions_[offer.a], regions_[offer.b]);
    const Vec3d z = cone_axis(surface_, both.triangles);
    if (too_steep(offer, z, STEEP_AREA))
        return false;
    Verdict verdict;
    if (!fits_along(surface_, both, z, bounds_, verdict))
        return false;
    Frame frame = verdict.frame;
    if (!verdict.pieces.empty()) {
        auto main = std::max_element(verdict.pieces.begin(), verdict.pieces.end(),
                                     [&](const Region &a, const Region &b) {
                                         return texels(a) < texels(b);
                                     });
        const double less = std::min(texels_[offer.a], texels_[offer.b]);
        if (texels(both) - texels(*main) > std::min(LOOSE_TEXELS, LOOSE_SHARE * less))
            return false;
        both = std::move(*main);
        verdict.pieces.erase(main);
        frame = make_frame(surface_.mesh, both.triangles, z);
        std::move(verdict.pieces.begin(), verdict.pieces.end(), std::back_inserter(loose_));
    }
    frames_[offer.a] = frame;
    regions_[offer.a] = std::move(both);
    regions_[offer.b] = {};
    return true;
}

/* The second of two charts is now the first's. */
void Merger::adopt(const Offer &offer)
{
    const auto &[length, a, b, age] = offer;
    outline_[a] += outline_[b] - 2 * length;
    texels_[a] += texels_[b];
    ++age_[a];
    ++age_[b];
    border_[a].erase(b);
    border_[b].erase(a);
    for (const auto &[other, border] : border_[b]) {
        border_[a][other] += border;
        border_[other][a] += border;
        border_[other].erase(b);
    }
    border_[b].clear();
    for (const auto &[other, border] : border_[a])
        this->offer(a, other);
}

std::vector<Region> Merger::run()
{
    measure();
    for (uint32_t a = 0; a < regions_.size(); ++a)
        for (const auto &[b, border] : border_[a])
            if (a < b)
                offer(a, b);
    while (!queue_.empty()) {
        Offer best = queue_.top();
        queue_.pop();
        const bool current = age_[best.a] + age_[best.b] == best.age && border_[best.a].count(best.b);
        if (current && merge(best))
            adopt(best);
    }
    size_t kept = 0;
    for (size_t i = 0; i < regions_.size(); ++i) {
        if (!regions_[i].size())
            continue;
        std::swap(regions_[kept], regions_[i]);
        frames_[kept++] = frames_[i];
    }
    regions_.resize(kept);
    frames_.resize(kept);
    return std::move(loose_);
}

} // namespace

std::vector<Region> merge_charts(const Surface &surface, const Bounds &bounds,
                                 std::vector<Region> &regions, std::vector<Frame> &frames)
{
    return Merger(surface, bounds, regions, frames).run();
}

} // namespace gtx
