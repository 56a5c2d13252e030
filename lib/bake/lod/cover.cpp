/* Adds up the edges over a triangle: where a surface goes on beyond each of them, it lies over all
 * of the triangle if it does over the middle. */
#include "bake/lod/cover.hpp"

#include <algorithm>
#include <limits>

namespace gtx::baking {

namespace {

/* Of an angle of a triangle: what thinner ones say of places over them is lost in rounding. */
constexpr double MIN_SINE = 1e-6;

/* A place over a triangle: the shares of its corners, of which none is below 0 inside, and the
 * height over its plane. */
struct Over {
    double share[3], height;
};

class Prism {
public:
    explicit Prism(const Corners &t) : origin_(t[0])
    {
        const Vec3d b = t[1] - t[0], c = t[2] - t[0], normal = cross(b, c);
        const double square = dot(normal, normal);
        is_flat_ = !(square > MIN_SINE * MIN_SINE * dot(b, b) * dot(c, c)) ||
                   !(square > std::numeric_limits<double>::min());
        up_ = normal / std::sqrt(square);
        b_ = cross(c, normal) / square;
        c_ = cross(normal, b) / square;
    }
    bool is_flat() const { return is_flat_; }
    const Vec3d &up() const { return up_; }
    /* Whether corners are not all beside it, and where they are then. */
    bool place(const Corners &corners, Over (&at)[3]) const
    {
        Vec3d from[3];
        for (int k = 0; k < 3; ++k) {
            from[k] = corners[k] - origin_;
            at[k].share[1] = dot(b_, from[k]);
        }
        if (are_beside(at, 1))
            return false;
        for (int k = 0; k < 3; ++k) {
            at[k].share[2] = dot(c_, from[k]);
            at[k].share[0] = 1 - at[k].share[1] - at[k].share[2];
            at[k].height = dot(up_, from[k]);
        }
        return !are_beside(at, 2) && !are_beside(at, 0);
    }

private:
    static bool are_beside(const Over (&at)[3], int k)
    {
        return (at[0].share[k] <= 0) & (at[1].share[k] <= 0) & (at[2].share[k] <= 0);
    }

    Vec3d origin_, b_, c_, up_;
    bool is_flat_;
};

/* Of a triangle what lies over another, clipped side by side. A side adds a corner; one through a
 * corner may for rounding be crossed again and again, and adds half as many as there are. */
struct Piece {
    static constexpr int MAX = 9;
    Over corner[MAX];
    int count = 3;

    void clip(int k)
    {
        Over left[MAX];
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const Over &from = corner[i], &to = corner[i + 1 < count ? i + 1 : 0];
            const double a = from.share[k], b = to.share[k];
            if (a >= 0)
                left[kept++] = from;
            if ((a < 0) != (b < 0)) {
                const double t = a / (a - b);
                Over &at = left[kept++];
                for (int j = 0; j < 3; ++j)
                    at.share[j] = from.share[j] + (to.share[j] - from.share[j]) * t;
                at.height = from.height + (to.height - from.height) * t;
            }
        }
        std::copy_n(left, kept, corner);
        count = kept;
    }
    bool is_within(double most) const
    {
        bool all = true;
        for (int i = 0; i < count; ++i)
            all = all && std::abs(corner[i].height) <= most;
        return all;
    }
};

/* Whether a triangle is nowhere higher or lower over the other than `most`. */
bool is_within(const Over (&at)[3], double most)
{
    Piece piece = {{at[0], at[1], at[2]}};
    for (int k = 0; k < 3 && !piece.is_within(most); ++k)
        piece.clip(k);
    return piece.is_within(most);
}

/* An edge over the triangle, or beside it. The way between its vertices does not change a bit of
 * what is said of it: both its triangles say the same. */
class Edge {
public:
    Edge(uint32_t from, uint32_t to, const Over &at_from, const Over &at_to)
        : up_(from < to), low_(up_ ? from : to), high_(up_ ? to : from)
    {
        const double *a = up_ ? at_from.share : at_to.share;
        const double *b = up_ ? at_to.share : at_from.share;
        const double x = b[1] - a[1], y = b[2] - a[2];
        const double first = y * a[1] - x * a[2], second = first - y, third = first + x;
        centre_ = first + (x - y) / 3;
        crosses_ = !((std::min({first, second, third}) >= 0) |
                     (std::max({first, second, third}) <= 0) |
                     (std::max(a[0], b[0]) <= 0) | (std::max(a[1], b[1]) <= 0) |
                     (std::max(a[2], b[2]) <= 0));
    }
    /* Whether a part of it is over the inside. */
    bool crosses() const { return crosses_; }
    /* Whether the middle is to its left, or on it, of one of the ways. */
    bool has_middle() const { return up_ ? centre_ >= 0 : centre_ < 0; }
    /* The negative number the other way. */
    uint64_t number() const
    {
        uint64_t n = (uint64_t(low_) << 32 | high_) * 0x9e3779b97f4a7c15u;
        n = (n ^ n >> 29) * 0xbf58476d1ce4e5b9u;
        n ^= n >> 32;
        return up_ ? n : 0 - n;
    }

private:
    bool up_, crosses_;
    uint32_t low_, high_;
    double centre_;              /* > 0: the middle is to the left of the way up */
};

/* What lies over a triangle. */
struct Sum {
    double most;
    uint32_t middle = NO_PATCH;  /* a triangle over the middle */
    /* Numbers of the edges, 0 where all have both their triangles: other sums of 64 bits are that
     * as seldom as any number. */
    uint64_t edges = 0;

    void add(uint32_t triangle, const std::array<uint32_t, 3> &vertices, const Over (&at)[3])
    {
        const double *a = at[0].share, *b = at[1].share, *c = at[2].share;
        if (!((b[1] - a[1]) * (c[2] - a[2]) > (b[2] - a[2]) * (c[1] - a[1])))
            return; /* turned away */
        bool has_middle = true, crosses = false;
        uint64_t sum = 0;
        for (int k = 0; k < 3; ++k) {
            const int next = k == 2 ? 0 : k + 1;
            const Edge edge(vertices[k], vertices[next], at[k], at[next]);
            has_middle = has_middle && edge.has_middle();
            if (edge.crosses()) {
                crosses = true;
                sum += edge.number();
            }
        }
        if ((!crosses && !has_middle) || !is_within(at, most))
            return;
        edges += sum;
        middle = has_middle ? triangle : middle;
    }
};

} // namespace

uint32_t covering(const Corners &triangle, const SortedSurface &surface, double most,
                  uint32_t near)
{
    const Prism prism(triangle);
    if (prism.is_flat())
        return NO_PATCH;
    gtx::Box around;
    for (const Vec3d &p : triangle) {
        around.add(p + prism.up() * most);
        around.add(p - prism.up() * most);
    }
    Sum sum = {most};
    surface.tree().visit_around(near, [&](const gtx::Box &box) { return !around.touches(box); },
                                [&](uint32_t t) {
        Over at[3];
        if (prism.place(surface.corners(t), at))
            sum.add(t, surface.vertices(t), at);
    });
    return sum.edges == 0 ? sum.middle : NO_PATCH;
}

} // namespace gtx::baking
