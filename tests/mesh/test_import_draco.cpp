/* Draco streams: encoded here, decoded by the importer, and damaged in every byte. */
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <draco/point_cloud/point_cloud_builder.h>

#include "test_import_gltf.hpp"

static std::string bytes_of(const draco::EncoderBuffer &buffer)
{
    return std::string(buffer.data(), buffer.size());
}

/* A grid of 5 x 5 squares with a colour and a normal. */
static std::string encoded_grid(draco::MeshEncoderMethod method)
{
    const int n = 5;
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2 * n * n);
    int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
    int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
    for (int f = 0; f < 2 * n * n; ++f) {
        float x = float(f / 2 % n), y = float(f / 2 / n), up[] = {0, 0, 1};
        float p[4][3] = {{x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}};
        uint8_t red[] = {255, 51, 0};
        draco::FaceIndex face(static_cast<uint32_t>(f));
        int k = f % 2;
        builder.SetAttributeValuesForFace(position, face, p[0], p[1 + k], p[2 + k]);
        builder.SetAttributeValuesForFace(normal, face, up, up, up);
        builder.SetAttributeValuesForFace(color, face, red, red, red);
    }
    std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    draco::EncoderBuffer buffer;
    assert_true(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return bytes_of(buffer);
}

static void test_decode(void **)
{
    for (auto method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
        Imported i = import_text("a.drc", encoded_grid(method));
        assert_works(i, 36, 50);
        assert_float_equal(area_vector(i.mesh).z, 25, 1e-2);
        assert_color(i.mesh, 7, 255, 51, 0, 255);
        assert_float_equal(i.mesh.normals[9].z, 1, 1e-2);
    }
}

static void test_point_cloud(void **)
{
    draco::PointCloudBuilder builder;
    builder.Start(4);
    int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (uint32_t i = 0; i < 4; ++i) {
        float p[] = {float(i), 0, 0};
        builder.SetAttributeValueForPoint(position, draco::PointIndex(i), p);
    }
    std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(false);
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    assert_true(encoder.EncodePointCloudToBuffer(*cloud, &buffer).ok());
    assert_fails(import_text("a.drc", bytes_of(buffer)), GTX_ERROR_UNSUPPORTED, "point cloud");
}

static void test_damaged(void **)
{
    Folder folder;
    size_t refused = 0;
    for (auto method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
        const std::string good = encoded_grid(method);
        for (size_t at = 0; at < good.size(); ++at)
            for (int bit = 0; bit < 8; bit += 3) {
                std::string bad = good;
                bad[at] = char(bad[at] ^ 1 << bit);
                Imported i = import_path(folder.write("a.drc", bad));
                if (i.result != GTX_OK)
                    ++refused;
                else
                    assert_works(i, i.mesh.positions.size(), i.mesh.triangles.size());
            }
        for (size_t size = 0; size < good.size(); ++size)
            assert_int_not_equal(import_path(folder.write("a.drc", good.substr(0, size))).result,
                                 GTX_OK);
    }
    assert_true(refused > 20);
    assert_fails(import_text("a.drc", "DRACO"), GTX_ERROR_INPUT, "header");
    assert_fails(import_text("a.drc", "not at all"), GTX_ERROR_INPUT, "header");
}

/* The grid as KHR_draco_mesh_compression; its accessors have no buffer view of their own. */
static const char gltf[] = R"({"asset":{"version":"2.0"},"extensionsUsed":
["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"],
"nodes":[{"mesh":0,"scale":[2,2,2]}],"meshes":[{"primitives":[{"attributes":
{"POSITION":0,"NORMAL":1,"COLOR_0":2},"indices":3,"extensions":{"KHR_draco_mesh_compression":
{"bufferView":0,"attributes":{"POSITION":0,"NORMAL":1,"COLOR_0":2}}}}]}],"accessors":[
{"componentType":5126,"count":36,"type":"VEC3"},{"componentType":5126,"count":36,"type":"VEC3"},
{"componentType":5121,"normalized":true,"count":36,"type":"VEC3"},
{"componentType":5123,"count":150,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":SIZE}],
"buffers":[{"byteLength":SIZE,"uri":"data:;base64,DATA"}]})";

