/* gtx bench: what it refuses, and that its report says what was measured and what was not. */
#include "common/schema.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <numeric>

extern "C" {
#include "cli/command.h"
}

using schema::json;

static void usage_is_exit_1(void **)
{
    expect(gtx("bench sphere.gtx"), 1);
    for (const char *wrong : {"--sizes 100", "--sizes 0x10", "--sizes 10x-3", "--sizes 10x10,",
                              "--sizes 99999x10", "--instances 0", "--instances 1,two",
                              "--instances 99999999999", "--methods best", "--methods ''",
                              "--frames 0", "--budget -1", "--min-iou 1.1"})
        expect(gtx("bench sphere.gtx sphere.obj %s", wrong), 1);
    expect(gtx("bench none.gtx sphere.obj"), 2);
    expect(gtx("bench sphere.gtx none.obj"), 2);
    expect(gtx("bench sphere.obj sphere.obj"), 3);
}

/* The report of a run, of the form that is promised. */
static json bench(const char *arguments, const char *asset = "sphere.gtx")
{
    expect(gtx("bench %s sphere.obj --json --frames 2 %s", asset, arguments), 0);
    json report = json::parse(std::string(output));
    const json rules = schema::load("format/bench-report.schema.json");
    const std::string why = schema::broken(report, rules, rules);
    if (!why.empty())
        fail_msg("%s", why.c_str());
    return report;
}

static void every_method_is_measured(void **)
{
    const json report = bench("--sizes 64x48,96x96 --instances 1,5 --methods mesh,mesh_stream,"
                              "simplified,paper,cast,auto,cast_depth,auto_depth,cast_fragment");
    assert_int_equal(report["rows"].size(), 2 * 2 * 9);
    assert_true(report["skipped"].empty());
    double full = 0;
    for (const json &row : report["rows"]) {
        const std::string method = row["method"];
        assert_true(row["ms_median"].get<double>() >= row["ms_min"].get<double>());
        assert_true(row["silhouette_iou"].get<double>() > (method == "paper" ? 0.9 : 0.93));
        if (method == "mesh") {
            assert_true(row["silhouette_iou"].get<double>() == 1);
            assert_true(row["psnr_db"].is_null());
            full = row["triangles"].get<double>();
        }
        if (method == "simplified") {
            assert_true(row["triangles"].get<double>() <= full);
            for (const json &other : report["rows"])
                if (other["method"] == "auto" && other["zoom"] == row["zoom"] &&
                    other["instances"] == row["instances"])
                    assert_true(other["silhouette_iou"] <= row["silhouette_iou"]);
        }
        /* five stand on a wall of three by two */
        if (row["instances"] == 5 && row["zoom"] == "96x96")
            assert_in_range(row["pixels"].get<int>(), 200, 32 * 32);
    }
}

/* As good as by OpenGL, whose picture is the same but for some pixels. */
static void vulkan_stands_beside_opengl(void **)
{
    expect(gtx("render sphere.gtx -o vulkan.png --vulkan --size 9x9") % 5, 0);
    if (!exists("vulkan.png"))
        skip(); /* no Vulkan here */
    const json report =
        bench("--vulkan --sizes 96x96 --methods mesh,paper,cast,cast_fragment,lod,auto,grid");
    assert_int_equal(report["rows"].size(), 1 + 2 * 6);
    for (const json &row : report["rows"])
        for (const json &other : report["rows"])
            if (other["method"] == row["method"].get<std::string>() + "_vulkan") {
                const double apart = other["silhouette_iou"].get<double>() -
                                     row["silhouette_iou"].get<double>();
                assert_true(std::fabs(apart) < 0.005);
                assert_true(std::fabs(other["psnr_db"].get<double>() -
                                      row["psnr_db"].get<double>()) < 1);
                assert_true(other["pixels"].get<int>() > 1000);
            }
    expect(gtx("bench sphere.gtx sphere.obj --vulkan --cells"), 1);
    expect(gtx("bench sphere.gtx sphere.obj --vulkan --random 2"), 1);
    expect(gtx("bench sphere.gtx sphere.obj --methods cast_vulkan"), 1);
}

/* A row for texels, and one for each kind of blocks that the driver reads, which take less; parts
 * are what all takes. */
