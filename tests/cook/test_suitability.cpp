/* What a cook says of models that geometry textures are not for, and of what partitions lose. */
#include "common/schema.hpp"

#include "cook/coarse.hpp"
#include "cook/folder.hpp"

struct Told {
    gtx_result result;
    std::set<std::string> warnings;
    schema::json report;
};

static Told cook(const std::string &model, gtx_partition partition, bool strict = false,
                 uint32_t resolution = 0, uint64_t texels = 0)
{
    const std::string output = in_folder("told.gtx");
    gtx_cook_desc desc = {};
    desc.partition = partition;
    desc.strict = strict;
    desc.resolution = resolution;
    desc.limits.texels = texels;
    gtx_report report = {};
    gtx_error error = {};
    Told told = {};
    told.result = gtx_cook_file(model.c_str(), output.c_str(), &desc, &report, &error);
    assert_int_equal(fs::exists(output), told.result == GTX_OK);
    if (told.result)
        return told;
    static const schema::json rules = schema::load("format/cook-report.schema.json");
    told.report = schema::json::parse(report.json);
    const std::string why = schema::broken(told.report, rules, rules);
    if (!why.empty())
        fail_msg("%s", why.c_str());
    for (size_t i = 0; i < report.warning_count; ++i)
        told.warnings.insert(report.warning_names[i]);
    gtx_report_free(&report);
    fs::remove(output);
    return told;
}

static std::string write_model(const char *name, const gtx::Mesh &mesh)
{
    const std::string path = in_folder(name);
    write_file(path, obj_text(mesh));
    return path;
}

static void a_ball_is_suitable(void **)
{
    const Told told = cook(ball_file(), GTX_PARTITION_CUTS, true);
    assert_int_equal(told.result, GTX_OK);
    assert_true(told.warnings.empty());
    const schema::json &said = told.report["suitability"];
    assert_true(said["better"].is_null());
    assert_true(said["triangles_per_patch"] > 16);
    assert_true(said["outline_loss"] < 0.001);
    assert_true(said["unseen_fraction"] == 0);
    assert_true(said["empty_fraction"] == told.report["empty_fraction"]);
}

static void a_box_is_better_drawn_as_a_mesh(void **)
{
    const std::string box = write_model("box.obj", shapes::ball(1, [](const gtx::Vec3d &) {
                                            return 1.;
                                        }));
    const Told told = cook(box, GTX_PARTITION_CUTS);
    assert_int_equal(told.result, GTX_OK);
    assert_true(told.warnings.count("few-triangles"));
    assert_true(told.report["suitability"]["better"] == "mesh");
    assert_true(told.report["suitability"]["triangles_per_patch"] <= 12);
    assert_int_equal(cook(box, GTX_PARTITION_CUTS, true).result, GTX_ERROR_INPUT);
}

/* A ball in a ball. */
static void what_six_views_lose_is_told(void **)
{
    gtx::Mesh nested = shapes::ball(20, shapes::bumps);
    const size_t outer = nested.positions.size();
    const gtx::Mesh inner = shapes::ball(20, shapes::bumps);
    for (const gtx::Vec3d &p : inner.positions)
        nested.positions.push_back(p * 0.5);
    for (auto t : inner.triangles)
        nested.triangles.push_back({uint32_t(t[0] + outer), uint32_t(t[1] + outer),
                                    uint32_t(t[2] + outer)});
    const std::string model = write_model("nested.obj", nested);
    const Told told = cook(model, GTX_PARTITION_RELIEF);
    assert_int_equal(told.result, GTX_OK);
    assert_true(told.warnings.count("unseen-surface"));
    assert_true(told.report["partition"] == "relief");
    assert_true(told.report["charts"] <= 6);
    assert_true(told.report["suitability"]["better"] == "cuts");
    const double lost = told.report["suitability"]["unseen_fraction"];
    assert_true(lost > 0.15 && lost < 0.25);
    assert_int_equal(cook(model, GTX_PARTITION_RELIEF, true).result, GTX_ERROR_INPUT);
    assert_false(cook(model, GTX_PARTITION_CUTS).warnings.count("unseen-surface"));
}

static uint64_t walls_of(const std::string &model, gtx_partition partition)
{
    const std::string output = in_folder("walls.gtx");
    gtx_cook_desc desc = {};
    desc.partition = partition;
    desc.lod_levels = GTX_LOD_LEVELS_NONE;
    assert_int_equal(gtx_cook_file(model.c_str(), output.c_str(), &desc, nullptr, nullptr), GTX_OK);
    gtx_compare_desc compare = {};
    compare.size = 512;
    compare.levels = 1;
    gtx_compare_result result = {};
    assert_int_equal(gtx_compare_files(output.c_str(), model.c_str(), &compare, &result, nullptr,
                                       nullptr), GTX_OK);
    fs::remove(output);
    return result.wall_pixels;
}

/* A tile of thin walls, but not a ball; nor where the resolution is asked for. */
static void auto_takes_finer_layers_for_outlines(void **)
{
    const std::string tile_file = in_folder("tile.obj");
    city_tile().write(tile_file);
    const schema::json cuts = cook(tile_file, GTX_PARTITION_CUTS).report;
    const schema::json taken = cook(tile_file, GTX_PARTITION_AUTO).report;
    assert_true(taken["partition"] == "layers");
    assert_true(taken["suitability"]["taken_for"] == "outlines");
    const double loss = taken["suitability"]["outline_loss"];
    assert_true(taken["resolution"] > 128);
    assert_true(loss < 0.8 * double(cuts["suitability"]["outline_loss"]));
    assert_true(double(taken["texels_total"]) < 2.7 * double(cuts["texels_total"]));
    const uint64_t walls = walls_of(tile_file, GTX_PARTITION_AUTO);
    const uint64_t walls_of_cuts = walls_of(tile_file, GTX_PARTITION_CUTS);
    print_message("# %d wall pixels, with cuts %d\n", int(walls), int(walls_of_cuts));
    assert_true(walls < walls_of_cuts / 2);

    for (const Told &told : {cook(tile_file, GTX_PARTITION_AUTO, false, 128),
                             cook(ball_file(), GTX_PARTITION_AUTO)}) {
        assert_true(told.report["suitability"]["taken_for"].is_null());
        assert_int_equal(told.report["resolution"], 128);
    }
}

