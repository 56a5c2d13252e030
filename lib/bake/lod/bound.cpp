/* How far an LOD mesh strays: triangles of either surface are split where the other may be farther
 * from them than from any point looked at so far. */
#include "bake/lod/bound.hpp"
#include "bake/lod/parts.hpp"

#include <algorithm>

namespace gtx::baking {

using Corners = std::array<Vec3d, 3>;

/* The bound that is told, as a multiple of the farthest point found: at 1.05 twice as many
 * triangles are split, at 1.2 levels are used that much nearer than they might. */
constexpr double LOOSE = 1.1;
/* Of each surface so many points come first, for most of the other triangles need no look once
 * something far is known. Half and double take a few hundredths more time. */
constexpr size_t FIRST = 2048;
/* How steeply a level's triangle may leave the source. Of source to level nothing is taken for
 * granted: triangles there are small, and few are looked at twice. */
constexpr double STEEPEST = 0.35;
/* So many of the last triangles that were nearest are tried before the tree is asked; 7 take as
 * long, 15 a tenth more. */
constexpr size_t EARLIER = 3;

namespace {

/* A point, and how far it was from the nearest triangle at the time. */
struct Corner {
    Vec3d at;
    uint32_t near = NO_PATCH;
    double away = 0;             /* squared */
};

/* A triangle that was the nearest, and its box. */
struct Known {
    uint32_t triangle = NO_PATCH;
    NearTriangle shape = {};
    Vec3d low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};

    Known() = default;
    Known(uint32_t triangle, const NearTriangle &shape) : triangle(triangle), shape(shape)
    {
        for (const Vec3d &p : {shape.a, shape.b, shape.a + shape.ac})
            for (int k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], p[k]);
                high[k] = std::max(high[k], p[k]);
            }
    }
    bool is_within(const Vec3d &p, double limit) const
    {
        for (int k = 0; k < 3; ++k)
            if (!(p[k] >= low[k] - limit && p[k] <= high[k] + limit))
                return false;
        return shape.distance2(p) <= limit * limit;
    }
};

/* From triangles to a surface. */
struct Search {
    const SortedSurface &to;
    double slope;                /* how fast distances may change along a triangle */
    double least;                /* triangles of a smaller radius are not split */
    double free;                 /* a distance of no interest */
    double found;                /* the greatest so far */
    uint32_t near = NO_PATCH;    /* the triangle of `to` that was nearest last */
    NearTriangle nearest = {};   /* that */
    Known earlier[EARLIER] = {}; /* others that were */
    size_t next = 0;

    double most() const { return std::max(free, LOOSE * found); }
    bool is_within(Corner &c, double square) const
    {
        if (c.near != near) {
            c.near = near;
            c.away = nearest.distance2(c.at);
        }
        return c.away <= square;
    }
    /* Whether that triangle is within most() of all that the corners span: distances from a convex
     * set are greatest at corners. */
    bool is_covered(Corner &a, Corner &b, Corner &c) const
    {
        const double limit = most() * most();
        return near < to.size() && is_within(a, limit) && is_within(b, limit) &&
               is_within(c, limit);
    }
    /* The same of an earlier one, which becomes the nearest. */
    bool was_covered(const Corner &a, const Corner &b, const Corner &c)
    {
        for (Known &known : earlier) {
            if (!known.is_within(a.at, most()) || !known.is_within(b.at, most()) ||
                !known.is_within(c.at, most()))
                continue;
            const Known last(near, nearest);
            near = known.triangle;
            nearest = known.shape;
            known = last;
            return true;
        }
        return false;
    }
    bool is_covered(const gtx::Box &box) const
    {
        const double limit = most() * most();
        if (near >= to.size())
            return false;
        for (int corner = 0; corner < 8; ++corner) {
            Vec3d p;
            for (int k = 0; k < 3; ++k)
                p[k] = corner >> k & 1 ? box.high[k] : box.low[k];
            if (!(nearest.distance2(p) <= limit))
                return false;
        }
        return true;
    }
    double distance(const Vec3d &p, double enough)
    {
        const uint32_t last = near;
        const double known = near < to.size() ? nearest.distance2(p) : INFINITY;
        const double square =
            near < to.size() && slope >= 1 /* of smaller triangles than these is it close by */
                ? to.tree().nearer_around(known, p, &near, enough * enough)
                : to.tree().nearer(known, p, &near, [](uint32_t) { return true; }, nullptr,
                                   enough * enough);
        if (near != last) {
            earlier[next] = last < to.size() ? Known(last, nearest) : Known();
            next = (next + 1) % EARLIER;
            const Corners c = to.corners(near);
            nearest = {c[0], c[1], c[2]};
        }
        return std::sqrt(square);
    }
    void look(const Corners &c)
    {
        Corner a = {c[0]}, b = {c[1]}, d = {c[2]};
        look(a, b, d);
    }
    void look(Corner &a, Corner &b, Corner &c);
};

