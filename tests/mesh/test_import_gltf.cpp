/* glTF: scenes, transforms, accessors, containers. */
#include "test_import_gltf.hpp"

static std::string glb(const std::string &json, const std::string &binary)
{
    std::string text = json, data = binary;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    data.resize((data.size() + 3) / 4 * 4);
    std::string out = "glTF" +
                      packed<uint32_t>({2, uint32_t(28 + text.size() + data.size()),
                                        uint32_t(text.size()), 0x4e4f534a}) +
                      text;
    return out + packed<uint32_t>({uint32_t(data.size()), 0x004e4942}) + data;
}

static void test_plain(void **)
{
    Imported i = import_data(square_json, square());
    assert_works(i, 4, 2);
    assert_triangle(i.mesh, 1, 0, 2, 3);
    assert_position(i.mesh, 2, 1, 1, 0);
    assert_true(i.mesh.normals.empty() && i.mesh.colors.empty() && i.mesh.flags.empty());
    assert_true(i.warnings.empty());
    assert_works(import_text("a.bin", "\n \t" + with_data(square_json, square())), 4, 2);
}

static void test_glb(void **)
{
    std::string json = change(square_json, ",'uri':'URI'", "");
    std::string good = glb(json, square());
    assert_works(import_text("a.glb", good), 4, 2);
    assert_works(import_text("a.glb", good + "trailing"), 4, 2);
    for (size_t size = 4; size < good.size(); ++size)
        assert_fails(import_text("a.glb", good.substr(0, size)), GTX_ERROR_INPUT, "GLB");
    std::string old = good;
    old[4] = 1;
    assert_fails(import_text("a.glb", old), GTX_ERROR_UNSUPPORTED, "version 1");
    std::string odd = good;
    odd[16] = 'X';
    assert_fails(import_text("a.glb", odd), GTX_ERROR_INPUT, "not JSON");
    assert_fails(import_text("a.glb", glb(json, square().substr(0, 40))), GTX_ERROR_INPUT,
                 "buffer 0 has 40 of its 60 bytes");
}

static void test_files(void **)
{
    Folder folder;
    folder.write("models/parts/my data.bin", square() + "more");
    folder.write("secret.bin", square());
    auto with_uri = [&](const std::string &uri) {
        return import_path(folder.write("models/a.gltf", change(square_json, "URI", uri)));
    };
    Imported i = with_uri("parts/my%20data.bin");
    assert_works(i, 4, 2);
    assert_int_equal(i.sources.size(), 2);
    assert_true(
        std::filesystem::equivalent(i.sources[1], folder.path / "models/parts/my data.bin"));
    assert_works(with_uri("./parts/my data.bin"), 4, 2);
    assert_fails(with_uri("absent.bin"), GTX_ERROR_READ,
                 "buffer 0: 'absent.bin': cannot open the file: No such file or directory");
    assert_fails(with_uri("parts"), GTX_ERROR_READ,
                 "buffer 0: 'parts': cannot read the file: it is not a regular one");
    for (const std::string &uri :
         {std::string("../secret.bin"), std::string("parts/../../secret.bin"), std::string(""),
          std::string("%2e%2e/secret.bin"), std::string("..%5c..\\\\secret.bin"),
          (folder.path / "secret.bin").string(), std::string("file:///etc/passwd"),
          std::string("https://example.com/a.bin"), std::string("parts/a%00.bin")})
        assert_fails(with_uri(uri), GTX_ERROR_INPUT, "is not a file in the model's folder");
    assert_fails(with_uri("data:application/octet-stream;base64,????"), GTX_ERROR_INPUT,
                 "not base64");
    assert_fails(with_uri("data:text/plain,hello"), GTX_ERROR_INPUT, "not base64");
    assert_fails(with_uri("data:;base64,AAAA"), GTX_ERROR_INPUT, "buffer 0 has 3 of its 60 bytes");
}

static void test_transforms(void **)
{
    /* translation x rotation (a quarter turn about z, unnormalised) x scale, below a matrix */
    Imported i = import_changed("[{'mesh':0}]", R"([
        {"children":[1],"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 100,0,0,1]},
        {"mesh":0,"translation":[10,20,30],"rotation":[0,0,2,2],"scale":[2,3,4]}])");
    assert_works(i, 4, 2);
    assert_position(i.mesh, 0, 110, 20, 30);
    assert_position(i.mesh, 1, 110, 22, 30);
    assert_position(i.mesh, 2, 107, 22, 30);
    assert_float_equal(area_vector(i.mesh).z, 6, 1e-9);
}

