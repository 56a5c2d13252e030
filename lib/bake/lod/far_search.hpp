/* Where a surface is far from another: its triangles are split where the other may be farther from
 * them than from any point looked at so far. */
#pragma once

#include "bake/lod/parts.hpp"
#include "mesh/mesh.hpp"
#include "mesh/nearest.hpp"

#include <atomic>

namespace gtx::baking {

/* The bound that is told, as a multiple of the farthest point found: at 1.05 twice as many
 * triangles are split, at 1.2 levels are used that much nearer than they might. */
constexpr double LOOSE = 1.1;
/* So many of the last triangles that were nearest are tried before the tree is asked; 7 take as
 * long, 15 a tenth more. */
constexpr size_t EARLIER = 3;

/* Triangles, for NearestTree. */
struct Surface {
    const Vector<Vec3d> &positions;
    const Vector<std::array<uint32_t, 3>> &triangles;

    size_t size() const { return triangles.size(); }
    size_t looks(size_t) const { return 1; }
    std::array<Vec3d, 3> corners(size_t t) const
    {
        const auto &[a, b, c] = triangles[t];
        return {positions[a], positions[b], positions[c]};
    }
    gtx::Box box(size_t t) const
    {
        gtx::Box box;
        for (const Vec3d &p : corners(t))
            box.add(p);
        return box;
    }
    double distance2(size_t t, const Vec3d &p, double) const
    {
        const std::array<Vec3d, 3> c = corners(t);
        return triangle_distance2(p, c[0], c[1], c[2]);
    }
};

/* A surface and a tree of its triangles, which have the order of the tree. */
class SortedSurface {
public:
    /* `in_order`: triangles have that of one already, but for a few. */
    SortedSurface(Vector<Vec3d> positions, Vector<std::array<uint32_t, 3>> triangles, Task &task,
                  double done, bool in_order = false);
    SortedSurface(const SortedSurface &) = delete;
    SortedSurface &operator=(const SortedSurface &) = delete;

    size_t size() const { return triangles_.size(); }
    std::array<Vec3d, 3> corners(size_t t) const { return shapes_.corners(t); }
    const Vec3d &corner(size_t t, int k) const { return positions_[triangles_[t][k]]; }
    size_t vertex_count() const { return positions_.size(); }
    const Vec3d &position(size_t vertex) const { return positions_[vertex]; }
    const std::array<uint32_t, 3> &vertices(size_t t) const { return triangles_[t]; }
    /* The triangles that go on beyond its edges, the first from corner 0 to corner 1, the same way
     * round; NO_TRIANGLE where none or several do. */
    const std::array<uint32_t, 3> &beside(size_t t) const { return beside_[t]; }
    double mean_area() const { return mean_area_; }
    const NearestTree<Surface> &tree() const { return tree_; }
    /* Which of those that were given triangle t is. */
    uint32_t given(size_t t) const { return given_[t]; }

private:
    Vector<Vec3d> positions_;
    Vector<std::array<uint32_t, 3>> triangles_;
    Surface shapes_;
    NearestTree<Surface> tree_;
    Vector<uint32_t> given_;
    Vector<std::array<uint32_t, 3>> beside_;
    double mean_area_ = 0;
};

/* A distance of each triangle of a surface: the greatest that any thread tells. */
class Reached {
public:
    explicit Reached(size_t triangles) : away_(triangles) {}

    void tell(size_t triangle, double away)
    {
        if (away > at(triangle)) /* mostly it is not */
            raise(triangle, away);
    }
    void set(size_t triangle, double away)
    {
        away_[triangle].store(rounded_up(away), std::memory_order_relaxed);
    }
    double at(size_t triangle) const
    {
        return double(away_[triangle].load(std::memory_order_relaxed));
    }
    static float rounded_up(double away)
    {
        const float near = float(away);
        return double(near) < away ? gtx::Box::above(near) : near;
    }

private:
    void raise(size_t triangle, double away);

    Vector<std::atomic<float>> away_;
};

/* A point, and how far it was from the nearest triangle at the time. */
struct FarCorner {
    Vec3d at;
    uint32_t near = NO_PATCH;
    double away = 0;             /* squared */
};

/* A triangle that was the nearest, and its box. */
struct KnownTriangle {
    uint32_t triangle = NO_PATCH;
    NearTriangle shape = {};
    double beyond = 0;           /* as in FarSearch */
    Vec3d low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};

    KnownTriangle() = default;
    KnownTriangle(uint32_t triangle, const NearTriangle &shape, double beyond)
        : triangle(triangle), shape(shape), beyond(beyond)
    {
        for (const Vec3d &p : {shape.a, shape.b, shape.a + shape.ac})
            for (int k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], p[k]);
                high[k] = std::max(high[k], p[k]);
            }
    }
    /* The squared distance; infinity where it is greater than `limit`. */
    double distance2(const Vec3d &p, double limit) const
    {
        for (int k = 0; k < 3; ++k)
            if (!(p[k] >= low[k] - limit && p[k] <= high[k] + limit))
                return INFINITY;
        const double square = shape.distance2(p);
        return square <= limit * limit ? square : INFINITY;
    }
};

/* A point of a triangle, the triangle that is nearest to it, and how far that is. */
struct FarPlace {
    Vec3d at;
    uint32_t near = NO_PATCH;
    double away = 0;
    int corner = -1;             /* of the triangle, where it is one */
};

/* From triangles to a surface. What is said to be within a distance is told: to `reached`, of the
 * triangles that it is within that distance of, and to `reach`. */
