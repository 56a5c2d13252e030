/* Grids that GDAL reads: where their nodes lie, what has no value, lying files, no GDAL at all. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "grid/grid.hpp"
#include "grid/module.h"
#include "grid/tiff.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <unistd.h>

using namespace gtx;

static char folder[] = "/tmp/gtx-gdal-XXXXXX";

static std::string file(const std::string &name, const std::string &bytes)
{
    const std::string path = std::string(folder) + "/" + name;
    FILE *out = std::fopen(path.c_str(), "wb");
    assert_non_null(out);
    assert_int_equal(std::fwrite(bytes.data(), 1, bytes.size(), out), bytes.size());
    assert_int_equal(std::fclose(out), 0);
    return path;
}

static HeightGrid read(const std::string &path, const GridReading &reading = {},
                       const gtx_limits &limits = {})
{
    Task task(1, nullptr, nullptr, {}, {}, limits);
    return read_grid(path, reading, task);
}

/* The result with which reading fails; its sentence has no path of GDAL's memory. */
static gtx_result failure(const std::string &path, const gtx_limits &limits = {})
{
    try {
        read(path, {}, limits);
    } catch (const Error &e) {
        assert_true(e.message.size() > 8);
        assert_null(std::strstr(e.message.c_str(), "vsimem"));
        return e.result;
    }
    return GTX_OK;
}

