/* Reading grids: every format as its makers write it, hostile headers, and parts of one surface. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "grid/grid.hpp"
#include "image/image.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

using namespace gtx;

/* The result with which reading fails; OK when it does not. */
template <class Read> static gtx_result failure(Read read)
{
    try {
        read();
    } catch (const Error &e) {
        assert_true(e.message.size() > 8);
        return e.result;
    }
    return GTX_OK;
}

static const std::string CLASSIC = "-996 2 10.0 20.0\n1000 1020 500 520\n3 30.0 1000 500\n"
                                   "0 0 0 0 0 0 0\n1 2 3\n4 9999900.0000 6\n";

static void irap_classic_is_read(void **)
{
    assert_true(is_irap_classic(CLASSIC));
    const HeightGrid grid = read_irap_classic(CLASSIC);
    assert_int_equal(grid.nx, 3);
    assert_int_equal(grid.ny, 2);
    assert_true(grid.at(2, 0) == 3 && grid.at(0, 1) == 4 && std::isnan(grid.at(1, 1)));
    assert_true(grid.origin[0] == 1000 && grid.origin[1] == 500 && grid.rotation == 30);
    assert_true(grid.step[0] == 10 && grid.step[1] == 20);
    const auto place = grid.place(1, 0);
    assert_true(std::fabs(place[0] - 1000 - 10 * std::cos(std::acos(-1.0) / 6)) < 1e-9);
    assert_true(std::fabs(place[1] - 505) < 1e-9);
}

static void put(std::string &to, uint32_t bits)
{
    for (int k = 24; k >= 0; k -= 8)
        to += char(bits >> k);
}
static void put(std::string &to, float value)
{
    uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    put(to, bits);
}
static std::string record(const std::string &content)
{
    std::string out;
    put(out, uint32_t(content.size()));
    out += content;
    put(out, uint32_t(content.size()));
    return out;
}
static std::string binary(uint32_t nx, uint32_t ny, const Vector<float> &nodes)
{
    std::string first, second, data;
    put(first, uint32_t(-996));
    put(first, ny);
    for (float value : {1000.f, 1020.f, 500.f, 520.f, 10.f, 20.f})
        put(first, value);
    put(second, nx);
    for (float value : {0.f, 1000.f, 500.f})
        put(second, value);
    for (float value : nodes)
        put(data, value);
    return record(first) + record(second) + record(std::string(28, 0)) + record(data);
}

static void irap_binary_is_read(void **)
{
    const std::string bytes = binary(3, 2, {1, 2, 3, 4, 1e30f, 6});
    assert_true(is_irap_binary(bytes) && !is_irap_classic(bytes));
    const HeightGrid grid = read_irap_binary(bytes);
    assert_int_equal(grid.nx, 3);
    assert_true(grid.at(2, 0) == 3 && std::isnan(grid.at(1, 1)) && grid.step[1] == 20);
}

static const std::string ZMAP = "! made by hand\n@top HEADER, GRID, 2\n 15, -99999.0, , 4, 1\n"
                                " 2, 3, 100.0, 120.0, 50.0, 60.0\n 0.0, 0.0, 0.0\n@\n"
                                "+ Grid data starts after this line\n 4.0 1.0\n -99999.0 2.0\n"
                                " 6.0 3.0\n";

static void zmap_is_read(void **)
{
    assert_true(is_zmap(ZMAP) && !is_zmap(CLASSIC));
    const HeightGrid grid = read_zmap(ZMAP); /* columns, each from the north */
    assert_int_equal(grid.nx, 3);
    assert_int_equal(grid.ny, 2);
    assert_true(grid.at(0, 0) == 1 && grid.at(2, 0) == 3 && grid.at(0, 1) == 4);
    assert_true(std::isnan(grid.at(1, 1)) && grid.step[0] == 10 && grid.step[1] == 10);
}