static void memory_is_measured(void **)
{
    double texels = 0;
    int kinds = 0;
    expect(gtx("bench sphere.gtx none.obj --compress --sizes 64x48"), 0);
    for (const char *row = output; (row = std::strstr(row, "\n| ")); ++row) {
        char name[16];
        double bytes, part[7], mean, p99;
        if (std::sscanf(row, "\n| %15[^|]| %lf | %lf | %lf | %lf | %lf | %lf | %lf | %lf |"
                             "%*[^|]|%*[^|]|%*[^|]| %lf | %lf |", name, &bytes, &part[0], &part[1],
                        &part[2], &part[3], &part[4], &part[5], &part[6], &mean, &p99) != 11)
            continue; /* the head */
        const bool normals = std::strchr(name, ',') != nullptr;
        texels = std::strncmp(name, "texels", 6) ? texels : bytes;
        assert_true(normals ? bytes < texels && p99 > 0 && mean <= p99 : bytes <= texels);
        assert_true(normals || p99 < 0.001);
        assert_true(std::fabs(std::accumulate(part, part + 7, -bytes)) < 0.005);
        ++kinds;
    }
    assert_true(texels > 0 && kinds >= 3);
    for (const char *wrong : {"--json", "--instances 2", "--cells", "--random 2"})
        expect(gtx("bench sphere.gtx sphere.obj --compress %s", wrong), 1);
}

static void the_error_follows_the_outline(void **)
{
    double last = 5;
    for (const char *iou : {"0.5", "0.95", "1"}) {
        const std::string arguments = "--sizes 64x64 --methods mesh,lod,auto --min-iou ";
        const json report = bench((arguments + iou).c_str());
        const json &mesh = report["rows"][0], &row = report["rows"].back();
        const double error = row["max_error_px"];
        assert_false(mesh.contains("max_error_px"));
        assert_true(error <= last);
        assert_true(error == 0.25 || row["silhouette_iou"] >= std::atof(iou));
        last = error;
    }
    assert_true(last == 0.25); /* no picture is the mesh's own */
    const json report = bench("--sizes 64x64 --methods cast --max-error 0.75");
    assert_true(report["rows"][0]["max_error_px"] == 0.75);
}

/* The mesh pays for the same shading, or pictures and times could not be compared. */
static void the_mesh_has_the_materials(void **)
{
    std::ofstream(in_folder("metal.mtl")) << "newmtl metal\nKd 0.8 0.5 0.2\nPr 0.4\nPm 1\n";
    std::ofstream(in_folder("metal.obj")) << "mtllib metal.mtl\nusemtl metal\n"
                                          << std::ifstream(in_folder("sphere.obj")).rdbuf();
    expect(gtx("cook metal.obj -o metal.gtx"), 0);
    expect(gtx("bench metal.gtx metal.obj --json --frames 1 --sizes 96x96 --methods cast"), 0);
    const json report = json::parse(std::string(output));
    assert_true(report["rows"][0]["psnr_db"].get<double>() > 30);
}

/* The outline is what one sample a pixel draws worst, the mesh's own picture included. */
static void pictures_are_held_against_many_samples(void **)
{
    const json report = bench("--sizes 48x48,96x96 --methods mesh,cast --truth");
    double last = 0;
    for (const json &row : report["rows"]) {
        const double truth = row["truth_psnr_db"], inside = row["truth_inside_psnr_db"];
        const double outline = row["truth_outline_share"];
        assert_true(truth > 15 && truth < 30);
        assert_true(inside > truth + 6);
        assert_true(outline > 0.5 && outline < 1);
        if (row["method"] != "mesh")
            continue;
        assert_true(truth > last); /* an outline takes a lesser share of a larger picture */
        last = truth;
    }
    assert_false(bench("--sizes 32x32 --methods mesh")["rows"][0].contains("truth_psnr_db"));
    expect(gtx("bench sphere.gtx sphere.obj --sizes 32x32 --frames 1 --methods mesh --truth"), 0);
    expect_text("| triang. | truth | inside | outline |");
}

static void what_is_not_measured_is_named(void **)
{
    expect(gtx("cook sphere.obj --lod-levels 0 -o bare.gtx"), 0);
    const json no_lod = bench("--sizes 32x32 --methods mesh,lod", "bare.gtx");
    assert_int_equal(no_lod["rows"].size(), 1);
    assert_string_equal(no_lod["skipped"][0]["reason"].get<std::string>().c_str(),
                        "the asset has no LOD mesh");
    const json no_time = bench("--sizes 32x32 --budget 0");
    assert_true(no_time["rows"].empty());
    assert_int_equal(no_time["skipped"].size(), 6);
}

static void the_table_has_a_line_a_row(void **)
{
    expect(gtx("bench sphere.gtx sphere.obj --sizes 32x32 --frames 1 --methods mesh,cast"), 0);
    expect_text("| 32x32     |     1 | mesh ");
    expect_text("| 32x32     |     1 | cast ");
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(usage_is_exit_1), cmocka_unit_test(every_method_is_measured),
        cmocka_unit_test(vulkan_stands_beside_opengl),
        cmocka_unit_test(memory_is_measured),
        cmocka_unit_test(the_error_follows_the_outline),
        cmocka_unit_test(the_mesh_has_the_materials),
        cmocka_unit_test(pictures_are_held_against_many_samples),
        cmocka_unit_test(what_is_not_measured_is_named),
        cmocka_unit_test(the_table_has_a_line_a_row)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
