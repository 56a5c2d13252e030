/* The LOD mesh of meshes with known surfaces: how far it strays, that it stays whole and where its
 * patches have normals, and that any number of threads makes the same. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "bake/lods.hpp"

#include <set>

using namespace lods;
using shapes::field;

static void a_ball_stays_closed_and_near(void **)
{
    Mesh mesh = shapes::ball(40, [](const Vec3d &) { return 1.0; });
    Lod lod = lod_of(mesh, shapes::split(mesh, shapes::by_axis(mesh), 64));
    assert_int_equal(lod.levels.size(), 5);
    assert_valid(lod);
    assert_placed(lod);
    size_t before = mesh.triangle_count();
    double error = 0;
    for (const LodLevel &level : lod.levels) {
        assert_true(4 * level.triangle_count() <= 3 * before);
        assert_true(level.error >= error);
        before = level.triangle_count();
        error = level.error;
        Edges edges = count_edges(level); /* neighbours share their vertices, so their borders */
        assert_int_equal(edges.open, 0);
        assert_int_equal(edges.crowded, 0);
        double deepest = 0;
        size_t outside = 0;
        for_each(level, [&](size_t, const std::array<Vec3d, 3> &c) {
            for (const Vec3d &p : c) {
                assert_true(std::fabs(length(p) - 1) < 3 * level.error + 2 * level.step);
                outside += length(p) > 1;
            }
            deepest = std::max(deepest, 1 - length((c[0] + c[1] + c[2]) / 3));
        });
        assert_true(deepest < 4 * level.error + level.step);
        /* vertices settled where triangles cut off as little as they add */
        assert_true(level.error < 4 * level.step || outside > 2 * level.triangle_count());
    }
    assert_bounded(lod, mesh);
    assert_true(lod.levels[0].error < 0.01 && lod.levels[0].triangle_count() < 2401);
}

static void bumps_stay_closed(void **)
{
    Mesh mesh = shapes::ball(48, shapes::bumps);
    Lod lod = lod_of(mesh, shapes::split(mesh, shapes::by_axis(mesh), 96));
    assert_true(lod.levels.size() >= 3);
    assert_valid(lod);
    assert_placed(lod);
    assert_bounded(lod, mesh);
    for (const LodLevel &level : lod.levels)
        assert_int_equal(count_edges(level).open + count_edges(level).crowded, 0);
}

/* Two halves with vertices of their own where they meet, as height fields have that more than two
 * share an edge with: they do not part. */
static void fields_that_meet_stay_together(void **)
{
    Mesh mesh = shapes::ball(40, shapes::bumps);
    std::map<uint32_t, uint32_t> other;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        if (mesh.position(t, 0).z + mesh.position(t, 1).z + mesh.position(t, 2).z < 0)
            continue;
        for (uint32_t &v : mesh.triangles[t]) {
            const auto [own, is_new] = other.try_emplace(v, uint32_t(mesh.positions.size()));
            if (is_new)
                mesh.positions.push_back(Vec3d(mesh.positions[v]));
            v = own->second;
        }
    }
    Lod lod = lod_of(mesh, shapes::split(mesh, shapes::by_axis(mesh), 64));
    assert_true(lod.levels.size() >= 3);
    assert_valid(lod);
    for (const LodLevel &level : lod.levels)
        assert_int_equal(count_edges(level).open + count_edges(level).crowded, 0);
}

/* Nothing but its twelve edges matters: what is left are corners and a few more. */
static void a_cube_keeps_its_corners(void **)
{
    Mesh mesh = shapes::ball(24, [](const Vec3d &d) {
        return 1 / std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    });
    Lod lod = lod_of(mesh, shapes::split(mesh, shapes::by_axis(mesh), 64));
    assert_true(lod.levels.size() >= 1);
    assert_valid(lod);
    assert_placed(lod);
    const LodLevel &last = lod.levels.back();
    assert_true(last.triangle_count() <= 60 && last.error < 0.03);
    std::set<std::array<int, 3>> corners;
    for (uint32_t v = 0; v < last.positions.size() / 3; ++v) {
        Vec3d p = point(last, v);
        if (std::fabs(p.x) > 0.98 && std::fabs(p.y) > 0.98 && std::fabs(p.z) > 0.98)
            corners.insert({p.x > 0, p.y > 0, p.z > 0});
    }
    assert_int_equal(corners.size(), 8);
}

static void an_open_border_stays(void **)
{
    Mesh mesh = field(48, [](double u, double v) {
        return Vec3d(u, v, 0.05 * std::sin(7 * u) * std::cos(5 * v));
    });
    Lod lod = lod_of(mesh, shapes::split(mesh, [&](size_t t) {
        return mesh.position(t, 0).x < 0.5;
    }, 64));
    assert_valid(lod);
    assert_placed(lod);
    for (const LodLevel &level : near_levels(lod)) {
        double area = 0;
        for_each(level, [&](size_t, const std::array<Vec3d, 3> &c) {
            area += cross(c[1] - c[0], c[2] - c[0]).z / 2;
        });
        assert_true(std::fabs(area - 1) < 0.01);
        assert_int_equal(count_edges(level).crowded, 0);
    }
}

