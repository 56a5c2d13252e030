/* Holes, leaks, silhouettes and shading where the answer is known. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "asset/asset.h"
#include "common/fixture.h"
#include "measure/measure.hpp"
#include "measure/view.hpp"
#include "meshes.hpp"

#include <cstring>

using namespace gtx;

static CompareReport measure(const gtx_asset *asset, const Mesh &mesh, CompareOptions options,
                             unsigned threads = 2)
{
    Task task(threads, nullptr, nullptr);
    return compare(asset, mesh, options, task);
}

static CompareOptions views_of(uint32_t size, uint32_t levels = 1,
                               Vector<HoleSample> *holes = nullptr)
{
    CompareOptions options;
    options.size = size;
    options.levels = levels;
    options.surface = false;
    options.holes = holes;
    return options;
}

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
        const Vector<std::array<uint32_t, 2>> pixels = {{15, 16}, {16, 9}, {9, 16}};
        const Vector<MeshImage> close = rasterise_close(mesh, view, pixels);
        assert_int_equal(close.size(), 3);
        for (size_t k = 0; k < 3; ++k) {
            const size_t centre = CLOSER * CLOSE_SIDE + CLOSER;
            const size_t pixel = pixels[k][1] * 32 + pixels[k][0];
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

static void a_good_sphere_has_no_fault(void **)
{
    gtx_asset *asset = fixture_sphere(2, 96, 16);
    Mesh mesh = sphere_mesh(2, 100);
    CompareReport r = measure(asset, mesh, views_of(192));
    print_message("# iou %.5f min %.5f, depth rms %.2e max %.2e, normal %.3f deg, psnr %.1f\n",
                  r.silhouette_iou, r.silhouette_iou_min, r.depth_rms, r.depth_max,
                  r.normal_mean_deg, r.psnr_db);
    assert_int_equal(r.views, 26);
    assert_true(r.surface_pixels > 26 * 24000);
    assert_int_equal(r.hole_pixels, 0);
    assert_int_equal(r.leak_pixels, 0);
    assert_true(r.silhouette_iou > 0.997 && r.silhouette_iou_min > 0.995);
    assert_true(r.silhouette_iou_min <= r.silhouette_iou);
    assert_true(r.depth_rms < 3e-4 && r.depth_p99 < 1e-3);
    assert_true(r.normal_mean_deg < 0.5 && r.normal_p99_deg < 1);
    assert_true(r.psnr_db > 35);
    gtx_close(asset);
}

static void a_missing_patch_is_a_hole(void **)
{
    gtx_asset *asset = fixture_sphere_without(2, 64, 8, 1 << 4); /* +z */
    Mesh mesh = sphere_mesh(2, 60);
    Vector<HoleSample> holes;
    CompareReport r = measure(asset, mesh, views_of(128, 1, &holes));
    uint64_t listed = r.hole_pixels;
    for (const DetailReport &detail : r.details)
        listed += detail.hole_pixels;
    assert_int_equal(holes.size(), listed);
    assert_true(r.hole_pixels > r.surface_pixels / 8 && r.hole_pixels < r.surface_pixels / 4);
    assert_true(r.leak_pixels > 1000);
    assert_true(r.silhouette_iou < 0.95);
    for (const HoleSample &hole : holes) {
        if (hole.level == CHOSEN_LEVELS)
            continue;
        assert_float_equal(length(hole.position), 2, 0.01);
        assert_true(hole.position.z > 2 / std::sqrt(3.) - 0.2);
        assert_true(hole.patch == NO_HIT || hole.depth > 0.02);
    }
    gtx_close(asset);
}

static void levels_are_measured(void **)
{
    gtx_asset *asset = fixture_sphere(2, 96, 8);
    CompareReport r = measure(asset, sphere_mesh(2, 60), views_of(96, 4));
    assert_int_equal(r.levels.size(), 4);
    for (uint32_t k = 0; k < 4; ++k) {
        print_message("# level %u: %d holes, %d leaks, iou %.4f\n", k, int(r.levels[k].hole_pixels),
                      int(r.levels[k].leak_pixels), r.levels[k].silhouette_iou);
        assert_int_equal(r.levels[k].level, k);
        assert_true(r.levels[k].silhouette_iou > 0.95);
    }
    assert_int_equal(r.levels[0].hole_pixels, r.hole_pixels);
    assert_int_equal(r.hole_pixels, 0);
    assert_true(r.levels[0].silhouette_iou == r.silhouette_iou);
    gtx_close(asset);
}

