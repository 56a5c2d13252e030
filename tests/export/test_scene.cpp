/* Scenes of many meshes: what suits becomes assets in its place, the rest stays as it was. */
#include <filesystem>
#include <fstream>
#include <sstream>

#include "export/exported.hpp"

namespace fs = std::filesystem;

static fs::path folder;

/* Arrays one behind another in one buffer, and one view of all of them. */
struct SceneMaker {
    json root = {{"asset", {{"version", "2.0"}}}};
    std::string binary;

    size_t floats(const std::vector<float> &values, const char *type, size_t width)
    {
        return accessor(std::string(reinterpret_cast<const char *>(values.data()),
                                    4 * values.size()), 5126, values.size() / width, type);
    }
    size_t indices(const std::vector<uint32_t> &values)
    {
        return accessor(std::string(reinterpret_cast<const char *>(values.data()),
                                    4 * values.size()), 5125, values.size(), "SCALAR");
    }
    size_t accessor(const std::string &bytes, int component, size_t count, const char *type)
    {
        root["accessors"].push_back({{"bufferView", 0}, {"byteOffset", binary.size()},
                                     {"componentType", component}, {"count", count},
                                     {"type", type}});
        binary += bytes;
        return root["accessors"].size() - 1;
    }
    std::string bytes()
    {
        json out = root;
        out["bufferViews"] = json::array({{{"buffer", 0}, {"byteLength", binary.size()}}});
        out["buffers"] = json::array({{{"byteLength", binary.size()}}});
        std::string text = out.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string glb = "glTF";
        for (size_t word : {size_t(2), 28 + text.size() + binary.size(), text.size(),
                            size_t(0x4e4f534a)})
            put(glb, word);
        glb += text;
        put(glb, binary.size());
        put(glb, 0x004e4942);
        return glb + binary;
    }
    static void put(std::string &to, size_t word)
    {
        for (int k = 0; k < 4; ++k)
            to += char(word >> (8 * k));
    }
};

/* A sphere far from its mesh's origin, in two places; a quad; a sphere that is blended. */
static SceneMaker scene()
{
    std::vector<float> place;
    std::vector<uint32_t> corners;
    std::istringstream obj(sphere_obj(60, false));
    for (std::string key; obj >> key;) {
        float p[3];
        uint32_t f[3];
        if (key == "v" && obj >> p[0] >> p[1] >> p[2])
            place.insert(place.end(), {p[0] + 100, p[1], p[2]});
        if (key == "f" && obj >> f[0] >> f[1] >> f[2])
            corners.insert(corners.end(), {f[0] - 1, f[1] - 1, f[2] - 1});
    }
    SceneMaker made;
    const size_t sphere = made.floats(place, "VEC3", 3), triangles = made.indices(corners);
    const size_t quad = made.floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3", 3);
    const size_t two = made.indices({0, 1, 2, 0, 2, 3});
    made.root["accessors"][quad].update({{"min", {0, 0, 0}}, {"max", {1, 1, 0}}});
    json &root = made.root;
    root["materials"] = json::array({{{"name", "steel"}},
                                     {{"name", "clear"}, {"alphaMode", "BLEND"}},
                                     {{"name", "paint"}}});
    auto mesh = [](const char *name, size_t at, size_t indices, size_t material) {
        return json{{"name", name},
                    {"primitives", json::array({{{"attributes", {{"POSITION", at}}},
                                                 {"indices", indices}, {"material", material}}})}};
    };
    root["meshes"] = {mesh("Ball / bumpy", sphere, triangles, 0), mesh("quad", quad, two, 2),
                      mesh("glass", sphere, triangles, 1)};
    root["nodes"] = {{{"name", "root"}, {"children", {1, 2, 3}}},
                     {{"name", "a"}, {"mesh", 0}, {"translation", {1, 2, 3}}},
                     {{"name", "b"}, {"mesh", 0}, {"scale", {2, 2, 2}}, {"children", {4}}},
                     {{"name", "floor"}, {"mesh", 1}},
                     {{"name", "window"}, {"mesh", 2}}};
    root["scenes"] = json::array({{{"nodes", {0}}}});
    root["cameras"] = json::array({{{"type", "perspective"}}});
    return made;
}

static std::string written(const char *name, const std::string &bytes)
{
    const fs::path path = folder / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return path.string();
}

static std::string contents(const fs::path &path)
{
    std::ifstream file(path, std::ios::binary);
    std::ostringstream out;
    out << file.rdbuf();
    return out.str();
}

static gtx_result cook_scene(const std::string &input, const fs::path &out, json *report = nullptr,
                             const gtx_cook_desc &desc = {})
{
    gtx_report made = {};
    gtx_error error = {};
    const gtx_result result =
        gtx_cook_scene(input.c_str(), out.string().c_str(), &desc, &made, &error);
    if (!result && report)
        *report = json::parse(made.json);
    gtx_report_free(&made);
    return result;
}

