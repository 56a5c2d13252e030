/* The LOD mesh of charts that are cut straight into patches, which share the triangles at a cut. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "bake/lods.hpp"

using namespace lods;
using shapes::field;

/* At a pitch of its own, so that no patch can have more than 64 texels of it. */
static Partition cut(const Mesh &mesh, unsigned charts, double pitch = 0)
{
    Task task(2, nullptr, nullptr, {"partition", "frame"}, {1, 1});
    ChartOptions options;
    options.charts = charts;
    options.resolution = 64;
    options.pitch = pitch;
    return make_partition(mesh, options, task);
}

static LodSource source_of(const Mesh &mesh, Partition partition, Maps &maps,
                           unsigned threads = 2)
{
    Task task(threads, nullptr, nullptr, {"bake", "pack", "lod"}, {1, 1, 1});
    maps = bake(mesh, partition, {}, task);
    return lod_source(mesh, partition, maps, task);
}

static Edges count_edges(const gtx::Vector<std::array<uint32_t, 3>> &triangles)
{
    LodLevel level;
    for (const auto &t : triangles)
        level.indices.insert(level.indices.end(), t.begin(), t.end());
    return lods::count_edges(level);
}

static void assert_placed(const LodSource &source, const Maps &maps)
{
    for (size_t t = 0; t < source.triangles.size(); ++t) {
        std::array<Vec3d, 3> corner;
        for (int k = 0; k < 3; ++k)
            corner[k] = source.positions[source.triangles[t][k]];
        lods::assert_placed(maps, source.patch[t], corner);
    }
}

static double area_of(const LodSource &source)
{
    double area = 0;
    for (const auto &[a, b, c] : source.triangles)
        area += length(cross(source.positions[b] - source.positions[a],
                             source.positions[c] - source.positions[a])) / 2;
    return area;
}

static Mesh cube()
{
    return shapes::ball(1, [](const Vec3d &d) {
        return 1 / std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    });
}

static bool is_cut(const Partition &partition)
{
    return std::any_of(partition.charts.begin(), partition.charts.end(), [](const Chart &c) {
        return std::isfinite(c.clip_low[0]) || std::isfinite(c.clip_low[1]);
    });
}

/* Two triangles a side, many patches: all edges are split alike from both sides. */
static void a_cube_is_split_at_its_cuts(void **)
{
    Mesh mesh = cube();
    assert_int_equal(mesh.triangle_count(), 12);
    Partition partition = cut(mesh, 60, 0.015);
    assert_true(is_cut(partition));
    Maps maps;
    LodSource source = source_of(mesh, partition, maps);
    assert_in_range(source.triangles.size(), partition.charts.size(), 60 * 60);
    assert_int_equal(count_edges(source.triangles).open, 0);
    assert_int_equal(count_edges(source.triangles).crowded, 0);
    assert_true(std::fabs(area_of(source) - 24) < 1e-9);
    for (const Vec3d &p : source.positions)
        assert_true(std::fabs(std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) - 1) <
                    1e-12);
    assert_placed(source, maps);
}

static void every_patch_has_its_part(void **)
{
    Mesh mesh = field(1, [](double u, double v) { return Vec3d(2 * u + 0.3 * v, v, 0.1 * u); });
    Partition partition = cut(mesh, 24, 0.01);
    assert_true(partition.charts.size() >= 8);
    Maps maps;
    LodSource source = source_of(mesh, partition, maps);
    assert_placed(source, maps);
    gtx::Vector<size_t> count(maps.patches.size());
    for (uint32_t p : source.patch)
        ++count[p];
    for (size_t n : count)
        assert_true(n > 0);
    assert_int_equal(count_edges(source.triangles).crowded, 0);
}

/* Triangles smaller than texels need no splitting, each has one patch. */
static void small_triangles_stay_whole(void **)
{
    Mesh mesh = shapes::ball(60, shapes::bumps);
    Partition partition = cut(mesh, 40);
    assert_true(is_cut(partition));
    Maps maps;
    LodSource source = source_of(mesh, partition, maps);
    assert_in_range(source.triangles.size(), mesh.triangle_count(),
                    mesh.triangle_count() + mesh.triangle_count() / 50);
    assert_int_equal(count_edges(source.triangles).open, 0);
    assert_placed(source, maps);
}

