/* NetCDF-4 by a program of its own: what it reads, what it must not look at, that it alone ends. */
#include "grid/grid.hpp"
#include "image/open.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sys/wait.h>
#include <unistd.h>

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

using namespace gtx;

static std::string bytes_of(const char *path)
{
    std::ifstream in(path, std::ios::binary);
    std::string out((std::istreambuf_iterator<char>(in)), {});
    assert_true(out.size() > 1000);
    return out;
}

/* Three by two nodes, texts of HDF5's own kind, the edges of columns beside them; deflated. */
static const char *const GRID = "tests/golden/grids/netcdf4.nc";

static void need_program()
{
    char path[GTX_MAX_PROGRAM_PATH];
    if (!gtx_find_program("geotex-netcdf", path))
        skip();
}

static gtx_result failure(const std::string &bytes, const gtx_limits &limits = {})
{
    Task task(1, nullptr, nullptr, {}, {}, limits);
    try {
        read_netcdf(classic_of_netcdf4(bytes, task), task.limits);
    } catch (const Error &e) {
        assert_true(e.message.size() > 8);
        return e.result;
    }
    return GTX_OK;
}

static void no_process_is_left()
{
    assert_true(waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD);
}

static void netcdf4_is_read(void **)
{
    need_program();
    Task task(1, nullptr, nullptr);
    assert_true(is_grid_file(GRID));
    const HeightGrid grid = read_grid(GRID, {}, task);
    assert_true(grid.nx == 3 && grid.ny == 2 && !grid.in_degrees && !grid.is_unplaced);
    assert_true(grid.at(0, 1) == 1.5f && grid.at(1, 1) == 2 && grid.at(2, 1) == 3);
    assert_true(grid.at(0, 0) == 4 && std::isnan(grid.at(1, 0)) && grid.at(2, 0) == 6);
    assert_true(grid.origin[0] == 100 && grid.origin[1] == 50);
    assert_true(grid.step[0] == 10 && grid.step[1] == 20);
    no_process_is_left();
}

/* HDF5's library crashes on some of these: that is an error like others. */
static void damaged_files_are_refused(void **)
{
    need_program();
    const std::string good = bytes_of(GRID);
    std::srand(1);
    unsigned refused = 0;
    for (int k = 0; k < 60; ++k) {
        std::string bad = good;
        for (int n = 0; n < 1 + k % 12; ++n)
            bad[8 + size_t(std::rand()) % (bad.size() - 8)] = char(std::rand() % 256);
        if (k % 6 == 5)
            bad.resize(size_t(std::rand()) % bad.size());
        const gtx_result result = failure(bad);
        assert_true(result == GTX_OK || result == GTX_ERROR_INPUT || result == GTX_ERROR_LIMIT);
        refused += result != GTX_OK;
    }
    assert_true(refused > 10);
    assert_int_equal(failure(good.substr(0, 8)), GTX_ERROR_INPUT);
    no_process_is_left();
}

/* Its values are those of /etc/passwd, by HDF5's external storage. */
static void no_other_file_is_looked_at(void **)
{
    need_program();
    assert_int_equal(access("/etc/passwd", R_OK), 0);
    assert_int_equal(failure(bytes_of("tests/golden/grids/names_a_file.h5")), GTX_ERROR_INPUT);
}

static void memory_is_limited(void **)
{
    need_program();
    const std::string good = bytes_of(GRID);
    gtx_limits limits = {};
    limits.texels = 5;
    assert_int_equal(failure(good, limits), GTX_ERROR_LIMIT);
    limits = {};
    limits.memory = 2000;
    assert_int_equal(failure(good, limits), GTX_ERROR_LIMIT);
    no_process_is_left();
}

static bool is_cancelled = false;
static int cancel(const gtx_progress *, void *)
{
    return is_cancelled;
}

static void reading_can_be_cancelled(void **)
{
    need_program();
    Task task(1, cancel, nullptr, {"read"}, {1});
    const std::string bytes = bytes_of(GRID);
    task.begin("read");
    is_cancelled = true;
    try {
        for (int k = 0; k < 1000; ++k)
            classic_of_netcdf4(bytes, task);
        fail();
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_CANCELLED);
    }
    no_process_is_left();
}

/* A copy of this test elsewhere has no program beside it. */
static void its_absence_is_told(void **)
{
    char folder[] = "/tmp/gtx-netcdf-XXXXXX", line[300] = "";
    assert_non_null(mkdtemp(folder));
    const std::string alone = std::string(folder) + "/alone";
    assert_int_equal(std::system(("cp /proc/$PPID/exe " + alone).c_str()), 0);
    FILE *out = popen((alone + " " + GRID).c_str(), "r");
    assert_non_null(out);
    assert_non_null(std::fgets(line, sizeof line, out));
    pclose(out);
    assert_non_null(std::strstr(line, "geotex-netcdf"));
    assert_non_null(std::strstr(line, "nccopy -k classic"));
    assert_int_equal(unlink(alone.c_str()) | rmdir(folder), 0);
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        try {
            Task task(1, nullptr, nullptr);
            read_grid(argv[1], {}, task);
        } catch (const Error &e) {
            std::puts(e.message.c_str());
        }
        return 0;
    }
    const CMUnitTest tests[] = {
        cmocka_unit_test(netcdf4_is_read),
        cmocka_unit_test(damaged_files_are_refused),
        cmocka_unit_test(no_other_file_is_looked_at),
        cmocka_unit_test(memory_is_limited),
        cmocka_unit_test(reading_can_be_cancelled),
        cmocka_unit_test(its_absence_is_told),
    };
    return cmocka_run_group_tests_name("netcdf4", tests, nullptr, nullptr);
}