static void what_suits_becomes_assets(void **state)
{
    (void)state;
    SceneMaker made = scene();
    const std::string bytes = made.bytes(), input = written("scene.glb", bytes);
    json report;
    const fs::path out = folder / "out";
    assert_int_equal(cook_scene(input, out, &report), GTX_OK);
    assert_true(report["meshes"][0]["asset"] == "0-Ball-bumpy.gtx");
    assert_true(report["meshes"][0]["nodes"] == 2);
    assert_true(report["meshes"][1]["kept"].get<std::string>().find("triangles a patch") !=
                std::string::npos);
    assert_true(report["meshes"][2]["kept"] == "it is blended");

    gtx_asset *asset = nullptr;
    assert_int_equal(gtx_open_file((out / "0-Ball-bumpy.gtx").string().c_str(), nullptr, &asset,
                                   nullptr), GTX_OK);
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx_close(asset);
    assert_int_equal(info.source_triangles, made.root["accessors"][1]["count"].get<size_t>() / 3);

    const std::string scene_bytes = contents(out / "scene.glb");
    const Glb glb(scene_bytes);
    const json &root = glb.root;
    assert_int_equal(root["nodes"].size(), 7); /* and a child for either place */
    for (size_t i = 0; i < 5; ++i)
        assert_true(root["nodes"][i]["name"] == made.root["nodes"][i]["name"]);
    assert_true(root["extensions"]["GTX_geometry_texture"]["assets"] ==
                json::array({{{"uri", "0-Ball-bumpy.gtx"}}}));
    for (size_t i : {1, 2}) {
        const json &node = root["nodes"][i];
        assert_false(node.contains("mesh"));
        const json &child = root["nodes"][node["children"].back().get<size_t>()];
        assert_true(child["extensions"]["GTX_geometry_texture"]["asset"] == 0);
        for (size_t k = 0; k < 3; ++k) /* anchor at the node's origin */
            assert_true(child["translation"][k].get<double>() == info.anchor[k]);
    }
    assert_true(info.anchor[0] > 90);
    assert_true(root["nodes"][2]["children"][0] == 4 && root["cameras"].size() == 1);
    assert_int_equal(root["meshes"].size(), 2); /* the quad's and the glass's data are as before */
    const json &quad = root["meshes"][root["nodes"][3]["mesh"].get<size_t>()];
    assert_true(quad["name"] == "quad");
    const auto place = glb.floats(quad["primitives"][0]["attributes"]["POSITION"]);
    assert_true(place == std::vector<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}));
    const json &paint = root["materials"][quad["primitives"][0]["material"].get<size_t>()];
    assert_true(paint["name"] == "paint" && root["materials"].size() == 2);

    assert_int_equal(cook_scene(input, folder / "again"), GTX_OK); /* the same bytes again */
    assert_true(contents(folder / "again" / "scene.glb") == scene_bytes);
}

/* Without the blended one nothing needs the sphere's arrays any more. */
static void what_nothing_needs_is_left_out(void **state)
{
    (void)state;
    SceneMaker made = scene();
    made.root["nodes"][4].erase("mesh");
    const std::string bytes = made.bytes(), input = written("lean.glb", bytes);
    assert_int_equal(cook_scene(input, folder / "lean"), GTX_OK);
    assert_true(fs::file_size(folder / "lean" / "lean.glb") < bytes.size() / 50);
    made.root["extensionsUsed"] = {"ACME_mystery"}; /* which may refer to anything */
    const std::string other = written("mystery.glb", made.bytes());
    assert_int_equal(cook_scene(other, folder / "mystery"), GTX_OK);
    assert_true(fs::file_size(folder / "mystery" / "mystery.glb") > bytes.size() * 9 / 10);
}

static void hostile_scenes_are_refused(void **state)
{
    (void)state;
    const struct {
        const char *pointer;
        json value;
    } cases[] = {
        {"/nodes/3/mesh", 17},
        {"/meshes/1/primitives/0/indices", 99},
        {"/meshes/1/primitives/0/material", 7},
        {"/accessors/2/bufferView", 5},
        {"/meshes/1/name", 3},
        {"/meshes/2/primitives", {{"a", 1}}},
        {"/nodes", 12},
    };
    for (const auto &c : cases) {
        SceneMaker made = scene();
        made.root[json::json_pointer(c.pointer)] = c.value;
        const std::string input = written("bad.glb", made.bytes());
        const gtx_result result = cook_scene(input, folder / "bad");
        if (result != GTX_ERROR_INPUT)
            fail_msg("%s: %s", c.pointer, gtx_result_string(result));
        assert_false(fs::exists(folder / "bad" / "bad.glb"));
    }
    const std::string whole = scene().bytes();
    for (size_t size = 4; size < whole.size(); size += size < 4096 ? 97 : 99991)
        assert_int_not_equal(cook_scene(written("cut.glb", whole.substr(0, size)), folder / "cut"),
                             GTX_OK);
}

static void inputs_are_not_written_over(void **state)
{
    (void)state;
    fs::create_directories(folder / "same");
    const std::string bytes = scene().bytes(), input = written("same/scene.glb", bytes);
    assert_int_equal(cook_scene(input, folder / "same"), GTX_ERROR_ARGUMENT);
    assert_true(contents(input) == bytes && !fs::exists(folder / "same" / "0-Ball-bumpy.gtx"));
    const std::string file = written("file", "x");
    assert_int_equal(cook_scene(input, file), GTX_ERROR_WRITE);
    gtx_cook_desc desc = {};
    desc.strict = 1;
    assert_int_equal(cook_scene(input, folder / "x", nullptr, desc), GTX_ERROR_ARGUMENT);
    assert_int_equal(cook_scene(written("a.obj", sphere_obj(10, false)), folder / "x"),
                     GTX_ERROR_UNSUPPORTED);
    desc = {};
    desc.progress = [](const gtx_progress *p, void *) { return int(p->fraction > 0.3f); };
    assert_int_equal(cook_scene(input, folder / "x", nullptr, desc), GTX_CANCELLED);
    assert_false(fs::exists(folder / "x" / "scene.glb"));
}

static int set_up(void **state)
{
    (void)state;
    char name[] = "/tmp/gtx-scene-XXXXXX";
    if (!mkdtemp(name))
        return 1;
    folder = name;
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    fs::remove_all(folder);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_suits_becomes_assets),
        cmocka_unit_test(what_nothing_needs_is_left_out),
        cmocka_unit_test(hostile_scenes_are_refused),
        cmocka_unit_test(inputs_are_not_written_over),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
