/* What the command may take: every verb has the options, and a limit that is passed is exit 6. Its
 * help lists those that bound something. */
#include "cli/command.h"

static void every_limit_names_its_option(void **state)
{
    (void)state;
    static const struct {
        const char *arguments, *option;
    } cases[] = {
        {"cook sphere.obj -o x.gtx --max-memory 20k", "--max-memory"},
        {"cook sphere.obj -o x.gtx --max-triangles 10", "--max-triangles"},
        {"cook sphere.obj -o x.gtx --max-work 10k", "--max-work"},
        {"cook sphere.obj -o x.gtx --max-texels 1k", "--max-texels"},
        {"cook sphere.obj -o x.gtx --max-patches 1", "--max-patches"},
        {"compare sphere.gtx sphere.obj --max-triangles 10", "--max-triangles"},
        {"horizons f/height-0.png -o x.gtx --max-pixels 3", "--max-pixels"},
        {"horizons f/height-0.png -o x.gtx --max-texels 3", "--max-texels"},
        {"info sphere.gtx --max-memory 1k", "--max-memory"},
        {"validate sphere.gtx --max-memory 1k", "--max-memory"},
        {"unpack sphere.gtx folder --max-texels 1k", "--max-texels"},
        {"filter sphere.gtx -o x.gtx --gaussian 1 --max-patches 1", "--max-patches"},
        {"combine sphere.gtx sphere.gtx -o x.gtx --op union --max-memory 1M", "--max-memory"},
        {"combine sphere.gtx sphere.gtx -o x.gtx --op union --max-cells 3", "--max-cells"},
        {"combine sphere.gtx sphere.gtx -o x.gtx --op union --max-work 100k", "--max-work"},
        {"pack sphere.gtx -o x.gtx --max-memory 1k", "--max-memory"},
        {"render sphere.gtx -o x.png --max-texels 1k", "--max-texels"},
        {"render sphere.obj -o x.png --max-triangles 10", "--max-triangles"},
    };
    expect(gtx("unpack sphere.gtx f"), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char wanted[64];
        expect(gtx("%s", cases[i].arguments), 6);
        snprintf(wanted, sizeof wanted, "(%s allows more)", cases[i].option);
        expect_text(wanted);
        expect_text("error[limit]");
        assert_int_equal(left_over(), 0);
    }
}

static void a_limit_that_help_leaves_out_bounds_nothing(void **state)
{
    (void)state;
    static const char *const limits[] = {"memory", "triangles", "texels", "pixels",
                                         "patches", "cells", "work"};
    static const struct {
        const char *verb, *arguments;
        uint32_t left_out;
    } cases[] = {
        {"info", "sphere.gtx", 4},
        {"validate", "sphere.gtx", 4},
        {"unpack", "sphere.gtx new", 4},
        {"pack", "h -o x.gtx", 3},
        {"horizons", "h/height-0.png -o x.gtx --lod-levels 0", 2},
        {"cook", "sphere.obj -o x.gtx --lod-levels 0", 1},
    };
    expect(gtx("unpack sphere.gtx h"), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        uint32_t left_out = 0;
        for (size_t k = 0; k < sizeof limits / sizeof *limits; ++k) {
            char listed[32];
            expect(gtx("%s --help", cases[i].verb), 0);
            snprintf(listed, sizeof listed, "--max-%s ", limits[k]);
            if (strstr(output, listed))
                continue;
            ++left_out;
            expect(gtx("%s %s --max-%s 1", cases[i].verb, cases[i].arguments, limits[k]), 0);
            shell("rm -rf new");
        }
        assert_int_equal(left_out, cases[i].left_out);
    }
}

static void amounts_have_units(void **state)
{
    (void)state;
    expect(gtx("cook sphere.obj -o x.gtx -q --max-memory 1G --max-triangles 1M --max-texels 1T"),
           0);
    expect(gtx("info x.gtx --max-memory 0.1G"), 0);
    static const char *const bad[] = {"0", "-1", "1q", "1kk", "k", "nan", "1e30"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        expect(gtx("info x.gtx --max-memory=%s", bad[i]), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_limit_names_its_option),
        cmocka_unit_test(a_limit_that_help_leaves_out_bounds_nothing),
        cmocka_unit_test(amounts_have_units),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
