/* CPS-3 and NetCDF, hostile too; values at other nodes; parts, copies and layers of surfaces. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "grid/grid.hpp"
#include "grid/netcdf.hpp"

#include <cstdlib>
#include <cstring>
#include <functional>

using namespace gtx;

static gtx_result failure(const std::function<void()> &call)
{
    try {
        call();
    } catch (const Error &e) {
        assert_true(e.message.size() > 8);
        return e.result;
    }
    return GTX_OK;
}

/* Three by two nodes, the first row in the south, one without a value. */
static void expect(const HeightGrid &grid, double x, double y, double dx, double dy)
{
    assert_true(grid.nx == 3 && grid.ny == 2);
    assert_true(grid.at(0, 1) == 1.5f && grid.at(1, 1) == 2 && grid.at(2, 1) == 3);
    assert_true(grid.at(0, 0) == 4 && std::isnan(grid.at(1, 0)) && grid.at(2, 0) == 6);
    assert_true(std::fabs(grid.origin[0] - x) < 1e-6 && std::fabs(grid.origin[1] - y) < 1e-6);
    assert_true(std::fabs(grid.step[0] - dx) < 1e-9 && std::fabs(grid.step[1] - dy) < 1e-9);
}

/* ---- files ---- */

static const std::string CPS3 = "FSASCI 0 1 \"Computed\" 0 1.0E+30\nFSATTR 0 0\n"
                                "FSLIMI 100 120 50 70 1.5 6\nFSNROW 2 3\nFSXINC 10 20\n->top\n"
                                "1.5 4 2 1.0E+30\n3 6\n";

static void cps3_is_read(void **)
{
    assert_true(is_cps3(CPS3) && !is_zmap(CPS3));
    expect(read_cps3(CPS3), 100, 50, 10, 20);
    /* Comments first, a name of two words, more numbers behind the marker of no value. */
    std::string other = "! made by hand\n! for a test\n" + CPS3;
    other.replace(other.find("\"Computed\" 0 1.0E+30"), 20, "\"Computed twice\" 0 1E30 0");
    assert_true(is_cps3(other) && !is_zmap(other));
    expect(read_cps3(other), 100, 50, 10, 20);
    other.replace(other.find("\n3 6"), 4, "\n0 6"); /* 0 is a value */
    assert_true(read_cps3(other).at(2, 1) == 0);
    for (size_t size = 0; size < CPS3.size() - 2; ++size)
        assert_int_equal(failure([&] { read_cps3(CPS3.substr(0, size)); }), GTX_ERROR_INPUT);
    for (const char *line : {"FSNROW 2000000 3000000", "FSNROW -2 3", "FSNROW .5 3", "FSNROW x"}) {
        std::string bad = CPS3;
        bad.replace(bad.find("FSNROW 2 3"), 10, line);
        assert_int_not_equal(failure([&] { read_cps3(bad); }), GTX_OK);
    }
}

static void netcdf_is_read(void **)
{
    for (int version : {1, 2, 5}) {
        const std::string file = netcdf(version);
        assert_true(is_netcdf(file));
        expect(read_netcdf(file), 100, 50, 10, 20);
        assert_false(read_netcdf(file).in_degrees);
    }
    NetCdf how;
    how.unit = "degrees_east";
    assert_true(read_netcdf(netcdf(1, how)).in_degrees);
    how.unit = "km"; /* and heights in metres */
    expect(read_netcdf(netcdf(1, how)), 100000, 50000, 10000, 20000);
    how = {};
    how.has_places = false;
    assert_true(read_netcdf(netcdf(1, how)).is_unplaced);
    how = {};
    how.is_packed = true;
    const HeightGrid packed = read_netcdf(netcdf(2, how));
    assert_true(packed.at(0, 1) == 1.5f && packed.at(2, 0) == 6 && std::isnan(packed.at(1, 0)));
    how = {};
    how.grids = 2;
    assert_int_equal(failure([&] { read_netcdf(netcdf(1, how)); }), GTX_ERROR_INPUT);
    how = {};
    how.last_x = 121; /* steps that differ */
    assert_int_equal(failure([&] { read_netcdf(netcdf(1, how)); }), GTX_ERROR_INPUT);
}

static void hostile_netcdf_is_refused(void **)
{
    uint64_t state = 1;
    const auto random = [&] {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return size_t(state >> 33);
    };
    for (int version : {1, 2, 5}) {
        const std::string good = netcdf(version);
        for (size_t size = 4; size < good.size(); ++size)
            assert_int_not_equal(failure([&] { read_netcdf(good.substr(0, size)); }), GTX_OK);
        size_t refused = 0;
        for (int turn = 0; turn < 4000; ++turn) {
            std::string bad = good;
            for (size_t k = 1 + random() % 3; k > 0; --k)
                bad[4 + random() % (bad.size() - 4)] = char(random() % 2 ? random() : 255);
            refused += failure([&] { read_netcdf(bad); }) != GTX_OK;
        }
        assert_true(refused > 1000);
    }
}

