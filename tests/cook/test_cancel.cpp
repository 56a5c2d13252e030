/* Progress and cancelling of every long call: what was there stays, and nothing else appears. */
#include "cook/folder.hpp"

/* As far as some fraction, from the begin of a stage on: how often a call asks is a matter of
 * time. */
struct Moment {
    size_t stage;
    float fraction;
};

/* Notes the steps; cancels once at `stop`. */
struct Watch {
    Moment stop = {SIZE_MAX, 0};
    bool stopped = false;
    std::vector<float> partitioned; /* where progress stands when a partition begins */
    float last = 0;
    std::vector<std::string> stages;
    std::vector<float> from; /* each: where progress stood at its first call */
};

static int watch_progress(const gtx_progress *progress, void *user)
{
    Watch *watch = static_cast<Watch *>(user);
    assert_true(progress->fraction >= watch->last && progress->fraction <= 1);
    assert_false(watch->stopped); /* and asked again */
    watch->last = progress->fraction;
    if (watch->stages.empty() || watch->stages.back() != progress->stage) {
        watch->stages.push_back(progress->stage);
        if (watch->stages.back() == "partition")
            watch->partitioned.push_back(progress->fraction);
        watch->from.push_back(progress->fraction);
    }
    watch->stopped = watch->stages.size() > watch->stop.stage &&
                     progress->fraction >= watch->stop.fraction;
    return watch->stopped;
}

/* The beginning and the middle of each stage, and the end of all. */
static std::vector<Moment> moments(const Watch &all)
{
    std::vector<Moment> out = {{all.stages.size() - 1, all.last}};
    for (size_t i = 0; i < all.stages.size(); ++i) {
        const float end = i + 1 < all.stages.size() ? all.from[i + 1] : all.last;
        out.push_back({i, all.from[i]});
        out.push_back({i, all.from[i] + (end - all.from[i]) / 2});
    }
    return out;
}

using Call = std::function<gtx_result(Watch &, gtx_error *)>;

/* Runs `call` once to its end, and then cancels it everywhere. */
static void cancel_everywhere(const Call &call, const std::vector<std::string> &stages,
                              const std::function<void()> &unharmed)
{
    Watch all;
    gtx_error error = {};
    if (call(all, &error))
        fail_msg("%s", error.message);
    assert_true(all.stages == stages);
    unharmed();
    size_t files = files_in_folder();
    for (const Moment &moment : moments(all)) {
        Watch watch;
        watch.stop = moment;
        error = {};
        assert_int_equal(call(watch, &error), GTX_CANCELLED);
        assert_int_equal(error.result, GTX_CANCELLED);
        assert_int_equal(files_in_folder(), files);
        unharmed();
    }
}

/* How often several threads report is a matter of chance. */
static gtx_cook_desc watched(Watch &watch)
{
    gtx_cook_desc desc = {};
    desc.charts = 12;
    desc.lod_levels = 3;
    desc.threads = 1;
    desc.progress = watch_progress;
    desc.progress_user = &watch;
    return desc;
}

static const std::vector<std::string> cook_stages = {"import", "clean", "partition", "frame",
                                                     "bake",   "pack",  "lod",     "write"};

static void a_cancelled_cook_overwrites_nothing(void **)
{
    std::string output = in_folder("a.gtx"), ply = in_folder("a.ply");
    cancel_everywhere(
        [&](Watch &watch, gtx_error *error) {
            gtx_cook_desc desc = watched(watch);
            desc.charts_ply = ply.c_str();
            return gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, nullptr, error);
        },
        cook_stages,
        [&] {
            if (fs::file_size(output) > 8) /* the first, whole run */
                write_file(output, "precious");
            assert_string_equal(read_file(output).c_str(), "precious");
            fs::remove(ply);
        });
    fs::remove(output);
}

static void a_measured_cook_is_cancelled_too(void **)
{
    std::string output = in_folder("b.gtx");
    std::vector<std::string> stages = cook_stages;
    stages.insert(stages.end() - 1, "measure");
    cancel_everywhere(
        [&](Watch &watch, gtx_error *error) {
            gtx_cook_desc desc = watched(watch);
            desc.measure = 1;
            return gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, nullptr, error);
        },
        stages, [&] { fs::remove(output); });
}

static void a_cancelled_cook_in_memory_gives_nothing(void **)
{
    std::string bytes = read_file(small_ball_file());
    cancel_everywhere(
        [&](Watch &watch, gtx_error *error) {
            gtx_cook_desc desc = watched(watch);
            gtx_asset *asset = nullptr;
            gtx_result result = gtx_cook_memory(bytes.data(), bytes.size(), "ball.obj", &desc,
                                                &asset, nullptr, error);
            assert_int_equal(asset == nullptr, result != GTX_OK);
            gtx_close(asset);
            return result;
        },
        cook_stages, [] {});
}

