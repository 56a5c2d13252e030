/* LOD meshes of meshes, and what every LOD mesh must be, for the tests of baking. */
#pragma once

#include "bake/shapes.hpp"
#include "bake/lod/bound.hpp"

#include <iterator>
#include <map>
#include <memory>

namespace lods {

using namespace gtx;

struct Lod {
    Maps maps;
    Vector<LodLevel> levels;
};

inline Lod lod_of(const Mesh &mesh, Partition partition, unsigned levels = 5,
                  unsigned threads = 2, BakeOptions options = {})
{
    Task task(threads, nullptr, nullptr, {"bake", "pack", "lod"}, {1, 1, 1});
    Lod out = {bake(mesh, partition, options, task), {}};
    out.levels = make_lod(lod_source(mesh, partition, out.maps, task), out.maps, levels, task);
    return out;
}

/* Without those for models of a few pixels. */
inline Vector<LodLevel> near_levels(const Lod &lod)
{
    Vector<LodLevel> out;
    std::copy_if(lod.levels.begin(), lod.levels.end(), std::back_inserter(out),
                 [](const LodLevel &level) { return !level.far; });
    return out;
}

inline Vector<gtx_lod_mesh> describe(const Vector<LodLevel> &levels)
{
    Vector<gtx_lod_mesh> out;
    for (const LodLevel &level : levels)
        out.push_back(level.mesh());
    return out;
}

/* The asset obeys every rule, and its file gives the levels back. */
inline void assert_valid(const Lod &lod)
{
    Vector<const uint8_t *> normals;
    gtx_asset_desc desc = shapes::describe(lod.maps, normals);
    const Vector<gtx_lod_mesh> levels = describe(lod.levels);
    desc.lod = levels.data();
    desc.lod_levels = uint32_t(levels.size());
    gtx_asset *asset = nullptr, *again = nullptr;
    gtx_error error;
    if (gtx_create(&desc, &asset, &error))
        print_error("%s\n", error.message);
    assert_non_null(asset);
    gtx_encode_desc encode = {};
#ifdef GTX_ZSTD
    encode.zstd_level = 3;
#endif
    void *data;
    size_t size;
    assert_int_equal(gtx_encode(asset, &encode, &data, &size, nullptr), GTX_OK);
    assert_int_equal(gtx_open_memory(data, size, nullptr, &again, nullptr), GTX_OK);
    for (uint32_t k = 0; k < levels.size(); ++k) {
        gtx_lod_mesh level;
        assert_int_equal(gtx_get_lod_mesh(again, k, &level), GTX_OK);
        assert_int_equal(level.triangle_count, levels[k].triangle_count);
        assert_memory_equal(level.indices, levels[k].indices, 12 * level.triangle_count);
        assert_memory_equal(level.positions, levels[k].positions, 6 * level.vertex_count);
    }
    gtx_lod_mesh none;
    assert_int_equal(gtx_get_lod_mesh(again, uint32_t(levels.size()), &none), GTX_ERROR_ARGUMENT);
    gtx_close(again);
    gtx_close(asset);
    free(data);
}

inline Vec3d point(const LodLevel &level, uint32_t vertex)
{
    Vec3d p;
    for (int k = 0; k < 3; ++k)
        p[k] = level.origin[k] + double(level.step) * level.positions[3 * vertex + k];
    return p;
}

/* Edges by how many triangles have them, in the one direction less in the other. */
struct Edges {
    size_t open = 0, crowded = 0;
};
inline Edges count_edges(const LodLevel &level)
{
    std::map<std::array<uint32_t, 2>, std::array<int, 2>> uses;
    for (size_t i = 0; i < level.indices.size(); ++i) {
        uint32_t a = level.indices[i], b = level.indices[i % 3 == 2 ? i - 2 : i + 1];
        ++uses[{std::min(a, b), std::max(a, b)}][a < b];
    }
    Edges edges;
    for (const auto &use : uses) {
        edges.open += use.second[0] + use.second[1] == 1;
        edges.crowded += use.second[0] > 1 || use.second[1] > 1;
    }
    return edges;
}

/* Calls with patch and triangle, three points of it relative to the anchor. */
inline void for_each(const LodLevel &level,
                     const std::function<void(size_t, const std::array<Vec3d, 3> &)> &call)
{
    for (size_t p = 0; p + 1 < level.first.size(); ++p)
        for (size_t t = level.first[p]; t < level.first[p + 1]; ++t)
            call(p, {point(level, level.indices[3 * t]), point(level, level.indices[3 * t + 1]),
                     point(level, level.indices[3 * t + 2])});
}

/* Texel (i, j) covers i..i+1, j..j+1. */
inline std::array<double, 2> texel(const gtx_patch &p, const Vec3d &point)
{
    Vec3d x(p.axis_x[0], p.axis_x[1], p.axis_x[2]), y(p.axis_y[0], p.axis_y[1], p.axis_y[2]);
    Vec3d z(p.axis_z[0], p.axis_z[1], p.axis_z[2]);
    Vec3d from = point - Vec3d(p.origin[0], p.origin[1], p.origin[2]);
    double det = dot(cross(x, y), z);
    return {dot(from, cross(y, z)) / det / p.extent_x * p.rect[2],
            dot(from, cross(z, x)) / det / p.extent_y * p.rect[3]};
}

/* Whether a texel has a code, or one at most `dilation` away. */
inline bool has_normal(const Maps &maps, const gtx_patch &p, int x, int y)
{
    for (int j = y - p.dilation; j <= y + p.dilation; ++j)
        for (int i = x - p.dilation; i <= x + p.dilation; ++i) {
            if (i < 0 || j < 0 || i >= p.rect[2] || j >= p.rect[3])
                continue;
            size_t row = size_t(p.page) * maps.page_height + p.rect[1] + j;
            if (maps.height[row * maps.page_width + p.rect[0] + i])
                return true;
        }
    return false;
}

/* A triangle faces its patch, but for what rounding does to slivers, and has a normal wherever it
 * is looked at. */
inline void assert_placed(const Maps &maps, size_t patch, const std::array<Vec3d, 3> &corner)
{
    const gtx_patch &p = maps.patches[patch];
    std::array<double, 2> at[3];
    for (int k = 0; k < 3; ++k)
        at[k] = texel(p, corner[k]);
    const double area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) -
                        (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]);
    double longest = 0;
    for (int k = 0; k < 3; ++k)
        longest = std::max(longest, std::hypot(at[k][0] - at[(k + 1) % 3][0],
                                               at[k][1] - at[(k + 1) % 3][1]));
    assert_true(area > -0.2 * longest); /* a sliver may be turned: .15 texel wide on the bunny */
    for (int a = 0; a <= 16; ++a) {
        for (int b = 0; a + b <= 16; ++b) {
            double u[2];
            for (int k = 0; k < 2; ++k)
                u[k] = (a * at[0][k] + b * at[1][k] + (16 - a - b) * at[2][k]) / 16;
            assert_true(u[0] > -0.5 && u[0] < p.rect[2] + 0.5);
            assert_true(u[1] > -0.5 && u[1] < p.rect[3] + 0.5);
            assert_true(has_normal(maps, p, int(u[0]), int(u[1])));
        }
    }
}

