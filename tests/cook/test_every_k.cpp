/* The k-th allocation fails, and the k-th progress call cancels, for every k: each call of cook.h
 * says so, gives nothing, writes nothing and leaks nothing. */
#include "cook/folder.hpp"

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>

#include <sys/wait.h>
#include <unistd.h>

/* ---- a copy of the process for every k ---- */

/* At the k-th moment a copy of the process goes on with a failure, and the process waits for it,
 * then goes on without: all k for the time of one call, and of as many ways out. */
static struct {
    bool open = false, is_copy = false;
    size_t moments = 0, stride = 1, tried = 0, bad = 0; /* bad: copies that did not end well */
} branches;

/* True in the copy. There are no other threads, which a copy would not have. */
static bool branch()
{
    constexpr unsigned SECONDS = 100; /* hangs */
    if (!branches.open || ++branches.moments % branches.stride)
        return false;
    branches.open = false;
    const pid_t copy = fork();
    if (copy == 0) {
        branches.is_copy = true;
        alarm(SECONDS);
        return true;
    }
    int status = -1;
    if (copy < 0 || waitpid(copy, &status, 0) != copy || status != 0) {
        ++branches.bad;
        fprintf(stderr, "the copy of moment %zu: status %d\n", branches.moments, status);
    }
    ++branches.tried;
    branches.open = true;
    return false;
}

/* ---- allocations that fail ---- */

/* What all of the program's C++ takes, its libraries' too. One alone fails, so that a failure that
 * is swallowed shows. */
static std::atomic<size_t> taken{0}, live{0};
static bool allocations_fail = false;

static void *take(size_t size)
{
    ++taken;
    if (allocations_fail && branch())
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

static size_t progress_calls = 0;

static int count_progress(const gtx_progress *, void *)
{
    ++progress_calls;
    return !allocations_fail && branch();
}

using Call = std::function<gtx_result(gtx_error *)>;

static std::string model, output, cooked, grid_file;

static gtx_cook_desc quick()
{
    gtx_cook_desc desc = {};
    desc.charts = 3;
    desc.resolution = 64;
    desc.threads = 1;
    desc.progress = count_progress;
    return desc;
}

static Call cook_by(gtx_partition partition, uint32_t lod_levels, uint32_t measure)
{
    return [=](gtx_error *error) {
        gtx_cook_desc desc = quick();
        desc.partition = partition;
        desc.lod_levels = lod_levels;
        desc.measure = measure;
        return gtx_cook_file(model.c_str(), output.c_str(), &desc, nullptr, error);
    };
}

static gtx_result compare_once(gtx_error *error)
{
    gtx_compare_desc desc = {};
    desc.size = 32;
    desc.levels = 1;
    desc.threads = 1;
    desc.progress = count_progress;
    return gtx_compare_files(cooked.c_str(), model.c_str(), &desc, nullptr, nullptr,
                             error);
}

/* A result has an asset, and an error has none. No assertion: that is nothing for a copy. */
static gtx_result closed(gtx_asset *asset, gtx_result result)
{
    const bool fits = (asset == nullptr) == (result != GTX_OK);
    gtx_close(asset);
    return fits ? result : GTX_ERROR_INTERNAL;
}

static gtx_result lod_once(gtx_error *error)
{
    gtx_asset *asset = nullptr, *out = nullptr;
    gtx_result result = gtx_open_file(cooked.c_str(), nullptr, &asset, error);
    if (result)
        return result;
    gtx_lod_desc desc = {};
    desc.levels = 2;
    desc.threads = 1;
    desc.progress = count_progress;
    result = gtx_cook_lod_meshes(asset, &desc, &out, error);
    gtx_close(asset);
    return closed(out, result);
}

static gtx_result horizons_once(gtx_error *error)
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
    desc.progress = count_progress;
    gtx_asset *out = nullptr;
    result = gtx_horizons(&grid, 1, &desc, &out, nullptr, error);
    gtx_height_grid_free(&grid);
    return closed(out, result);
}

