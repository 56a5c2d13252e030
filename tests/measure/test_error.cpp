/* Distances where the answer is known. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "common/fixture.h"
#include "measure/cells.hpp"
#include "measure/measure.hpp"
#include "measure/view.hpp"
#include "meshes.hpp"

using namespace gtx;

static double uniform(uint64_t &seed)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return double(seed >> 11) / 9007199254740992.0;
}

static Vec3d random_point(uint64_t &seed, double size)
{
    double x = uniform(seed), y = uniform(seed), z = uniform(seed);
    return (Vec3d(x, y, z) - Vec3d(0.5, 0.5, 0.5)) * size;
}

static SurfaceError error_of(const gtx_asset *asset, const Mesh &mesh,
                             const Vector<uint8_t> &junk = {})
{
    Task task(2, nullptr, nullptr);
    return surface_error({asset}, mesh, junk, task);
}

static void triangle_distance_is_the_least(void **)
{
    uint64_t seed = 1;
    for (int round = 0; round < 200; ++round) {
        Vec3d a = random_point(seed, 2), b = random_point(seed, 2), c = random_point(seed, 2);
        Vec3d p = random_point(seed, 4);
        double least = 1e9, found = std::sqrt(triangle_distance2(p, a, b, c));
        for (int i = 0; i <= 60; ++i)
            for (int j = 0; i + j <= 60; ++j) {
                Vec3d q = a + (b - a) * (i / 60.) + (c - a) * (j / 60.);
                least = std::min(least, length(p - q));
            }
        assert_true(found <= least + 1e-12);
        assert_true(found >= least - 0.06);
    }
    Vec3d o, x(1, 0, 0), half(0.5, 0, 0); /* degenerate: a segment, a point */
    assert_float_equal(triangle_distance2(Vec3d(0.5, 2, 0), o, x, half), 4, 1e-12);
    assert_float_equal(triangle_distance2(Vec3d(0, 3, 0), o, o, o), 9, 1e-12);
}

struct Soup {
    Vector<Vec3d> corners;
    size_t size() const { return corners.size() / 3; }
    size_t looks(size_t) const { return 1; }
    Box box(size_t i) const
    {
        Box box;
        for (int k = 0; k < 3; ++k)
            box.add(corners[3 * i + k]);
        return box;
    }
    double distance2(size_t i, const Vec3d &p, double) const
    {
        return triangle_distance2(p, corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]);
    }
};

static void tree_finds_the_nearest(void **)
{
    uint64_t seed = 2;
    for (size_t count : {0, 1, 4, 5, 300}) {
        Soup soup;
        for (size_t i = 0; i < count; ++i) {
            Vec3d at = random_point(seed, 4);
            for (int k = 0; k < 3; ++k)
                soup.corners.push_back(at + random_point(seed, 0.5));
        }
        Task task(0, nullptr, nullptr);
        NearestTree<Soup> tree(soup, task, 0);
        uint32_t near = NO_HIT; /* then whatever the point before was near to */
        for (int q = 0; q < 500; ++q) {
            Vec3d p = random_point(seed, 8);
            double least = std::numeric_limits<double>::infinity();
            for (size_t i = 0; i < count; ++i)
                least = std::min(least, soup.distance2(i, p, least));
            assert_true(tree.distance2(p, &near) == least);
            assert_true(count ? soup.distance2(near, p, least) == least : near == NO_HIT);
        }
    }
}

/* Triangles over each other: whatever the tree, one cannot be told from the next. */
static void few_looks_find_something_as_near_at_least(void **)
{
    uint64_t seed = 3;
    Soup soup;
    for (size_t i = 0; i < 3 * 5000; ++i)
        soup.corners.push_back(random_point(seed, 4));
    Task task(0, nullptr, nullptr);
    NearestTree<Soup> tree(soup, task, 0);
    size_t looks = 1000, visited = 0;
    for (int q = 0; q < 100; ++q) {
        const Vec3d p = random_point(seed, 4);
        uint32_t near = NO_HIT, found = NO_HIT;
        const size_t before = looks;
        const double quick = tree.distance2(p, &found, &looks);
        visited += before - looks;
        assert_true(quick >= tree.distance2(p, &near));
        assert_true(soup.distance2(found, p, INFINITY) == quick);
    }
    assert_int_equal(looks, 0);
    assert_int_equal(visited, 1000);
}

static void an_offset_plane_is_off_by_its_offset(void **)
{
    gtx_asset *asset = fixture_flat(0.5, 8);
    for (double d : {0.01, -0.3}) {
        Mesh mesh = plane_mesh(3.875, 2.875, 0.5 + d, 5);
        double diagonal = std::hypot(3.875, 2.875);
        SurfaceError e = error_of(asset, mesh);
        assert_float_equal(e.forward.rms, std::abs(d) / diagonal, 1e-7);
        assert_float_equal(e.forward.max, std::abs(d) / diagonal, 1e-7);
        assert_float_equal(e.reverse.rms, std::abs(d) / diagonal, 1e-7);
        assert_float_equal(e.reverse.max, std::abs(d) / diagonal, 1e-7);
    }
    gtx_close(asset);
}

static void half_field(const gtx_patch *, double x, double, const void *, fixture_texel *out)
{
    out->height = 0.5;
    out->trim = x - 7.5;
}

/* The height field is shown up to 0.3 texels past its outline at x = 7.5, and nothing of it
 * beyond. */
