/* Charts drawn by a GPU against the same charts sampled by the CPU: layers, slivers, masses. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "bake/agreement.hpp"
#include "bake/field/chart_field.hpp"
#include "bake/shapes.hpp"
#include "host/offscreen.h"

#include <memory>

using namespace gtx;
using Asset = std::unique_ptr<gtx_asset, decltype(&gtx_close)>;

static gtx_offscreen *offscreen;

static int make_context(void **)
{
    gtx_error error;
    if (gtx_offscreen_create(&offscreen, &error))
        print_message("all skipped: %s\n", error.message);
    return 0;
}

static int end_context(void **)
{
    gtx_offscreen_destroy(offscreen);
    return 0;
}

/* The context is current on this thread from beginning to end. */
static GlContext lent_context()
{
    return {[](const char *name) { return gtx_offscreen_load(name, nullptr); }, [] {}, [] {}};
}

static Maps bake_with(const Mesh &mesh, Partition partition, Extractor *extractor)
{
    Task task(1, nullptr, nullptr, {"bake", "pack"});
    BakeOptions options;
    options.extractor = extractor;
    return bake(mesh, partition, options, task);
}

static Asset asset_of(const Maps &maps)
{
    Vector<const uint8_t *> levels;
    gtx_asset_desc desc = shapes::describe(maps, levels);
    gtx_asset *asset = nullptr;
    gtx_error error;
    if (gtx_create(&desc, &asset, &error))
        fail_msg("%s (rule %u)", error.message, error.rule);
    return Asset(asset, gtx_close);
}

static void expect_the_same(const Mesh &mesh, Partition partition, double share = 0.999)
{
    if (!offscreen)
        skip();
    Extractor extractor(lent_context());
    const Asset cpu = asset_of(bake_with(mesh, partition, nullptr));
    const Asset gpu = asset_of(bake_with(mesh, partition, &extractor));
    const agreement::Agreement found = agreement::measure(cpu.get(), gpu.get());
    if (found.least() < share || double(found.both) < 0.999 * double(found.either))
        fail_msg("of %d texels %d in both; %d heights, %d normals, %d colours differ",
                 int(found.either), int(found.both), int(found.height), int(found.normal),
                 int(found.color));
    assert_true(found.both > 100);
}

static void paint(Mesh &mesh)
{
    for (const auto &triangle : mesh.triangles)
        for (uint32_t v : triangle) {
            auto wave = [](double x) { return uint8_t(127.5 + 120 * std::sin(x)); };
            const Vec3d &p = mesh.positions[v];
            mesh.colors.push_back({wave(9 * p.x), wave(8 * p.y + 1), wave(7 * p.z + 2), 255});
        }
}

static double hills(double u, double v)
{
    return 0.1 * std::sin(9 * u) * std::cos(7 * v);
}

/* One chart that looks along z. */
static Partition one_chart(const Mesh &mesh, double resolution)
{
    Partition partition = shapes::split(mesh, shapes::all_in_one(), resolution);
    Chart &chart = partition.charts[0];
    chart.frame = shapes::frame_along(mesh, chart.triangles, {0, 0, 1});
    partition.pitch = 1 / resolution;
    return partition;
}

static void a_chart_of_many_triangles(void **)
{
    Mesh mesh = shapes::field(220, [](double u, double v) { return Vec3d(u, v, hills(u, v)); });
    paint(mesh);
    assert_true(mesh.triangle_count() > 1 << 16);
    expect_the_same(mesh, one_chart(mesh, 100));
}

static void a_chart_of_two_triangles(void **)
{
    Mesh mesh = shapes::field(1, [](double u, double v) { return Vec3d(u, v, 0.3 * u - 0.1 * v); });
    paint(mesh);
    expect_the_same(mesh, one_chart(mesh, 60));
}

static Mesh joined(Mesh mesh, const Mesh &other)
{
    for (auto triangle : other.triangles) {
        for (uint32_t &v : triangle)
            v += uint32_t(mesh.positions.size());
        mesh.triangles.push_back(triangle);
    }
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
    paint(mesh);
    return mesh;
}

/* A second height field hovers over part of the first, and is drawn before and after it; then one
 * that faces away, which hides nothing. */
static void the_topmost_of_two_layers(void **)
{
    const Mesh low = shapes::field(20, [](double u, double v) { return Vec3d(u, v, hills(u, v)); });
    auto above = [](double u, double v) {
        return Vec3d(0.3 + 0.4 * u, 0.2 + 0.5 * v, 0.3 - hills(u, v));
    };
    const Mesh high = shapes::field(10, above);
    const Mesh away = shapes::field(10, [&](double u, double v) { return above(v, u); });
    for (const Mesh &mesh : {joined(low, high), joined(high, low), joined(low, away)})
        expect_the_same(mesh, one_chart(mesh, 80));
}

