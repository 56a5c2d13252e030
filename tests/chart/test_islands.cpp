/* What is small, upright, two-sided or turned over in a chart. */
#include "test_partition.hpp"

/* Small islands that touch a chart beside it join it; those that hang over it do not. */
static void test_attached(void **)
{
    Mesh mesh = shapes::plane(30);
    const ChartOptions vsa = with(PartitionMethod::VSA);
    size_t alone = partition(mesh, 2, vsa).charts.size();
    auto add = [&mesh](size_t vertex, const Vec3d &b, const Vec3d &c) {
        auto v = uint32_t(mesh.positions.size());
        Vec3d a = mesh.positions[vertex];
        mesh.positions.insert(mesh.positions.end(), {a, a + b, a + c});
        mesh.triangles.push_back({v, v + 1, v + 2});
    };
    for (size_t row = 5; row < 25; ++row)
        add(31 * row, {-0.002, 0.002, 0}, {-0.002, -0.002, 0});
    Partition p = partition(mesh, 2, vsa);
    check(mesh, p, 64);
    assert_in_range(p.charts.size(), alone - 3, alone + 3);
    for (size_t row = 5; row < 25; ++row)
        add(31 * row + 15, {0.006, 0, 0.006}, {0, 0.006, 0.006});
    p = partition(mesh, 2, vsa);
    check(mesh, p, 64);
    assert_in_range(p.charts.size(), alone + 17, alone + 23);
    assert_int_equal(p.report.junk_triangles, 0);
}

/* No chart of a model of few, large triangles has one that stands upright, whoever it was given to
 * and however few charts face it. */
static void test_walls(void **)
{
    for (uint32_t seed = 0; seed < 40; ++seed) {
        uint32_t random = seed;
        Mesh mesh = shapes::sphere(5);
        for (Vec3d &v : mesh.positions) {
            random = random * 1664525 + 1013904223;
            const double radii[] = {0.5, 0.7, 1, 1, 1.3, 1.8};
            v *= radii[(random >> 16) % 6];
        }
        const Partition p = partition(mesh, 2, with(PartitionMethod::CUTS));
        for (const Chart &chart : p.charts)
            for (uint32_t t : chart.triangles) {
                const Vec3d area = mesh.area_vector(t) / 2;
                if (!p.junk[t] && length(area) > 16 * p.pitch * p.pitch)
                    assert_true(dot(normalize(area), chart.frame.z) > 0.1);
            }
    }
}

static void test_two_sided(void **)
{
    Mesh mesh = shapes::both(shapes::sphere(8), shapes::plane(10), {3, 0, 0});
    mesh.flags.assign(mesh.triangle_count(), 0);
    size_t first = shapes::sphere(8).triangle_count();
    std::fill(mesh.flags.begin() + ptrdiff_t(first), mesh.flags.end(), TRIANGLE_TWO_SIDED);
    for (const Chart &c : partition(mesh).charts)
        assert_int_equal(c.two_sided, c.triangles.front() >= first);
}

/* Scanner noise: a few triangles turned over within a good surface drive no split. */
static void test_junk(void **)
{
    Mesh mesh = shapes::plane(60);
    size_t before = partition(mesh).charts.size();
    mesh.positions[61 * 30 + 30] = mesh.positions[61 * 30 + 31] + Vec3d(0.0005, 0.0003, 0.0002);
    Partition p = partition(mesh);
    check(mesh, p);
    print("noisy", p);
    assert_true(p.report.junk_triangles > 0);
    assert_true(p.report.junk_area_fraction < 1e-3);
    assert_true(p.charts.size() <= before + 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_attached), cmocka_unit_test(test_walls),
        cmocka_unit_test(test_two_sided), cmocka_unit_test(test_junk),
    };
    return cmocka_run_group_tests_name("islands", tests, nullptr, nullptr);
}