static void trim_is_honoured(void **)
{
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 16, 16, 1, 1), half_field, nullptr};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 1);
    Cells cells({asset});
    Task task(0, nullptr, nullptr);
    NearestTree<Cells> tree(cells, task, 0);
    uint32_t near = NO_HIT;
    assert_float_equal(std::sqrt(tree.distance2(Vec3d(12, 7.3, 0.5), &near)), 12 - 7.8, 0.02);
    assert_float_equal(std::sqrt(tree.distance2(Vec3d(7.7, 7.3, 0.75), &near)), 0.25, 1e-9);
    double area = 0;
    for (size_t i = 0; i < cells.size(); ++i)
        area += cells.shown_area(i);
    assert_float_equal(area, 7.75 * 15, 0.01); /* a grid of 4x4 samples a cell */
    /* Reverse samples are of all that is drawn. */
    Mesh wide = plane_mesh(7.8, 15, 0.5, 3), narrow = plane_mesh(7, 15, 0.5, 3);
    assert_float_equal(error_of(asset, wide).reverse.max, 0, 1e-9);
    assert_float_equal(error_of(asset, narrow).reverse.max, 0.8 / std::hypot(7, 15), 1e-3);
    gtx_close(asset);
}

static void a_sphere_is_near_its_asset(void **)
{
    gtx_asset *asset = fixture_sphere(2, 96, 16);
    SurfaceError e = error_of(asset, sphere_mesh(2, 100));
    print_message("# forward %.2e max %.2e, reverse %.2e max %.2e\n", e.forward.rms, e.forward.max,
                  e.reverse.rms, e.reverse.max);
    assert_true(e.forward.rms > 0 && e.forward.rms < 1e-4 && e.forward.max < 1e-3);
    assert_true(e.reverse.rms > 0 && e.reverse.rms < 1e-4 && e.reverse.max < 1e-3);
    gtx_close(asset);
}

static void what_is_missing_is_far(void **)
{
    gtx_asset *asset = fixture_sphere_without(2, 64, 8, 1 << 4);
    SurfaceError e = error_of(asset, sphere_mesh(2, 40));
    double diagonal = 4 * std::sqrt(3.), to_rim = 2 * 2 * std::sin(std::atan(1.) / 2);
    assert_true(e.forward.max > 0.9 * to_rim / diagonal);
    assert_true(e.reverse.max < 0.01);
    gtx_close(asset);
}

static void junk_is_left_out(void **)
{
    gtx_asset *asset = fixture_flat(0.5, 8);
    Mesh mesh = plane_mesh(3.875, 2.875, 0.5, 2);
    uint32_t first = uint32_t(mesh.positions.size());
    for (int k = 0; k < 3; ++k)
        mesh.positions.push_back({double(k == 1), double(k == 2), 3});
    mesh.triangles.push_back({first, first + 1, first + 2});
    Vector<uint8_t> junk(mesh.triangle_count(), 0);
    assert_true(error_of(asset, mesh, junk).forward.max > 0.4);
    junk.back() = 1;
    assert_float_equal(error_of(asset, mesh, junk).forward.max, 0, 1e-7);
    gtx_close(asset);
}

static void other_half(const gtx_patch *, double x, double, const void *, fixture_texel *out)
{
    out->height = 0.5;
    out->trim = 7.5 - x;
}

/* Two halves of a plane meet, the second a little higher; the plane goes on around them. */
static void a_step_between_patches_is_seen(void **)
{
    for (double step : {0., 0.05}) {
        const double corner[3] = {10, 10, 0}, raised[3] = {10, 10, step};
        fixture_patch patches[] = {{fixture_frame(corner, 16, 16, 1, 1), half_field, nullptr},
                                   {fixture_frame(raised, 16, 16, 1, 1), other_half, nullptr}};
        gtx_asset *asset = fixture_build(patches, 2, 8, 1);
        Task task(2, nullptr, nullptr);
        SeamReport seams = measure_seams({asset}, plane_mesh(40, 40, 0.5, 5), task);
        assert_int_equal(seams.points, 100000);
        assert_int_equal(seams.within_two_steps, step > 0 ? 0 : 100000);
        assert_float_equal(seams.p99_steps, step * 254, 1e-3);
        assert_float_equal(seams.max_steps, step * 254, 1e-3);
        assert_float_equal(seams.max, step / std::hypot(40, 40), 1e-6);
        /* Where the source ends, no neighbour is missed. */
        seams = measure_seams({asset}, plane_mesh(17.5, 40, 0.5, 5), task);
        assert_int_equal(seams.points, 0);
        gtx_close(asset);
    }
}

static void empty_field(const gtx_patch *, double, double, const void *, fixture_texel *out)
{
    out->height = -1;
    out->trim = 7;
}

static void an_asset_without_surface_is_infinitely_far(void **)
{
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 8, 8, 1, 1), empty_field, nullptr};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 1);
    SurfaceError e = error_of(asset, plane_mesh(1, 1, 0, 1));
    assert_true(std::isinf(e.forward.rms) && std::isinf(e.forward.max));
    assert_true(e.reverse.rms == 0 && e.reverse.max == 0);
    gtx_close(asset);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangle_distance_is_the_least),
        cmocka_unit_test(tree_finds_the_nearest),
        cmocka_unit_test(few_looks_find_something_as_near_at_least),
        cmocka_unit_test(an_offset_plane_is_off_by_its_offset),
        cmocka_unit_test(trim_is_honoured),
        cmocka_unit_test(a_sphere_is_near_its_asset),
        cmocka_unit_test(what_is_missing_is_far),
        cmocka_unit_test(junk_is_left_out),
        cmocka_unit_test(a_step_between_patches_is_seen),
        cmocka_unit_test(an_asset_without_surface_is_infinitely_far),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
