/* How far an LOD mesh strays: first of some points, then of all, at last where it was changed. */
#include "bake/lod/bound.hpp"
#include "bake/lod/outlier.hpp"
#include "bake/lod/parts.hpp"

#include <algorithm>

namespace gtx::baking {

/* Of each surface so many points come first, for most of the other triangles need no look once
 * something far is known. Half and double take a few hundredths more time. */
constexpr size_t FIRST = 2048;
/* What is farther than so many times the root of the mean square is a spot, and nothing less is
 * told of what has spots. At half a cook takes a fourth more instructions and levels have a tenth
 * more triangles, at double their errors are 40 to 100 % larger (bunny; dragon of 810,080: a fifth,
 * 9 %, 3 to 60). */
constexpr double OUTLYING = 6;
/* A finer level is of use up to so much of the distance that matters: a cook of the dragon takes
 * 3 % more instructions at a third of it, and at 0.85. */
constexpr double MAX_KNOWN = 0.75;

/* Those of the boxes that touch another; all of space touches it where `near` is null. */
class Near {
public:
    Near(const Vector<gtx::Box> *near, const gtx::Box &box) : all_(!near)
    {
        for (size_t i = 0; near && i < near->size(); ++i)
            if ((*near)[i].touches(box))
                boxes_.push_back((*near)[i]);
    }
    bool touches(const gtx::Box &box) const
    {
        return all_ || std::any_of(boxes_.begin(), boxes_.end(),
                                   [&](const gtx::Box &b) { return b.touches(box); });
    }

private:
    bool all_;
    Vector<gtx::Box> boxes_;
};

/* `counts(t)`: whether triangle t of `from` is to be near. Nothing is asked of what touches none of
 * the boxes, where there are any. */
template <class Counts>
static double greatest(const SortedSurface &from, const Counts &counts, const FarSearch &start,
                       const Vector<gtx::Box> *boxes, Task &task)
{
    Vector<double> found(from.tree().parts(), 0);
    task.parallel(found.size(), [&](size_t part) {
        FarSearch search = start;
        const Near near(boxes, from.tree().box(part));
        from.tree().visit(part, [&](const gtx::Box &box) {
            return !near.touches(box) || search.is_covered(box);
        }, [&](uint32_t t) {
            if (counts(t))
                search.look(from.corners(t));
        });
        found[part] = search.found;
    }, 1, 1);
    return *std::max_element(found.begin(), found.end());
}

/* `add(t, place)` for each triangle that is somewhere farther than start.free. */
template <class Counts, class Add>
static Vector<FarPoint> all_far(const SortedSurface &from, const Counts &counts,
                                const FarSearch &start, const Add &add, Task &task)
{
    Vector<Vector<FarPoint>> found(from.tree().parts());
    task.parallel(found.size(), [&](size_t part) {
        FarSearch search = start;
        from.tree().visit(part, [&](const gtx::Box &box) { return search.is_covered(box); },
                          [&](uint32_t t) {
            if (!counts(t))
                return;
            const FarPlace place = search.find_far(from.corners(t));
            if (place.away > 0)
                found[part].push_back(add(t, place));
        });
    }, 1, 1);
    Vector<FarPoint> all;
    for (const Vector<FarPoint> &of : found)
        all.insert(all.end(), of.begin(), of.end());
    return all;
}

/* Which triangles are not sure to be within that distance of another surface. */
static Vector<uint8_t> unsure_of(const SortedSurface &from, const SortedSurface &to, double within,
                                 Task &task)
{
    Vector<uint8_t> unsure(from.size(), 0);
    task.parallel(from.tree().parts(), [&](size_t part) {
        FarSearch search = {to, within, 0};
        from.tree().visit(part, [&](const gtx::Box &box) { return search.is_covered(box); },
                          [&](uint32_t t) { unsure[t] = !search.is_within(from.corners(t)); });
    }, 1, 1);
    return unsure;
}

/* The first points: their greatest distance, and the root of the mean square. */
template <class Counts>
static Strayed sample(const SortedSurface &from, const Counts &counts, const FarSearch &start,
                      Task &task)
{
    const size_t step = (from.size() + FIRST - 1) / FIRST, count = (from.size() + step - 1) / step;
    const size_t chunk = 256;
    Vector<double> away(count, -1);
    task.parallel((count + chunk - 1) / chunk, [&](size_t n) {
        FarSearch search = start;
        for (size_t i = n * chunk; i < std::min(count, (n + 1) * chunk); ++i) {
            search.near = NO_PATCH; /* the last was far away */
            if (counts(uint32_t(i * step)))
                away[i] = search.distance(from.corners(i * step)[0], start.free);
        }
    }, 1, 1);
    Strayed out;
    double sum = 0, looked = 0;
    for (double a : away) {
        out.most = std::max(out.most, a);
        sum += a >= 0 ? a * a : 0;
        looked += a >= 0;
    }
    out.rms = looked > 0 ? std::sqrt(sum / looked) : 0;
    return out;
}

BoundSource::BoundSource(const LodSource &source, Task &task)
    : patch_(source.patch), surface_(source.positions, source.triangles, task, 0),
      parts_(part_sizes(source.positions, source.triangles)),
      largest_part_(*std::max_element(parts_.begin(), parts_.end()))
{
}

bool BoundSource::is_shown(uint32_t triangle, double speck) const
{
    return parts_[surface_.given(triangle)] > speck || largest_part_ <= speck;
}

static Vector<uint32_t> stored_triangles(const LevelMesh &mesh)
{
    Vector<uint32_t> out;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (mesh.patch[t] != NO_PATCH && !mesh.collapses(mesh.triangles[t]))
            out.push_back(t);
    return out;
}

static Vector<Vec3d> points_of(const LevelMesh &mesh, const Lattice &lattice)
{
    Vector<Vec3d> out;
    for (const Place &place : mesh.places)
        out.push_back(lattice.point(place));
    return out;
}

static Vector<Triangle> triangles_of(const LevelMesh &mesh, const Vector<uint32_t> &number)
{
    Vector<Triangle> out;
    for (uint32_t t : number)
        out.push_back(mesh.triangles[t]);
    return out;
}

LevelSurface::LevelSurface(const LevelMesh &mesh, const Lattice &lattice, Task &task)
    : number(stored_triangles(mesh)),
      surface(points_of(mesh, lattice), triangles_of(mesh, number), task, 1)
{
}

static gtx::Box box_around(const Corners &corners, double beyond)
{
    gtx::Box box;
    for (const Vec3d &p : corners) {
        box.add(p + Vec3d(beyond, beyond, beyond));
        box.add(p - Vec3d(beyond, beyond, beyond));
    }
    return box;
}

LevelBound::LevelBound(const BoundSource &source, const LevelMesh &mesh, const Lattice &lattice,
                       double speck, const Vector<BoundedLevel> &finer, Task &task)
    : source_(source), mesh_(mesh), lattice_(lattice), speck_(speck),
      finer_(finer), task_(task), level_(std::make_unique<LevelSurface>(mesh, lattice, task))
{
}

Spots LevelBound::spots(double least) const
{
    task_.limits.work_again(); /* large sources take several looks a triangle at each level */
    const auto shown = [&](uint32_t t) { return is_shown(t); };
    FarSearch there = {level_->surface, 0, 0};
    Spots out;
    out.rms = sample(source_.surface(), shown, there, task_).rms;
    out.most = there.free = std::max(least, OUTLYING * out.rms);
    out.points = all_far(source_.surface(), shown, there, [&](uint32_t t, const FarPlace &place) {
        return FarPoint{place.at, source_.surface().corners(t), source_.patch_of(t),
                        level_->of_mesh(place.near), place.away};
    }, task_);
    return out;
}

/* Where a finer level is near enough, its source is: distances add up, and fewer triangles lie
 * over each. */
Vector<uint8_t> LevelBound::may_be_far(double within) const
{
    const SortedSurface &level = level_->surface;
    for (auto finer = finer_.rbegin(); finer != finer_.rend(); ++finer)
        if (finer->away <= MAX_KNOWN * within)
            return unsure_of(level, finer->level->surface, within - finer->away, task_);
    return Vector<uint8_t>(level.size(), 1);
}

Spots LevelBound::spots_of(double least) const
{
    task_.limits.work_again();
    const SortedSurface &level = level_->surface;
    const FarSearch back = {source_.surface(), least / LOOSE, 0};
    const Vector<uint8_t> unsure = may_be_far(back.free);
    Spots out;
    out.of_level = true;
    out.most = least;
    out.points = all_far(level, [&](uint32_t t) { return unsure[t]; }, back,
                         [&](uint32_t t, const FarPlace &place) {
        const Corners c = source_.surface().corners(place.near);
        const auto [x, y, z] = nearest_shares(c, place.at);
        const uint32_t number = level_->of_mesh(t);
        return FarPoint{c[0] * x + c[1] * y + c[2] * z, c, source_.patch_of(place.near), number,
                        place.away,
                        place.corner < 0 ? NO_VERTEX : mesh_.triangles[number][place.corner]};
    }, task_);
    return out;
}

double LevelBound::after(const Spots &spots, const Vector<Corners> &changed)
{
    if (spots.points.empty())
        return spots.most;
    Vector<gtx::Box> boxes;
    for (const Corners &c : changed)
        boxes.push_back(box_around(c, spots.most));
    for (const FarPoint &p : spots.points) {
        boxes.push_back(box_around(p.source, spots.most));
        boxes.push_back(
            box_around(mesh_.corners(mesh_.triangles[p.near], lattice_), spots.most));
    }
    if (!changed.empty())
        level_ = std::make_unique<LevelSurface>(mesh_, lattice_, task_);
    const auto any = [](uint32_t) { return true; };
    const auto shown = [&](uint32_t t) { return is_shown(t); };
    FarSearch there = {level_->surface, spots.most, 0};
    there.found = greatest(source_.surface(), shown, there, &boxes, task_);
    if (spots.of_level) {
        const FarSearch back = {source_.surface(), spots.most / LOOSE, there.found};
        there.found = greatest(level_->surface, any, back, &boxes, task_);
    }
    return there.most();
}

Strayed LevelBound::whole() const
{
    task_.limits.work_again();
    const auto any = [](uint32_t) { return true; };
    const auto shown = [&](uint32_t t) { return is_shown(t); };
    FarSearch there = {level_->surface, double(lattice_.step) / 2, 0};
    FarSearch back = {source_.surface(), double(lattice_.step) / 2, 0};
    Strayed out = sample(source_.surface(), shown, there, task_);
    back.found = std::max(out.most, sample(level_->surface, any, back, task_).most);
    task_.limits.work_again();
    /* The source first: it takes less, and its spots spare the level most of its looks. */
    there.found = back.found;
    back.found = greatest(source_.surface(), shown, there, nullptr, task_);
    task_.limits.work_again();
    there.found = greatest(level_->surface, any, back, nullptr, task_);
    out.most = there.most();
    return out;
}

BoundedLevel LevelBound::bounded(double away) &&
{
    return {std::move(level_), away};
}

} // namespace gtx::baking
