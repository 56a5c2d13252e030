/* Peeling along few directions, gathering small pieces, six views, choosing a partition. */
#include "test_partition.hpp"

#include <set>

static Mesh moved(Mesh mesh, const Vec3d &by)
{
    for (Vec3d &p : mesh.positions)
        p = p + by;
    return mesh;
}

static Mesh slab(const Vec3d &x, const Vec3d &y, const Vec3d &z)
{
    Mesh mesh = shapes::cube(12);
    for (Vec3d &p : mesh.positions)
        p = x * (2 * p.x) + y * p.y + z * (0.02 * p.z);
    return mesh;
}

/* Sheets of 2 x 2 squares, side by side with room between, or each above the last. */
static Mesh sheets(unsigned count, const Vec3d &step, const Vec3d &next_row = {})
{
    Mesh mesh;
    for (unsigned i = 0; i < count; ++i)
        mesh = shapes::both(mesh, shapes::plane(2, 0.7, 0.7),
                            step * double(i % 10) + next_row * double(i / 10));
    return mesh;
}

static void assert_axes(const Partition &p, const Vector<Vec3d> &axes)
{
    for (const Chart &chart : p.charts) {
        double most = 0;
        for (const Vec3d &axis : axes)
            most = std::max(most, std::abs(dot(chart.frame.z, axis)));
        assert_true(most > 1 - 1e-6);
    }
}

static const ChartOptions layers = with(PartitionMethod::LAYERS);
static const ChartOptions few_layers = with(PartitionMethod::LAYERS, 10);
static const ChartOptions relief = with(PartitionMethod::RELIEF);

static void a_slab_is_seen_along_its_axes(void **)
{
    const Mesh straight = slab({1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    Partition p = partition(straight, 2, layers);
    check(straight, p);
    assert_axes(p, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});

    const Vec3d x = normalize(Vec3d(3, 1, 2)), z = normalize(cross(x, Vec3d(0, 1, 0)));
    const Mesh askew = slab(x, cross(z, x), z);
    p = partition(askew, 2, layers);
    check(askew, p);
    assert_axes(p, {x, cross(z, x), z});
}

static void a_ball_is_seen_along_the_axes_of_the_object(void **)
{
    const Mesh mesh = shapes::bumpy_sphere(30);
    Partition p = partition(mesh, 2, layers);
    check(mesh, p);
    assert_true(p.method == PartitionMethod::LAYERS);
    assert_axes(p, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

static void small_pieces_of_a_layer_share_a_chart(void **)
{
    const Mesh beside = sheets(100, {1, 0, 0}, {0, 1, 0});
    Partition p = partition(beside, 2, few_layers);
    assert_true(p.charts.size() <= 60);
    check(beside, p);

    const Mesh above = sheets(10, {0, 0, 1});
    p = partition(above, 2, few_layers);
    assert_int_equal(p.charts.size(), 10);
    assert_true(p.report.second_layer_fraction == 0);
}

static void threads_do_not_matter(void **)
{
    const Mesh mesh = shapes::both(sheets(50, {1, 0, 0}, {0, 1, 0.2}), shapes::helicoid(30, 3),
                                   {0, 0, 4});
    for (const ChartOptions &options : {layers, relief, with(PartitionMethod::AUTO)}) {
        const Partition a = partition(mesh, 1, options), b = partition(mesh, 3, options);
        assert_true(a.pitch == b.pitch && a.method == b.method);
        assert_int_equal(a.charts.size(), b.charts.size());
        for (size_t i = 0; i < a.charts.size(); ++i) {
            assert_true(a.charts[i].triangles == b.charts[i].triangles);
            assert_true(a.charts[i].frame.origin == b.charts[i].frame.origin);
        }
    }
}

static void little_is_a_chart(void **)
{
    Mesh one;
    one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    one.triangles = {{0, 1, 2}};
    for (const ChartOptions &options : {layers, relief, with(PartitionMethod::AUTO)}) {
        assert_int_equal(partition(one, 2, options).charts.size(), 1);
        for (double scale : {1e-30, 1e30}) {
            Mesh ball = shapes::bumpy_sphere(8);
            for (Vec3d &v : ball.positions)
                v *= scale;
            assert_true(partition(ball, 2, options).charts.size() >= 6);
        }
        try {
            partition(Mesh(), 2, options);
            fail();
        } catch (const Error &e) {
            assert_int_equal(e.result, GTX_ERROR_EMPTY);
        }
    }
}

static void six_views_show_a_ball_and_lose_what_is_in_it(void **)
{
    const Mesh ball = shapes::sphere(20);
    Partition p = partition(ball, 2, relief);
    assert_int_equal(p.charts.size(), 6);
    assert_int_equal(p.report.unseen_triangles, 0);
    assert_true(p.report.unseen_area_fraction == 0);

    Mesh inner = shapes::sphere(10);
    for (Vec3d &v : inner.positions)
        v *= 0.5;
    const Mesh nested = shapes::both(ball, inner, {});
    p = partition(nested, 2, relief);
    assert_int_equal(p.charts.size(), 6);
    assert_int_equal(p.report.unseen_triangles, inner.triangle_count());
    assert_true(std::abs(p.report.unseen_area_fraction - 0.2) < 0.01);
    std::set<uint32_t> shown;
    for (const Chart &chart : p.charts)
        for (uint32_t t : chart.triangles) {
            assert_true(t < ball.triangle_count());
            assert_true(shown.insert(t).second);
        }
    assert_int_equal(shown.size(), ball.triangle_count());
}

/* Faces inwards all around: whoever looks sees backs. */
static void what_no_view_sees_is_refused(void **)
{
    Mesh mesh = shapes::cube(3);
    for (auto &t : mesh.triangles)
        std::swap(t[0], t[1]);
    try {
        partition(mesh, 2, relief);
        fail();
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_ERROR_EMPTY);
    }
}

static void auto_takes_the_fewer_texels(void **)
{
    assert_true(partition(shapes::bumpy_sphere(30), 2, with(PartitionMethod::AUTO)).method ==
                PartitionMethod::CUTS);
    for (const Mesh &mesh : {shapes::torus(40, 0.02), slab({1, 0, 0}, {0, 1, 0}, {0, 0, 1})})
        assert_true(partition(mesh, 2, with(PartitionMethod::AUTO)).method ==
                    PartitionMethod::LAYERS);
}

static void edges_are_measured(void **)
{
    /* A cube of 2 has 24 of edge; each is told by two rows of triangles as a third of their
     * outlines. */
    const Partition cube = partition(shapes::cube(1));
    assert_true(std::abs(cube.report.area - 24) < 1e-9);
    assert_in_range(std::lround(cube.report.edge_length), 20, 60);
    assert_true(partition(shapes::sphere(20)).report.edge_length == 0);
    const Partition sheet = partition(moved(shapes::plane(10), {1, 2, 3}));
    assert_in_range(std::lround(10 * sheet.report.edge_length), 35, 60);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slab_is_seen_along_its_axes),
        cmocka_unit_test(a_ball_is_seen_along_the_axes_of_the_object),
        cmocka_unit_test(small_pieces_of_a_layer_share_a_chart),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(little_is_a_chart),
        cmocka_unit_test(six_views_show_a_ball_and_lose_what_is_in_it),
        cmocka_unit_test(what_no_view_sees_is_refused),
        cmocka_unit_test(auto_takes_the_fewer_texels),
        cmocka_unit_test(edges_are_measured),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
