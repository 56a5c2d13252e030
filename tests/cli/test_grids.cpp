/* Height grids from the command line: every text format alike, properties of other sizes, degrees,
 * what may be a mistake, and pictures of them. */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

extern "C" {
#include "cli/command.h"
#include "image/image.h"
}
#include "grid/netcdf.hpp"

#include <unistd.h>

static void write_text(const std::string &name, const std::string &text)
{
    std::ofstream(in_folder(name.c_str()), std::ios::binary) << text;
}

using Height = std::function<double(double x, double y)>;

static double hills(double x, double y)
{
    return 10 * std::sin(x / 30) * std::cos(y / 40);
}

/* A lattice of nodes as IRAP or as CPS-3. */
struct Lattice {
    int nx = 33, ny = 25;
    double x = 1000, y = 2000, step = 10;
};

static std::string irap(const Lattice &l, const Height &height)
{
    std::ostringstream out;
    out.precision(9);
    out << "-996 " << l.ny << " " << l.step << " " << l.step << "\n" << l.x << " "
        << l.x + l.step * (l.nx - 1) << " " << l.y << " " << l.y + l.step * (l.ny - 1) << "\n"
        << l.nx << " 0 " << l.x << " " << l.y << "\n0 0 0 0 0 0 0\n";
    for (int j = 0; j < l.ny; ++j)
        for (int i = 0; i < l.nx; ++i)
            out << height(l.x + i * l.step, l.y + j * l.step) << "\n";
    return out.str();
}

static std::string cps3(const Lattice &l, const Height &height)
{
    std::ostringstream out;
    out.precision(9);
    out << "FSASCI 0 1 COMPUTED 0 1E30\nFSATTR 0 0\nFSLIMI " << l.x << " "
        << l.x + l.step * (l.nx - 1) << " " << l.y << " " << l.y + l.step * (l.ny - 1)
        << " -10 10\nFSNROW " << l.ny << " " << l.nx << "\nFSXINC " << l.step << " " << l.step
        << "\n->hills\n";
    for (int i = 0; i < l.nx; ++i)
        for (int j = l.ny - 1; j >= 0; --j)
            out << height(l.x + i * l.step, l.y + j * l.step) << "\n";
    return out.str();
}

static std::string ascii_in_degrees()
{
    std::ostringstream out;
    out << "ncols 20\nnrows 20\nxllcenter 10\nyllcenter 46\ncellsize 0.001\n";
    for (int k = 0; k < 400; ++k)
        out << 500 + 30 * std::sin(k / 9.) << "\n";
    return out.str();
}

static void formats_give_the_same_asset(void **)
{
    write_text("a.irap", irap({}, hills));
    write_text("a.cps3", cps3({}, hills));
    expect(gtx("horizons a.irap -q -o irap.gtx"), 0);
    expect(gtx("horizons a.cps3 -q -o cps3.gtx"), 0);
    same_files("irap.gtx", "cps3.gtx");
    write_text("a.nc", netcdf(1));
    expect(gtx("horizons a.nc -o nc.gtx"), 3); /* one of its four nodes is missing */
    expect_text("no four neighbouring nodes");
    write_text("h5.nc", "\x89HDF\r\n\x1a\n and more");
    /* Read by a program of its own where that has been built, and damaged. */
    const int code = gtx("horizons h5.nc -o nc.gtx");
    assert_true(code == 3 || code == 5);
    expect_text(code == 3 ? "HDF5's library does not read it" : "nccopy -k classic");
    write_text("short.cps3", cps3({}, hills).substr(0, 900));
    expect(gtx("horizons short.cps3 -o nc.gtx"), 3);
    assert_false(exists("nc.gtx"));
}

/* Of a property with other nodes, no colour but those of its kinds. */
static void kinds_are_not_blended(void **)
{
    const auto rock = [](double x, double) { return x < 1150 ? 1 : 3; };
    write_text("rock.irap", irap({9, 7, 1000, 2000, 40}, rock));
    const char *how = "--size 200x160 --camera 0,89,2 --method cast --legend";
    unsigned other[2] = {0, 0};
    for (int k = 0; k < 2; ++k) {
        expect(gtx("horizons a.irap=rock.irap --colors rainbow%s -q -o rock.gtx",
                   k ? " --categories" : ""), 0);
        expect(gtx("render rock.gtx %s -o rock.png", how), 0);
        gtx_image image;
        gtx_error error;
        assert_int_equal(gtx_image_read(in_folder("rock.png"), &image, &error), GTX_OK);
        for (size_t i = 0; i < size_t(200) * 140; ++i) { /* blue and red, lit; green between them */
            const uint8_t *p = &image.pixels[4 * i];
            other[k] += p[1] > p[0] + 40 && p[1] > p[2] + 40;
        }
        gtx_image_free(&image);
    }
    assert_true(other[0] > 100);
    assert_int_equal(other[1], 0);
}

