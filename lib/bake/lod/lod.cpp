/* The LOD meshes: how many, how fine, and the order of their triangles. */
#include "bake/lod/bound.hpp"
#include "bake/lod/parts.hpp"
#include "base/exact.h"
#include "bake/lod/strip.hpp"

#include <algorithm>
#include <map>

namespace gtx::baking {

using Place = std::array<uint16_t, 3>; /* of a vertex, in steps */

/* Measured with five levels of bunny, Spot's control mesh and the truck, at half and at double. */

/* Triangles of the source for one of the finest level: fills the bytes that an LOD mesh may take.
 * Bunny: 82 % more triangles | 51 % fewer. */
constexpr size_t FINEST_RATIO = 9;
/* Models of so many triangles, with normals alone, get a level of a share of their own first, which
 * is drawn however near: no search in maps is faster than what so few triangles take. Bunny: 16 %
 * more bytes, and near views take .6 of the mesh's time; as many triangles as the source has, 39 %
 * more | a third of them, and the level strays twice as far. Half as many models have it with a
 * SMALL of half; a TINY of half and less has it in toys, whose meshes are fast enough. */
constexpr size_t SMALL = 1 << 17, TINY = 1 << 15;
constexpr size_t SMALL_RATIO = 2;
/* Triangles of a level for one of the next: five levels then reach from windows of a million pixels
 * to models of a hundred across. Bunny: two levels fewer at half. */
constexpr double LEVEL_RATIO = 2.2;
/* A level is worth its bytes when it has at most this share of them. Bunny: two levels fewer |
 * Spot: four more. */
constexpr double MAX_SHARE = 0.75;
/* Positions are rounded to this part of a texel: 0.7 % bytes either way (bunny). */
constexpr double STEP = 1.0 / 16;
/* An error that nobody sees, the maps know no better: that of rounding. In texels. */
constexpr double FREE_ERROR = STEP;
/* What is seen from so far that this is a pixel is a handful of pixels. Share of the diagonal.
 * Truck: 64 % more triangles | Spot: 54 % fewer. */
constexpr double MAX_ERROR = 1.0 / 64;
/* The coarsest level beyond, for models of ten to twenty pixels, and how far it may stray. Spot:
 * one level more | one fewer; MAX_FAR_ERROR: error +13 % | a few bytes. */
constexpr double FAR_TRIANGLES = 160, MAX_FAR_ERROR = 1.0 / 20;
/* Parts of the source that are no longer than so many times the error that merging measured may be
 * missing: far levels go without those that have become no longer than that error, and specks of a
 * scan merge into nothing. At 1 specks of the dragon of 810,080 triangles make the error of its
 * second level nine times as large. */
constexpr double SPECK = 2;
/* How many lead there: a limit. And triangles of one for one of the next where fewer of them do;
 * Spot: one level fewer at half, a few bytes at double. */
constexpr unsigned FAR_LEVELS = 3;
constexpr double FAR_RATIO = 2.5;

Vector<PatchRegion> patch_regions(const Maps &maps, Task &task)
{
    Vector<PatchRegion> regions(maps.patches.size());
    task.parallel(regions.size(), [&](size_t p) {
        regions[p] = PatchRegion(maps, uint32_t(p));
    }, 0, 0);
    return regions;
}

/* Texels of a mean patch are so far apart. */
static double mean_pitch(const Maps &maps)
{
    double area = 0, texels = 0;
    for (const gtx_patch &p : maps.patches) {
        area += double(p.extent_x) * p.extent_y;
        texels += double(p.rect[2]) * p.rect[3];
    }
    return std::sqrt(area / texels);
}

/* The places that positions are rounded to. */
struct Lattice {
    float origin[3] = {0, 0, 0}, step = 0;