/* Rows a thousandth of a texel thin between rows of several texels, on a steep slope. */
static void slivers_on_a_slope(void **)
{
    Mesh mesh = shapes::field(41, [](double u, double v) {
        double row = v * 41, pair = std::floor(row / 2);
        double y = (pair + (row - 2 * pair > 0.5 ? 0.9995 : 0)) / 20.5;
        return Vec3d(u, y, 2 * y + hills(u, y));
    });
    paint(mesh);
    expect_the_same(mesh, one_chart(mesh, 64));
}

/* Half a hundredth of a texel beside a triangle of a thousandth, its plane is far away. */
static void a_place_beside_a_sliver_is_on_its_edge(void **)
{
    baking::FlatTriangle sliver = {{{0, 0, 0}, {4, 0, 1}, {4, 0.001, 9}}, 0, true};
    const double beside[][2] = {{3, 0.005}, {3, -0.005}, {4.004, 0}, {-0.004, 0}};
    for (const auto &at : beside) {
        const Vec3d weight = baking::weights_at(sliver, at[0], at[1]);
        for (int k = 0; k < 3; ++k)
            assert_true(weight[k] >= 0 && weight[k] <= 1);
        assert_true(std::fabs(weight.x + weight.y + weight.z - 1) < 1e-12);
    }
    const Vec3d inside = baking::weights_at(sliver, 2, 0.00025);
    assert_true(length(inside - Vec3d(0.5, 0.25, 0.25)) < 1e-9);
}

/* Its relief is too fine for the pitch, so that the height field is laid and drawn twice. */
static void relief_that_wants_a_finer_pitch(void **)
{
    Mesh mesh = shapes::field(160, [](double u, double v) {
        return Vec3d(u, v, 0.06 * std::sin(100 * u) * std::sin(90 * v));
    });
    paint(mesh);
    const Partition partition = one_chart(mesh, 48);
    const gtx_patch patch = bake_with(mesh, partition, nullptr).patches[0];
    assert_true(patch.extent_x / patch.rect[2] < 0.9 * partition.pitch);
    /* How far a texel may rise goes by the triangle that it shows; on walls a GPU sees another. */
    expect_the_same(mesh, partition, 0.98);
}

/* Waves that lean over: every tenth triangle or so faces away and cannot be seen. Patches of their
 * walls meet the chart everywhere, and where one differs the other follows. */
static void a_chart_that_folds(void **)
{
    Mesh mesh = shapes::field(60, [](double u, double v) {
        double t = 20 * u + 2.9;
        return Vec3d(u + 0.07 * std::sin(t), v, 0.1 * std::cos(t) + hills(u, v));
    });
    paint(mesh);
    assert_true(mesh.area_vector(0).z < 0);
    expect_the_same(mesh, one_chart(mesh, 84), 0.998);
}

/* Junk is shown whole, though it faces away. */
static void a_chart_that_faces_away(void **)
{
    Mesh mesh = shapes::field(12, [](double u, double v) { return Vec3d(v, u, hills(u, v)); });
    paint(mesh);
    expect_the_same(mesh, one_chart(mesh, 40));
}

static void a_context_without_a_function_is_refused(void **)
{
    if (!offscreen)
        skip();
    GlContext context = lent_context();
    context.load = [](const char *name) -> GlContext::Proc {
        return std::string(name) == "glReadPixels" ? nullptr : gtx_offscreen_load(name, nullptr);
    };
    try {
        Extractor extractor(context);
        fail();
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_ERROR_GL);
        assert_string_equal(e.what(), "the context has no glReadPixels");
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_chart_of_many_triangles),
        cmocka_unit_test(a_chart_of_two_triangles),
        cmocka_unit_test(the_topmost_of_two_layers),
        cmocka_unit_test(slivers_on_a_slope),
        cmocka_unit_test(a_place_beside_a_sliver_is_on_its_edge),
        cmocka_unit_test(relief_that_wants_a_finer_pitch),
        cmocka_unit_test(a_chart_that_folds),
        cmocka_unit_test(a_chart_that_faces_away),
        cmocka_unit_test(a_context_without_a_function_is_refused),
    };
    return cmocka_run_group_tests(tests, make_context, end_context);
}
