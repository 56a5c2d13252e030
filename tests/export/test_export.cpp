/* Exports as any reader sees them: structure, light, levels, and the asset inside. */
#include "asset/patch.h"
#include "image/image.h"
#include "mesh/mesh.hpp"

#include <algorithm>
#include <map>

#include "export/exported.hpp"

static gtx_asset *opened(const std::string &bytes)
{
    gtx_asset *asset = nullptr;
    assert_int_equal(gtx_open_memory(bytes.data(), bytes.size(), nullptr, &asset, nullptr), GTX_OK);
    return asset;
}

static gtx_image decoded(const std::string &png)
{
    gtx_image image;
    gtx_error error;
    if (gtx_image_decode(png.data(), png.size(), &image, &error))
        fail_msg("%s", error.message);
    return image;
}

static gtx::Vec3d vec(const std::vector<float> &from, size_t i, size_t width)
{
    return {from[width * i], from[width * i + 1], from[width * i + 2]};
}

static void a_mesh_with_its_textures(void **state)
{
    (void)state;
    const std::string bytes = cooked_sphere();
    gtx_asset *asset = opened(bytes);
    gtx_info info;
    gtx_lod_mesh lod;
    gtx_get_info(asset, &info);
    gtx_get_lod_mesh(asset, 0, &lod);
    const Glb glb(exported(bytes));
    const json &root = glb.root;
    assert_true(root["asset"]["version"] == "2.0");
    assert_int_equal(root["meshes"].size(), 1);
    assert_int_equal(root["images"].size(), 2 * info.page_count); /* normals, colours */
    size_t triangles = 0;
    for (const json &p : root["meshes"][0]["primitives"]) {
        const auto &attributes = p["attributes"];
        const auto place = glb.floats(attributes["POSITION"]);
        const auto uv = glb.floats(attributes["TEXCOORD_0"]);
        const auto normal = glb.floats(attributes["NORMAL"]);
        const auto tangent = glb.floats(attributes["TANGENT"]);
        const json &accessor = root["accessors"][attributes["POSITION"].get<size_t>()];
        for (size_t i = 0; 3 * i < place.size(); ++i) {
            const gtx::Vec3d n = vec(normal, i, 3), t = vec(tangent, i, 4);
            assert_true(std::abs(length(n) - 1) < 1e-5 && std::abs(length(t) - 1) < 1e-5);
            assert_true(std::abs(dot(n, t)) < 1e-5 && tangent[4 * i + 3] == -1);
            for (size_t k = 0; k < 2; ++k)
                assert_true(uv[2 * i + k] > 0 && uv[2 * i + k] < 1);
            for (size_t k = 0; k < 3; ++k)
                assert_true(place[3 * i + k] >= accessor["min"][k].get<float>() &&
                            place[3 * i + k] <= accessor["max"][k].get<float>());
        }
        const auto indices = glb.indices(p);
        assert_true(*std::max_element(indices.begin(), indices.end()) < place.size() / 3);
        triangles += indices.size() / 3;
        const json &material = root["materials"][p["material"].get<size_t>()];
        gtx_image image = decoded(glb.image(material["pbrMetallicRoughness"]["baseColorTexture"]));
        assert_int_equal(image.width, info.page_width);
        assert_int_equal(image.height, info.page_height);
        gtx_image_free(&image);
        assert_true(material["pbrMetallicRoughness"]["metallicFactor"] == 0);
    }
    assert_int_equal(triangles, lod.triangle_count);
    gtx_close(asset);
}

/* What a reader sees at the middle of triangles, lit by the frames and the normal texture alone, is
 * what the asset has there: normals in degrees, colours in bytes. */
