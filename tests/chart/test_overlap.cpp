/* The surface around a chart: exactly what lies within reach, connected and facing. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "chart/chart.hpp"
#include "shapes.hpp"

#include <algorithm>
#include <set>

using namespace gtx;

constexpr unsigned SIDE = 20;

/* The squares [i0, i1) x [j0, j1) of a grid, as a chart seen from above. */
static Chart block(unsigned i0, unsigned i1, unsigned j0, unsigned j1)
{
    Chart chart;
    for (unsigned j = j0; j < j1; ++j)
        for (unsigned i = i0; i < i1; ++i)
            for (unsigned half = 0; half < 2; ++half)
                chart.triangles.push_back(2 * (j * SIDE + i) + half);
    std::sort(chart.triangles.begin(), chart.triangles.end());
    chart.frame.x = {1, 0, 0};
    chart.frame.y = {0, 1, 0};
    chart.frame.z = {0, 0, 1};
    chart.frame.origin = {double(i0), double(j0), 0};
    chart.frame.extent[0] = i1 - i0;
    chart.frame.extent[1] = j1 - j0;
    return chart;
}

static Mesh grid(double (*height)(double, double))
{
    return shapes::field(SIDE, SIDE, [=](double u, double v) {
        return Vec3d(SIDE * u, SIDE * v, height(SIDE * u, SIDE * v));
    });
}

static std::set<uint32_t> overlap(const Mesh &mesh, const Chart &chart, double reach)
{
    Vector<uint32_t> out = overlap_triangles(mesh, triangle_neighbours(mesh), chart, reach);
    assert_true(std::is_sorted(out.begin(), out.end()));
    std::set<uint32_t> set(out.begin(), out.end());
    assert_int_equal(set.size(), out.size());
    for (uint32_t t : out)
        assert_false(std::binary_search(chart.triangles.begin(), chart.triangles.end(), t));
    return set;
}

/* Distance of a triangle of the flat grid from a block, by dense sampling. */
static double distance(const Mesh &mesh, uint32_t t, const double low[2], const double high[2])
{
    double least = INFINITY;
    for (int i = 0; i <= 60; ++i)
        for (int j = 0; i + j <= 60; ++j) {
            Vec3d p = mesh.position(t, 0) * (i / 60.) + mesh.position(t, 1) * (j / 60.) +
                      mesh.position(t, 2) * ((60 - i - j) / 60.);
            double a = std::max({low[0] - p.x, p.x - high[0], 0.});
            double b = std::max({low[1] - p.y, p.y - high[1], 0.});
            least = std::min(least, std::hypot(a, b));
        }
    return least;
}

static void test_ring(void **)
{
    Mesh mesh = grid([](double, double) { return 0.; });
    Chart chart = block(6, 12, 7, 11);
    double low[2] = {6, 7}, high[2] = {12, 11};
    for (double reach : {0.02, 0.5, 1.1, 1.6, 2.7}) {
        std::set<uint32_t> found = overlap(mesh, chart, reach);
        for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
            if (std::binary_search(chart.triangles.begin(), chart.triangles.end(), t))
                continue;
            assert_int_equal(found.count(t), distance(mesh, t, low, high) <= reach);
        }
    }
}

static void test_open_border(void **)
{
    Mesh mesh = grid([](double, double) { return 0.; });
    assert_int_equal(overlap(mesh, block(0, SIDE, 0, SIDE), 3).size(), 0);
    for (uint32_t t : overlap(mesh, block(0, SIDE, 0, 5), 0.5))
        assert_in_range(t / 2 / SIDE, 5, 5);
}

/* Beyond a depth discontinuity lies surface within reach that no facing triangle leads to. */
static void test_discontinuity(void **)
{
    Mesh mesh = grid([](double x, double) { return x < 10.5 ? 0. : 50.; });
    std::set<uint32_t> found = overlap(mesh, block(4, 10, 4, 10), 3);
    assert_true(!found.empty());
    for (uint32_t t : found)
        assert_true(t / 2 % SIDE < 10);
}

/* Reach is measured in the frame's plane: on a slope of 60 degrees a ring is half as wide. */
static void test_slope(void **)
{
    Mesh mesh = shapes::field(SIDE, SIDE, [](double u, double v) {
        return Vec3d(SIDE * u / 2, SIDE * v, SIDE * u * 0.8660254);
    });
    Chart chart = block(8, 12, 8, 12);
    chart.frame.origin = {4, 8, 0};
    chart.frame.extent[0] = 2;
    size_t most = 0;
    for (uint32_t t : overlap(mesh, chart, 0.9))
        most = std::max<size_t>(most, t / 2 % SIDE);
    assert_int_equal(most, 13);
}

static void test_partitioned_model(void **)
{
    Mesh mesh = shapes::bumpy_sphere(40);
    Task task(2, nullptr, nullptr, {"partition", "frame"});
    ChartOptions options;
    options.method = PartitionMethod::VSA; /* whole charts: each has others all around */
    Partition p = make_partition(mesh, options, task);
    auto neighbours = triangle_neighbours(mesh);
    size_t all = 0;
    for (const Chart &chart : p.charts) {
        Vector<uint32_t> ring = overlap_triangles(mesh, neighbours, chart, 1.5 * p.pitch);
        assert_true(!ring.empty());
        for (uint32_t t : ring)
            assert_true(dot(normalize(mesh.area_vector(t)), chart.frame.z) >= 0.1);
        all += ring.size();
    }
    assert_true(all < 2 * mesh.triangle_count());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ring), cmocka_unit_test(test_open_border),
        cmocka_unit_test(test_discontinuity), cmocka_unit_test(test_slope),
        cmocka_unit_test(test_partitioned_model)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
