/* Merging charts: what is one height map together becomes one, and nothing else. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "chart/merge.hpp"
#include "shapes.hpp"

#include <algorithm>
#include <cmath>

using namespace gtx;

/* What merging leaves. */
struct Merged {
    Vector<Region> regions, loose;
    Vector<Frame> frames;
    Vector<Layers> layers;          /* of the charts as they are now */
    Vector<double> area;            /* likewise */
    Region whole;
    size_t before = 0;              /* charts */
};

/* Charts are the connected pieces of what has the same `key`, which gets centres of triangles. */
static Merged merge(const Mesh &mesh, double pitch,
                    const std::function<uint32_t(const Vec3d &)> &key, unsigned threads = 2)
{
    Task task(threads, nullptr, nullptr, {"partition"}, {1});
    const Surface surface = make_surface(mesh, pitch, task);
    Vector<uint32_t> labels;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        labels.push_back(
            key((mesh.position(t, 0) + mesh.position(t, 1) + mesh.position(t, 2)) / 3));
    const uint32_t count = connected_pieces(surface.whole, labels);
    Merged out;
    out.regions = split_region(surface.whole, labels, count);
    out.whole = surface.whole;
    out.before = count;
    for (const Region &region : out.regions)
        out.frames.push_back(
            make_frame(mesh, region.triangles, cone_axis(surface, region.triangles)));
    const Bounds bounds = {INFINITY, pitch, true};
    out.loose = merge_charts(surface, bounds, out.regions, out.frames, task);
    assert_int_equal(out.frames.size(), out.regions.size());
    for (size_t i = 0; i < out.regions.size(); ++i) {
        out.layers.push_back(find_layers(surface, out.regions[i], out.frames[i], pitch, task));
        out.area.push_back(0);
        for (uint32_t t : out.regions[i].triangles)
            out.area.back() += length(mesh.area_vector(t)) / 2;
    }
    return out;
}

/* Every triangle is in one chart, once, with the neighbours that it has there. */
static void check(const Mesh &mesh, const Merged &merged)
{
    Vector<int> seen(mesh.triangle_count());
    for (const auto *charts : {&merged.regions, &merged.loose})
        for (const Region &region : *charts) {
            assert_true(region.size() > 0 && region.neighbours.size() == region.size());
            assert_true(std::is_sorted(region.triangles.begin(), region.triangles.end()));
            for (size_t i = 0; i < region.size(); ++i) {
                ++seen[region.triangles[i]];
                for (int k = 0; k < 3; ++k) {
                    const uint32_t n = region.neighbours[i][k];
                    const uint32_t whole = merged.whole.neighbours[region.triangles[i]][k];
                    const bool has = std::binary_search(region.triangles.begin(),
                                                        region.triangles.end(), whole);
                    assert_true(has ? region.triangles[n] == whole : n == NO_TRIANGLE);
                }
            }
        }
    for (int n : seen)
        assert_int_equal(n, 1);
    for (size_t i = 0; i < merged.regions.size(); ++i) {
        assert_true(merged.layers[i].folds.empty() && merged.layers[i].discontinuities.empty());
        const FrameInverse inverse(merged.frames[i]);
        for (uint32_t t : merged.regions[i].triangles)
            for (int k = 0; k < 3; ++k) {
                const Vec3d p = inverse(mesh.position(t, k));
                for (int a = 0; a < 3; ++a)
                    assert_true(p[a] > -1e-6 && p[a] < merged.frames[i].extent[a] + 1e-6);
            }
    }
}

/* Strips of a plane, and squares of a hill. */
static void what_is_flat_becomes_one(void **)
{
    const Mesh plane = shapes::plane(32);
    Merged merged = merge(plane, 0.01, [](const Vec3d &p) { return uint32_t(8 * p.x); });
    check(plane, merged);
    assert_int_equal(merged.before, 8);
    assert_int_equal(merged.regions.size(), 1);
    const Mesh hill = shapes::field(32, 32, [](double u, double v) {
        return Vec3d(u, v, 0.3 * std::sin(3 * u) * std::sin(3 * v));
    });
    merged = merge(hill, 0.01, [](const Vec3d &p) {
        return uint32_t(4 * p.x) + 4 * uint32_t(4 * p.y);
    });
    check(hill, merged);
    assert_int_equal(merged.before, 16);
    assert_int_equal(merged.regions.size(), 1);
}

