/* Models in pieces: the triangles that importing gives, and faults of files that lie. */
#include "worlds.hpp"

#include "base/bytes.h"

#include <functional>

using namespace gtx;

static Vector<Corners3> read_all(const std::string &path)
{
    Task task(1, nullptr, nullptr);
    Vector<Corners3> out;
    open_triangles(path, task)->read([&](const Corners3 &c) { out.push_back(c); });
    return out;
}

/* The stream has the triangles of the imported mesh, in its order, corner by corner. */
static void same_as_imported(const std::string &path)
{
    Task task(1, nullptr, nullptr);
    const Mesh mesh = import_mesh(path, task);
    const Vector<Corners3> read = read_all(path);
    assert_int_equal(read.size(), mesh.triangle_count());
    for (size_t t = 0; t < read.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            assert_true(read[t][k].position == mesh.position(t, int(k)));
            if (!mesh.normals.empty())
                assert_true(read[t][k].normal == mesh.normals[3 * t + k]);
            if (!mesh.colors.empty())
                assert_true(read[t][k].color == mesh.colors[3 * t + k]);
        }
}

/* With normals and colours, or a surface of positions alone. */
static TileSurface patch(bool all)
{
    const Mesh mesh = terrain(12);
    TileSurface s;
    s.traits = {true, all, all};
    s.positions = mesh.positions;
    for (const Vec3d &p : mesh.positions) {
        s.normals.push_back(Vec3f(normalize(Vec3d(p.x, 1, p.z))));
        s.colors.push_back({uint8_t(100 + 90 * p.x), uint8_t(100 + 90 * p.z), 40, 255});
        s.place.push_back(uint32_t(s.place.size()));
    }
    s.triangles = mesh.triangles;
    s.own = s.triangles.size();
    s.header.low = {-1, -1, -1};
    s.header.high = {1, 1, 1};
    return s;
}

static std::string float_stl()
{
    const Mesh mesh = terrain(9);
    std::string out(84 + 50 * mesh.triangle_count(), 0);
    auto *to = reinterpret_cast<uint8_t *>(&out[80]);
    gtx_store_u32(to, uint32_t(mesh.triangle_count()));
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (int k = 0; k < 9; ++k)
            gtx_store_f32(to + 4 + 50 * t + 12 + 4 * size_t(k),
                          float(mesh.position(t, k / 3)[k % 3]));
    return out;
}

static void streams_are_what_importing_gives(void **)
{
    for (bool all : {false, true}) {
        write_file(in_folder("a.ply"), ply_of(patch(all)));
        same_as_imported(in_folder("a.ply"));
    }
    write_file(in_folder("a.stl"), float_stl());
    same_as_imported(in_folder("a.stl"));
    const TileSurface s = patch(true);
    Task task(1, nullptr, nullptr);
    NearSurface near(s, task);
    write_file(in_folder("a.glb"), glb_of(plain_mesh_of(s, s.own), near, false));
    same_as_imported(in_folder("a.glb"));
    assert_int_equal(read_all(in_folder("a.glb")).size(), s.own);
}

/* Targa of so many grey pixels a side. */
static std::string image(unsigned side, unsigned grey)
{
    std::string out(18, 0);
    out[2] = 2;
    out[12] = out[14] = char(side);
    out[16] = 24;
    for (unsigned i = 0; i < side * side; ++i)
        out += std::string(3, char(grey + i));
    return out;
}

