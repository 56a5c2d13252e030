/* Which triangles of the source are near points. */
#include "bake/seam/near_source.hpp"

namespace gtx::baking {

/* Sides of cells in texels: time against how much of the source is found near. */
constexpr double SIDE = 2;
constexpr size_t HASH_BITS = 21;
/* What is told of squared distances above the largest one that counts. */
constexpr double BEYOND = 1.5;

gtx::Box NearSource::Triangles::box(size_t t) const
{
    gtx::Box box;
    for (const Vec3d &p : corners[t])
        box.add(p);
    return box;
}

double NearSource::Triangles::distance2(size_t t, const Vec3d &p, double) const
{
    return triangle_distance2(p, corners[t][0], corners[t][1], corners[t][2]);
}

NearSource::NearSource(const Job &job, double reach)
    : job_(job), reach_(reach), side_(SIDE * job.pitch), marked_(size_t(1) << HASH_BITS)
{
}

size_t NearSource::hash(const Cell &cell)
{
    uint64_t mixed = 0;
    for (int64_t coordinate : cell)
        mixed = (mixed ^ uint64_t(coordinate)) * 0x9e3779b97f4a7c15;
    return size_t(mixed >> (64 - HASH_BITS));
}

void NearSource::add(const Vec3d &point)
{
    marked_[hash({coordinate(point.x), coordinate(point.y), coordinate(point.z)})] = true;
}

bool NearSource::may_be_near(const std::array<Vec3d, 3> &corners) const
{
    constexpr double MANY = 64;  /* cells: a large triangle is not worth the search */
    Cell low, high;
    double count = 1;
    for (int k = 0; k < 3; ++k) {
        const auto [least, most] = std::minmax({corners[0][k], corners[1][k], corners[2][k]});
        low[size_t(k)] = coordinate(least - reach_);
        high[size_t(k)] = coordinate(most + reach_);
        count *= double(high[size_t(k)] - low[size_t(k)] + 1);
    }
    if (count > MANY)
        return true;
    for (int64_t z = low[2]; z <= high[2]; ++z)
        for (int64_t y = low[1]; y <= high[1]; ++y)
            for (int64_t x = low[0]; x <= high[0]; ++x)
                if (marked_[hash({x, y, z})])
                    return true;
    return false;
}

void NearSource::gather(Task &task)
{
    constexpr size_t CHUNK = 4096, TURNS = 16; /* of a short loop, for a triangle */
    const size_t count = job_.mesh.triangle_count(), chunks = (count + CHUNK - 1) / CHUNK;
    Vector<Vector<std::array<Vec3d, 3>>> found(chunks);
    task.parallel(chunks, [&](size_t n) {
        for (size_t t = n * CHUNK; t < std::min(count, (n + 1) * CHUNK); ++t) {
            std::array<Vec3d, 3> corners;
            for (size_t k = 0; k < 3; ++k)
                corners[k] = job_.mesh.position(t, int(k)) - job_.anchor;
            cancel_point(TURNS);
            if (may_be_near(corners))
                found[n].push_back(corners);
        }
    });
    for (const auto &some : found)
        triangles_.corners.insert(triangles_.corners.end(), some.begin(), some.end());
    tree_.emplace(triangles_, task, 1);
}

double NearSource::distance(const Vec3d &point, double enough, uint32_t &near,
                            size_t &looks) const
{
    const auto any = [](uint32_t) { return true; };
    double best = BEYOND * reach_ * reach_;
    if (near < triangles_.size())
        best = std::min(best, triangles_.distance2(near, point, best));
    return std::sqrt(tree_->nearer(best, point, &near, any, &looks, enough * enough));
}

bool NearSource::find_nearest(const Vec3d &point, Vec3d &nearest, size_t &looks) const
{
    uint32_t near = NO_TRIANGLE;
    if (!(distance(point, 0, near, looks) < reach_) || !looks || near == NO_TRIANGLE)
        return false;
    const std::array<Vec3d, 3> &corners = triangles_.corners[near];
    const std::array<double, 3> share = nearest_shares(corners, point);
    nearest = corners[0] * share[0] + corners[1] * share[1] + corners[2] * share[2];
    return true;
}

} // namespace gtx::baking
