/* Memory of cooking and comparing: what callers get goes through their hooks and comes back with
 * its size, and running out of it at any moment is a result that leaves nothing behind. */
#include <cstring>
#include <map>
#include <thread>

#include "cook/folder.hpp"

/* Counts, and fails at one call alone, so that a failure that is swallowed shows. */
struct Meter {
    size_t calls = 0, fail_at = 0; /* 0 = never */
    std::map<void *, size_t> live;
    std::thread::id thread = std::this_thread::get_id();
    gtx_allocator hooks = {
        [](size_t size, void *user) { return static_cast<Meter *>(user)->alloc(size); },
        [](void *memory, size_t size, void *user) {
            static_cast<Meter *>(user)->free(memory, size);
        },
        this};

    void *alloc(size_t size)
    {
        assert_true(std::this_thread::get_id() == thread);
        ++calls;
        if (calls == fail_at)
            return nullptr;
        void *memory = malloc(size);
        live[memory] = size;
        return memory;
    }

    void free(void *memory, size_t size)
    {
        assert_true(std::this_thread::get_id() == thread);
        auto found = live.find(memory);
        assert_true(found != live.end() && found->second == size);
        live.erase(found);
        ::free(memory);
    }
};

using Attempt = std::function<gtx_result(Meter &, gtx_error *)>;

/* Every allocation fails in turn; returns how many success takes. */
static size_t exhaust(const Attempt &attempt)
{
    size_t files = files_in_folder();
    for (size_t fail_at = 1;; ++fail_at) {
        Meter meter;
        meter.fail_at = fail_at;
        gtx_error error = {};
        gtx_result result = attempt(meter, &error);
        assert_int_equal(meter.live.size(), 0);
        assert_int_equal(files_in_folder(), files);
        if (meter.calls < fail_at) {
            assert_int_equal(result, GTX_OK);
            return meter.calls;
        }
        if (result != GTX_ERROR_MEMORY)
            fail_msg("allocation %zu: %d, %s", fail_at, result, error.message);
        assert_int_equal(error.result, GTX_ERROR_MEMORY);
    }
}

static gtx_cook_desc quick(const Meter &meter)
{
    gtx_cook_desc desc = {};
    desc.charts = 6;
    desc.resolution = 64;
    desc.threads = 2;
    desc.allocator = &meter.hooks;
    return desc;
}

/* The report of a call that failed is as it was. */
static void check_report(gtx_report &report, gtx_result result, const Meter &meter,
                         size_t sources = 1)
{
    assert_int_equal(report.json == nullptr, result != GTX_OK);
    if (report.json) {
        assert_int_equal(meter.live.count(report.block), 1);
        assert_int_equal(strlen(report.json), report.size);
        assert_int_equal(report.source_count, sources);
        if (sources)
            assert_string_equal(report.sources[0], small_ball_file().c_str());
    }
    gtx_report_free(&report);
}

static void a_cook_runs_out_of_memory(void **)
{
    std::string output = in_folder("a.gtx");
    size_t calls = exhaust([&](Meter &meter, gtx_error *error) {
        gtx_cook_desc desc = quick(meter);
        gtx_result result =
            gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, nullptr, error);
        assert_int_equal(fs::exists(output), result == GTX_OK);
        fs::remove(output);
        return result;
    });
    assert_true(calls > 10); /* an asset, its sections, what encoding takes, a file, a path */
}

/* What was there before is still there, also where the report is what finds no memory. */
static void an_old_output_survives(void **)
{
    std::string output = in_folder("b.gtx");
    write_file(output, "precious");
    exhaust([&](Meter &meter, gtx_error *error) {
        gtx_cook_desc desc = quick(meter);
        gtx_report report = {};
        gtx_result result =
            gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, &report, error);
        check_report(report, result, meter);
        assert_int_equal(read_file(output) == "precious", result != GTX_OK);
        write_file(output, "precious");
        return result;
    });
    fs::remove(output);
}

/* To find that nothing has changed takes memory too; not finding out is no reason to cook. */
static void an_unchanged_output_runs_out_of_memory(void **)
{
    std::string output = in_folder("c.gtx");
    Meter first;
    gtx_cook_desc cook = quick(first);
    assert_int_equal(
        gtx_cook_file(small_ball_file().c_str(), output.c_str(), &cook, nullptr, nullptr), GTX_OK);
    exhaust([&](Meter &meter, gtx_error *error) {
        gtx_cook_desc desc = quick(meter);
        desc.if_changed = 1;
        gtx_report report = {};
        gtx_result result =
            gtx_cook_file(small_ball_file().c_str(), output.c_str(), &desc, &report, error);
        assert_int_equal(report.unchanged, result == GTX_OK);
        check_report(report, result, meter);
        return result;
    });
    fs::remove(output);
}

/* The asset outlives the descriptor and the copy of the hooks in it. */
static void a_cook_in_memory_runs_out_of_it(void **)
{
    std::string bytes = read_file(small_ball_file());
    exhaust([&](Meter &meter, gtx_error *error) {
        gtx_allocator copy = meter.hooks;
        gtx_cook_desc desc = quick(meter);
        desc.allocator = &copy;
        gtx_report report = {};
        gtx_asset *asset = nullptr;
        gtx_result result = gtx_cook_memory(bytes.data(), bytes.size(), "ball.obj", &desc, &asset,
                                            &report, error);
        copy = {};
        assert_int_equal(asset == nullptr, result != GTX_OK);
        check_report(report, result, meter, 0);
        assert_int_equal(meter.live.empty(), asset == nullptr);
        gtx_close(asset);
        return result;
    });
}

static void a_comparison_runs_out_of_memory(void **)
{
    std::string output = in_folder("d.gtx");
    Meter first;
    gtx_cook_desc cook = quick(first);
    assert_int_equal(
        gtx_cook_file(small_ball_file().c_str(), output.c_str(), &cook, nullptr, nullptr), GTX_OK);
    exhaust([&](Meter &meter, gtx_error *error) {
        gtx_compare_desc desc = {};
        desc.size = 16;
        desc.levels = 1;
        desc.threads = 2;
        desc.allocator = &meter.hooks;
        gtx_compare_result figures = {};
        gtx_report report = {};
        gtx_result result = gtx_compare_files(output.c_str(), small_ball_file().c_str(), &desc,
                                              &figures, &report, error);
        assert_int_equal(figures.surface_pixels == 0, result != GTX_OK);
        check_report(report, result, meter);
        return result;
    });
    fs::remove(output);
}

/* The bytes are the same from whatever memory. */
static void hooks_change_no_byte(void **)
{
    std::string with = in_folder("e.gtx"), without = in_folder("f.gtx");
    Meter meter;
    gtx_cook_desc desc = quick(meter);
    cook_ball(with, desc);
    assert_true(meter.calls > 10);
    assert_true(meter.live.empty());
    desc.allocator = nullptr;
    cook_ball(without, desc);
    assert_true(read_file(with) == read_file(without));
    fs::remove(with);
    fs::remove(without);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_cook_runs_out_of_memory),
        cmocka_unit_test(an_old_output_survives),
        cmocka_unit_test(an_unchanged_output_runs_out_of_memory),
        cmocka_unit_test(a_cook_in_memory_runs_out_of_it),
        cmocka_unit_test(a_comparison_runs_out_of_memory),
        cmocka_unit_test(hooks_change_no_byte),
    };
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