/* ---- other nodes ---- */

static HeightGrid plane(uint32_t nx, uint32_t ny, double x, double y, double step)
{
    HeightGrid grid;
    grid.nx = nx;
    grid.ny = ny;
    grid.origin[0] = x;
    grid.origin[1] = y;
    grid.step[0] = grid.step[1] = step;
    for (uint32_t j = 0; j < ny; ++j)
        for (uint32_t i = 0; i < nx; ++i)
            grid.values.push_back(float(2 * (x + i * step) - 3 * (y + j * step)));
    return grid;
}

static double farthest(const Vector<float> &values, const HeightGrid &truth)
{
    double far = 0;
    for (size_t k = 0; k < values.size(); ++k)
        far = std::max(far, std::isnan(values[k]) ? INFINITY
                                                  : std::fabs(double(values[k] - truth.values[k])));
    return far;
}

static void planes_stay_planes(void **)
{
    const HeightGrid coarse = plane(11, 11, 0, 0, 10), fine = plane(181, 181, 5, 5, 0.5);
    assert_true(farthest(resample(coarse, fine), fine) < 1e-4);
    /* The mean of a plane around a node is its value there. */
    const HeightGrid nodes = plane(8, 8, 10, 10, 10);
    assert_true(farthest(resample(fine, nodes), nodes) < 1e-4);
    HeightGrid turned = plane(5, 5, 0, 0, 1);
    turned.origin[0] = 50;
    turned.origin[1] = 50;
    turned.rotation = 30;
    for (uint32_t j = 0; j < 5; ++j)
        for (uint32_t i = 0; i < 5; ++i) {
            const auto at = turned.place(i, j);
            turned.values[j * 5 + i] = float(2 * at[0] - 3 * at[1]);
        }
    assert_true(farthest(resample(coarse, turned), turned) < 1e-4);
}

static void finer_values_are_averaged(void **)
{
    HeightGrid stripes = plane(101, 101, 0, 0, 1);
    for (size_t k = 0; k < stripes.count(); ++k)
        stripes.values[k] = float(k % 101 % 2);
    const HeightGrid coarse = plane(9, 9, 10, 10, 10);
    for (float value : resample(stripes, coarse))
        assert_true(std::fabs(value - 0.5f) < 0.06f);
}

/* Between rock 1 and rock 3 lies no rock 2. */
static void categories_stay_what_they_are(void **)
{
    HeightGrid rocks = plane(11, 11, 0, 0, 10);
    rocks.has_categories = true;
    for (size_t k = 0; k < rocks.count(); ++k)
        rocks.values[k] = k % 11 < 5 ? 1 : 3;
    const HeightGrid fine = plane(181, 181, 5, 5, 0.5), coarse = plane(3, 3, 5, 5, 45);
    for (const HeightGrid *to : {&fine, &coarse}) {
        const Vector<float> values = resample(rocks, *to);
        for (size_t k = 0; k < values.size(); ++k) {
            const double x = to->place(k % to->nx, 0)[0];
            assert_true(values[k] == 1 || values[k] == 3);
            if (to == &fine && x != 45) /* as far from both */
                assert_true(values[k] == (x < 45 ? 1 : 3));
        }
    }
    /* Three columns of 1 for every two of 7: the most frequent, not the mean. */
    HeightGrid stripes = plane(101, 101, 0, 0, 1);
    stripes.has_categories = true;
    for (size_t k = 0; k < stripes.count(); ++k)
        stripes.values[k] = k % 101 % 5 < 3 ? 1 : 7;
    for (float value : resample(stripes, plane(8, 8, 12, 12, 10)))
        assert_true(value == 1);
}

