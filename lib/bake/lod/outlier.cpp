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

/* By which shares of its corners a triangle is nearest to a point. */
static std::array<double, 3> nearest_shares(const std::array<Vec3d, 3> &c, const Vec3d &point)
{
    const Vec3d x = c[1] - c[0], y = c[2] - c[0], p = point - c[0];
    const double xx = dot(x, x), xy = dot(x, y), yy = dot(y, y), px = dot(p, x), py = dot(p, y);
    const double whole = xx * yy - xy * xy, b = yy * px - xy * py, d = xx * py - xy * px;
    if (whole > 0 && b >= 0 && d >= 0 && b + d <= whole)
        return {(whole - b - d) / whole, b / whole, d / whole};
    std::array<double, 3> best = {1, 0, 0};
    double least = INFINITY;
    for (int k = 0; k < 3; ++k) {
        const int n = (k + 1) % 3;
        const Vec3d edge = c[n] - c[k], from = point - c[k];
        const double size = dot(edge, edge);
        const double at = size > 0 ? std::clamp(dot(from, edge) / size, 0.0, 1.0) : 0;
        const Vec3d way = from - edge * at;
        if (dot(way, way) >= least)
            continue;
        least = dot(way, way);
        best = {0, 0, 0};
        best[k] = 1 - at;
        best[n] = at;
    }
    return best;
}

/* A point above the `count` triangles of `near`, where it is farther from them than `most`. Which
 * side it is on is told by those that are all nearest to it: one, or those around an edge or a
 * corner. */
static Outlier find_outlier(const Simplified &surface, const uint32_t *near, size_t count,
                            const Vec3d &point, double most)
{
    const double same = 1 + 1e-9;
    Outlier out;
    Vec3d facing;
    double least = INFINITY;
    for (size_t i = 0; i < count; ++i) {
        const auto &[a, b, d] = surface.triangles[near[i]];
        const std::array<Vec3d, 3> c = {surface.positions[a], surface.positions[b],
                                        surface.positions[d]};
        const std::array<double, 3> share = nearest_shares(c, point);
        const Vec3d way = point - (c[0] * share[0] + c[1] * share[1] + c[2] * share[2]);
        const double distance = dot(way, way);
        if (distance <= most * most)
            return {};
        if (distance > least * same)
            continue;
        const Vec3d area = cross(c[1] - c[0], c[2] - c[0]);
        facing = distance * same < least ? area : facing + area;
        least = std::min(least, distance);
        out.way = way;
        out.triangle = near[i];
        out.share = share;
    }
    out.height = dot(out.way, facing) > 0 ? std::sqrt(least) : 0;
    return out;
}

/* The triangles around a vertex and those around their corners. */
static Vector<uint32_t> find_near(const Simplified &s, uint32_t vertex)
{
    Vector<uint32_t> near;
    for (uint32_t i = s.start[vertex]; i < s.start[vertex + 1]; ++i)
        for (uint32_t v : s.triangles[s.around[i]])
            near.insert(near.end(), s.around.begin() + s.start[v],
                        s.around.begin() + s.start[v + 1]);
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    return near;
}

/* The planes of the triangles around a vertex: what is above none of them by more than `most` is
 * not outside. Of most points this is all that has to be known. */
class Planes {
public:
    Planes(const Simplified &s, uint32_t vertex)
    {
        for (uint32_t i = s.start[vertex]; i < s.start[vertex + 1] && count_ < MAX_FAN; ++i) {
            const auto &[a, b, c] = s.triangles[s.around[i]];
            const Vec3d &at = s.positions[a];
            normal_[count_++] = normalize(cross(s.positions[b] - at, s.positions[c] - at));
        }
        at_ = s.positions[vertex];
        all_ = s.start[vertex + 1] - s.start[vertex] <= uint32_t(MAX_FAN);
    }
    bool below(const Vec3d &point, double most) const
    {
        double above = -INFINITY;
        for (int i = 0; i < count_; ++i)
            above = std::max(above, dot(normal_[i], point - at_));
        return all_ && above <= most;
    }

private:
    Vec3d normal_[MAX_FAN], at_;
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
    for (uint32_t i = s.first[vertex]; i < s.first[vertex + 1]; ++i) {
        const double least = std::max(most, worst.height);
        if (planes.below(s.points[i], least))
            continue;
        if (find_outlier(s, s.around.data() + s.start[vertex],
                         s.start[vertex + 1] - s.start[vertex], s.points[i], least).height == 0)
            continue;
        if (near.empty())
            near = find_near(s, vertex);
        const Outlier o = find_outlier(s, near.data(), near.size(), s.points[i], least);
        if (o.height > 0)
            worst = o;
    }
    return worst;
}

/* What has nothing outside hardly gets any: later rounds look at the others alone. The corners of a
 * triangle move by what each has of the point below, which moves all of them least. */
void draw_out(const Simplified &surface, double most,
              const std::function<void(uint32_t, const Vec3d &)> &move, Task &task, double done)
{
    const size_t chunk = 256;
    Vector<uint32_t> left(surface.positions.size());
    std::iota(left.begin(), left.end(), 0u);
    for (int n = 0; n < ROUNDS && !left.empty(); ++n) {
        Vector<uint8_t> has_any(left.size());
        task.parallel((left.size() + chunk - 1) / chunk, [&](size_t of) {
            for (size_t i = of * chunk; i < std::min(left.size(), (of + 1) * chunk); ++i)
                has_any[i] = find_worst(surface, left[i], most).height > 0;
        }, done, done);
        Vector<uint32_t> still;
        for (size_t i = 0; i < left.size(); ++i)
            if (has_any[i])
                still.push_back(left[i]);
        left.swap(still);
        for (uint32_t v : left) {
            const Outlier o = find_worst(surface, v, most); /* others may have moved */
            if (o.height == 0)
                continue;
            const auto &[a, b, c] = o.share;
            const Vec3d way = o.way * ((1 - most / o.height) / (a * a + b * b + c * c));
            for (int k = 0; k < 3; ++k)
                if (o.share[k] > 0)
                    move(surface.triangles[o.triangle][k], way * o.share[k]);
        }
    }
}

} // namespace gtx::baking
