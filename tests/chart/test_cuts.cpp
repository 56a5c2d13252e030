/* Charts that are cut: how fine their texels are, and where cuts go. */
#include "test_partition.hpp"

/* Texels are no finer than the wanted number of full rectangles would have them, or than small
 * charts need. */
static void test_density(void **)
{
    ChartOptions options = with(PartitionMethod::VSA);
    options.resolution = 256;
    Partition p = partition(shapes::bumpy_sphere(30), 2, options);
    double longest = 0;
    for (const Chart &c : p.charts)
        longest = std::max({longest, c.frame.extent[0], c.frame.extent[1]});
    assert_true(std::abs(longest / p.pitch - 248) < 1e-6);

    Mesh mesh;
    for (int i = 0; i < 300; ++i)
        mesh = shapes::both(mesh, shapes::cube(1), {4. * i, 0, 0});
    p = partition(mesh, 2, with(PartitionMethod::VSA));
    assert_in_range(p.charts.size(), 1800, 2800);
    assert_true(texels(p) < 1.2 * 120 * 120 * 10 * std::pow(3600., 0.28));
    p = partition(mesh);
    assert_int_equal(p.charts.size(), 1800); /* a face each */
    assert_true(texels(p) > 0.99 * 100 * 1800);
    assert_true(texels(p) < 1.5 * 100 * 1800);

    mesh = shapes::sphere(8); /* a sliver: its rectangles are all rim */
    for (Vec3d &v : mesh.positions)
        v = {1e6 * v.x, v.y, 1e-6 * v.z};
    assert_true(partition(mesh).charts.size() < 10 * 10 * std::pow(mesh.triangle_count(), 0.28));

    double pitch = partition(shapes::bumpy_sphere(30)).pitch;
    options = {};
    options.resolution = 256;
    assert_true(std::abs(partition(shapes::bumpy_sphere(30), 2, options).pitch - pitch / 2) <
                1e-9 * pitch);
}

/* The side of a texel along an axis of a chart. */
static double texel(const Chart &chart, int axis)
{
    return chart.frame.extent[axis] / chart.cells[axis];
}

/* Texels go where the surface bends, and along the axis along which it does; as many in all. */
static void test_spread(void **)
{
    auto square = [](double height, double k, double l) {
        return shapes::field(200, 200, [=](double u, double v) {
            return Vec3d(u, v, height * std::cos(k * u) * std::cos(l * v));
        });
    };
    Mesh mesh = shapes::both(square(0, 0, 0), square(0.005, 150, 75), {2, 0, 0});
    ChartOptions options;
    options.pitch = 1 / 50.;
    Partition p = partition(mesh, 2, options);
    check(mesh, p);
    assert_int_equal(p.charts.size(), 2);
    const bool first = p.charts[0].frame.origin.x < 1.5;
    const Chart &flat = p.charts[!first], &rough = p.charts[first];
    const double texels[] = {double(flat.cells[0]) * flat.cells[1],
                             double(rough.cells[0]) * rough.cells[1]};
    print_message("texels of a flat square: %.0f, of a rough one: %.0f\n", texels[0], texels[1]);
    assert_true(texels[1] > 2 * texels[0]);
    assert_in_range(texels[0] + texels[1], 0.95 * 2 * 50 * 50, 1.05 * 2 * 50 * 50);

    p = partition(square(0.005, 150, 0), 2, options); /* it bends along x alone */
    assert_int_equal(p.charts.size(), 1);
    const Chart &c = p.charts[0];
    const int along = std::abs(c.frame.x.x) > std::abs(c.frame.y.x) ? 0 : 1;
    assert_true(texel(c, !along) > 1.2 * texel(c, along));
}

/* Where texels are finer, empty ones cost more: cuts go there. */
static void test_cuts_by_relief(void **)
{
    auto wedge = [](double height) {
        return shapes::field(200, 200, [=](double u, double v) {
            return Vec3d(u, u * v, height * std::cos(150 * u) * std::cos(150 * u * v));
        });
    };
    ChartOptions options;
    options.pitch = 1 / 100.;
    options.charts = 12;
    Partition p = partition(shapes::both(wedge(0), wedge(0.005), {2, 0, 0}), 2, options);
    size_t rough = 0;
    for (const Chart &chart : p.charts)
        rough += chart.frame.origin.x > 1.5;
    print_message("patches of a flat wedge: %zu, of a rough one: %zu\n", p.charts.size() - rough,
                  rough);
    assert_true(p.charts.size() <= 12);
    assert_true(rough > p.charts.size() - rough);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_density), cmocka_unit_test(test_spread),
        cmocka_unit_test(test_cuts_by_relief),
    };
    return cmocka_run_group_tests_name("cuts", tests, nullptr, nullptr);
}