static void test_gltf(void **)
{
    std::string grid = encoded_grid(draco::MESH_EDGEBREAKER_ENCODING),
                size = std::to_string(grid.size());
    std::string json = edited(gltf, "\"byteLength\":SIZE,", "\"byteLength\":" + size + ",");
    json = edited(edited(json, "SIZE", size), "DATA", base64(grid));
    Imported i = import_text("a.gltf", json);
    assert_works(i, 36, 50);
    assert_float_equal(area_vector(i.mesh).z, 100, 1e-1);
    assert_color(i.mesh, 0, 255, 124, 0, 255); /* linear 51 / 255 */
    assert_float_equal(i.mesh.normals[3].z, 1, 1e-2);

    std::string unknown = "\"attributes\":{\"POSITION\":9,\"NORMAL\":1,\"COLOR_0\":2}}}}]";
    assert_fails(import_text("a.gltf", edited(json,
                                              "\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
                                              "\"COLOR_0\":2}}}}]",
                                              unknown)),
                 GTX_ERROR_INPUT, "no attribute 9 for POSITION");
    /* positions from an accessor, triangles from Draco: their numbers need not agree */
    std::string few =
        edited(json, "{\"POSITION\":0,\"NORMAL\":1,\"COLOR_0\":2}}}}]", "{\"NORMAL\":1}}}}]");
    few = edited(few, "\"COLOR_0\":2", "\"X\":2");
    few = edited(few, "[\n{\"componentType\":5126,\"count\":36",
                 "[\n{\"bufferView\":0,\"componentType\":5126,\"count\":2");
    assert_fails(import_text("a.gltf", few), GTX_ERROR_INPUT, "2 positions for 36 Draco points");
    std::string damaged = grid;
    damaged.resize(grid.size() / 2);
    json = edited(edited(gltf, "\"byteLength\":SIZE,", "\"byteLength\":" + size + ","), "SIZE",
                  std::to_string(damaged.size()));
    damaged.resize(grid.size());
    assert_fails(import_text("a.gltf", edited(json, "DATA", base64(damaged))), GTX_ERROR_INPUT,
                 "the Draco data is damaged");
}

/* One triangle with texture coordinates, a tangent and a colour in bytes that are no fractions. */
static void test_gltf_texture(void **)
{
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(1);
    const float p[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const float uv[3][2] = {{0, 0}, {0.25f, 0}, {0, 1}};
    const float t[4] = {0, 1, 0, -1};
    draco::FaceIndex face(0);
    int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    int texture = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
    int tangent = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_FLOAT32);
    builder.SetAttributeValuesForFace(position, face, p[0], p[1], p[2]);
    builder.SetAttributeValuesForFace(texture, face, uv[0], uv[1], uv[2]);
    builder.SetAttributeValuesForFace(tangent, face, t, t, t);
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
    draco::EncoderBuffer buffer;
    assert_true(encoder.EncodeMeshToBuffer(*builder.Finalize(), &buffer).ok());

    Folder folder;
    folder.write("a.png", png(folder, 1, 1, {255, 0, 0, 255}));
    const std::string size = std::to_string(buffer.size());
    std::string json = quoted(R"({'asset':{'version':'2.0'},
'extensionsRequired':['KHR_draco_mesh_compression'],'meshes':[{'primitives':[{'material':0,
'attributes':{'POSITION':0,'TEXCOORD_0':1,'TANGENT':2},'indices':3,'extensions':
{'KHR_draco_mesh_compression':{'bufferView':0,'attributes':
{'POSITION':0,'TEXCOORD_0':1,'TANGENT':2}}}}]}],
'accessors':[{'componentType':5126,'count':3,'type':'VEC3'},
{'componentType':5126,'count':3,'type':'VEC2'},{'componentType':5126,'count':3,'type':'VEC4'},
{'componentType':5123,'count':3,'type':'SCALAR'}],
'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0}},'normalTexture':{'index':0}}],
'textures':[{'source':0}],'images':[{'uri':'a.png'}],
'bufferViews':[{'buffer':0,'byteLength':)") + size + quoted("}],'buffers':[{'byteLength':") + size +
                       quoted(",'uri':'URI'}]}");
    json = with_data(json, bytes_of(buffer));
    Imported i = import_path(folder.write("a.gltf", json));
    assert_works(i, 3, 1);
    const gtx::Appearance &look = i.mesh.appearance;
    assert_int_equal(look.uv[0].size(), 3);
    assert_int_equal(look.tangents.size(), 3);
    for (size_t k = 0; k < 3; ++k) {
        const Vec3d &at = i.mesh.position(0, int(k));
        assert_float_equal(look.uv[0][k][0], 0.25 * at.x, 1e-6);
        assert_float_equal(look.uv[0][k][1], at.y, 1e-6);
        assert_true(look.tangents[k][1] == 1 && look.tangents[k][3] == -1);
    }
    assert_sample(i.mesh, 0, {1, 0, 0, 1});
    json = edited(json, "\"TEXCOORD_0\":1,\"TANGENT\":2}}", "\"TEXCOORD_0\":2,\"TANGENT\":2}}");
    assert_fails(import_path(folder.write("a.gltf", json)), GTX_ERROR_INPUT,
                 "POSITION and TEXCOORD_0 do not fit");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decode),
        cmocka_unit_test(test_point_cloud),
        cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_gltf),
        cmocka_unit_test(test_gltf_texture),
    };
    return cmocka_run_group_tests_name("import_draco", tests, nullptr, nullptr);
}
