/* The LOD meshes: how many, how fine, and the order of their triangles. */
#include "bake/lod/bound.hpp"
#include "bake/lod/spots.hpp"
#include "base/exact.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>

namespace gtx::baking {

/* Measured with five levels of bunny, Spot's control mesh and the truck, at half and at double. */

/* Triangles of the source for one of the finest level: fills the bytes that an LOD mesh may take.
 * Bunny: 82 % more triangles | 51 % fewer. */
constexpr size_t FINEST_RATIO = 9;
/* Models of so many triangles, with normals alone, get a level of a share of their own first, which
 * is drawn however near: no search in maps is faster than what so few triangles take. Bunny: 16 %
 * more bytes, and near views take .6 of the mesh's time; as many triangles as the source has, 39 %
 * more | a third of them, and the level strays twice as far. Half as many models have it with a
 * SMALL of half; a TINY of half and less has it in toys, whose meshes are fast enough. Others
 * follow by LEVEL_RATIO: with FINEST_RATIO next a file has 6 % fewer bytes, but a page of 640x480
 * reads and draws the finest, 40 % more of them. */
constexpr size_t SMALL = 1 << 17, TINY = 1 << 15;
constexpr size_t SMALL_RATIO = 2;
/* Triangles of a level for one of the next: five levels then reach from windows of a million pixels
 * to models of a hundred across. Bunny: two levels fewer at half. */
constexpr double LEVEL_RATIO = 2.2;
/* A level is worth its bytes when it has at most this share of them. Bunny: two levels fewer |
 * Spot: four more. */
constexpr double MAX_SHARE = 0.75;
/* Positions are rounded to this part of a texel. Bunny: 2 % more bytes | 1.8 % fewer, and the two
 * finest stray 5 % further. */
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

/* What all levels of an asset are made with. */
struct LodJob {
    const LodSource &source;
    const Maps &maps;
    const Vector<PatchRegion> &regions;
    const Lattice &lattice;
    double pitch, size;          /* of the texels, of the model */
    Task &task;
};

/* A level before its triangles are in order. */
struct MadeLevel {
    LevelMesh mesh;
    double speck;                /* parts that are no longer may be missing */
    bool far;                    /* these and the following as in LodLevel */
    float error = 0, rms = 0;
};

/* Levels on their way from who makes them to who finds their errors and to who stores them, all at
 * once: each has one thread for much of its time. */
class Line {
public:
    enum Step { MADE, BOUNDED, STEPS };

