/* Worlds of the tests' own: models by formula, and all steps one after another. */
#pragma once

#include "bake/shapes.hpp"
#include "base/bytes.h"
#include "common/folder.hpp"
#include "world/facts.hpp"
#include "world/surface.hpp"

#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

/* Last, for its macros take names that the standard library uses. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

/* Hills upon hills, 2 x 2 wide, +Y up. */
inline gtx::Mesh terrain(unsigned n)
{
    return shapes::field(n, [](double u, double v) {
        double h = 0, size = 0.12;
        for (double f = 3; f < 50; f *= 2.3, size /= 2.1)
            h += size * std::sin(f * (2 * u + 0.3 * v) + f) * std::cos(f * (1.7 * v - 0.4 * u));
        return gtx::Vec3d(2 * u - 1, h, 1 - 2 * v);
    });
}

/* The same, with so much of the height at each octave, down to that of its vertices; each octave is
 * turned from the one before. */
inline gtx::Mesh rough_terrain(unsigned n, double gain = 0.7, double amplitude = 0.12,
                               double seed = 2, double each = 2.4)
{
    return shapes::field(n, [=](double u, double v) {
        double h = 0, size = amplitude;
        int k = 0;
        for (double f = 3; f < 2.5 * n; f *= 2, size *= gain, ++k) {
            const double turn = each * k + seed;
            const double x = std::cos(turn) * u - std::sin(turn) * v;
            const double y = std::sin(turn) * u + std::cos(turn) * v;
            h += size * std::sin(f * x + 1.7 * turn) * std::cos(f * y - 0.9 * turn);
        }
        return gtx::Vec3d(2 * u - 1, h, 1 - 2 * v);
    });
}

/* Closed, with bumps of two sizes. */
inline gtx::Mesh ball(unsigned n)
{
    return shapes::ball(n, [](const gtx::Vec3d &d) {
        return 1 + 0.04 * std::sin(9 * d.x + 2) * std::sin(8 * d.y) +
               0.02 * std::sin(23 * d.z) * std::cos(21 * d.x + d.y);
    });
}

/* As binary PLY, without textures. */
inline std::string ply_of(const gtx::TileSurface &s)
{
    const bool normals = s.traits.normals, colors = s.traits.colors;
    std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(s.positions.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\n";
    if (normals)
        out += "property float nx\nproperty float ny\nproperty float nz\n";
    if (colors)
        out += "property uchar red\nproperty uchar green\nproperty uchar blue\n"
               "property uchar alpha\n";
    out += "element face " + std::to_string(s.triangles.size()) +
           "\nproperty list uchar uint vertex_indices\nend_header\n";
    const gtx::CornerTraits row = {true, normals, colors};
    const size_t header = out.size(), vertex = row.bytes();
    out.resize(header + s.positions.size() * vertex + s.triangles.size() * 13);
    auto *to = reinterpret_cast<uint8_t *>(&out[header]);
    for (size_t v = 0; v < s.positions.size(); ++v) {
        for (int k = 0; k < 3; ++k, to += 8)
            gtx_store_f64(to, s.positions[v][k]);
        for (int k = 0; k < 3 && normals; ++k, to += 4)
            gtx_store_f32(to, s.normals[v][k]);
        std::memcpy(to, &s.colors[v], colors ? 4 : 0);
        to += colors ? 4 : 0;
    }
    for (const auto &t : s.triangles) {
        *to++ = 3;
        for (uint32_t v : t) {
            gtx_store_u32(to, v);
            to += 4;
        }
    }
    return out;
}

inline std::string ply_text(const gtx::Mesh &mesh)
{
    gtx::TileSurface surface;
    surface.positions = mesh.positions;
    surface.normals.resize(mesh.positions.size());
    surface.colors.resize(mesh.positions.size());
    surface.triangles = mesh.triangles;
    return ply_of(surface);
}

inline void write_file(const std::string &path, const std::string &text)
{
    std::ofstream(path, std::ios::binary) << text;
}

inline std::string read_file(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/* All steps; returns the plan. */
inline gtx::Plan make_world(const gtx::PlanOptions &options)
{
    gtx::Task task(2, nullptr, nullptr, {"read", "cook", "simplify"}, {1, 1, 1});
    task.limits.allow_work(1e6);
    gtx::plan_world(options, task);
    gtx::split_world(options.folder, task);
    const gtx::Plan plan = gtx::read_plan(options.folder, task);
    for (size_t n = plan.tiles.size(); n-- > 0;) { /* deepest first, leaves before all others */
        if (plan.tiles[n].is_leaf())
            gtx::cook_tile(options.folder, plan.tiles[n].name, task);
    }
    for (uint32_t depth = plan.depths(); depth-- > 0;)
        for (const gtx::Tile &tile : plan.tiles)
            if (tile.depth == depth && !tile.is_leaf()) {
                gtx::merge_tile(options.folder, tile.name, task);
                gtx::cook_tile(options.folder, tile.name, task);
            }
    gtx::index_world(options.folder, task);
    return plan;
}
