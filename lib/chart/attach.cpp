/* Attaches small islands: components of a few triangles, which scans with non-manifold edges have
 * by the thousand, and what is left over from splitting. Each would cost a patch of its own. */
#include "chart/attach.hpp"
#include "chart/near_grid.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gtx {

namespace {

/* Largest candidate whose target will be cut. Half: RMS -9 %, double: bytes +1 % (truck). */
constexpr double CANDIDATE_TEXELS = 3 * PATCH_TEXELS;
/* Surface this near is tried as a target even where it does not touch. Half: patches +7 % (truck);
 * double: 5 holes (truck). */
constexpr double NEAR_TEXELS = 3;
/* VSA and PGP: what a patch costs for being one, in texels. Half: patches +2 %; double: bytes +1 %
 * (truck). */
constexpr double PATCH_COST = 256;
/* Least cosine of raw normals with the target's axis, of small islands and of larger candidates.
 * Half: RMS +1 %, bytes +1 %; double: patches +7 and +12 % (truck). */
constexpr double ISLAND_FACING = 0.1, CANDIDATE_FACING = 0.3;
/* What of their area may be steeper. Half: patches +3 %; double: RMS +3 % (truck). */
constexpr double STEEP_AREA = 0.05;
/* Of a wall that a target may get: scans have small ones. Half and double change nothing, at 1 the
 * gargoyle changes. */
constexpr double WALL_TEXELS = 16;
/* An island may lead to the next; tiny ones wait for the last pass. A limit: the first pass finds
 * nearly all, and chains of islands must not take a time of their number squared. */
constexpr int PASSES = 4;
/* A limit on time: all tries together look at so many texels for each triangle. */
constexpr double MAX_LOOKS = 1024;

class Attachment {
public:
    Attachment(Surface &surface, const Bounds &bounds, Vector<Region> &regions,
               Vector<Frame> &frames, Task &task)
        : surface_(surface), bounds_(bounds), regions_(regions), frames_(frames), task_(task),
          grid_of_(frames), grids_(regions.size()), age_(regions.size()),
          looks_left_(MAX_LOOKS * double(surface.facets.size()))
    {
    }

    void run();

private:
    void find_candidates();
    void find_near();
    double texels(const Region &region) const
    {
        return texels_of(surface_, region, bounds_.pitch);
    }
    uint32_t owner_of(uint32_t region);
    void place(uint32_t candidate, bool tiny);
    bool try_target(uint32_t candidate, uint32_t target, bool tiny);
    void mark_junk(const Region &candidate, const Vec3d &z);
    bool faces(const Region &candidate, const Vec3d &z) const;
    Frame widened(const Frame &frame, const Region &candidate, double &texels) const;
    bool look_at(double texels);
    double cost(const Frame &frame) const
    {
        double w = frame.extent[0] / bounds_.pitch + RIM, h = frame.extent[1] / bounds_.pitch + RIM;
        return PATCH_COST + w * h;
    }

