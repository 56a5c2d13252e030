/* Spreads over a triangle from what lies over its middle: a surface that goes on beyond each of its
 * edges that cross the triangle lies over all of it. */
#include "bake/lod/cover.hpp"

#include <algorithm>
#include <limits>

namespace gtx::baking {

namespace {

/* Of an angle of a triangle: what thinner ones say of places over them is lost in rounding. */
constexpr double MIN_SINE = 1e-6;
/* From a triangle close by to the one over the middle: a limit. */
constexpr int MAX_STEPS = 16;

/* Corners of a triangle over another tell how far it is from it where that is at most this share of
 * what is allowed; else a closer look does. Dragon of 810,080 triangles: at half 47 % more closer
 * looks; at double coarser levels are told less, and 17 % more triangles are looked at. */
constexpr double TIGHT = 0.5;

/* A place over a triangle: the shares of its corners, of which none is below 0 inside, the height
 * over its plane, and a bit of each share that is not above 0. */
struct Over {
    double share[3], height;
    unsigned beside;
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
        const double x = dot(b_, from), y = dot(c_, from), z = 1 - x - y;
        return {{z, x, y}, dot(up_, from),
                unsigned((z <= 0) | (x <= 0) << 1 | (y <= 0) << 2)};
    }

private:
    Vec3d origin_, b_, c_, up_;
    bool is_flat_;
};

/* An edge over the triangle, or beside it. The way between its vertices does not change a bit of
 * what is said of it: both its triangles say the same. */
class Edge {
public:
    Edge(bool up, const Over &from, const Over &to)
        : up_(up), a_(up ? from : to), b_(up ? to : from), x_(b_.share[1] - a_.share[1]),
          y_(b_.share[2] - a_.share[2]), first_(y_ * a_.share[1] - x_ * a_.share[2])
    {
    }
    /* Whether a part of it is over the inside: one of its ends is, or corners are on both sides. */
    bool crosses() const
    {
        if ((a_.beside & b_.beside) || !a_.beside || !b_.beside)
            return !(a_.beside & b_.beside);
        const double second = first_ - y_, third = first_ + x_;
        return !(((first_ >= 0) & (second >= 0) & (third >= 0)) |
                 ((first_ <= 0) & (second <= 0) & (third <= 0)));
    }
    /* Whether the middle is to its left, or on it, of one of the ways. */
    bool has_middle() const
    {
        const double middle = first_ + (x_ - y_) / 3;
        return up_ ? middle >= 0 : middle < 0;
    }
    /* How far to its left a corner is: greater than 0 there. */
    double left(int corner) const
    {
        const double at = corner == 0 ? first_ : corner == 1 ? first_ - y_ : first_ + x_;
        return up_ ? at : -at;
    }
    /* How high or low it is over the triangle; 0 where it is beside it. */
    double height() const
    {
        double from = 0, to = 1;
        for (int k = 0; k < 3; ++k) {
            const double a = a_.share[k], b = b_.share[k];
            if ((a < 0) & (b < 0))
                return 0;
            if (a < 0)
                from = std::max(from, a / (a - b));
            else if (b < 0)
                to = std::min(to, a / (a - b));
        }
        const double way = b_.height - a_.height;
        return from <= to ? greater(a_.height + way * from, a_.height + way * to) : 0;
    }
    /* The magnitude of that with the greater; what is not a number is infinite. */
    static double greater(double a, double b)
    {
        const double most = std::max(std::abs(a), std::abs(b));
        return most < INFINITY && b == b ? most : INFINITY;
    }

private:
    bool up_;
    const Over &a_, &b_;         /* at the lower vertex and the higher */
    double x_, y_, first_;       /* > 0: the first corner is to the left of the way up */
};

/* A triangle of the surface; NO_TRIANGLE beyond its border. Many are made that nobody needs, and
 * begin with nothing. */
struct Placed {
    uint32_t triangle;
    int known;                   /* the side that the surface came over; -1: none */
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
    Cover(const Prism &prism, const SortedSurface &surface, double most, const Reached *beyonds,
          CoverParts &parts)
        : prism_(prism), surface_(surface), most_(most), beyonds_(beyonds), parts_(parts)
    {
    }
    /* That over the middle, in a few steps from one close by; else none. */
    Placed over_middle(uint32_t near) const;
    /* Whether it goes on from one over the middle to all of the triangle. */
    bool spreads(const Placed &middle);

private:
    Placed whole(uint32_t triangle) const;
    void place_beyond(const Placed &from, int side, Placed &to) const;
    Edge edge(const Placed &of, int side) const;
    double height_over(const Placed &of, double enough) const;
    bool is_new(uint32_t triangle) const
    {
        uint32_t same = 0;
        for (size_t i = 0; i < parts_.count; ++i) /* faster than to end where it is found */
            same |= parts_.triangle[i] == triangle;
        return !same;
    }
    size_t add(uint32_t triangle)
    {
        parts_.triangle[parts_.count] = triangle;
        return parts_.count++;
    }

