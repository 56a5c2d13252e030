/* Cooking several models, models that lie on their side and models in memory; the report. */
#include "cook/build.hpp"

static void several_models_become_one_asset(void **)
{
    gtx::Mesh far = shapes::ball(8, shapes::bumps);
    for (gtx::Vec3d &p : far.positions)
        p.x += 10;
    std::string a = small_ball_file(), b = in_folder("far.obj"), output = in_folder("a.gtx");
    write_file(b, obj_text(far));
    const char *more[] = {b.c_str()};
    gtx_cook_desc desc = {};
    desc.more = more;
    desc.more_count = 1;
    Cooked cooked = cook(a, output, desc);
    assert_int_equal(cooked.json["source"]["triangles"], 2 * far.triangle_count());
    assert_true(cooked.sources == (std::vector<std::string>{a, b}));
    gtx_compare_desc compare = {};
    compare.size = 128;
    compare.levels = 1;
    compare.more = more;
    compare.more_count = 1;
    gtx_compare_result figures = {};
    assert_int_equal(
        gtx_compare_files(output.c_str(), a.c_str(), &compare, &figures, nullptr, nullptr), GTX_OK);
    assert_int_equal(figures.hole_pixels, 0);
    assert_true(figures.silhouette_iou > 0.95);

    std::string key = cooked.json["key"];
    more[0] = a.c_str();
    assert_true(cook(b, output, desc).json["key"] != key); /* the order counts */
    std::string bad = in_folder("bad.obj");
    write_file(bad, "v 0 0 0\nf 1 2 3\n");
    more[0] = bad.c_str();
    cooked = try_cook(a, output, desc);
    assert_int_equal(cooked.result, GTX_ERROR_INPUT);
    assert_non_null(strstr(cooked.message.c_str(), "bad.obj: line 2"));
    write_file(bad, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nnonsense 1\n");
    cooked = cook(a, output, desc);
    assert_non_null(strstr(cooked.warnings[0].c_str(), "bad.obj: OBJ statements"));
    more[0] = output.c_str(); /* an output is no source */
    assert_int_equal(try_cook(a, output, desc).result, GTX_ERROR_ARGUMENT);
    more[0] = nullptr;
    assert_int_equal(try_cook(a, output, desc).result, GTX_ERROR_ARGUMENT);
    for (const std::string &path : {b, bad, output})
        fs::remove(path);
}

/* Attributes that only one of the models has. */
static void colours_stay_with_their_model(void **)
{
    std::string a = in_folder("plain.off"), b = in_folder("red.off"), output = in_folder("a.gtx");
    write_file(a, "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    write_file(b, "COFF 3 1 0\n5 0 0 255 0 0\n6 0 0 255 0 0\n5 1 0 255 0 0\n3 0 1 2\n");
    for (bool swapped : {false, true}) {
        const char *more[] = {(swapped ? a : b).c_str()};
        gtx_cook_desc desc = {};
        desc.more = more;
        desc.more_count = 1;
        cook(swapped ? b : a, output, desc);
        gtx_asset *asset = nullptr;
        assert_int_equal(gtx_open_file(output.c_str(), nullptr, &asset, nullptr), GTX_OK);
        gtx_info info;
        gtx_get_info(asset, &info);
        assert_int_equal(info.has_color, 1);
        const auto *color =
            static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_COLOR, 0, nullptr));
        for (uint32_t i = 0; i < info.patch_count; ++i) {
            const gtx_patch &p = gtx_patches(asset)[i];
            uint32_t x = p.rect[0] + p.rect[2] / 4, y = p.rect[1] + p.rect[3] / 4;
            const size_t row = size_t(p.page) * info.page_height + y;
            const uint8_t *c = color + 4 * (row * info.page_width + x);
            bool red = p.sphere[0] + info.anchor[0] > 3;
            assert_int_equal(c[0], 255);
            assert_int_equal(c[1], red ? 0 : 255);
        }
        gtx_close(asset);
    }
    for (const std::string &path : {a, b, output})
        fs::remove(path);
}

