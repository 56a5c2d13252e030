/* Cooking as a build step: keys, outputs left alone, strictness, several models, memory. */
#include "common/schema.hpp"

#include "cook/folder.hpp"

#include <sys/stat.h>

/* Two pixels by two, red and blue. */
static const unsigned char red_png[] = {
    0x89, 'P',  'N',  'G',  0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 'I',  'H',  'D',
    'R',  0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd,
    0xd4, 0x9a, 0x73, 0x00, 0x00, 0x00, 0x10, 'I',  'D',  'A',  'T',  0x78, 0x9c, 0x63, 0xf8,
    0xcf, 0xc0, 0x00, 0x44, 0x0c, 0x10, 0x0a, 0x00, 0x1f, 0xee, 0x03, 0xfd, 0x8b, 0x5f, 0x14,
    0xd4, 0x00, 0x00, 0x00, 0x00, 'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};
static const unsigned char blue_png[] = {
    0x89, 'P',  'N',  'G',  0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 'I',  'H',  'D',
    'R',  0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd,
    0xd4, 0x9a, 0x73, 0x00, 0x00, 0x00, 0x0f, 'I',  'D',  'A',  'T',  0x78, 0x9c, 0x63, 0x60,
    0x60, 0xf8, 0x0f, 0x46, 0x60, 0x0a, 0x00, 0x17, 0xf6, 0x03, 0xfd, 0x7e, 0xeb, 0x37, 0xf3,
    0x00, 0x00, 0x00, 0x00, 'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};

static std::string text_of(const unsigned char *bytes, size_t size)
{
    return {reinterpret_cast<const char *>(bytes), size};
}

struct Cooked {
    gtx_result result;
    std::string message, summary;
    schema::json json;
    std::vector<std::string> sources, warnings;
    bool unchanged = false;
};

static Cooked try_cook(const std::string &input, const std::string &output,
                       const gtx_cook_desc &desc)
{
    Cooked out;
    gtx_report report = {};
    gtx_error error = {};
    out.result = gtx_cook_file(input.c_str(), output.c_str(), &desc, &report, &error);
    out.message = error.message;
    if (out.result)
        return out;
    out.json = schema::json::parse(report.json);
    out.summary = report.summary;
    out.sources.assign(report.sources, report.sources + report.source_count);
    out.warnings.assign(report.warnings, report.warnings + report.warning_count);
    out.unchanged = report.unchanged;
    gtx_report_free(&report);
    return out;
}

static Cooked cook(const std::string &input, const std::string &output,
                   const gtx_cook_desc &desc = {})
{
    Cooked out = try_cook(input, output, desc);
    if (out.result)
        fail_msg("%s: %d: %s", input.c_str(), out.result, out.message.c_str());
    return out;
}

/* What META holds. */
static schema::json meta_of(const std::string &path)
{
    gtx_asset *asset = nullptr;
    assert_int_equal(gtx_open_file(path.c_str(), nullptr, &asset, nullptr), GTX_OK);
    size_t size = 0;
    const char *text = gtx_meta(asset, &size);
    schema::json meta = schema::json::parse(std::string(text, size));
    gtx_close(asset);
    return meta;
}

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
    const Change matter[] = {
        [](gtx_cook_desc &d) { d.charts = 9; },      [](gtx_cook_desc &d) { d.resolution = 64; },
        [](gtx_cook_desc &d) { d.height_bits = 16; }, [](gtx_cook_desc &d) { d.dilation = 3; },
        [](gtx_cook_desc &d) { d.mips = 2; },        [](gtx_cook_desc &d) { d.zstd_level = 7; },
        [](gtx_cook_desc &d) { d.zstd_level = -1; }, [](gtx_cook_desc &d) { d.unit = 0.001f; },
        [](gtx_cook_desc &d) { d.z_up = 1; },        [](gtx_cook_desc &d) { d.error = 0.01; },
        [](gtx_cook_desc &d) { d.lod_levels = 2; },
        [](gtx_cook_desc &d) { d.lod_levels = 5; },
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

/* A textured triangle of glTF, or of OBJ: files by their names in a folder. */
using Files = std::map<std::string, std::string>;

static Files gltf_files()
{
    float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1};
    std::string buffer(reinterpret_cast<const char *>(numbers), sizeof numbers);
    return {{"it.gltf",
             R"({"asset": {"version": "2.0"},
                 "buffers": [{"byteLength": 60, "uri": "a%20buffer.bin"}],
                 "bufferViews": [{"buffer": 0, "byteLength": 36},
                                 {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
                 "accessors": [
                     {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                     {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
                 "images": [{"uri": "skin/color.png"}], "textures": [{"source": 0}],
                 "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
                 "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1},
                                             "material": 0}]}],
                 "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})"},
            {"a buffer.bin", buffer},
            {"skin/color.png", text_of(red_png, sizeof red_png)}};
}

static Files obj_files()
{
    return {{"it.obj", "mtllib my library.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\n"
                       "f 1/1 2/1 3/1\n"},
            {"my library.mtl", "newmtl m\nKd 1 1 1\nmap_Kd -s 1 1 1 color.png\n"},
            {"color.png", text_of(red_png, sizeof red_png)}};
}

static void write_files(const std::string &name, const Files &files)
{
    fs::remove_all(in_folder(name.c_str()));
    for (const auto &[file, bytes] : files) {
        fs::path path = folder / name / file;
        fs::create_directories(path.parent_path());
        write_file(path.string(), bytes);
    }
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
        std::vector<std::string> told = cook(input, output).sources, read;
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
    write_file(input, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\n"); /* twice, and open */
    gtx_cook_desc desc = {};
    desc.strict = 1;
    Cooked cooked = try_cook(input, output, desc);
    assert_int_equal(cooked.result, GTX_ERROR_INPUT);
    assert_non_null(strstr(cooked.message.c_str(), "more warning"));
    assert_false(fs::exists(output));
    desc.strict = 0;
    assert_true(cook(input, output, desc).warnings.size() > 1);
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
    gtx_encode_desc encode = {};
    encode.zstd_level = 3;
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
        cmocka_unit_test(each_option_that_matters_changes_the_key),
        cmocka_unit_test(adaptive_cells_are_told),
        cmocka_unit_test(each_source_changes_the_key),
        cmocka_unit_test(the_sources_are_all_that_is_read),
        cmocka_unit_test(other_files_are_not_looked_at),
        cmocka_unit_test(what_was_not_foreseen_is_cooked_again),
        cmocka_unit_test(too_many_names_are_refused),
        cmocka_unit_test(an_unchanged_output_is_left_alone),
        cmocka_unit_test(strict_cooks_refuse_warnings),
        cmocka_unit_test(several_models_become_one_asset),
        cmocka_unit_test(colours_stay_with_their_model),
        cmocka_unit_test(up_turns_every_format),
        cmocka_unit_test(memory_and_file_give_the_same_bytes),
        cmocka_unit_test(the_report_is_right),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