/* Each attempt moves the progress on, and does not leave most of it to the last step. */
static void attempts_at_an_error_progress(void **)
{
    Watch watch;
    gtx_cook_desc desc = watched(watch);
    desc.error = 1e-3;
    gtx_asset *asset = nullptr;
    std::string bytes = read_file(small_ball_file());
    assert_int_equal(gtx_cook_memory(bytes.data(), bytes.size(), "ball.obj", &desc, &asset, nullptr,
                                     nullptr), GTX_OK);
    gtx_close(asset);
    assert_true(watch.partitioned.size() > 2);
    for (size_t i = 1; i < watch.partitioned.size(); ++i)
        assert_true(watch.partitioned[i] > watch.partitioned[i - 1] + 0.01f);
    assert_true(watch.partitioned.back() > 0.4f && watch.last > 0.95f);
}

static void a_cancelled_comparison_gives_nothing(void **)
{
    std::string output = in_folder("c.gtx");
    gtx_cook_desc cook = {};
    cook.charts = 12;
    assert_int_equal(
        gtx_cook_file(small_ball_file().c_str(), output.c_str(), &cook, nullptr, nullptr), GTX_OK);
    cancel_everywhere(
        [&](Watch &watch, gtx_error *error) {
            gtx_compare_desc desc = {};
            desc.size = 64;
            desc.threads = 1;
            desc.progress = watch_progress;
            desc.progress_user = &watch;
            gtx_report report = {};
            gtx_compare_result figures = {};
            gtx_result result = gtx_compare_files(output.c_str(), small_ball_file().c_str(), &desc,
                                                  &figures, &report, error);
            assert_int_equal(report.json == nullptr, result != GTX_OK);
            assert_int_equal(figures.surface_pixels == 0, result != GTX_OK);
            gtx_report_free(&report);
            return result;
        },
        {"import", "clean", "measure"}, [] {});
    fs::remove(output);
}

/* Threads in the middle of a view stop too, and nobody is asked again. */
static void several_threads_stop(void **)
{
    std::string output = in_folder("d.gtx");
    gtx_cook_desc cook = {};
    cook.charts = 12;
    assert_int_equal(
        gtx_cook_file(small_ball_file().c_str(), output.c_str(), &cook, nullptr, nullptr), GTX_OK);
    for (float fraction : {0.2f, 0.4f, 0.7f}) {
        Watch watch;
        watch.stop = {0, fraction};
        gtx_compare_desc desc = {};
        desc.size = 256;
        desc.threads = 3;
        desc.progress = watch_progress;
        desc.progress_user = &watch;
        assert_int_equal(gtx_compare_files(output.c_str(), small_ball_file().c_str(), &desc,
                                           nullptr, nullptr, nullptr),
                         GTX_CANCELLED);
    }
    fs::remove(output);
}

/* Every importer asks while it reads, so that a large file can be cancelled. */
static void long_imports_are_cancelled(void **)
{
    gtx::Mesh mesh = shapes::ball(90, shapes::bumps);
    std::string obj = obj_text(mesh), off, ply, stl = "solid\n";
    char line[200];
    auto add = [&](std::string &to, int size) { to.append(line, size_t(size)); };
    add(off, snprintf(line, sizeof line, "OFF %zu %zu 0\n", mesh.positions.size(),
                      mesh.triangle_count()));
    add(ply, snprintf(line, sizeof line,
                      "ply\nformat ascii 1.0\nelement vertex %zu\nproperty double x\n"
                      "property double y\nproperty double z\n", mesh.positions.size()));
    add(ply, snprintf(line, sizeof line, "element face %zu\nproperty list uchar uint vertex_index\n"
                      "end_header\n", mesh.triangle_count()));
    std::string body;
    for (const gtx::Vec3d &p : mesh.positions)
        add(body, snprintf(line, sizeof line, "%.9g %.9g %.9g\n", p.x, p.y, p.z));
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto &v = mesh.triangles[t];
        add(body, snprintf(line, sizeof line, "3 %u %u %u\n", v[0], v[1], v[2]));
        stl += "facet normal 0 0 0\nouter loop\n";
        for (int k = 0; k < 3; ++k) {
            const gtx::Vec3d &p = mesh.position(t, k);
            add(stl, snprintf(line, sizeof line, "vertex %.9g %.9g %.9g\n", p.x, p.y, p.z));
        }
        stl += "endloop\nendfacet\n";
    }
    const struct {
        const char *name;
        std::string bytes;
    } files[] = {{"a.obj", obj}, {"a.off", off + body}, {"a.ply", ply + body},
                 {"a.stl", stl + "endsolid\n"}};
    for (const auto &file : files) {
        Watch watch;
        watch.stop = {0, 1e-4f}; /* past its beginning, */
        gtx_cook_desc desc = watched(watch);
        gtx_asset *asset = nullptr;
        assert_int_equal(gtx_cook_memory(file.bytes.data(), file.bytes.size(), file.name, &desc,
                                         &asset, nullptr, nullptr),
                         GTX_CANCELLED);
        assert_true(watch.last < 0.02f); /* and within the import, which ends at 0.05 */
        assert_null(asset);
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_cancelled_cook_overwrites_nothing),
        cmocka_unit_test(a_measured_cook_is_cancelled_too),
        cmocka_unit_test(a_cancelled_cook_in_memory_gives_nothing),
        cmocka_unit_test(attempts_at_an_error_progress),
        cmocka_unit_test(a_cancelled_comparison_gives_nothing),
        cmocka_unit_test(several_threads_stop),
        cmocka_unit_test(long_imports_are_cancelled),
    };
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
