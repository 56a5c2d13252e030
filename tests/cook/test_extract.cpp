/* Extraction by the GPU: it agrees with the CPU's, says whose it is, and leaves callers theirs. */
#include "common/schema.hpp"

#include "bake/agreement.hpp"
#include "cook/folder.hpp"
#include "host/offscreen.h"

#include <EGL/egl.h>
#include <sys/wait.h>
#include <unistd.h>

/* The bumpy ball with a normal and a colour at every vertex. */
static std::string coloured_ball(unsigned n)
{
    const gtx::Mesh mesh = shapes::ball(n, shapes::bumps);
    gtx::Vector<gtx::Vec3d> normals(mesh.positions.size());
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (uint32_t v : mesh.triangles[t])
            normals[v] += mesh.area_vector(t);
    std::string text = "ply\nformat ascii 1.0\nelement vertex " +
                       std::to_string(mesh.positions.size());
    for (const char *name : {"x", "y", "z", "nx", "ny", "nz"})
        text += std::string("\nproperty float ") + name;
    for (const char *name : {"red", "green", "blue"})
        text += std::string("\nproperty uchar ") + name;
    text += "\nelement face " + std::to_string(mesh.triangle_count()) +
            "\nproperty list uchar int vertex_indices\nend_header\n";
    char line[200];
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        const gtx::Vec3d &p = mesh.positions[v], m = gtx::normalize(normals[v]);
        auto wave = [&](double x) { return int(127.5 + 120 * std::sin(x)); };
        text.append(line, size_t(snprintf(line, sizeof line,
                                          "%.9g %.9g %.9g %.9g %.9g %.9g %d %d %d\n", p.x, p.y,
                                          p.z, m.x, m.y, m.z, wave(7 * p.x), wave(5 * p.y + 1),
                                          wave(9 * p.z + 2))));
    }
    for (const auto &t : mesh.triangles)
        text.append(line, size_t(snprintf(line, sizeof line, "3 %u %u %u\n", t[0], t[1], t[2])));
    return text;
}

struct Cooked {
    std::unique_ptr<gtx_asset, decltype(&gtx_close)> asset{nullptr, gtx_close};
    schema::json report;
};

/* Skips the test where no driver can be had. */
static Cooked cook(const std::string &model, const char *name, gtx_extract extract,
                   gtx_cook_desc desc = {})
{
    Cooked out;
    gtx_asset *asset = nullptr;
    gtx_report report = {};
    gtx_error error = {};
    desc.extract = extract;
    gtx_result result = gtx_cook_memory(model.data(), model.size(), name, &desc, &asset, &report,
                                        &error);
    if (result == GTX_ERROR_GL && !strncmp(error.message, "no OpenGL driver", 16)) {
        print_message("skipped: %s\n", error.message);
        skip();
    }
    if (result)
        fail_msg("%s: %s", name, error.message);
    out.asset.reset(asset);
    out.report = schema::json::parse(report.json);
    gtx_report_free(&report);
    return out;
}

/* ---- agreement ---- */

static void expect_agreement(const std::string &model, const char *name)
{
    const Cooked cpu = cook(model, name, GTX_EXTRACT_CPU), gpu = cook(model, name, GTX_EXTRACT_GPU);
    const agreement::Agreement found = agreement::measure(cpu.asset.get(), gpu.asset.get());
    gtx_info info;
    gtx_get_info(gpu.asset.get(), &info);
    auto percent = [&](uint64_t differing) { return 100 * found.share(differing); };
    print_message("%s on %s: within one code of %llu texels: height %.3f %%, normal %.3f %%, "
                  "colour %.3f %%%s; %llu more covered by one alone\n",
                  name, gpu.report["extract"]["renderer"].get<std::string>().c_str(),
                  (unsigned long long)found.both, percent(found.height), percent(found.normal),
                  percent(found.color), info.has_color ? "" : " (it has none)",
                  (unsigned long long)(found.either - found.both));
    assert_true(found.both > 1000);
    assert_true(found.least() >= 0.999);
    assert_true(double(found.both) > 0.99 * double(found.either));
}

static void both_agree_within_a_code(void **)
{
    expect_agreement(coloured_ball(60), "ball.ply");
}

static void both_agree_on_models(void **)
{
    const char *models = getenv("GEOTEX_MODELS");
    if (!models || !*models)
        skip();
    for (const char *name : {"draco/bunny.drc", "textured/DamagedHelmet.glb"}) {
        const std::string path = std::string(models) + "/" + name;
        expect_agreement(read_file(path), path.c_str());
    }
}

/* ---- whose it is ---- */

