/* Variational shape approximation (Cohen-Steiner, Alliez, Desbrun 2004), metric L2,1.
 *
 * Lloyd's algorithm: grow all clusters at once, best triangle first, then refit each cluster's
 * proxy. Seeds come from above: the clusters of largest error get a second one where they fit
 * least, until there are enough. Nothing is random. */
#include "chart/vsa.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace gtx {

namespace {

/* Of a partition, and of a region split in two. Half: RMS +6 % (bunny), +1 % (Spot); double: RMS -2
 * % (bunny), patches -3 % (Spot) for twice the time. */
constexpr int LLOYD_ITERATIONS = 10, PAIR_ITERATIONS = 3;
/* Mean clusters between the first seeds: time against the choice of the rest. Half: RMS +3 %,
 * patches -5 %; double: RMS +5 %, patches +2 % (Spot). */
constexpr double SEED_STEPS = 8;
/* Weight of the distance from a cluster's centre, in radii of an average cluster. Normals alone
 * make snakes along creases, and one long chart sets the texel density of the whole model. Half:
 * patches +3 %; double: texels +22 % (Spot). */
constexpr float COMPACTNESS = 0.01f;

/* A priority queue of 2048 buckets, 32 an octave: the order of nearly equal errors does not
 * matter, and a heap costs twice the time. Last in, first out within a bucket. */
class BucketQueue {
public:
    struct Entry {
        uint32_t triangle, cluster, next;
    };

    void push(float key, uint32_t triangle, uint32_t cluster)
    {
        if (!free_) { /* places are used again at once, which keeps them in the cache */
            entries_.push_back({});
            free_ = uint32_t(entries_.size());
        }
        uint32_t place = free_;
        Entry &entry = entries_[place - 1];
        free_ = entry.next;
        size_t b = bucket(key);
        entry = {triangle, cluster, heads_[b]};
        heads_[b] = place;
        used_[b / 64] |= uint64_t(1) << b % 64;
    }

    bool pop(Entry &out)
    {
        for (size_t word = 0; word < WORDS; ++word) {
            if (!used_[word])
                continue;
            size_t b = word * 64;
            for (uint64_t bits = used_[word]; !(bits & 1); bits >>= 1)
                ++b;
            uint32_t place = heads_[b];
            out = entries_[place - 1];
            entries_[place - 1].next = free_;
            free_ = place;
            heads_[b] = out.next;
            if (!out.next)
                used_[word] &= ~(uint64_t(1) << b % 64);
            return true;
        }
        return false;
    }

private:
    static constexpr size_t BUCKETS = 2048, WORDS = BUCKETS / 64;
    static constexpr uint32_t LOWEST = (127 - 52) << 5; /* 2^-52: errors are around 1 */

    static size_t bucket(float key)
    {
        uint32_t bits;
        std::memcpy(&bits, &key, 4);
        uint32_t place = bits >> 18;
        return place <= LOWEST ? 0 : std::min<size_t>(place - LOWEST, BUCKETS - 1);
    }

    Vector<Entry> entries_;      /* places count from 1; 0 ends a list */
    uint32_t free_ = 0;
    uint32_t heads_[BUCKETS] = {};
    uint64_t used_[WORDS] = {};
};

class Clustering {
public:
    /* `clusters` sets the length scale of compactness. */
    Clustering(const Surface &surface, const Region &region, double clusters)
        : nodes_(region.size())
    {
        double size = 0;
        for (size_t i = 0; i < region.size(); ++i) {
            const Facet &facet = surface.facets[region.triangles[i]];
            nodes_[i] = {facet, region.neighbours[i], 0};
            size += facet.size;
        }
        spread_ = COMPACTNESS / float(size / clusters / M_PI);
    }

    void add_seed(uint32_t local)
    {
        clusters_.push_back({nodes_[local].facet.normal, nodes_[local].facet.centre, local});
    }

    void grow();
    void refit();
    void add_worst_seeds(size_t wanted);

    size_t count() const { return clusters_.size(); }
    Vector<uint32_t> labels() const
    {
        Vector<uint32_t> out;
        for (const Node &node : nodes_)
            out.push_back(node.label);
        return out;
    }

private:
    /* A triangle, in one line of the cache: growing is nothing but reaching for them. */
    struct alignas(16) Node {
        Facet facet;
        std::array<uint32_t, 3> neighbours;
        uint32_t label;
    };

    float error(const Facet &facet, const Cluster &cluster) const
    {
        Vec3f dn = facet.normal - cluster.normal, dc = facet.centre - cluster.centre;
        return facet.size * (dot(dn, dn) + spread_ * dot(dc, dc));
    }