static std::string glb_with(std::string json, std::string binary)
{
    std::string out = "glTF";
    auto word = [&](size_t x) {
        for (int k = 0; k < 4; ++k)
            out += char(x >> (8 * k) & 255);
    };
    json.resize((json.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, 0);
    word(2);
    word(28 + json.size() + binary.size());
    word(json.size());
    out += "JSON" + json;
    word(binary.size());
    return out + std::string("BIN\0", 4) + binary;
}

/* A square twice, turned and moved: one with images of the file, one with that of a file beside it
 * and one that is not there. */
static std::string textured_glb()
{
    const float numbers[] = {0, 0, 0, 1,    0,    0, 1, 1,    0, 0, 1, 0,   /* positions */
                             0, 1, 1, 1,    1,    0, 0, 0.25f,              /* coordinates */
                             1, 0, 0, 1,    1,    0, 0, 1,    1, 0, 0, 1,   1, 0, 0, -1};
    std::string binary(sizeof numbers + 12, 0);
    auto *to = reinterpret_cast<uint8_t *>(&binary[0]);
    for (float x : numbers) {
        gtx_store_f32(to, x);
        to += 4;
    }
    for (unsigned v : {0u, 1u, 2u, 0u, 2u, 3u}) {
        gtx_store_u16(to, uint16_t(v));
        to += 2;
    }
    const std::string pictures[] = {image(8, 7), image(4, 99)};
    std::string views;
    for (const std::string &picture : pictures) {
        views += ",{\"buffer\":0,\"byteOffset\":" + std::to_string(binary.size()) +
                 ",\"byteLength\":" + std::to_string(picture.size()) + "}";
        binary += picture;
    }
    return glb_with(
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}],"
        "\"nodes\":[{\"mesh\":0},{\"mesh\":1,\"rotation\":[0,0.6,0,0.8],\"scale\":[-1,2,1]}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_1\":1,"
        "\"TANGENT\":2},\"indices\":3,\"material\":0}]},{\"primitives\":[{\"attributes\":{"
        "\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":3,\"material\":1}]}],"
        "\"materials\":[{\"normalTexture\":{\"index\":1,\"texCoord\":1},\"pbrMetallicRoughness\":{"
        "\"baseColorFactor\":[0.5,1,1,1],\"baseColorTexture\":{\"index\":0,\"texCoord\":1}}},"
        "{\"occlusionTexture\":{\"index\":3},\"pbrMetallicRoughness\":{"
        "\"metallicRoughnessTexture\":{\"index\":0,\"texCoord\":5},"
        "\"baseColorTexture\":{\"index\":2}}}],"
        "\"textures\":[{\"source\":0},{\"source\":1},{\"source\":2},{\"source\":3}],"
        "\"images\":[{\"bufferView\":4},{\"bufferView\":5},{\"uri\":\"beside.tga\"},"
        "{\"uri\":\"none.tga\"}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
        "{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC4\"},"
        "{\"bufferView\":3,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48},"
        "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32},"
        "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":64},"
        "{\"buffer\":0,\"byteOffset\":144,\"byteLength\":12}" + views + "],"
        "\"buffers\":[{\"byteLength\":" + std::to_string(binary.size()) + "}]}", binary);
}

static void same_texture(const Texture &a, const Texture &b)
{
    assert_int_equal(a.image, b.image);
    assert_int_equal(a.set, b.set);
}

/* What the GLB looks like, too, an image at a time. */
static void images_come_one_by_one(void **)
{
    const std::string path = in_folder("textured.glb");
    write_file(path, textured_glb());
    write_file(in_folder("beside.tga"), image(16, 30));
    same_as_imported(path);
    Task task(1, nullptr, nullptr), heard(1, nullptr, nullptr);
    const Mesh mesh = import_mesh(path, heard);
    const Appearance &whole = mesh.appearance;
    const auto stream = open_triangles(path, task);
    assert_true(stream->traits().textured);
    size_t images = 0, t = 0;
    stream->on_look = [&](const Appearance &look) {
        assert_true(look.images.size() + (look.materials.empty() ? 0 : 1) == 1);
        for (const Image &one : look.images)
            assert_true(one.levels[0].texels == whole.images[images++].levels[0].texels);
        assert_int_equal(look.materials.size(), look.materials.empty() ? 0 : 2);
        for (size_t m = 0; m < look.materials.size(); ++m) {
            assert_float_equal(look.materials[m].color[0], whole.materials[m].color[0], 0);
            for (Texture Material::*map : MATERIAL_TEXTURES)
                same_texture(look.materials[m].*map, whole.materials[m].*map);
        }
    };
    stream->read([&](const Corners3 &corners) {
        for (size_t k = 0; k < 3; ++k) {
            const CornerLook &look = corners[k].look;
            assert_int_equal(look.material, whole.material[t]);
            for (size_t i = 0; i < 2; ++i)
                assert_float_equal(look.uv[0][i], whole.uv[0][3 * t + k][i], 0);
            for (size_t i = 0; i < 4; ++i)
                assert_float_equal(look.tangent[i], whole.tangents[3 * t + k][i], 0);
        }
        ++t;
    });
    assert_int_equal(t, 4);
    assert_int_equal(images, 3);
    assert_int_equal(images, whole.images.size());
    assert_int_equal(task.warnings.size(), heard.warnings.size());
}

/* Rows of text may take fewer bytes than their numbers do in memory. */
static void text_is_imported_whole(void **)
{
    write_file(in_folder("text.ply"),
               "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\n"
               "property double y\nproperty double z\nelement face 2\n"
               "property list uchar int vertex_indices\nend_header\n"
               "0 0 0\n1 0 0\n0 1 0\n1 1 1\n3 0 1 2\n3 1 3 2\n");
    assert_int_equal(read_all(in_folder("text.ply")).size(), 2);
    same_as_imported(in_folder("text.ply"));
}

