/* A box and a triangle, for nearest-point queries. */
#pragma once

#include "mesh/vec.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

namespace gtx {

struct Box {
    static constexpr float HUGE_F = std::numeric_limits<float>::infinity();
    Vec3f low{HUGE_F, HUGE_F, HUGE_F}, high{-HUGE_F, -HUGE_F, -HUGE_F};

    /* Rounded outwards. */
    void add(const Vec3d &p)
    {
        for (int k = 0; k < 3; ++k) {
            const float at = float(p[k]);
            low[k] = std::min(low[k], at <= p[k] ? at : -above(-at));
            high[k] = std::max(high[k], at >= p[k] ? at : above(at));
        }
    }
    bool touches(const Box &b) const
    {
        bool apart = false;
        for (int k = 0; k < 3; ++k)
            apart |= low[k] > b.high[k] || high[k] < b.low[k];
        return !apart;
    }
    /* The next float: std::nextafter in a few instructions. */
    static float above(float at)
    {
        int32_t bits;
        std::memcpy(&bits, &at, sizeof bits);
        bits = at == 0 ? 1 : at > 0 ? bits + 1 : bits - 1;
        std::memcpy(&at, &bits, sizeof bits);
        return at;
    }
    void add(const Box &b)
    {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], b.low[k]);
            high[k] = std::max(high[k], b.high[k]);
        }
    }
    Vec3d centre() const { return (Vec3d(low) + Vec3d(high)) * 0.5; }
    double distance2(const Vec3d &p) const
    {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            const double d = std::max(std::max(low[k] - p[k], p[k] - high[k]), 0.);
            sum += d * d;
        }
        return sum;
    }
};

/* A triangle as its distances want it. */
struct NearTriangle {
    Vec3d a, b, ab, ac, across;
    double bb = 0, bc = 0, cc = 0, area = 0;

    NearTriangle() = default;
    NearTriangle(const Vec3d &a, const Vec3d &b, const Vec3d &c)
        : a(a), b(b), ab(b - a), ac(c - a), across(c - b), bb(dot(ab, ab)), bc(dot(ab, ac)),
          cc(dot(ac, ac)), area(bb * cc - bc * bc)
    {
    }
    /* Where p is over the triangle (by its barycentric coordinates v and w, times `area`) to the
     * plane, else to those sides that p is outside of. Rounding may pick another point of the
     * triangle, never one beside it. */
    double distance2(const Vec3d &p) const
    {
        const Vec3d d = p - a;
        const double db = dot(d, ab), dc = dot(d, ac);
        const double v = cc * db - bc * dc, w = bb * dc - bc * db;
        const bool flat = !(area > 0);
        if (!flat && v >= 0 && w >= 0 && v + w <= area) {
            const Vec3d off = d - ab * (v / area) - ac * (w / area);
            return dot(off, off);
        }
        double best = std::numeric_limits<double>::infinity();
        if (flat || w < 0)
            best = beside(d, ab, db, bb);
        if (flat || v < 0)
            best = std::min(best, beside(d, ac, dc, cc));
        if (flat || v + w > area)
            best = std::min(best, beside(p - b, across, dot(p - b, across), dot(across, across)));
        return best;
    }

    /* How far a point is over the inside of a side, in a measure of that side; below 0 beyond it.
     * Sides are those from a to b, from b to c and from c to a. */
    std::array<double, 3> inside(const Vec3d &p) const
    {
        const Vec3d d = p - a;
        const double db = dot(d, ab), dc = dot(d, ac);
        const double v = cc * db - bc * dc, w = bb * dc - bc * db;
        return {w, area - v - w, v};
    }

private:
    static double beside(const Vec3d &from_start, const Vec3d &edge, double along, double square)
    {
        const double s = square > 0 ? std::clamp(along / square, 0., 1.) : 0;
        const Vec3d off = from_start - edge * s;
        return dot(off, off);
    }
};

/* The squared distance from p to the triangle abc. */
inline double triangle_distance2(const Vec3d &p, const Vec3d &a, const Vec3d &b, const Vec3d &c)
{
    return NearTriangle(a, b, c).distance2(p);
}

/* By which shares of its corners a triangle is nearest to a point. */
inline std::array<double, 3> nearest_shares(const std::array<Vec3d, 3> &c, const Vec3d &point)
{
    const Vec3d x = c[1] - c[0], y = c[2] - c[0], p = point - c[0];
    const double xx = dot(x, x), xy = dot(x, y), yy = dot(y, y), px = dot(p, x), py = dot(p, y);
    const double whole = xx * yy - xy * xy, b = yy * px - xy * py, d = xx * py - xy * px;
    if (whole > 0 && b >= 0 && d >= 0 && b + d <= whole)
        return {(whole - b - d) / whole, b / whole, d / whole};
    std::array<double, 3> best = {1, 0, 0};
    double least = std::numeric_limits<double>::infinity();
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

} // namespace gtx
