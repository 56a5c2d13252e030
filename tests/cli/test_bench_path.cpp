/* gtx bench --path, --random: what is refused, where the views are, and what is compared there. */
#include "common/schema.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>

extern "C" {
#include "cli/command.h"
}

using schema::json;

static void write_text(const char *name, const std::string &text)
{
    write_file(name, text.data(), text.size());
}

static void what_does_not_fit_is_refused(void **)
{
    write_text("one.path", "0 0 3  0 0 0\n");
    for (const char *wrong :
         {"--path one.path --random 3", "--path one.path --instances 2", "--random 0",
          "--random 3 --min-iou 0.9", "--random 3 --repeats 0", "--random 3 --seed -1",
          "--random 3 --methods mesh,mesh_stream", "--methods floor"})
        expect(gtx("bench sphere.gtx sphere.obj --sizes 16x16 %s", wrong), 1);
    expect(gtx("bench sphere.gtx sphere.obj --path none.path"), 2);
    expect_text("none.path: ");
    const std::string head = "# a comment\n\n";
    for (const char *wrong :
         {"1 2 3 4 5", "1 2 3 4 5 6 7", "1 2 3 4 5 x", "1 2 3 4 5 nan", "1 2 3 4 5 1e300",
          "1 2 3 1 2 3", "up 0 0 0", "up 0 1", "fov 0.5", "fov 171", "fov", "key 1 2 3 4 5",
          "0 0 3 0 0 0 up"}) {
        write_text("bad.path", head + wrong + "\n");
        expect(gtx("bench sphere.gtx sphere.obj --path bad.path"), 3);
        expect_text("bad.path: error[input]: line 3: ");
    }
    write_text("bad.path", "0 0 3  0 0 0\nfov 60\n");
    expect(gtx("bench sphere.gtx sphere.obj --path bad.path"), 3);
    expect_text("line 2: 'up' and 'fov' come before the first key");
    write_text("bad.path", std::string("0 0 3 0 0 \0", 11));
    expect(gtx("bench sphere.gtx sphere.obj --path bad.path"), 3);
    write_text("bad.path", head);
    expect(gtx("bench sphere.gtx sphere.obj --path bad.path"), 3);
    expect_text("the path has no key");
    write_text("bad.path", "0 0 3  0 0 0\n0 0 -3  0 0 0\n0 0 0  0 0 3");
    expect(gtx("bench sphere.gtx sphere.obj --path bad.path --frames 5"), 3);
    expect_text("between two keys the eye looks at itself");
    write_text("bad.path", std::string(100000, '#'));
    expect(gtx("bench sphere.gtx sphere.obj --path bad.path --max-memory 50k"), 6);
    std::string many;
    for (int i = 0; i <= 100000; ++i)
        many += "0 0 3 0 0 0\n";
    write_text("bad.path", many);
    expect(gtx("bench sphere.gtx sphere.obj --path bad.path"), 3);
    expect_text("line 100001: more than 100000 keys");
}

/* The entry of the only window, of the form that is promised. */
static json along(const char *asset, const char *model, const std::string &arguments)
{
    expect(gtx("bench %s %s -q --json --sizes 64x48 --repeats 1 %s", asset, model,
               arguments.c_str()), 0);
    const json report = json::parse(std::string(output));
    const json rules = schema::load("format/bench-report.schema.json");
    const std::string why = schema::broken(report, rules, rules);
    if (!why.empty())
        fail_msg("%s", why.c_str());
    assert_int_equal(report["paths"].size(), 1);
    return report["paths"][0];
}

static const json &cell(const json &view, const char *method)
{
    for (const json &c : view["methods"])
        if (c["method"] == method)
            return c;
    fail_msg("%s was not measured", method);
    return view;
}

static double distance(const json &a, const json &b)
{
    double square = 0;
    for (int k = 0; k < 3; ++k)
        square += std::pow(a[k].get<double>() - b[k].get<double>(), 2);
    return std::sqrt(square);
}

static void keys_are_views_and_what_is_between_them(void **)
{
    write_text("line.path", "up 0 0 2 # any length\nfov 60\n\n"
                            "0 0 3  0 0 0 # front\r\n\t0.5e1 0 3  0 1 0\n5 8 3 0 1 0");
    const json keys = along("sphere.gtx", "sphere.obj", "--path line.path --methods mesh,auto");
    assert_int_equal(keys["views"].size(), 3);
    assert_true(keys["up"] == json({0, 0, 1}) && keys["fov_degrees"] == 60);
    assert_true(keys["views"][1]["eye"] == json({5, 0, 3}));
    const json spread =
        along("sphere.gtx", "sphere.obj", "--path line.path --methods mesh,auto --frames 9");
    assert_int_equal(spread["views"].size(), 9);
    assert_true(spread["views"][0]["eye"] == json({0, 0, 3}));
    assert_true(spread["views"][1]["eye"] == json({1.25, 0, 3}));
    assert_true(spread["views"][1]["target"] == json({0, 0.25, 0}));
    assert_true(spread["views"][6]["eye"] == json({5, 4, 3}));
    assert_true(spread["views"][8]["eye"] == json({5, 8, 3}));
    const json none = along("sphere.gtx", "sphere.obj", "--path line.path --budget 0");
    assert_true(none["views"].empty() && none["views_wanted"] == 3);
}

