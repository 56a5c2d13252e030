/* LOD meshes made of maps alone: as whole as those of meshes, along borders between patches too. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "bake/lods.hpp"

using namespace lods;

static Lod remade(const Mesh &mesh, Partition partition, BakeOptions options = {},
                  unsigned threads = 2)
{
    Task task(threads, nullptr, nullptr, {"bake", "pack", "lod"}, {1, 1, 1});
    Lod out = {bake(mesh, partition, options, task), {}};
    LodSource source = lod_source(out.maps, task);
    source.model = mesh.triangle_count();
    out.levels = make_lod(source, out.maps, 5, task);
    return out;
}

/* Everything that the maps show, as one level. */
static Edges edges_of_surface(const Mesh &mesh, Partition partition)
{
    Task task(2, nullptr, nullptr, {"bake", "pack", "lod"}, {1, 1, 1});
    const Maps maps = bake(mesh, partition, {}, task);
    LodLevel all;
    for (const auto &t : lod_source(maps, task).triangles)
        all.indices.insert(all.indices.end(), t.begin(), t.end());
    return count_edges(all);
}

static void neighbours_share_their_borders(void **)
{
    for (auto shape : {shapes::bumps, +[](const Vec3d &) { return 1.0; }}) {
        Mesh mesh = shapes::ball(40, shape);
        Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 64);
        Edges whole = edges_of_surface(mesh, partition);
        assert_int_equal(whole.open + whole.crowded, 0);
        Lod lod = remade(mesh, partition);
        assert_true(lod.levels.size() >= 3);
        assert_valid(lod);
        for (const LodLevel &level : lod.levels)
            assert_int_equal(count_edges(level).open, 0);
    }
}

static void the_surface_is_that_of_the_mesh(void **)
{
    Mesh mesh = shapes::ball(40, [](const Vec3d &) { return 1.0; });
    for (unsigned bits : {8u, 16u}) {
        BakeOptions options;
        options.height_bits = bits;
        Lod lod = remade(mesh, shapes::split(mesh, shapes::by_axis(mesh), 64), options);
        double volume = 0;
        for_each(lod.levels[0], [&](size_t, const std::array<Vec3d, 3> &c) {
            volume += dot(c[0], cross(c[1], c[2])) / 6;
            for (const Vec3d &p : c)
                assert_true(std::fabs(length(p) - 1) < 0.01);
        });
        assert_true(std::fabs(volume - 4.18879) < 0.05);
    }
}

/* A border of the model is none between patches: it stays open, and where it is. */
static void an_open_border_stays(void **)
{
    Mesh mesh = shapes::field(48, [](double u, double v) {
        return Vec3d(u, v, 0.05 * std::sin(7 * u) * std::cos(5 * v));
    });
    Lod lod = remade(mesh, shapes::split(mesh, [&](size_t t) {
        return mesh.position(t, 0).x < 0.5;
    }, 64));
    assert_valid(lod);
    for (const LodLevel &level : near_levels(lod)) {
        double area = 0;
        for_each(level, [&](size_t, const std::array<Vec3d, 3> &c) {
            area += cross(c[1] - c[0], c[2] - c[0]).z / 2;
        });
        assert_true(std::fabs(area - 1) < 0.03);
        assert_int_equal(count_edges(level).crowded, 0);
    }
}

static void one_patch_alone_is_its_own_surface(void **)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    shapes::add_normals(mesh);
    Lod lod = remade(mesh, shapes::split(mesh, shapes::all_in_one(), 16));
    assert_int_equal(lod.levels.size(), 1);
    assert_valid(lod);
}

static void any_thread_count_gives_the_same(void **)
{
    Mesh mesh = shapes::ball(48, shapes::bumps);
    Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 96);
    Lod one = remade(mesh, partition, {}, 1), many = remade(mesh, partition, {}, 7);
    assert_int_equal(one.levels.size(), many.levels.size());
    for (size_t k = 0; k < one.levels.size(); ++k) {
        assert_true(one.levels[k].indices == many.levels[k].indices);
        assert_true(one.levels[k].positions == many.levels[k].positions);
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(neighbours_share_their_borders),
        cmocka_unit_test(the_surface_is_that_of_the_mesh),
        cmocka_unit_test(an_open_border_stays),
        cmocka_unit_test(one_patch_alone_is_its_own_surface),
        cmocka_unit_test(any_thread_count_gives_the_same),
    };
    return cmocka_run_group_tests_name("LOD mesh of maps", tests, nullptr, nullptr);
}
