/* Shapes to clean, and a slow, independent check of what a cleaned mesh promises. */
#pragma once

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include "mesh/mesh.hpp"

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <set>

extern "C" {
#include <cmocka.h> /* last: its fail() is a macro */
}

using gtx::CleanReport;
using gtx::Mesh;
using gtx::Task;
using gtx::Vec3d;
using gtx::Vec3f;

/* ---- shapes ---- */

inline void append(Mesh &mesh, const Mesh &other)
{
    uint32_t base = uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    for (const auto &t : other.triangles)
        mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

inline Mesh moved(Mesh mesh, const Vec3d &scale, const Vec3d &offset)
{
    for (Vec3d &p : mesh.positions)
        p = Vec3d(p.x * scale.x, p.y * scale.y, p.z * scale.z) + offset;
    return mesh;
}

inline void turn(Mesh &mesh, size_t t)
{
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
}

inline Mesh turned(Mesh mesh)
{
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        turn(mesh, t);
    return mesh;
}

inline Mesh cube()
{
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(Vec3d(i & 1, i >> 1 & 1, i >> 2));
    static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto &q : quads) {
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    return mesh;
}

/* A grid of m x n cells, both directions closed as told; a turn over when closing in u. */
inline Mesh grid(uint32_t m, uint32_t n, bool closed_u, bool closed_v, bool twist,
                 const std::function<Vec3d(double, double)> &at)
{
    Mesh mesh;
    uint32_t columns = closed_u ? m : m + 1, rows = closed_v ? n : n + 1;
    for (uint32_t i = 0; i < columns; ++i)
        for (uint32_t j = 0; j < rows; ++j)
            mesh.positions.push_back(at(double(i) / m, double(j) / n));
    auto vertex = [&](uint32_t i, uint32_t j) {
        if (i == columns && twist)
            j = closed_v ? (n - j) % n : n - j;
        return i % columns * rows + j % rows;
    };
    for (uint32_t i = 0; i < m; ++i)
        for (uint32_t j = 0; j < n; ++j) {
            uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1),
                     d = vertex(i, j + 1);
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    return mesh;
}

constexpr double TURN = 6.283185307179586;

/* The poles are full of triangles without area. */
inline Mesh sphere(uint32_t n = 16)
{
    return grid(2 * n, n, true, false, false, [](double u, double v) {
        double r = v == 0 || v == 1 ? 0 : std::sin(v * TURN / 2);
        return Vec3d(r * std::cos(u * TURN), r * -std::sin(u * TURN), std::cos(v * TURN / 2));
    });
}

inline Mesh torus(uint32_t m = 24, uint32_t n = 12)
{
    return grid(m, n, true, true, false, [](double u, double v) {
        double r = 3 + std::cos(v * TURN);
        return Vec3d(r * std::cos(u * TURN), r * std::sin(u * TURN), std::sin(v * TURN));
    });
}

inline Mesh moebius()
{
    return grid(40, 4, true, false, true, [](double u, double v) {
        double w = (v - 0.5), r = 2 + w * std::cos(u * TURN / 2);
        return Vec3d(r * std::cos(u * TURN), r * std::sin(u * TURN), w * std::sin(u * TURN / 2));
    });
}

inline Mesh klein()
{
    return grid(40, 16, true, true, true, [](double u, double v) {
        double s = std::sin(v * TURN), d = std::sin(2 * v * TURN), h = u * TURN / 2;
        double r = 3 + std::cos(h) * s - std::sin(h) * d;
        return Vec3d(r * std::cos(2 * h), r * std::sin(2 * h), std::sin(h) * s + std::cos(h) * d);
    });
}

/* Every corner its own vertex. */
inline Mesh soup(const Mesh &mesh)
{
    Mesh result;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        for (int k = 0; k < 3; ++k)
            result.positions.push_back(mesh.position(t, k));
        result.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return result;
}

/* ---- the check ---- */

struct UnionFind {
    gtx::Vector<size_t> parent;
    explicit UnionFind(size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), size_t(0)); }
    size_t find(size_t i) { return parent[i] == i ? i : parent[i] = find(parent[i]); }
    void join(size_t a, size_t b) { parent[find(a)] = find(b); }
};

struct DirectedEdge {
    size_t triangle;
    int corner;
    bool forward; /* from the lower vertex to the higher */
};
using EdgeMap = std::map<std::pair<uint32_t, uint32_t>, gtx::Vector<DirectedEdge>>;

inline EdgeMap edges_of(const Mesh &mesh)
{
    EdgeMap edges;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k) {
            uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            edges[{std::min(a, b), std::max(a, b)}].push_back({t, k, a < b});
        }
    return edges;
}

inline void check_triangles(const Mesh &mesh)
{
    gtx::Vector<bool> used(mesh.positions.size(), false);
    std::set<std::array<std::array<double, 3>, 3>> seen;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        std::array<std::array<double, 3>, 3> key;
        for (int k = 0; k < 3; ++k) {
            assert_true(mesh.triangles[t][k] < mesh.positions.size());
            used[mesh.triangles[t][k]] = true;
            Vec3d p = mesh.position(t, k);
            assert_true(is_finite(p));
            key[k] = {p.x, p.y, p.z};
        }
        std::sort(key.begin(), key.end());
        assert_true(seen.insert(key).second);
        assert_true(key[0] != key[1] && key[1] != key[2]);
        double area = length(mesh.area_vector(t));
        assert_true(area > 0 && std::isfinite(area));
    }
    assert_true(std::find(used.begin(), used.end(), false) == used.end());
}