/* As auto, but where nobody asks for a density, and what it takes passes no limit. */
static void the_default_takes_them_where_it_may(void **)
{
    const std::string tile_file = in_folder("tile.obj");
    city_tile().write(tile_file);
    const schema::json cuts = cook(tile_file, GTX_PARTITION_CUTS).report;
    const schema::json taken = cook(tile_file, GTX_PARTITION_DEFAULT).report;
    assert_true(taken["suitability"]["taken_for"] == "outlines");
    assert_true(taken["content_hash"] ==
                cook(tile_file, GTX_PARTITION_AUTO).report["content_hash"]);

    const double texels = double(cuts["texels_total"]) / double(cuts["page_fill"]);
    for (const Told &told : {cook(tile_file, GTX_PARTITION_DEFAULT, false, 128),
                             cook(tile_file, GTX_PARTITION_DEFAULT, false, 0,
                                  uint64_t(texels + 1))}) {
        assert_int_equal(told.result, GTX_OK);
        assert_true(told.report["content_hash"] == cuts["content_hash"]);
    }
    assert_true(cook(ball_file(), GTX_PARTITION_DEFAULT).report["content_hash"] ==
                cook(ball_file(), GTX_PARTITION_CUTS).report["content_hash"]);
}

/* A box loses less of its outlines, but its texels are coarse. */
static void a_box_takes_finer_texels(void **)
{
    const std::string box = write_model("coarse_box.obj", shapes::ball(1, [](const gtx::Vec3d &) {
                                            return 1.;
                                        }));
    const schema::json cuts = cook(box, GTX_PARTITION_CUTS).report;
    const schema::json taken = cook(box, GTX_PARTITION_DEFAULT).report;
    assert_true(cuts["suitability"]["outline_loss"] < 0.003);
    assert_true(taken["suitability"]["taken_for"] == "outlines");
    assert_int_equal(taken["resolution"], 256);
}

/* Neither layers nor what auto comes to leave a hole in a closed model. */
static void other_partitions_leave_no_hole(void **)
{
    for (gtx_partition partition : {GTX_PARTITION_LAYERS, GTX_PARTITION_AUTO}) {
        const Told told = cook(ball_file(), partition, true);
        assert_int_equal(told.result, GTX_OK);
        const std::string name = told.report["partition"];
        assert_true(name == "layers" || (partition == GTX_PARTITION_AUTO && name == "cuts"));

        const std::string output = in_folder("closed.gtx");
        gtx_cook_desc desc = {};
        desc.partition = partition;
        cook_ball(output, desc);
        gtx_compare_desc compare = {};
        compare.size = 128;
        compare.levels = 1;
        gtx_compare_result result = {};
        assert_int_equal(gtx_compare_files(output.c_str(), ball_file().c_str(), &compare, &result,
                                           nullptr, nullptr), GTX_OK);
        assert_int_equal(result.hole_pixels, 0);
        assert_true(result.forward_rms < 1e-3);
        fs::remove(output);
    }
}

/* Open, flipped in part, with a NaN, a triangle alone, or nothing: an asset or a refusal. */
static void nasty_models_are_cooked_or_refused(void **)
{
    gtx::Mesh open = shapes::ball(8, shapes::bumps), flipped = open;
    open.triangles.resize(open.triangles.size() / 2);
    for (size_t t = 0; t < flipped.triangles.size(); t += 3)
        std::swap(flipped.triangles[t][0], flipped.triangles[t][1]);
    const std::string good[] = {
        write_model("open.obj", open), write_model("flipped.obj", flipped),
        (write_file(in_folder("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
         in_folder("one.obj")),
        (write_file(in_folder("nan.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\n"
                                          "f 1 2 4\n"),
         in_folder("nan.obj"))};
    const std::string empty = in_folder("empty.obj"), broken = in_folder("broken.obj");
    write_file(empty, "v 0 0 0\n");
    write_file(broken, "f 1 2\x01");
    for (gtx_partition p : {GTX_PARTITION_LAYERS, GTX_PARTITION_RELIEF, GTX_PARTITION_AUTO}) {
        for (const std::string &model : good)
            assert_int_equal(cook(model, p).result, GTX_OK);
        assert_int_equal(cook(empty, p).result, GTX_ERROR_EMPTY);
        assert_true(cook(broken, p).result != GTX_OK);
    }
}

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(a_ball_is_suitable),
                                cmocka_unit_test(a_box_is_better_drawn_as_a_mesh),
                                cmocka_unit_test(what_six_views_lose_is_told),
                                cmocka_unit_test(auto_takes_finer_layers_for_outlines),
                                cmocka_unit_test(the_default_takes_them_where_it_may),
        cmocka_unit_test(a_box_takes_finer_texels),
                                cmocka_unit_test(other_partitions_leave_no_hole),
                                cmocka_unit_test(nasty_models_are_cooked_or_refused)};
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
