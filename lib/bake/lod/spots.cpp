/* Splits triangles of a level where the source has a point far from them. */
#include "bake/lod/spots.hpp"
#include "bake/lod/outlier.hpp"

#include <algorithm>
#include <map>

namespace gtx::baking {

/* How often half the way is tried; at 1 errors of two of the dragon's levels are 15 and 24 %
 * larger, and of one of the bunny's 45. */
constexpr int MOVE_STEPS = 3;

namespace {

/* A triangle that becomes several: each has a new vertex for one of these corners. */
struct Split {
    uint32_t triangle;
    Vector<int> corners;
};

/* Triangles change once: what is beside them is then known no more. */
class Reach {
public:
    Reach(LevelMesh &mesh, const Vector<PatchRegion> &regions, const Lattice &lattice,
          double most, const Vector<FarPoint> &spots);

    /* As far as it can be. */
    void reach(const FarPoint &spot);
    /* The triangles that changed, as they were. */
    Vector<Corners> changed;

private:
    Corners corners(const Triangle &t) const { return mesh_.corners(t, lattice_); }
    bool keeps(uint32_t vertex) const { return !mesh_.kept.empty() && mesh_.kept[vertex]; }
    bool turns(const Triangle &part, const Corners &whole) const;
    bool suits(const Triangle &part, const Corners &whole, uint32_t patch) const;
    bool split(const Vector<Split> &splits, const FarPoint &spot);
    bool split_edge(const FarPoint &spot, int corner);
    bool move(uint32_t vertex, Vec3d way);

