/* Manifold meshes for the tests of charts. */
#pragma once

#include "mesh/mesh.hpp"

#include <functional>

namespace shapes {

using gtx::Mesh;
using gtx::Vec3d;

constexpr double PI = 3.14159265358979;

/* A grid of columns x rows squares under (u, v) in [0, 1]^2, closed along u or v on request. */
inline Mesh field(unsigned columns, unsigned rows, const std::function<Vec3d(double, double)> &at,
                  bool close_u = false, bool close_v = false)
{
    Mesh mesh;
    unsigned nu = columns + !close_u, nv = rows + !close_v;
    for (unsigned j = 0; j < nv; ++j)
        for (unsigned i = 0; i < nu; ++i)
            mesh.positions.push_back(at(double(i) / columns, double(j) / rows));
    for (unsigned j = 0; j < rows; ++j)
        for (unsigned i = 0; i < columns; ++i) {
            uint32_t a = j * nu + i, b = j * nu + (i + 1) % nu;
            uint32_t c = (j + 1) % nv * nu + i, d = (j + 1) % nv * nu + (i + 1) % nu;
            mesh.triangles.push_back({a, b, d});
            mesh.triangles.push_back({a, d, c});
        }
    return mesh;
}

inline Mesh plane(unsigned n, double width = 1, double height = 1)
{
    return field(n, n, [=](double u, double v) { return Vec3d(width * u, height * v, 0); });
}

inline Mesh torus(unsigned n, double thickness)
{
    return field(2 * n, n, [=](double u, double v) {
        double r = 1 + thickness * std::cos(2 * PI * v);
        return Vec3d(r * std::cos(2 * PI * u), r * std::sin(2 * PI * u),
                     thickness * std::sin(2 * PI * v));
    }, true, true);
}

inline Mesh cylinder(unsigned n)
{
    return field(n, n, [](double u, double v) {
        return Vec3d(std::cos(2 * PI * u), std::sin(2 * PI * u), 3 * v);
    }, true);
}

/* A ramp that winds `turns` times around the z axis, above itself. */
inline Mesh helicoid(unsigned n, double turns)
{
    return field(unsigned(n * turns), 8, [=](double u, double v) {
        double angle = 2 * PI * turns * u, r = 1.5 - v;
        return Vec3d(r * std::cos(angle), r * std::sin(angle), 0.3 * turns * u);
    });
}

/* A height field folded over itself: two layers `gap` apart, joined by a half turn. */
inline Mesh folded_field(unsigned n, double gap)
{
    return field(3 * n, n, [=](double u, double v) {
        double r = gap / 2, arc = PI * r, flat = 1, s = u * (2 * flat + arc);
        if (s < flat)
            return Vec3d(s, v, 0);
        if (s < flat + arc)
            return Vec3d(flat + r * std::sin((s - flat) / r), v, r - r * std::cos((s - flat) / r));
        return Vec3d(2 * flat + arc - s, v, gap);
    });
}

/* A cube's sides pushed onto the unit sphere, r(direction) away; `corner` keeps them flat. */
inline Mesh ball(unsigned n, const std::function<double(const Vec3d &)> &radius, bool cube = false)
{
    Mesh mesh;
    std::map<std::array<int, 3>, uint32_t> known;
    auto vertex = [&](std::array<int, 3> at) {
        auto found = known.find(at);
        if (found != known.end())
            return found->second;
        Vec3d p(2. * at[0] / n - 1, 2. * at[1] / n - 1, 2. * at[2] / n - 1);
        Vec3d direction = normalize(p);
        mesh.positions.push_back(cube ? p : direction * radius(direction));
        return known[at] = uint32_t(mesh.positions.size() - 1);
    };
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
            for (unsigned j = 0; j < n; ++j)
                for (unsigned i = 0; i < n; ++i) {
                    auto corner = [&](unsigned a, unsigned b) {
                        std::array<int, 3> at;
                        at[axis] = side ? int(n) : 0;
                        at[(axis + 1) % 3] = int(side ? a : b);
                        at[(axis + 2) % 3] = int(side ? b : a);
                        return vertex(at);
                    };
                    uint32_t a = corner(i, j), b = corner(i + 1, j);
                    uint32_t c = corner(i, j + 1), d = corner(i + 1, j + 1);
                    mesh.triangles.push_back({a, b, d});
                    mesh.triangles.push_back({a, d, c});
                }
    return mesh;
}

inline Mesh sphere(unsigned n)
{
    return ball(n, [](const Vec3d &) { return 1.; });
}

inline Mesh bumpy_sphere(unsigned n)
{
    return ball(n, [](const Vec3d &p) {
        return 1 + 0.1 * std::sin(9 * p.x) * std::sin(8 * p.y + 1) * std::sin(7 * p.z + 2);
    });
}

inline Mesh cube(unsigned n)
{
    return ball(n, [](const Vec3d &) { return 1.; }, true);
}

inline Mesh both(const Mesh &a, const Mesh &b, const Vec3d &apart)
{
    Mesh mesh = a;
    for (const Vec3d &p : b.positions)
        mesh.positions.push_back(p + apart);
    for (auto t : b.triangles) {
        for (uint32_t &v : t)
            v += uint32_t(a.positions.size());
        mesh.triangles.push_back(t);
    }
    return mesh;
}

} // namespace shapes