static void lods_of_cuts_are_whole(void **)
{
    const Mesh meshes[] = {cube(), shapes::ball(3, shapes::bumps), shapes::ball(12, shapes::bumps),
                           shapes::ball(60, shapes::bumps)};
    for (const Mesh &mesh : meshes) {
        for (unsigned charts : {12u, 40u, 150u}) {
            Partition partition = cut(mesh, charts);
            Lod lod = lod_of(mesh, partition);
            assert_true(lod.levels.size() >= 1);
            assert_valid(lod);
            assert_placed(lod);
            for (const LodLevel &level : lod.levels) {
                assert_int_equal(lods::count_edges(level).open, 0);
                assert_int_equal(lods::count_edges(level).crowded, 0);
            }
        }
    }
}

static void open_fields_keep_their_outline(void **)
{
    for (unsigned n : {1u, 3u, 60u}) {
        Mesh mesh = field(n, [](double u, double v) {
            return Vec3d(u, v, 0.05 * std::sin(7 * u) * std::cos(5 * v));
        });
        Lod lod = lod_of(mesh, cut(mesh, 30));
        assert_valid(lod);
        assert_placed(lod);
        for (const LodLevel &level : lod.levels) {
            double area = 0;
            for_each(level, [&](size_t, const std::array<Vec3d, 3> &c) {
                area += cross(c[1] - c[0], c[2] - c[0]).z / 2;
            });
            assert_true(std::fabs(area - 1) < 0.002 + 4 * level.error);
            assert_int_equal(lods::count_edges(level).crowded, 0);
        }
    }
}

static void any_thread_count_splits_the_same(void **)
{
    Mesh mesh = shapes::ball(3, shapes::bumps);
    Partition partition = cut(mesh, 60);
    Maps maps;
    LodSource one = source_of(mesh, partition, maps, 1);
    LodSource many = source_of(mesh, partition, maps, 7);
    assert_true(one.triangles == many.triangles && one.patch == many.patch);
    assert_memory_equal(one.positions.data(), many.positions.data(),
                        one.positions.size() * sizeof(Vec3d));
}

/* Those of the border, at every level whose triangles lie in their patches. */
static void vertices_can_be_kept(void **)
{
    const Mesh mesh = field(48, [](double u, double v) {
        return Vec3d(u, v, 0.1 * std::sin(19 * u + 3 * v) * std::cos(17 * v));
    });
    Partition partition = shapes::split(mesh, [&](size_t t) {
        return mesh.position(t, 0).x < 0.5;
    }, 64);
    auto on_border = [](double x) { return x == 0 || x == 1; };
    for (bool kept : {false, true}) {
        Task task(2, nullptr, nullptr, {"bake", "pack", "lod"}, {1, 1, 1});
        Lod lod = {bake(mesh, partition, {}, task), {}};
        LodSource source = lod_source(mesh, partition, lod.maps, task);
        for (const Vec3d &p : source.positions)
            source.kept.push_back(kept && (on_border(p.x + lod.maps.anchor[0]) ||
                                           on_border(p.y + lod.maps.anchor[1])));
        lod.levels = make_lod(source, lod.maps, 3, task);
        assert_valid(lod);
        for (const LodLevel &level : near_levels(lod)) {
            if (kept)
                assert_true(count_edges(level).open >= 4 * 48);
            else
                assert_true(count_edges(level).open < 4 * 40);
        }
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(vertices_can_be_kept),
        cmocka_unit_test(a_cube_is_split_at_its_cuts),
        cmocka_unit_test(every_patch_has_its_part),
        cmocka_unit_test(small_triangles_stay_whole),
        cmocka_unit_test(lods_of_cuts_are_whole),
        cmocka_unit_test(open_fields_keep_their_outline),
        cmocka_unit_test(any_thread_count_splits_the_same),
    };
    return cmocka_run_group_tests_name("LOD mesh cuts", tests, nullptr, nullptr);
}
