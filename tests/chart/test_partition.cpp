/* Partitions: complete, connected, framed, without a fold. */
#include "test_partition.hpp"

static void test_shapes(void **)
{
    struct {
        const char *name;
        Mesh mesh;
    } cases[] = {{"plane", shapes::plane(40)},
                 {"sphere", shapes::sphere(24)},
                 {"bumpy", shapes::bumpy_sphere(40)},
                 {"torus", shapes::torus(40, 0.4)},
                 {"ring", shapes::torus(40, 0.02)},
                 {"cylinder", shapes::cylinder(40)},
                 {"helicoid", shapes::helicoid(60, 5)},
                 {"folded", shapes::folded_field(30, 0.01)},
                 {"flat fold", shapes::folded_field(30, 1e-5)},
                 {"cube", shapes::cube(1)},
                 {"fine cube", shapes::cube(20)},
                 {"two", shapes::both(shapes::sphere(10), shapes::torus(20, 0.3), {5, 0, 0})},
                 {"far", shapes::both(shapes::sphere(10), shapes::sphere(10), {1e7, 0, 0})}};
    for (auto &c : cases) {
        Partition p = partition(c.mesh);
        print(c.name, p);
        check(c.mesh, p);
        for (PartitionMethod method : {PartitionMethod::VSA, PartitionMethod::PGP})
            check(c.mesh, partition(c.mesh, 2, with(method)), 64);
        check(c.mesh, partition(c.mesh, 2, with(PartitionMethod::LAYERS)));
    }
}

static void test_small(void **)
{
    Mesh one;
    one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    one.triangles = {{0, 1, 2}};
    Partition p = partition(one, 2, with(PartitionMethod::PGP));
    assert_int_equal(p.charts.size(), 1);
    p = partition(one);
    check(one, p);
    assert_int_equal(p.charts.size(), 1);
    assert_true(length(p.charts[0].frame.z - Vec3d(0, 0, 1)) < 1e-6);
    assert_true(p.charts[0].frame.extent[2] < 1e-12);

    Mesh box = shapes::cube(1); /* a face is a chart */
    p = partition(box);
    check(box, p);
    assert_int_equal(p.charts.size(), 6);

    for (double scale : {1e-30, 1e-6, 1e30}) {
        Mesh ball = shapes::bumpy_sphere(10);
        for (Vec3d &v : ball.positions)
            v *= scale;
        check(ball, partition(ball));
        check(ball, partition(ball, 2, with(PartitionMethod::PGP)), 64);
    }
    Mesh needle = shapes::plane(10, 1, 1e-6);
    check(needle, partition(needle));
    check(needle, partition(needle, 2, with(PartitionMethod::PGP)), 64);
}

static void test_empty(void **)
{
    try {
        partition(Mesh());
        fail();
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_ERROR_EMPTY);
    }
}

/* What folds must be split, however few charts were asked for. */
static void test_folds_are_split(void **)
{
    const ChartOptions one = with(PartitionMethod::VSA, 1);
    for (const Mesh &mesh : {shapes::sphere(16), shapes::torus(30, 0.4), shapes::helicoid(60, 5),
                             shapes::folded_field(30, 0.02), shapes::cylinder(40),
                             shapes::bumpy_sphere(30)}) {
        Partition p = partition(mesh, 2, one);
        check(mesh, p);
        assert_int_equal(p.report.initial_charts, 1);
        assert_true(p.charts.size() > 1);
    }
    Mesh ramp = shapes::helicoid(60, 5); /* every normal faces up, and yet it folds */
    Partition p = partition(ramp, 2, one);
    assert_int_equal(p.report.initial_inverted, 0);
    assert_true(p.charts.size() >= 5);

    Mesh flat = shapes::plane(20);
    assert_int_equal(partition(flat, 2, one).charts.size(), 1);
}

static void check_single_layer(const Mesh &source, const Partition &p)
{
    const Mesh &mesh = p.charted(source);
    const double apart = 1e-4 * 6 + 1e-9;
    for (const Chart &chart : p.charts) {
        size_t noise = 0; /* as the junk rule has it: a few samples, and shallow */
        for (uint32_t t : chart.triangles) {
            Vec3d sum;
            for (int k = 0; k < 3; ++k)
                sum += mesh.position(t, k) / 3;
            Vec3d at = chart.frame.local(sum);
            bool inside = true;
            for (int a = 0; a < 2; ++a)
                inside = inside && at[a] > chart.clip_low[a] && at[a] < chart.clip_high[a];
            if (!inside)
                continue;
            size_t deep = 0;
            for (uint32_t o : chart.triangles) {
                Vec3d c[3];
                for (int k = 0; k < 3; ++k)
                    c[k] = chart.frame.local(mesh.position(o, k));
                double area = (c[1].x - c[0].x) * (c[2].y - c[0].y) -
                              (c[1].y - c[0].y) * (c[2].x - c[0].x);
                double b = ((at.x - c[0].x) * (c[2].y - c[0].y) -
                            (at.y - c[0].y) * (c[2].x - c[0].x)) / area;
                double d = ((c[1].x - c[0].x) * (at.y - c[0].y) -
                            (c[1].y - c[0].y) * (at.x - c[0].x)) / area;
                double z = c[0].z + b * (c[1].z - c[0].z) + d * (c[2].z - c[0].z);
                bool meets = b >= 0 && d >= 0 && b + d <= 1;
                deep += meets && std::abs(z - at.z) > 4 * p.pitch;
                noise += meets && std::abs(z - at.z) > apart;
            }
            assert_int_equal(deep, 0);
        }
        assert_true(noise <= 4);
    }
}

