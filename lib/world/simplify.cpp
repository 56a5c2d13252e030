/* Simplifies a tile's surface for its parent, keeping its border. */
#include "world/surface.hpp"

#include "mesh/material/srgb.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace gtx {

namespace {

/* The own triangles by place, and what a place has. */
struct Places {
    Vector<uint32_t> indices;        /* three a triangle; of vertices, the first at each */
    Vector<Vec3f> positions;         /* relative to the middle */
    Vector<Vec3f> normals;
    Vector<Rgba8> colors;
};

Places places_of(const TileSurface &s)
{
    Places out;
    const Vec3d middle = (s.header.low + s.header.high) / 2;
    Vector<std::array<double, 5>> sums(s.positions.size());
    Vector<Vec3d> normals(s.positions.size());
    for (size_t v = 0; v < s.positions.size(); ++v) {
        const Rgba8 &c = s.colors[v];
        const double values[5] = {double(c.r), double(c.g), double(c.b), double(c.a), 1};
        for (size_t k = 0; k < 5; ++k)
            sums[s.place[v]][k] += values[k];
        normals[s.place[v]] += Vec3d(s.normals[v]);
    }
    for (size_t v = 0; v < s.positions.size(); ++v) {
        const auto &sum = sums[s.place[v]];
        auto mean = [&](size_t k) { return uint8_t(sum[k] / sum[4] + 0.5); };
        out.positions.push_back(Vec3f(s.positions[v] - middle));
        out.normals.push_back(Vec3f(normalize(normals[s.place[v]])));
        out.colors.push_back({mean(0), mean(1), mean(2), mean(3)});
    }
    for (size_t t = 0; t < s.own; ++t) {
        const auto &[a, b, c] = s.triangles[t];
        const uint32_t at[3] = {s.place[a], s.place[b], s.place[c]};
        if (at[0] != at[1] && at[1] != at[2] && at[2] != at[0])
            out.indices.insert(out.indices.end(), at, at + 3);
    }
    return out;
}

} // namespace

/* Garland and Heckbert's quadrics (1997) with a locked border. */
static Vector<uint32_t> simplified(const Places &places, size_t wanted)
{
    const Vector<uint32_t> &from = places.indices;
    Vector<uint32_t> out(from.size());
    if (from.size() <= 3 * wanted)
        return from;
    cancel_point();
    const TakenMemory taken(from.size() * 4 * 8 + places.positions.size() * 100);
    out.resize(meshopt_simplify(out.data(), from.data(), from.size(), &places.positions[0].x,
                                places.positions.size(), sizeof(Vec3f), 3 * wanted, FLT_MAX,
                                meshopt_SimplifyLockBorder, nullptr));
    return out;
}

/* What is seen of triangles, added up at places by light; `weight` is the triangles' area. */
namespace {
struct Light {
    double sum[4] = {0, 0, 0, 0}, weight = 0;
    void add(const Rgba8 &c, double w)
    {
        const double values[4] = {srgb_to_linear(c.r), srgb_to_linear(c.g), srgb_to_linear(c.b),
                                  double(c.a)};
        for (size_t k = 0; k < 4; ++k)
            sum[k] += w * values[k];
        weight += w;
    }
    Rgba8 mean() const
    {
        auto at = [&](size_t k) { return linear_to_srgb(float(sum[k] / weight)); };
        return {at(0), at(1), at(2), uint8_t(sum[3] / weight + 0.5)};
    }
};
} // namespace

/* Each triangle of the painted surface gives its colour to the corners of the triangle of `low`
 * that is nearest. Where neighbours meet, both see the same: the triangles around the place alone,
 * the ring's with them. */
static Vector<Rgba8> seen_around(const TileSurface &s, const PlainMesh &low, Task &task)
{
    Vector<Light> around(s.positions.size()), wide(s.positions.size());
    Vector<uint8_t> is_ring(s.positions.size(), 0);
    Vector<Vec3d> middles;
    Vector<double> areas;
    for (size_t t = 0; t < s.triangles.size(); ++t) {
        const auto &[a, b, c] = s.triangles[t];
        const Vec3d p = s.positions[a], q = s.positions[b], r = s.positions[c];
        areas.push_back(std::max(length(cross(q - p, r - p)) / 2, DBL_MIN));
        if (t < s.own)
            middles.push_back((p + q + r) / 3);
        for (uint32_t v : s.triangles[t]) {
            around[s.place[v]].add(s.seen[t], areas[t]);
            is_ring[s.place[v]] |= t >= s.own;
        }
    }
    const Vector<uint32_t> nearest = nearest_triangles(middles, low, task);
    for (size_t t = 0; t < s.own; ++t) {
        const auto &to = low.triangles[nearest[t]];
        const Vec3d w = weights_at(middles[t], low.positions[to[0]], low.positions[to[1]],
                                   low.positions[to[2]]);
        for (int k = 0; k < 3; ++k)
            wide[to[size_t(k)]].add(s.seen[t], areas[t] * w[k]);
    }
    Vector<Rgba8> out(s.positions.size());
    for (size_t v = 0; v < out.size(); ++v)
        if (around[v].weight > 0)
            out[v] = (is_ring[v] || !(wide[v].weight > 0) ? around : wide)[v].mean();
    return out;
}

/* The mean side of a square of two triangles. */
static double spacing_of(const PlainMesh &mesh)
{
    double area = 0;
    for (const auto &[a, b, c] : mesh.triangles)
        area += length(cross(mesh.positions[b] - mesh.positions[a],
                             mesh.positions[c] - mesh.positions[a])) / 2;
    return mesh.triangles.empty() ? 0 : std::sqrt(2 * area / double(mesh.triangles.size()));
}

LowSurface simplify_surface(const TileSurface &surface, NearSurface &near, size_t wanted,
                            Task &task)
{
    Places places = places_of(surface);
    const Vector<uint32_t> indices = simplified(places, wanted);
    LowSurface out = {CellWriter(low_traits(surface.traits)), 0};
    PlainMesh mesh = {surface.positions, {}};
    for (size_t i = 0; i < indices.size(); i += 3)
        mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    if (!surface.seen.empty() && !indices.empty())
        places.colors = seen_around(surface, mesh, task);
    for (size_t i = 0; i < indices.size(); i += 3) {
        Corners3 corners;
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t v = indices[i + k];
            corners[k] = {surface.positions[v], places.normals[v], places.colors[v]};
        }
        out.cell.add(corners);
    }
    if (indices.size() < places.indices.size())
        out.deviation = near.distance_to(mesh, false);
    out.cell.header.deviation = surface.header.deviation + out.deviation;
    if (!surface.seen.empty()) /* finer than its vertices lie no colour is seen */
        out.cell.header.deviation = std::max(out.cell.header.deviation, spacing_of(mesh));
    return out;
}

} // namespace gtx
