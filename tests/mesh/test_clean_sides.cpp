/* Cleaning: which side of a component is out, which triangles have two, what stays apart. */
#include "test_clean.hpp"

static void test_winding(void **)
{
    Mesh random = torus();
    uint32_t state = 1;
    for (size_t t = 0; t < random.triangle_count(); ++t)
        if ((state = state * 1664525u + 1013904223u) >> 31)
            turn(random, t);
    assert_true(clean(random).report.closed);
    assert_true(volume(clean(random).mesh) > 0);

    Cleaned inverted = clean(turned(sphere()));
    assert_true(volume(inverted.mesh) > 0);
    assert_int_equal(inverted.report.flipped, inverted.mesh.triangle_count());

    /* an open surface has no outside: the majority decides, wherever it begins */
    for (size_t turns : {40, 88}) {
        Mesh open = grid(8, 8, false, false, false,
                         [](double u, double v) { return Vec3d(u, v, 0); });
        for (size_t t = 0; t < turns; ++t)
            turn(open, t);
        Cleaned c = clean(open);
        assert_int_equal(c.report.flipped, 40);
        assert_true((c.mesh.area_vector(0).z > 0) == (turns == 40));
    }
}

static void test_nested(void **)
{
    auto shell = [](double radius, bool inward) {
        Mesh mesh = moved(sphere(), {radius, radius, radius}, {0.01, 0.02, 0.03});
        return inward ? turned(mesh) : mesh;
    };
    Mesh hollow = shell(2, false);
    append(hollow, shell(1, true));
    append(hollow, shell(0.5, false));
    Cleaned c = clean(hollow);
    assert_int_equal(c.report.flipped, 0);
    assert_int_equal(c.report.components, 3);

    /* the outermost is turned, the wall of its cavity is left alone */
    Mesh both = shell(2, true);
    append(both, shell(1, true));
    assert_int_equal(clean(both).report.flipped, c.mesh.triangle_count() / 3);

    /* beside each other, in one another's shadow, nothing encloses anything */
    Mesh row;
    for (int i = 0; i < 6; ++i)
        append(row, turned(moved(cube(), {1, 1, 1}, {2. * i, 0, 0})));
    assert_int_equal(clean(row).report.flipped, row.triangle_count());

    /* a ring around it is no shell around it */
    Mesh ring = torus();
    append(ring, turned(sphere()));
    c = clean(ring);
    assert_int_equal(c.report.flipped, c.mesh.triangle_count() - torus().triangle_count());
}

static void test_one_sided(void **)
{
    Mesh source = moebius();
    Cleaned c = clean(source);
    assert_int_equal(c.mesh.triangle_count(), source.triangle_count());
    assert_int_equal(c.report.components, 1);
    assert_true(c.report.boundary_edges > 80 && c.report.boundary_edges < 120);
    source = klein();
    c = clean(source);
    assert_int_equal(c.mesh.triangle_count(), source.triangle_count());
    assert_true(c.report.boundary_edges > 0 && c.report.boundary_edges < 300);
    for (uint8_t flags : c.mesh.flags)
        assert_true(flags & gtx::TRIANGLE_TWO_SIDED);
}

static Mesh open_book(uint32_t pages)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}};
    for (uint32_t i = 0; i < pages; ++i) {
        double turn = i * TURN / pages;
        mesh.positions.push_back(Vec3d(std::cos(turn), std::sin(turn), 0.5));
        if (i % 2)
            mesh.triangles.push_back({0, 1, i + 2});
        else
            mesh.triangles.push_back({1, 0, i + 2});
    }
    return mesh;
}

static void test_fans(void **)
{
    Cleaned book = clean(open_book(16));
    assert_int_equal(book.mesh.triangle_count(), 16);
    assert_int_equal(book.report.nonmanifold_edges, 1);
    assert_int_equal(book.report.components, 8);
    assert_int_equal(clean(open_book(1000)).mesh.triangle_count(), 1000);

    /* a fin on a closed surface leaves it closed: only the fin is open */
    Mesh finned = torus();
    finned.positions.push_back(Vec3d(9, 9, 9));
    uint32_t tip = uint32_t(finned.positions.size() - 1);
    finned.triangles.push_back({finned.triangles[5][0], finned.triangles[5][1], tip});
    finned.triangles.push_back({finned.triangles[50][1], finned.triangles[50][0], tip});
    Cleaned c = clean(finned);
    assert_int_equal(c.report.nonmanifold_edges, 2);
    assert_int_equal(c.report.components, 3);
    assert_int_equal(c.report.boundary_edges, 6);
    assert_int_equal(c.mesh.flags[5], 0);
}

