/* Meshes with known surfaces, and partitions made by hand, for the tests of baking. */
#pragma once

#include "bake/bake.hpp"

#include <algorithm>
#include <functional>

namespace shapes {

using gtx::Vec3d;
using gtx::Vec3f;

/* Smooth corner normals: area-weighted means around the vertices. */
inline void add_normals(gtx::Mesh &mesh)
{
    gtx::Vector<Vec3d> sum(mesh.positions.size());
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k)
            sum[mesh.triangles[t][k]] += mesh.area_vector(t);
    for (const auto &triangle : mesh.triangles)
        for (uint32_t v : triangle)
            mesh.normals.push_back(Vec3f(gtx::normalize(sum[v])));
}

/* A grid of n x n squares over [0, 1]^2; wrap closes it along u or v. */
inline gtx::Mesh field(unsigned n, const std::function<Vec3d(double, double)> &point,
                       bool wrap = false)
{
    gtx::Mesh mesh;
    unsigned m = wrap ? n : n + 1;
    for (unsigned j = 0; j < m; ++j)
        for (unsigned i = 0; i < m; ++i)
            mesh.positions.push_back(point(double(i) / n, double(j) / n));
    for (unsigned j = 0; j < n; ++j) {
        for (unsigned i = 0; i < n; ++i) {
            uint32_t a = j * m + i, b = j * m + (i + 1) % m;
            uint32_t c = (j + 1) % m * m + (i + 1) % m, d = (j + 1) % m * m + i;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    }
    add_normals(mesh);
    return mesh;
}

/* A cube of 6 n^2 squares pushed out to the radius of its direction. */
inline gtx::Mesh ball(unsigned n, const std::function<double(const Vec3d &)> &radius)
{
    gtx::Mesh mesh;
    std::map<std::array<int, 3>, uint32_t> seen;
    auto vertex = [&](int axis, int side, unsigned i, unsigned j) {
        std::array<int, 3> at;
        at[axis] = side * int(n);
        at[(axis + 1) % 3] = side * (2 * int(i) - int(n));
        at[(axis + 2) % 3] = 2 * int(j) - int(n);
        auto found = seen.emplace(at, uint32_t(mesh.positions.size()));
        if (found.second) {
            auto bent = [&](int k) { return std::tan(at[k] * M_PI / 4 / n); };
            Vec3d direction = gtx::normalize(Vec3d(bent(0), bent(1), bent(2)));
            mesh.positions.push_back(direction * radius(direction));
        }
        return found.first->second;
    };
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = -1; side <= 1; side += 2) {
            for (unsigned j = 0; j < n; ++j) {
                for (unsigned i = 0; i < n; ++i) {
                    uint32_t a = vertex(axis, side, i, j), b = vertex(axis, side, i + 1, j);
                    uint32_t c = vertex(axis, side, i + 1, j + 1), d = vertex(axis, side, i, j + 1);
                    mesh.triangles.push_back({a, b, c});
                    mesh.triangles.push_back({a, c, d});
                }
            }
        }
    }
    add_normals(mesh);
    return mesh;
}

inline double bumps(const Vec3d &d)
{
    return 1 + 0.05 * std::sin(9 * d.x + 1) * std::sin(11 * d.y) + 0.03 * std::cos(13 * d.z);
}

/* An orthonormal frame that looks along z, around the chart. */
inline gtx::Frame frame_along(const gtx::Mesh &mesh, const gtx::Vector<uint32_t> &triangles,
                              const Vec3d &z)
{
    gtx::Frame frame;
    frame.z = gtx::normalize(z);
    Vec3d aside = std::fabs(frame.z.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    frame.x = gtx::normalize(aside - frame.z * dot(aside, frame.z));
    frame.y = cross(frame.z, frame.x);
    Vec3d low(1e300, 1e300, 1e300), high = -low;
    for (uint32_t t : triangles) {
        for (int k = 0; k < 3; ++k) {
            Vec3d p = mesh.position(t, k);
            Vec3d local(dot(frame.x, p), dot(frame.y, p), dot(frame.z, p));
            for (int a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], local[a]);
                high[a] = std::max(high[a], local[a]);
            }
        }
    }
    frame.origin = frame.x * low.x + frame.y * low.y + frame.z * low.z;
    for (int a = 0; a < 3; ++a)
        frame.extent[a] = high[a] - low[a];
    return frame;
}

/* Charts by a key of each triangle; each frame looks along the mean normal. */
inline gtx::Partition split(const gtx::Mesh &mesh, const std::function<int(size_t)> &key,
                            double resolution)
{
    std::map<int, gtx::Chart> charts;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        charts[key(t)].triangles.push_back(uint32_t(t));
    gtx::Partition partition;
    double longest = 0;
    for (auto &entry : charts) {
        gtx::Chart &chart = entry.second;
        Vec3d z;
        for (uint32_t t : chart.triangles)
            z += mesh.area_vector(t);
        chart.frame = frame_along(mesh, chart.triangles, z);
        longest = std::max({longest, chart.frame.extent[0], chart.frame.extent[1]});
        partition.charts.push_back(chart);
    }
    partition.pitch = longest / resolution;
    partition.junk.assign(mesh.triangle_count(), 0);
    return partition;
}

/* The axis (0..5) that a triangle's normal is nearest to. */
inline std::function<int(size_t)> by_axis(const gtx::Mesh &mesh)
{
    return [&mesh](size_t t) {
        Vec3d n = mesh.area_vector(t);
        double a[3] = {std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)};
        int axis = a[0] >= a[1] && a[0] >= a[2] ? 0 : a[1] >= a[2] ? 1 : 2;
        return 2 * axis + (n[axis] < 0);
    };
}

inline std::function<int(size_t)> all_in_one()
{
    return [](size_t) { return 0; };
}

/* The maps as gtx_create wants them. */
inline gtx_asset_desc describe(const gtx::Maps &maps, gtx::Vector<const uint8_t *> &levels)
{
    levels.clear();
    for (const auto &level : maps.normal)
        levels.push_back(level.data());
    for (const auto &level : maps.color)
        levels.push_back(level.data());
    gtx_asset_desc desc = {};
    desc.patches = maps.patches.data();
    desc.patch_count = uint32_t(maps.patches.size());
    desc.page_count = maps.page_count;
    desc.page_width = maps.page_width;
    desc.page_height = maps.page_height;
    desc.mip_count = maps.mip_count;
    desc.height_bits = maps.height_bits;
    desc.height = maps.height.data();
    desc.trim = maps.trim.data();
    desc.normal = levels.data();
    desc.color = maps.color.empty() ? nullptr : levels.data() + maps.normal.size();
    for (int k = 0; k < 3; ++k) {
        desc.bounds_min[k] = maps.bounds_min[k];
        desc.bounds_max[k] = maps.bounds_max[k];
        desc.anchor[k] = maps.anchor[k];
    }
    return desc;
}

} // namespace shapes
