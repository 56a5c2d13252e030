/* Spreads over a triangle from what lies over its middle: a surface that goes on beyond each of its
 * edges that cross the triangle lies over all of it. */
#include "bake/lod/cover.hpp"

#include <algorithm>
#include <limits>

namespace gtx::baking {

namespace {

/* Of an angle of a triangle: what thinner ones say of places over them is lost in rounding. */
constexpr double MIN_SINE = 1e-6;
/* Triangles that lie over another; at half the dragon's cook takes 3 % more instructions, at double
 * 0.7 % fewer. */
constexpr size_t MAX_OVER = 64;
/* From a triangle close by to the one over the middle: a limit. */
constexpr int MAX_STEPS = 16;

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
    Over place(const Vec3d &point) const
    {
        const Vec3d from = point - origin_;
        const double x = dot(b_, from), y = dot(c_, from);
        return {{1 - x - y, x, y}, dot(up_, from)};
    }

private:
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
    Edge(bool up, const Over &from, const Over &to)
        : up_(up), a_(up ? from.share : to.share), b_(up ? to.share : from.share),
          x_(b_[1] - a_[1]), y_(b_[2] - a_[2]), first_(y_ * a_[1] - x_ * a_[2])
    {
    }
    /* Whether a part of it is over the inside. */
    bool crosses() const
    {
        const double second = first_ - y_, third = first_ + x_;
        return !(((first_ >= 0) & (second >= 0) & (third >= 0)) |
                 ((first_ <= 0) & (second <= 0) & (third <= 0)) |
                 ((a_[0] <= 0) & (b_[0] <= 0)) | ((a_[1] <= 0) & (b_[1] <= 0)) |
                 ((a_[2] <= 0) & (b_[2] <= 0)));
    }
    /* Whether the middle is to its left, or on it, of one of the ways. */
    bool has_middle() const
    {
        const double middle = first_ + (x_ - y_) / 3;
        return up_ ? middle >= 0 : middle < 0;
    }

private:
    bool up_;
    const double *a_, *b_;       /* shares at the lower vertex and the higher */
    double x_, y_, first_;       /* > 0: the first corner is to the left of the way up */
};

/* A triangle of the surface; NO_TRIANGLE beyond its border. */
struct Placed {
    uint32_t triangle = NO_TRIANGLE;
    int known = -1;              /* the side that the surface came over */
    Over at[3];

    bool faces() const
    {
        const double *a = at[0].share, *b = at[1].share, *c = at[2].share;
        return (b[1] - a[1]) * (c[2] - a[2]) > (b[2] - a[2]) * (c[1] - a[1]);
    }
};

/* The part of a surface that lies over a triangle. */
class Cover {
public:
    Cover(const Prism &prism, const SortedSurface &surface, double most)
        : prism_(prism), surface_(surface), most_(most)
    {
    }
    /* That over the middle, in a few steps from one close by; else none. */
    Placed over_middle(uint32_t near) const;
    /* Whether it goes on from one over the middle to all of the triangle. */
    bool spreads(const Placed &middle);

private:
    Placed whole(uint32_t triangle) const;
    Placed beyond(const Placed &from, int side) const;
    Edge edge(const Placed &of, int side) const;
    bool is_new(uint32_t triangle) const
    {
        return std::find(seen_, seen_ + count_, triangle) == seen_ + count_;
    }

    const Prism &prism_;
    const SortedSurface &surface_;
    const double most_;
    uint32_t seen_[MAX_OVER];
    size_t count_ = 0;
};

Placed Cover::whole(uint32_t triangle) const
{
    const Corners c = surface_.corners(triangle);
    return {triangle, -1, {prism_.place(c[0]), prism_.place(c[1]), prism_.place(c[2])}};
}

/* Its own corner is the only one whose place is not known. */
Placed Cover::beyond(const Placed &from, int side) const
{
    Placed to;
    to.triangle = surface_.beside(from.triangle)[side];
    if (to.triangle == NO_TRIANGLE)
        return to;
    const int next = side == 2 ? 0 : side + 1;
    const uint32_t last = surface_.vertices(from.triangle)[next];
    const std::array<uint32_t, 3> &v = surface_.vertices(to.triangle);
    const int first = v[0] == last ? 0 : v[1] == last ? 1 : 2, own = (first + 2) % 3;
    to.at[first] = from.at[next];
    to.at[(first + 1) % 3] = from.at[side];
    to.known = first;
    to.at[own] = prism_.place(surface_.corners(to.triangle)[own]);
    return to;
}

Edge Cover::edge(const Placed &of, int side) const
{
    const std::array<uint32_t, 3> &v = surface_.vertices(of.triangle);
    const int next = side == 2 ? 0 : side + 1;
    return Edge(v[side] < v[next], of.at[side], of.at[next]);
}

Placed Cover::over_middle(uint32_t near) const
{
    Placed at = whole(near);
    for (int n = 0; n < MAX_STEPS && at.triangle != NO_TRIANGLE && at.faces(); ++n) {
        int side = 0;
        while (side < 3 && (side == at.known || edge(at, side).has_middle()))
            ++side;
        if (side == 3)
            return at;
        at = beyond(at, side);
    }
    return {};
}

bool Cover::spreads(const Placed &middle)
{
    Placed left[MAX_OVER + 2];
    size_t size = 0;
    left[0] = middle;
    left[size++].known = -1;     /* nothing is said yet of what came there */
    while (size) {
        const Placed at = left[--size];
        if (at.triangle == NO_TRIANGLE)
            return false;
        if (!is_new(at.triangle))
            continue;
        if (count_ == MAX_OVER || !at.faces() || !is_within(at.at, most_))
            return false;
        seen_[count_++] = at.triangle;
        for (int side = 0; side < 3; ++side)
            if (side != at.known && edge(at, side).crosses() &&
                is_new(surface_.beside(at.triangle)[side]))
                left[size++] = beyond(at, side);
    }
    return true;
}

} // namespace

uint32_t covering(const Corners &triangle, const SortedSurface &surface, double most,
                  uint32_t near)
{
    const Prism prism(triangle);
    if (prism.is_flat())
        return NO_PATCH;
    Cover cover(prism, surface, most);
    Placed middle;
    if (near < surface.size())
        middle = cover.over_middle(near);
    if (middle.triangle == NO_TRIANGLE) {
        near = NO_PATCH;
        surface.tree().nearer(most * most, (triangle[0] + triangle[1] + triangle[2]) / 3, &near,
                              [](uint32_t) { return true; });
        if (near != NO_PATCH)
            middle = cover.over_middle(near);
    }
    return middle.triangle != NO_TRIANGLE && cover.spreads(middle) ? middle.triangle : NO_PATCH;
}

} // namespace gtx::baking
