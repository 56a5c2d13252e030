/* The k-th allocation fails, and the k-th progress call cancels, for every k: each call of cook.h
 * says so, gives nothing, writes nothing and leaks nothing. */
#include "cook/folder.hpp"

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>

/* ---- allocations that fail ---- */

/* What all of the program's C++ takes, its libraries' too. One alone fails, so that a failure that
 * is swallowed shows; none on other threads' behalf, for there are none. */
static std::atomic<size_t> taken{0}, live{0}, fail_at{0};

static void *take(size_t size)
{
    if (++taken == fail_at)
        throw std::bad_alloc();
    void *memory = std::malloc(size ? size : 1);
    if (!memory)
        throw std::bad_alloc();
    ++live;
    return memory;
}

static void give(void *memory)
{
    live -= memory != nullptr;
    std::free(memory);
}

void *operator new(size_t size) { return take(size); }
void *operator new[](size_t size) { return take(size); }
void operator delete(void *memory) noexcept { give(memory); }
void operator delete[](void *memory) noexcept { give(memory); }
void operator delete(void *memory, size_t) noexcept { give(memory); }
void operator delete[](void *memory, size_t) noexcept { give(memory); }

/* ---- the calls ---- */

/* Counts progress calls, and cancels at one. */
struct Progress {
    size_t calls = 0, at = 0; /* 0 = never */

    static int count(const gtx_progress *, void *user)
    {
        Progress *self = static_cast<Progress *>(user);
        return ++self->calls == self->at;
    }
};

using Call = std::function<gtx_result(Progress &, gtx_error *)>;

static std::string model, output, cooked, grid_file;

static gtx_cook_desc quick(Progress &progress)
{
    gtx_cook_desc desc = {};
    desc.charts = 3;
    desc.resolution = 64;
    desc.threads = 1;
    desc.progress = Progress::count;
    desc.progress_user = &progress;
    return desc;
}

static Call cook_by(gtx_partition partition, uint32_t lod_levels, uint32_t measure)
{
    return [=](Progress &progress, gtx_error *error) {
        gtx_cook_desc desc = quick(progress);
        desc.partition = partition;
        desc.lod_levels = lod_levels;
        desc.measure = measure;
        return gtx_cook_file(model.c_str(), output.c_str(), &desc, nullptr, error);
    };
}

static gtx_result compare_once(Progress &progress, gtx_error *error)
{
    gtx_compare_desc desc = {};
    desc.size = 32;
    desc.levels = 1;
    desc.threads = 1;
    desc.progress = Progress::count;
    desc.progress_user = &progress;
    return gtx_compare_files(cooked.c_str(), model.c_str(), &desc, nullptr, nullptr,
                             error);
}

static gtx_result lod_once(Progress &progress, gtx_error *error)
{
    gtx_asset *asset = nullptr, *out = nullptr;
    gtx_result result = gtx_open_file(cooked.c_str(), nullptr, &asset, error);
    if (result)
        return result;
    gtx_lod_desc desc = {};
    desc.levels = 2;
    desc.threads = 1;
    desc.progress = Progress::count;
    desc.progress_user = &progress;
    result = gtx_cook_lod_meshes(asset, &desc, &out, error);
    assert_int_equal(out == nullptr, result != GTX_OK);
    gtx_close(out);
    gtx_close(asset);
    return result;
}

static gtx_result horizons_once(Progress &progress, gtx_error *error)
{
    gtx_height_grid grid = {};
    gtx_result result =
        gtx_height_grid_read(grid_file.c_str(), nullptr, &grid, error);
    if (result)
        return result;
    gtx_horizons_desc desc = {};
    desc.tile = 16;
    desc.lod_levels = 2;
    desc.threads = 1;
    desc.progress = Progress::count;
    desc.progress_user = &progress;
    gtx_asset *out = nullptr;
    result = gtx_horizons(&grid, 1, &desc, &out, nullptr, error);
    assert_int_equal(out == nullptr, result != GTX_OK);
    gtx_close(out);
    gtx_height_grid_free(&grid);
    return result;
}

