/* gtx horizons; gtx unpack and gtx pack: there and back again, edits, folders of no asset. */
#include "cli/command.h"

#include "image/image.h"

#include <glob.h>
#include <unistd.h>

/* Replaces the first `from` in a text file. */
static void edit(const char *name, const char *from, const char *to)
{
    size_t size;
    char *text = slurp(name, &size);
    text[size] = 0;
    char *at = strstr(text, from);
    if (!at)
        fail_msg("'%s' is not in %s", from, name);
    FILE *file = fopen(in_folder(name), "wb");
    fwrite(text, 1, (size_t)(at - text), file);
    fputs(to, file);
    fputs(at + strlen(from), file);
    fclose(file);
    free(text);
}

static void there_and_back_again(const char *name)
{
    run_shell("rm -rf maps back.gtx");
    expect(gtx("unpack %s maps", name), 0);
    expect(gtx("pack maps -o back.gtx"), 0);
    same_files(name, "back.gtx");
}

static void every_golden_file_comes_back(void **state)
{
    (void)state;
    glob_t found;
    unsigned done = 0;
    assert_int_equal(glob("tests/golden/good/*.gtx", 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; ++i) {
        char command[512];
        if (strstr(found.gl_pathv[i], "unknown"))
            continue;
        snprintf(command, sizeof command, "cp '%s' %s/golden.gtx", found.gl_pathv[i], folder);
        assert_int_equal(system(command), 0);
        there_and_back_again("golden.gtx");
        ++done;
    }
    globfree(&found);
    assert_true(done > 8);
}

static void cooked_assets_come_back(void **state)
{
    (void)state;
    static const char *const options[] = {"", "--zstd 0", "--zstd 9 --mips 1", "--height-bits 16",
                                          "--lod-levels 5"};
    for (size_t i = 0; i < sizeof options / sizeof *options; ++i) {
        expect(gtx("cook -q sphere.obj -o c.gtx %s", options[i]), 0);
        there_and_back_again("c.gtx");
    }
}

/* An asset in place of a folder, and an LOD mesh that needs no mesh. */
static void an_asset_is_packed_anew(void **state)
{
    (void)state;
    expect(gtx("cook -q sphere.obj -o c.gtx"), 0);
    expect(gtx("pack c.gtx -o same.gtx"), 0);
    same_files("c.gtx", "same.gtx");
    expect(gtx("pack c.gtx -o lod.gtx --lod-levels 3"), 0);
    expect(gtx("validate lod.gtx"), 0);
    expect(gtx("info lod.gtx"), 0);
    expect_text("LOD meshes ");
    expect(gtx("pack sphere.obj -o no.gtx"), 3);
    expect(gtx("pack c.gtx -o no.gtx --lod-levels 6"), 1);
}

static const char classic[] = "-996 3 10 10\n0 20 0 20\n3 0 0 0\n0 0 0 0 0 0 0\n"
                              "1 2 3\n2 3 4\n3 4 5\n";

static const char elsewhere[] = "-996 2 10 10\n500 510 0 10\n2 0 0 0\n0 0 0 0 0 0 0\n1 2 3 4\n";

static void grids_become_an_asset(void **state)
{
    (void)state;
    write_file("a.irap", classic, sizeof classic - 1);
    expect(gtx("horizons a.irap -o h.gtx --vertical 2 --colors rainbow"), 0);
    expect_text("9 nodes, 8 triangles, 1 patches");
    expect(gtx("validate h.gtx"), 0);
    expect(gtx("horizons a.irap=a.irap a.irap@100,0 -q -o h.gtx"), 0);
    expect(gtx("horizons a.irap a.irap@20,0 --one-surface -o h.gtx"), 0);
    expect_text("15 nodes, 16 triangles");
    write_file("b.irap", classic, sizeof classic - 3);
    expect(gtx("horizons b.irap -o no.gtx"), 3);
    expect_text("b.irap: error[input]");
    write_file("c.irap", elsewhere, sizeof elsewhere - 1);
    expect(gtx("horizons a.irap=c.irap -o no.gtx"), 3);
    expect_text("c.irap: error[input]: it has no value anywhere on its grid");
    expect(gtx("horizons nowhere.irap -o no.gtx"), 2);
    expect(gtx("horizons a.irap"), 1);
    expect(gtx("horizons a.irap -o no.gtx --spacing 3"), 1);
    expect(gtx("horizons a.irap@x -o no.gtx"), 1);
    expect(gtx("horizons a.irap -o no.gtx --missing 1 --vertical 0"), 1);
    assert_false(exists("no.gtx"));
}

/* What `gtx horizons ARGUMENTS` says, and then what gtx info does of its asset. */
static void horizons_tells(const char *arguments, const char *said, const char *info)
{
    expect(gtx("horizons %s --output h.gtx", arguments), 0);
    expect_text(said);
    expect(gtx("info h.gtx"), 0);
    expect_text(info);
}

static void grids_lie_where_options_say(void **state)
{
    (void)state;
    static const uint8_t codes[4] = {0, 128, 255, 64};
    gtx_error error;
    if (gtx_image_write_png(in_folder("g.png"), 2, 2, 1, codes, &error))
        fail_msg("%s", error.message);
    write_file("a.irap", classic, sizeof classic - 1);
    horizons_tells("a.irap", "colours 1 to 5", "bounds          -16 1 -4 .. 4 5 16");
    horizons_tells("a.irap --depths", "colours 1 to 5", "bounds          -16 -5 -4 .. 4 -1 16");
    horizons_tells("a.irap --origin 100,200", "9 nodes", "anchor          112 0 -208");
    horizons_tells("a.irap --rotation 90", "9 nodes", "anchor          -16 0 -16");
    horizons_tells("a.irap --unit 0.5", "9 nodes", "unit            0.5 m");
    horizons_tells("a.irap --color-range 0,10", "colours 0 to 10", "anchor          16 0 -16");
    horizons_tells("g.png", "colours 0 to 255", "-128 -1 .. 1 127 0");
    horizons_tells("g.png --range 0,51", "colours 0 to 51", "bounds          0 -32 -1 .. 1 19 0");
    horizons_tells("g.png=g.png --property-range 0,51", "colours 0 to 51", "-128 -1 .. 1 127 0");
}

static void tiles_bound_the_patches(void **state)
{
    (void)state;
    uint8_t flat[40 * 40] = {0};
    gtx_error error;
    if (gtx_image_write_png(in_folder("flat.png"), 40, 40, 1, flat, &error))
        fail_msg("%s", error.message);
    horizons_tells("flat.png", ", 1 patches", "patches         1 ");
    horizons_tells("flat.png --tile 16", ", 9 patches", "patches         9 ");
}

static void unknown_sections_are_warned_of(void **state)
{
    (void)state;
    char command[512];
    snprintf(command, sizeof command, "cp tests/golden/good/unknown.gtx %s/u.gtx", folder);
    assert_int_equal(system(command), 0);
    run_shell("rm -rf maps");
    expect(gtx("unpack u.gtx maps"), 0);
    expect_text("warning[other-bytes]: packed again it will have other bytes");
    expect(gtx("pack maps -o back.gtx"), 0);
    expect(gtx("validate back.gtx"), 0);
}

static void edits_arrive(void **state)
{
    (void)state;
    run_shell("rm -rf maps && cp sphere.gtx e.gtx");
    expect(gtx("unpack e.gtx maps"), 0);
    edit("maps/asset.json", "\"unit\": 1.0", "\"unit\": 0.5");
    expect(gtx("pack maps -o e.gtx --zstd 0"), 0);
    expect(gtx("info e.gtx"), 0);
    expect_text("0.5 m");
    gtx_raw_image image; /* lower every height: spheres and bounds no longer hold */
    assert_int_equal(gtx_image_read_raw(in_folder("maps/height-0.png"), &image, NULL), GTX_OK);
    uint8_t *codes = image.pixels;
    for (size_t i = 0; i < (size_t)image.width * image.height; ++i)
        codes[i] = (uint8_t)(codes[i] ? 1 + (codes[i] - 1) / 8 : 0);
    assert_int_equal(gtx_image_write_png(in_folder("maps/height-0.png"), image.width, image.height,
                                         1, codes, NULL), GTX_OK);
    free(image.pixels);
    edit("maps/asset.json", "\"coverage\": 0.", "\"coverage\": 0.0");
    expect(gtx("pack maps -o e.gtx"), 0);
    expect_text("computed anew from the heights");
    expect(gtx("validate e.gtx"), 0);
    there_and_back_again("e.gtx");
}

static void what_is_there_stays(void **state)
{
    (void)state;
    run_shell("rm -rf maps && mkdir maps && echo mine >maps/note");
    expect(gtx("unpack sphere.gtx maps"), 2);
    expect_text("maps: error[write]: is there and not an empty folder");
    run_shell("test \"$(cat maps/note)\" = mine && rm maps/note");
    expect(gtx("unpack sphere.gtx maps"), 0); /* an empty folder will do */
    expect(gtx("unpack sphere.gtx no/such/place"), 2);
    expect(gtx("unpack sphere.obj other"), 3);
    assert_false(exists("other") || left_over());
    expect(gtx("pack maps -o sphere.gtx"), 0);
    expect(gtx("pack nothing -o sphere.gtx"), 2);
    expect(gtx("validate sphere.gtx"), 0);
    expect(gtx("pack maps"), 1);
}

static void what_is_no_asset_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *says; /* an edit of asset.json */
        int code;
    } bad[] = {
        {"{", "[", "is not a JSON object", 3},
        {"asset 1", "asset 9", "format is not", 3},
        {"\"mip_count\": 4", "\"mip_count\": 0", "not those of an asset", 3},
        {"\"mip_count\": 4", "\"mip_count\": 9", "mip_count is not a whole number", 3},
        {"\"mip_count\": 4", "\"mip_count\": -1", "mip_count is not a whole number", 3},
        {"\"mip_count\": 4", "\"mip_counts\": 4", "mip_count is missing", 3},
        {"\"mip_count\": 4", "\"mip_count\": 5", "normal-0-4.png", 2},
        {"\"height_bits\": 8", "\"height_bits\": 16", " x 16", 3},
        {"\"height_bits\": 8", "\"height_bits\": 12", "not those of an asset", 3},
        {"\"page_count\": 1", "\"page_count\": 2", "height-1.png", 2},
        {"\"page_count\": 1", "\"page_count\": 2000000000", "page_count is not a whole number", 3},
        {"\"has_color\": false", "\"has_color\": 0", "has_color is neither", 3},
        {"\"has_color\": false", "\"has_color\": true", "color-0-0.png", 2},
        {"\"origin\": [", "\"origin\": [\"x\",", "origin is not", 3},
        {"\"axis_x\"", "\"axis_q\"", "axis_x is missing", 3},
        {"\"patches\": [", "\"patches\": [7,", "a patch is not an object", 3},
        {"\"dilation\": ", "\"dilation\": 9999", "dilation is not", 3},
        {"\"unit\": 1.0", "\"unit\": 1e400", "is not a JSON object", 3},
        {"\"unit\": 1.0", "\"unit\": -1.0", "unit", 3},
        {"\"lod_meshes\": [", "\"LOD meshes\": [", "lod_meshes is missing", 3},
        {"\"lod_meshes\": [", "\"lod_meshes\": [7,", "one of lod_meshes is not an object", 3},
        {"\"step\": ", "\"step\": -", "step positive", 3},
        {"\"triangles\": ", "\"triangles\": 1", "lod-0.bin: error[input]: has not the size", 3},
        {"\"vertices\": ", "\"vertices\": -", "vertices is not a whole number", 3},
    };
    run_shell("rm -rf maps");
    expect(gtx("cook -q sphere.obj --lod-levels 3 -o s.gtx"), 0);
    expect(gtx("unpack s.gtx maps"), 0);
    run_shell("cp maps/asset.json good.json && rm -f no.gtx");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        run_shell("cp good.json maps/asset.json");
        edit("maps/asset.json", bad[i].from, bad[i].to);
        const int code = gtx("pack maps -o no.gtx");
        if (code != bad[i].code || !strstr(output, bad[i].says) || exists("no.gtx"))
            fail_msg("edit %zu: exit code %d, not %d '%s': %s", i, code, bad[i].code, bad[i].says,
                     output);
    }
    run_shell("cp good.json maps/asset.json && cp maps/normal-0-1.png maps/normal-0-0.png");
    expect(gtx("pack maps -o no.gtx"), 3);
    expect_text("normal-0-0.png: error[input]: is ");
    run_shell("echo nonsense >maps/normal-0-0.png");
    expect(gtx("pack maps -o no.gtx"), 2);
    run_shell("rm maps/normal-0-0.png");
    expect(gtx("pack maps -o no.gtx"), 2);
    assert_false(exists("no.gtx"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_golden_file_comes_back),
        cmocka_unit_test(cooked_assets_come_back),
        cmocka_unit_test(an_asset_is_packed_anew),
        cmocka_unit_test(grids_become_an_asset),
        cmocka_unit_test(grids_lie_where_options_say),
        cmocka_unit_test(tiles_bound_the_patches),
        cmocka_unit_test(unknown_sections_are_warned_of),
        cmocka_unit_test(edits_arrive),
        cmocka_unit_test(what_is_there_stays),
        cmocka_unit_test(what_is_no_asset_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