    const Prism &prism_;
    const SortedSurface &surface_;
    const double most_;
    const Reached *beyonds_;
    CoverParts &parts_;
};

Placed Cover::whole(uint32_t triangle) const
{
    const Corners c = surface_.corners(triangle);
    return {triangle, -1, {prism_.place(c[0]), prism_.place(c[1]), prism_.place(c[2])}};
}

/* Its own corner is the only one whose place is not known. */
void Cover::place_beyond(const Placed &from, int side, Placed &to) const
{
    to.triangle = surface_.beside(from.triangle)[side];
    if (to.triangle == NO_TRIANGLE)
        return;
    const int next = side == 2 ? 0 : side + 1;
    const uint32_t last = surface_.vertices(from.triangle)[next];
    const std::array<uint32_t, 3> &v = surface_.vertices(to.triangle);
    const int first = v[0] == last ? 0 : v[1] == last ? 1 : 2, own = (first + 2) % 3;
    to.at[first] = from.at[next];
    to.at[(first + 1) % 3] = from.at[side];
    to.known = first;
    to.at[own] = prism_.place(surface_.corner(to.triangle, own));
}

Edge Cover::edge(const Placed &of, int side) const
{
    const std::array<uint32_t, 3> &v = surface_.vertices(of.triangle);
    const int next = side == 2 ? 0 : side + 1;
    return Edge(v[side] < v[next], of.at[side], of.at[next]);
}

/* How high or low a triangle is over the other: at its corners, where that is within `enough`, else
 * at most where its edges are over the other and where the other's corners are under it. */
double Cover::height_over(const Placed &of, double enough) const
{
    const Over *at = of.at;
    double most = Edge::greater(Edge::greater(at[0].height, at[1].height), at[2].height);
    if (most <= enough)
        return most;
    const Edge edges[3] = {edge(of, 0), edge(of, 1), edge(of, 2)};
    most = 0;
    for (const Edge &e : edges)
        most = Edge::greater(most, e.height());
    for (int corner = 0; corner < 3; ++corner) {
        const double a = edges[1].left(corner), b = edges[2].left(corner),
                     c = edges[0].left(corner);
        if (a >= 0 && b >= 0 && c >= 0)
            most = Edge::greater(most, (at[0].height * a + at[1].height * b + at[2].height * c) /
                                           (a + b + c));
    }
    return most;
}

Placed Cover::over_middle(uint32_t near) const
{
    Placed places[2] = {whole(near), {}};
    for (int n = 0; n < MAX_STEPS; ++n) {
        Placed &at = places[n % 2];
        if (at.triangle == NO_TRIANGLE || !at.faces())
            break;
        int side = 0;
        while (side < 3 && (side == at.known || edge(at, side).has_middle()))
            ++side;
        if (side == 3)
            return at;
        place_beyond(at, side, places[(n + 1) % 2]);
    }
    places[0].triangle = NO_TRIANGLE;
    return places[0];
}

bool Cover::spreads(const Placed &middle)
{
    Placed placed[CoverParts::MAX];
    size_t left[CoverParts::MAX], size = 0;
    placed[0] = middle;
    placed[0].known = -1;        /* nothing is said yet of what came there */
    left[size++] = add(middle.triangle);
    while (size) {
        const size_t slot = left[--size];
        const Placed &at = placed[slot];
        if (!at.faces())
            return false;
        const double more = beyonds_ ? beyonds_->at(at.triangle) : 0;
        const double away = more + height_over(at, TIGHT * most_);
        if (!(away <= most_))
            return false;
        parts_.away[slot] = away;
        for (int side = 0; side < 3; ++side) {
            if (side == at.known || !edge(at, side).crosses())
                continue;
            const uint32_t next = surface_.beside(at.triangle)[side];
            if (next == NO_TRIANGLE)
                return false;
            if (!is_new(next))
                continue;
            if (parts_.count == CoverParts::MAX)
                return false;
            left[size] = add(next);
            place_beyond(at, side, placed[left[size]]);
            ++size;
        }
    }
    return true;
}

} // namespace

uint32_t covering(const Corners &triangle, const SortedSurface &surface, double most,
                  uint32_t near, const Reached *beyonds, CoverParts *parts)
{
    const Prism prism(triangle);
    if (prism.is_flat())
        return NO_PATCH;
    CoverParts none;
    Cover cover(prism, surface, most, beyonds, parts ? *parts : none);
    Placed middle;
    middle.triangle = NO_TRIANGLE;
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
