/* Cooking as a build step: keys, sources, outputs left alone, strictness. */
#include "cook/build.hpp"

static const gtx_cook_desc few_charts = [] {
    gtx_cook_desc desc = {};
    desc.charts = 6; /* the fewer, the sooner */
    return desc;
}();

static std::string key_of(const std::string &input, const gtx_cook_desc &desc = few_charts)
{
    std::string output = in_folder("key.gtx");
    std::string key = cook(input, output, desc).json["key"];
    assert_true(meta_of(output)["key"] == key);
    fs::remove(output);
    return key;
}

/* A time long ago, which whoever writes the file changes. */
static void age(const std::string &path)
{
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(48));
}

static void adaptive_cells_are_told(void **)
{
    std::string output = in_folder("adaptive.gtx");
    for (uint32_t adaptive : {0u, 1u}) {
        gtx_cook_desc desc = few_charts;
        desc.partition = GTX_PARTITION_PGP;
        desc.adaptive = adaptive;
        cook(small_ball_file(), output, desc);
        assert_true(meta_of(output)["options"].value("adaptive", false) == bool(adaptive));
    }
    fs::remove(output);
}

static void each_option_that_matters_changes_the_key(void **)
{
    using Change = void (*)(gtx_cook_desc &);
    static const double points[] = {1, 2, 3, 4, 5, 6};
    const Change matter[] = {
        [](gtx_cook_desc &d) { d.charts = 9; },      [](gtx_cook_desc &d) { d.resolution = 64; },
        [](gtx_cook_desc &d) { d.height_bits = 16; }, [](gtx_cook_desc &d) { d.dilation = 3; },
        [](gtx_cook_desc &d) { d.mips = 2; },        [](gtx_cook_desc &d) { d.zstd_level = 7; },
        [](gtx_cook_desc &d) { d.zstd_level = -1; }, [](gtx_cook_desc &d) { d.unit = 0.001f; },
        [](gtx_cook_desc &d) { d.z_up = 1; },        [](gtx_cook_desc &d) { d.error = 0.01; },
        [](gtx_cook_desc &d) { d.lod_levels = 2; },  [](gtx_cook_desc &d) { d.closed = 1; },
        [](gtx_cook_desc &d) { d.kept = points, d.kept_count = 1; },
        [](gtx_cook_desc &d) { d.kept = points, d.kept_count = 2; },
        [](gtx_cook_desc &d) { d.lod_levels = GTX_LOD_LEVELS_NONE; },
        [](gtx_cook_desc &d) { d.texel_density = 1; },
        [](gtx_cook_desc &d) { d.texel_density = 1e-7f; },
        [](gtx_cook_desc &d) { d.texel_density = GTX_TEXEL_DENSITY_RELIEF; },
        [](gtx_cook_desc &d) { d.partition = GTX_PARTITION_VSA; },
        [](gtx_cook_desc &d) { d.partition = GTX_PARTITION_PGP; },
        [](gtx_cook_desc &d) { d.partition = GTX_PARTITION_PGP, d.adaptive = 1; }};
    std::set<std::string> keys = {key_of(small_ball_file())};
    for (Change change : matter) {
        gtx_cook_desc desc = few_charts;
        change(desc);
        assert_true(keys.insert(key_of(small_ball_file(), desc)).second);
    }
    static std::string ply;
    ply = in_folder("charts.ply");
    const Change indifferent[] = {
        [](gtx_cook_desc &d) { d.threads = 3; },     [](gtx_cook_desc &d) { d.measure = 1; },
        [](gtx_cook_desc &d) { d.strict = 1; },      [](gtx_cook_desc &d) { d.if_changed = 1; },
        [](gtx_cook_desc &d) { d.charts_ply = ply.c_str(); },
        [](gtx_cook_desc &d) { d.partition = GTX_PARTITION_CUTS; }};
    std::string key = key_of(small_ball_file());
    for (Change change : indifferent) {
        gtx_cook_desc desc = few_charts;
        change(desc);
        assert_string_equal(key_of(small_ball_file(), desc).c_str(), key.c_str());
    }
    fs::remove(ply);
}

