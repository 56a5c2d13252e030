/* Cooking files: what is written, what is reported, and what is left behind when it fails. */
#include "common/schema.hpp"

#include "cook/folder.hpp"

static void an_asset_comes_out(void **)
{
    std::string output = in_folder("a.gtx");
    gtx_error error = {};
    assert_int_equal(gtx_cook_file(ball_file().c_str(), output.c_str(), nullptr, nullptr, nullptr),
                     GTX_OK);
    gtx_asset *asset = nullptr;
    assert_int_equal(gtx_open_file(output.c_str(), nullptr, &asset, &error), GTX_OK);
    gtx_info info;
    gtx_get_info(asset, &info);
    assert_int_equal(info.source_triangles, 6 * 24 * 24 * 2);
    assert_int_equal(info.mip_count, 4);
    assert_int_equal(info.height_bits, 8);
    assert_true(info.unit == 1);
    assert_true(info.patch_count > 50 && info.patch_count < 400);
    size_t size = 0;
    const char *text = gtx_meta(asset, &size);
    schema::json meta = schema::json::parse(std::string(text, size));
    assert_string_equal(meta["options"]["partition"].get<std::string>().c_str(), "cuts");
    assert_null(strstr(std::string(text, size).c_str(), folder.c_str()));
    gtx_close(asset);
    fs::remove(output);
}

static void options_reach_the_asset(void **)
{
    std::string output = in_folder("b.gtx");
    gtx_cook_desc desc = {};
    desc.charts = 12;
    desc.height_bits = 16;
    desc.mips = 3;
    desc.dilation = 5;
    desc.zstd_level = -1;
    desc.unit = 0.01f;
    cook_ball(output, desc);
    gtx_asset *asset = nullptr;
    assert_int_equal(gtx_open_file(output.c_str(), nullptr, &asset, nullptr), GTX_OK);
    gtx_info info;
    gtx_get_info(asset, &info);
    assert_int_equal(info.mip_count, 3);
    assert_int_equal(info.height_bits, 16);
    assert_true(info.unit == 0.01f);
    assert_true(info.patch_count < 40);
    assert_int_equal(gtx_patches(asset)[0].dilation, 5);
    gtx_close(asset);
    fs::remove(output);
}

/* The error that a file was cooked to keep, and its size. */
static schema::json cook_to(double error, uint32_t threads)
{
    std::string output = in_folder("e.gtx");
    gtx_cook_desc desc = {};
    desc.error = error;
    desc.threads = threads;
    gtx_report report = {};
    cook_ball(output, desc, &report);
    schema::json json = schema::json::parse(report.json);
    gtx_report_free(&report);
    assert_true(json["error"]["requested"] == error);
    assert_true(json["error"]["forward"]["rms"] <= error);
    fs::remove(output);
    return json;
}

static void an_error_is_kept_with_few_bytes(void **)
{
    schema::json coarse = cook_to(1e-3, 2), fine = cook_to(2e-4, 1);
    assert_true(coarse["error"]["forward"]["rms"] > 0.7e-3);
    assert_true(fine["error"]["forward"]["rms"] > 1.4e-4);
    assert_true(coarse["bytes"] < fine["bytes"]);
    assert_true(cook_to(1e-3, 1)["content_hash"] == coarse["content_hash"]);

    gtx_cook_desc desc = {};
    desc.error = 1e-9;
    std::string output = in_folder("e.gtx");
    gtx_error error;
    assert_int_equal(
        gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, nullptr, &error),
        GTX_ERROR_LIMIT);
    assert_non_null(strstr(error.message, "out of reach"));
    assert_false(fs::exists(output));
    desc.error = -1;
    assert_int_equal(
        gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, nullptr, &error),
        GTX_ERROR_ARGUMENT);
    desc.error = 0.01;
    for (gtx_partition partition : {GTX_PARTITION_VSA, GTX_PARTITION_PGP}) {
        desc.partition = partition;
        assert_int_equal(gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, nullptr,
                                       &error), GTX_ERROR_ARGUMENT);
    }
}

