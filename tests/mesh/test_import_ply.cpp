/* PLY: three encodings, every type, odd elements, and headers that lie. */
#include "test_import.hpp"

static const char header[] = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\n"
                             "property float x\nproperty float y\nproperty float z\n"
                             "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
static const char body[] = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

static void test_ascii(void **)
{
    Imported i = import_text("a.ply", std::string(header) + body);
    assert_works(i, 4, 2);
    assert_triangle(i.mesh, 1, 0, 2, 3);
    assert_position(i.mesh, 2, 1, 1, 0);
    assert_true(i.mesh.normals.empty() && i.mesh.colors.empty() && i.warnings.empty());

    std::string text = std::string(header) + body, crlf;
    for (char c : text)
        crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    assert_works(import_text("a.ply", crlf), 4, 2);
    assert_works(import_text("a.ply", text.substr(0, text.size() - 1)), 4, 2);
}

/* Appends a value as `size` bytes of the machine, turned when asked. */
template <class T> static void put(std::string &out, T value, bool turn)
{
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    for (size_t k = 0; k < sizeof value; ++k)
        out += bytes[turn ? sizeof value - 1 - k : k];
}

static std::string everything(bool big)
{
    std::string out =
        std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
        " 1.0\nelement junk 2\nproperty list uint16 double many\nproperty char one\n"
        "element vertex 3\nproperty double x\nproperty float32 y\nproperty int16 z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "property uchar red\nproperty ushort green\nproperty float blue\n"
        "property uint8 alpha\nproperty list uchar int tags\n"
        "element face 1\nproperty uint id\nproperty list int uint vertex_index\nend_header\n";
    for (uint16_t n : {uint16_t(2), uint16_t(0)}) {
        put(out, n, big);
        for (int k = 0; k < n; ++k)
            put(out, 1.5, big);
        put(out, int8_t(-1), big);
    }
    for (int v = 0; v < 3; ++v) {
        put(out, 1e9 + v, big);
        put(out, float(v == 2), big);
        put(out, int16_t(-300), big);
        put(out, 0.f, big);
        put(out, 0.f, big);
        put(out, 1.f, big);
        put(out, uint8_t(51 * v), big);
        put(out, uint16_t(65535), big);
        put(out, 0.5f, big);
        put(out, uint8_t(128), big);
        put(out, uint8_t(1), big);
        put(out, int32_t(7), big);
    }
    put(out, uint32_t(1), big);
    put(out, int32_t(3), big);
    for (uint32_t k = 0; k < 3; ++k)
        put(out, k, big);
    return out;
}

static void test_binary(void **)
{
    const uint16_t one = 1;
    bool little = *reinterpret_cast<const unsigned char *>(&one) == 1;
    assert_true(little); /* put() writes the machine's order */
    for (bool big : {false, true}) {
        Imported i = import_text("a.ply", everything(big));
        assert_works(i, 3, 1);
        assert_true(i.mesh.positions[2] == Vec3d(1e9 + 2, 1, -300));
        assert_true(i.mesh.normals[1] == Vec3f(0, 0, 1));
        assert_color(i.mesh, 1, 51, 255, 128, 128);
        assert_true(i.warns("vertex.tags, face.id"));
        std::string whole = everything(big);
        for (size_t size = 0; size < whole.size(); ++size) /* cut anywhere: never a fault */
            assert_true(import_text("a.ply", whole.substr(0, size)).result != GTX_OK);
    }
}

static void test_faces_first(void **)
{
    Imported i =
        import_text("a.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int "
                             "vertex_index\nelement vertex 4\nproperty float z\nproperty "
                             "float y\nproperty float x\nend_header\n4 0 1 2 3\n"
                             "0 0 0\n0 0 1\n0 1 1\n0 1 0\n");
    assert_works(i, 4, 2);
    assert_position(i.mesh, 1, 1, 0, 0);
    assert_float_equal(area_vector(i.mesh).z, 1, 1e-9);
}

static void test_polygons(void **)
{
    std::string text =
        edited(std::string(header) + body, "3 0 1 2\n3 0 2 3\n", "5 0 1 2 3 0\n2 0 1\n");
    Imported i = import_text("a.ply", text);
    assert_works(i, 4, 3);
    assert_true(i.warns("1 faces with fewer than three corners"));
}

