/* OFF: keywords and counts in every shape, colours, polygons, and files that lie. */
#include "test_import.hpp"

static const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

static void test_shapes_of_the_header(void **)
{
    const char *starts[] = {"OFF\n4 1 0\n",
                            "OFF 4 1 0\n",
                            "OFF\n4 1\n",
                            "OFF # a comment\n\n# and another\n 4\t1 4 # counts\n",
                            "\xef\xbb\xbfOFF\n4 1 0\n",
                            "\n  OFF\n4 1 0\n",
                            "# a comment before the keyword\nOFF\n4 1 0\n",
                            " OFF4 1 12# glued\n",
                            "4 1 0\n"}; /* the keyword is optional */
    for (const char *start : starts) {
        Imported i = import_text("a.off", start + square + "4 0 1 2 3\n");
        assert_works(i, 4, 2);
        assert_true(area(i.mesh) == 1);
        assert_true(area_vector(i.mesh) == Vec3d(0, 0, 1));
        assert_true(i.mesh.colors.empty() && i.mesh.normals.empty() && i.warnings.empty());
    }
    std::string text = "OFF\n4 2 5\n" + square + "3 0 1 2\n3 0 2 3", crlf;
    assert_works(import_text("a.off", text), 4, 2); /* no last line end */
    for (char c : text)
        crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    assert_works(import_text("a.off", crlf), 4, 2);
    assert_works(import_text("none", text), 4, 2);
    std::string row = square; /* the vertices in one line */
    std::replace(row.begin(), row.end() - 1, '\n', ' ');
    assert_works(import_text("a.off", "OFF\n4 1 0\n" + row + "4 0 1 2\n3\n"), 4, 2);
}

static void test_polygons(void **)
{
    /* An arrow head: a fan from its first corner would leave the polygon. */
    Imported i = import_text("a.off", "OFF 4 1 0\n0 0 0\n2 -1 0\n0 2 0\n-2 -1 0\n4 0 1 2 3\n");
    assert_works(i, 4, 2);
    assert_true(std::abs(area(i.mesh) - 4) < 1e-12);
    i = import_text("a.off", "OFF 4 3 0\n" + square + "1 0\n2 0 1\n3 0 1 2\n");
    assert_works(i, 4, 1);
    assert_true(i.warns("2 faces with fewer than three corners"));
    assert_fails(import_text("a.off", "OFF 4 0 0\n" + square), GTX_ERROR_EMPTY, "no triangle");
    assert_fails(import_text("a.off", "OFF 0 0 0\n"), GTX_ERROR_EMPTY, "no triangle");
}