static void each_source_changes_the_key(void **)
{
    for (const Files &files : {gltf_files(), obj_files()}) {
        std::string model = files.count("it.obj") ? "it.obj" : "it.gltf";
        write_files("here", files);
        std::string input = (folder / "here" / model).string(), key = key_of(input);
        std::set<std::string> keys = {key};
        for (const auto &[name, bytes] : files) {
            Files other = files;
            if (name.find(".png") != name.npos)
                other[name] = text_of(blue_png, sizeof blue_png);
            else if (name.find(".bin") != name.npos)
                other[name][14] ^= 1;
            else
                other[name] += "\n";
            write_files("here", other);
            assert_true(keys.insert(key_of(input)).second);
            if (name != model && name.find(".bin") == name.npos) { /* a model does without */
                other.erase(name);
                write_files("here", other);
                assert_true(keys.insert(key_of(input)).second);
            }
        }
        write_files("here", files);
        for (const auto &[name, bytes] : files)
            age((folder / "here" / name).string());
        assert_string_equal(key_of(input).c_str(), key.c_str());
        write_files("there", files);
        assert_string_equal(key_of((folder / "there" / model).string()).c_str(), key.c_str());
    }
    fs::remove_all(folder / "here");
    fs::remove_all(folder / "there");
}

static void too_many_names_are_refused(void **)
{
    std::string input = in_folder("names.obj"), text, output = in_folder("a.gtx");
    for (int i = 0; i < 5000; ++i) {
        text += "mtllib";
        for (int k = 0; k < 20; ++k)
            text += " " + std::to_string(i) + "." + std::to_string(k);
        text += "\n";
    }
    write_file(input, text + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_int_equal(try_cook(input, output, {}).result, GTX_ERROR_LIMIT);
    fs::remove(input);
}

/* Whatever an importer reads has to be found without it: the key would miss it. */
static void the_sources_are_all_that_is_read(void **)
{
    for (const Files &files : {gltf_files(), obj_files()}) {
        std::string model = files.count("it.obj") ? "it.obj" : "it.gltf";
        write_files("here", files);
        std::string input = (folder / "here" / model).string(), output = in_folder("a.gtx");
        std::vector<std::string> told = cook(input, output).sources;
        gtx::Vector<std::string> read;
        assert_string_equal(told[0].c_str(), input.c_str());
        assert_int_equal(told.size(), files.size());
        gtx::Task task(1, nullptr, nullptr);
        gtx::import_mesh(input, task, &read);
        for (const std::string &path : read)
            assert_true(std::find(told.begin(), told.end(), path) != told.end());
        fs::remove(output);
    }
    fs::remove_all(folder / "here");
}

/* Where a name is written so that it is only found by importing, nothing is ever skipped. */
static void what_was_not_foreseen_is_cooked_again(void **)
{
    Files files = obj_files();
    files["it.obj"].replace(0, 7, "mtllib \\\n");
    write_files("here", files);
    std::string input = (folder / "here" / "it.obj").string(), output = in_folder("a.gtx");
    gtx_cook_desc desc = few_charts;
    desc.if_changed = 1;
    for (int i = 0; i < 2; ++i) {
        Cooked cooked = cook(input, output, desc);
        assert_false(cooked.unchanged);
        assert_int_equal(cooked.sources.size(), 3);
    }
    fs::remove(output);
    files = obj_files();
    files["my library.mtl"] = "newmtl m\nmap_Kd skin\\my color.png\n";
    files["skin/my color.png"] = files["color.png"];
    files.erase("color.png");
    write_files("here", files);
    assert_int_equal(cook(input, output, desc).sources.size(), 3);
    assert_true(cook(input, output, desc).unchanged);
    fs::remove(output);
    fs::remove_all(folder / "here");
}

/* A name out of a model must not lead out of its folder, not even to be hashed. */
static void other_files_are_not_looked_at(void **)
{
    Files files = obj_files();
    write_file(in_folder("outside.png"), "secret");
    files["my library.mtl"] = "newmtl m\nmap_Kd ../outside.png\nmap_Ks " +
                              in_folder("outside.png") + "\nmap_Ka /dev/zero\n";
    write_files("here", files);
    std::string output = in_folder("a.gtx");
    assert_int_equal(cook((folder / "here" / "it.obj").string(), output).sources.size(), 2);
    fs::remove(output);
    fs::remove(in_folder("outside.png"));
    fs::remove_all(folder / "here");
}

static void an_unchanged_output_is_left_alone(void **)
{
    std::string input = in_folder("in.obj"), output = in_folder("a.gtx");
    schema::json rules = schema::load("format/cook-report.schema.json");
    write_file(input, read_file(small_ball_file()));
    gtx_cook_desc desc = few_charts;
    desc.if_changed = 1;
    Cooked first = cook(input, output, desc);
    assert_false(first.unchanged);
    assert_false(first.json["unchanged"].get<bool>());
    std::string bytes = read_file(output);

    auto cooks = [&](bool wanted) {
        age(output);
        auto before = fs::last_write_time(output);
        Cooked again = cook(input, output, desc);
        assert_int_equal(again.unchanged, !wanted);
        assert_int_equal(again.json["unchanged"].get<bool>(), !wanted);
        assert_int_equal(fs::last_write_time(output) == before, !wanted);
        std::string why = schema::broken(again.json, rules, rules);
        if (!why.empty())
            fail_msg("%s", why.c_str());
        for (const char *same : {"key", "content_hash", "bytes", "charts"})
            if (!wanted)
                assert_true(again.json[same] == first.json[same]);
        assert_true(again.sources == first.sources);
        return first = again;
    };
    assert_string_equal(cooks(false).summary.c_str(), "unchanged");
    age(input);
    cooks(false);
    desc.threads = 2;
    cooks(false);
    write_file(input, read_file(small_ball_file()) + "# a comment\n");
    cooks(true);
    cooks(false);
    write_file(input, read_file(small_ball_file()));
    cooks(true);
    assert_true(read_file(output) == bytes);

    write_file(output, bytes.substr(0, bytes.size() - 64)); /* cut */
    cooks(true);
    std::string flipped = bytes;
    flipped[flipped.size() / 2] ^= 1;
    write_file(output, flipped);
    cooks(true);
    write_file(output, "something else");
    cooks(true);
    std::string ply = in_folder("charts.ply");
    desc.charts_ply = ply.c_str(); /* which only cooking can write */
    cooks(true);
    assert_true(fs::exists(ply));
    desc.charts_ply = nullptr;
    desc.if_changed = 0;
    cooks(true);
    for (const std::string &path : {input, output, ply})
        fs::remove(path);
}

static void strict_cooks_refuse_warnings(void **)
{
    std::string input = in_folder("open.obj"), output = in_folder("a.gtx");
    write_file(input, "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv nan 0 0\n"
                      "f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 6\n"); /* 3 on an edge, few, open */
    gtx_cook_desc desc = {};
    desc.strict = 1;
    Cooked cooked = try_cook(input, output, desc);
    assert_int_equal(cooked.result, GTX_ERROR_INPUT);
    assert_non_null(strstr(cooked.message.c_str(), "(non-finite, and 1 more warning"));
    assert_false(fs::exists(output));
    desc.strict = 0;
    Cooked warned = cook(input, output, desc);
    assert_true(warned.warnings.size() > 1);
    assert_true(warned.names.size() == warned.warnings.size());
    schema::json names = warned.json["warning_names"];
    assert_true(names.size() > 1 && warned.json["note_names"] == schema::json({"open-edges"}));
    names.push_back("open-edges"); /* notes come last */
    assert_true(names == schema::json(warned.names));
    schema::json rules = schema::load("format/cook-report.schema.json");
    assert_string_equal(schema::broken(warned.json, rules, rules).c_str(), "");
    desc.if_changed = 1;
    assert_true(cook(input, output, desc).unchanged);
    desc.strict = 1; /* an asset with warnings does not count as done */
    assert_int_equal(try_cook(input, output, desc).result, GTX_ERROR_INPUT);
    assert_true(fs::exists(output));
    assert_int_equal(try_cook(small_ball_file(), output, desc).result, GTX_OK);
    assert_true(cook(small_ball_file(), output, desc).unchanged);
    fs::remove(input);
    fs::remove(output);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(each_option_that_matters_changes_the_key),
        cmocka_unit_test(adaptive_cells_are_told),
        cmocka_unit_test(each_source_changes_the_key),
        cmocka_unit_test(the_sources_are_all_that_is_read),
        cmocka_unit_test(other_files_are_not_looked_at),
        cmocka_unit_test(what_was_not_foreseen_is_cooked_again),
        cmocka_unit_test(too_many_names_are_refused),
        cmocka_unit_test(an_unchanged_output_is_left_alone),
        cmocka_unit_test(strict_cooks_refuse_warnings),
    };
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
