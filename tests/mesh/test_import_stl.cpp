/* STL: which of the two kinds a file is, both of them, and files that lie. */
#include "test_import.hpp"

static const std::string facet = " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"
                                 "   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n endfacet\n";

static void put(std::string &out, uint32_t value, int size)
{
    for (int i = 0; i < size; ++i)
        out += char(value >> (8 * i));
}

/* `count` triangles beside each other; the header starts as told. */
static std::string binary(const char *start, uint32_t count, char padding = '\0')
{
    std::string out = start;
    out.resize(80, padding);
    put(out, count, 4);
    for (uint32_t t = 0; t < count; ++t) {
        float values[12] = {0, 0, -1, float(t), 0, 0, float(t) + 1, 0, 0, float(t), 1, 0};
        for (float v : values) {
            uint32_t bits;
            std::memcpy(&bits, &v, 4);
            put(out, bits, 4);
        }
        put(out, 0, 2);
    }
    return out;
}

static void test_binary(void **)
{
    Imported i = import_text("a.stl", binary("made by a test", 5));
    assert_works(i, 15, 5);
    assert_triangle(i.mesh, 4, 12, 13, 14);
    assert_position(i.mesh, 13, 5, 0, 0);
    assert_true(i.mesh.normals.empty() && i.warnings.empty()); /* whatever its normals say */
    std::string colored = binary("COLOR=\xff\xff\xff\xff", 2);
    colored.back() = '\x80';
    i = import_text("a.stl", colored);
    assert_works(i, 6, 2);
    assert_true(i.warns("colours of STL facets were ignored"));
    i = import_text("a.stl", binary("x", 2) + "tail");
    assert_works(i, 6, 2);
    assert_true(i.warns("behind the last facet"));
}

static void test_text(void **)
{
    Imported i =
        import_text("a.stl", "solid name of it\n" + facet + facet + "endsolid name of it\n");
    assert_works(i, 6, 2);
    assert_true(i.mesh.normals.empty() && i.warnings.empty());
    assert_true(area_vector(i.mesh) == Vec3d(0, 0, 1));
    assert_works(import_text("none", "solid\n" + facet + "endsolid"), 3, 1);
    assert_works(import_text("a.stl", "\n solid\n" + facet + "endsolid\nsolid b\n" + facet +
                                          "endsolid b\n"), 6, 2);
    std::string upper = "solid x\n" + facet + "endsolid x\n", crlf;
    for (char &c : upper)
        c = char(std::toupper(c));
    assert_works(import_text("a.stl", edited(upper, "SOLID X\n ", "solid X\n ")), 3, 1);
    for (char c : upper)
        crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    assert_works(import_text("a.stl", edited(crlf, "SOLID X\r\n ", "solid X\r\n ")), 3, 1);
    std::string quad = edited(facet, "  endloop", "   vertex -1 .5 0\n  endloop");
    assert_works(import_text("a.stl", "solid\n" + quad + "endsolid\n"), 4, 2);
    const std::string unknown = edited(facet, "normal 0 0 1", "normal nan nan nan");
    assert_works(import_text("a.stl", "solid\n" + unknown + "endsolid\n"), 3, 1);
}

static void test_telling_them_apart(void **)
{
    for (char padding : {'\0', ' ', '\n'})
        for (uint32_t count : {1u, 7u})
            assert_works(import_text("none", binary("solid facet normal", count, padding)),
                         3 * count, count);
    assert_works(import_text("a.stl", binary("solid", 3) + "tail"), 9, 3);
    assert_fails(import_text("a.stl", binary("solid", 3).substr(0, 200)), GTX_ERROR_INPUT, "3 STL");
    assert_works(import_text("a.stl", "solid short\n" + facet + "endsolid\n"), 3, 1);
}

static void test_refusals(void **)
{
    assert_fails(import_text("a.stl", ""), GTX_ERROR_INPUT, "header");
    assert_fails(import_text("a.stl", std::string(83, '\0')), GTX_ERROR_INPUT, "83 bytes");
    assert_fails(import_text("a.stl", binary("", 0)), GTX_ERROR_EMPTY, "no triangle");
    assert_fails(import_text("a.stl", "solid\nendsolid\n"), GTX_ERROR_EMPTY, "no triangle");
    std::string lying = binary("", 2);
    for (int i = 80; i < 84; ++i)
        lying[size_t(i)] = '\xff';
    assert_fails(import_text("a.stl", lying), GTX_ERROR_INPUT, "4294967295 STL facets");
    assert_fails(import_text("a.stl", binary("", 2).substr(0, 183)), GTX_ERROR_INPUT, "184 bytes");
    std::string solid = "solid\n" + facet;
    const struct {
        std::string text;
        const char *part;
    } cases[] = {
        {solid, "endsolid"},
        {solid + "facet", "'outer'"},
        {solid + "endsolid\nfacet\n", "line 10"},
        {"solid\nvertex 0 0 0\n", "'vertex' where 'facet'"},
        {edited(solid, "vertex 0 1 0", "vertex 0 1"), "number"},
        {edited(solid, "vertex 0 1 0", "vertex 0 1 z"), "line 6"},
        {edited(solid, "   vertex 0 1 0\n", ""), "corner 3"},
        {edited(solid, "outer loop", "outer ring"), "'ring' where 'loop'"},
        {edited(solid, " endfacet\n", ""), "endfacet"},
    };
    for (const auto &c : cases)
        assert_fails(import_text("a.stl", c.text), GTX_ERROR_INPUT, c.part);
    for (size_t size = 6; size + 1 < solid.size(); ++size) /* cut anywhere */
        assert_int_equal(import_text("a.stl", solid.substr(0, size)).result, GTX_ERROR_INPUT);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_binary),
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_telling_them_apart),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