static void truncated_grids_are_refused(void **)
{
    const std::string bytes = binary(3, 2, {1, 2, 3, 4, 5, 6});
    for (size_t size = 0; size < bytes.size(); ++size)
        assert_int_equal(failure([&] { read_irap_binary({bytes.data(), size}); }),
                         GTX_ERROR_INPUT);
    for (size_t size = 0; size + 3 < CLASSIC.size(); ++size)
        assert_int_equal(failure([&] { read_irap_classic({CLASSIC.data(), size}); }),
                         GTX_ERROR_INPUT);
    for (size_t size = 0; size + 4 < ZMAP.size(); ++size)
        assert_int_equal(failure([&] { read_zmap({ZMAP.data(), size}); }), GTX_ERROR_INPUT);
}

static std::string replaced(std::string text, const std::string &from, const std::string &to)
{
    return text.replace(text.find(from), from.size(), to);
}

/* What a header claims costs nothing before the nodes are there. */
static void hostile_headers_are_refused(void **)
{
    for (const char *size : {"-3", "0", "2.5", "nan", "16000000", "1e300", "x"}) {
        assert_int_equal(failure([&] { read_irap_classic(replaced(CLASSIC, "\n3 30", "\n" +
                                                         std::string(size) + " 30")); }),
                         GTX_ERROR_INPUT);
        assert_int_equal(failure([&] { read_zmap(replaced(ZMAP, " 2, 3", std::string(" 2, ") +
                                                          size)); }), GTX_ERROR_INPUT);
    }
    for (const char *step : {"0", "nan", "inf", "1e300"})
        assert_int_equal(failure([&] { read_irap_classic(replaced(CLASSIC, "10.0", step)); }),
                         GTX_ERROR_INPUT);
    for (uint32_t nx : {0u, 0xffffffffu, 1u << 24})
        assert_int_equal(failure([&] { read_irap_binary(binary(nx, 1 << 10, {1})); }),
                         nx == 1u << 24 ? GTX_ERROR_LIMIT : GTX_ERROR_INPUT);
    std::string bytes = binary(3, 2, {1, 2, 3, 4, 5, 6});
    bytes[8] = char(0xff); /* a record of gigabytes */
    bytes[40] = char(0x7f);
    assert_int_equal(failure([&] { read_irap_binary(bytes); }), GTX_ERROR_INPUT);
}

/* Lattices that run backwards come out the same surface. */
static void negative_steps_are_turned_round(void **)
{
    const std::string text = "-996 2 -10.0 20.0\n1020 1000 500 520\n3 0 1020 500\n"
                             "0 0 0 0 0 0 0\n3 2 1\n6 5 4\n";
    const HeightGrid grid = read_irap_classic(text);
    assert_true(grid.step[0] == 10 && grid.origin[0] == 1000);
    assert_true(grid.at(0, 0) == 1 && grid.at(2, 1) == 6);
}

static void images_are_read_from_the_top(void **)
{
    const uint16_t codes[6] = {0, 1, 65535, 10, 20, 30};
    const float depths[6] = {1, NAN, 3, 4, INFINITY, 6};
    Task task(1, nullptr, nullptr);
    const double missing = 0, range[2] = {100, 200};
    GridReading reading;
    char folder[] = "/tmp/gtx-grid-XXXXXX";
    assert_non_null(mkdtemp(folder));
    const std::string png = std::string(folder) + "/a.png", exr = std::string(folder) + "/a.exr";
    assert_int_equal(gtx_image_write_png16(png.c_str(), 3, 2, codes, nullptr), GTX_OK);
    assert_int_equal(gtx_image_write_exr(exr.c_str(), 3, 2, depths, nullptr), GTX_OK);
    HeightGrid grid = read_grid(png, reading, task);
    assert_true(grid.at(0, 0) == 10 && grid.at(0, 1) == 0 && grid.at(2, 1) == 65535);
    reading.missing = &missing;
    reading.range = range;
    grid = read_grid(png, reading, task);
    assert_true(std::isnan(grid.at(0, 1)) && grid.at(1, 1) == 100 && grid.at(2, 1) == 200);
    reading = {};
    grid = read_grid(exr, reading, task);
    assert_true(grid.at(0, 1) == 1 && std::isnan(grid.at(1, 1)) && std::isnan(grid.at(1, 0)));
    assert_int_equal(failure([&] { read_grid(std::string(folder) + "/b.png", reading, task); }),
                     GTX_ERROR_READ);
    FILE *text = std::fopen((std::string(folder) + "/c.txt").c_str(), "w");
    std::fputs("no grid at all", text);
    std::fclose(text);
    assert_int_equal(failure([&] { read_grid(std::string(folder) + "/c.txt", reading, task); }),
                     GTX_ERROR_READ);
    assert_int_equal(system((std::string("rm -r ") + folder).c_str()), 0);
}

