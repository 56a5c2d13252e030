/* Closed models of few triangles, as OBJ: what modellers make, where every edge is sharp. */
#pragma once

#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

struct Coarse {
    using Point = std::array<double, 3>;
    std::vector<Point> points;
    std::vector<std::array<size_t, 3>> triangles;

    /* A ring of a body: its centre, half axes in x and z, and how its middle is shifted. */
    struct Ring {
        double x, y, z, rx, rz;
    };

    /* Rings joined along y from the first, lowest to the last, closed by flat ends. A ring without
     * half axes is a tip. */
    void loft(const std::vector<Ring> &rings, size_t sides, double turn = 0)
    {
        std::vector<std::vector<size_t>> rows;
        for (const Ring &r : rings) {
            std::vector<size_t> row;
            const size_t count = r.rx > 0 ? sides : 1;
            for (size_t i = 0; i < count; ++i) {
                const double a = 2 * PI * (double(i) / double(sides)) + turn;
                row.push_back(add({r.x + r.rx * std::cos(a), r.y, r.z - r.rz * std::sin(a)}));
            }
            rows.push_back(row);
        }
        for (size_t j = 0; j + 1 < rows.size(); ++j)
            for (size_t i = 0; i < sides; ++i) {
                const size_t n = (i + 1) % sides;
                auto at = [&](size_t row, size_t k) { return rows[row][k % rows[row].size()]; };
                face(at(j, i), at(j, n), at(j + 1, n));
                face(at(j, i), at(j + 1, n), at(j + 1, i));
            }
        for (size_t i = 1; i + 1 < sides; ++i) {
            if (rows.front().size() > 1)
                face(rows.front()[0], rows.front()[i + 1], rows.front()[i]);
            if (rows.back().size() > 1)
                face(rows.back()[0], rows.back()[i], rows.back()[i + 1]);
        }
    }
    void box(const Point &low, const Point &high)
    {
        prism({{low[0], low[2]}, {high[0], low[2]}, {high[0], high[2]}, {low[0], high[2]}}, low[1],
              high[1]);
    }
    /* An outline in x and z, which need not be convex but starts where fans reach all of it, raised
     * along y. */
    void prism(const std::vector<std::array<double, 2>> &outline, double low, double high)
    {
        const size_t n = outline.size(), first = points.size();
        for (double y : {low, high})
            for (const auto &[x, z] : outline)
                add({x, y, z});
        for (size_t i = 0; i < n; ++i) {
            const size_t a = first + i, b = first + (i + 1) % n;
            face(a, b + n, b);
            face(a, a + n, b + n);
            if (i + 2 < n) {
                face(first, first + i + 1, first + i + 2);
                face(first + n, first + n + i + 2, first + n + i + 1);
            }
        }
    }
    /* Turns what was added since there were `from` points around x, then moves it. */
    void lean(size_t from, double radians, const Point &to)
    {
        const double c = std::cos(radians), s = std::sin(radians);
        for (size_t i = from; i < points.size(); ++i) {
            const Point p = points[i];
            points[i] = {to[0] + p[0], to[1] + c * p[1] - s * p[2], to[2] + s * p[1] + c * p[2]};
        }
    }
    /* Turns it around z. */
    void roll(size_t from, double radians)
    {
        const double c = std::cos(radians), s = std::sin(radians);
        for (size_t i = from; i < points.size(); ++i) {
            const Point p = points[i];
            points[i] = {c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
        }
    }
    void write(const std::string &path) const
    {
        std::ofstream out(path);
        out.precision(9);
        for (const Point &p : points)
            out << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
        for (const auto &t : triangles)
            out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    }

private:
    static constexpr double PI = 3.14159265358979;
    size_t add(const Point &p)
    {
        points.push_back(p);
        return points.size() - 1;
    }
    void face(size_t a, size_t b, size_t c)
    {
        if (a != b && b != c && c != a)
            triangles.push_back({a, b, c});
    }
};

/* A lathe's profile with a foot, a hollow bottom, a shoulder, a neck and a cap. */
inline Coarse bottle(size_t sides)
{
    Coarse out;
    std::vector<Coarse::Ring> rings;
    const double profile[][2] = {{0, 0.12}, {0.55, 0.1}, {0.8, 0}, {0.95, 0.03}, {1, 0.15},
                                 {1, 1},    {0.94, 1.1}, {0.94, 1.9}, {1, 2}, {1, 2.8},
                                 {0.9, 3.1}, {0.6, 3.4}, {0.36, 3.55}, {0.34, 3.8}, {0.42, 3.82},
                                 {0.42, 4.1}, {0.38, 4.16}, {0, 4.16}};
    for (const auto &[r, y] : profile)
        rings.push_back({0, y, 0, r, r});
    out.loft(rings, sides);
    return out;
}

/* A hexagonal head, a washer, a shaft, and a nut beside it on a plate. */
inline Coarse bolts()
{
    Coarse out;
    out.box({-3, -0.4, -2}, {3, 0, 2});
    for (double x : {-1.8, 0., 1.8})
        for (double z : {-1., 1.}) {
            out.loft({{x, 0, z, 0.62, 0.62}, {x, 0.08, z, 0.62, 0.62}}, 16);
            out.loft({{x, 0.06, z, 0.45, 0.45}, {x, 0.4, z, 0.45, 0.45}, {x, 0.46, z, 0.38, 0.38}},
                     6, 0.3 * x);
            out.loft({{x, 0.4, z, 0.18, 0.18}, {x, 0.9, z, 0.18, 0.18}, {x, 0.96, z, 0.12, 0.12}},
                     10);
        }
    return out;
}

/* A round head with two flat, pointed ears and a snout. */
inline Coarse ears()
{
    Coarse out;
    out.loft({{0, -1, 0, 0, 0}, {0, -0.8, 0, 0.6, 0.55}, {0, -0.3, 0, 0.95, 0.85},
              {0, 0.3, 0, 0.95, 0.8}, {0, 0.8, 0, 0.6, 0.5}, {0, 1, 0, 0, 0}}, 10);
    for (double side : {-1., 1.}) {
        const size_t from = out.points.size();
        out.loft({{0, 0, 0, 0.3, 0.1}, {0, 0.5, 0, 0.34, 0.08}, {0, 1.4, 0.1, 0, 0}}, 6);
        out.roll(from, -0.5 * side);
        out.lean(from, 0.15, {0.5 * side, 0.5, 0});
    }
    return out;
}

/* A house: walls, a gable roof of two thin slabs that stand over, and a chimney. */
inline Coarse roof()
{
    Coarse out;
    out.prism({{-2, -1.5}, {2, -1.5}, {2, 1.5}, {-2, 1.5}}, 0, 1.6);
    for (double side : {-1., 1.}) {
        const size_t from = out.points.size();
        out.box({-2.4, -0.05, side > 0 ? 0 : -2.3}, {2.4, 0.07, side > 0 ? 2.3 : 0});
        out.lean(from, 0.6 * side, {0, 2.9, 0});
    }
    out.box({0.9, 1.8, 0.3}, {1.3, 3.3, 0.7});
    return out;
}

/* Thin walls around courts, on a slab, some with flat roofs. */
inline Coarse city_tile()
{
    Coarse out;
    out.box({-5, -0.3, -5}, {5, 0, 5});
    constexpr double T = 0.08;
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
            const double x = -4.5 + 3.2 * i, z = -4.5 + 3.2 * j, h = 0.8 + 0.7 * ((2 * i + j) % 4);
            const double w = 2.4, d = 2;
            out.box({x, -0.1, z}, {x + w, h, z + T});
            out.box({x, -0.1, z + d - T}, {x + w, h, z + d});
            out.box({x, -0.1, z + T}, {x + T, h, z + d - T});
            out.box({x + w - T, -0.1, z + T}, {x + w, h, z + d - T});
            if ((i + j) % 2)
                out.box({x - 0.1, h - 0.05, z - 0.1}, {x + w + 0.1, h + 0.05, z + d + 0.1});
        }
    return out;
}