static void properties_have_any_size(void **)
{
    const auto slope = [](double x, double y) { return x + 2 * y; };
    write_text("same.irap", irap({}, slope));
    write_text("wide.irap", irap({60, 50, 900, 1900, 10}, slope));
    write_text("coarse.irap", irap({9, 7, 1000, 2000, 40}, slope));
    write_text("apart.irap", irap({9, 7, 90000, 2000, 40}, slope));
    for (const char *name : {"same", "wide", "coarse"})
        expect(gtx("horizons a.irap=%s.irap -q -o %s.gtx --color-range 5000,6500", name, name), 0);
    /* A plane is the same plane from any lattice: so are the maps, but for a rounding. */
    for (const char *name : {"same", "wide", "coarse"})
        expect(gtx("render %s.gtx --size 200x160 --camera 0,89,2 -o %s.png", name, name), 0);
    gtx_image first, other;
    gtx_error error;
    assert_int_equal(gtx_image_read(in_folder("same.png"), &first, &error), GTX_OK);
    for (const char *name : {"wide.png", "coarse.png"}) {
        assert_int_equal(gtx_image_read(in_folder(name), &other, &error), GTX_OK);
        for (size_t i = 0; i < size_t(4) * 200 * 160; ++i)
            if (std::abs(int(first.pixels[i]) - int(other.pixels[i])) > 2)
                fail_msg("%s differs at %zu", name, i / 4);
        gtx_image_free(&other);
    }
    gtx_image_free(&first);
    expect(gtx("horizons a.irap=apart.irap -o none.gtx"), 3);
    expect_text("apart.irap: error[input]: it has no value anywhere on its grid");
    assert_false(exists("none.gtx"));
    /* Moved together: the property is fitted to the grid's own place. */
    expect(gtx("horizons a.irap@0,0=same.irap -q -o moved.gtx"), 0);
    expect(gtx("unpack moved.gtx moved"), 0);
    std::ifstream file(in_folder("moved/asset.json"));
    std::stringstream text;
    text << file.rdbuf();
    assert_true(text.str().find("property") != std::string::npos);
}

static void mistakes_are_told(void **)
{
    write_text("left.irap", irap({}, hills));
    write_text("right.irap", irap({33, 25, 1300, 2000, 10}, hills));
    write_text("off.irap", irap({33, 25, 1300, 2000, 10},
                                [](double x, double y) { return hills(x, y) + 3; }));
    write_text("deep.irap",
               irap({}, [](double x, double y) { return hills(x, y) - x / 90 + 12; }));
    expect(gtx("horizons left.irap right.irap --one-surface -o x.gtx"), 0);
    assert_null(strstr(output, "warning"));
    expect(gtx("horizons left.irap off.irap --one-surface -o x.gtx"), 0);
    expect_text("warning[grids-differ]: of 75 nodes that parts share 75 have other values, by up "
                "to 3");
    expect(gtx("horizons left.irap off.irap --one-surface --strict -o y.gtx"), 3);
    assert_false(exists("y.gtx"));
    expect(gtx("horizons left.irap right.irap -o x.gtx"), 0);
    expect_text("warning[grids-overlap]: grids 1 and 2 have the same heights");
    expect(gtx("horizons left.irap right.irap --strict --allow grids-overlap -o x.gtx"), 0);
    expect(gtx("horizons left.irap deep.irap --strict -o x.gtx"), 0);
    expect_text("note[grids-cross]: grids lie on the other side of the next one at ");
}

