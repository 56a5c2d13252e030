/* Columns and rows of a chart's texels, summed: what a rectangle of them would cost. */
#pragma once

#include "chart/cuts/tree.hpp"

namespace gtx {

/* Sums over heights at texels, to fit a plane to. */
struct Moments {
    double n = 0, u = 0, v = 0, h = 0, uu = 0, uv = 0, vv = 0, uh = 0, vh = 0, hh = 0;

    Moments plus(const Moments &m) const
    {
        return {n + m.n,   u + m.u,   v + m.v,   h + m.h,   uu + m.uu,
                uv + m.uv, vv + m.vv, uh + m.uh, vh + m.vh, hh + m.hh};
    }
    /* Mean square of what the least-squares plane leaves. */
    double residual() const
    {
        if (n < 4)
            return 0;
        double suu = uu - u * u / n, suv = uv - u * v / n, svv = vv - v * v / n;
        double suh = uh - u * h / n, svh = vh - v * h / n, shh = hh - h * h / n;
        double det = suu * svv - suv * suv;
        if (det > 1e-9 * suu * svv) {
            double a = (suh * svv - svh * suv) / det, b = (svh * suu - suh * suv) / det;
            shh -= a * suh + b * svh;
        }
        return std::max(0., shh / n);
    }
};

inline constexpr Rect NOTHING = {{INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN}};

/* A column or row of a node, or several. */
struct Slice {
    Moments moments;
    Rect box = NOTHING;

    Slice plus(const Slice &s) const
    {
        return {moments.plus(s.moments),
                {{std::min(box.low[0], s.box.low[0]), std::min(box.low[1], s.box.low[1])},
                 {std::max(box.high[0], s.box.high[0]), std::max(box.high[1], s.box.high[1])}}};
    }
};

/* Columns or rows of a part of the chart, in order. */
struct Lines {
    int first = 0; /* coordinate of the first */
    Vector<Slice> slices;
};

/* The columns (axis 0) or rows of a box, in parts that end at the coordinates `across` of the other
 * axis, of which the last is where the box ends. */
Vector<Lines> line_parts(const Relief &relief, const Rect &box, int axis,
                         const Vector<int> &across);
/* Those of all of it, where they are not known yet. */
void add_lines(const Relief &relief, const Rect &box, int axis, Lines &lines);

} // namespace gtx