static uint32_t side_of(const Vec3d &p)
{
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        axis = std::fabs(p[k]) > std::fabs(p[axis]) ? k : axis;
    return uint32_t(2 * axis + (p[axis] < 0));
}

/* No axis sees two sides of a cube well enough. */
static void sides_of_a_cube_stay_apart(void **)
{
    const Mesh mesh = shapes::cube(16);
    const Merged merged = merge(mesh, 0.02, side_of);
    check(mesh, merged);
    assert_int_equal(merged.before, 6);
    assert_int_equal(merged.regions.size(), 6);
}

/* A ramp winds above itself: eighths of turns become charts of less than a whole one. */
static void what_folds_together_stays_apart(void **)
{
    const Mesh mesh = shapes::helicoid(64, 2.5);
    const Merged merged = merge(mesh, 0.02, [](const Vec3d &p) {
        return uint32_t(p.z / 0.3 * 8);
    });
    check(mesh, merged);
    assert_int_equal(merged.before, 20);
    assert_in_range(merged.regions.size(), 3, 6);
}

/* A chart of fewer texels than 64 is a small island, and not asked. */
static void small_islands_are_left(void **)
{
    const Mesh mesh = shapes::plane(32);
    auto border = [](const Vec3d &p) { return uint32_t(p.x > 1. / 32); };
    for (double pitch : {0.02, 0.025}) {
        const Merged merged = merge(mesh, pitch, border);
        check(mesh, merged);
        assert_int_equal(merged.before, 2);
        assert_int_equal(merged.regions.size(), pitch == 0.02 ? 1 : 2);
    }
}

/* A unit square with a block on it, whose sides stand upright. */
static Mesh square_with_block(double height)
{
    constexpr double SIDE = 2. / 32, FOOT = 3. / 32; /* from the middle, 0 to 1 */
    return shapes::field(64, 64, [=](double u, double v) {
        const Vec3d from = {2 * u - 1, 2 * v - 1, 0};
        const double r = std::max(std::fabs(from.x), std::fabs(from.y));
        if (r <= SIDE)
            return Vec3d(from.x / 2, from.y / 2, height);
        if (r <= FOOT)
            return from * (SIDE / r / 2) + Vec3d(0, 0, height * (FOOT - r) / (FOOT - SIDE));
        return from * ((SIDE + (r - FOOT) * (1 - SIDE) / (1 - FOOT)) / r / 2);
    });
}

/* Where two charts fit together but for walls, these are set apart, and what they enclose; but not
 * where that is much. */
static void walls_are_set_apart(void **)
{
    auto half = [](const Vec3d &p) { return uint32_t(p.x > 0); };
    const Mesh low = square_with_block(0.01), high = square_with_block(0.05);
    const Merged merged = merge(low, 0.012, half);
    check(low, merged);
    assert_int_equal(merged.regions.size(), 1);
    assert_true(merged.loose.size() >= 2);
    double upright = 0;
    for (uint32_t t : merged.regions[0].triangles)
        if (normalize(low.area_vector(t)).z < 0.05)
            upright += length(low.area_vector(t)) / 2;
    assert_true(upright < 4 * 0.012 * 0.012); /* at the block's corners: no texel each */
    const Merged apart = merge(high, 0.012, half);
    assert_int_equal(apart.regions.size(), 2);
    assert_int_equal(apart.loose.size(), 0);
}

static void any_thread_count_merges_the_same(void **)
{
    const Mesh mesh = shapes::bumpy_sphere(32);
    auto key = [](const Vec3d &p) {
        return uint32_t(3 * (p.x + 2)) + 100 * uint32_t(3 * (p.y + 2)) +
               10000 * uint32_t(3 * (p.z + 2));
    };
    const Merged one = merge(mesh, 0.01, key, 1), many = merge(mesh, 0.01, key, 7);
    check(mesh, one);
    assert_true(one.before > 100 && one.regions.size() < one.before / 2);
    assert_int_equal(one.regions.size(), many.regions.size());
    for (size_t i = 0; i < one.regions.size(); ++i)
        assert_true(one.regions[i].triangles == many.regions[i].triangles);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(what_is_flat_becomes_one),
        cmocka_unit_test(sides_of_a_cube_stay_apart),
        cmocka_unit_test(what_folds_together_stays_apart),
        cmocka_unit_test(small_islands_are_left),
        cmocka_unit_test(walls_are_set_apart),
        cmocka_unit_test(any_thread_count_merges_the_same),
    };
    return cmocka_run_group_tests_name("merging charts", tests, nullptr, nullptr);
}
