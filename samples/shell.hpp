/* The form of the sculpture: a spined, ribbed sea shell, grown by formula. */
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

constexpr double PI = 3.14159265358979323846;
using Vec = std::array<double, 3>;

struct ShellPoint {
    Vec position, color; /* sRGB, 0..1 */
};
struct Model {
    std::vector<Vec> positions, normals, colors; /* normals of any length, linear colours */
    std::vector<std::array<uint32_t, 3>> triangles;
};

inline double mix(double a, double b, double t) { return a + (b - a) * t; }
inline Vec mix(Vec a, Vec b, double t)
{
    return {mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t)};
}
inline double smooth(double t) { return t <= 0 ? 0 : t >= 1 ? 1 : t * t * (3 - 2 * t); }
/* A quarter circle from 0 to 1: rounds the ends of a tube. */
inline double dome(double t) { return t < 1 ? std::sqrt(t * (2 - t)) : 1; }
/* A bump around v = 0, once a turn. */
inline double peak(double v) { return std::pow(std::max(0., std::cos(v)), 40); }

/* Value noise in -1..1: hashed lattice points, smoothly interpolated. */
inline double noise(double x, double y, double z)
{
    const Vec cell = {std::floor(x), std::floor(y), std::floor(z)};
    const Vec t = {smooth(x - cell[0]), smooth(y - cell[1]), smooth(z - cell[2])};
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        uint32_t h = 0x9e3779b9u;
        double weight = 1;
        for (int k = 0; k < 3; ++k) {
            int upper = corner >> k & 1;
            h = (h ^ uint32_t(int32_t(cell[k]) + upper)) * 0x85ebca6bu;
            h ^= h >> 15;
            weight *= upper ? t[k] : 1 - t[k];
        }
        sum += weight * (h * 0xc2b2ae35u >> 8) / 8388607.5;
    }
    return sum - 1;
}

/* A tube around a logarithmic spiral (Raup 1966): at `angle`, 0 at the mouth and negative towards
 * the apex, everything is `growth` times as large. s in 0..1 runs along the tube: outside from the
 * apex to the lip, around the lip, back inside. One surface, closed at its poles s = 0 and s = 1.
 * v in 0..2 pi runs around the tube. */
inline ShellPoint shell_at(double s, double v)
{
    const double per_turn = 2.25, rate = std::log(per_turn) / (2 * PI), turns = 4.2;
    const double lip = 0.8, inside = 0.83, wall = 0.13, tube = 0.5, distance = 0.85, height = 1.5;
    const Vec ivory = {.94, .87, .76}, clay = {.78, .47, .30}, umber = {.33, .17, .11};
    const Vec rose = {.90, .60, .48};

    double angle = 0;
    if (s < lip)
        angle = 2 * std::log(mix(std::pow(per_turn, -turns / 2), 1, s / lip)) / rate;
    else if (s > inside)
        angle = -1.9 * (s - inside) / (1 - inside);
    /* the mouth opens away from the whorl above it */
    double flare = (0.28 + 0.06 * std::cos(8 * v - 3)) * (0.55 - 0.45 * std::cos(v - 2.1)) *
                   std::exp(angle / 0.3);
    double radius = 1 + flare, lean = 0;
    Vec color = mix(rose, ivory, std::exp(angle / 0.15));
    if (s < lip) {
        double x = std::cos(v), y = std::sin(v), ease = 1 - std::exp(angle / 0.05);
        double grain = noise(9 * angle, 4 * x, 4 * y), fine = noise(40 * angle, 16 * x, 16 * y);
        double at = 10 * angle / (2 * PI) + 0.06 * grain, off = at - std::round(at);
        double rib = std::exp(-off * off / 0.01);
        double spines = 0.7 * peak(v - 0.5) + 0.28 * peak(v + 0.35) + 0.17 * peak(v + 1.1);
        double crest = rib * (0.09 + 0.02 * std::sin(9 * v + at) + spines);
        double thread = 1 - std::fabs(std::sin(21 * v + 0.5 * grain));
        double line = std::sin(90 * angle + 2.5 * grain);
        double relief = ease * (crest + (1 - rib) * (0.03 * thread * thread + 0.006 * line) +
                                0.006 * fine + 0.012 * grain);
        double band = smooth(0.5 + 0.9 * std::sin(3 * v + 0.6) + 0.5 * grain);
        Vec ground = mix(umber, mix(clay, ivory, 0.75 * band), smooth(0.3 + 30 * relief));
        color = mix(mix(ground, ivory, rib), clay, 0.8 * smooth(3 * (relief - 0.25)));
        radius = (radius + relief) * dome(s / lip / 0.006);
        lean = ease * crest * (0.25 + 0.5 * crest); /* spines curl towards the mouth */
    } else if (s < inside) {
        double around = PI * (s - lip) / (inside - lip);
        radius -= wall / 2 * (1 - std::cos(around));
        lean = wall / 2 * std::sin(around);
    } else {
        radius = (radius - wall) * dome((1 - s) / (1 - inside) / 0.25);
    }

    double growth = std::exp(rate * angle);
    double out = growth * (distance + tube * radius * std::cos(v));
    double up = growth * (1.1 * tube * radius * std::sin(v) - height);
    angle += tube * lean / distance;
    return {{out * std::cos(angle), up, out * std::sin(angle)}, color};
}

inline void add_vertex(Model &model, ShellPoint point)
{
    for (double &c : point.color)
        c = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    model.positions.push_back(point.position);
    model.colors.push_back(point.color);
}

/* Sums of the area vectors around each vertex. */
inline void add_normals(Model &model)
{
    model.normals.assign(model.positions.size(), Vec{});
    for (const auto &t : model.triangles)
        for (int k = 0, i = 1, j = 2; k < 3; i = j, j = k++) {
            const Vec *p = model.positions.data(), &o = p[t[0]], &q = p[t[1]], &r = p[t[2]];
            double area = (q[i] - o[i]) * (r[j] - o[j]) - (q[j] - o[j]) * (r[i] - o[i]);
            for (uint32_t v : t)
                model.normals[v][k] += area;
        }
}

/* Rings of vertices between two poles s = 0 and s = 1, half of `slender` times as many as vertices
 * in a ring. Triangles share them, so the surface is watertight. */
template <class Point> Model make_rings(double triangles, double slender, Point point_at)
{
    uint32_t columns = uint32_t(std::sqrt(triangles / slender));
    uint32_t rings = uint32_t(triangles / 2 / columns);
    Model model;
    add_vertex(model, point_at(0, 0));
    for (uint32_t r = 1; r <= rings; ++r)
        for (uint32_t c = 0; c < columns; ++c)
            add_vertex(model, point_at(double(r) / (rings + 1), 2 * PI * c / columns));
    add_vertex(model, point_at(1, 0));
    auto vertex = [&](uint32_t r, uint32_t c) {
        return r == 0 ? 0 : r > rings ? 1 + rings * columns : 1 + (r - 1) * columns + c % columns;
    };
    for (uint32_t r = 0; r <= rings; ++r)
        for (uint32_t c = 0; c < columns; ++c) {
            uint32_t diagonal[] = {vertex(r, c + 1), vertex(r + 1, c)};
            if (r > 0)
                model.triangles.push_back({vertex(r, c), diagonal[0], diagonal[1]});
            if (r < rings)
                model.triangles.push_back({diagonal[1], diagonal[0], vertex(r + 1, c + 1)});
        }
    add_normals(model);
    return model;
}