static void views_are_held_against_many_samples(void **)
{
    write_text("two.path", "0 0 3  0 0 0\n0 0 4  0 0 0\n");
    const json path =
        along("sphere.gtx", "sphere.obj", "--path two.path --methods mesh,cast --truth");
    for (size_t m = 0; m < 2; ++m) {
        const double all = path["rows"][m]["truth_psnr_db"];
        double low = 1e9, high = 0;
        for (const json &view : path["views"]) {
            low = std::min<double>(low, view["methods"][m]["truth_psnr_db"]);
            high = std::max<double>(high, view["methods"][m]["truth_psnr_db"]);
        }
        assert_true(low > 15 && low <= all && all <= high);
    }
}

/* The sphere has a radius of about one and is centred on the origin. */
static void random_views_are_a_third_each_and_the_same_again(void **)
{
    const json first = along("sphere.gtx", "sphere.obj", "--random 30 --methods mesh,cast");
    const json again = along("sphere.gtx", "sphere.obj", "--random 30 --seed 1 --methods mesh");
    const json other = along("sphere.gtx", "sphere.obj", "--random 30 --seed 2 --methods mesh");
    const json middle = {0, 0, 0};
    std::set<json> eyes;
    for (size_t i = 0; i < 30; ++i) {
        const json &view = first["views"][i];
        assert_true(view["eye"] == again["views"][i]["eye"]);
        assert_true(view["target"] == again["views"][i]["target"]);
        assert_true(view["eye"] != other["views"][i]["eye"]);
        eyes.insert(view["eye"]);
        const double radii = distance(view["eye"], middle) / std::sqrt(3);
        if (i % 3 == 0)
            assert_true(radii > 0.58 && radii < 3.2);
        if (i % 3 == 1) /* 0.2 to 2 % of the diagonal above radii of 0.97 to 1.03 */
            assert_true(radii > 0.97 / std::sqrt(3) && radii < 1.12 / std::sqrt(3));
        if (i % 3 == 2)
            assert_true(radii < 1.05);
    }
    assert_int_equal(eyes.size(), 30);
}

/* What rays of a method look at: cells a ray, of any ray the most, and slabs. */
struct Counts {
    unsigned long long rays;
    double cells, slabs;
    unsigned most;
};

static Counts counted(const char *method, const char *where)
{
    char window[16], name[32];
    Counts c;
    unsigned view, most_slabs;
    double fragments;
    expect(gtx("bench sphere.gtx none.obj --cells --sizes 64x48 --methods %s %s", method, where),
           0);
    const char *row = std::strstr(output, "| 64x48");
    if (!row || std::sscanf(row, "| %15s | %31s | %llu | %lf | %lf | %u | %u | %lf | %u |", window,
                            name, &c.rays, &fragments, &c.cells, &c.most, &view, &c.slabs,
                            &most_slabs) != 9)
        fail_msg("no counts: %s", output);
    assert_string_equal(name, method);
    return c;
}

static void cells_are_counted(void **)
{
    write_text("near.path", "0 0 1.1  3 0 0.4\n");
    for (const char *where : {"", "--path near.path"})
        for (const char *method : {"paper", "cast", "cast_fragment"}) {
            const Counts c = counted(method, where);
            if (c.rays < 100 || c.rays > 4 * 64 * 48 || c.most < c.cells || c.cells < 0.5)
                fail_msg("%s: %llu rays, %g cells", method, c.rays, c.cells);
        }
    const Counts by_paper = counted("paper", ""), exactly = counted("cast_fragment", "");
    assert_true(exactly.cells < by_paper.cells && by_paper.slabs == 0 && exactly.slabs == 0);
    for (const char *wrong : {"--json", "--instances 2", "--methods mesh", "--methods auto"})
        expect(gtx("bench sphere.gtx none.obj --cells --sizes 64x48 %s", wrong), 1);
}

/* Wherever one stands, all methods show the same surface: the parts of the mesh that are left out
 * are out of view. */