static void test_strips(void **)
{
    std::string text = edited(std::string(header) + body, "element face 2", "element tristrips 1");
    text = edited(text, "list uchar int", "list int int");
    Imported i = import_text("a.ply", edited(text, "3 0 1 2\n3 0 2 3\n", "8 0 1 3 2 -1 0 1 2\n"));
    assert_works(i, 4, 3);
    assert_triangle(i.mesh, 0, 0, 1, 3);
    assert_triangle(i.mesh, 1, 3, 1, 2);
    assert_triangle(i.mesh, 2, 0, 1, 2);
    assert_fails(import_text("a.ply", edited(text, "3 0 1 2\n3 0 2 3\n", "3 0 1 -2\n")),
                 GTX_ERROR_INPUT, "strip 0: index -2 of 4");
}

static void test_point_cloud(void **)
{
    std::string text(header);
    text = edited(text, "element face 2\nproperty list uchar int vertex_indices\n", "");
    assert_fails(import_text("a.ply", text + "0 0 0 1 0 0 1 1 0 0 1 0"), GTX_ERROR_UNSUPPORTED,
                 "point cloud");
    assert_fails(
        import_text("a.ply", edited(edited(header, "vertex 4", "vertex 0"), "face 2", "face 0")),
        GTX_ERROR_EMPTY, "no triangle");
}

/* Colours of faces, in any type, where vertices have none. */
static void test_face_colors(void **)
{
    const std::string plain = std::string(header) + body;
    auto with = [&](const char *properties, const char *first, const char *second) {
        std::string text = edited(plain, "vertex_indices\n",
                                  (std::string("vertex_indices\n") + properties).c_str());
        text = edited(text, "3 0 1 2\n", (std::string("3 0 1 2") + first + "\n").c_str());
        return edited(text, "3 0 2 3\n", (std::string("3 0 2 3") + second + "\n").c_str());
    };
    const char bytes[] = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    Imported i = import_text("a.ply", with(bytes, " 255 0 10", " 1 2 3"));
    assert_works(i, 4, 2);
    assert_true(i.warnings.empty());
    for (size_t c = 0; c < 3; ++c) {
        assert_color(i.mesh, c, 255, 0, 10, 255);
        assert_color(i.mesh, 3 + c, 1, 2, 3, 255);
    }
    i = import_text("a.ply", with("property float diffuse_blue\nproperty double diffuse_green\n"
                                  "property ushort diffuse_red\nproperty float alpha\n",
                                  " 0.5 1 65535 0.25", " nan -1 99999 2"));
    assert_works(i, 4, 2);
    assert_color(i.mesh, 0, 255, 255, 128, 64);
    assert_color(i.mesh, 3, 255, 0, 0, 255);

    /* not all of them, or not as numbers */
    i = import_text("a.ply", with("property uchar red\nproperty uchar green\n", " 1 2", " 3 4"));
    assert_works(i, 4, 2);
    assert_true(i.mesh.colors.empty() && i.warns("face.red, face.green"));
    i = import_text("a.ply", with("property list uchar uchar red\nproperty uchar green\n"
                                  "property uchar blue\n", " 1 9 2 3", " 0 5 6"));
    assert_works(i, 4, 2);
    assert_true(i.mesh.colors.empty() && i.warns("face.red, face.green, face.blue"));

    assert_fails(import_text("a.ply", with(bytes, " 1 2 3", " 1 2")), GTX_ERROR_INPUT,
                 "the file ends in face 1 of 2");
    assert_fails(import_text("a.ply", with(bytes, " 1 2 3", " 1 2 red")), GTX_ERROR_INPUT,
                 "is not a number");
}