/* No line along z may meet a chart twice, but for what the rules call one layer. */
static void test_single_layer(void **)
{
    Mesh mesh = shapes::both(shapes::helicoid(50, 4), shapes::folded_field(20, 0.03), {4, 0, 0});
    for (PartitionMethod method :
         {PartitionMethod::VSA, PartitionMethod::PGP, PartitionMethod::CUTS,
          PartitionMethod::LAYERS}) {
        /* Of a fold that is smaller than a texel or two the layers are one. */
        const unsigned charts = method == PartitionMethod::LAYERS ? 40 : 2;
        Partition p = partition(mesh, 2, with(method, charts));
        check(mesh, p);
        check_single_layer(mesh, p);
    }
}

static void test_wanted_count(void **)
{
    Mesh mesh = shapes::bumpy_sphere(40);
    for (unsigned wanted : {20u, 100u, 400u}) {
        Partition p = partition(mesh, 2, with(PartitionMethod::VSA, wanted));
        assert_int_equal(p.report.initial_charts, wanted);
        assert_in_range(p.charts.size(), wanted, wanted * 5 / 4);
        check(mesh, p, 64);
        p = partition(mesh, 2, with(PartitionMethod::CUTS, wanted));
        assert_in_range(p.charts.size(), wanted * 9 / 10, wanted + (wanted == 20 ? 10 : 0));
        check(mesh, p);
    }
    assert_int_equal(partition(mesh, 2, with(PartitionMethod::VSA)).report.initial_charts,
                     std::lround(10 * std::pow(double(mesh.triangle_count()), 0.28)));
}

/* Distant components get their charts by area; tiny ones get one and take nobody's. */
static void test_components(void **)
{
    Mesh mesh = shapes::sphere(20);
    for (int i = 0; i < 50; ++i) {
        Mesh island = shapes::sphere(1);
        for (Vec3d &v : island.positions)
            v *= 0.003;
        mesh = shapes::both(mesh, island, {2, 0.1 * i, 0});
    }
    Partition p = partition(mesh, 2, with(PartitionMethod::VSA, 60));
    check(mesh, p, 64);
    size_t large = 0;
    for (const Chart &c : p.charts)
        large += c.triangles.front() < shapes::sphere(20).triangle_count();
    assert_in_range(large, 55, 75);
}

static void assert_same(const Partition &a, const Partition &b)
{
    assert_true(a.pitch == b.pitch);
    assert_true(a.initial_chart == b.initial_chart);
    assert_true(a.junk == b.junk);
    assert_int_equal(a.charts.size(), b.charts.size());
    for (size_t i = 0; i < a.charts.size(); ++i) {
        const Frame &f = a.charts[i].frame, &g = b.charts[i].frame;
        assert_true(a.charts[i].triangles == b.charts[i].triangles);
        assert_true(f.origin == g.origin && f.x == g.x && f.y == g.y && f.z == g.z);
        assert_memory_equal(f.extent, g.extent, sizeof f.extent);
    }
}

static void test_deterministic(void **)
{
    Mesh mesh = shapes::both(shapes::bumpy_sphere(30), shapes::helicoid(40, 3), {4, 0, 0});
    assert_same(partition(mesh, 1), partition(mesh, 3));
    const ChartOptions pgp = with(PartitionMethod::PGP, 40);
    assert_same(partition(mesh, 1, pgp), partition(mesh, 3, pgp));
}

static int cancel(const gtx_progress *, void *)
{
    return 1;
}

static void test_cancel(void **)
{
    Mesh mesh = shapes::sphere(10); /* before the task, which taking memory would ask */
    Task task(2, cancel, nullptr, {"partition", "frame"});
    try {
        make_partition(mesh, {}, task);
        fail();
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_CANCELLED);
    }
}

static void test_models(void **)
{
    const char *models = std::getenv("GEOTEX_MODELS");
    if (!models)
        skip();
    struct {
        const char *name, *file;
        unsigned charts;
        PartitionMethod method = PartitionMethod::CUTS;
    } cases[] = {{"bunny", "scans/bunny.ply", 222},
                 {"squares", "scans/bunny.ply", 222, PartitionMethod::PGP},
                 {"armadillo", "scans/armadillo_86k.obj.gz", 0},
                 {"horse", "scans/horse.ply.gz", 0},
                 {"nefertiti", "scans/nefertiti.obj.gz", 0},
                 {"gargo", "scans/gargo_3dhop.ply.gz", 0},
                 {"dragon", "scans/dragon_vrip_res2.ply.gz", 453}};
    for (auto &c : cases) {
        Task task(1, nullptr, nullptr, {"read", "partition", "frame"});
        task.begin("read");
        CleanReport report;
        Mesh mesh = clean_mesh(import_mesh(std::string(models) + "/" + c.file, task), task, report);
        Partition p = make_partition(mesh, with(c.method, c.charts), task);
        task.end();
        print(c.name, p);
        print_message("           %.2f s\n", task.seconds()[1] + task.seconds()[2]);
        check(mesh, p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes), cmocka_unit_test(test_small), cmocka_unit_test(test_empty),
        cmocka_unit_test(test_folds_are_split), cmocka_unit_test(test_single_layer),
        cmocka_unit_test(test_wanted_count), cmocka_unit_test(test_components),
        cmocka_unit_test(test_deterministic), cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_models),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
