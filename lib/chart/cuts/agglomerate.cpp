/* Bottom-up clustering with the metric of variational shape approximation (Cohen-Steiner, Alliez,
 * Desbrun 2004, L2,1): what a merge costs is by how much it shortens the sum of normals.
 *
 * Rounds of mutually cheapest merges take millions of triangles to thousands of clusters in linear
 * time; a queue does the rest in the exact order; label switching (cuts/borders.cpp) then moves the
 * borders. */
#include "chart/cuts/agglomerate.hpp"

#include "chart/cuts/borders.hpp"

#include <algorithm>
#include <numeric>
#include <queue>
#include <utility>

namespace gtx {

namespace {

/* A cluster's normals sum to at least this share of its area: (1 + cos) / 2 for a round cap. Half:
 * RMS +17 % (Duck); above 1 nothing merges: 9 times the texels (bunny). */
constexpr float MIN_CONE = 0.82f;
/* Small clusters merge first where the surface is flat. Half: RMS +7 % (Duck); double: patches +9 %
 * (truck). */
constexpr float SIZE_COST = 1e-4f;
/* Time against order: rounds stop here and the queue goes on. Half: RMS +5 %; double: bytes +3 %
 * (bunny). */
constexpr size_t QUEUED_CLUSTERS = 20000;
/* Clusters a parallel step; changes no byte. */
constexpr size_t CHUNK = 4096;

struct Sum {
    Vec3f normal; /* of sizes times normals */
    float size = 0, norm = 0;
};

Sum operator+(const Sum &a, const Sum &b)
{
    Sum out = {a.normal + b.normal, a.size + b.size, 0};
    out.norm = length(out.normal);
    return out;
}

float merge_cost(const Sum &a, const Sum &b)
{
    Sum both = a + b;
    if (both.norm < MIN_CONE * both.size)
        return INFINITY;
    return 2 * (a.norm + b.norm - both.norm) + SIZE_COST * both.size;
}

/* Clusters and who touches whom, as rounds rebuild them. */
struct Clusters {
    Vector<Sum> sums;
    Vector<uint32_t> first, touching;      /* those of c: touching[first[c]] to first[c + 1] */