static void a_two_sided_strip_stays(void **)
{
    Mesh mesh = field(40, [](double u, double v) {
        return Vec3d(u, v / 8, 0.1 * std::sin(6 * u));
    });
    Partition partition = shapes::split(mesh, shapes::all_in_one(), 64);
    partition.charts[0].two_sided = true;
    Lod lod = lod_of(mesh, partition);
    assert_true(lod.levels.size() >= 2);
    assert_valid(lod);
    assert_placed(lod);
}

static void two_components_both_stay(void **)
{
    Mesh mesh = shapes::ball(20, [](const Vec3d &) { return 1.0; });
    const size_t vertices = mesh.positions.size(), triangles = mesh.triangle_count();
    for (size_t v = 0; v < vertices; ++v)
        mesh.positions.push_back(mesh.positions[v] * 0.2 + Vec3d(3, 0, 0));
    for (size_t t = 0; t < triangles; ++t) {
        std::array<uint32_t, 3> other = mesh.triangles[t];
        for (uint32_t &v : other)
            v += uint32_t(vertices);
        mesh.triangles.push_back(other);
    }
    mesh.normals.insert(mesh.normals.end(), mesh.normals.begin(), mesh.normals.end());
    auto axis = shapes::by_axis(mesh);
    Lod lod = lod_of(mesh, shapes::split(mesh, [&](size_t t) {
        return axis(t) + 6 * (t >= triangles);
    }, 64));
    assert_valid(lod);
    assert_placed(lod);
    for (const LodLevel &level : lod.levels) {
        size_t small = 0;
        for_each(level, [&](size_t p, const std::array<Vec3d, 3> &) { small += p >= 6; });
        assert_in_range(small, 4, level.triangle_count() - 4);
        assert_int_equal(count_edges(level).open, 0);
    }
}

/* From a point to a triangle. */
static double distance_to(const std::array<Vec3d, 3> &c, const Vec3d &p)
{
    const Vec3d n = cross(c[1] - c[0], c[2] - c[0]);
    bool above = true;
    double least = INFINITY;
    for (int k = 0; k < 3; ++k) {
        const Vec3d edge = c[(k + 1) % 3] - c[k], from = p - c[k];
        above = above && dot(cross(n, edge), from) >= 0;
        const double at = std::clamp(dot(from, edge) / dot(edge, edge), 0.0, 1.0);
        least = std::min(least, length(from - edge * at));
    }
    return above ? std::fabs(dot(n, p - c[0])) / length(n) : least;
}

/* Narrow tips, which a mean of distances would give up: hardly a vertex of the source is farther
 * outside than half a level's error, and none is by much. */
static void tips_are_reached(void **)
{
    Mesh mesh = shapes::ball(40, [](const Vec3d &d) {
        return 1 + 0.25 * std::pow(std::sin(8 * d.x) * std::sin(9 * d.y) * std::sin(7 * d.z), 6);
    });
    Lod lod = lod_of(mesh, shapes::split(mesh, shapes::by_axis(mesh), 96));
    assert_true(lod.levels.size() >= 4);
    assert_bounded(lod, mesh);
    for (const LodLevel &level : lod.levels) {
        if (level.far)
            continue;
        size_t outside = 0;
        for (const Vec3d &p : mesh.positions) {
            double least = INFINITY, height = 0;
            for_each(level, [&](size_t, const std::array<Vec3d, 3> &c) {
                const double distance = distance_to(c, p);
                if (distance >= least)
                    return;
                least = distance;
                height = dot(cross(c[1] - c[0], c[2] - c[0]), p - c[0]) > 0 ? distance : 0;
            });
            outside += height > 0.5 * level.error + level.step;
            assert_true(height < level.error + level.step);
        }
        assert_true(outside <= mesh.positions.size() / 200);
    }
}

static void one_triangle_is_its_own_lod(void **)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    shapes::add_normals(mesh);
    Lod lod = lod_of(mesh, shapes::split(mesh, shapes::all_in_one(), 16));
    assert_int_equal(lod.levels.size(), 1);
    assert_int_equal(lod.levels[0].triangle_count(), 1);
    assert_true(lod.levels[0].error <= lod.levels[0].step);
    assert_valid(lod);
}

static void none_and_fewer_levels_can_be_asked_for(void **)
{
    Mesh mesh = shapes::ball(20, shapes::bumps);
    Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 48);
    assert_int_equal(lod_of(mesh, partition, 0).levels.size(), 0);
    Lod one = lod_of(mesh, partition, 1), three = lod_of(mesh, partition, 3);
    assert_int_equal(near_levels(one).size(), 1);
    assert_int_equal(near_levels(three).size(), 3);
    assert_true(one.levels[0].indices == three.levels[0].indices);
}

