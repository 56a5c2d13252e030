/* Sources with materials: what is cut away is no surface, and colours are those of textures. */
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

using namespace gtx;

/* The plane of fixture_flat under a texture of two columns: left red, right green. */
static Mesh painted_plane(double cutoff, uint8_t right_alpha)
{
    Mesh mesh = plane_mesh(3.875, 2.875, 0.5, 4);
    mesh.flags.assign(mesh.triangle_count(), TRIANGLE_TWO_SIDED);
    Appearance &look = mesh.appearance;
    look.images.resize(1);
    look.images[0].levels.push_back({2, 1, {{255, 0, 0, 255}, {0, 255, 0, right_alpha}}});
    look.images[0].levels.push_back({1, 1, {{188, 188, 0, 255}}});
    look.materials.resize(1);
    look.materials[0].alpha_cutoff = float(cutoff);
    look.materials[0].color_map.image = 0;
    look.materials[0].color_map.wrap[0] = look.materials[0].color_map.wrap[1] = Wrap::CLAMP;
    look.material.assign(mesh.triangle_count(), 0);
    for (const auto &triangle : mesh.triangles)
        for (uint32_t v : triangle)
            look.uv[0].push_back({float(mesh.positions[v].x / 3.875), 0.5f});
    return mesh;
}

static const View &front_of(const Vector<View> &views)
{
    for (const View &view : views)
        if (view.toward.z > 0.999)
            return view;
    return views[0];
}

static void colours_are_those_of_the_texture(void **)
{
    Mesh mesh = painted_plane(-1, 255);
    Vector<View> views = comparison_views(extent_of(mesh), 64);
    const View &view = front_of(views);
    MeshImage image = rasterise(mesh, view);
    size_t covered = 0;
    for (uint32_t j = 0; j < 64; ++j)
        for (uint32_t i = 0; i < 64; ++i) {
            if (image.triangle[j * 64 + i] == NO_HIT)
                continue;
            ++covered;
            Fragment f = fragment_at(mesh, view, image, i, j);
            assert_float_equal(f.normal.z, 1, 1e-6);
            double u = view.at(i, j).x / 3.875; /* blended from one texel's middle to the other's */
            double green = std::clamp(2 * u - 0.5, 0., 1.);
            double code = f.color[1] / 255; /* back to light */
            double light = code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
            assert_float_equal(light, green, 1e-3);
            assert_float_equal(f.color[2], 0, 1e-9);
        }
    assert_true(covered > 1000);
}

/* The right half is cut away: alpha falls below one half in the middle. */
static void what_is_cut_away_is_no_surface(void **)
{
    Mesh mesh = painted_plane(0.5, 0);
    Vector<View> views = comparison_views(extent_of(mesh), 64);
    const View &view = front_of(views);
    MeshImage image = rasterise(mesh, view);
    for (uint32_t j = 0; j < 64; ++j)
        for (uint32_t i = 0; i < 64; ++i) {
            Vec3d p = view.at(i, j);
            bool there = p.x > 0 && p.x < 3.875 / 2 && p.y > 0 && p.y < 2.875;
            assert_int_equal(image.triangle[j * 64 + i] != NO_HIT, there);
        }

    /* An asset that shows all of the plane: twice the area, and no hole. */
    gtx_asset *asset = fixture_flat(0.5, 8);
    asset->patches[0].flags |= GTX_PATCH_TWO_SIDED;
    Task task(2, nullptr, nullptr);
    CompareOptions options;
    options.size = 64;
    options.surface = false;
    CompareReport report = compare(asset, mesh, options, task);
    assert_float_equal(report.silhouette_iou, 0.5, 0.03);
    gtx_close(asset);
}

static void empty_right_half(const gtx_patch *, double x, double, const void *, fixture_texel *out)
{
    out->height = 0.5;
    out->trim = x - 7.5;
}

/* Forward points are of what is there alone: none is far from an asset of just that half. */
static void what_is_cut_away_is_not_missed(void **)
{
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 16, 16, 1, 1), empty_right_half, nullptr};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 1);
    Mesh mesh = painted_plane(0.5, 0);
    for (Vec3d &p : mesh.positions)
        p = {p.x / 3.875 * 15, p.y / 2.875 * 15, 0.5};
    Task task(2, nullptr, nullptr);
    assert_float_equal(surface_error({asset}, mesh, {}, task).forward.max, 0, 1e-7);
    mesh.appearance.materials[0].alpha_cutoff = -1;
    double farthest = (15 - 7.8) / std::hypot(15, 15);
    assert_float_equal(surface_error({asset}, mesh, {}, task).forward.max, farthest, 1e-3);
    gtx_close(asset);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_are_those_of_the_texture),
        cmocka_unit_test(what_is_cut_away_is_no_surface),
        cmocka_unit_test(what_is_cut_away_is_not_missed),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