static const struct {
    const char *name;
    Call call;
} calls[] = {{"cuts", cook_by(GTX_PARTITION_CUTS, 2, 1)},
             {"vsa", cook_by(GTX_PARTITION_VSA, GTX_LOD_LEVELS_NONE, 0)},
             {"pgp", cook_by(GTX_PARTITION_PGP, GTX_LOD_LEVELS_NONE, 0)},
             {"layers", cook_by(GTX_PARTITION_LAYERS, GTX_LOD_LEVELS_NONE, 0)},
             {"relief", cook_by(GTX_PARTITION_RELIEF, GTX_LOD_LEVELS_NONE, 0)},
             {"compare", compare_once},
             {"lod", lod_once},
             {"horizons", horizons_once}};

static int prepare(void **state)
{
    if (make_ball_folder(state))
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
    gtx_cook_desc desc = quick();
    return gtx_cook_file(model.c_str(), cooked.c_str(), &desc, nullptr, nullptr);
}

/* ---- the tests ---- */

/* All of them, in minutes, where all is asked for; else so many, evenly. */
static size_t stride(size_t count)
{
    constexpr size_t SOME = 30;
    const char *corpus = getenv("GTX_CORPUS");
    return corpus && !strcmp(corpus, "all") ? 1 : count / SOME + 1;
}

/* Whether a copy ended as it must, without a file or a block left. Only an allocation that makes
 * no difference may be done without. */
static bool ended_well(const gtx_error &error, gtx_result result, size_t leaks, size_t new_files,
                       const std::string &expected)
{
    const gtx_result wanted = allocations_fail ? GTX_ERROR_MEMORY : GTX_CANCELLED;
    if (result == GTX_OK && allocations_fail && read_file(output) == expected) {
        fs::remove(output);
        return true;
    }
    const bool good = result == wanted && error.result == wanted && !leaks && !new_files;
    if (!good)
        fprintf(stderr, "ended with %d, %s; %zd blocks and %zd files are left\n", result,
                error.message, ssize_t(leaks), ssize_t(new_files));
    return good;
}

/* What may fail, so far. How often progress is asked for depends on the clock. */
static size_t moments()
{
    return allocations_fail ? size_t(taken) : progress_calls;
}

/* Makes the call, and a copy of it fail at each of its moments, or some: `count` is about how many
 * there are. */
static void fail_at_every(size_t count, const char *name, const Call &call,
                          const std::string &expected)
{
    const size_t files = files_in_folder();
    branches = {};
    branches.stride = stride(count);
    gtx_error error = {};
    const size_t before = live, first = moments();
    branches.open = true;
    const gtx_result result = call(&error);
    branches.open = false;
    const size_t met = moments() - first;
    const size_t leaks = live - before;
    if (branches.is_copy)
        _exit(!ended_well(error, result, leaks, files_in_folder() - files, expected));
    if (branches.bad)
        fail_msg("%s: %zu of %zu copies", name, branches.bad, branches.tried);
    assert_int_equal(result, GTX_OK);
    assert_int_equal(branches.tried, met / branches.stride);
    print_message("%s: %zu of %zu\n", name, branches.tried, met);
    fs::remove(output);
}

static void every_allocation_fails(void **)
{
    for (const auto &c : calls) {
        gtx_error error = {};
        if (c.call(&error)) /* what is made once and kept is made now */
            fail_msg("%s: %s", c.name, error.message);
        const size_t first = taken;
        assert_int_equal(c.call(nullptr), GTX_OK);
        const size_t count = taken - first;
        const std::string expected = read_file(output);
        fs::remove(output);
        assert_true(count > 100);
        allocations_fail = true;
        fail_at_every(count, c.name, c.call, expected);
        allocations_fail = false;
    }
}

static void every_progress_call_cancels(void **)
{
    for (const auto &c : calls) {
        progress_calls = 0;
        assert_int_equal(c.call(nullptr), GTX_OK);
        fs::remove(output);
        assert_true(progress_calls > 2);
        fail_at_every(progress_calls, c.name, c.call, "");
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
