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
/* Triangles of a surface that start from the same knowledge, whatever the number of threads. */
constexpr size_t CHUNK = 4096;

namespace {

/* From triangles to a surface. */
struct Search {
    const Surface &to;
    const NearestTree<Surface> &tree;
    double slope;                /* how fast distances may change along a triangle */
    double least;                /* triangles of a smaller radius are not split */
    double free;                 /* a distance of no interest */
    double found;                /* the greatest so far */
    uint32_t near = NO_PATCH;    /* the triangle of `to` that was nearest last */

    double most() const { return std::max(free, LOOSE * found); }
    /* Whether that triangle is within most() of all that the corners span: distances from a convex
     * set are greatest at corners. */
    bool is_covered(const Corners &c) const
    {
        const double limit = most() * most();
        return near < to.size() && to.distance2(near, c[0], limit) <= limit &&
               to.distance2(near, c[1], limit) <= limit && to.distance2(near, c[2], limit) <= limit;
    }
    double distance(const Vec3d &p, double enough)
    {
        const double square = tree.distance2(
            p, &near, [](uint32_t) { return true; }, nullptr, enough * enough);
        return std::sqrt(square);
    }
    void look(const Corners &c);
};

void Search::look(const Corners &c)
{
    cancel_point();
    if (is_covered(c))
        return;
    const Vec3d middle = (c[0] + c[1] + c[2]) / 3;
    const double radius =
        std::max({length(c[0] - middle), length(c[1] - middle), length(c[2] - middle)});
    const double enough = std::max(0.0, most() - slope * radius), away = distance(middle, enough);
    if (away <= enough)
        return;
    found = std::max(found, away);
    if (away + slope * radius <= most() || radius <= least || is_covered(c))
        return;
    const Vec3d side[3] = {(c[1] + c[2]) / 2, (c[2] + c[0]) / 2, (c[0] + c[1]) / 2};
    look({side[0], side[1], side[2]});
    look({c[0], side[2], side[1]});
    look({side[2], c[1], side[0]});
    look({side[1], side[0], c[2]});
}

} // namespace

/* `skipped`: triangles of `from` that are left out, or empty. */
static double greatest(const Surface &from, const Vector<uint8_t> &skipped, const Search &start,
                       Task &task)
{
    const size_t chunks = (from.size() + CHUNK - 1) / CHUNK;
    Vector<double> found(chunks, 0);
    task.parallel(chunks, [&](size_t n) {
        Search search = start;
        for (size_t t = n * CHUNK; t < std::min(from.size(), (n + 1) * CHUNK); ++t)
            if (skipped.empty() || !skipped[t])
                search.look(from.corners(t));
        found[n] = search.found;
    }, 1, 1);
    return *std::max_element(found.begin(), found.end());
}

/* The first points: their greatest distance, and the root of the mean square. */
static Strayed sample(const Surface &from, const Vector<uint8_t> &skipped, const Search &start,
                      Task &task)
{
    const size_t step = (from.size() + FIRST - 1) / FIRST, count = (from.size() + step - 1) / step;
    const size_t chunk = 256;
    Vector<double> away(count, -1);
    task.parallel((count + chunk - 1) / chunk, [&](size_t n) {
        Search search = start;
        for (size_t i = n * chunk; i < std::min(count, (n + 1) * chunk); ++i)
            if (skipped.empty() || !skipped[i * step])
                away[i] = search.distance(from.corners(i * step)[0], start.free);
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

Bounds::Bounds(const LodSource &source, double pitch, Task &task)
    : source_{source.positions, source.triangles}, pitch_(pitch), task_(task), tree_(source_)
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
    const Surface made = {positions, triangles};
    const NearestTree<Surface> tree(made);
    const Vector<uint8_t> none;
    const Vector<uint8_t> specks =
        speck > 0 ? find_specks(source_.positions, source_.triangles, speck) : none;
    Search there = {made, tree, 1, 0, double(level.step) / 2, 0};
    Search back = {source_, tree_, STEEPEST, pitch_, double(level.step) / 2, 0};
    Strayed out = sample(source_, specks, there, task_);
    back.found = std::max(out.most, sample(made, none, back, task_).most);
    task_.limits.work_again();
    /* The source first: it takes less, and its spots spare the level most of its looks. */
    there.found = back.found;
    back.found = greatest(source_, specks, there, task_);
    task_.limits.work_again();
    there.found = greatest(made, none, back, task_);
    out.most = there.most();
    return out;
}

} // namespace gtx::baking
