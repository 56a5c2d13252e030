/* How far an LOD mesh strays: first of some points, then of all, at last where it was changed. */
#include "bake/lod/bound.hpp"
#include "bake/lod/outlier.hpp"
#include "bake/lod/parts.hpp"

#include <algorithm>

namespace gtx::baking {

/* What is farther than so many times the root of the mean square is a spot, and nothing less is
 * told of what has spots. At half a cook takes a fourth more instructions and levels have a tenth
 * more triangles, at double their errors are 40 to 100 % larger (bunny; dragon of 810,080: a fifth,
 * 9 %, 3 to 60). */
constexpr double OUTLYING = 6;
/* Where more of a finer level's triangles are unsure, all of the source is looked at: boxes around
 * them have most of it, and many have the same. A limit: without it the first far level of the
 * dragon of 810,080 triangles takes five times as long. */
constexpr double MANY_UNSURE = 0.25;
/* Of each surface so many points come first, for most of the other triangles need no look once
 * something far is known. Half and double take a few hundredths more time. */
constexpr size_t FIRST = 2048;
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
    return parts_[surface_.given(triangle)] > speck || is_speck(speck);
}

/* In the order that they had before, with others where some are gone and at the end. */
static Vector<uint32_t> stored_triangles(const LevelMesh &mesh, const LevelSurface *before)
{
    Vector<uint8_t> is_new(mesh.triangles.size(), 0);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        is_new[t] = mesh.patch[t] != NO_PATCH && !mesh.collapses(mesh.triangles[t]);
    Vector<uint32_t> out;
    size_t gaps = 0;
    for (size_t i = 0; before && i < before->surface.size(); ++i) {
        const uint32_t t = before->of_mesh(uint32_t(i));
        gaps += !is_new[t];
        out.push_back(is_new[t] ? t : NO_PATCH);
        is_new[t] = 0;
    }
    size_t gap = 0;
    for (uint32_t t = 0; t < is_new.size(); ++t) {
        if (!is_new[t])
            continue;
        if (gaps) {
            while (out[gap] != NO_PATCH)
                ++gap;
            out[gap] = t;
            --gaps;
        } else {
            out.push_back(t);
        }
    }
    if (gaps)
        out.erase(std::remove(out.begin(), out.end(), NO_PATCH), out.end());
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

LevelSurface::LevelSurface(const LevelMesh &mesh, const Lattice &lattice,
                           const LevelSurface *before, Task &task)
    : number(stored_triangles(mesh, before)),
      surface(points_of(mesh, lattice), triangles_of(mesh, number), task, 1, before)
{
}

LevelBound::LevelBound(const BoundSource &source, const LevelMesh &mesh, const Lattice &lattice,
                       double speck, const BoundedLevel *finer, Task &task)
    : source_(source), mesh_(mesh), lattice_(lattice), speck_(speck), finer_(finer), task_(task)
{
    level_ = std::make_unique<LevelSurface>(mesh, lattice, nullptr, task);
    const SortedSurface &surface = finer ? finer->level->surface : source.surface();
    Overlay overlay = lay_over(surface, level_->surface, finer ? finer->from_source.get() : nullptr,
                               finer ? finer->to_source.get() : nullptr, task);
    of_finer_ = std::move(overlay.of_fine);
    from_source_ = std::make_unique<Reached>(std::move(overlay.to_coarse));
    to_source_ = std::make_unique<Reached>(std::move(overlay.of_coarse));
}

/* After it was changed: what is known of triangles stays, where they do. */
void LevelBound::change()
{
    auto level = std::make_unique<LevelSurface>(mesh_, lattice_, level_.get(), task_);
    const SortedSurface &surface = level->surface;
    auto from = std::make_unique<Reached>(surface.size());
    auto to = std::make_unique<Reached>(surface.size());
    Vector<uint32_t> was(mesh_.triangles.size(), NO_PATCH);
    for (uint32_t t = 0; t < level_->surface.size(); ++t)
        was[level_->of_mesh(t)] = t;
    for (uint32_t t = 0; t < surface.size(); ++t) {
        const uint32_t old = was[level->of_mesh(t)];
        const bool same = old != NO_PATCH && level_->surface.corners(old) == surface.corners(t);
        from->tell(t, same ? from_source_->at(old) : 0);
        to->tell(t, same ? to_source_->at(old) : INFINITY);
    }
    level_ = std::move(level);
    from_source_ = std::move(from);
    to_source_ = std::move(to);
}

/* Of so many triangles those that may be farther. */
template <class Away> static Vector<uint32_t> those_beyond(double within, size_t count, Away away)
{
    Vector<uint32_t> out;
    for (size_t t = 0; t < count; ++t)
        if (!(double(away(t)) <= within))
            out.push_back(uint32_t(t));
    return out;
}

/* The triangles of the source that may be farther from the level. Each point of another is near
 * one of the finer level that is near enough to this one: distances add up. */
Few LevelBound::few_of_source(double within)
{
    if (!finer_)
        return those_beyond(within, of_finer_.size(), [&](size_t t) { return of_finer_[t]; });
    if (source_.is_speck(speck_)) /* all is shown again */
        return {};
    const SortedSurface &finer = finer_->level->surface;
    Vector<Vector<gtx::Box>> boxes(finer.tree().parts());
    task_.parallel(boxes.size(), [&](size_t part) {
        FarSearch search = {level_->surface, 0, 0};
        search.reached = from_source_.get();
        finer.tree().visit(part, [](const gtx::Box &) { return false; }, [&](uint32_t t) {
            search.before = finer_->from_source->at(t);
            search.free = within - search.before;
            if (double(of_finer_[t]) <= search.free)
                return;
            const Corners corners = finer.corners(t);
            if (!(search.free > 0 && search.is_within(corners)))
                boxes[part].push_back(box_around(corners, search.before));
        });
    }, 1, 1);
    const Vector<gtx::Box> all = joined(boxes);
    if (double(all.size()) > MANY_UNSURE * double(finer.size()))
        return {};
    return touching(source_.surface(), all, task_);
}

/* The triangles of the level that may be farther from the source. */
Few LevelBound::few_of_level(double within)
{
    const SortedSurface &level = level_->surface;
    if (!finer_)
        return those_beyond(within, level.size(), [&](size_t t) { return to_source_->at(t); });
    Vector<Vector<uint32_t>> few(level.tree().parts());
    task_.parallel(few.size(), [&](size_t part) {
        FarSearch search = {finer_->level->surface, within, 0};
        search.beyonds = finer_->to_source.get();
        level.tree().visit(part, [](const gtx::Box &) { return false; }, [&](uint32_t t) {
            search.reach = 0;
            if (to_source_->at(t) <= within)
                return;
            if (search.is_within(level.corners(t)))
                to_source_->set(t, search.reach);
            else
                few[part].push_back(t);
        });
    }, 1, 1);
    return joined(few);
}

Spots LevelBound::spots(double least)
{
    task_.limits.work_again(); /* large sources take several looks a triangle at each level */
    const auto shown = [&](uint32_t t) { return is_shown(t); };
    FarSearch there = {level_->surface, 0, 0};
    Spots out;
    out.rms = sample(source_.surface(), shown, there, task_).rms;
    out.most = there.free = std::max(least, OUTLYING * out.rms);
    there.reached = from_source_.get();
    out.points = all_far(source_.surface(), few_of_source(there.free), shown, there,
                         nullptr, [&](uint32_t t, const FarPlace &place) {
        return FarPoint{place.at, source_.surface().corners(t), source_.patch_of(t),
                        level_->of_mesh(place.near), place.away};
    }, task_);
    return out;
}

Spots LevelBound::spots_of(double least)
{
    task_.limits.work_again();
    const SortedSurface &level = level_->surface;
    const FarSearch back = {source_.surface(), least / LOOSE, 0};
    Spots out;
    out.of_level = true;
    out.most = least;
    const auto any = [](uint32_t) { return true; };
    out.points = all_far(level, few_of_level(back.free), any, back, to_source_.get(),
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
        change();
    const auto any = [](uint32_t) { return true; };
    const auto shown = [&](uint32_t t) { return is_shown(t); };
    FarSearch there = {level_->surface, spots.most, 0};
    there.reached = from_source_.get();
    there.found = greatest(source_.surface(), touching(source_.surface(), boxes, task_), shown,
                           there, nullptr, task_);
    if (spots.of_level) {
        const FarSearch back = {source_.surface(), spots.most / LOOSE, there.found};
        there.found = greatest(level_->surface, touching(level_->surface, boxes, task_), any, back,
                               to_source_.get(), task_);
    }
    return there.most();
}

Strayed LevelBound::whole()
{
    task_.limits.work_again();
    const auto any = [](uint32_t) { return true; };
    const auto shown = [&](uint32_t t) { return is_shown(t); };
    FarSearch there = {level_->surface, double(lattice_.step) / 2, 0};
    FarSearch back = {source_.surface(), double(lattice_.step) / 2, 0};
    Strayed out = sample(source_.surface(), shown, there, task_);
    there.found = std::max(out.most, sample(level_->surface, any, back, task_).most);
    task_.limits.work_again();
    there.reached = from_source_.get();
    back.found = greatest(source_.surface(), few_of_source(there.most()), shown, there,
                          nullptr, task_);
    task_.limits.work_again();
    there.found = greatest(level_->surface, few_of_level(back.most()), any, back, to_source_.get(),
                           task_);
    out.most = there.most();
    return out;
}

BoundedLevel LevelBound::bounded(double away) &&
{
    for (size_t t = 0; t < level_->surface.size(); ++t)
        to_source_->set(t, std::min(to_source_->at(t), away));
    return {std::move(level_), std::move(from_source_), std::move(to_source_)};
}

} // namespace gtx::baking