    LevelMesh &mesh_;
    const Vector<PatchRegion> &regions_;
    const Lattice &lattice_;
    double most_;
    std::map<uint32_t, Vector<uint32_t>> around_;   /* vertices of triangles that are near spots */
    Vector<uint8_t> done_;                          /* of each triangle there was */
};

Reach::Reach(LevelMesh &mesh, const Vector<PatchRegion> &regions, const Lattice &lattice,
             double most, const Vector<FarPoint> &spots)
    : mesh_(mesh), regions_(regions), lattice_(lattice), most_(most),
      done_(mesh.triangles.size(), 0)
{
    Vector<uint8_t> near(mesh.places.size(), 0);
    for (const FarPoint &spot : spots)
        for (uint32_t v : mesh.triangles[spot.near])
            near[v] = 1;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (uint32_t v : mesh.triangles[t])
            if (near[v] && mesh.patch[t] != NO_PATCH)
                around_[v].push_back(t);
}

bool Reach::turns(const Triangle &part, const Corners &whole) const
{
    const Corners c = corners(part);
    const Vec3d was = cross(whole[1] - whole[0], whole[2] - whole[0]);
    const Vec3d is = cross(c[1] - c[0], c[2] - c[0]);
    return dot(was, is) <= MIN_TURN_COSINE * std::sqrt(dot(was, was) * dot(is, is));
}

/* Whether the patch shows it as well as another triangle. */
bool Reach::suits(const Triangle &part, const Corners &other, uint32_t patch) const
{
    return mesh_.fits(regions_[patch], part, lattice_) &&
           regions_[patch].keeps(other, corners(part), false);
}

/* All of them or none. A part that the patch of the triangle cannot show goes to that of the
 * source. */
bool Reach::split(const Vector<Split> &splits, const FarPoint &spot)
{
    struct Part {
        uint32_t whole, patch;
        Triangle corners;
    };
    const uint32_t vertex = uint32_t(mesh_.places.size());
    Vector<Part> parts;
    mesh_.places.push_back(lattice_.round(spot.at));
    bool all = true;
    for (const Split &s : splits)
        for (int corner : s.corners) {
            Part part = {s.triangle, mesh_.patch[s.triangle], mesh_.triangles[s.triangle]};
            const Corners whole = corners(part.corners);
            part.corners[corner] = vertex;
            all = all && (!turns(part.corners, whole) || !turns(part.corners, spot.source));
            if (!suits(part.corners, whole, part.patch)) {
                part.patch = spot.patch;
                all = all && suits(part.corners, spot.source, part.patch);
            }
            parts.push_back(part);
        }
    if (!all) {
        mesh_.places.pop_back();
        return false;
    }
    if (!mesh_.kept.empty())
        mesh_.kept.push_back(0);
    for (const Part &part : parts) {
        uint32_t t = part.whole;
        if (!done_[t]) {
            changed.push_back(corners(mesh_.triangles[t]));
        } else { /* its place has the first part */
            t = uint32_t(mesh_.triangles.size());
            mesh_.triangles.emplace_back();
            mesh_.patch.emplace_back();
        }
        mesh_.triangles[t] = part.corners;
        mesh_.patch[t] = part.patch;
        done_[part.whole] = 1;
    }
    return true;
}

/* All triangles that have the edge opposite to a corner. */
bool Reach::split_edge(const FarPoint &spot, int corner)
{
    const Triangle &near = mesh_.triangles[spot.near];
    const uint32_t a = near[(corner + 1) % 3], b = near[(corner + 2) % 3];
    if (keeps(a) && keeps(b))
        return false;
    Vector<Split> splits;
    for (uint32_t t : around_.at(a)) {
        const Triangle &beside = mesh_.triangles[t];
        if (done_[t]) /* the edge may be gone */
            return false;
        if (corner_of(beside, b) >= 0)
            splits.push_back({t, {corner_of(beside, a), corner_of(beside, b)}});
    }
    return split(splits, spot);
}

/* Less far where its triangles need it. */
bool Reach::move(uint32_t vertex, Vec3d way)
{
    const Vector<uint32_t> &around = around_.at(vertex);
    bool all = !keeps(vertex);
    for (uint32_t t : around)
        all = all && !done_[t];
    if (!all)
        return false;
    Vector<Corners> before;
    for (uint32_t t : around)
        before.push_back(corners(mesh_.triangles[t]));
    const Place was = mesh_.places[vertex];
    for (int n = 0; n < MOVE_STEPS; ++n, way = way * 0.5) {
        mesh_.places[vertex] = lattice_.round(lattice_.point(was) + way);
        all = mesh_.places[vertex] != was;
        for (size_t i = 0; i < around.size() && all; ++i) {
            const uint32_t t = around[i];
            all = !turns(mesh_.triangles[t], before[i]) &&
                  suits(mesh_.triangles[t], before[i], mesh_.patch[t]);
        }
        if (all)
            break;
    }
    if (!all) {
        mesh_.places[vertex] = was;
        return false;
    }
    for (uint32_t t : around)
        done_[t] = 1;
    changed.insert(changed.end(), before.begin(), before.end());
    return true;
}

void Reach::reach(const FarPoint &spot)
{
    if (done_[spot.near])
        return;
    if (spot.vertex != NO_VERTEX) {
        move(spot.vertex, spot.at - lattice_.point(mesh_.places[spot.vertex]));
        return;
    }
    const Triangle &near = mesh_.triangles[spot.near];
    const std::array<double, 3> share = nearest_shares(corners(near), spot.at);
    const auto [low, high] = std::minmax_element(share.begin(), share.end());
    if (*high == 1) { /* beyond a corner: others are near that, which does not go all the way */
        const uint32_t vertex = near[high - share.begin()];
        const Vec3d way = spot.at - lattice_.point(mesh_.places[vertex]);
        if (move(vertex, way * (1 - 0.5 * most_ / length(way))))
            return;
    }
    if (!split_edge(spot, int(low - share.begin())))
        split({{spot.near, {0, 1, 2}}}, spot);
}

} // namespace

Vector<Corners> reach_spots(LevelMesh &mesh, Vector<FarPoint> spots, double most,
                            const Vector<PatchRegion> &regions, const Lattice &lattice)
{
    std::stable_sort(spots.begin(), spots.end(), [](const FarPoint &a, const FarPoint &b) {
        return a.away > b.away;
    });
    Reach all(mesh, regions, lattice, most, spots);
    for (const FarPoint &spot : spots)
        all.reach(spot);
    return std::move(all.changed);
}

} // namespace gtx::baking