static void test_far_away(void **)
{
    Imported i = import_changed("{'mesh':0}", "{'mesh':0,'translation':[1e9,0,0],"
                                              "'scale':[0.001,0.001,0.001]}");
    assert_works(i, 4, 2);
    double side = i.mesh.positions[1].x - i.mesh.positions[0].x;
    assert_float_equal(side, 0.001, 1e-6);
}

static void test_mirror(void **)
{
    std::string json = change(square_json, "'POSITION':0", "'POSITION':0,'NORMAL':2");
    json = change(
        json, ",'type':'SCALAR'}],",
        R"(,"type":"SCALAR"},{"bufferView":2,"componentType":5126,"count":4,"type":"VEC3"}],)");
    json = change(json, "'byteLength':12}",
                  R"("byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":48})");
    json = change(json, "'byteLength':60", "'byteLength':108");
    std::string bytes = square() + packed<float>({1, 1, 0, 1, 1, 0, 1, 1, 0, 0, 0, 1});
    json = change(json, "{'mesh':0}", "{'mesh':0,'scale':[-2,1,1]}");
    Imported i = import_data(json, bytes);
    assert_works(i, 4, 2);
    assert_triangle(i.mesh, 0, 0, 2, 1);
    assert_float_equal(area_vector(i.mesh).z, 2, 1e-9); /* still facing +z */
    Vec3f n = i.mesh.normals[0]; /* the inverse transpose: (-1/2, 1) normalised */
    assert_float_equal(n.x, -0.4472136, 1e-6);
    assert_float_equal(n.y, 0.8944272, 1e-6);

    Imported flat = import_text(
        "a.gltf", with_data(change(json, "[-2,1,1]", "[1,1,0]"), bytes)); /* singular, not fatal */
    assert_works(flat, 4, 2);
    for (const Vec3f &normal : flat.mesh.normals)
        assert_true(gtx::is_finite(normal));
}

static void test_trees(void **)
{
    assert_works(import_changed("[{'mesh':0}]", R"([{"children":[1,2]},{"mesh":0},{"mesh":0}])"), 8,
                 4);
    assert_works(import_changed("'scene':0,'scenes':[{'nodes':[0]}],", ""), 4, 2);
    std::string library = change(square_json, "'scene':0,'scenes':[{'nodes':[0]}],", "");
    library = change(library, "'nodes':[{'mesh':0}],", "");
    assert_works(import_data(library, square()), 4, 2);
    assert_fails(import_changed("[{'mesh':0}]", "[{}, {'mesh':0}]"), GTX_ERROR_EMPTY,
                 "no triangle");
    assert_fails(import_changed("'scene':0", "'scene':1"), GTX_ERROR_INPUT, "no scene 1");
    assert_fails(import_changed("{'mesh':0}", "{'mesh':0,'children':[0]}"), GTX_ERROR_INPUT,
                 "node 0 is reached twice");
    assert_fails(import_changed("[{'mesh':0}]", R"([{"children":[1]},{"children":[0]}])"),
                 GTX_ERROR_INPUT, "node 0 is reached twice");
    assert_fails(import_changed("{'mesh':0}", "{'mesh':0,'children':[7]}"), GTX_ERROR_INPUT,
                 "no node 7");
    assert_fails(import_changed("{'mesh':0}", "{'mesh':3}"), GTX_ERROR_INPUT,
                 "node 0: there is no mesh 3");

    std::string deep = "[";
    for (int k = 1; k < 50000; ++k)
        deep += "{'translation':[1,0,0],'children':[" + std::to_string(k) + "]},";
    Imported i = import_changed("[{'mesh':0}]", deep + "{'mesh':0}]");
    assert_works(i, 4, 2);
    assert_position(i.mesh, 0, 49999, 0, 0);
}

/* A few kilobytes that ask for thirty million triangles. */
static void test_instances(void **)
{
    std::string indices;
    for (int k = 0; k < 30000; ++k)
        indices += packed<uint16_t>({0, 1, 2});
    std::string json = change(square_json, "'byteLength':12", "'byteLength':180000");
    json = change(json, "'count':6", "'count':90000");
    json = change(json, "'byteLength':60", "'byteLength':180048");
    std::string nodes, roots;
    for (int k = 0; k < 2000; ++k) {
        nodes += std::string(k ? "," : "") + "{'mesh':0}";
        roots += (k ? "," : "") + std::to_string(k);
    }
    json = change(json, "{'mesh':0}", nodes);
    json = change(json, "'nodes':[0]", "'nodes':[" + roots + "]");
    assert_fails(import_data(json, square().substr(0, 48) + indices), GTX_ERROR_LIMIT,
                 "triangles, more than");
}

