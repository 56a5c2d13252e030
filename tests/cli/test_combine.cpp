/* gtx combine: what it makes and tells, and what it refuses without leaving a file. */
#include "common/schema.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

extern "C" {
#include "cli/command.h"
}

using schema::json;

/* sphere.obj, farther along x. */
static void write_moved(const char *name, double by)
{
    std::ifstream from(in_folder("sphere.obj"));
    std::ofstream to(in_folder(name));
    for (std::string line; std::getline(from, line);) {
        double x, y, z;
        if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3)
            to << "v " << x + by << ' ' << y << ' ' << z << '\n';
        else
            to << line << '\n';
    }
}

static void refused(int code, const char *text, const char *arguments)
{
    expect(gtx("combine %s", arguments), code);
    expect_text(text);
    assert_false(exists("no.gtx"));
    assert_int_equal(left_over(), 0);
}

static json report_of(const char *arguments)
{
    expect(gtx("combine %s --report r.json", arguments), 0);
    std::ifstream file(in_folder("r.json"));
    const json report = json::parse(file);
    const json rules = schema::load("format/combine-report.schema.json");
    const std::string why = schema::broken(report, rules, rules);
    if (!why.empty())
        fail_msg("%s", why.c_str());
    return report;
}

static void misuse_leaves_nothing(void **)
{
    std::ofstream(in_folder("flat.obj")) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    expect(gtx("cook flat.obj -q -o flat.gtx"), 0);
    refused(1, "-o OUT.gtx is missing", "sphere.gtx sphere.gtx --op union");
    refused(1, "--op is missing", "sphere.gtx sphere.gtx -o no.gtx");
    refused(1, "--op wants", "sphere.gtx sphere.gtx -o no.gtx --op xor");
    refused(1, "operands are missing", "sphere.gtx -o no.gtx --op union");
    refused(1, "would write over a file", "sphere.gtx flat.gtx -o sphere.gtx --op union");
    refused(1, "would write one file",
            "sphere.gtx flat.gtx -o no.gtx --report no.gtx --op union");
    refused(1, "--openness wants", "sphere.gtx flat.gtx -o no.gtx --op union --openness 2");
    refused(2, "none.gtx: error[read]", "sphere.gtx none.gtx -o no.gtx --op union");
    refused(2, "error[write]", "sphere.gtx sphere.gtx -o nowhere/no.gtx --op union");
    refused(3, "error[100 identifier]", "sphere.gtx sphere.obj -o no.gtx --op union");
    refused(3, "the second asset: the surface is open", "sphere.gtx flat.gtx -o no.gtx --op union");
    refused(3, "the first asset: the surface is open", "flat.gtx sphere.gtx -o no.gtx --op union");
    refused(3, "nothing is left", "sphere.gtx sphere.gtx -o no.gtx --op subtract");
    refused(3, "(--strict)",
            "sphere.gtx flat.gtx -o no.gtx --op union --openness 1 --strict --lod-levels 0");
    const json report = report_of("sphere.gtx flat.gtx -o open.gtx --op union --openness 1 "
                                  "--lod-levels 0 --zstd 0");
    expect_text("flat.gtx: warning[open-solid]");
    assert_int_equal(report["warnings"].size(), 1);
}

/* Two bumpy balls that do not meet are what cooking both together shows. */
static void a_union_is_both(void **)
{
    write_moved("far.obj", 2.5);
    expect(gtx("cook far.obj -q -o far.gtx"), 0);
    const json report = report_of("sphere.gtx far.gtx -o both.gtx --op union --threads 1");
    expect_text("both.gtx: volume");
    expect(gtx("validate both.gtx"), 0);
    assert_int_equal(report["assets"][0]["dropped_patches"], 0);
    assert_true(report["error"] == 0.0);
    assert_true(report["result"]["lod_meshes"] > 0);
    expect(gtx("compare both.gtx sphere.obj far.obj --size 256 --levels 1 --max-holes 0 "
               "--max-rms 1e-4"), 0);
}

static void balls_are_cut(void **)
{
    write_moved("near.obj", 0.7);
    expect(gtx("cook near.obj -q -o near.gtx --partition layers --mips 3 --height-bits 16"), 0);
    double volume[3], all = 0;
    const char *const ops[3] = {"union", "intersect", "subtract"};
    for (int i = 0; i < 3; ++i) {
        const std::string call = std::string("sphere.gtx near.gtx --lod-levels 0 --op ") + ops[i];
        const json report = report_of((call + " -o cut.gtx").c_str());
        expect(gtx("validate cut.gtx"), 0);
        if (i == 2) { /* as the operations share the code that uses threads */
            expect(gtx("combine %s -q -o again.gtx --threads 3", call.c_str()), 0);
            same_files("cut.gtx", "again.gtx");
        }
        volume[i] = report["result"]["volume"];
        all = report["assets"][0]["volume"].get<double>() +
              report["assets"][1]["volume"].get<double>();
        assert_true(report["assets"][0]["cut_patches"] > 0);
        assert_true(report["assets"][1]["cut_patches"] > 0);
        assert_true(report["error"] > 0.0 && report["error"] < 0.1);
        assert_true(report["result"]["openness"] < 0.01);
        expect(gtx("info cut.gtx --json"), 0);
        expect_text("\"mips\": 3");
        expect_text("\"height_bits\": 16");
    }
    assert_true(std::fabs(volume[0] + volume[1] - all) < 5e-3 * all);
    assert_true(std::fabs(volume[1] + volume[2] - all / 2) < 5e-3 * all);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(misuse_leaves_nothing),
        cmocka_unit_test(a_union_is_both),
        cmocka_unit_test(balls_are_cut),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
