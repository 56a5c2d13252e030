/* Finds what is farthest outside, vertex by vertex, and moves the triangle below it. */
#include "bake/lod/outlier.hpp"

#include <algorithm>
#include <numeric>

namespace gtx::baking {

/* Each round moves triangles for what is farthest outside at each vertex. Half or double
 * change a few bytes. */
constexpr int ROUNDS = 12;

struct Outlier {
    double height = 0;             /* above the nearest point of the surface; 0: not outside */
    Vec3d way;                     /* from there */
    uint32_t triangle = 0;         /* on which that is */
    std::array<double, 3> share{}; /* and what its corners have of it */
};

/* A triangle, and the way to a point from the nearest of its own, by the shares of its corners. */
struct Reached {
    std::array<Vec3d, 3> corner;
    std::array<double, 3> share;
    Vec3d way;

    Reached(const Simplified &surface, uint32_t triangle, const Vec3d &point)
    {
        const auto &[a, b, d] = surface.triangles[triangle];
        corner = {surface.positions[a], surface.positions[b], surface.positions[d]};
        share = nearest_shares(corner, point);
        way = point - (corner[0] * share[0] + corner[1] * share[1] + corner[2] * share[2]);
    }
};

/* Whether all of a triangle is farther from a point than that: by a ball around it. */
static bool is_beyond(const Simplified &surface, uint32_t triangle, const Vec3d &point, double away)
{
    const auto &[a, b, c] = surface.triangles[triangle];
    const Vec3d *at = surface.positions.data();
    const Vec3d middle = (at[a] + at[b] + at[c]) * (1.0 / 3), from = point - middle;
    double square = 0;
    for (uint32_t v : {a, b, c})
        square = std::max(square, dot(at[v] - middle, at[v] - middle));
    const double reach = away + std::sqrt(square);
    return dot(from, from) > reach * reach;
}

/* A point above the `count` triangles of `near`, where it is farther from them than `most`. Which
 * side it is on is told by those that are all nearest to it: one, or those around an edge or a
 * corner. One of them is no farther than `known`, squared. */
static Outlier find_outlier(const Simplified &surface, const uint32_t *near, size_t count,
                            const Vec3d &point, double most, double known)
{
    const double same = 1 + 1e-9, bound = std::sqrt(known) * same;
    Outlier out;
    Vec3d facing;
    double least = INFINITY;
    for (size_t i = 0; i < count; ++i) {
        if (is_beyond(surface, near[i], point, bound))
            continue;
        const Reached reached(surface, near[i], point);
        const std::array<Vec3d, 3> &c = reached.corner;
        const double distance = dot(reached.way, reached.way);
        if (distance <= most * most)
            return {};
        if (distance > least * same)
            continue;
        const Vec3d area = cross(c[1] - c[0], c[2] - c[0]);
        facing = distance * same < least ? area : facing + area;
        least = std::min(least, distance);
        out.way = reached.way;
        out.triangle = near[i];
        out.share = reached.share;
    }
    out.height = dot(out.way, facing) > 0 ? std::sqrt(least) : 0;
    return out;
}

/* The triangles around a vertex and those around their corners. */
static Vector<uint32_t> find_near(const Simplified &s, uint32_t vertex)
{
    Vector<uint32_t> ring, near;
    for (uint32_t i = s.start[vertex]; i < s.start[vertex + 1]; ++i)
        for (uint32_t v : s.triangles[s.around[i]])
            ring.push_back(v);
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    for (uint32_t v : ring)
        near.insert(near.end(), s.around.begin() + s.start[v], s.around.begin() + s.start[v + 1]);
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    return near;
}

/* The triangles around a vertex: what is above none of their planes by more than `most` is not
 * outside, nor what is as near to any. Of most points this is all that has to be known. */
class Planes {
public:
    Planes(const Simplified &s, uint32_t vertex)
    {
        at_ = s.positions[vertex];
        for (uint32_t i = s.start[vertex]; i < s.start[vertex + 1] && count_ < MAX_FAN; ++i) {
            const auto &[a, b, c] = s.triangles[s.around[i]];
            const Vec3d &at = s.positions[a];
            normal_[count_] = normalize(cross(s.positions[b] - at, s.positions[c] - at));
            middle_[count_++] = normalize(at + s.positions[b] + s.positions[c] - at_ * 3);
        }
        all_ = s.start[vertex + 1] - s.start[vertex] <= uint32_t(MAX_FAN);
    }
    /* The triangle that lies most in the way to a point. */
    uint32_t towards(const Vec3d &point) const
    {
        int best = 0;
        double most = -INFINITY;
        for (int i = 0; i < count_; ++i) {
            const double along = dot(middle_[i], point - at_);
            best = along > most ? i : best;
            most = std::max(most, along);
        }
        return uint32_t(best);
    }
    bool below(const Vec3d &point, double most) const
    {
        double above = -INFINITY;
        for (int i = 0; i < count_; ++i)
            above = std::max(above, dot(normal_[i], point - at_));
        return all_ && above <= most;
    }

private:
    Vec3d normal_[MAX_FAN], middle_[MAX_FAN], at_;
    int count_ = 0;
    bool all_;
};

/* Of the points that a vertex stands for that farthest outside; a height of 0 where none is by more
 * than `most`. Few are, and the triangles around the vertex alone tell of most others. */
static Outlier find_worst(const Simplified &s, uint32_t vertex, double most)
{
    Outlier worst;
    Vector<uint32_t> near;
    const Planes planes(s, vertex);
    const uint32_t *around = s.around.data() + s.start[vertex];
    for (uint32_t i = s.first[vertex]; i < s.first[vertex + 1]; ++i) {
        const double least = std::max(most, worst.height);
        if (planes.below(s.points[i], least))
            continue;
        const Vec3d way = Reached(s, around[planes.towards(s.points[i])], s.points[i]).way;
        const double known = dot(way, way);
        if (known <= least * least ||
            find_outlier(s, around, s.start[vertex + 1] - s.start[vertex], s.points[i], least,
                         known).height == 0)
            continue;
        if (near.empty())
            near = find_near(s, vertex);
        const Outlier o = find_outlier(s, near.data(), near.size(), s.points[i], least, known);
        if (o.height > 0)
            worst = o;
    }
    return worst;
}

/* Which vertices have moved, or one beside them has, since it was made: what was found at those two
 * steps from all of them still holds. */
class Moved {
public:
    explicit Moved(const Simplified &s) : s_(s), near_(s.positions.size(), 0) {}