static void the_report_names_the_driver(void **)
{
    const std::string model = coloured_ball(12);
    const Cooked gpu = cook(model, "ball.ply", GTX_EXTRACT_GPU);
    const Cooked cpu = cook(model, "ball.ply", GTX_EXTRACT_CPU);
    const Cooked plain = cook(model, "ball.ply", GTX_EXTRACT_DEFAULT);
    const schema::json rules = schema::load("format/cook-report.schema.json");
    for (const Cooked *c : {&gpu, &cpu})
        assert_string_equal(schema::broken(c->report, rules, rules).c_str(), "");
    assert_true(gpu.report["extract"]["by"] == "gpu");
    assert_true(!gpu.report["extract"]["renderer"].get<std::string>().empty());
    assert_true(!gpu.report["extract"]["version"].get<std::string>().empty());
    assert_true(cpu.report["extract"] == schema::json({{"by", "cpu"}}));
    size_t size = 0;
    const char *meta = gtx_meta(gpu.asset.get(), &size);
    assert_true(schema::json::parse(meta, meta + size)["options"]["extract"] == "gpu");
    assert_true(gpu.report["key"] != cpu.report["key"]);
    assert_true(plain.report["key"] == cpu.report["key"]);
}

/* As a build does that finds the same driver again, and one that wants no GPU. */
static void the_key_covers_the_extraction(void **)
{
    const std::string output = in_folder("key.gtx");
    cook(coloured_ball(4), "ball.ply", GTX_EXTRACT_GPU); /* skips without a driver */
    gtx_cook_desc desc = {};
    desc.if_changed = 1;
    desc.extract = GTX_EXTRACT_GPU;
    for (uint32_t unchanged : {0, 1}) {
        gtx_report report = {};
        gtx_error error = {};
        if (gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, &report, &error))
            fail_msg("%s", error.message);
        assert_int_equal(report.unchanged, unchanged);
        gtx_report_free(&report);
    }
    desc.extract = GTX_EXTRACT_CPU;
    gtx_report report = {};
    assert_int_equal(gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, &report,
                                   nullptr),
                     GTX_OK);
    assert_int_equal(report.unchanged, 0);
    gtx_report_free(&report);
    fs::remove(output);
}

static void any_thread_count_gives_the_same(void **)
{
    const std::string model = coloured_ball(24);
    gtx_cook_desc one = {}, four = {};
    one.threads = 1;
    four.threads = 4;
    assert_true(cook(model, "ball.ply", GTX_EXTRACT_GPU, one).report["content_hash"] ==
                cook(model, "ball.ply", GTX_EXTRACT_GPU, four).report["content_hash"]);
}

static void the_callers_context_is_current_again(void **)
{
    gtx_offscreen *offscreen = nullptr;
    gtx_error error;
    if (gtx_offscreen_create(&offscreen, &error)) {
        print_message("skipped: %s\n", error.message);
        skip();
    }
    const EGLContext before = eglGetCurrentContext();
    const EGLDisplay display = eglGetCurrentDisplay();
    cook(coloured_ball(8), "ball.ply", GTX_EXTRACT_GPU);
    assert_true(before != EGL_NO_CONTEXT);
    assert_ptr_equal(eglGetCurrentContext(), before);
    assert_ptr_equal(eglGetCurrentDisplay(), display);
    gtx_offscreen_destroy(offscreen);
    cook(coloured_ball(8), "ball.ply", GTX_EXTRACT_GPU); /* on a display that was ended */
    assert_ptr_equal(eglGetCurrentContext(), EGL_NO_CONTEXT);
}

/* ---- what cannot be done ---- */

static void without_a_driver_nothing_is_written(void **)
{
    const std::string output = in_folder("none.gtx");
    const pid_t child = fork(); /* libEGL looks for drivers once a process */
    if (!child) {
        setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent", 1);
        gtx_cook_desc desc = {};
        gtx_error error = {};
        desc.extract = GTX_EXTRACT_GPU;
        gtx_result result =
            gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, nullptr, &error);
        _exit(strncmp(error.message, "no OpenGL driver", 16) ? 0 : int(result));
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    if (!WEXITSTATUS(status)) {
        print_message("skipped: this libEGL has its driver built in\n");
        skip();
    }
    assert_int_equal(WEXITSTATUS(status), GTX_ERROR_GL);
    assert_false(fs::exists(output));
}

static void an_unknown_extraction_is_refused(void **)
{
    gtx_cook_desc desc = {};
    gtx_error error = {};
    const int unknown = 3;
    memcpy(&desc.extract, &unknown, sizeof desc.extract);
    assert_int_equal(gtx_cook_file(small_ball_file().c_str(), in_folder("none.gtx").c_str(), &desc,
                                   nullptr, &error),
                     GTX_ERROR_ARGUMENT);
    assert_string_equal(error.message, "unknown extraction");
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(without_a_driver_nothing_is_written),
        cmocka_unit_test(an_unknown_extraction_is_refused),
        cmocka_unit_test(both_agree_within_a_code),
        cmocka_unit_test(both_agree_on_models),
        cmocka_unit_test(the_report_names_the_driver),
        cmocka_unit_test(the_key_covers_the_extraction),
        cmocka_unit_test(any_thread_count_gives_the_same),
        cmocka_unit_test(the_callers_context_is_current_again),
    };
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
