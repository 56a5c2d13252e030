/* The views of a comparison, and what is seen of a mesh in them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "measure/view.hpp"
#include "meshes.hpp"

#include <algorithm>
#include <cmath>

using namespace gtx;

static void views_are_26(void **)
{
    Extent extent = extent_of(sphere_mesh(3, 8, Vec3d(1, 2, 3)));
    assert_float_equal(extent.radius, 3, 1e-9);
    assert_float_equal(extent.diagonal, 6 * std::sqrt(3.), 1e-9);
    Vector<View> views = comparison_views(extent, 100);
    assert_int_equal(views.size(), 26);
    for (const View &v : views) {
        Vec3d z = cross(v.right, v.up) - v.toward;
        assert_float_equal(dot(z, z), 0, 1e-12);
        assert_float_equal(length(v.toward), 1, 1e-12);
        Vec3d top = v.project(extent.centre + v.up * extent.radius);
        assert_float_equal(top.x, 50, 1e-9);
        assert_float_equal(top.y, 2, 1e-9);
        Vec3d near_point = v.project(extent.centre + v.toward * extent.radius);
        assert_float_equal(near_point.z, extent.radius, 1e-9);
        assert_true(v.up.y > 1e-9 || std::abs(v.toward.y) > 0.999);
    }
}

static void raster_is_tight(void **)
{
    Mesh sphere = sphere_mesh(1, 40, Vec3d(5, 0, 0));
    for (const View &view : comparison_views(extent_of(sphere), 96)) {
        MeshImage image = rasterise(sphere, view);
        for (uint32_t j = 0; j < 96; ++j)
            for (uint32_t i = 0; i < 96; ++i) {
                double from_centre = std::hypot(i + 0.5 - 48, j + 0.5 - 48) * view.pixel;
                bool covered = image.triangle[j * 96 + i] != NO_HIT;
                if (from_centre < 0.995) { /* no pinhole */
                    assert_true(covered);
                    assert_int_equal(image.front[j * 96 + i], 1);
                    double depth = 2 - std::sqrt(1 - from_centre * from_centre);
                    assert_true(std::abs(image.depth[j * 96 + i] - depth) < 0.02);
                } else if (from_centre > 1) {
                    assert_false(covered);
                }
            }
    }
}

/* Two rectangles with a slit of a fifth of a pixel between them, between the centres of pixels. */
static void slits_are_seen_from_close(void **)
{
    Extent extent;
    extent.radius = 1;
    for (const View &view : comparison_views(extent, 32)) {
        if (view.toward.z < 0.999)
            continue;
        const double slit = view.at(15, 0).x + view.pixel / 2, half = view.pixel / 10;
        Mesh mesh;
        const std::array<double, 2> sides[] = {{-0.9, slit - half}, {slit + half, 0.9}};
        for (const auto &[from, to] : sides) {
            const uint32_t at = uint32_t(mesh.positions.size());
            for (double y : {-0.9, 0.9})
                for (double x : {from, to})
                    mesh.positions.push_back({x, y, 0.25});
            mesh.triangles.push_back({at, at + 1, at + 3});
            mesh.triangles.push_back({at, at + 3, at + 2});
        }
        const MeshImage image = rasterise(mesh, view);
        const Vector<ClosePixel> pixels = {{15, 16, INFINITY}, {16, 9, INFINITY},
                                           {9, 16, INFINITY}, {10, 16, 0.25}};
        const Vector<MeshImage> close = rasterise_close(mesh, view, pixels);
        assert_int_equal(close.size(), 4);
        const auto &shown = close[3].triangle; /* all is deeper than it asks for */
        assert_int_equal(std::count(shown.begin(), shown.end(), NO_HIT), CLOSE_SIDE * CLOSE_SIDE);
        for (size_t k = 0; k < 3; ++k) {
            const size_t centre = CLOSER * CLOSE_SIDE + CLOSER;
            const size_t pixel = pixels[k].j * 32 + pixels[k].i;
            assert_int_equal(image.front[pixel], 1);
            assert_int_equal(close[k].triangle[centre], image.triangle[pixel]);
            assert_float_equal(close[k].depth[centre], image.depth[pixel], 1e-6);
            const auto &front = close[k].front;
            assert_int_equal(std::count(front.begin(), front.end(), 0), k < 2 ? CLOSE_SIDE : 0);
        }
    }
}

/* A rectangle seen along its normal covers the pixels whose centres are in it; the view from behind
 * shows a back, unless it is two-sided. */
static void facing_is_told(void **)
{
    Mesh plane = plane_mesh(4, 3, 0.5, 3);
    for (int two_sided = 0; two_sided < 2; ++two_sided) {
        plane.flags.assign(plane.triangle_count(), two_sided ? TRIANGLE_TWO_SIDED : 0);
        for (const View &view : comparison_views(extent_of(plane), 64)) {
            if (std::abs(view.toward.z) < 0.999)
                continue;
            MeshImage image = rasterise(plane, view);
            size_t covered = 0, expected = 0;
            for (uint32_t j = 0; j < 64; ++j)
                for (uint32_t i = 0; i < 64; ++i) {
                    Vec3d p = view.at(i, j);
                    expected += p.x > 0 && p.x < 4 && p.y > 0 && p.y < 3;
                    if (image.triangle[j * 64 + i] == NO_HIT)
                        continue;
                    ++covered;
                    assert_int_equal(image.front[j * 64 + i], two_sided || view.toward.z > 0);
                }
            assert_int_equal(covered, expected);
            assert_true(covered > 1000);
        }
    }
}

static void random_views_are_those_of_a_seed(void **)
{
    Extent extent;
    extent.radius = 1;
    Vector<View> a = comparison_views(extent, 64, 40, 5), b = comparison_views(extent, 64, 40, 5),
                 c = comparison_views(extent, 64, 40, 6);
    assert_int_equal(a.size(), 66);
    Vec3d sum;
    for (size_t i = 26; i < a.size(); ++i) {
        assert_float_equal(length(a[i].toward), 1, 1e-12);
        assert_float_equal(length(cross(a[i].right, a[i].up) - a[i].toward), 0, 1e-12);
        assert_true(length(a[i].toward - b[i].toward) == 0);
        assert_true(length(a[i].toward - c[i].toward) > 0);
        sum += a[i].toward;
    }
    assert_true(length(sum) < 15);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_are_26),
        cmocka_unit_test(random_views_are_those_of_a_seed),
        cmocka_unit_test(raster_is_tight),
        cmocka_unit_test(slits_are_seen_from_close),
        cmocka_unit_test(facing_is_told),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
