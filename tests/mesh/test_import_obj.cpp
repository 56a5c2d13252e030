/* OBJ: what it says, in every spelling, and where it goes wrong. */
#include "test_import.hpp"

static const char square[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

static void test_plain(void **)
{
    Imported i = import_text("a.obj", std::string("# a comment\no name\n") + square +
                                          "s off\nf 1 2 3\nf 1 3 4");
    assert_works(i, 4, 2);
    assert_triangle(i.mesh, 1, 0, 2, 3);
    assert_position(i.mesh, 2, 1, 1, 0);
    assert_true(i.mesh.normals.empty() && i.mesh.colors.empty() && i.mesh.flags.empty());
    assert_true(i.warnings.empty());
}

static void test_line_ends(void **)
{
    for (const char *end : {"\n", "\r\n", "\r"}) {
        std::string text;
        for (const char *line : {"v 0 0 0", "", "v\t1 0 0  ", "v 1 1 0 # corner", "f 1 2 3"})
            text += std::string(line) + end;
        assert_works(import_text("a.obj", text), 3, 1);
        assert_fails(import_text("a.obj", text + "f 1 2 9"), GTX_ERROR_INPUT, "line 6: vertex 9");
    }
    assert_works(import_text("a.obj",
                             "\xef\xbb\xbfv 0 0 0\nv 1 \\\n 0 0\nv 0 1 0\nf 1 \\\r\n2\\\n 3"
                             "\ncurv 0 1 \\\n 2 3\n"),
                 3, 1);
}

static void test_numbers(void **)
{
    Imported i =
        import_text("a.obj", "v +1e3 -.5 2.\nv 1e400 -1e400 1e-400\nv nan inf 0\nf 1 2 3\n");
    assert_works(i, 3, 1);
    assert_position(i.mesh, 0, 1000, -0.5, 2);
    assert_true(i.mesh.positions[1] == Vec3d(HUGE_VAL, -HUGE_VAL, 0));
    assert_true(std::isnan(i.mesh.positions[2].x));
    /* Whole ones, of digits that a double holds and of more. */
    i = import_text("a.obj", "v +12 007 999999999999999\nv 12e1 9007199254740993 4E0\n"
                             "v 18446744073709551617 -0 0\nf 1 2 3\n");
    assert_works(i, 3, 1);
    assert_position(i.mesh, 0, 12, 7, 999999999999999.);
    assert_position(i.mesh, 1, 120, 9007199254740992., 4);
    assert_position(i.mesh, 2, 18446744073709551616., 0, 0);
    assert_int_not_equal(import_text("a.obj", "v 1 2 3x\nf 1 1 1\n").result, GTX_OK);
}

static void test_negative_indices(void **)
{
    Imported i = import_text("a.obj", std::string(square) + "f -4 -3 -2\nv 5 5 5\nf -1 -3 -2\n");
    assert_works(i, 5, 2);
    assert_triangle(i.mesh, 0, 0, 1, 2);
    assert_triangle(i.mesh, 1, 4, 2, 3);
}

static void test_normals(void **)
{
    Imported i = import_text("a.obj", std::string(square) + "vt 0 0\nvn 0 0 1\nvn 1 0 0\n" +
                                          "f 1 2 3\nf 1//1 3//2 4//-1\nf 1/1/1 2/1/2 3/1\n");
    assert_works(i, 4, 3);
    assert_int_equal(i.mesh.normals.size(), 9);
    assert_true(i.mesh.normals[0] == Vec3f() && i.mesh.normals[8] == Vec3f());
    assert_true(i.mesh.normals[3] == Vec3f(0, 0, 1) && i.mesh.normals[5] == Vec3f(1, 0, 0));
}

static void test_colors(void **)
{
    Imported i = import_text("a.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 7 -1 nan\nv 0 1 0\nv 1 1 0 1\n"
                                      "f 1 2 3\n");
    assert_works(i, 4, 1);
    assert_color(i.mesh, 0, 255, 128, 0, 255);
    assert_color(i.mesh, 1, 255, 0, 0, 255);
    assert_color(i.mesh, 2, 255, 255, 255, 255);
}

static void test_polygons(void **)
{
    /* an arrow head, whose fan from the first corner would leave it, turned every way */
    const char *corners[] = {"v 0 0 0\n", "v 4 -2 0\n", "v 1 0 0\n", "v 4 2 0\n"};
    for (int turn = 0; turn < 4; ++turn) {
        std::string text;
        for (int k = 0; k < 4; ++k)
            text += corners[(k + turn) % 4];
        Imported i = import_text("a.obj", text + "f 1 2 3 4\n");
        assert_works(i, 4, 2);
        assert_float_equal(area(i.mesh), 2, 1e-9);
        assert_float_equal(area_vector(i.mesh).z, 2, 1e-9);
    }
    /* a comb with five teeth, far from the origin and seen from behind */
    std::string text, face = "f";
    for (int k = 0; k < 11; ++k)
        text += "v 1e7 " + std::to_string(10000000 + k) + (k % 2 ? " 10\n" : " 1\n");
    text += "v 1e7 10000010 0\nv 1e7 10000000 0\n";
    for (int k = 1; k <= 13; ++k)
        face += " " + std::to_string(k);
    Imported comb = import_text("a.obj", text + face + "\n");
    assert_works(comb, 13, 11);
    assert_float_equal(area(comb.mesh), 55, 1e-6);
    assert_float_equal(area_vector(comb.mesh).x, -55, 1e-6);
}

static void test_odd_polygons(void **)
{
    /* crossing itself, repeating corners, of no area, of NaN: as many triangles as ever */
    assert_works(import_text("a.obj", std::string(square) + "f 1 3 2 4\n"), 4, 2);
    assert_works(import_text("a.obj", std::string(square) + "f 1 1 1 1 1\n"), 4, 3);
    assert_works(import_text("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv nan 0 0\nf 1 2 3 2 1 4\n"), 4,
                 4);
    std::string large = "";
    std::string face = "f";
    for (int k = 0; k < 3000; ++k) {
        double a = k * 2 * 3.14159265358979 / 3000;
        large += "v " + std::to_string(cos(a)) + " " + std::to_string(sin(a)) + " 0\n";
        face += " " + std::to_string(k + 1);
    }
    Imported i = import_text("a.obj", large + face);
    assert_works(i, 3000, 2998);
    assert_float_equal(area(i.mesh), 3.14159, 1e-3);
}

static void test_ignored(void **)
{
    Imported i = import_text("a.obj", std::string("mtllib a.mtl\n") + square +
                                          "usemtl x\nl 1 2\np 1\nusemtl y\nf 1 2\nf 1 2 3\n");
    assert_works(i, 4, 1);
    assert_true(i.warns("ignored: l, p") && i.warns("'a.mtl' was not found"));
    assert_true(i.warns("1 faces with fewer than three corners"));
    assert_int_equal(i.warnings.size(), 3);
}

static void test_bad(void **)
{
    static const struct {
        const char *line, *message;
    } bad[] = {
        {"f 1 2 5", "line 5: vertex 5, but 4"},
        {"f 0 1 2", "line 5: vertex 0"},
        {"f -5 1 2", "line 5: vertex -5"},
        {"f 1 2 99999999999999999999999", "line 5: vertex 9999"},
        {"f 1 2 x", "line 5: a corner"},
        {"f 1 2 3.5", "line 5: a corner"},
        {"f 1//1 2//1 3//1", "line 5: normal 1, but 0"},
        {"v 1 2", "line 5: a vertex needs 3"},
        {"v 1 2 three", "line 5: 'three' is not a number"},
        {"v 1,5 2 3", "line 5: ',5 2 3' is not a number"},
        {"vn 1 2", "line 5: a normal needs 3"},
        {"\x01\x02\x03", "is not an OBJ statement"},
    };
    for (const auto &b : bad)
        assert_fails(import_text("a.obj", std::string(square) + b.line), GTX_ERROR_INPUT,
                     b.message);
    assert_fails(import_text("a.obj", std::string(square) + std::string("f 1 2\0 3", 8)),
                 GTX_ERROR_INPUT, "line 5: a corner");
    assert_fails(import_text("a.obj", square), GTX_ERROR_EMPTY, "no triangle");
    assert_fails(import_text("a.obj", ""), GTX_ERROR_EMPTY, "no triangle");
    for (const char *tail :
         {"v", "f", "f 1/", "f 1//", "f 1/2/", "\\", "f 1 \\\n", "#", "v 1 2 +", "v 1 2 -"})
        assert_true(import_text("a.obj", std::string(square) + tail).result != GTX_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain),    cmocka_unit_test(test_line_ends),
        cmocka_unit_test(test_numbers),  cmocka_unit_test(test_negative_indices),
        cmocka_unit_test(test_normals),  cmocka_unit_test(test_colors),
        cmocka_unit_test(test_polygons), cmocka_unit_test(test_odd_polygons),
        cmocka_unit_test(test_ignored),  cmocka_unit_test(test_bad),
    };
    return cmocka_run_group_tests_name("import_obj", tests, nullptr, nullptr);
}
