/* Rounds what a simplifier left, finds a patch for each triangle, and puts them in order. */
#include "bake/lod/level.hpp"
#include "bake/lod/strip.hpp"

#include <algorithm>
#include <cmath>

namespace gtx::baking {

Lattice::Lattice(const Vector<Vec3d> &points, double wanted)
{
    Vec3d low = points[0], high = low;
    for (const Vec3d &p : points) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    const Vec3d size = high - low;
    step = float(std::max(wanted, std::max({size.x, size.y, size.z}) / 65534));
    store(origin, low);
}

Place Lattice::round(const Vec3d &point) const
{
    Place place;
    for (int k = 0; k < 3; ++k)
        place[k] = uint16_t(
            std::clamp(std::floor((point[k] - origin[k]) / step + 0.5), 0.0, 65535.0));
    return place;
}

bool LevelMesh::empty() const
{
    for (size_t t = 0; t < triangles.size(); ++t)
        if (patch[t] != NO_PATCH && !collapses(triangles[t]))
            return false;
    return true;
}

bool LevelMesh::fits(const PatchRegion &region, const Triangle &t, const Lattice &lattice) const
{
    if (collapses(t))
        return false;
    for (uint32_t v : t)
        if (!region.near(region.place(lattice.point(places[v]))))
            return false;
    return true;
}

static LevelMesh rounded(const Simplifier &simplified, const Lattice &lattice)
{
    LevelMesh mesh = {simplified.triangles(), simplified.patch(), {}, simplified.kept()};
    for (const Vec3d &p : simplified.positions())
        mesh.places.push_back(lattice.round(p));
    return mesh;
}

/* A triangle that does not fit its patch goes to one that has a neighbour of it, for without it
 * there would be a hole. */
LevelMesh level_mesh(const Simplifier &simplified, const Vector<PatchRegion> &regions,
                     const Lattice &lattice)
{
    LevelMesh mesh = rounded(simplified, lattice);
    const auto &triangles = mesh.triangles;
    Vector<uint32_t> &homes = mesh.patch, homeless;
    Vector<std::pair<uint32_t, uint32_t>> beside;      /* vertices, and patches that have them */
    for (uint32_t t = 0; t < triangles.size(); ++t) {
        if (mesh.fits(regions[homes[t]], triangles[t], lattice))
            continue;
        homes[t] = NO_PATCH;
        if (!mesh.collapses(triangles[t]))
            homeless.push_back(t);
    }
    for (uint32_t t = 0; t < triangles.size() && !homeless.empty(); ++t)
        for (uint32_t v : triangles[t])
            if (homes[t] != NO_PATCH)
                beside.push_back({v, homes[t]});
    std::sort(beside.begin(), beside.end());
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    for (uint32_t t : homeless)
        for (uint32_t v : triangles[t])
            for (auto at = std::lower_bound(beside.begin(), beside.end(), std::make_pair(v, 0u));
                 homes[t] == NO_PATCH && at != beside.end() && at->first == v; ++at)
                if (mesh.fits(regions[at->second], triangles[t], lattice))
                    homes[t] = at->second;
    return mesh;
}

LevelMesh far_level_mesh(const Simplifier &simplified, const Maps &maps,
                         const Vector<PatchRegion> &regions, const Lattice &lattice, Task &task)
{
    LevelMesh mesh = rounded(simplified, lattice);
    mesh.patch = find_far_homes(simplified, maps, regions, task);
    return mesh;
}

/* Of each vertex the first one that has its place. */
static Vector<uint32_t> first_there(const Vector<Place> &places)
{
    Vector<std::pair<uint64_t, uint32_t>> all;
    all.reserve(places.size());
    for (const auto &[x, y, z] : places)
        all.push_back({uint64_t(x) << 32 | uint64_t(y) << 16 | z, uint32_t(all.size())});
    std::sort(all.begin(), all.end());
    Vector<uint32_t> first(places.size());
    for (size_t i = 0, same = 0; i < all.size(); ++i) {
        same = all[i].first == all[same].first ? same : i;
        first[all[i].second] = all[same].second;
    }
    return first;
}

LodLevel stored(const LevelMesh &mesh, size_t patches, const Lattice &lattice)
{
    const auto &[corners, patch, places, kept] = mesh;
    const Vector<uint32_t> first = first_there(places);
    Vector<Triangle> triangles = corners;
    for (Triangle &t : triangles)
        for (uint32_t &v : t)
            v = first[v];
    Vector<Vector<uint32_t>> members(patches);
    for (size_t t = 0; t < triangles.size(); ++t)
        if (patch[t] != NO_PATCH && !mesh.collapses(triangles[t]))
            members[patch[t]].push_back(uint32_t(t));

    LodLevel level;
    std::copy_n(lattice.origin, 3, level.origin);
    level.step = lattice.step;
    Vector<uint32_t> name(places.size(), NO_VERTEX);
    Vector<Triangle> ordered;
    Strip strip(triangles, patch, places.size());
    for (uint32_t p = 0; p < members.size(); ++p) {
        level.first.push_back(uint32_t(ordered.size()));
        strip.follow(p, members[p], ordered);
    }
    level.first.push_back(uint32_t(ordered.size()));
    for (const Triangle &t : ordered) {
        for (uint32_t v : t) {
            uint32_t &n = name[v];
            if (n == NO_VERTEX) {
                n = uint32_t(level.positions.size() / 3);
                level.positions.insert(level.positions.end(), places[v].begin(), places[v].end());
            }
            level.indices.push_back(n);
        }
    }
    return level;
}

} // namespace gtx::baking