static void the_report_follows_its_schema(void **)
{
    std::string output = in_folder("c.gtx");
    schema::json rules = schema::load("format/cook-report.schema.json");
    for (uint32_t measure : {0u, 1u}) {
        gtx_cook_desc desc = {};
        desc.charts = 12;
        desc.measure = measure;
        gtx_report report = {};
        cook_ball(output, desc, &report);
        assert_int_equal(strlen(report.json), report.size);
        schema::json json = schema::json::parse(report.json);
        std::string why = schema::broken(json, rules, rules);
        if (!why.empty())
            fail_msg("%s", why.c_str());
        std::string hash = json["content_hash"];
        assert_true(hash.size() == 18 && strspn(hash.c_str() + 2, "0123456789abcdef") == 16);
        assert_int_equal(json["source"]["triangles"], 6 * 24 * 24 * 2);
        assert_int_equal(json["bytes"], fs::file_size(output));
        assert_int_equal(json["error"]["forward"].is_null(), !measure);
        if (measure)
            assert_true(json["error"]["forward"]["rms"] < 2e-3);
        assert_int_equal(report.source_count, 1);
        assert_string_equal(report.sources[0], ball_file().c_str());
        assert_int_equal(json["warnings"].size() + json["notes"].size(), report.warning_count);
        assert_true(strlen(report.summary) > 20);
        gtx_report_free(&report);
        assert_null(report.json);
        gtx_report_free(&report);
    }
    gtx_report_free(nullptr);
    fs::remove(output);
}

static void any_thread_count_gives_the_same_file(void **)
{
    std::string expected;
    for (uint32_t threads : {1u, 2u, 3u, 7u}) {
        std::string output = in_folder("d.gtx");
        gtx_cook_desc desc = {};
        desc.threads = threads;
        cook_ball(output, desc);
        std::string bytes = read_file(output);
        if (expected.empty())
            expected = bytes;
        assert_true(bytes == expected);
        fs::remove(output);
    }
}

static void wrong_arguments_are_refused(void **)
{
    using Change = void (*)(gtx_cook_desc &);
    const struct {
        gtx_result result;
        Change change;
    } cases[] = {
        {GTX_ERROR_ARGUMENT,
         [](gtx_cook_desc &d) { memset(&d.partition, 77, sizeof d.partition); }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.resolution = 63; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.resolution = 513; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.height_bits = 12; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.dilation = 129; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.mips = 9; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.lod_levels = 6; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.zstd_level = 20; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.zstd_level = -2; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.charts = (1u << 20) + 1; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.threads = 1025; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.unit = -1; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.unit = NAN; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.adaptive = 1; }},
        {GTX_ERROR_ARGUMENT,
         [](gtx_cook_desc &d) { d.adaptive = 1, d.partition = GTX_PARTITION_VSA; }},
        {GTX_ERROR_ARGUMENT,
         [](gtx_cook_desc &d) { d.adaptive = 2, d.partition = GTX_PARTITION_PGP; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.measure = 2; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.z_up = 2; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.strict = 2; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.if_changed = 2; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.more_count = 1; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.kept_count = 1; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.texel_density = -0.5f; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.texel_density = 4.5f; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.texel_density = NAN; }},
        {GTX_ERROR_ARGUMENT, [](gtx_cook_desc &d) { d.closed = 2; }},
        {GTX_ERROR_NOT_ZEROED, [](gtx_cook_desc &d) { d.reserved[0] = 1; }},
    };
    std::string output = in_folder("e.gtx");
    for (const auto &c : cases) {
        gtx_cook_desc desc = {};
        c.change(desc);
        gtx_error error = {};
        assert_int_equal(
            gtx_cook_file(ball_file().c_str(), output.c_str(), &desc, nullptr, &error), c.result);
        assert_int_equal(error.result, c.result);
        assert_true(strlen(error.message) > 5);
    }
    assert_int_equal(gtx_cook_file(nullptr, output.c_str(), nullptr, nullptr, nullptr),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_cook_file(output.c_str(), nullptr, nullptr, nullptr, nullptr),
                     GTX_ERROR_ARGUMENT);
    assert_false(fs::exists(output));
}

static void a_source_is_never_overwritten(void **)
{
    std::string before = read_file(ball_file());
    assert_int_equal(
        gtx_cook_file(ball_file().c_str(), ball_file().c_str(), nullptr, nullptr, nullptr),
        GTX_ERROR_ARGUMENT);
    assert_true(read_file(ball_file()) == before);
}

static void failures_leave_nothing_behind(void **)
{
    std::string output = in_folder("f.gtx"), input = in_folder("bad.obj");
    write_file(output, "what was there before");
    size_t files = files_in_folder() + 1; /* and the input */
    const struct {
        const char *text;
        gtx_result result;
    } cases[] = {
        {"", GTX_ERROR_EMPTY},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\n", GTX_ERROR_EMPTY},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", GTX_ERROR_INPUT},
        {"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", GTX_ERROR_EMPTY},
    };
    for (const auto &c : cases) {
        write_file(input, c.text);
        gtx_error error = {};
        gtx_report report = {};
        gtx_result result =
            gtx_cook_file(input.c_str(), output.c_str(), nullptr, &report, &error);
        if (result != c.result)
            fail_msg("%d, not %d: %s", result, c.result, error.message);
        assert_null(report.json);
        assert_true(read_file(output) == "what was there before");
        assert_int_equal(files_in_folder(), files);
    }
    gtx_error error = {};
    assert_int_equal(
        gtx_cook_file(in_folder("none.obj").c_str(), output.c_str(), nullptr, nullptr, &error),
        GTX_ERROR_READ);
    std::string nowhere = in_folder("no/such/folder.gtx");
    assert_int_equal(
        gtx_cook_file(ball_file().c_str(), nowhere.c_str(), nullptr, nullptr, &error),
        GTX_ERROR_WRITE);
    assert_int_equal(files_in_folder(), files);
    fs::remove(output);
    fs::remove(input);
}