/* An open height field is seen from behind when mesh and patch are two-sided; otherwise its back is
 * no surface, and the asset shows nothing there. */
static void two_sided_fields(void **)
{
    Mesh plane = plane_mesh(3.875, 2.875, 0.5, 4);
    plane.flags.assign(plane.triangle_count(), TRIANGLE_TWO_SIDED);
    gtx_asset *asset = fixture_flat(0.5, 8);
    CompareReport one = measure(asset, plane, views_of(64));
    assert_true(one.hole_pixels > one.surface_pixels / 3);
    asset->patches[0].flags |= GTX_PATCH_TWO_SIDED;
    CompareReport both = measure(asset, plane, views_of(64));
    assert_int_equal(both.surface_pixels, one.surface_pixels);
    assert_int_equal(both.hole_pixels, 0);
    assert_int_equal(both.leak_pixels, 0);
    assert_true(both.silhouette_iou > 0.99);
    assert_true(both.normal_mean_deg < 0.5);
    gtx_close(asset);
}

static void threads_change_nothing(void **)
{
    gtx_asset *asset = fixture_sphere_without(2, 48, 8, 1);
    Mesh mesh = sphere_mesh(2, 30);
    CompareOptions options = views_of(64, 2);
    options.surface = true;
    CompareReport a = measure(asset, mesh, options, 1), b = measure(asset, mesh, options, 5);
    assert_true(a.surface_pixels == b.surface_pixels && a.hole_pixels == b.hole_pixels);
    assert_true(a.silhouette_iou == b.silhouette_iou && a.psnr_db == b.psnr_db);
    assert_true(a.depth_rms == b.depth_rms && a.normal_p99_deg == b.normal_p99_deg);
    assert_true(a.levels[1].leak_pixels == b.levels[1].leak_pixels);
    assert_true(a.error.forward.rms == b.error.forward.rms);
    assert_true(a.error.reverse.max == b.error.reverse.max);
    gtx_close(asset);
}

static void far_from_the_origin(void **)
{
    gtx_asset *asset = fixture_sphere(2, 64, 8);
    const Vec3d centre(1.2e7, -3e6, 8e6);
    for (int k = 0; k < 3; ++k)
        asset->info.anchor[k] = centre[k];
    CompareOptions options = views_of(128);
    options.surface = true;
    CompareReport r = measure(asset, sphere_mesh(2, 60, centre), options);
    assert_int_equal(r.hole_pixels, 0);
    assert_true(r.silhouette_iou > 0.99);
    assert_true(r.error.forward.rms < 1e-3 && r.error.reverse.rms < 1e-3);
    gtx_close(asset);
}

static int cancel(const gtx_progress *progress, void *)
{
    return progress->fraction > 0.2f;
}

static void can_be_cancelled_and_refuses_nothing_to_measure(void **)
{
    gtx_asset *asset = fixture_flat(0.5, 8);
    Task task(2, cancel, nullptr), other(1, nullptr, nullptr);
    Mesh mesh = sphere_mesh(2, 10), nothing;
    gtx_result result = GTX_OK;
    try {
        compare(asset, mesh, views_of(32), task);
    } catch (const Error &e) {
        result = e.result;
    }
    assert_int_equal(result, GTX_CANCELLED);
    try {
        compare(asset, nothing, views_of(32), other);
    } catch (const Error &e) {
        result = e.result;
    }
    assert_int_equal(result, GTX_ERROR_EMPTY);
    gtx_close(asset);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_are_26),
        cmocka_unit_test(raster_is_tight),
        cmocka_unit_test(slits_are_seen_from_close),
        cmocka_unit_test(facing_is_told),
        cmocka_unit_test(a_good_sphere_has_no_fault),
        cmocka_unit_test(a_missing_patch_is_a_hole),
        cmocka_unit_test(levels_are_measured),
        cmocka_unit_test(two_sided_fields),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(far_from_the_origin),
        cmocka_unit_test(can_be_cancelled_and_refuses_nothing_to_measure),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
