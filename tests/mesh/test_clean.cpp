/* Cleaning: whatever comes in, the promises of a cleaned mesh hold and nothing good is lost. */
#include "test_clean.hpp"

static void expect_empty(const Mesh &mesh)
{
    Task task(1, nullptr, nullptr);
    CleanReport report;
    try {
        clean_mesh(mesh, task, report);
        fail_msg("an empty mesh was accepted");
    } catch (const gtx::Error &error) {
        assert_int_equal(error.result, GTX_ERROR_EMPTY);
    }
}

static void test_nothing(void **)
{
    expect_empty(Mesh());
    Mesh points;
    points.positions.resize(10);
    expect_empty(points);
    expect_empty(moved(sphere(), {0, 0, 0}, {1, 2, 3}));
    expect_empty(moved(sphere(), {1, 0, 0}, {0, 0, 0}));
    expect_empty(moved(sphere(), {NAN, 1, 1}, {0, 0, 0}));
    expect_empty(moved(sphere(), {1e200, 1e200, 1e200}, {0, 0, 0}));
    expect_empty(moved(sphere(), {1e-200, 1e-200, 1e-200}, {0, 0, 0}));
}

static void test_one_triangle(void **)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    Cleaned c = clean(mesh);
    assert_int_equal(c.report.boundary_edges, 3);
    assert_int_equal(c.report.flipped, 0);
    assert_true(c.mesh.normals[0] == Vec3f(0, 0, 1));
    assert_int_equal(c.mesh.flags[0], gtx::TRIANGLE_TWO_SIDED);
}

static void test_clean_stays(void **)
{
    Mesh source = torus();
    Cleaned c = clean(source);
    assert_true(c.mesh.triangles.size() == source.triangles.size());
    for (size_t t = 0; t < source.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k)
            assert_true(c.mesh.position(t, k) == source.position(t, k));
    assert_true(c.warnings.empty() && c.report.dropped.empty());
    assert_true(c.report.closed);
    assert_int_equal(c.report.components, 1);
    for (uint8_t flags : c.mesh.flags)
        assert_int_equal(flags, 0);
}

static void test_bad_indices(void **)
{
    Mesh mesh = cube();
    mesh.triangles.push_back({0, 1, 8});
    mesh.triangles.push_back({0xffffffffu, 1, 2});
    mesh.triangles.push_back({3, 3, 5});
    Cleaned c = clean(mesh);
    assert_int_equal(c.dropped("index"), 2);
    assert_int_equal(c.dropped("degenerate"), 1);
    assert_int_equal(c.mesh.triangle_count(), 12);
    assert_int_equal(c.warnings.size(), 2);
    assert_true(c.report.closed);
}

static void test_not_finite(void **)
{
    const double bad[] = {NAN, INFINITY, -INFINITY, 1e200, std::numeric_limits<double>::max()};
    for (double x : bad) {
        Mesh mesh = torus();
        mesh.positions[7].y = x;
        Cleaned c = clean(mesh);
        assert_int_equal(c.dropped("non-finite"), 6);
        assert_int_equal(c.report.boundary_edges, 6);
    }
    Mesh unused = cube();
    unused.positions.push_back(Vec3d(NAN, NAN, NAN));
    assert_true(clean(unused).report.dropped.empty());
}

static void test_weld(void **)
{
    Mesh source = torus(), mesh = soup(source);
    Cleaned c = clean(mesh);
    assert_int_equal(c.mesh.positions.size(), source.positions.size());
    assert_true(c.mesh.position(0, 0) == source.position(0, 0));
    assert_true(c.report.closed);
    /* the first triangles name the first vertices */
    assert_int_equal(c.mesh.triangles[0][0], 0);
    assert_int_equal(c.mesh.triangles[0][1], 1);
    assert_int_equal(c.mesh.triangles[0][2], 2);

    Mesh zeros;
    zeros.positions = {{0., 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0., 0, -0.}, {1, -0., 0}, {0, -1, 0}};
    zeros.triangles = {{0, 1, 2}, {3, 5, 4}};
    assert_int_equal(clean(zeros).mesh.positions.size(), 4);
}

static void test_duplicates(void **)
{
    Mesh mesh = torus();
    size_t count = mesh.triangle_count();
    for (size_t t = 0; t < count; t += 2) {
        auto v = mesh.triangles[t];
        mesh.triangles.push_back({v[1], v[2], v[0]});
        mesh.triangles.push_back({v[1], v[0], v[2]});
    }
    Cleaned c = clean(soup(mesh));
    assert_int_equal(c.dropped("duplicate"), count);
    assert_int_equal(c.mesh.triangle_count(), count);
    assert_true(c.report.closed);
    assert_int_equal(c.report.flipped, 0);

    /* a brim without thickness continues one side of a closed surface straight on, better than the
     * other side does: the surface stays closed all the same */
    Mesh brim = torus(24, 12);
    for (uint32_t i = 0; i < 24; ++i)
        brim.positions.push_back(brim.positions[12 * i] * 2. - brim.positions[12 * i + 11]);
    for (uint32_t i = 0; i < 24; ++i) {
        uint32_t next = (i + 1) % 24, p = 12 * i, q = 12 * next, r = 288 + next, s = 288 + i;
        brim.triangles.insert(brim.triangles.end(), {{p, q, r}, {p, r, s}, {q, p, r}, {r, p, s}});
    }
    c = clean(brim);
    assert_int_equal(c.report.components, 2);
    assert_int_equal(c.report.boundary_edges, 48);
    assert_int_equal(c.mesh.flags[0], 0);
    /* a sheet of two sides alone keeps one */
    assert_int_equal(clean(moved(torus(), {1, 1, 0}, {0, 0, 0})).report.components, 1);

    /* the copy that stays winds as most do */
    Mesh copies;
    copies.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    copies.triangles = {{0, 2, 1}, {0, 1, 2}, {1, 2, 0}};
    assert_true(clean(copies).mesh.area_vector(0).z > 0);

    Mesh twice = sphere();
    append(twice, sphere());
    assert_true(clean(twice).report.closed);
}