/* EXT_mesh_gpu_instancing: a node that repeats its mesh, quarter turns as normalised shorts. */
static void test_gpu_instancing(void **)
{
    std::string json = change(square_json, "{'mesh':0}", R"({"mesh":0,"translation":[100,0,0],
        "extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2,"ROTATION":3}}}})");
    json = change(json, "'asset'", "'extensionsRequired':['EXT_mesh_gpu_instancing'],'asset'");
    json = change(json, ",'type':'SCALAR'}],",
                  R"(,"type":"SCALAR"},
        {"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"},
        {"bufferView":3,"componentType":5122,"normalized":true,"count":2,"type":"VEC4"}],)");
    json = change(json, "'byteLength':12}", R"("byteLength":12},
        {"buffer":0,"byteOffset":60,"byteLength":24},
        {"buffer":0,"byteOffset":84,"byteLength":16})");
    json = change(json, "'byteLength':60", "'byteLength':100");
    std::string bytes = square() + packed<float>({0, 0, 5, 10, 0, 0}) +
                        packed<int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170});
    Imported i = import_data(json, bytes);
    assert_works(i, 8, 4);
    assert_position(i.mesh, 1, 101, 0, 5);
    assert_position(i.mesh, 4, 110, 0, 0);
    assert_position(i.mesh, 5, 110, 1, 0);
    assert_true(i.warnings.empty());
    assert_fails(import_data(change(json, "'TRANSLATION':2,'ROTATION':3", ""), bytes),
                 GTX_ERROR_EMPTY, "no triangle"); /* repeated no times */
    assert_fails(import_data(change(json, "5126,'count':2", "5126,'count':1"), bytes),
                 GTX_ERROR_INPUT, "node 0: the TRANSLATION of its instances");
    assert_fails(import_data(change(json, "'TRANSLATION':2", "'TRANSLATION':3"), bytes),
                 GTX_ERROR_INPUT, "node 0: the TRANSLATION of its instances");
    assert_fails(import_data(change(json, "'TRANSLATION':2", "'TRANSLATION':9"), bytes),
                 GTX_ERROR_INPUT, "no accessor 9");
    std::string many = change(json, "'bufferView':2,'componentType':5126,'count':2",
                              "'componentType':5126,'count':2000000");
    assert_fails(import_data(change(many, ",'ROTATION':3", ""), bytes), GTX_ERROR_LIMIT,
                 "node 0: more than 1048576 repeated instances");
}

static void test_modes(void **)
{
    Imported strip = import_changed("'indices':1", "'mode':5");
    assert_works(strip, 4, 2);
    assert_triangle(strip.mesh, 0, 0, 1, 2);
    assert_triangle(strip.mesh, 1, 2, 1, 3);
    Imported fan = import_changed("'indices':1", "'mode':6");
    assert_works(fan, 4, 2);
    assert_triangle(fan.mesh, 1, 0, 2, 3);
    assert_works(import_changed("'indices':1", "'mode':4"), 4, 1);
    Imported lines = import_changed("'indices':1", "'mode':1");
    assert_fails(lines, GTX_ERROR_EMPTY, "no triangle");
    assert_true(lines.warns("points and lines"));
    assert_fails(import_changed("'indices':1", "'mode':9"), GTX_ERROR_INPUT,
                 "mesh 0 primitive 0: 9 is not a mode");
}

static void test_index_types(void **)
{
    std::string positions = square().substr(0, 48);
    std::string json = change(square_json, "'componentType':5123", "'componentType':5121");
    assert_works(
        import_data(json, positions + packed<uint8_t>({0, 1, 2, 0, 2, 3, 9, 9, 9, 9, 9, 9})), 4, 2);
    json = change(square_json, "'componentType':5123", "'componentType':5125");
    json = change(json, "'count':6", "'count':3");
    assert_works(import_data(json, positions + packed<uint32_t>({1, 2, 3})), 4, 1);
    assert_fails(import_data(json, positions + packed<uint32_t>({1, 2, 4})), GTX_ERROR_INPUT,
                 "accessor 1: index 2 is vertex 4 of 4");
    assert_fails(import_changed("'componentType':5123", "'componentType':5122"), GTX_ERROR_INPUT,
                 "accessor 1: indices must be unsigned");
}