inline void assert_placed(const Lod &lod)
{
    for (const LodLevel &level : near_levels(lod))
        for_each(level, [&](size_t n, const std::array<Vec3d, 3> &corner) {
            assert_placed(lod.maps, n, corner);
        });
}

/* The greatest distance of points all over one surface from the other. */
inline double farthest(const baking::Surface &from, const baking::Surface &to)
{
    Task task(0, nullptr, nullptr);
    const NearestTree<baking::Surface> tree(to, task, 0);
    const size_t each = 1 + 60000 / from.size();
    uint32_t near = ~0u, random = 1;
    double most = 0;
    for (size_t t = 0; t < from.size(); ++t) {
        const std::array<Vec3d, 3> c = from.corners(t);
        for (size_t i = 0; i < each; ++i) {
            double share[2];
            for (double &s : share) {
                random = random * 1664525u + 1013904223u;
                s = (random >> 8) / double(1 << 24);
            }
            const double u = std::sqrt(share[0]), v = share[1];
            const Vec3d p = c[0] * (1 - u) + c[1] * (u * (1 - v)) + c[2] * (u * v);
            most = std::max(most, std::sqrt(tree.distance2(p, &near)));
        }
    }
    return most;
}

/* No point of a level is farther from the mesh than it says, nor a point of the mesh from it; and
 * it does not say much more. */
inline void assert_bounded(const Lod &lod, const Mesh &mesh)
{
    const double *anchor = lod.maps.anchor;
    Vector<Vec3d> at;
    for (const Vec3d &p : mesh.positions)
        at.push_back(p - Vec3d(anchor[0], anchor[1], anchor[2]));
    const baking::Surface source = {at, mesh.triangles};
    double before = 0;
    for (const LodLevel &level : lod.levels) {
        Vector<Vec3d> positions;
        Vector<std::array<uint32_t, 3>> triangles;
        for (uint32_t v = 0; 3 * v < level.positions.size(); ++v)
            positions.push_back(point(level, v));
        for (size_t i = 0; i < level.indices.size(); i += 3)
            triangles.push_back({level.indices[i], level.indices[i + 1], level.indices[i + 2]});
        const baking::Surface made = {positions, triangles};
        const double most = std::max(farthest(source, made), farthest(made, source));
        const double told = double(level.error);
        if (most > told)
            fail_msg("%zu triangles: %g instead of %g", triangles.size(), most, told);
        assert_true(level.rms > 0 && level.rms < level.error);
        assert_true(told <= std::max(1.8 * most, before));
        before = told;
    }
}

} // namespace lods