inline void check_edges(const Mesh &mesh, const EdgeMap &edges)
{
    auto neighbours = triangle_neighbours(mesh);
    assert_int_equal(neighbours.size(), mesh.triangle_count());
    for (const auto &edge : edges) {
        const auto &sides = edge.second;
        assert_true(sides.size() == 1 || sides.size() == 2);
        if (sides.size() == 1) {
            assert_int_equal(neighbours[sides[0].triangle][sides[0].corner], gtx::NO_TRIANGLE);
            continue;
        }
        assert_true(sides[0].forward != sides[1].forward);
        assert_int_equal(neighbours[sides[0].triangle][sides[0].corner], sides[1].triangle);
        assert_int_equal(neighbours[sides[1].triangle][sides[1].corner], sides[0].triangle);
    }
}

/* The corners of a vertex hang together over edges at that vertex. */
inline void check_fans(const Mesh &mesh, const EdgeMap &edges)
{
    UnionFind corners(3 * mesh.triangle_count());
    for (const auto &edge : edges) {
        for (uint32_t v : {edge.first.first, edge.first.second}) {
            gtx::Vector<size_t> at_v;
            for (const DirectedEdge &side : edge.second)
                for (size_t k = 0; k < 3; ++k)
                    if (mesh.triangles[side.triangle][k] == v)
                        at_v.push_back(3 * side.triangle + k);
            for (size_t c : at_v)
                corners.join(at_v[0], c);
        }
    }
    gtx::Vector<size_t> fan(mesh.positions.size(), SIZE_MAX);
    for (size_t c = 0; c < corners.parent.size(); ++c) {
        size_t &of_vertex = fan[mesh.triangles[c / 3][c % 3]];
        assert_true(of_vertex == SIZE_MAX || of_vertex == corners.find(c));
        of_vertex = corners.find(c);
    }
}

inline void check_report(const Mesh &mesh, const EdgeMap &edges, const CleanReport &report)
{
    UnionFind triangles(mesh.triangle_count());
    gtx::Vector<bool> open(mesh.triangle_count(), false);
    size_t borders = 0;
    std::set<size_t> components;
    gtx::Vector<Vec3d> vector_area(mesh.triangle_count());
    gtx::Vector<double> area(mesh.triangle_count());
    for (const auto &edge : edges)
        triangles.join(edge.second.front().triangle, edge.second.back().triangle);
    for (const auto &edge : edges)
        if (edge.second.size() == 1) {
            ++borders;
            open[triangles.find(edge.second[0].triangle)] = true;
        }
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        components.insert(triangles.find(t));
        vector_area[triangles.find(t)] += mesh.area_vector(t);
        area[triangles.find(t)] += length(mesh.area_vector(t));
    }
    /* Small gaps make nothing two-sided; the vector area, their least, tells how small. */
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        size_t c = triangles.find(t);
        if (open[c] && length(vector_area[c]) > 0.0101 * area[c])
            assert_true(mesh.flags[t] & gtx::TRIANGLE_TWO_SIDED);
    }
    assert_int_equal(report.components, components.size());
    assert_int_equal(report.boundary_edges, borders);
    assert_int_equal(report.closed, borders == 0);
}

inline void check_normals(const Mesh &mesh)
{
    for (size_t c = 0; c < mesh.normals.size(); ++c) {
        Vec3d n(mesh.normals[c]);
        assert_true(std::fabs(length(n) - 1) < 1e-5);
        assert_true(dot(n, normalize(mesh.area_vector(c / 3))) > -1e-6);
    }
}

inline void check_open_mesh(const Mesh &mesh)
{
    OpenMesh::TriConnectivity other;
    gtx::Vector<OpenMesh::VertexHandle> vertices;
    for (size_t v = 0; v < mesh.positions.size(); ++v)
        vertices.push_back(other.add_vertex());
    for (const auto &t : mesh.triangles)
        assert_true(other.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]).is_valid());
}

inline void check_promises(const Mesh &mesh, const CleanReport &report)
{
    assert_true(mesh.triangle_count() > 0);
    assert_int_equal(mesh.normals.size(), 3 * mesh.triangle_count());
    assert_true(mesh.colors.empty() || mesh.colors.size() == 3 * mesh.triangle_count());
    assert_int_equal(mesh.flags.size(), mesh.triangle_count());
    EdgeMap edges = edges_of(mesh);
    check_triangles(mesh);
    check_edges(mesh, edges);
    check_fans(mesh, edges);
    check_report(mesh, edges, report);
    check_normals(mesh);
    check_open_mesh(mesh);
}

/* ---- one cleaning, checked ---- */

struct Cleaned {
    Mesh mesh;
    CleanReport report;
    gtx::Vector<std::string> warnings;
    uint64_t dropped(const char *reason) const
    {
        auto found = report.dropped.find(reason);
        return found == report.dropped.end() ? 0 : found->second;
    }
};

inline Cleaned clean(const Mesh &mesh, unsigned threads = 1)
{
    Cleaned result;
    Task task(threads, nullptr, nullptr);
    result.mesh = clean_mesh(mesh, task, result.report);
    for (const gtx::Warning &warning : task.warnings)
        result.warnings.push_back(warning.sentence);
    check_promises(result.mesh, result.report);
    return result;
}

inline double volume(const Mesh &mesh)
{
    double sum = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        sum += dot(mesh.position(t, 0), cross(mesh.position(t, 1), mesh.position(t, 2))) / 6;
    return sum;
}

inline double area(const Mesh &mesh)
{
    double sum = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        sum += length(mesh.area_vector(t)) / 2;
    return sum;
}