    size_t size() const { return sums.size(); }
};

Clusters single_triangles(const Surface &surface)
{
    Clusters out;
    out.sums.reserve(surface.whole.size());
    out.first.reserve(surface.whole.size() + 1);
    out.touching.reserve(3 * surface.whole.size());
    for (size_t t = 0; t < surface.whole.size(); ++t) {
        const Facet &f = surface.facets[t];
        out.sums.push_back({f.normal * f.size, f.size, f.size});
        out.first.push_back(uint32_t(out.touching.size()));
        for (uint32_t n : surface.whole.neighbours[t])
            if (n != NO_TRIANGLE)
                out.touching.push_back(n);
    }
    out.first.push_back(uint32_t(out.touching.size()));
    return out;
}

/* Breaks ties between pairs that cost the same, as in planes, so that many are mutual. */
uint32_t tie_break_hash(uint32_t a, uint32_t b)
{
    uint32_t hash = std::min(a, b) * 0x9e3779b1u ^ std::max(a, b) * 0x85ebca77u;
    return (hash ^ hash >> 15) * 0xc2b2ae35u;
}

/* The cheapest partner of each cluster, NO_TRIANGLE where no merge is allowed. */
Vector<uint32_t> cheapest_partners(const Clusters &clusters, Task &task)
{
    Vector<uint32_t> best(clusters.size(), NO_TRIANGLE);
    task.parallel((clusters.size() + CHUNK - 1) / CHUNK, [&](size_t chunk) {
        size_t end = std::min(clusters.size(), (chunk + 1) * CHUNK);
        for (size_t c = chunk * CHUNK; c < end; ++c) {
            float least = INFINITY;
            uint32_t best_hash = 0;
            for (uint32_t i = clusters.first[c]; i < clusters.first[c + 1]; ++i) {
                uint32_t other = clusters.touching[i];
                float cost = merge_cost(clusters.sums[c], clusters.sums[other]);
                uint32_t hash = tie_break_hash(uint32_t(c), other);
                if (cost < least || (cost == least && cost < INFINITY && hash < best_hash)) {
                    least = cost;
                    best_hash = hash;
                    best[c] = other;
                }
            }
        }
    }, 0, 0);
    return best;
}

/* Who merges with whom: every two that are each other's cheapest, and where costs rise along a
 * line, so that these are few, whoever is still free. */
Vector<uint32_t> match(const Vector<uint32_t> &best, Task &task)
{
    Vector<uint32_t> partner(best.size(), NO_TRIANGLE);
    Vector<size_t> mutual(task.parts(best.size(), CHUNK), 0);
    task.in_parts(best.size(), mutual.size(), [&](size_t part, size_t from, size_t to) {
        for (size_t c = from; c < to; ++c)
            if (best[c] != NO_TRIANGLE && best[best[c]] == c)
                partner[c] = best[c];
        const uint32_t *own = partner.data();
        mutual[part] = to - from - size_t(std::count(own + from, own + to, NO_TRIANGLE));
    });
    const size_t matched = std::accumulate(mutual.begin(), mutual.end(), size_t(0));
    for (uint32_t c = 0; matched < best.size() / 16 && c < best.size(); ++c)
        if (partner[c] == NO_TRIANGLE && best[c] != NO_TRIANGLE &&
            partner[best[c]] == NO_TRIANGLE) {
            partner[c] = best[c];
            partner[best[c]] = c;
        }
    return partner;
}

/* Clusters from..to - 1 of those that take the place of `members` and their partners. */
Clusters merge_some(const Clusters &clusters, const Vector<uint32_t> &members,
                    const Vector<uint32_t> &partner, const Vector<uint32_t> &renamed, size_t from,
                    size_t to)
{
    Clusters out;
    Vector<uint32_t> listed(members.size(), NO_TRIANGLE);      /* by which cluster, last */
    out.sums.reserve(to - from);
    out.first.reserve(to - from);
    for (size_t c = from; c < to; ++c) {
        const uint32_t other_half = partner[members[c]];
        const Sum &own = clusters.sums[members[c]];
        out.sums.push_back(other_half == NO_TRIANGLE ? own : own + clusters.sums[other_half]);
        out.first.push_back(uint32_t(out.touching.size()));
        listed[c] = uint32_t(c);
        for (uint32_t member : {members[c], other_half}) {
            if (member == NO_TRIANGLE)
                continue;
            for (uint32_t i = clusters.first[member]; i < clusters.first[member + 1]; ++i) {
                const uint32_t other = renamed[clusters.touching[i]];
                if (std::exchange(listed[other], uint32_t(c)) != c)
                    out.touching.push_back(other);
            }
        }
    }
    return out;
}

/* One after the other. */
Clusters joined(Vector<Clusters> &parts)
{
    Clusters out = std::move(parts[0]);
    for (size_t part = 1; part < parts.size(); ++part) {
        const Clusters more = std::move(parts[part]);
        const auto before = uint32_t(out.touching.size());
        out.sums.insert(out.sums.end(), more.sums.begin(), more.sums.end());
        for (uint32_t first : more.first)
            out.first.push_back(before + first);
        out.touching.insert(out.touching.end(), more.touching.begin(), more.touching.end());
    }
    out.first.push_back(uint32_t(out.touching.size()));
    return out;
}

/* Merges matched pairs. Returns the new cluster of each old one. */
Vector<uint32_t> merge_pairs(Clusters &clusters, const Vector<uint32_t> &partner, Task &task)
{
    Vector<uint32_t> renamed(clusters.size()), members;
    for (uint32_t c = 0; c < clusters.size(); ++c) {
        if (partner[c] < c) {
            renamed[c] = renamed[partner[c]];
            continue;
        }
        renamed[c] = uint32_t(members.size());
        members.push_back(c);
    }
    Vector<Clusters> parts(task.parts(members.size(), CHUNK));
    task.in_parts(members.size(), parts.size(), [&](size_t part, size_t from, size_t to) {
        parts[part] = merge_some(clusters, members, partner, renamed, from, to);
    });
    clusters = joined(parts);
    return renamed;
}

/* The cheapest merge a cluster saw when it last looked. Those of equal cost have an order. */
struct Offer {
    float cost = INFINITY;
    uint32_t a = 0, b = 0;        /* a < b; one of them is the owner */
    uint32_t age_a = 0, age_b = 0, owner = 0;

    bool is_before(const Offer &o) const
    {
        return cost != o.cost ? cost < o.cost : a != o.a ? a < o.a : b < o.b;
    }
    bool operator<(const Offer &o) const { return o.is_before(*this); } /* the queue's top is
                                                                           last */
};

/* Merges the cheapest pair, again and again. The queue holds the cheapest offer of each cluster, or
 * an old one that was as cheap: only a cluster just made can lower what its neighbours pay. */
class MergeQueue {
public:
    explicit MergeQueue(Clusters &clusters);
    /* Returns the new cluster of each old one. */
    Vector<uint32_t> run();

private:
    uint32_t root(uint32_t c)
    {
        while (parent_[c] != c)
            c = parent_[c] = parent_[parent_[c]];
        return c;
    }
    bool is_now(uint32_t c, uint32_t age) const { return parent_[c] == c && age_[c] == age; }
    Offer offer(uint32_t owner, uint32_t other) const;
    void keep(const Offer &best);
    void look(uint32_t owner);
    void merge(uint32_t a, uint32_t b);