void Search::look(Corner &a, Corner &b, Corner &c)
{
    cancel_point();
    if (is_covered(a, b, c) || (slope >= 1 && was_covered(a, b, c)))
        return;
    const Vec3d middle = (a.at + b.at + c.at) / 3;
    const double radius =
        std::max({length(a.at - middle), length(b.at - middle), length(c.at - middle)});
    const double enough = most() - slope * radius;
    if (enough > 0 || radius <= least) {
        const double away = distance(middle, std::max(0.0, enough));
        if (away <= enough)
            return;
        found = std::max(found, away);
        if (away + slope * radius <= most() || radius <= least || is_covered(a, b, c))
            return;
    }
    Corner x = {(b.at + c.at) / 2}, y = {(c.at + a.at) / 2}, z = {(a.at + b.at) / 2};
    look(x, y, z);
    look(a, z, y);
    look(z, b, x);
    look(y, x, c);
}

} // namespace

/* `counts(t)`: whether triangle t of `from` is to be near. */
template <class Counts>
static double greatest(const SortedSurface &from, const Counts &counts, const Search &start,
                       Task &task)
{
    Vector<double> found(from.tree().parts(), 0);
    task.parallel(found.size(), [&](size_t part) {
        Search search = start;
        from.tree().visit(part, [&](const gtx::Box &box) { return search.is_covered(box); },
                          [&](uint32_t t) {
                              if (counts(t))
                                  search.look(from.corners(t));
                          });
        found[part] = search.found;
    }, 1, 1);
    return *std::max_element(found.begin(), found.end());
}

/* The first points: their greatest distance, and the root of the mean square. */
template <class Counts>
static Strayed sample(const SortedSurface &from, const Counts &counts, const Search &start,
                      Task &task)
{
    const size_t step = (from.size() + FIRST - 1) / FIRST, count = (from.size() + step - 1) / step;
    const size_t chunk = 256;
    Vector<double> away(count, -1);
    task.parallel((count + chunk - 1) / chunk, [&](size_t n) {
        Search search = start;
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

SortedSurface::SortedSurface(Vector<Vec3d> positions,
                             Vector<std::array<uint32_t, 3>> triangles, Task &task, double done)
    : positions_(std::move(positions)), triangles_(std::move(triangles)),
      shapes_{positions_, triangles_}, tree_(shapes_, task, done), given_(tree_.renumber())
{
    Vector<Vec3d> places;
    Vector<std::array<uint32_t, 3>> ordered;
    Vector<uint32_t> name(positions_.size(), NO_VERTEX);
    places.reserve(positions_.size());
    ordered.reserve(triangles_.size());
    for (uint32_t t : given_) {
        ordered.push_back(triangles_[t]);
        for (uint32_t &v : ordered.back()) {
            if (name[v] == NO_VERTEX) {
                name[v] = uint32_t(places.size());
                places.push_back(positions_[v]);
            }
            v = name[v];
        }
    }
    positions_ = std::move(places);
    triangles_ = std::move(ordered);
}

Bounds::Bounds(const LodSource &source, double pitch, Task &task)
    : pitch_(pitch), task_(task), source_(source.positions, source.triangles, task, 0),
      parts_(part_sizes(source.positions, source.triangles)),
      largest_part_(*std::max_element(parts_.begin(), parts_.end()))
{
}

Strayed Bounds::of(const LodLevel &level, double speck) const
{
    task_.limits.work_again(); /* large sources take several looks a triangle at each level */
    Vector<Vec3d> positions;
    Vector<std::array<uint32_t, 3>> triangles;
    for (size_t i = 0; i < level.positions.size(); i += 3)
        positions.push_back({level.origin[0] + double(level.step) * level.positions[i],
                             level.origin[1] + double(level.step) * level.positions[i + 1],
                             level.origin[2] + double(level.step) * level.positions[i + 2]});
    for (size_t i = 0; i < level.indices.size(); i += 3)
        triangles.push_back({level.indices[i], level.indices[i + 1], level.indices[i + 2]});
    const SortedSurface made(std::move(positions), std::move(triangles), task_, 1);
    const auto any = [](uint32_t) { return true; };
    const auto shown = [&](uint32_t t) {
        return parts_[source_.given(t)] > speck || largest_part_ <= speck;
    };
    Search there = {made, 1, 0, double(level.step) / 2, 0};
    Search back = {source_, STEEPEST, pitch_, double(level.step) / 2, 0};
    Strayed out = sample(source_, shown, there, task_);
    back.found = std::max(out.most, sample(made, any, back, task_).most);
    task_.limits.work_again();
    /* The source first: it takes less, and its spots spare the level most of its looks. */
    there.found = back.found;
    back.found = greatest(source_, shown, there, task_);
    task_.limits.work_again();
    there.found = greatest(made, any, back, task_);
    out.most = there.most();
    return out;
}

} // namespace gtx::baking