static void what_is_missing_stays_so(void **)
{
    HeightGrid from = plane(11, 11, 0, 0, 10);
    from.values[5 * 11 + 5] = NAN;
    const HeightGrid to = plane(21, 21, 0, 0, 5);
    const Vector<float> values = resample(from, to);
    assert_true(std::isnan(values[10 * 21 + 10]) && !std::isnan(values[10 * 21 + 12]));
    /* Nodes beside all of it have none; nothing in common is a mistake. */
    const Vector<float> beside = resample(from, plane(11, 11, 50, 0, 10));
    assert_true(!std::isnan(beside[5]) && std::isnan(beside[7]));
    assert_int_equal(failure([&] { resample(from, plane(5, 5, 1000, 0, 10)); }), GTX_ERROR_INPUT);
    HeightGrid degrees = from;
    degrees.in_degrees = true;
    assert_int_equal(failure([&] { resample(degrees, to); }), GTX_ERROR_INPUT);
    /* An image reaches over all. */
    HeightGrid image = plane(2, 2, 0, 0, 1);
    image.is_unplaced = true;
    image.values = {0, 1, 0, 1};
    const Vector<float> over = resample(image, plane(5, 5, 1000, 1000, 10));
    for (size_t k = 0; k < over.size(); ++k)
        assert_true(std::fabs(over[k] - float(k % 5) / 4) < 1e-6f);
}

static void degrees_become_metres(void **)
{
    HeightGrid grid = plane(3, 3, 10, 46, 0.001);
    grid.in_degrees = true;
    use_local_metres(grid, 46);
    assert_false(grid.in_degrees);
    /* WGS 84: M = a (1 - e2) / (1 - e2 sin2)^1.5, N cos = a cos / (1 - e2 sin2)^0.5. */
    const double phi = 46 * std::acos(-1.0) / 180, a = 6378137, e2 = 0.00669437999014;
    const double w = 1 - e2 * std::sin(phi) * std::sin(phi), degree = std::acos(-1.0) / 180;
    const double north = a * (1 - e2) / std::pow(w, 1.5) * degree;
    const double east = a * std::cos(phi) / std::sqrt(w) * degree;
    assert_true(std::fabs(grid.step[0] / (0.001 * east) - 1) < 1e-5);
    assert_true(std::fabs(grid.step[1] / (0.001 * north) - 1) < 1e-5);
    grid.in_degrees = true;
    assert_int_equal(failure([&] { use_local_metres(grid, 90); }), GTX_ERROR_INPUT);
}

/* ---- mistakes ---- */

static HeightGrid hills(double x, double y, double height)
{
    HeightGrid grid = plane(41, 41, x, y, 1);
    for (uint32_t j = 0; j < 41; ++j)
        for (uint32_t i = 0; i < 41; ++i)
            grid.values[j * 41 + i] =
                float(height + 5 * std::sin((x + i) / 4) * std::cos((y + j) / 5));
    return grid;
}

static void copies_and_layers_are_told_apart(void **)
{
    assert_true(are_alike(hills(0, 0, 0), hills(0, 0, 0)));
    assert_true(are_alike(hills(0, 0, 0), hills(10, 5, 0)));   /* tiles that overlap */
    assert_false(are_alike(hills(0, 0, 0), hills(0, 0, 10)));  /* layers */
    assert_false(are_alike(hills(0, 0, 0), hills(100, 0, 0))); /* apart */
    assert_int_equal(count_crossings(hills(0, 0, 0), hills(0, 0, 10)), 0);
    HeightGrid low = hills(0, 0, 10);
    for (size_t k = 0; k < 7; ++k)
        low.values[3 * k] -= 20;
    low.values[100] = NAN;
    assert_int_equal(count_crossings(hills(0, 0, 0), low), 7);
    assert_int_equal(count_crossings(hills(0, 0, 0), hills(1, 0, -10)), 0); /* of no lattice */
}

static void parts_tell_where_they_differ(void **)
{
    HeightGrid right = hills(31, 0, 0); /* ten columns of forty-one rows in common */
    SharedNodes shared;
    mosaic({hills(0, 0, 0), right}, Limits(), &shared);
    assert_int_equal(shared.count, 410);
    const uint64_t rounded = shared.differing;
    assert_true(shared.difference < 1e-5);
    for (size_t k = 0; k < 3; ++k)
        right.values[k] += float(k + 1);
    shared = {};
    const HeightGrid whole = mosaic({hills(0, 0, 0), right}, Limits(), &shared);
    assert_true(shared.differing >= 3 && shared.differing <= rounded + 3);
    assert_true(std::fabs(shared.difference - 3) < 1e-4);
    assert_true(whole.at(32, 0) == hills(0, 0, 0).at(32, 0)); /* the first part's */
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cps3_is_read),
        cmocka_unit_test(netcdf_is_read),
        cmocka_unit_test(hostile_netcdf_is_refused),
        cmocka_unit_test(planes_stay_planes),
        cmocka_unit_test(finer_values_are_averaged),
        cmocka_unit_test(categories_stay_what_they_are),
        cmocka_unit_test(what_is_missing_stays_so),
        cmocka_unit_test(degrees_become_metres),
        cmocka_unit_test(copies_and_layers_are_told_apart),
        cmocka_unit_test(parts_tell_where_they_differ),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
