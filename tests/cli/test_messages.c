/* What the command says: one line each, with nothing that a terminal would obey, and by name. */
#include "cli/command.h"

#define ODD "$(printf 'a\\033[31m\\nb\\302\\233\\377.obj')"

static void one_clean_line(void)
{
    const size_t size = strlen(output);
    assert_true(size && output[size - 1] == '\n');
    for (size_t i = 0; i + 1 < size; ++i)
        if (output[i] < 0x20 || output[i] == 0x7f)
            fail_msg("byte %d in: %s", output[i], output);
}

static void paths_hold_anything(void **state)
{
    static const char *const commands[] = {
        "cook \"" ODD "\" -o a.gtx",
        "cook sphere.obj -q -o \"nowhere/" ODD "\"",
        "cook sphere.obj -q -o a.gtx --report \"nowhere/" ODD "\"",
        "cook sphere.obj -o \"" ODD ".gtx\"",
        "cook sphere.obj \"" ODD "\" -o a.gtx",
        "cook sphere.obj -o a.gtx --charts \"" ODD "\"",
        "cook sphere.obj -o a.gtx \"--" ODD "\"",
        "horizons \"" ODD "\" -o a.gtx",
        "info \"" ODD "\"",
        "validate \"" ODD "\"",
        "validate \"" ODD ".gtx/\"",
        "unpack \"" ODD "\" maps",
        "unpack sphere.gtx \"nowhere/" ODD "\"",
        "pack \"" ODD "\" -o a.gtx",
        "filter sphere.gtx -o a.gtx --pattern \"" ODD "\"",
        "filter \"" ODD "\" -o a.gtx --gaussian 1",
        "combine \"" ODD "\" sphere.gtx -o a.gtx --op union",
        "render \"" ODD "\" -o a.png",
        "view \"" ODD "\"",
        "compare sphere.gtx \"" ODD "\"",
        "compare \"" ODD "\" sphere.obj",
        "bench \"" ODD "\" sphere.obj",
        "bench sphere.gtx sphere.obj --methods \"" ODD "\"",
        "\"" ODD "\"",
    };
    (void)state;
    for (size_t i = 0; i < sizeof commands / sizeof *commands; ++i) {
        const int code = gtx("%s", commands[i]);
        assert_int_equal(code == 0, i == 3); /* which tells what it made */
        expect_text("31m");
        one_clean_line();
    }
}

/* Found before the work, whichever path it is. */
static void dependency_files_name_no_line_breaks(void **state)
{
    static const char model[] = "mtllib l\rb.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char scene[] = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,"
                                "\"uri\":\"l%0Ab.bin\"}]}";
    (void)state;
    write_file("l\nb.obj", model, sizeof model - 1);
    write_file("s.gltf", scene, sizeof scene - 1);
    write_file("l\nb.bin", "data", 4);
    static const char *const commands[] = {
        "cook \"$(printf 'l\\nb.obj')\" -o no.gtx --depfile no.d",
        "cook sphere.obj -o \"$(printf 'l\\nb.gtx')\" --depfile no.d",
        "cook s.gltf -o no.gtx --depfile no.d", /* it has no triangle, but that comes later */
    };
    for (size_t i = 0; i < sizeof commands / sizeof *commands; ++i) {
        expect(gtx("%s", commands[i]), 1);
        expect_text("a dependency file cannot name a path with a line break");
        one_clean_line();
        assert_false(exists("no.gtx") || exists("no.d") || exists("l\nb.gtx"));
    }
}

static void passed_limits_are_told(void **state)
{
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    (void)state;
    write_file("open.obj", text, sizeof text - 1);
    expect(gtx("compare sphere.gtx open.obj --any-model --size 64 --levels 1 --min-iou 0.9 "
               "--max-rms 0.001"), 7);
    expect_text("open.obj: note[open-edges]: 1 component with a border");
    expect_text("sphere.gtx: error[differs]: silhouette IoU 0.");
    expect_text(": below --min-iou 0.9\n");
    expect_text("sphere.gtx: error[differs]: forward RMS 0.");
    expect_text(": above --max-rms 0.001\n");
    assert_null(strstr(output, "--max-holes"));
    expect(gtx("cook open.obj -q -o open.gtx"), 0);
    expect(gtx("compare open.gtx sphere.obj --size 64 --levels 1 --any-model --max-holes 3"), 7);
    expect_text(": above --max-holes 3\n");
    assert_null(strstr(output, "--min-iou"));
    /* The sphere is far larger: before the triangle's background stand nothing but walls. */
    expect(gtx("compare sphere.gtx open.obj --any-model --size 64 --levels 1 --max-walls 3"), 7);
    expect_text("sphere.gtx: error[differs]: wall pixels ");
    expect_text(": above --max-walls 3\n");
    expect(gtx("compare sphere.gtx sphere.obj --size 64 --levels 1 --max-turned 0"), 0);
}

static void another_model_is_refused(void **state)
{
    (void)state;
    write_sphere("moved.obj", 40);
    expect(gtx("cook moved.obj -q -o moved.gtx"), 0);
    expect(gtx("compare moved.gtx moved.obj --size 64 --levels 1"), 0);
    write_sphere("moved.obj", 39);
    expect(gtx("compare moved.gtx moved.obj --size 64 --levels 1"), 3);
    expect_text("moved.obj: error[input]: the asset was cooked from another model, or this one "
                "or its textures have changed since (--any-model compares with it)\n");
    one_clean_line();
    expect(gtx("compare sphere.gtx moved.obj sphere.obj --size 64 --levels 1"), 3);
    expect_text("gtx compare: error[input]: the asset was cooked from other models");
    expect(gtx("compare moved.gtx moved.obj --size 64 --levels 1 --any-model"), 0);
    /* What tells no source is compared with anything. */
    expect(gtx("combine moved.gtx sphere.gtx --op union -q -o both.gtx"), 0);
    expect(gtx("compare both.gtx sphere.obj --size 64 --levels 1"), 0);
}

static void every_verb_prints_warnings(void **state)
{
    (void)state;
    expect(gtx("cook open.obj -o a.gtx"), 0);
    expect_text("open.obj: note[open-edges]: ");
    expect(gtx("compare a.gtx open.obj --size 64 --levels 1"), 0);
    expect_text("open.obj: note[open-edges]: ");
    const int code = gtx("bench a.gtx open.obj --sizes 16x16 --methods cast --frames 1");
    expect_text("open.obj: note[open-edges]: ");
    if (code == 5)
        skip();
    expect(gtx("render open.obj --size 16x16 -o a.png"), 0);
    expect_text("open.obj: note[open-edges]: ");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_hold_anything),
        cmocka_unit_test(dependency_files_name_no_line_breaks),
        cmocka_unit_test(passed_limits_are_told),
        cmocka_unit_test(another_model_is_refused),
        cmocka_unit_test(every_verb_prints_warnings),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