static const struct {
    const char *name;
    Call call;
} calls[] = {{"cuts", cook_by(GTX_PARTITION_CUTS, 2, 1)},
             {"vsa", cook_by(GTX_PARTITION_VSA, 0, 0)},
             {"pgp", cook_by(GTX_PARTITION_PGP, 0, 0)},
             {"compare", compare_once},
             {"lod", lod_once},
             {"horizons", horizons_once}};

static int prepare(void **state)
{
    if (make_folder(state))
        return 1;
    model = in_folder("ball.obj");
    output = in_folder("out.gtx");
    cooked = in_folder("whole.gtx");
    grid_file = in_folder("grid.irap");
    write_file(model, obj_text(shapes::ball(4, shapes::bumps)));
    std::string grid = "-996 9 1 1\n0 8 0 8\n9 0 0 0\n0 0 0 0 0 0 0\n";
    for (int i = 0; i < 81; ++i)
        grid += std::to_string(i * 7 % 5) + " ";
    write_file(grid_file, grid);
    Progress progress;
    gtx_cook_desc desc = quick(progress);
    return gtx_cook_file(model.c_str(), cooked.c_str(), &desc, nullptr, nullptr);
}

/* ---- the tests ---- */

/* Runs it once more, which must end so, without a file or a block left. Only what makes no
 * difference may get by without an allocation. */
static void fails_cleanly(const char *name, const Call &call, size_t k, gtx_result wanted,
                          const std::string &expected)
{
    Progress progress;
    const size_t files = files_in_folder();
    gtx_error error = {};
    const size_t before = live;
    if (wanted == GTX_CANCELLED)
        progress.at = k;
    else
        fail_at = taken + k;
    const gtx_result result = call(progress, &error);
    fail_at = 0;
    if (result == GTX_OK && wanted == GTX_ERROR_MEMORY) {
        assert_true(read_file(output) == expected);
        fs::remove(output);
        return;
    }
    if (result != wanted || error.result != wanted)
        fail_msg("%s %zu: %d, %s", name, k, result, error.message);
    if (live != before)
        fail_msg("%s %zu leaks %zd blocks", name, k, ssize_t(live) - ssize_t(before));
    assert_int_equal(files_in_folder(), files);
}

/* All of them, in minutes, where all is asked for; else so many, evenly. */
static size_t stride(size_t count)
{
    constexpr size_t SOME = 30;
    const char *corpus = getenv("GTX_CORPUS");
    return corpus && !strcmp(corpus, "all") ? 1 : count / SOME + 1;
}

static void every_allocation_fails(void **)
{
    for (const auto &c : calls) {
        Progress progress;
        gtx_error error = {};
        if (c.call(progress, &error)) /* what is made once and kept is made now */
            fail_msg("%s: %s", c.name, error.message);
        const size_t first = taken;
        assert_int_equal(c.call(progress, nullptr), GTX_OK);
        const size_t count = taken - first;
        const std::string expected = read_file(output);
        fs::remove(output);
        assert_true(count > 100);
        for (size_t k = 1; k <= count; k += stride(count))
            fails_cleanly(c.name, c.call, k, GTX_ERROR_MEMORY, expected);
    }
}

static void every_progress_call_cancels(void **)
{
    for (const auto &c : calls) {
        Progress whole;
        assert_int_equal(c.call(whole, nullptr), GTX_OK);
        fs::remove(output);
        assert_true(whole.calls > 2);
        for (size_t k = 1; k <= whole.calls; k += stride(whole.calls))
            fails_cleanly(c.name, c.call, k, GTX_CANCELLED, "");
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(every_allocation_fails),
        cmocka_unit_test(every_progress_call_cancels),
    };
    return cmocka_run_group_tests(tests, prepare, remove_folder);
}
