/* Corner normals of cleaned meshes: the source's where they serve, derived where they do not. */
#include "test_clean.hpp"

static double degrees(const Vec3f &a, const Vec3d &b)
{
    double cosine = dot(normalize(Vec3d(a)), normalize(b));
    return std::acos(std::min(1., std::max(-1., cosine))) * 360 / TURN;
}

/* A unit sphere's normals, not of unit length. */
static Mesh sphere_with_normals()
{
    Mesh mesh = sphere();
    for (const auto &t : mesh.triangles)
        for (uint32_t v : t)
            mesh.normals.push_back(Vec3f(mesh.positions[v]) * 7.f);
    return mesh;
}

static void expect_outward(const Mesh &mesh, double tolerance)
{
    for (size_t c = 0; c < mesh.normals.size(); ++c)
        assert_true(degrees(mesh.normals[c], mesh.position(c / 3, int(c % 3))) <= tolerance);
}

static size_t warnings_about_normals(const Cleaned &c)
{
    size_t count = 0;
    for (const std::string &warning : c.warnings)
        count += warning.find("normal") != std::string::npos;
    return count;
}

static void test_smooth(void **)
{
    Cleaned c = clean(sphere(32));
    expect_outward(c.mesh, 1.5);
    assert_int_equal(warnings_about_normals(c), 0);
}

static void test_sharp(void **)
{
    Cleaned c = clean(cube());
    for (size_t corner = 0; corner < c.mesh.normals.size(); ++corner)
        assert_true(degrees(c.mesh.normals[corner], c.mesh.area_vector(corner / 3)) < 0.01);
}

/* A side counts by its angle, however many triangles it was cut into. */
static void test_weights(void **)
{
    Mesh roof; /* two slopes alike, one in many triangles, one in few */
    roof.positions = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {2, 1, -0.5}, {-2, 0, -0.5},
                      {-2, 0.7, -0.5}, {-2, 1.1, -0.5}, {-2, 1.5, -0.5}, {-2, 2, -0.5}};
    roof.triangles = {{0, 3, 1}, {1, 3, 2}, {1, 4, 0}, {1, 5, 4}, {1, 6, 5}, {1, 7, 6},
                      {1, 8, 7}, {2, 8, 1}};
    Cleaned c = clean(roof);
    size_t seen = 0;
    for (size_t corner = 0; corner < c.mesh.normals.size(); ++corner)
        if (c.mesh.position(corner / 3, int(corner % 3)) == Vec3d(0, 1, 0)) {
            assert_true(degrees(c.mesh.normals[corner], Vec3d(0, 0, 1)) < 1e-3);
            ++seen;
        }
    assert_int_equal(seen, 8);
}

static void test_source_kept(void **)
{
    Cleaned c = clean(sphere_with_normals());
    expect_outward(c.mesh, 0.001);
    assert_int_equal(warnings_about_normals(c), 0);
}

static void test_source_unusable(void **)
{
    const Vec3f bad[] = {{0, 0, 0}, {NAN, 0, 1}, {INFINITY, 0, 0}, {-1, -1, -1},
                         {1e38f, 1e38f, 1e38f}};
    for (const Vec3f &normal : bad) {
        Mesh mesh = sphere_with_normals();
        for (size_t c = 0; c < mesh.normals.size(); c += 3)
            mesh.normals[c] = normal;
        Cleaned c = clean(mesh);
        assert_int_equal(warnings_about_normals(c), 1);
        if (std::isfinite(normal.x) && normal.x > 0)
            continue; /* a long normal is as good as a short one where it does not face away */
        for (size_t corner = 0; corner < c.mesh.normals.size(); ++corner)
            assert_true(degrees(c.mesh.normals[corner], c.mesh.area_vector(corner / 3)) < 90);
    }
    Mesh mesh = sphere_with_normals();
    for (Vec3f &n : mesh.normals)
        n = Vec3f();
    expect_outward(clean(mesh).mesh, 4);
}

/* Inside out with its normals, and inside out despite its normals: they come out right. */
static void test_turned(void **)
{
    Mesh mesh = turned(sphere_with_normals());
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        std::swap(mesh.normals[3 * t + 1], mesh.normals[3 * t + 2]);
    Cleaned despite = clean(mesh);
    assert_int_equal(despite.report.flipped, despite.mesh.triangle_count());
    expect_outward(despite.mesh, 0.001);
    assert_int_equal(warnings_about_normals(despite), 0);
    for (Vec3f &n : mesh.normals)
        n = -n;
    expect_outward(clean(mesh).mesh, 0.001);
}

/* One vertex of 5,000 triangles: normals as good, in a time that is not their number squared. */
static void test_large_fan(void **)
{
    Mesh cone;
    const uint32_t n = 5000;
    for (uint32_t i = 0; i < n; ++i)
        cone.positions.push_back(Vec3d(std::cos(i * TURN / n), std::sin(i * TURN / n), 0));
    cone.positions.push_back(Vec3d(0, 0, 0.25));
    cone.positions.push_back(Vec3d(0, 0, -0.25));
    for (uint32_t i = 0; i < n; ++i) {
        cone.triangles.push_back({i, (i + 1) % n, n});
        cone.triangles.push_back({(i + 1) % n, i, n + 1});
    }
    Cleaned c = clean(cone);
    assert_true(c.report.closed);
    for (size_t corner = 0; corner < c.mesh.normals.size(); ++corner)
        assert_true(degrees(c.mesh.normals[corner], c.mesh.area_vector(corner / 3)) < 31);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_smooth),      cmocka_unit_test(test_sharp),
        cmocka_unit_test(test_weights),     cmocka_unit_test(test_source_kept),
        cmocka_unit_test(test_source_unusable), cmocka_unit_test(test_turned),
        cmocka_unit_test(test_large_fan),
    };
    return cmocka_run_group_tests_name("clean normals", tests, nullptr, nullptr);
}