static void test_slivers(void **)
{
    Mesh mesh = cube();
    mesh.positions.push_back(Vec3d(0.5, 0, 0));
    mesh.triangles.push_back({0, 8, 1});
    Cleaned c = clean(mesh);
    assert_int_equal(c.dropped("degenerate"), 1);
    assert_int_equal(c.mesh.positions.size(), 8);
    assert_true(c.report.closed);

    /* a sliver with a real height is not degenerate, whatever its shape */
    Mesh thin;
    thin.positions = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-12, 0}};
    thin.triangles = {{0, 1, 2}};
    clean(thin);
    /* its height is rounding when it lies far away */
    for (Vec3d &p : thin.positions)
        p += Vec3d(1e4, 1e4, 0);
    expect_empty(thin);
    /* without poles, as many triangles as a sphere keeps */
    assert_int_equal(clean(sphere(16)).dropped("degenerate"), 64);
}

static void test_scales(void **)
{
    const Vec3d scales[] = {{1e-30, 1e-30, 1e-30}, {1e30, 1e30, 1e30}, {1e-6, 1e-6, 1e-6},
                            {1e6, 1, 1e-6},        {1e38, 1e38, 1e38}};
    for (const Vec3d &scale : scales) {
        Cleaned c = clean(moved(torus(), scale, {0, 0, 0}));
        assert_true(c.report.closed && c.report.dropped.empty());
        assert_int_equal(c.report.flipped, 0);
    }
    Cleaned far = clean(moved(torus(), {0.01, 0.01, 0.01}, {1e7, -1e7, 1e7}));
    assert_true(far.report.closed && far.report.dropped.empty());

    /* the same in the precision of floats: most of it collapses, the rest is still a mesh */
    Mesh coarse = moved(sphere(), {1, 1, 1}, {1e7, 1e7, 1e7});
    for (Vec3d &p : coarse.positions)
        p = Vec3d(Vec3f(p));
    assert_true(clean(coarse).dropped("degenerate") > 0);
}

static void test_attributes_follow(void **)
{
    Mesh mesh = turned(cube());
    mesh.triangles.insert(mesh.triangles.begin(), {0, 1, 99});
    mesh.flags.assign(13, 0);
    mesh.flags[4] = gtx::TRIANGLE_TWO_SIDED;
    for (uint32_t c = 0; c < 39; ++c)
        mesh.colors.push_back({uint8_t(mesh.triangles[c / 3][c % 3]), uint8_t(c / 3), 0, 255});
    Mesh source = mesh;
    Cleaned c = clean(mesh);
    for (uint32_t corner = 0; corner < 36; ++corner) {
        gtx::Rgba8 color = c.mesh.colors[corner];
        assert_true(c.mesh.position(corner / 3, int(corner % 3)) == source.positions[color.r]);
        assert_int_equal(color.g, corner / 3 + 1);
        assert_int_equal(c.mesh.flags[corner / 3], corner / 3 == 3);
    }
    source.colors.resize(5); /* attributes that do not fit are none */
    source.normals.resize(7);
    assert_true(clean(source).mesh.colors.empty());
}

static void test_threads_agree(void **)
{
    Mesh mesh = torus(400, 100);
    Cleaned one = clean(mesh, 1), three = clean(mesh, 3);
    assert_true(one.mesh.triangles == three.mesh.triangles);
    assert_true(one.mesh.positions == three.mesh.positions);
    assert_true(one.mesh.normals == three.mesh.normals);
}

static int cancel_at(const gtx_progress *progress, void *user)
{
    return progress->fraction >= *static_cast<float *>(user);
}

static void test_cancel(void **)
{
    for (float at : {0.f, 0.25f, 0.65f, 0.9f}) {
        Task task(1, cancel_at, &at);
        CleanReport report;
        gtx_result result = GTX_OK;
        try {
            clean_mesh(torus(), task, report);
        } catch (const gtx::Error &error) {
            result = error.result;
        }
        assert_int_equal(result, GTX_CANCELLED);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nothing), cmocka_unit_test(test_one_triangle),
        cmocka_unit_test(test_clean_stays), cmocka_unit_test(test_bad_indices),
        cmocka_unit_test(test_not_finite), cmocka_unit_test(test_weld),
        cmocka_unit_test(test_duplicates), cmocka_unit_test(test_slivers),
        cmocka_unit_test(test_scales), cmocka_unit_test(test_attributes_follow),
        cmocka_unit_test(test_threads_agree), cmocka_unit_test(test_cancel),
    };
    return cmocka_run_group_tests_name("clean", tests, nullptr, nullptr);
}