    void add(uint32_t vertex)
    {
        each_beside(vertex, [this](uint32_t v) { near_[v] = 1; });
    }
    bool near(uint32_t vertex) const
    {
        uint8_t any = 0;
        each_beside(vertex, [&](uint32_t v) { any |= near_[v]; });
        return any;
    }

private:
    template <class Visit> void each_beside(uint32_t vertex, Visit visit) const
    {
        for (uint32_t i = s_.start[vertex]; i < s_.start[vertex + 1]; ++i)
            for (uint32_t v : s_.triangles[s_.around[i]])
                visit(v);
    }

    const Simplified &s_;
    Vector<uint8_t> near_;
};

/* What has nothing outside hardly gets any: later rounds look at the others alone. The corners of a
 * triangle move by what each has of the point below, which moves all of them least. */
void draw_out(const Simplified &surface, double most,
              const std::function<bool(uint32_t, const Vec3d &)> &move, Task &task, double done)
{
    const size_t chunk = 256;
    Vector<uint32_t> left(surface.positions.size());
    std::iota(left.begin(), left.end(), 0u);
    for (int n = 0; n < ROUNDS && !left.empty(); ++n) {
        Vector<Outlier> found(left.size());
        task.parallel((left.size() + chunk - 1) / chunk, [&](size_t of) {
            for (size_t i = of * chunk; i < std::min(left.size(), (of + 1) * chunk); ++i)
                found[i] = find_worst(surface, left[i], most);
        }, done, done);
        Moved moved(surface);
        Vector<uint32_t> still;
        for (size_t i = 0; i < left.size(); ++i) {
            if (found[i].height == 0)
                continue;
            still.push_back(left[i]);
            const Outlier o = moved.near(left[i]) ? find_worst(surface, left[i], most) : found[i];
            if (o.height == 0)
                continue;
            const auto &[a, b, c] = o.share;
            const Vec3d way = o.way * ((1 - most / o.height) / (a * a + b * b + c * c));
            for (int k = 0; k < 3; ++k) {
                const uint32_t v = surface.triangles[o.triangle][k];
                if (o.share[k] > 0 && move(v, way * o.share[k]))
                    moved.add(v);
            }
        }
        left.swap(still);
    }
}

} // namespace gtx::baking