static void any_thread_count_gives_the_same(void **)
{
    Mesh mesh = shapes::ball(48, shapes::bumps);
    Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 96);
    Lod one = lod_of(mesh, partition, 5, 1), many = lod_of(mesh, partition, 5, 7);
    assert_int_equal(one.levels.size(), many.levels.size());
    for (size_t k = 0; k < one.levels.size(); ++k) {
        assert_true(one.levels[k].indices == many.levels[k].indices);
        assert_true(one.levels[k].positions == many.levels[k].positions);
        assert_true(one.levels[k].first == many.levels[k].first);
        assert_true(one.levels[k].error == many.levels[k].error);
    }
}

/* Every option of baking, and a place far from the origin. */
static void options_and_offsets_are_followed(void **)
{
    Mesh mesh = shapes::ball(24, shapes::bumps);
    for (Vec3d &p : mesh.positions)
        p = p * 100 + Vec3d(1e7, -2e7, 3e6);
    Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 64);
    for (unsigned bits : {8u, 16u}) {
        for (unsigned mips : {1u, 8u}) {
            BakeOptions options;
            options.height_bits = bits;
            options.mips = mips;
            Lod lod = lod_of(mesh, partition, 5, 2, options);
            assert_true(lod.levels.size() >= 2);
            assert_valid(lod);
            assert_int_equal(count_edges(lod.levels[0]).open, 0);
        }
    }
}

/* The LOD mesh of a file in the folder of models. */
static Lod lod_of_file(const char *file, Mesh &mesh)
{
    Task task(2, nullptr, nullptr, {"partition", "frame", "bake", "pack", "lod"},
              {1, 1, 1, 1, 1});
    CleanReport report;
    const std::string models = getenv("GEOTEX_MODELS");
    mesh = clean_mesh(import_mesh(models + "/scans/" + file, task), task, report);
    Partition partition = make_partition(mesh, {}, task);
    Lod lod = {bake(mesh, partition, {}, task), {}};
    lod.levels = make_lod(lod_source(mesh, partition, lod.maps, task), lod.maps, 5, task);
    return lod;
}

/* A real scan, with holes in it. */
static void a_scan_is_followed(void **)
{
    if (!getenv("GEOTEX_MODELS"))
        skip();
    Mesh mesh;
    Lod lod = lod_of_file("bunny.ply", mesh);
    assert_true(lod.levels.size() >= 4);
    assert_valid(lod);
    assert_placed(lod);
    const double diagonal = 0.25;
    assert_bounded(lod, mesh);
    assert_true(lod.levels[0].error < 2.5e-3 * diagonal);
    /* The finest as near as height fields are, the next ones of a few bytes. */
    assert_true(lod.levels[0].error < 0.5e-3 * diagonal);
    assert_true(lod.levels[0].triangle_count() > mesh.triangle_count() / 2);
    assert_true(lod.levels[1].triangle_count() < mesh.triangle_count() / 4);
    assert_true(lod.levels[2].triangle_count() < mesh.triangle_count() / 7);
    /* No spots set an error: without vertices of their own 10 and 11 times the mean. */
    for (int k = 1; k < 3; ++k)
        assert_true(lod.levels[k].error < 9 * lod.levels[k].rms);
}

/* Not an edge of a closed model is open at any level: nothing shows through. */
static void closed_models_stay_closed(void **)
{
    if (!getenv("GEOTEX_MODELS"))
        skip();
    for (const char *file : {"armadillo_86k.obj.gz", "horse.ply.gz", "rocker-arm.obj"}) {
        Mesh mesh;
        Lod lod = lod_of_file(file, mesh);
        assert_true(lod.levels.size() >= 3);
        assert_bounded(lod, mesh);
        for (const LodLevel &level : lod.levels)
            assert_int_equal(count_edges(level).open, 0);
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_stays_closed_and_near),
        cmocka_unit_test(bumps_stay_closed),
        cmocka_unit_test(fields_that_meet_stay_together),
        cmocka_unit_test(a_cube_keeps_its_corners),
        cmocka_unit_test(an_open_border_stays),
        cmocka_unit_test(a_two_sided_strip_stays),
        cmocka_unit_test(two_components_both_stay),
        cmocka_unit_test(tips_are_reached),
        cmocka_unit_test(one_triangle_is_its_own_lod),
        cmocka_unit_test(none_and_fewer_levels_can_be_asked_for),
        cmocka_unit_test(any_thread_count_gives_the_same),
        cmocka_unit_test(options_and_offsets_are_followed),
        cmocka_unit_test(a_scan_is_followed),
        cmocka_unit_test(closed_models_stay_closed),
    };
    return cmocka_run_group_tests_name("lod", tests, nullptr, nullptr);
}
