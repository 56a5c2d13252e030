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
#include "measure/distribution.hpp"
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
                               Vector<PixelFault> *faults = nullptr)
{
    CompareOptions options;
    options.size = size;
    options.levels = levels;
    options.surface = false;
    options.faults = faults;
    return options;
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
    Vector<PixelFault> holes;
    CompareReport r = measure(asset, mesh, views_of(128, 1, &holes));
    uint64_t listed = r.hole_pixels;
    for (const DetailReport &detail : r.details)
        listed += detail.hole_pixels;
    assert_int_equal(holes.size(), listed);
    assert_true(r.hole_pixels > r.surface_pixels / 8 && r.hole_pixels < r.surface_pixels / 4);
    assert_true(r.leak_pixels > 1000);
    assert_true(r.silhouette_iou < 0.95);
    for (const PixelFault &hole : holes) {
        if (hole.level == CHOSEN_LEVELS)
            continue;
        assert_float_equal(length(hole.position), 2, 0.01);
        assert_true(hole.position.z > 2 / std::sqrt(3.) - 0.2);
        assert_true(hole.patch == NO_HIT || hole.off > 0.02);
    }
    gtx_close(asset);
}

/* A sphere's asset beside the sphere and, in the +z half, one that is smaller: the asset is a wall
 * there, over the source and over its background. */
static void what_juts_out_is_a_wall(void **)
{
    gtx_asset *asset = fixture_sphere(2, 96, 16);
    Mesh good = sphere_mesh(2, 100), small = good;
    assert_int_equal(measure(asset, good, views_of(192)).wall_pixels, 0);
    for (Vec3d &p : small.positions)
        if (p.z > 0.5)
            p.z = 0.5;
    Vector<PixelFault> faults;
    CompareReport r = measure(asset, small, views_of(192, 1, &faults));
    assert_int_equal(r.hole_pixels, 0);
    uint64_t walls = 0, alone = 0;
    for (const PixelFault &fault : faults) {
        assert_true(fault.kind == Fault::wall);
        assert_float_equal(length(fault.position), 2, 0.03);
        assert_true(fault.position.z > 0.5);
        alone += fault.triangle == NO_HIT;
        walls += fault.level == 0;
    }
    assert_int_equal(walls, r.wall_pixels);
    assert_int_equal(r.levels[0].wall_pixels, r.wall_pixels);
    assert_true(r.wall_pixels > 9 * 8000 && alone > 8 * 1000);
    gtx_close(asset);
}

/* The same sphere, whose corner normals are nearly square to the surface in its +z half; or that
 * has them inside there, as no height field can. */
static void what_faces_another_way_is_turned(void **)
{
    gtx_asset *asset = fixture_sphere(2, 96, 16);
    Mesh mesh = sphere_mesh(2, 100);
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k)
            mesh.normals.push_back(Vec3f(normalize(mesh.position(t, k))));
    assert_int_equal(measure(asset, mesh, views_of(192)).turned_pixels, 0);
    uint64_t beyond = 0;
    for (Vec3f &n : mesh.normals)
        if (n.z > 0.5f) {
            n = Vec3f(normalize(cross(Vec3d(n), Vec3d(1, 0, 0))) + Vec3d(n) * 0.05);
            ++beyond;
        }
    assert_true(beyond);
    Vector<PixelFault> faults;
    CompareReport r = measure(asset, mesh, views_of(192, 1, &faults));
    assert_int_equal(r.hole_pixels + r.wall_pixels, 0);
    assert_int_equal(faults.size(), r.turned_pixels);
    for (const PixelFault &fault : faults) {
        assert_true(fault.kind == Fault::turned);
        assert_in_range(fault.off, 85, 95);
        assert_true(fault.position.z > 0.9);
    }
    assert_true(r.turned_pixels > 9 * 4000);
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k)
            mesh.normals[3 * t + size_t(k)] = -Vec3f(normalize(mesh.position(t, k)));
    assert_int_equal(measure(asset, mesh, views_of(192)).turned_pixels, 0);
    gtx_close(asset);
}

/* A corner of a pixel's tenth more than the source is excused, one of two pixels is not. */
static void outlines_may_be_off_by_less_than_a_pixel(void **)
{
    gtx_asset *asset = fixture_flat(0.5, 8);
    for (const double pixels : {0.6, 3.}) {
        const double extent = std::hypot(3.875, 2.875) / (0.96 * 256);
        Mesh plane = plane_mesh(3.875, 2.875 - pixels * extent, 0.5, 4);
        CompareReport r = measure(asset, plane, views_of(256));
        if (pixels < 1)
            assert_int_equal(r.wall_pixels, 0);
        else
            assert_true(r.wall_pixels > 200);
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
    options.random_views = 7;
    CompareReport a = measure(asset, mesh, options, 1), b = measure(asset, mesh, options, 5);
    assert_int_equal(a.views, 33);
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

/* Every pixel of every view has a depth and an angle: lists of all would be 16 MB here. */
static void pixels_take_no_room(void **)
{
    gtx_asset *asset = fixture_sphere(2, 96, 16);
    gtx_limits limits = {};
    limits.memory = 9 << 20;
    Task task(1, nullptr, nullptr, {}, {}, limits);
    MemoryScope scope(task.limits);
    CompareReport r = compare(asset, sphere_mesh(2, 40), views_of(192), task);
    assert_true(r.surface_pixels > 26 * 24000);
    gtx_close(asset);
}

static void percentiles_of_a_distribution(void **)
{
    Distribution distribution;
    assert_true(distribution.percentile_99() == 0);
    Vector<float> values;
    for (int i = 1; i <= 1000; ++i)
        values.push_back(float(i) / 1000);
    distribution.add(values);
    assert_float_equal(distribution.percentile_99(), 0.99, 0.99 / 1024);
    assert_true(distribution.most() == 1 && distribution.count() == 1000);
    Distribution zero;
    zero.add(Vector<float>(7, 0.f));
    assert_true(zero.percentile_99() == 0 && zero.count() == 7);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_good_sphere_has_no_fault),
        cmocka_unit_test(a_missing_patch_is_a_hole),
        cmocka_unit_test(what_juts_out_is_a_wall),
        cmocka_unit_test(what_faces_another_way_is_turned),
        cmocka_unit_test(outlines_may_be_off_by_less_than_a_pixel),
        cmocka_unit_test(levels_are_measured),
        cmocka_unit_test(two_sided_fields),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(far_from_the_origin),
        cmocka_unit_test(pixels_take_no_room),
        cmocka_unit_test(percentiles_of_a_distribution),
        cmocka_unit_test(can_be_cancelled_and_refuses_nothing_to_measure),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