static void any_reader_lights_it_as_the_asset(void **state)
{
    (void)state;
    const std::string bytes = cooked_sphere();
    gtx_asset *asset = opened(bytes);
    gtx_info info;
    gtx_get_info(asset, &info);
    const auto *map = static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_NORMAL, 0, nullptr));
    const auto *colors =
        static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_COLOR, 0, nullptr));
    const auto *heights =
        static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_HEIGHT, 0, nullptr));
    const Glb glb(exported(bytes));
    std::vector<double> angles;
    size_t bent = 0;
    for (const json &p : glb.root["meshes"][0]["primitives"]) {
        const auto &attributes = p["attributes"];
        const auto uv = glb.floats(attributes["TEXCOORD_0"]);
        const auto normal = glb.floats(attributes["NORMAL"]);
        const auto tangent = glb.floats(attributes["TANGENT"]);
        const json &material = glb.root["materials"][p["material"].get<size_t>()];
        gtx_image image = decoded(glb.image(material["normalTexture"]));
        gtx_image shown = decoded(glb.image(material["pbrMetallicRoughness"]["baseColorTexture"]));
        const auto indices = glb.indices(p);
        for (size_t i = 0; i < indices.size(); i += 3) {
            double at[2] = {0, 0};
            gtx::Vec3d n, t, b;
            for (size_t k = 0; k < 3; ++k) {
                const size_t v = indices[i + k];
                for (size_t j = 0; j < 2; ++j)
                    at[j] += double(uv[2 * v + j]) / 3;
                n += vec(normal, v, 3);
                t += vec(tangent, v, 4);
                b += cross(vec(normal, v, 3), vec(tangent, v, 4)) * double(tangent[4 * v + 3]);
            }
            const uint32_t x = uint32_t(at[0] * info.page_width);
            const uint32_t y = uint32_t(at[1] * info.page_height);
            const gtx_patch *patch = nullptr;
            for (uint32_t q = 0; q < info.patch_count; ++q) {
                const uint16_t *r = gtx_patches(asset)[q].rect;
                if (x - r[0] < uint32_t(r[2]) && y - r[1] < uint32_t(r[3]))
                    patch = &gtx_patches(asset)[q];
            }
            assert_non_null(patch);
            const size_t texel = size_t(y) * info.page_width + x;
            if (!heights[texel]) /* a reader gets what the nearest one has */
                continue;
            assert_memory_equal(&shown.pixels[4 * texel], &colors[4 * texel], 3);
            const uint8_t *code = &image.pixels[4 * texel];
            const gtx::Vec3d seen = normalize(normalize(t) * (code[0] / 127.5 - 1) +
                                              normalize(b) * (code[1] / 127.5 - 1) +
                                              normalize(n) * (code[2] / 127.5 - 1));
            float rows[3][3], own[3];
            gtx_normal_frame(patch, rows);
            gtx_decode_normal(map + 2 * texel, own);
            gtx::Vec3d wanted;
            for (int k = 0; k < 3; ++k)
                for (int j = 0; j < 3; ++j)
                    wanted[k] += double(own[j] * rows[j][k]);
            angles.push_back(std::acos(std::min(dot(seen, normalize(wanted)), 1.)) * 57.3);
            bent += std::abs(code[0] - 128) + std::abs(code[1] - 128) > 6;
        }
        gtx_image_free(&image);
        gtx_image_free(&shown);
    }
    std::sort(angles.begin(), angles.end());
    if (angles.size() < 500 || bent < angles.size() / 10) /* not all straight up */
        fail_msg("%zu normals of %zu differ from the vertices'", bent, angles.size());
    if (angles[angles.size() / 2] > 0.5 || angles[angles.size() * 99 / 100] > 2)
        fail_msg("normals are %.2f degrees off, 1 %% %.2f", angles[angles.size() / 2],
                 angles[angles.size() * 99 / 100]);
    gtx_close(asset);
}

static void levels_are_named_by_msft_lod(void **state)
{
    (void)state;
    const std::string bytes = cooked_sphere(false);
    gtx_asset *asset = opened(bytes);
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx_export_desc desc = {};
    desc.lods = 1;
    const Glb glb(exported(bytes, desc));
    const json &node = glb.root["nodes"][0];
    const json &ids = node["extensions"]["MSFT_lod"]["ids"];
    assert_int_equal(glb.root["scenes"][0]["nodes"].size(), 1);
    assert_int_equal(ids.size() + 1, glb.root["nodes"].size());
    assert_true(ids.size() >= 2);
    size_t before = SIZE_MAX;
    for (uint32_t k = 0; k <= ids.size(); ++k) {
        gtx_lod_mesh lod;
        gtx_get_lod_mesh(asset, k, &lod);
        assert_false(lod.flags & GTX_LOD_FAR);
        size_t triangles = 0;
        for (const json &p : glb.root["meshes"][k]["primitives"]) {
            triangles += glb.indices(p).size() / 3;
            const json &material = glb.root["materials"][p["material"].get<size_t>()];
            gtx_image image = decoded(glb.image(material["normalTexture"]));
            assert_int_equal(image.width, info.page_width >> std::min(k, info.mip_count - 1));
            gtx_image_free(&image);
        }
        assert_int_equal(triangles, lod.triangle_count);
        assert_true(triangles < before);
        before = triangles;
    }
    const json &coverage = node["extras"]["MSFT_screencoverage"];
    assert_int_equal(coverage.size(), ids.size() + 1);
    assert_true(std::is_sorted(coverage.rbegin(), coverage.rend()) && coverage.back() == 0);
    gtx_close(asset);
}

static void one_level_is_chosen_by_number_or_error(void **state)
{
    (void)state;
    const std::string bytes = cooked_sphere(false);
    gtx_asset *asset = opened(bytes);
    gtx_lod_mesh lod[3];
    for (uint32_t k = 0; k < 3; ++k)
        gtx_get_lod_mesh(asset, k, &lod[k]);
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx::Vec3d size;
    for (int k = 0; k < 3; ++k)
        size[k] = double(info.bounds_max[k] - info.bounds_min[k]);
    auto triangles = [&](const gtx_export_desc &desc) {
        size_t count = 0;
        const Glb glb(exported(bytes, desc));
        for (const json &p : glb.root["meshes"][0]["primitives"])
            count += glb.indices(p).size() / 3;
        return count;
    };
    gtx_export_desc desc = {};
    desc.level = 2;
    assert_int_equal(triangles(desc), lod[2].triangle_count);
    desc = {};
    desc.max_error = double(lod[1].error) * 1.001 / length(size);
    assert_int_equal(triangles(desc), lod[1].triangle_count);
    std::string out;
    desc.max_error = double(lod[0].error) * 0.5 / length(size);
    assert_int_equal(try_export(bytes, desc, out), GTX_ERROR_LIMIT);
    desc = {};
    desc.level = info.lod_levels - 1; /* a far one */
    gtx_lod_mesh last;
    gtx_get_lod_mesh(asset, desc.level, &last);
    assert_true(last.flags & GTX_LOD_FAR);
    assert_int_equal(try_export(bytes, desc, out), GTX_ERROR_ARGUMENT);
    gtx_close(asset);
}