/* Every triangle of a polygon or of a strip has its colour; what has none is white. */
static void test_face_colors_spread(void **)
{
    const char properties[] = "property list uchar int vertex_indices\nproperty uchar red\n"
                              "property uchar green\nproperty uchar blue\n";
    std::string text = std::string("ply\nformat ascii 1.0\nelement face 3\n") + properties +
                       "element tristrips 1\n" + properties + "element vertex 5\nproperty float x\n"
                       "property float y\nproperty float z\nend_header\n"
                       "5 0 1 2 3 4 9 8 7\n2 0 1 1 1 1\n3 0 1 2 6 5 4\n4 0 1 2 3 3 2 1\n"
                       "0 0 0\n2 0 0\n2 1 0\n1 2 0\n0 1 0\n";
    Imported i = import_text("a.ply", text);
    assert_works(i, 5, 6);
    for (size_t t = 0; t < 3; ++t)
        assert_color(i.mesh, 3 * t, 9, 8, 7, 255);
    assert_color(i.mesh, 9, 6, 5, 4, 255);
    assert_color(i.mesh, 12, 3, 2, 1, 255);
    assert_color(i.mesh, 17, 3, 2, 1, 255);

    text = edited(text, "element vertex", "element face 1\nproperty list uchar int vertex_index\n"
                  "element vertex");
    i = import_text("a.ply", edited(text, "0 0 0\n", "3 0 1 2\n0 0 0\n"));
    assert_works(i, 5, 7);
    assert_color(i.mesh, 12, 255, 255, 255, 255);
}

/* Vertices know better. */
static void test_face_and_vertex_colors(void **)
{
    std::string text = edited(everything(false), "property uint id\n",
                              "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                              "property uchar id\n");
    Imported i = import_text("a.ply", text);
    assert_works(i, 3, 1);
    assert_color(i.mesh, 1, 51, 255, 128, 128);
    assert_true(i.warns("the colours of faces were ignored"));
}

static void test_bad(void **)
{
    static const struct {
        const char *from, *to, *message;
    } bad[] = {
        {"ascii", "text", "line 2: 'text' is not a PLY format"},
        {"format ascii 1.0\n", "", "no format"},
        {"end_header", "end_heater", "line 10: 'end_heater'"},
        {"float z", "quad z", "line 7: 'quad' is not a PLY type"},
        {"property float x\n", "", "no x, y and z"},
        {"vertex 4", "vertex -4", "line 4: an element"},
        {"vertex 4", "vertex 4000000000", "4000000000 rows of element 'vertex'"},
        {"vertex 4", "vertex 99999999999999999999999", "line 4: an element"},
        {"face 2", "face 18446744073709551615", "rows of element 'face'"},
        {"face 2", "face 3", "the file ends in face 2 of 3"},
        {"list uchar int", "list float int", "line 9: the length of a list"},
        {"element vertex", "property float x\nelement vertex", "line 4: this is not a property"},
        {"3 0 2 3", "3 0 2 4", "face 1: index 4 of 4"},
        {"3 0 2 3", "3 0 2 -1", "face 1: index -1 of 4"},
        {"3 0 2 3", "3 0 2 2.5", "face 1: index 2.5 of 4"},
        {"3 0 2 3", "3 0 2 nan", "face 1: index nan of 4"},
        {"3 0 2 3", "-3 0 2 3", "face 1: a list of -3"},
        {"3 0 2 3", "4000000000 0 2 3", "face 1: a list of 4000000000"},
        {"3 0 2 3", "nan 0 2 3", "face 1: a list of nan"},
        {"1 1 0", "1 one 0", "line 13: 'one 0"},
    };
    for (const auto &b : bad)
        assert_fails(import_text("a.ply", edited(std::string(header) + body, b.from, b.to)),
                     GTX_ERROR_INPUT, b.message);
    assert_fails(import_text("a.ply", "plywood\n"), GTX_ERROR_INPUT, "'ply'");
    assert_fails(import_text("a.ply", ""), GTX_ERROR_INPUT, "end_header");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ascii),       cmocka_unit_test(test_binary),
        cmocka_unit_test(test_faces_first), cmocka_unit_test(test_polygons),
        cmocka_unit_test(test_strips),      cmocka_unit_test(test_point_cloud),
        cmocka_unit_test(test_face_colors), cmocka_unit_test(test_face_colors_spread),
        cmocka_unit_test(test_face_and_vertex_colors),
        cmocka_unit_test(test_bad),
    };
    return cmocka_run_group_tests_name("import_ply", tests, nullptr, nullptr);
}
