/* The asset inside a GLB: it comes back byte by byte, and hostile files do not get through. */
#include "export/exported.hpp"

/* The same document with other JSON, of whatever length. */
static std::string with_json(const std::string &glb, const json &root)
{
    std::string text = root.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const size_t old = 20 + size_t(Glb::word(glb, 12));
    std::string out = glb.substr(0, 12) + std::string(8, 0) + text + glb.substr(old);
    auto put = [&](size_t at, size_t word) {
        for (size_t k = 0; k < 4; ++k)
            out[at + k] = char(word >> (8 * k));
    };
    put(8, out.size());
    put(12, text.size());
    put(16, 0x4e4f534a);
    return out;
}

static gtx_result find(const std::string &bytes, std::string &out)
{
    const void *asset;
    size_t size;
    gtx_error error;
    const gtx_result result = gtx_find_asset(bytes.data(), bytes.size(), &asset, &size, &error);
    if (!result)
        out.assign(static_cast<const char *>(asset), size);
    return result;
}

static void comes_back_byte_by_byte(void **state)
{
    (void)state;
    gtx_cook_desc stored = {};
    stored.zstd_level = -1;
    for (const std::string &bytes : {cooked_sphere(), cooked_sphere(false, stored)}) {
        std::string found;
        assert_int_equal(find(exported(bytes), found), GTX_OK);
        assert_true(found == bytes);
        assert_int_equal(find(bytes, found), GTX_OK);
        assert_true(found == bytes);
    }
}

static void cooking_takes_it_as_it_is(void **state)
{
    (void)state;
    const std::string bytes = cooked_sphere(), glb = exported(bytes);
    assert_true(cooked(glb, "sphere.glb") == bytes);
    gtx_asset *asset = nullptr;
    gtx_cook_desc desc = {};
    desc.resolution = 256;
    assert_int_equal(gtx_cook_memory(glb.data(), glb.size(), "sphere.glb", &desc, &asset, nullptr,
                                     nullptr), GTX_ERROR_ARGUMENT);
    gtx_export_desc without = {};
    without.without_asset = 1;
    const std::string mesh = exported(bytes, without);
    std::string found;
    assert_int_equal(find(mesh, found), GTX_ERROR_EMPTY);
    assert_true(cooked(mesh, "sphere.glb") != bytes); /* a model like any other */
}

static void hostile_documents_are_refused(void **state)
{
    (void)state;
    const std::string glb = exported(cooked_sphere(false));
    const json root = Glb(glb).root;
    const size_t view = root["extensions"]["GTX_geometry_texture"]["assets"][0]["bufferView"];
    struct {
        const char *pointer;
        json value;
        gtx_result wanted;
    } cases[] = {
        {"/extensions/GTX_geometry_texture/assets/0/bufferView", 1000000, GTX_ERROR_INPUT},
        {"/extensions/GTX_geometry_texture/assets/0/bufferView", -1, GTX_ERROR_INPUT},
        {"/extensions/GTX_geometry_texture/assets/0/bufferView", "7", GTX_ERROR_INPUT},
        {"/extensions/GTX_geometry_texture/assets", 3, GTX_ERROR_INPUT},
        {"/extensions/GTX_geometry_texture", json::array(), GTX_ERROR_INPUT},
        {"/extensions", "GTX_geometry_texture", GTX_ERROR_EMPTY},
        {"/extensions/GTX_geometry_texture/assets", json::array(), GTX_ERROR_EMPTY},
        {"/extensions/GTX_geometry_texture/assets/1", json{{"bufferView", view}},
         GTX_ERROR_UNSUPPORTED},
        {"/extensions/GTX_geometry_texture/assets/0", json{{"uri", "a.gtx"}}, GTX_ERROR_EMPTY},
        {"/bufferViews", 1, GTX_ERROR_INPUT},
        {"/buffers/0/uri", "elsewhere.bin", GTX_ERROR_INPUT},
        {"/bufferViews/V/buffer", 1, GTX_ERROR_INPUT},
        {"/bufferViews/V/byteOffset", uint64_t(1) << 63, GTX_ERROR_INPUT},
        {"/bufferViews/V/byteLength", UINT64_MAX, GTX_ERROR_INPUT},
        {"/bufferViews/V/byteLength", 0, GTX_ERROR_INPUT},
        {"/bufferViews/V/byteLength", 1.5, GTX_ERROR_INPUT},
        {"/bufferViews/V/byteOffset", 0, GTX_ERROR_NOT_GTX}, /* within the file, but no asset */
    };
    for (const auto &c : cases) {
        std::string pointer = c.pointer, found;
        if (const size_t at = pointer.find("/V/"); at != pointer.npos)
            pointer.replace(at + 1, 1, std::to_string(view));
        json changed = root;
        changed[json::json_pointer(pointer)] = c.value;
        const gtx_result result = find(with_json(glb, changed), found);
        if (result != c.wanted)
            fail_msg("%s: %s instead of %s", pointer.c_str(), gtx_result_string(result),
                     gtx_result_string(c.wanted));
    }
    json deep = root;
    json *at = &deep["extensions"]["GTX_geometry_texture"]["x"];
    for (int i = 0; i < 200; ++i)
        at = &(*at)["x"];
    std::string found;
    assert_int_equal(find(with_json(glb, deep), found), GTX_ERROR_LIMIT);
}