/* Of a closed model it is closed: each edge is there once in either direction. */
static void collision_is_one_closed_mesh(void **state)
{
    (void)state;
    gtx_export_desc desc = {};
    desc.collision = 1;
    desc.level = 1;
    const Glb glb(exported(cooked_sphere(), desc));
    assert_false(glb.root.contains("materials") || glb.root.contains("images") ||
                 glb.root.contains("extensionsUsed"));
    const json &primitives = glb.root["meshes"][0]["primitives"];
    assert_int_equal(primitives.size(), 1);
    assert_int_equal(primitives[0]["attributes"].size(), 1);
    const auto indices = glb.indices(primitives[0]);
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (size_t i = 0; i < indices.size(); ++i)
        ++edges[{indices[i], indices[i % 3 == 2 ? i - 2 : i + 1]}];
    for (const auto &[edge, count] : edges)
        assert_true(count == 1 && edges.count({edge.second, edge.first}) == 1);
}

/* Decoded again by the importer: the same triangles, whose corners may be turned, at the same
 * places. */
static void compressed_it_is_the_same(void **state)
{
    (void)state;
    const std::string bytes = cooked_sphere();
    gtx_export_desc desc = {};
    for (uint32_t collision = 0; collision < 2; ++collision) {
        desc.collision = collision;
        desc.without_asset = 0;
        gtx::Mesh meshes[2];
        std::string files[2];
        for (int packed = 0; packed < 2; ++packed) {
            desc.compress = packed ? GTX_EXPORT_MESHOPT : GTX_EXPORT_UNCOMPRESSED;
            files[packed] = exported(bytes, desc);
            gtx::Task task(1, nullptr, nullptr);
            meshes[packed] = gtx::import_model(
                gtx::model_in_memory(files[packed], "a.glb", task), task);
            assert_true(task.warnings.empty());
        }
        assert_true(meshes[0].positions == meshes[1].positions);
        assert_int_equal(meshes[0].triangle_count(), meshes[1].triangle_count());
        const gtx::Mesh &a = meshes[0], &b = meshes[1];
        for (size_t t = 0; t < a.triangle_count(); ++t) {
            size_t turn = 0;
            while (turn < 3 && b.triangles[t][turn] != a.triangles[t][0])
                ++turn;
            assert_true(turn < 3);
            for (size_t k = 0; k < 3; ++k) {
                const size_t other = 3 * t + (k + turn) % 3;
                assert_int_equal(a.triangles[t][k], b.triangles[t][(k + turn) % 3]);
                if (collision)
                    continue;
                assert_true(length(a.normals[3 * t + k] - b.normals[other]) < 1e-4f);
                for (size_t i = 0; i < 2; ++i)
                    assert_true(std::abs(a.appearance.uv[0][3 * t + k][i] -
                                         b.appearance.uv[0][other][i]) < 1e-5f);
            }
        }
        const Glb glb(files[1]);
        assert_true(glb.root["extensionsRequired"].size() == 2 - collision);
        const void *held = nullptr;
        size_t size = 0;
        assert_int_equal(gtx_find_asset(files[1].data(), files[1].size(), &held, &size, nullptr),
                         collision ? GTX_ERROR_EMPTY : GTX_OK);
        assert_true(collision || (size == bytes.size() && !std::memcmp(held, bytes.data(), size)));
    }
    desc.compress = gtx_export_compression(3);
    void *out = nullptr;
    size_t size = 0;
    assert_int_equal(gtx_export_memory(bytes.data(), bytes.size(), &desc, &out, &size, nullptr,
                                       nullptr), GTX_ERROR_ARGUMENT);
}

static void threads_and_copies_change_nothing(void **state)
{
    (void)state;
    const std::string bytes = cooked_sphere();
    gtx_export_desc desc = {};
    desc.lods = 1;
    desc.threads = 1;
    const std::string one = exported(bytes, desc);
    desc.threads = 3;
    assert_true(exported(bytes, desc) == one);
    assert_true(exported(one, desc) == one); /* of a GLB that holds the asset */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mesh_with_its_textures),
        cmocka_unit_test(any_reader_lights_it_as_the_asset),
        cmocka_unit_test(levels_are_named_by_msft_lod),
        cmocka_unit_test(one_level_is_chosen_by_number_or_error),
        cmocka_unit_test(collision_is_one_closed_mesh),
        cmocka_unit_test(compressed_it_is_the_same),
        cmocka_unit_test(threads_and_copies_change_nothing),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