    Surface &surface_;
    const Bounds &bounds_;
    Vector<Region> &regions_;
    Vector<Frame> &frames_;
    Task &task_;
    Vector<uint32_t> candidates_;                     /* largest first */
    struct Near {
        uint32_t candidate, region;
        uint32_t refused_by = NO_TRIANGLE, ages = 0; /* the target at the last try, and both ages */
    };
    Vector<Near> near_;                               /* ascending */
    Vector<uint32_t> target_;                         /* of a region; itself while it stays */
    /* Depths of regions that were tried as targets, in the frames that they had at first. */
    Vector<Frame> grid_of_;
    Vector<LayerGrid> grids_;
    Vector<uint32_t> age_;                            /* of a region: what it has taken in */
    Vector<uint32_t> asked_by_;                       /* a target: which candidate came last */
    double looks_left_;
};

void Attachment::find_candidates()
{
    Vector<std::pair<double, uint32_t>> order;
    for (uint32_t i = 0; i < regions_.size(); ++i)
        order.emplace_back(-texels(regions_[i]), i);
    std::sort(order.begin(), order.end());
    for (const auto &[less, region] : order)
        if (-less < (bounds_.cone ? CANDIDATE_TEXELS : SMALL_ISLAND_TEXELS))
            candidates_.push_back(region);
}

void Attachment::find_near()
{
    const Mesh &mesh = surface_.mesh;
    NearGrid grid(NEAR_TEXELS * bounds_.pitch);
    for (uint32_t candidate : candidates_)
        for (uint32_t t : regions_[candidate].triangles)
            for (uint32_t v : mesh.triangles[t])
                grid.add(mesh.positions[v], candidate);
    grid.dilate();

    constexpr size_t LEAST = 16; /* regions; changes no byte */
    Vector<Vector<Near>> found(candidates_.empty() ? 0 : task_.parts(regions_.size(), LEAST));
    task_.in_parts(regions_.size(), found.size(), [&](size_t part, size_t from, size_t to) {
        Vector<uint32_t> last_seen(mesh.positions.size(), NO_TRIANGLE); /* a vertex: by a region */
        Vector<uint32_t> last_region(regions_.size(), NO_TRIANGLE);     /* of a candidate */
        for (auto region = uint32_t(from); region < to; ++region)
            for (uint32_t t : regions_[region].triangles)
                for (uint32_t v : mesh.triangles[t])
                    if (std::exchange(last_seen[v], region) != region) {
                        cancel_point();
                        grid.each_near(mesh.positions[v], [&](uint32_t candidate) {
                            if (candidate != region &&
                                std::exchange(last_region[candidate], region) != region)
                                found[part].push_back({candidate, region});
                        });
                    }
    });
    for (const Vector<Near> &some : found)
        near_.insert(near_.end(), some.begin(), some.end());
    /* Regions ascend already. */
    std::stable_sort(near_.begin(), near_.end(), [](const Near &a, const Near &b) {
        return a.candidate < b.candidate;
    });
}

bool Attachment::faces(const Region &candidate, const Vec3d &z) const
{
    double steep = 0, size = 0;
    const double least = texels(candidate) < SMALL_ISLAND_TEXELS ? ISLAND_FACING : CANDIDATE_FACING;
    for (uint32_t t : candidate.triangles) {
        const double facing = dot(Vec3d(surface_.normal[t]), z);
        if (leans_back(surface_, t, facing, z, bounds_.pitch))
            return false;
        size += surface_.facets[t].size;
        if (facing < least)
            steep += surface_.facets[t].size;
    }
    return steep <= STEEP_AREA * size &&
           !has_wall(surface_, candidate, z, bounds_.pitch, WALL_TEXELS);
}

/* Also the texels of the rectangle that the candidate takes there. */
Frame Attachment::widened(const Frame &frame, const Region &candidate, double &texels) const
{
    FrameInverse inverse(frame);
    Vec3d own_low(INFINITY, INFINITY, INFINITY), own_high = -own_low;
    for (uint32_t t : candidate.triangles)
        for (int k = 0; k < 3; ++k) {
            Vec3d p = inverse(surface_.mesh.position(t, k));
            for (int i = 0; i < 3; ++i) {
                own_low[i] = std::min(own_low[i], p[i]);
                own_high[i] = std::max(own_high[i], p[i]);
            }
        }
    Vec3d low, high;
    for (int i = 0; i < 3; ++i) {
        low[i] = std::min(0., own_low[i]);
        high[i] = std::max(frame.extent[i], own_high[i]);
    }
    texels = (own_high.x - own_low.x) * (own_high.y - own_low.y) / (bounds_.pitch * bounds_.pitch);
    Frame out = frame;
    out.origin = frame.point(low);
    for (int i = 0; i < 3; ++i)
        out.extent[i] = high[i] - low[i];
    return out;
}

/* Whether that many may be looked at still. */
bool Attachment::look_at(double texels)
{
    const bool may = texels <= looks_left_;
    looks_left_ -= may ? texels : 0;
    return may;
}

void Attachment::mark_junk(const Region &candidate, const Vec3d &z)
{
    for (uint32_t t : candidate.triangles)
        if (dot(Vec3d(surface_.normal[t]), z) < ISLAND_FACING)
            surface_.junk[t] = 1;
}

bool Attachment::try_target(uint32_t candidate, uint32_t target, bool tiny)
{
    const Region &added = regions_[candidate];
    if (!tiny && !faces(added, frames_[target].z))
        return false;
    double looks;
    Frame frame = widened(frames_[target], added, looks);
    if (!bounds_.cone && (std::max(frame.extent[0], frame.extent[1]) > bounds_.side ||
                          cost(frame) > cost(frames_[target]) + cost(frames_[candidate])))
        return false;
    if (!look_at(looks + double(added.size())))
        return false;
    LayerGrid &grid = grids_[target];
    LayerGrid own = make_layer_grid(surface_, added, grid_of_[target], bounds_.pitch, task_);
    size_t doubled;
    if (fold_together(grid, own, layer_rule(surface_, bounds_.pitch), doubled) ||
        (doubled && !tiny))
        return false;
    if (grid.grows_by(own) && !look_at(double(grid.samples.size())))
        return false;
    grid.add(own);
    if (tiny)
        mark_junk(added, frame.z);
    Region &both = regions_[target];
    auto offset = uint32_t(both.size());
    both.triangles.insert(both.triangles.end(), added.triangles.begin(), added.triangles.end());
    for (std::array<uint32_t, 3> n : added.neighbours) {
        for (uint32_t &i : n)
            i += i == NO_TRIANGLE ? 0 : offset;
        both.neighbours.push_back(n);
    }
    frames_[target] = frame;
    regions_[candidate] = {};
    target_[candidate] = target;
    ++age_[target];
    return true;
}

/* Where a region is now. */
uint32_t Attachment::owner_of(uint32_t region)
{
    while (target_[region] != region)
        region = target_[region] = target_[target_[region]];
    return region;
}

/* A target that refused is not asked again before one of the two has grown, but for tiny ones. */
void Attachment::place(uint32_t candidate, bool tiny)
{
    auto near = std::lower_bound(near_.begin(), near_.end(), candidate,
                                 [](const Near &a, uint32_t b) { return a.candidate < b; });
    for (; near != near_.end() && near->candidate == candidate; ++near) {
        const uint32_t target = owner_of(near->region), ages = age_[target] + age_[candidate];
        if (target == candidate ||
            (near->refused_by == target && near->ages == ages && !tiny) ||
            std::exchange(asked_by_[target], candidate) == candidate)
            continue;
        if (try_target(candidate, target, tiny))
            return;
        near->refused_by = target;
        near->ages = ages;
    }
}

void Attachment::run()
{
    find_candidates();
    find_near();
    Vector<uint8_t> is_near(regions_.size(), false);
    for (const Near &near : near_)
        is_near[near.region] = true;
    task_.parallel(regions_.size(), [&](size_t i) {
        if (is_near[i])
            grids_[i] = make_layer_grid(surface_, regions_[i], grid_of_[i], bounds_.pitch, task_);
    }, 0, 0);
    target_.resize(regions_.size());
    std::iota(target_.begin(), target_.end(), 0u);
    for (int pass = 1; pass <= PASSES; ++pass) {
        asked_by_.assign(regions_.size(), NO_TRIANGLE);
        for (uint32_t candidate : candidates_) {
            bool tiny = pass == PASSES && texels(regions_[candidate]) < JUNK_TEXELS;
            cancel_point();
            if (target_[candidate] == candidate)
                place(candidate, tiny);
        }
    }
    drop_empty(regions_, frames_);
}

} // namespace

void attach_islands(Surface &surface, const Bounds &bounds, Vector<Region> &regions,
                    Vector<Frame> &frames, Task &task)
{
    Attachment(surface, bounds, regions, frames, task).run();
}

} // namespace gtx