static void test_colors(void **)
{
    Imported i = import_text("a.off", "COFF\n3 1 0\n0 0 0 255 0 51 128\n1 0 0 0 255 0 255\n"
                                      "0 1 0 1 2 3 4\n3 0 1 2\n");
    assert_works(i, 3, 1);
    assert_color(i.mesh, 0, 255, 0, 51, 128);
    assert_color(i.mesh, 2, 1, 2, 3, 4);
    i = import_text("none", "COFF\n3 1 0\n0 0 0 1.0 0 0.2 0.5\n1 0 0 0 1 0\n0 1 0 0 0 1\n"
                            "3 0 1 2\n");
    assert_works(i, 3, 1);
    assert_color(i.mesh, 0, 255, 0, 51, 128);
    assert_color(i.mesh, 1, 0, 255, 0, 255);
    i = import_text("a.off", "COFF\n3 1 0\n0 0 0 300 -5 nan\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2\n");
    assert_color(i.mesh, 0, 255, 0, 0, 255);
    i = import_text("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n");
    assert_works(i, 3, 1);
    assert_true(i.warns("colours of faces were ignored") && i.mesh.colors.empty());
    assert_fails(import_text("a.off", "COFF\n3 1 0\n0 0 0 1 1\n"), GTX_ERROR_INPUT, "line 3");
    assert_fails(import_text("a.off", "COFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
                 GTX_ERROR_INPUT, "colour");
    assert_fails(import_text("a.off", "COFF\n3 1 0\n0 0 0 1 2 3 4 5\n"), GTX_ERROR_INPUT, "colour");
}

static void test_other_attributes(void **)
{
    Imported i = import_text("a.off", "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 1 0\n"
                                      "3 0 1 2\n");
    assert_works(i, 3, 1);
    assert_true(i.mesh.normals[0] == Vec3f(0, 0, 1) && i.mesh.normals[2] == Vec3f(0, 1, 0));
    i = import_text("a.off", "STOFF\n3 1 0\n0 0 0 .5 .5\n1 0 0 .5 .5\n0 1 0 .5 .5\n3 0 1 2\n");
    assert_works(i, 3, 1);
    i = import_text("a.off", "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 .5 .5\n"
                             "1 0 0 0 0 1 0 255 0 9 .5 .5\n0 1 0 0 0 1 0 0 255 .5 .5\n3 0 1 2\n");
    assert_works(i, 3, 1);
    assert_color(i.mesh, 0, 255, 0, 0, 255);
    assert_color(i.mesh, 1, 0, 255, 0, 9);
    assert_true(i.mesh.normals[2] == Vec3f(0, 0, 1));
}

static void test_refusals(void **)
{
    const struct {
        const char *text;
        gtx_result result;
        const char *part;
    } cases[] = {
        {"", GTX_ERROR_INPUT, "empty"},
        {"OFF BINARY\n\0\0\0\4", GTX_ERROR_UNSUPPORTED, "binary"},
        {"4OFF\n1 0 0\n0 0 0 1\n", GTX_ERROR_UNSUPPORTED, "dimensions"},
        {"nOFF\n4\n1 0 0\n", GTX_ERROR_UNSUPPORTED, "dimensions"},
        {"OFF\n", GTX_ERROR_INPUT, "ends"},
        {"OFFX 3 1 0\n", GTX_ERROR_INPUT, "not 'OFFX'"},
        {"OFF\nthree\n", GTX_ERROR_INPUT, "not 'three'"},
        {"OFF\n-3 1 0\n", GTX_ERROR_INPUT, "not '-3'"},
        {"OFF\n3.5 1 0\n", GTX_ERROR_INPUT, "not '3.5'"},
        {"OFF\n99999999999999999999 1 0\n", GTX_ERROR_INPUT, "not '9999"},
        {"OFF\n4294967295 1 0\n", GTX_ERROR_LIMIT, "more than"},
        {"OFF\n3 18446744073709551615 0\n", GTX_ERROR_LIMIT, "more than"},
        {"OFF\n4000000000 4000000000 0\n0 0 0\n", GTX_ERROR_INPUT, "ends"},
        {"OFF\n3 1 0\n0 0 0\n1 0 x\n", GTX_ERROR_INPUT, "line 4"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", GTX_ERROR_INPUT, "vertex 3"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", GTX_ERROR_INPUT, "not '-1'"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n", GTX_ERROR_INPUT, "ends"},
        {"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", GTX_ERROR_INPUT, "ends"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2.0\n", GTX_ERROR_INPUT, "not '2.0'"},
    };
    for (const auto &c : cases)
        assert_fails(import_text("a.off", c.text), c.result, c.part);
    Imported i = import_text("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\nmore\n");
    assert_true(i.result == GTX_OK && i.warns("behind the last face"));
    i = import_text("a.off", "OFF\n3 1 0\nnan 0 0\ninf 0 0\n0 1e999 0\n3 0 1 2\n");
    assert_works(i, 3, 1); /* cleaning drops those */
}

static void test_model(void **)
{
    if (models().empty())
        skip();
    Imported i = import_path(models() + "/scans/mask.off.gz");
    assert_int_equal(i.result, GTX_OK);
    assert_int_equal(i.mesh.triangle_count(), 62467);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes_of_the_header), cmocka_unit_test(test_polygons),
        cmocka_unit_test(test_colors),               cmocka_unit_test(test_other_attributes),
        cmocka_unit_test(test_refusals),             cmocka_unit_test(test_model),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