    void add(MadeLevel &&level)
    {
        std::lock_guard<std::mutex> lock(mutex_);
        levels_.push_back(std::move(level));
        ++through_[MADE];
        changed_.notify_all();
    }
    /* The next has its error. */
    void pass()
    {
        std::lock_guard<std::mutex> lock(mutex_);
        ++through_[BOUNDED];
        changed_.notify_all();
    }
    /* No more are to come. */
    void end(Step step)
    {
        std::lock_guard<std::mutex> lock(mutex_);
        ended_[step] = true;
        changed_.notify_all();
    }
    /* Waits for a level that is through a step; null where there are no more. */
    MadeLevel *at(size_t k, Step step, Task &task)
    {
        const std::chrono::milliseconds wait(10);
        std::unique_lock<std::mutex> lock(mutex_);
        while (!changed_.wait_for(lock, wait, [&] { return ended_[step] || k < through_[step]; })) {
            lock.unlock();
            task.advance(0); /* which may throw */
            lock.lock();
        }
        return k < through_[step] ? &levels_[k] : nullptr;
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<MadeLevel> levels_;
    size_t through_[STEPS] = {};
    bool ended_[STEPS] = {};
};

/* Ends a step however it ends. */
struct End {
    Line &line;
    Line::Step step;
    ~End() { line.end(step); }
};

/* Gives vertices to the few spots that a level is far from, which would set its error, and says how
 * far it strays then. The source first: it takes less, and what is left of its spots spares most
 * looks at the level. Triangles lie in their patches. */
static Strayed mend(const LodJob &job, LevelBound &bound, LevelMesh &mesh)
{
    auto reach = [&](const Spots &spots) {
        return bound.after(spots, reach_spots(mesh, spots.points, spots.most, job.regions,
                                              job.lattice));
    };
    const Spots spots = bound.spots(job.lattice.step / 2);
    if (spots.points.empty())
        return bound.whole();
    return {reach(bound.spots_of(reach(spots))), spots.rms};
}

/* Finds out how far levels stray: one says no less than a finer one, and than the specks that it
 * misses. */
static void find_errors(const LodJob &job, Line &line)
{
    const End end = {line, Line::BOUNDED};
    const BoundSource source(job.source, job.task);
    BoundedLevel finer;
    float told = 0;
    for (size_t k = 0; MadeLevel *level = line.at(k, Line::MADE, job.task); ++k) {
        LevelBound bound(source, level->mesh, job.lattice, level->speck, k ? &finer : nullptr,
                         job.task);
        const Strayed strayed = level->far ? bound.whole() : mend(job, bound, level->mesh);
        const float most = float(std::max(strayed.most, level->speck));
        level->error = told = std::max(told, std::nextafter(most, INFINITY));
        level->rms = float(strayed.rms);
        line.pass();
        finer = std::move(bound).bounded(strayed.most);
    }
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
static void make_far_levels(const LodJob &job, Simplifier &simplifier, Line &line)
{
    simplifier.cross_patches();
    const double ways = gtx_log(double(simplifier.triangles().size()) / FAR_TRIANGLES);
    const unsigned count = unsigned(std::clamp(std::ceil(ways / gtx_log(FAR_RATIO)), 0.0,
                                               double(FAR_LEVELS)));
    for (unsigned k = count; k-- > 0;) {
        job.task.limits.work_again();
        const double before = double(simplifier.triangles().size());
        const double ratio = gtx_pow(before / FAR_TRIANGLES, 1.0 / (k + 1));
        simplifier.reduce(size_t(before / ratio), 0, MAX_FAR_ERROR * job.size);
        simplifier.settle();
        drop_specks(simplifier);
        if (double(simplifier.triangles().size()) > MAX_SHARE * before)
            return;
        LevelMesh mesh =
            far_level_mesh(simplifier, job.maps, job.regions, job.lattice, job.task);
        if (mesh.empty())
            return;
        line.add({std::move(mesh), SPECK * simplifier.error(), true});
    }
}

/* At most `count` that keep to their patches, and far ones. */
static void make_levels(const LodJob &job, unsigned count, Line &line)
{
    const End end = {line, Line::MADE};
    const Maps &maps = job.maps;
    Simplifier simplifier(job.source, job.regions, job.task);
    const size_t model = job.source.model ? job.source.model : job.source.triangles.size();
    const bool finer = model > TINY && model <= SMALL && maps.color.empty() &&
                       maps.material.empty() && maps.emission.empty();
    size_t wanted = model / (finer ? SMALL_RATIO : FINEST_RATIO);
    for (unsigned k = 0; k < count; ++k) {
        job.task.limits.work_again();
        const size_t before = simplifier.triangles().size();
        simplifier.reduce(wanted, k ? 0 : FREE_ERROR * job.pitch, MAX_ERROR * job.size);
        if (k && double(simplifier.triangles().size()) > MAX_SHARE * double(before))
            break;
        simplifier.settle();
        LevelMesh mesh = level_mesh(simplifier, job.regions, job.lattice);
        if (mesh.empty())
            break;
        line.add({std::move(mesh), SPECK * simplifier.error(), false});
        wanted = size_t(double(simplifier.triangles().size()) / LEVEL_RATIO);
    }
    make_far_levels(job, simplifier, line);
}

/* As the asset keeps them; vertices have normals up to the first level without. */
static void store_levels(const LodJob &job, Line &line, Vector<LodLevel> &lod)
{
    const Maps &maps = job.maps;
    const NormalMaps shown = {maps.patches.data(), uint32_t(maps.patches.size()), maps.page_width,
                              maps.page_height, maps.height_bits, maps.height.data(),
                              maps.normal[0].data()};
    bool lit = true;
    for (size_t k = 0; const MadeLevel *made = line.at(k, Line::BOUNDED, job.task); ++k) {
        job.task.limits.work_again();
        lod.push_back(stored(made->mesh, job.regions.size(), job.lattice));
        LodLevel &level = lod.back();
        level.error = made->error;
        level.rms = made->rms;
        level.far = made->far;
        if (lit)
            level.normals = lod_normals(level.mesh(), shown);
        lit = !level.normals.codes.empty();
    }
}

} // namespace gtx::baking

namespace gtx {

using namespace baking;

Vector<LodLevel> make_lod(const LodSource &source, const Maps &maps, unsigned levels,
                          Task &task)
{
    task.begin("lod");
    if (source.triangles.empty() || !levels)
        return {};
    const Vector<PatchRegion> made =
        source.regions ? Vector<PatchRegion>() : patch_regions(maps, task);
    const Vector<PatchRegion> &regions = source.regions ? *source.regions : made;
    const double pitch = mean_pitch(maps);
    const Lattice lattice(source.positions, STEP * pitch);
    Vec3d size;
    for (int k = 0; k < 3; ++k)
        size[k] = double(maps.bounds_max[k]) - maps.bounds_min[k];
    const LodJob job = {source, maps, regions, lattice, pitch, length(size), task};
    Line line;
    Vector<LodLevel> lod;
    task.at_once({[&] { make_levels(job, levels, line); }, [&] { find_errors(job, line); },
                  [&] { store_levels(job, line, lod); }});
    return lod;
}

} // namespace gtx