struct FarSearch {
    const SortedSurface &to;
    double free;                 /* a distance of no interest */
    double found;                /* the greatest so far */
    FarCorner farthest = {};     /* where that was */
    uint32_t near = NO_PATCH;    /* the triangle of `to` that was nearest last */
    NearTriangle nearest = {};   /* that */
    KnownTriangle earlier[EARLIER] = {}; /* others that were */
    size_t next = 0;
    Reached *reached = nullptr;
    double before = 0;           /* that is added to what `reached` is told */
    double reach = 0;
    /* Where `to` stands for what is beyond it: how far beyond each of its triangles that may be,
     * and beyond `near`. */
    const Reached *beyonds = nullptr;
    double beyond = 0;

    double most() const { return std::max(free, LOOSE * found); }
    bool is_within(FarCorner &c, double square) const
    {
        if (c.near != near) {
            c.near = near;
            c.away = nearest.distance2(c.at);
        }
        return c.away <= square;
    }
    void tell(uint32_t triangle, double away)
    {
        reach = std::max(reach, away);
        if (reached)
            reached->tell(triangle, before + away);
    }
    /* That all of a triangle is at most so near to the nearest, or nearer: its corners tell. */
    void tell_near(const Corners &c, double most)
    {
        double square = 0;
        for (const Vec3d &p : c)
            square = std::max(square, nearest.distance2(p));
        tell(near, std::min(most, std::sqrt(square)) + beyond);
    }
    /* Whether that triangle is within most() of all that the corners span: distances from a convex
     * set are greatest at corners. */
    bool is_covered(FarCorner &a, FarCorner &b, FarCorner &c)
    {
        const double limit = most() - beyond, square = limit * limit;
        if (!(near < to.size() && limit >= 0 && is_within(a, square) && is_within(b, square) &&
              is_within(c, square)))
            return false;
        tell(near, std::sqrt(std::max({a.away, b.away, c.away})) + beyond);
        return true;
    }
    /* The same of an earlier one, which becomes the nearest. */
    bool was_covered(const FarCorner &a, const FarCorner &b, const FarCorner &c)
    {
        for (KnownTriangle &known : earlier) {
            const double limit = most() - known.beyond;
            double square = limit >= 0 ? known.distance2(a.at, limit) : INFINITY;
            for (const FarCorner *corner : {&b, &c})
                if (square < INFINITY)
                    square = std::max(square, known.distance2(corner->at, limit));
            if (!(square < INFINITY))
                continue;
            tell(known.triangle, std::sqrt(square) + known.beyond);
            const KnownTriangle last(near, nearest, beyond);
            near = known.triangle;
            nearest = known.shape;
            beyond = known.beyond;
            known = last;
            return true;
        }
        return false;
    }
    /* Not told to `reach`. */
    bool is_covered(const gtx::Box &box) const
    {
        const double limit = most() * most();
        if (near >= to.size())
            return false;
        double square = 0;
        for (int corner = 0; corner < 8; ++corner) {
            Vec3d p;
            for (int k = 0; k < 3; ++k)
                p[k] = corner >> k & 1 ? box.high[k] : box.low[k];
            square = std::max(square, nearest.distance2(p));
            if (!(square <= limit))
                return false;
        }
        if (reached)
            reached->tell(near, before + std::sqrt(square));
        return true;
    }
    double distance(const Vec3d &p, double enough)
    {
        const uint32_t last = near;
        const double known = near < to.size() ? nearest.distance2(p) : INFINITY;
        const double square =
            near < to.size()
                ? to.tree().nearer_around(known, p, &near, enough * enough)
                : to.tree().nearer(known, p, &near, [](uint32_t) { return true; }, nullptr,
                                   enough * enough);
        if (near != last)
            remember(last);
        return std::sqrt(square);
    }
    /* That another was nearest before. */
    void remember(uint32_t last)
    {
        earlier[next] = last < to.size() ? KnownTriangle(last, nearest, beyond) : KnownTriangle();
        next = (next + 1) % EARLIER;
        const Corners c = to.corners(near);
        nearest = {c[0], c[1], c[2]};
        beyond = beyonds ? beyonds->at(near) : 0;
    }
    /* Whether a triangle that the surface's edge beside the nearest triangle cuts in two is as near
     * to those two. */
    bool is_covered_by_two(const FarCorner &a, const FarCorner &b, const FarCorner &c);
    /* Whether the surface covers a triangle that near to it. */
    bool is_covered_whole(const Corners &c);
    /* Where a triangle is farther than `free`: at a corner, if any of them is, else where it is
     * farthest of what was looked at. An `away` of 0: nowhere. */
    FarPlace find_far(const Corners &c)
    {
        look(c);
        const FarPlace inside = {farthest.at, farthest.near, found, -1};
        found = 0; /* the next is another's */
        if (inside.away <= free)
            return {};
        for (int k = 0; k < 3; ++k) {
            const double away = distance(c[k], free);
            if (away > free)
                return {c[k], near, away, k};
        }
        return inside;
    }
    /* Whether all of a triangle is sure to be within `free`; what may be by little is not. */
    bool is_within(const Corners &c)
    {
        FarCorner a = {c[0]}, b = {c[1]}, d = {c[2]};
        return is_within(a, b, d);
    }
    bool is_within(FarCorner &a, FarCorner &b, FarCorner &c);
    void look(const Corners &c)
    {
        FarCorner a = {c[0]}, b = {c[1]}, d = {c[2]};
        look(a, b, d);
    }
    void look(FarCorner &a, FarCorner &b, FarCorner &c);
};

} // namespace gtx::baking