static void methods_agree_from_anywhere(void **)
{
    const json path = along("sphere.gtx", "sphere.obj", "--random 24 --methods "
                                                        "mesh,simplified,floor,cast,auto");
    uint64_t seen = 0;
    for (const json &view : path["views"]) {
        const json &mesh = cell(view, "mesh"), &simplified = cell(view, "simplified");
        assert_true(mesh["silhouette_iou"] == 1 && mesh["hole_pixels"] == 0);
        assert_true(mesh["outline_px"] == 0);
        assert_true(simplified["triangles"] <= mesh["triangles"]);
        seen += simplified["triangles"] < mesh["triangles"];
        for (const char *method : {"simplified", "cast", "auto"}) {
            assert_true(cell(view, method)["silhouette_iou"].get<double>() > 0.9);
            assert_true(cell(view, method)["outline_px"] <= 3);
            assert_true(cell(view, method)["enclosed_hole_pixels"] == 0);
        }
        for (const char *figure :
             {"silhouette_iou", "hole_pixels", "enclosed_hole_pixels", "outline_px"})
            assert_true(cell(view, "floor")[figure] == cell(view, "auto")[figure]);
    }
    assert_true(seen > 0); /* some views are far away enough */
    for (const json &row : path["rows"])
        if (row["method"] == "mesh")
            assert_true(row["ratio_median"] == 1 && row["ratio_worst"] == 1 &&
                        row["work_ratio_median"] == 1 && row["work_ratio_worst"] == 1);
        else
            assert_true(row["ratio_worst"] >= row["ratio_median"] &&
                        row["work_ratio_worst"] >= row["work_ratio_median"]);
}

/* An open sheet has two sides: the mesh is not culled there, as the asset is not. */
static void a_sheet_is_seen_from_behind(void **)
{
    std::string sheet;
    for (int y = 0; y <= 30; ++y)
        for (int x = 0; x <= 30; ++x)
            sheet += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
    for (int y = 0; y < 30; ++y)
        for (int x = 1; x <= 30; ++x) {
            const int a = 31 * y + x;
            sheet += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " +
                     std::to_string(a + 32) + " " + std::to_string(a + 31) + "\n";
        }
    write_text("sheet.obj", sheet);
    expect(gtx("cook sheet.obj -o sheet.gtx"), 0);
    write_text("sides.path", "15 15 60 15 15 0\n15 15 -60 15 15 0\n");
    const json path = along("sheet.gtx", "sheet.obj", "--path sides.path --methods mesh,cast");
    for (const json &view : path["views"])
        assert_true(cell(view, "cast")["outline_px"] <= 1);
}

/* An asset with a hole in it, a wider one and a smaller one, beside the whole sheet. */
static void gaps_and_moved_outlines_are_told_apart(void **)
{
    const char *frame = "v 0 0 0\nv 30 0 0\nv 30 30 0\nv 0 30 0\nv 10 10 0\nv 20 10 0\n"
                        "v 20 20 0\nv 10 20 0\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    const char *wide = "v -5 0 0\nv 35 0 0\nv 35 30 0\nv -5 30 0\nf 1 2 3 4\n";
    const char *small = "v 0 0 0\nv 24 0 0\nv 24 30 0\nv 0 30 0\nf 1 2 3 4\n";
    write_text("sheet.obj", "v 0 0 0\nv 30 0 0\nv 30 30 0\nv 0 30 0\nf 1 2 3 4\n");
    write_text("front.path", "15 15 60 15 15 0\n"); /* a unit is a pixel, nearly */
    struct {
        const char *model;
        int least_enclosed, most_enclosed, least_outline, most_outline;
    } cases[] = {{frame, 60, 100, 4, 6}, {wide, 0, 0, 4, 6}, {small, 0, 0, 5, 7}};
    for (const auto &c : cases) {
        write_text("other.obj", c.model);
        expect(gtx("cook other.obj -o other.gtx"), 0);
        const json path = along("other.gtx", "sheet.obj", "--path front.path --methods cast");
        const json &cast = cell(path["views"][0], "cast");
        assert_in_range(cast["enclosed_hole_pixels"].get<int>(), c.least_enclosed,
                        c.most_enclosed);
        assert_in_range(cast["outline_px"].get<int>(), c.least_outline, c.most_outline);
    }
}

/* The worst views are printed as a path that shows them again. */
static void the_worst_views_can_be_seen_again(void **)
{
    expect(gtx("bench sphere.gtx sphere.obj --sizes 32x32 --random 14 --repeats 1 "
               "--methods mesh,floor,auto -q"), 0);
    expect_text("| mesh ");
    expect_text("| floor ");
    expect_text("# auto against the mesh, worst first");
    const char *keys = std::strstr(output, "\nup ");
    assert_non_null(keys);
    write_text("worst.path", keys);
    const json again = along("sphere.gtx", "sphere.obj", "--path worst.path --methods mesh");
    assert_int_equal(again["views"].size(), 10);
    const json first = along("sphere.gtx", "sphere.obj", "--random 14 --methods mesh");
    for (const json &view : again["views"]) {
        double nearest = INFINITY;
        for (const json &other : first["views"])
            nearest = std::min(nearest, distance(view["eye"], other["eye"]) +
                                            distance(view["target"], other["target"]));
        assert_true(nearest < 1e-9);
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(keys_are_views_and_what_is_between_them),
        cmocka_unit_test(views_are_held_against_many_samples),
        cmocka_unit_test(random_views_are_a_third_each_and_the_same_again),
        cmocka_unit_test(cells_are_counted),
        cmocka_unit_test(methods_agree_from_anywhere),
        cmocka_unit_test(a_sheet_is_seen_from_behind),
        cmocka_unit_test(gaps_and_moved_outlines_are_told_apart),
        cmocka_unit_test(the_worst_views_can_be_seen_again)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