static void up_turns_every_format(void **)
{
    const struct {
        const char *name, *text;
    } files[] = {
        {"t.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"},
        {"t.off", "OFF 4 4 0\n0 0 0\n1 0 0\n0 2 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
    };
    std::string output = in_folder("a.gtx");
    for (const auto &file : files) {
        std::string input = in_folder(file.name);
        write_file(input, file.text);
        gtx_cook_desc desc = {};
        desc.z_up = 1;
        cook(input, output, desc);
        gtx_asset *asset = nullptr;
        assert_int_equal(gtx_open_file(output.c_str(), nullptr, &asset, nullptr), GTX_OK);
        gtx_info info;
        gtx_get_info(asset, &info);
        const double low[3] = {0, 0, -2}, high[3] = {1, 3, 0};
        for (int k = 0; k < 3; ++k) {
            assert_true(std::abs(info.bounds_min[k] + info.anchor[k] - low[k]) < 0.2);
            assert_true(std::abs(info.bounds_max[k] + info.anchor[k] - high[k]) < 0.2);
        }
        gtx_close(asset);
        gtx_compare_desc compare = {};
        gtx_compare_result figures = {};
        compare.size = 128;
        compare.z_up = 1;
        assert_int_equal(
            gtx_compare_files(output.c_str(), input.c_str(), &compare, &figures, nullptr, nullptr),
            GTX_OK);
        assert_true(figures.silhouette_iou > 0.9);
        assert_true(meta_of(output)["options"]["up"] == "z");
        fs::remove(input);
    }
    fs::remove(output);
}

static void memory_and_file_give_the_same_bytes(void **)
{
    std::string output = in_folder("a.gtx"), bytes = read_file(small_ball_file());
    Cooked file = cook(small_ball_file(), output);
    gtx_asset *asset = nullptr;
    gtx_report report = {};
    gtx_error error = {};
    if (gtx_cook_memory(bytes.data(), bytes.size(), "any.obj", nullptr, &asset, &report, &error))
        fail_msg("%s", error.message);
    const gtx_encode_desc encode = {};
    void *data = nullptr;
    size_t size = 0;
    assert_int_equal(gtx_encode(asset, &encode, &data, &size, nullptr), GTX_OK);
    assert_true(std::string(static_cast<char *>(data), size) == read_file(output));
    schema::json json = schema::json::parse(report.json);
    assert_int_equal(json["bytes"], size);
    assert_true(json["key"] == file.json["key"]);
    assert_int_equal(report.source_count, 0);
    free(data);
    gtx_close(asset);
    gtx_report_free(&report);

    asset = nullptr;
    assert_int_equal(gtx_cook_memory(bytes.data(), bytes.size(), "any", nullptr, &asset, nullptr,
                                     nullptr), GTX_ERROR_UNSUPPORTED);
    assert_int_equal(gtx_cook_memory(nullptr, 0, "any.obj", nullptr, &asset, nullptr, nullptr),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_cook_memory("", 0, "any.obj", nullptr, &asset, nullptr, nullptr),
                     GTX_ERROR_EMPTY);
    assert_null(asset);
    Files files = gltf_files(); /* what it refers to lies beside its name */
    write_files("here", files);
    std::string name = (folder / "here" / "not there.gltf").string();
    assert_int_equal(gtx_cook_memory(files["it.gltf"].data(), files["it.gltf"].size(), name.c_str(),
                                     nullptr, &asset, &report, nullptr), GTX_OK);
    assert_int_equal(report.source_count, 2);
    gtx_report_free(&report);
    gtx_close(asset);
    fs::remove_all(folder / "here");
    fs::remove(output);
}

/* The figures of the report, counted again. */
static void the_report_is_right(void **)
{
    std::string output = in_folder("a.gtx");
    gtx_cook_desc desc = {};
    desc.height_bits = 16;
    Cooked cooked = cook(small_ball_file(), output, desc);
    gtx_asset *asset = nullptr;
    assert_int_equal(gtx_open_file(output.c_str(), nullptr, &asset, nullptr), GTX_OK);
    gtx_info info;
    gtx_get_info(asset, &info);
    const uint16_t *height =
        static_cast<const uint16_t *>(gtx_map_data(asset, GTX_MAP_HEIGHT, 0, nullptr));
    uint64_t total = 0, empty = 0, triangles = 0;
    for (uint32_t i = 0; i < info.patch_count; ++i) {
        const gtx_patch &p = gtx_patches(asset)[i];
        triangles += p.source_triangles;
        total += uint64_t(p.rect[2]) * p.rect[3];
        for (uint32_t y = 0; y < p.rect[3]; ++y)
            for (uint32_t x = 0; x < p.rect[2]; ++x)
                empty += !height[(size_t(p.page) * info.page_height + p.rect[1] + y) *
                                     info.page_width + p.rect[0] + x];
    }
    const schema::json &json = cooked.json;
    assert_int_equal(json["texels_total"], total);
    assert_int_equal(json["texels_empty"], empty);
    const double share = double(empty) / double(total);
    assert_true(std::abs(json["empty_fraction"].get<double>() - share) < 1e-9);
    double pages = double(info.page_count) * info.page_width * info.page_height;
    assert_true(std::abs(json["page_fill"].get<double>() - double(total) / pages) < 1e-9);
    assert_int_equal(json["charts"], info.patch_count);
    assert_int_equal(json["source"]["triangles"], triangles);
    assert_int_equal(json["source"]["vertices"], 6 * 8 * 8 + 2);
    assert_int_equal(json["bytes"], fs::file_size(output));
    assert_true(std::abs(json["bytes_per_triangle"].get<double>() * double(triangles) -
                         double(fs::file_size(output))) < 1);
    char hash[32];
    snprintf(hash, sizeof hash, "0x%016llx", (unsigned long long)info.content_hash);
    assert_string_equal(json["content_hash"].get<std::string>().c_str(), hash);
    double sum = 0, whole = json["seconds"]["total"];
    for (const auto &[stage, seconds] : json["seconds"].items())
        sum += stage == "total" ? 0 : seconds.get<double>();
    assert_true(sum <= whole && sum > 0.9 * whole);
    gtx_close(asset);
    fs::remove(output);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(several_models_become_one_asset),
        cmocka_unit_test(colours_stay_with_their_model),
        cmocka_unit_test(up_turns_every_format),
        cmocka_unit_test(memory_and_file_give_the_same_bytes),
        cmocka_unit_test(the_report_is_right),
    };
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