static void a_comparison_measures_the_cook(void **)
{
    std::string output = in_folder("i.gtx");
    gtx_cook_desc cook = {};
    cook.charts = 12;
    cook_ball(output, cook);
    gtx_compare_desc desc = {};
    desc.size = 128;
    desc.levels = 2;
    gtx_compare_result result = {};
    gtx_report report = {};
    gtx_error error = {};
    if (gtx_compare_files(output.c_str(), ball_file().c_str(), &desc, &result, &report, &error))
        fail_msg("%s", error.message);
    schema::json rules = schema::load("format/compare-report.schema.json");
    schema::json json = schema::json::parse(report.json);
    std::string why = schema::broken(json, rules, rules);
    if (!why.empty())
        fail_msg("%s", why.c_str());
    assert_int_equal(json["levels"].size(), 2);
    /* What the runtime draws, down to 16 pixels: coarser and coarser, and without a hole. */
    assert_int_equal(json["details"].size(), 4);
    assert_int_equal(json["details"][3]["size"], 16);
    for (const schema::json &detail : json["details"])
        assert_int_equal(detail["hole_pixels"], 0);
    assert_int_equal(json["details"][0]["surface_pixels"], json["surface_pixels"]);
    assert_int_equal(json["hole_pixels"], result.hole_pixels);
    assert_int_equal(result.hole_pixels, 0);
    assert_true(result.silhouette_iou > 0.98);
    gtx_report_free(&report);

    gtx_compare_result figures = {};
    desc.figures_only = 1;
    if (gtx_compare_files(output.c_str(), ball_file().c_str(), &desc, &figures, &report, &error))
        fail_msg("%s", error.message);
    json = schema::json::parse(report.json);
    assert_string_equal(schema::broken(json, rules, rules).c_str(), "");
    assert_int_equal(json["levels"].size(), 1);
    assert_int_equal(json["details"].size(), 0);
    assert_memory_equal(&figures, &result, sizeof result);
    gtx_report_free(&report);

    desc.levels = 9;
    assert_int_equal(gtx_compare_files(output.c_str(), ball_file().c_str(), &desc, &result,
                                       nullptr, nullptr),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_compare_files(ball_file().c_str(), ball_file().c_str(), nullptr, &result,
                                       nullptr, &error),
                     GTX_ERROR_NOT_GTX);
    assert_int_equal(gtx_compare_files(output.c_str(), in_folder("none.obj").c_str(), nullptr,
                                       nullptr, nullptr, nullptr),
                     GTX_ERROR_READ);
    fs::remove(output);
}

static void a_scan_keeps_its_figures(void **)
{
    const char *models = getenv("GEOTEX_MODELS");
    if (!models || !*models)
        skip();
    std::string input = std::string(models) + "/draco/bunny.drc", output = in_folder("j.gtx");
    gtx_report report = {};
    gtx_error error = {};
    if (gtx_cook_file(input.c_str(), output.c_str(), nullptr, &report, &error))
        fail_msg("%s", error.message);
    schema::json json = schema::json::parse(report.json);
    assert_int_equal(json["source"]["triangles"], 69451);
    assert_int_equal(json["inverted_triangles"], 0);
    assert_true(json["empty_fraction"] < 0.45);
    assert_true(json["page_fill"] > 0.9);
    gtx_report_free(&report);
    fs::remove(output);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(an_asset_comes_out),
        cmocka_unit_test(options_reach_the_asset),
        cmocka_unit_test(an_error_is_kept_with_few_bytes),
        cmocka_unit_test(the_report_follows_its_schema),
        cmocka_unit_test(any_thread_count_gives_the_same_file),
        cmocka_unit_test(wrong_arguments_are_refused),
        cmocka_unit_test(a_source_is_never_overwritten),
        cmocka_unit_test(failures_leave_nothing_behind),
        cmocka_unit_test(a_comparison_measures_the_cook),
        cmocka_unit_test(a_scan_keeps_its_figures),
    };
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