    Clusters &clusters_;
    Vector<uint32_t> parent_, age_;
    Vector<Vector<uint32_t>> touching_;
    Vector<Offer> best_;
    std::priority_queue<Offer> queue_;
};

MergeQueue::MergeQueue(Clusters &clusters)
    : clusters_(clusters), parent_(clusters.size()), age_(clusters.size()),
      touching_(clusters.size()), best_(clusters.size())
{
    std::iota(parent_.begin(), parent_.end(), 0u);
    for (uint32_t c = 0; c < clusters.size(); ++c)
        touching_[c].assign(clusters.touching.begin() + clusters.first[c],
                            clusters.touching.begin() + clusters.first[c + 1]);
}

Offer MergeQueue::offer(uint32_t owner, uint32_t other) const
{
    const uint32_t a = std::min(owner, other), b = std::max(owner, other);
    return {merge_cost(clusters_.sums[a], clusters_.sums[b]), a, b, age_[a], age_[b], owner};
}

void MergeQueue::keep(const Offer &best)
{
    best_[best.owner] = best;
    if (best.cost < INFINITY)
        queue_.push(best);
}

void MergeQueue::look(uint32_t owner)
{
    Offer best;
    best.owner = owner;
    for (uint32_t &other : touching_[owner]) {
        other = root(other);
        const Offer one = offer(owner, other);
        if (other != owner && one.is_before(best))
            best = one;
    }
    keep(best);
}

void MergeQueue::merge(uint32_t a, uint32_t b)
{
    parent_[b] = a;
    ++age_[a];
    clusters_.sums[a] = clusters_.sums[a] + clusters_.sums[b];
    Vector<uint32_t> &all = touching_[a];
    all.insert(all.end(), touching_[b].begin(), touching_[b].end());
    touching_[b] = {};
    for (uint32_t &c : all)
        c = root(c);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    all.erase(std::find(all.begin(), all.end(), a));
    look(a);
    for (uint32_t other : all) {
        const Offer one = offer(other, a);
        if (one.is_before(best_[other]))
            keep(one);
    }
}

Vector<uint32_t> MergeQueue::run()
{
    const auto count = uint32_t(clusters_.size());
    for (uint32_t c = 0; c < count; ++c)
        look(c);
    while (!queue_.empty()) {
        const Offer o = queue_.top();
        const Offer &best = best_[o.owner];
        queue_.pop();
        if (is_now(o.a, o.age_a) && is_now(o.b, o.age_b))
            merge(o.a, o.b);
        else if (parent_[o.owner] == o.owner && best.a == o.a && best.b == o.b &&
                 best.age_a == o.age_a && best.age_b == o.age_b)
            look(o.owner);
    }
    Vector<uint32_t> renamed(count);
    uint32_t kept = 0;
    for (uint32_t c = 0; c < count; ++c) {
        if (root(c) == c) {
            clusters_.sums[kept] = clusters_.sums[c];
            renamed[c] = kept++;
        } else {
            renamed[c] = renamed[root(c)]; /* the lower number stays the root */
        }
    }
    clusters_.sums.resize(kept);
    return renamed;
}

} // namespace

Vector<uint32_t> agglomerate(const Surface &surface, uint32_t &count, Task &task)
{
    Clusters clusters = single_triangles(surface);
    Vector<uint32_t> labels = surface.whole.triangles;
    auto rename = [&](const Vector<uint32_t> &renamed) {
        task.in_parts(labels.size(), task.parts(labels.size(), CHUNK),
                      [&](size_t, size_t from, size_t to) {
            for (size_t t = from; t < to; ++t)
                labels[t] = renamed[labels[t]];
        });
    };
    for (size_t before = SIZE_MAX; clusters.size() > QUEUED_CLUSTERS && clusters.size() < before;) {
        before = clusters.size();
        rename(merge_pairs(clusters, match(cheapest_partners(clusters, task), task), task));
        task.advance(0.4 * (1 - double(clusters.size()) / double(labels.size())));
    }
    rename(MergeQueue(clusters).run());
    move_borders(surface, clusters.size(), labels, task);
    absorb_islands(surface, clusters.size(), labels);
    count = connected_pieces(surface.whole, labels);
    return labels;
}

} // namespace gtx