/* Where GDAL is not, neither is the module. */
static void need_module()
{
    char self[4096] = "";
    assert_true(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
    std::strcpy(std::strrchr(self, '/') + 1, "geotex-grid.so");
    if (access(self, F_OK) != 0)
        skip();
}

static const std::string ESRI = "ncols 3\nnrows 2\nxllcorner 600000\nyllcorner 5000000\n"
                                "cellsize 30\nNODATA_value -9999\n1.5 2 3\n4 -9999 6\n";

/* Three by two nodes, the first row in the north. */
static void expect(const HeightGrid &grid, double x, double y, double dx, double dy)
{
    assert_true(grid.nx == 3 && grid.ny == 2 && !grid.in_degrees);
    assert_true(grid.at(0, 1) == 1.5f && grid.at(1, 1) == 2 && grid.at(2, 1) == 3);
    assert_true(grid.at(0, 0) == 4 && std::isnan(grid.at(1, 0)) && grid.at(2, 0) == 6);
    assert_true(std::fabs(grid.origin[0] - x) < 1e-6 && std::fabs(grid.origin[1] - y) < 1e-6);
    assert_true(std::fabs(grid.step[0] - dx) < 1e-9 && std::fabs(grid.step[1] - dy) < 1e-9);
}

static void esri_ascii_is_read(void **)
{
    need_module();
    /* Cells have corners; nodes are their centres. */
    expect(read(file("a.asc", ESRI)), 600015, 5000015, 30, 30);
    const double missing = 6;
    GridReading reading;
    reading.missing = &missing;
    assert_true(std::isnan(read(file("a.asc", ESRI), reading).at(2, 0)));
}

static void xyz_is_read(void **)
{
    need_module();
    /* A node without a value is left out. */
    const char *const south = "100 50 4\n120 50 6\n", *const north = "100 70 1.5\n"
        "110 70 2\n120 70 3\n";
    expect(read(file("north.xyz", std::string(north) + south)), 100, 50, 10, 20);
    expect(read(file("south.xyz", std::string(south) + north)), 100, 50, 10, 20);
}

static std::string surfer_6()
{
    std::string out = "DSBB";
    for (int16_t count : {3, 2})
        put(out, count);
    for (double bound : {100.0, 120.0, 50.0, 70.0, 1.5, 6.0})
        put(out, bound);
    for (float node : {4.f, 1.70141e38f, 6.f, 1.5f, 2.f, 3.f})
        put(out, node);
    return out;
}

static const std::string SURFER_TEXT = "DSAA\n3 2\n100 120\n50 70\n1.5 6\n4 1.70141e+38 6\n\n"
                                       "1.5 2 3\n";

static void surfer_is_read(void **)
{
    need_module();
    expect(read(file("text.grd", SURFER_TEXT)), 100, 50, 10, 20);
    expect(read(file("binary.grd", surfer_6())), 100, 50, 10, 20);
}

/* ---- GeoTIFF ---- */

static void geotiff_is_read(void **)
{
    need_module();
    expect(read(file("a.tif", tiff({SCALE, PLACE, UTM, MISSING}))), 600015, 5000015, 30, 30);
    /* Without a place it is an image. */
    const HeightGrid plain = read(file("plain.tif", tiff({})));
    assert_true(plain.step[0] == 1 && plain.origin[0] == 0 && plain.at(1, 0) == -9999);
    /* Neither a world file nor metadata beside it has a say. */
    file("a.tfw", "1\n0\n0\n-1\n0\n0\n");
    file("a.tif.aux.xml", "<PAMDataset><GeoTransform>0,1,0,0,0,-1</GeoTransform></PAMDataset>");
    expect(read(std::string(folder) + "/a.tif"), 600015, 5000015, 30, 30);
}

/* A program's errors are no place for warnings of libraries: GDAL's own, and those that it would
 * print for OpenImageIO once it is there. */
static void nothing_is_printed(void **)
{
    need_module();
    std::string image = tiff({}), grid = tiff({SCALE, PLACE, UTM});
    for (std::string *bytes : {&image, &grid})
        ++(*bytes)[32 + 2 + 8 * 12]; /* the tag of the strip's size becomes another */
    std::fflush(stderr);
    const int kept = dup(2);
    const std::string said = file("said", "");
    FILE *out = std::fopen(said.c_str(), "wb");
    assert_int_equal(dup2(fileno(out), 2), 2);
    for (const std::string *bytes : {&image, &grid, &image})
        failure(file("said.tif", *bytes));
    std::fflush(stderr);
    dup2(kept, 2);
    close(kept);
    const long size = std::ftell(out) + lseek(fileno(out), 0, SEEK_END);
    std::fclose(out);
    assert_int_equal(size, 0);
}

/* x = 3 column + 4 row, y = 4 column - 3 row: turned by an angle with a tangent of 4/3. */
static Tag affine(double a, double b, double c, double d)
{
    return {34264, DOUBLE, 16,
            list<double>({a, b, 0, 1000, c, d, 0, 2000, 0, 0, 0, 0, 0, 0, 0, 1})};
}

static void rotated_grids_are_turned_or_refused(void **)
{
    need_module();
    const HeightGrid grid = read(file("turned.tif", tiff({affine(3, 4, 4, -3), UTM})));
    assert_true(std::fabs(grid.rotation - 53.130102354) < 1e-6);
    assert_true(std::fabs(grid.step[0] - 5) < 1e-9 && std::fabs(grid.step[1] - 5) < 1e-9);
    const auto corner = grid.place(0, 1); /* the upper left node */
    assert_true(std::fabs(corner[0] - 1003.5) < 1e-6 && std::fabs(corner[1] - 2000.5) < 1e-6);
    assert_true(grid.at(0, 1) == 1.5f);
    assert_int_equal(failure(file("skewed.tif", tiff({affine(3, 1, 0, -3), UTM}))),
                     GTX_ERROR_INPUT);
}

static std::string hgt()
{
    std::string out(2 * 1201 * 1201, '\0');
    out[0] = 1; /* 256 in the north west */
    out[2] = char(0x80); /* no value beside it */
    return out;
}

static void degrees_are_told(void **)
{
    need_module();
    assert_true(read(file("d.tif", tiff({SCALE, PLACE, WGS84}))).in_degrees);
    const HeightGrid grid = read(file("N46E008.hgt", hgt()));
    assert_true(grid.in_degrees && grid.nx == 1201);
    assert_true(grid.at(0, 1200) == 256 && std::isnan(grid.at(1, 1200)) && grid.at(5, 5) == 0);
    assert_true(std::fabs(grid.origin[0] - 8) < 1e-9 && std::fabs(grid.origin[1] - 46) < 1e-9);
    assert_int_equal(failure(file("alps.hgt", hgt())), GTX_ERROR_INPUT);
    /* Text says nothing of degrees; its heights do. */
    const std::string alps = "ncols 2\nnrows 2\nxllcorner 8\nyllcorner 46\ncellsize 0.001\n"
                             "400 500\n600 700\n";
    assert_true(read(file("alps.asc", alps)).in_degrees);
}

/* Heights come in the units of the lattice, where both are told. */
static void feet_become_metres(void **)
{
    need_module();
    auto units = [](uint16_t across_key, uint16_t across, uint16_t up) {
        return Tag{34735, SHORT, 20, list<uint16_t>({1, 1, 0, 4, 1024, 0, 1, 1, 1025, 0, 1, 1,
                                                     across_key, 0, 1, across, 4099, 0, 1, up})};
    };
    const uint16_t METRE = 9001, FOOT = 9002, FATHOM = 9014;
    struct {
        uint16_t key, across, up;
        double scale;
    } const cases[] = {{3072, 32632, FOOT, 0.3048}, {3076, METRE, FOOT, 0.3048},
                       {3076, FOOT, METRE, 1 / 0.3048}, {3076, FOOT, FOOT, 1},
                       {3076, METRE, FATHOM, 1},     {3072, 2225, FOOT, 1}}; /* not told */
    for (const auto &c : cases) {
        const HeightGrid grid =
            read(file("feet.tif", tiff({SCALE, PLACE, units(c.key, c.across, c.up)})));
        assert_true(std::fabs(grid.at(1, 1) - 2 * c.scale) < 1e-6);
        assert_true(std::fabs(grid.at(2, 0) - 6 * c.scale) < 1e-6 && grid.step[0] == 30);
    }
}

/* ---- files that lie ---- */

static void truncated_files_are_refused(void **)
{
    need_module();
    const std::string files[] = {ESRI, SURFER_TEXT, surfer_6(), tiff({SCALE, PLACE, UTM, MISSING})};
    for (const std::string &whole : files) {
        /* Without the last byte of a text all its numbers are there. */
        for (size_t size = 4; size + 2 <= whole.size(); ++size) {
            const gtx_result result = failure(file("cut", whole.substr(0, size)));
            assert_true(result == GTX_ERROR_INPUT || result == GTX_ERROR_READ);
        }
    }
    assert_int_equal(failure(file("N46E008.hgt", hgt().substr(0, 1000))), GTX_ERROR_INPUT);
}

static void lying_sizes_are_refused(void **)
{
    need_module();
    std::string text = ESRI;
    text.replace(0, 7, "ncols 200000000");
    assert_true(failure(file("wide.asc", text)) != GTX_OK);
    text = ESRI;
    text.replace(8, 7, "nrows 2000000000");
    assert_true(failure(file("high.asc", text)) != GTX_OK);
    assert_true(failure(file("wide.tif", tiff({SCALE, PLACE}, 1 << 23, 1 << 23))) != GTX_OK);
    assert_int_equal(failure(file("large.tif", tiff({SCALE, PLACE}, 40, 50))), GTX_ERROR_INPUT);
    gtx_limits limits = {};
    limits.texels = 5;
    assert_int_equal(failure(file("a.asc", ESRI), limits), GTX_ERROR_LIMIT);
}

/* A copy of this program elsewhere has no module beside it. */
static void its_absence_is_told(void **)
{
    const std::string program = std::string(folder) + "/alone";
    const std::string grid = file("a.asc", ESRI);
    assert_int_equal(std::system(("cp /proc/$PPID/exe " + program).c_str()), 0);
    FILE *out = popen((program + " " + grid).c_str(), "r");
    char line[300] = "";
    assert_non_null(out);
    assert_non_null(std::fgets(line, sizeof line, out));
    pclose(out);
    assert_non_null(std::strstr(line, "libgdal32"));
    assert_non_null(std::strstr(line, "geotex-grid.so"));
}

static int make_folder(void **) { return mkdtemp(folder) ? 0 : -1; }
static int remove_folder(void **)
{
    return std::system((std::string("rm -r ") + folder).c_str());
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        try {
            read(argv[1]);
        } catch (const Error &e) {
            std::puts(e.message.c_str());
        }
        return 0;
    }
    const CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_printed), /* first: it is about who comes first */
        cmocka_unit_test(esri_ascii_is_read),
        cmocka_unit_test(xyz_is_read),
        cmocka_unit_test(surfer_is_read),
        cmocka_unit_test(geotiff_is_read),
        cmocka_unit_test(rotated_grids_are_turned_or_refused),
        cmocka_unit_test(degrees_are_told),
        cmocka_unit_test(feet_become_metres),
        cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(lying_sizes_are_refused),
        cmocka_unit_test(its_absence_is_told),
    };
    return cmocka_run_group_tests_name("gdal", tests, make_folder, remove_folder);
}