    Lattice(const Vector<Vec3d> &points, double wanted)
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
    Place round(const Vec3d &point) const
    {
        Place place;
        for (int k = 0; k < 3; ++k)
            place[k] = uint16_t(
                std::clamp(std::floor((point[k] - origin[k]) / step + 0.5), 0.0, 65535.0));
        return place;
    }
    Vec3d point(const Place &place) const
    {
        return {origin[0] + double(step) * place[0], origin[1] + double(step) * place[1],
                origin[2] + double(step) * place[2]};
    }
};

static bool collapses(const Triangle &t, const Vector<Place> &places)
{
    return places[t[0]] == places[t[1]] || places[t[1]] == places[t[2]] ||
           places[t[2]] == places[t[0]];
}

/* Whether a level may have the triangle: it has an area, and lies on the rectangle of its patch or
 * next to it. */
static bool fits(const PatchRegion &region, const Triangle &t, const Lattice &lattice,
                 const Vector<Place> &places)
{
    if (collapses(t, places))
        return false;
    for (uint32_t v : t)
        if (!region.near(region.place(lattice.point(places[v]))))
            return false;
    return true;
}

/* The patch of each triangle, or NO_PATCH where none may have it: a triangle that does not fit its
 * own goes to one that has a neighbour of it, for without it there would be a hole. */
static Vector<uint32_t> find_homes(const Simplifier &simplified,
                                   const Vector<PatchRegion> &regions,
                                   const Lattice &lattice, const Vector<Place> &places)
{
    const auto &triangles = simplified.triangles();
    Vector<uint32_t> homes = simplified.patch(), homeless;
    Vector<std::pair<uint32_t, uint32_t>> beside;      /* vertices, and patches that have them */
    for (uint32_t t = 0; t < triangles.size(); ++t) {
        if (fits(regions[homes[t]], triangles[t], lattice, places))
            continue;
        homes[t] = NO_PATCH;
        if (!collapses(triangles[t], places))
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
                if (fits(regions[at->second], triangles[t], lattice, places))
                    homes[t] = at->second;
    return homes;
}

static Vector<Place> round_all(const Simplifier &simplified, const Lattice &lattice)
{
    Vector<Place> places;
    for (const Vec3d &p : simplified.positions())
        places.push_back(lattice.round(p));
    return places;
}

/* `patch` has NO_PATCH for triangles that are left out. */
static LodLevel make_level(const Simplifier &simplified, const Vector<uint32_t> &patch,
                           const Vector<Place> &places, size_t patches,
                           const Lattice &lattice)
{
    const auto &triangles = simplified.triangles();
    Vector<Vector<uint32_t>> members(patches);
    for (size_t t = 0; t < triangles.size(); ++t)
        if (patch[t] != NO_PATCH && !collapses(triangles[t], places))
            members[patch[t]].push_back(uint32_t(t));

    LodLevel level;
    std::copy_n(lattice.origin, 3, level.origin);
    level.step = lattice.step;
    std::map<Place, uint32_t> name; /* of the vertex at a place */
    Vector<uint32_t> named(places.size(), NO_VERTEX);
    Vector<Triangle> ordered;
    Strip strip(triangles, patch, places.size());
    for (uint32_t p = 0; p < members.size(); ++p) {
        level.first.push_back(uint32_t(ordered.size()));
        strip.follow(p, members[p], ordered);
    }
    level.first.push_back(uint32_t(ordered.size()));
    for (const Triangle &t : ordered) {
        for (uint32_t v : t) {
            if (named[v] == NO_VERTEX) {
                const auto [at, is_new] = name.try_emplace(places[v], uint32_t(name.size()));
                if (is_new)
                    level.positions.insert(level.positions.end(), places[v].begin(),
                                           places[v].end());
                named[v] = at->second;
            }
            level.indices.push_back(named[v]);
        }
    }
    return level;
}

/* What all levels of an asset are made with. */
struct LodJob {
    const Maps &maps;
    const Vector<PatchRegion> &regions;
    const Lattice &lattice;
    const Bounds &bounds;
    Task &task;
};

/* Adds a level that the simplifier made, and says how far it strays: no less than a finer one. */
static void add_level(const LodJob &job, const Simplifier &simplifier, LodLevel &&level,
                      Vector<LodLevel> &lod)
{
    const double speck = SPECK * simplifier.error();
    const Strayed strayed = job.bounds.of(level, speck);
    level.error = std::nextafter(float(std::max(strayed.most, speck)), INFINITY);
    level.rms = float(strayed.rms);
    if (!lod.empty())
        level.error = std::max(level.error, lod.back().error);
    lod.push_back(std::move(level));
}

/* Takes away the parts that are no longer than the error; not all. */
static void drop_specks(Simplifier &simplifier)
{
    const Vector<double> sizes = part_sizes(simplifier.positions(), simplifier.triangles());
    Vector<uint8_t> specks;
    for (double size : sizes)
        specks.push_back(size <= simplifier.error());
    if (std::find(specks.begin(), specks.end(), 0) != specks.end())
        simplifier.drop(specks);
}

/* Goes on without regard to patches: where each is a pixel, a triangle may show several. */
static void add_far_levels(const LodJob &job, Simplifier &simplifier, double most,
                           Vector<LodLevel> &lod)
{
    simplifier.cross_patches();
    const double ways = gtx_log(double(simplifier.triangles().size()) / FAR_TRIANGLES);
    const unsigned count = unsigned(std::clamp(std::ceil(ways / gtx_log(FAR_RATIO)), 0.0,
                                               double(FAR_LEVELS)));
    for (unsigned k = count; k-- > 0;) {
        const double before = double(simplifier.triangles().size());
        const double ratio = gtx_pow(before / FAR_TRIANGLES, 1.0 / (k + 1));
        simplifier.reduce(size_t(before / ratio), 0, most);
        simplifier.settle();
        drop_specks(simplifier);
        if (double(simplifier.triangles().size()) > MAX_SHARE * before)
            return;
        const Vector<uint32_t> homes =
            find_far_homes(simplifier, job.maps, job.regions, job.task);
        LodLevel level = make_level(simplifier, homes, round_all(simplifier, job.lattice),
                                    job.regions.size(), job.lattice);
        level.far = true;
        if (level.indices.empty())
            return;
        add_level(job, simplifier, std::move(level), lod);
    }
}

} // namespace gtx::baking

namespace gtx {

using namespace baking;

Vector<LodLevel> make_lod(const LodSource &source, const Maps &maps, unsigned levels,
                          Task &task)
{
    task.begin("lod");
    Vector<LodLevel> lod;
    if (source.triangles.empty() || !levels)
        return lod;
    const Vector<PatchRegion> regions = patch_regions(maps, task);
    const double pitch = mean_pitch(maps);
    const Lattice lattice(source.positions, STEP * pitch);
    Vec3d size;
    for (int k = 0; k < 3; ++k)
        size[k] = double(maps.bounds_max[k]) - maps.bounds_min[k];
    const double free = FREE_ERROR * pitch;
    Simplifier simplifier(source, regions, task);
    const Bounds bounds(source, pitch, task);
    const LodJob job = {maps, regions, lattice, bounds, task};
    const size_t model = source.model ? source.model : source.triangles.size();
    const bool finer = model > TINY && model <= SMALL && maps.color.empty() &&
                       maps.material.empty() && maps.emission.empty();
    size_t wanted = model / (finer ? SMALL_RATIO : FINEST_RATIO);
    for (unsigned k = 0; k < levels; ++k) {
        const size_t before = simplifier.triangles().size();
        simplifier.reduce(wanted, k ? 0 : free, MAX_ERROR * length(size));
        if (k && double(simplifier.triangles().size()) > MAX_SHARE * double(before))
            break;
        simplifier.settle();
        const Vector<Place> places = round_all(simplifier, lattice);
        LodLevel level =
            make_level(simplifier, find_homes(simplifier, regions, lattice, places), places,
                       regions.size(), lattice);
        if (level.indices.empty())
            break;
        add_level(job, simplifier, std::move(level), lod);
        wanted = size_t(double(simplifier.triangles().size()) / LEVEL_RATIO);
        if (finer && k == 0)
            wanted = model / FINEST_RATIO;
    }
    add_far_levels(job, simplifier, MAX_FAR_ERROR * length(size), lod);
    return lod;
}

} // namespace gtx