/* Faces of four corners, big-endian, with properties that nobody needs. */
static void polygons_and_other_orders_of_bytes(void **)
{
    const std::string header =
        "ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty uchar dust\n"
        "property float x\nproperty float y\nproperty float z\nelement face 2\n"
        "property list uchar int vertex_indices\nproperty uchar dust\nend_header\n";
    std::string text = header;
    auto put = [&](uint32_t bits) {
        for (int k = 3; k >= 0; --k)
            text += char(bits >> (8 * k));
    };
    for (int v = 0; v < 4; ++v) {
        text += 'd';
        for (bool one : {v == 1 || v == 2, v > 1, false})
            put(one ? 0x3f800000 : 0);
    }
    for (int face = 0; face < 2; ++face) {
        text += char(4);
        for (uint32_t v = 0; v < 4; ++v)
            put(v);
        text += 'd';
    }
    write_file(in_folder("big.ply"), text);
    assert_int_equal(read_all(in_folder("big.ply")).size(), 4);
    same_as_imported(in_folder("big.ply"));
}

static gtx_result result_of(const std::function<void()> &body)
{
    try {
        body();
        return GTX_OK;
    } catch (const Error &e) {
        assert_true(e.message.find('\n') == e.message.npos);
        return e.result;
    }
}

static gtx_result reading(const std::string &name, const std::string &text)
{
    write_file(in_folder(name.c_str()), text);
    return result_of([&] { read_all(in_folder(name.c_str())); });
}

static std::string replaced(std::string text, const std::string &from, const std::string &to)
{
    const size_t at = text.find(from);
    assert_true(at != text.npos);
    return text.replace(at, from.size(), to);
}

static void lies_are_found_before_memory_is_taken(void **)
{
    const std::string ply = ply_of(patch(false));
    assert_int_equal(reading("x.ply", ply.substr(0, ply.size() - 1)), GTX_ERROR_INPUT);
    assert_int_equal(reading("x.ply", ply.substr(0, 200)), GTX_ERROR_INPUT);
    assert_int_equal(reading("x.ply", replaced(ply, "face 288", "face 99999999999")),
                     GTX_ERROR_INPUT);
    assert_int_equal(reading("x.ply", replaced(ply, "vertex 169", "vertex 18446744073709551615")),
                     GTX_ERROR_INPUT);
    assert_int_equal(reading("x.ply", replaced(ply, "vertex 169", "vertex 168")),
                     GTX_ERROR_INPUT);
    std::string stl = float_stl();
    gtx_store_u32(reinterpret_cast<uint8_t *>(&stl[80]), UINT32_MAX);
    assert_int_equal(reading("x.stl", stl), GTX_ERROR_INPUT);
    const TileSurface s = patch(true);
    Task task(1, nullptr, nullptr);
    NearSurface near(s, task);
    const std::string glb = glb_of(plain_mesh_of(s, s.own), near, false);
    for (size_t cut : {glb.size() - 4, size_t(400), size_t(21)})
        assert_int_equal(reading("x.glb", glb.substr(0, cut)), GTX_ERROR_INPUT);
    for (const char *count : {"\"count\": 169", "\"count\": 864"})
        assert_int_equal(reading("x.glb", replaced(glb, count, "\"count\": 999")),
                         GTX_ERROR_INPUT);
}

static void blocks_are_few(void **)
{
    constexpr size_t TRIANGLES = 3000000;
    {
        std::ofstream out(in_folder("raw"), std::ios::binary);
        const std::string block(36 * 1000, 'A');
        for (size_t i = 0; i < TRIANGLES / 1000; ++i)
            out << block;
    }
    gtx_limits limits = {};
    limits.memory = 70 << 20; /* the file is 108 MB */
    Task task(1, nullptr, nullptr, {}, {}, limits);
    size_t count = 0;
    open_raw_triangles(in_folder("raw"), task)->read([&](const Corners3 &) { ++count; });
    assert_int_equal(count, TRIANGLES);
    fs::remove(in_folder("raw"));
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(streams_are_what_importing_gives),
        cmocka_unit_test(images_come_one_by_one),
        cmocka_unit_test(text_is_imported_whole),
        cmocka_unit_test(polygons_and_other_orders_of_bytes),
        cmocka_unit_test(lies_are_found_before_memory_is_taken),
        cmocka_unit_test(blocks_are_few),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