static void test_sparse(void **)
{
    std::string json = change(square_json, "'count':4,", R"("count":4,"sparse":{"count":1,
        "indices":{"bufferView":1,"byteOffset":2,"componentType":5123},
        "values":{"bufferView":0,"byteOffset":24}},)");
    Imported i = import_data(json, square());
    assert_works(i, 4, 2);
    assert_position(i.mesh, 1, 1, 1, 0);
    Imported zeros =
        import_data(change(json, "{'bufferView':0,'componentType'", "{'componentType'"), square());
    assert_works(zeros, 4, 2);
    assert_position(zeros.mesh, 1, 1, 1, 0);
    assert_position(zeros.mesh, 2, 0, 0, 0);
    assert_fails(import_data(change(json, "'byteOffset':24", "'byteOffset':40"), square()),
                 GTX_ERROR_INPUT, "accessor 0: its sparse values");
    assert_fails(import_data(change(json, "{'count':1,", "{'count':99,"), square()),
                 GTX_ERROR_INPUT, "accessor 0: its sparse indices");
    std::string far = square();
    far[50] = 77;
    assert_fails(import_data(json, far), GTX_ERROR_INPUT, "sparse index 77 of 4");
    assert_fails(import_changed("'bufferView':0,'componentType':5126,'count':4",
                                "'componentType':5126,'count':4000000000"),
                 GTX_ERROR_LIMIT, "bytes of memory");
}

/* KHR_mesh_quantization: normalised shorts with a stride. */
static void test_quantized(void **)
{
    std::string json =
        change(square_json, "'componentType':5126", "'componentType':5122,'normalized':true");
    json =
        change(json, "{'buffer':0,'byteLength':48}", "{'buffer':0,'byteLength':48,'byteStride':8}");
    json = change(json, "'asset'", "'extensionsRequired':['KHR_mesh_quantization'],'asset'");
    std::string bytes =
        packed<int16_t>({0, 0, 0, 7, 32767, 0, 0, 7, 32767, -32767, 0, 7, 0, 16384, 0, 7});
    bytes.resize(48);
    Imported i = import_data(json, bytes + square().substr(48));
    assert_works(i, 4, 2);
    assert_position(i.mesh, 2, 1, -1, 0);
    assert_float_equal(i.mesh.positions[3].y, 16384 / 32767., 1e-12);
    assert_fails(import_data(change(json, "'byteStride':8", "'byteStride':4"), bytes),
                 GTX_ERROR_INPUT, "");
}

static void test_materials(void **)
{
    std::string json = change(square_json, "'indices':1}", R"("indices":1,"material":0},
        {"attributes":{"POSITION":0,"COLOR_0":2},"indices":1,"material":1},
        {"attributes":{"POSITION":0},"indices":1})");
    json = change(json, "'asset'", R"("materials":[
        {"doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[0.5,0,1,0.25]}},
        {"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,0.5,0.5]}}],"asset")");
    json = change(json, "'SCALAR'}", R"("SCALAR"},{"bufferView":2,"componentType":5121,
        "normalized":true,"count":4,"type":"VEC4"})");
    json = change(json, "'byteLength':12}",
                  R"("byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":16})");
    json = change(json, "'byteLength':60", "'byteLength':76");
    std::string colors = packed<uint8_t>({55, 0, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    Imported i = import_data(json, square() + colors);
    assert_works(i, 12, 6);
    assert_sample(i.mesh, 0, {0.5, 0, 1, 1}); /* opaque has no alpha */
    assert_sample(i.mesh, 2, {55 / 255., 0, 0.5, 1});
    assert_sample(i.mesh, 4, {1, 1, 1, 1});
    const uint8_t flags[] = {gtx::TRIANGLE_TWO_SIDED, gtx::TRIANGLE_TWO_SIDED, 0, 0, 0, 0};
    assert_memory_equal(i.mesh.flags.data(), flags, 6);
    assert_true(i.warns("blended"));
    assert_fails(import_changed("'indices':1}", "'indices':1,'material':0}"), GTX_ERROR_INPUT,
                 "mesh 0 primitive 0: there is no material 0");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain), cmocka_unit_test(test_glb), cmocka_unit_test(test_files),
        cmocka_unit_test(test_transforms), cmocka_unit_test(test_far_away),
        cmocka_unit_test(test_mirror), cmocka_unit_test(test_trees),
        cmocka_unit_test(test_instances), cmocka_unit_test(test_gpu_instancing),
        cmocka_unit_test(test_modes), cmocka_unit_test(test_index_types),
        cmocka_unit_test(test_sparse), cmocka_unit_test(test_quantized),
        cmocka_unit_test(test_materials),
    };
    return cmocka_run_group_tests_name("import_gltf", tests, nullptr, nullptr);
}
