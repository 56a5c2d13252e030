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

constexpr int LLOYD_ITERATIONS = 10;
constexpr int PAIR_ITERATIONS = 3;
/* Weight of the distance from a cluster's centre, in radii of an average cluster. Normals alone
 * make snakes along creases, and one long chart sets the texel density of the whole model. */
constexpr float COMPACTNESS = 0.01f;

/* A priority queue of 2048 buckets, 32 an octave: the order of nearly equal errors does not
 * matter, and a heap costs twice the time. Last in, first out within a bucket. */
class BucketQueue {
public:
    struct Entry {
        uint32_t triangle, cluster, next;
    };

    explicit BucketQueue(size_t capacity) { entries_.reserve(capacity); }

    void push(float key, uint32_t triangle, uint32_t cluster)
    {
        size_t b = bucket(key);
        entries_.push_back({triangle, cluster, heads_[b]});
        heads_[b] = uint32_t(entries_.size());
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
            out = entries_[heads_[b] - 1];
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

    std::vector<Entry> entries_; /* indices from 1; 0 ends a list */
    uint32_t heads_[BUCKETS] = {};
    uint64_t used_[WORDS] = {};
};

class Clustering {
public:
    /* `clusters` sets the length scale of compactness. */
    Clustering(const Surface &surface, const Region &region, double clusters)
        : surface_(surface), region_(region), labels_(region.size())
    {
        double size = 0;
        for (uint32_t t : region.triangles)
            size += surface.size[t];
        spread_ = COMPACTNESS / float(size / clusters / 3.14159265);
    }

    void add_seed(uint32_t local)
    {
        uint32_t t = region_.triangles[local];
        clusters_.push_back({surface_.smooth[t], surface_.centre[t], local});
    }

    void grow();
    void refit();
    void add_worst_seeds(size_t wanted);

    size_t count() const { return clusters_.size(); }
    std::vector<uint32_t> take_labels() { return std::move(labels_); }

private:
    float error(uint32_t local, const Cluster &cluster) const
    {
        uint32_t t = region_.triangles[local];
        Vec3f dn = surface_.smooth[t] - cluster.normal;
        Vec3f dc = surface_.centre[t] - cluster.centre;
        return surface_.size[t] * (dot(dn, dn) + spread_ * dot(dc, dc));
    }

    const Surface &surface_;
    const Region &region_;
    float spread_;
    std::vector<uint32_t> labels_;
    std::vector<Cluster> clusters_;
};

void Clustering::grow()
{
    std::fill(labels_.begin(), labels_.end(), NO_TRIANGLE);
    BucketQueue queue(region_.size() * 2);
    auto take = [&](uint32_t local, uint32_t label) {
        labels_[local] = label;
        for (uint32_t n : region_.neighbours[local])
            if (n != NO_TRIANGLE && labels_[n] == NO_TRIANGLE)
                queue.push(error(n, clusters_[label]), n, label);
    };
    for (uint32_t c = 0; c < clusters_.size(); ++c)
        labels_[clusters_[c].seed] = c;
    for (uint32_t c = 0; c < clusters_.size(); ++c)
        take(clusters_[c].seed, c);
    BucketQueue::Entry entry;
    while (queue.pop(entry))
        if (labels_[entry.triangle] == NO_TRIANGLE)
            take(entry.triangle, entry.cluster);
}

/* The L2,1 proxy of a cluster is its area-weighted mean normal; it grows again from the triangle
 * that fits best. */
void Clustering::refit()
{
    std::vector<Vec3d> normal(count()), centre(count());
    std::vector<double> size(count());
    for (size_t i = 0; i < region_.size(); ++i) {
        uint32_t t = region_.triangles[i], c = labels_[i];
        normal[c] += Vec3d(surface_.smooth[t]) * double(surface_.size[t]);
        centre[c] += Vec3d(surface_.centre[t]) * double(surface_.size[t]);
        size[c] += surface_.size[t];
    }
    std::vector<float> best(count(), INFINITY), most(count(), -1.f);
    std::vector<double> sum(count());
    for (size_t c = 0; c < count(); ++c) {
        clusters_[c].normal = Vec3f(normalize(normal[c]));
        clusters_[c].centre = Vec3f(centre[c] / size[c]);
        clusters_[c].worst = clusters_[c].seed;
    }
    for (uint32_t i = 0; i < region_.size(); ++i) {
        uint32_t c = labels_[i];
        float e = error(i, clusters_[c]), density = e / surface_.size[region_.triangles[i]];
        sum[c] += e;
        if (e < best[c]) {
            best[c] = e;
            clusters_[c].seed = i;
        }
        if (density > most[c]) {
            most[c] = density;
            clusters_[c].worst = i;
        }
    }
    for (size_t c = 0; c < count(); ++c)
        clusters_[c].error = float(sum[c]);
}

/* A second seed for the clusters with more than their share of the error. */
void Clustering::add_worst_seeds(size_t wanted)
{
    std::vector<uint32_t> order(count());
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

/* A seed for each connected piece. Returns how many are so small beside a cluster of `mean` size
 * that they are not to take its place. */
uint32_t seed_pieces(const Surface &surface, const Region &region, double mean,
                     Clustering &clustering)
{
    std::vector<uint32_t> pieces(region.size(), 0);
    std::vector<double> size(connected_pieces(region, pieces));
    for (uint32_t i = 0, next = 0; i < region.size(); ++i) {
        size[pieces[i]] += surface.size[region.triangles[i]];
        if (pieces[i] == next) {
            clustering.add_seed(i);
            ++next;
        }
    }
    return uint32_t(std::count_if(size.begin(), size.end(),
                                  [=](double s) { return s < 0.5 * mean; }));
}

} // namespace

std::vector<uint32_t> cluster(const Surface &surface, const Region &region, uint32_t &count,
                              Task &task)
{
    Clustering clustering(surface, region, count);
    count += seed_pieces(surface, region, double(region.size()) / count, clustering);
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
    return clustering.take_labels();
}

std::vector<uint32_t> cluster_pair(const Surface &surface, const Region &region, uint32_t a,
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
    return clustering.take_labels();
}

} // namespace gtx