/* A cage: thin bars around a lamp. */
inline Coarse bars()
{
    Coarse out;
    out.box({-1.2, -0.2, -1.2}, {1.2, 0, 1.2});
    out.loft({{0, 2, 0, 1.5, 1.5}, {0, 2.1, 0, 1.5, 1.5}, {0, 2.8, 0, 0, 0}}, 8);
    for (int i = 0; i < 8; ++i) {
        const double a = 2 * 3.14159265358979 * i / 8;
        const double x = std::cos(a), z = std::sin(a);
        out.box({x - 0.035, -0.1, z - 0.035}, {x + 0.035, 2.05, z + 0.035});
    }
    out.loft({{0, -0.05, 0, 0.3, 0.3}, {0, 0.7, 0, 0.45, 0.45}, {0, 1.2, 0, 0, 0}}, 7);
    return out;
}

/* A body on four legs with a brush and sharp ears; some 500 triangles. */
inline Coarse fox()
{
    Coarse out;
    size_t from = out.points.size();
    out.loft({{0, -2, 0, 0, 0}, {0, -1.7, 0, 0.45, 0.5}, {0, -0.8, 0, 0.5, 0.55},
              {0, 0.4, 0, 0.42, 0.45}, {0, 1.2, 0.05, 0.5, 0.6}, {0, 1.8, 0.1, 0.3, 0.4},
              {0, 2.1, 0.1, 0, 0}}, 9);
    out.lean(from, 1.5707963, {0, 2, 0});
    from = out.points.size();                    /* the brush, thick behind and pointed */
    out.loft({{0, -0.2, 0, 0.1, 0.1}, {0, 0.6, 0, 0.3, 0.3}, {0, 1.5, 0, 0.26, 0.26},
              {0, 2.2, 0, 0, 0}}, 7);
    out.lean(from, -2.1, {0, 2.1, -1.7});
    from = out.points.size();                    /* the head, with a long snout */
    out.loft({{0, -0.4, 0, 0.3, 0.3}, {0, 0.1, 0, 0.52, 0.45}, {0, 0.5, 0, 0.4, 0.33},
              {0, 0.8, -0.06, 0.16, 0.15}, {0, 1.4, -0.1, 0.07, 0.07}}, 8);
    out.lean(from, 1.4, {0, 2.9, 2});
    for (double side : {-1., 1.}) {
        from = out.points.size();
        out.loft({{0, 0, 0, 0.2, 0.07}, {0, 0.75, 0, 0, 0}}, 4);
        out.roll(from, -0.25 * side);
        out.lean(from, -0.1, {0.27 * side, 3.2, 2});
        for (double z : {-1.5, 1.3}) {
            from = out.points.size();
            out.loft({{0, 0, 0.1, 0.13, 0.2}, {0, 0.12, 0.06, 0.12, 0.16}, {0, 0.7, 0, 0.09, 0.09},
                      {0, 1.3, -0.05, 0.17, 0.2}, {0, 2, 0, 0.1, 0.15}}, 6);
            out.lean(from, 0, {0.3 * side, 0, z});
        }
    }
    return out;
}