static void degrees_become_metres_when_asked(void **)
{
    char self[4096] = "";
    assert_true(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
    *strrchr(self, '/') = 0;
    if (access((std::string(self) + "/../../geotex-grid.so").c_str(), F_OK))
        skip();
    write_text("deg.asc", ascii_in_degrees());
    expect(gtx("horizons deg.asc -o x.gtx"), 3);
    expect_text("--local-metres");
    expect(gtx("horizons deg.asc --local-metres -o deg.gtx"), 0);
    expect_text("note[local-metres]: degrees were taken for metres as they are at latitude 46.01");
    expect(gtx("info deg.gtx"), 0);
    expect(gtx("render deg.asc --size 64x64 -o deg.png"), 0); /* to look at, without being asked */
    expect_text("note[local-metres]");
}

/* Pixels of a picture that are darker than the same ones of another. */
static size_t darker(const char *a, const char *b)
{
    gtx_image one, two;
    gtx_error error;
    size_t count = 0;
    assert_int_equal(gtx_image_read(in_folder(a), &one, &error), GTX_OK);
    assert_int_equal(gtx_image_read(in_folder(b), &two, &error), GTX_OK);
    for (size_t i = 0; i < size_t(one.width) * one.height; ++i)
        count += one.pixels[4 * i] + 30 < two.pixels[4 * i];
    gtx_image_free(&one);
    gtx_image_free(&two);
    return count;
}

static void grids_are_drawn_with_contours(void **)
{
    const auto ramp = [](double x, double) { return (x - 1000) / 2; }; /* 0 to 160 */
    write_text("ramp.irap", irap({}, ramp));
    const char *how = "--size 320x240 --camera 0,89.9,2 ";
    expect(gtx("render ramp.irap %s -o plain.png", how), 0);
    expect(gtx("render ramp.irap %s --contours 20 -o lines.png", how), 0);
    expect(gtx("render ramp.irap %s --contours auto -o auto.png", how), 0);
    /* Seen from above: eight lines from side to side of what is some 200 pixels high. */
    const size_t lines = darker("lines.png", "plain.png");
    assert_true(lines > 800 && lines < 4000);
    assert_true(darker("auto.png", "plain.png") > lines);
    assert_int_equal(darker("plain.png", "lines.png"), 0);
    /* Exaggeration is taken off: the same lines. */
    expect(gtx("horizons ramp.irap --vertical 0.5 -q -o half.gtx"), 0);
    expect(gtx("render half.gtx %s -o half.png", how), 0);
    expect(gtx("render half.gtx %s --contours 20 -o half_lines.png", how), 0);
    const double share = double(darker("half_lines.png", "half.png")) / double(lines);
    assert_true(share > 0.7 && share < 1.4);
    for (const char *bad : {"0", "-1", "x", "1e20", "5m"}) {
        expect(gtx("render ramp.irap --contours %s -o bad.png", bad), 1);
        expect_text("--contours takes a step above 0, or auto");
    }
    assert_false(exists("bad.png"));
}

/* An asset of horizons and a world of the same grid, each against it. */
static void grids_are_sources_of_comparisons(void **)
{
    write_text("hills.irap", irap({}, hills));
    write_text("flat.cps3", cps3({}, [](double, double) { return 0; }));
    expect(gtx("horizons hills.irap -q -o hills.gtx"), 0);
    expect(gtx("world plan hills.irap -o hills --triangles 1000 --engine shell"), 0);
    assert_int_equal(std::system(("sh " + std::string(in_folder("hills/build.sh"))).c_str()), 0);
    for (const char *what : {"hills.gtx", "hills"}) {
        expect(gtx("compare %s hills.irap --size 96 --max-holes 0 --max-rms 0.001", what), 0);
        expect(gtx("compare %s flat.cps3 --size 96 --max-rms 0.001", what), 7);
        expect(gtx("compare %s hills.irap flat.cps3 --size 96 --max-holes 0", what), 7);
        expect(gtx("compare %s hills.irap --up z --size 96 --max-holes 0 --max-rms 0.001", what),
               0); /* a grid says itself where up is */
    }
    write_text("degrees.asc", ascii_in_degrees());
    expect(gtx("compare hills.gtx degrees.asc --size 96"), 3);
    expect_text("lies in degrees");
    expect(gtx("compare hills.gtx none.irap --size 96"), 2);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(formats_give_the_same_asset),
        cmocka_unit_test(mistakes_are_told),
        cmocka_unit_test(degrees_become_metres_when_asked),
        cmocka_unit_test(kinds_are_not_blended),
        cmocka_unit_test(properties_have_any_size),
        cmocka_unit_test(grids_are_drawn_with_contours),
        cmocka_unit_test(grids_are_sources_of_comparisons),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