static void test_touching(void **)
{
    /* two triangles, and two cubes, at one vertex */
    Mesh bow_tie;
    bow_tie.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    bow_tie.triangles = {{0, 1, 2}, {0, 3, 4}};
    assert_int_equal(clean(bow_tie).mesh.positions.size(), 6);
    Mesh cubes = cube();
    append(cubes, moved(cube(), {1, 1, 1}, {1, 1, 1}));
    assert_int_equal(clean(cubes).mesh.positions.size(), 16);

    /* two cubes at one edge stay two closed cubes; four around it as well */
    for (Vec3d offset : {Vec3d(1, 1, 0), Vec3d(-1, 1, 0)}) {
        Mesh edge = cube();
        append(edge, moved(cube(), {1, 1, 1}, offset));
        Cleaned c = clean(edge);
        assert_true(c.report.closed);
        assert_int_equal(c.report.nonmanifold_edges, 1);
    }

    /* side by side: the common wall goes, an edge of three triangles is left around it */
    Mesh wall = cube();
    append(wall, moved(cube(), {1, 1, 1}, {1, 0, 0}));
    Cleaned c = clean(wall);
    assert_true(area(c.mesh) >= 10);
}

/* A torus whose tube is pinched so that all of one edge ring coincides with another: sheets
 * pass the same edges within the same fans. */
static void test_pinched(void **)
{
    Mesh pinched = torus(24, 12);
    for (uint32_t i = 0; i < 6; ++i)
        pinched.positions[i * 12 + 3] = pinched.positions[i * 12 + 9] = pinched.positions[i * 12];
    clean(pinched);
    Mesh kissing = torus(24, 12);
    for (uint32_t i = 0; i < 24; i += 2)
        kissing.positions[(i + 1) * 12 % 288] = kissing.positions[i * 12];
    clean(kissing);
    /* random identifications of vertices: every kind of conflict */
    for (uint32_t seed = 1; seed <= 300; ++seed) {
        Mesh mesh = torus(8, 6);
        uint32_t state = seed * 2654435761u;
        auto any = [&](size_t n) { return (state = state * 1664525u + 1013904223u) % 65521 % n; };
        for (uint32_t i = 0; i < 4 + seed % 12; ++i)
            mesh.positions[any(48)] = mesh.positions[any(48)];
        if (seed % 2)
            for (size_t i = 0; i < 10; ++i)
                turn(mesh, any(mesh.triangle_count()));
        clean(mesh);
    }
    for (uint32_t seed = 1; seed <= 300; ++seed) { /* a few points, triangles anywhere */
        Mesh mesh;
        uint32_t state = seed * 2246822519u;
        auto any = [&](uint32_t n) { return (state = state * 1664525u + 1013904223u) % 65521 % n; };
        for (int i = 0; i < 7; ++i)
            mesh.positions.push_back(Vec3d(any(99), any(99), any(99)));
        for (uint32_t i = 0; i < 5 + seed % 25; ++i)
            mesh.triangles.push_back({any(7), any(7), any(7)});
        mesh.triangles.push_back({0, 1, 2});
        clean(mesh);
    }
}

/* A sphere without some of its triangles, `share` of them, wound inwards if asked for. */
static Mesh holed_sphere(double share, bool inwards)
{
    Mesh mesh = inwards ? turned(sphere(64)) : sphere(64);
    size_t count = mesh.triangle_count();
    mesh.triangles.erase(mesh.triangles.begin() + ptrdiff_t(count / 2),
                         mesh.triangles.begin() + ptrdiff_t(double(count) * (0.5 + share)));
    return mesh;
}

/* A scan with small gaps is as good as closed: one side, outwards. A wide gap shows the other. */
static void test_gaps(void **)
{
    for (bool inwards : {false, true}) {
        Cleaned small = clean(holed_sphere(0.002, inwards));
        assert_true(small.report.boundary_edges > 0);
        Vec3d p = small.mesh.position(0, 0);
        assert_true(dot(small.mesh.area_vector(0), p) > 0);
        for (uint8_t flags : small.mesh.flags)
            assert_false(flags & gtx::TRIANGLE_TWO_SIDED);
        Cleaned wide = clean(holed_sphere(0.1, inwards));
        for (uint8_t flags : wide.mesh.flags)
            assert_true(flags & gtx::TRIANGLE_TWO_SIDED);
    }
}

/* A ribbon that twists by a full turn: its border's vector area is nothing, and it is no scan. */
static void test_ribbon(void **)
{
    Cleaned c = clean(grid(64, 4, false, false, false, [](double u, double v) {
        double w = v - 0.5;
        return Vec3d(10 * u, w * std::cos(u * TURN), w * std::sin(u * TURN));
    }));
    for (uint8_t flags : c.mesh.flags)
        assert_true(flags & gtx::TRIANGLE_TWO_SIDED);
}

static void test_many_components(void **)
{
    /* inside-out boxes everywhere must not take a time of their number squared */
    Mesh mesh;
    for (int i = 0; i < 4000; ++i)
        append(mesh, turned(moved(cube(), {0.5, 0.5, 0.5},
                                  {double(i % 20), double(i / 20 % 20), double(i / 400)})));
    Cleaned c = clean(mesh);
    assert_int_equal(c.report.components, 4000);
    assert_int_equal(c.report.flipped, 48000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_winding), cmocka_unit_test(test_nested),
        cmocka_unit_test(test_one_sided), cmocka_unit_test(test_fans),
        cmocka_unit_test(test_touching), cmocka_unit_test(test_pinched),
        cmocka_unit_test(test_gaps), cmocka_unit_test(test_ribbon),
        cmocka_unit_test(test_many_components),
    };
    return cmocka_run_group_tests_name("clean_sides", tests, nullptr, nullptr);
}