static void parts_become_one_surface(void **)
{
    HeightGrid a = read_irap_classic(CLASSIC), b = a;
    const auto place = a.place(2, 0); /* one common column */
    b.origin[0] = place[0];
    b.origin[1] = place[1];
    b.values[0] = 77; /* the first part counts */
    const HeightGrid both = mosaic({a, b});
    assert_int_equal(both.nx, 5);
    assert_int_equal(both.ny, 2);
    assert_true(both.at(2, 0) == 3 && both.at(4, 0) == 3 && both.at(3, 0) == 2);
    b.origin[0] += 3;
    assert_int_equal(failure([&] { mosaic({a, b}); }), GTX_ERROR_INPUT);
    b.origin[0] = 1e12;
    assert_true(failure([&] { mosaic({a, b}); }) != GTX_OK);
}

static void colours_go_from_end_to_end(void **)
{
    using Rgb = std::array<uint8_t, 3>;
    assert_true(color_of(ColorMap::VIRIDIS, 0) == (Rgb{68, 1, 84}));
    assert_true(color_of(ColorMap::VIRIDIS, 1) == (Rgb{253, 231, 37}));
    assert_true(color_of(ColorMap::VIRIDIS, 5) == (Rgb{253, 231, 37}));
    assert_true(color_of(ColorMap::RAINBOW, 0.5) == (Rgb{0, 255, 0}));
    assert_true(color_of(ColorMap::RAINBOW, NAN) == (Rgb{0, 0, 255}));
}

/* The formats of the real files agree where they hold the same horizon. */
static void real_grids_are_read(void **)
{
    const char *models = getenv("GEOTEX_MODELS");
    if (!models)
        skip();
    const std::string folder = std::string(models) + "/heightfields/";
    Task task(1, nullptr, nullptr);
    const HeightGrid grid = read_grid(folder + "reek/1_topreek_rota.gri", {}, task);
    assert_int_equal(grid.nx, 554);
    assert_int_equal(grid.ny, 451);
    const HeightGrid zmap = read_grid(folder + "reek/1_topreek_nonrota.zmap.gz", {}, task);
    assert_int_equal(zmap.nx, 205);
    assert_int_equal(zmap.ny, 209);
    auto range = [](const HeightGrid &g) {
        double low = INFINITY, high = -INFINITY;
        for (float v : g.values)
            if (!std::isnan(v)) {
                low = std::min(low, double(v));
                high = std::max(high, double(v));
            }
        return std::array<double, 2>{low, high};
    };
    assert_true(std::fabs(range(grid)[0] - 1547.2) < 0.1);
    assert_true(std::fabs(range(zmap)[0] - range(grid)[0]) < 20);
    assert_true(std::fabs(range(zmap)[1] - range(grid)[1]) < 20);
    const HeightGrid srtm = read_grid(folder + "srtm/N46E008.tif", {}, task);
    assert_true(srtm.nx == 1201 && srtm.ny == 1201 && range(srtm)[0] > -500);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(irap_classic_is_read),
        cmocka_unit_test(irap_binary_is_read),
        cmocka_unit_test(zmap_is_read),
        cmocka_unit_test(truncated_grids_are_refused),
        cmocka_unit_test(hostile_headers_are_refused),
        cmocka_unit_test(negative_steps_are_turned_round),
        cmocka_unit_test(images_are_read_from_the_top),
        cmocka_unit_test(parts_become_one_surface),
        cmocka_unit_test(colours_go_from_end_to_end),
        cmocka_unit_test(real_grids_are_read),
    };
    return cmocka_run_group_tests_name("grid", tests, nullptr, nullptr);
}