/* Every length of the file, and every byte of its first part changed: never a fault, and what is
 * found is checked like any asset. */
static void cut_and_changed_files_do_no_harm(void **state)
{
    (void)state;
    const std::string glb = exported(cooked_sphere(false));
    std::string found;
    for (size_t size = 0; size < glb.size(); size += size < 4096 ? 1 : 9973)
        assert_int_not_equal(find(std::string(glb.data(), size), found), GTX_OK);
    for (size_t i = 0; i < 4096; ++i) {
        std::string changed = glb;
        changed[i] = char(changed[i] ^ (1 << i % 8));
        gtx_asset *asset = nullptr;
        if (!find(changed, found))
            gtx_open_memory(found.data(), found.size(), nullptr, &asset, nullptr);
        gtx_close(asset);
    }
    std::string broken = glb;
    const size_t start = glb.find("\xabGTX");
    broken[start + 3000] = char(broken[start + 3000] ^ 1);
    assert_int_equal(find(broken, found), GTX_OK);
    gtx_asset *asset = nullptr;
    assert_int_equal(gtx_cook_memory(broken.data(), broken.size(), "sphere.glb", nullptr, &asset,
                                     nullptr, nullptr), GTX_ERROR_CORRUPT);
}

static void bad_descriptors_are_refused(void **state)
{
    (void)state;
    const std::string bytes = cooked_sphere(false);
    gtx_cook_desc none = {};
    none.lod_levels = GTX_LOD_LEVELS_NONE;
    std::string out;
    gtx_error error;
    assert_int_equal(try_export(cooked_sphere(false, none), {}, out, &error), GTX_ERROR_EMPTY);
    assert_non_null(strstr(error.message, "no LOD mesh"));
    assert_int_equal(try_export("neither", {}, out), GTX_ERROR_NOT_GTX);
    gtx_export_desc desc = {};
    desc.reserved[3] = 1;
    assert_int_equal(try_export(bytes, desc, out), GTX_ERROR_NOT_ZEROED);
    desc = {};
    desc.lods = 2;
    assert_int_equal(try_export(bytes, desc, out), GTX_ERROR_ARGUMENT);
    desc = {};
    desc.max_error = NAN;
    assert_int_equal(try_export(bytes, desc, out), GTX_ERROR_ARGUMENT);
    desc = {};
    desc.level = 1;
    desc.max_error = 0.1;
    assert_int_equal(try_export(bytes, desc, out), GTX_ERROR_ARGUMENT);
    desc = {};
    desc.limits.memory = 1000000;
    assert_int_equal(try_export(bytes, desc, out), GTX_ERROR_LIMIT);
    desc = {};
    desc.progress = [](const gtx_progress *, void *) { return 1; };
    assert_int_equal(try_export(bytes, desc, out), GTX_CANCELLED);
    assert_true(out.empty());
    assert_int_equal(gtx_export_memory(nullptr, 0, nullptr, nullptr, nullptr, nullptr, nullptr),
                     GTX_ERROR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(comes_back_byte_by_byte),
        cmocka_unit_test(cooking_takes_it_as_it_is),
        cmocka_unit_test(hostile_documents_are_refused),
        cmocka_unit_test(cut_and_changed_files_do_no_harm),
        cmocka_unit_test(bad_descriptors_are_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