    Vector<Node> nodes_;
    float spread_;
    Vector<Cluster> clusters_;
};

void Clustering::grow()
{
    /* A label, or OPEN and the cluster that offered last: half of all offers repeat that. */
    constexpr uint32_t OPEN = 1u << 31;
    for (Node &node : nodes_)
        node.label = NO_TRIANGLE;
    BucketQueue queue;
    auto take = [&](uint32_t local, uint32_t label) {
        nodes_[local].label = label;
        for (uint32_t n : nodes_[local].neighbours) {
            if (n == NO_TRIANGLE || !(nodes_[n].label & OPEN) || nodes_[n].label == (OPEN | label))
                continue;
            nodes_[n].label = OPEN | label;
            queue.push(error(nodes_[n].facet, clusters_[label]), n, label);
        }
    };
    for (uint32_t c = 0; c < clusters_.size(); ++c)
        nodes_[clusters_[c].seed].label = c;
    for (uint32_t c = 0; c < clusters_.size(); ++c)
        take(clusters_[c].seed, c);
    BucketQueue::Entry entry;
    while (queue.pop(entry))
        if (nodes_[entry.triangle].label & OPEN)
            take(entry.triangle, entry.cluster);
}

/* The L2,1 proxy of a cluster is its area-weighted mean normal; it grows again from the triangle
 * that fits best. */
void Clustering::refit()
{
    struct Sum {
        Vec3d normal, centre;
        double size = 0, error = 0;
        float best = INFINITY, worst = -1;
    };
    Vector<Sum> sums(count());
    for (const Node &node : nodes_) {
        Sum &sum = sums[node.label];
        double size = node.facet.size;
        sum.normal += Vec3d(node.facet.normal) * size;
        sum.centre += Vec3d(node.facet.centre) * size;
        sum.size += size;
    }
    for (size_t c = 0; c < count(); ++c) {
        clusters_[c].normal = Vec3f(normalize(sums[c].normal));
        clusters_[c].centre = Vec3f(sums[c].centre / sums[c].size);
    }
    for (uint32_t i = 0; i < nodes_.size(); ++i) {
        const Node &node = nodes_[i];
        Cluster &cluster = clusters_[node.label];
        Sum &sum = sums[node.label];
        float e = error(node.facet, cluster), density = e / node.facet.size;
        sum.error += e;
        if (e < sum.best) {
            sum.best = e;
            cluster.seed = i;
        }
        if (density > sum.worst) {
            sum.worst = density;
            cluster.worst = i;
        }
    }
    for (size_t c = 0; c < count(); ++c)
        clusters_[c].error = float(sums[c].error);
}

/* A second seed for the clusters with more than their share of the error. */
void Clustering::add_worst_seeds(size_t wanted)
{
    Vector<uint32_t> order(count());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        float ea = clusters_[a].error, eb = clusters_[b].error;
        return ea != eb ? ea > eb : a < b;
    });
    double total = 0;
    for (const Cluster &c : clusters_)
        total += c.error;
    order.resize(std::min(order.size(), wanted - count()));
    for (uint32_t c : order)
        if (clusters_[c].worst != clusters_[c].seed && clusters_[c].error * double(wanted) >= total)
            add_seed(clusters_[c].worst);
}

/* A seed for each connected piece, and some more along the order of the triangles, to save the
 * first rounds. Returns how many pieces are so small beside a cluster of `mean` size that they are
 * not to take its place. */
uint32_t seed_pieces(const Surface &surface, const Region &region, uint32_t wanted,
                     Clustering &clustering)
{
    Vector<uint32_t> pieces(region.size(), 0);
    Vector<double> size(connected_pieces(region, pieces));
    double mean = double(region.size()) / wanted;
    for (uint32_t i = 0, next = 0, step = 0; i < region.size(); ++i, ++step) {
        size[pieces[i]] += surface.facets[region.triangles[i]].size;
        if (pieces[i] != next && step < SEED_STEPS * mean)
            continue;
        next += pieces[i] == next;
        step = 0;
        clustering.add_seed(i);
    }
    return uint32_t(std::count_if(size.begin(), size.end(),
                                  [=](double s) { return s < 0.5 * mean; }));
}

} // namespace

Vector<uint32_t> cluster(const Surface &surface, const Region &region, uint32_t &count,
                         Task &task)
{
    Clustering clustering(surface, region, count);
    count += seed_pieces(surface, region, count, clustering);
    for (size_t before = 0; clustering.count() < count && clustering.count() > before;) {
        before = clustering.count();
        clustering.grow();
        clustering.refit();
        clustering.add_worst_seeds(count);
        task.advance(0.3 * double(clustering.count()) / double(count));
    }
    for (int i = 0; i < LLOYD_ITERATIONS; ++i) {
        clustering.grow();
        clustering.refit();
        task.advance(0.3 + 0.4 * i / LLOYD_ITERATIONS);
    }
    count = uint32_t(clustering.count());
    return clustering.labels();
}

Vector<uint32_t> cluster_pair(const Surface &surface, const Region &region, uint32_t a,
                              uint32_t b)
{
    Clustering clustering(surface, region, 2);
    clustering.add_seed(a);
    clustering.add_seed(b);
    for (int i = 0; i < PAIR_ITERATIONS; ++i) {
        if (i)
            clustering.refit();
        clustering.grow();
    }
    return clustering.labels();
}

} // namespace gtx
