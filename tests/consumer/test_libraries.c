/* What an engine inherits by linking: libraries needed, symbols exported, symbols asked for. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Runs a command in the build folder; calls fn on every line of its output. */
static void each_line(const char *command, void (*fn)(char *line))
{
    char full[1024], line[1024];
    const char *out = getenv("GTX_OUT");
    if (!out)
        skip();
    snprintf(full, sizeof full, "cd '%s' && %s", out, command);
    FILE *pipe = popen(full, "r");
    assert_non_null(pipe);
    while (fgets(line, sizeof line, pipe)) {
        line[strcspn(line, "\n")] = 0;
        fn(line);
    }
    assert_int_equal(pclose(pipe), 0);
}

static bool starts_with_any(const char *text, const char *const *prefixes)
{
    for (; *prefixes; ++prefixes)
        if (!strncmp(text, *prefixes, strlen(*prefixes)))
            return true;
    return false;
}

static unsigned lines;

static void needed_by_core(char *line)
{
    /* The sanitizers bring libraries of their own. */
    static const char *const allowed[] = {"libc.so.", "libm.so.", "libzstd.so.", "libasan.so.",
                                          "libubsan.so.", "ld-linux", NULL};
    ++lines;
    if (!starts_with_any(line, allowed))
        fail_msg("libgeotex needs %s", line);
}

static void core_needs_libc_only(void **state)
{
    (void)state;
    lines = 0;
    each_line("readelf -d libgeotex.so | sed -n 's/.*NEEDED.*\\[\\(.*\\)\\]/\\1/p'",
              needed_by_core);
    assert_true(lines > 0);
}

static void needed_by_cook(char *line)
{
    static const char *const refused[] = {"libOpenImageIO", "libpng", "libjpeg", "libgdal",
                                          "libglfw", "libEGL", "libGL", "libtinygltf", NULL};
    ++lines;
    if (starts_with_any(line, refused))
        fail_msg("libgeotex-cook needs %s", line);
}

static void cook_needs_no_images_and_no_windows(void **state)
{
    (void)state;
    lines = 0;
    each_line("readelf -d libgeotex-cook.so | sed -n 's/.*NEEDED.*\\[\\(.*\\)\\]/\\1/p'",
              needed_by_cook);
    assert_true(lines > 0);
}

static void exported(char *line)
{
    ++lines;
    if (strncmp(line, "gtx_", 4))
        fail_msg("exported: %s", line);
}

static void only_gtx_symbols_are_exported(void **state)
{
    (void)state;
    lines = 0;
    each_line("nm -D --defined-only libgeotex.so | awk '{print $3}'", exported);
    assert_true(lines > 10);
    each_line("nm -D --defined-only libgeotex-cook.so | "
              "awk '$2 != \"W\" && $2 != \"V\" && $2 != \"u\" {print $3}'", exported);
}

static void asked_for(char *line)
{
    static const char *const refused[] = {"gl", "egl", "_Z", "__cxa_throw", NULL};
    ++lines;
    if (starts_with_any(line, refused))
        fail_msg("libgeotex asks for %s", line);
    static const char *const never[] = {"exit", "abort", "printf", "puts", "putchar", NULL};
    for (const char *const *bad = never; *bad; ++bad)
        if (!strcmp(line, *bad))
            fail_msg("libgeotex calls %s", line);
}

static void core_prints_nothing_and_calls_no_gl(void **state)
{
    (void)state;
    if (getenv("GTX_CONFIG") && strcmp(getenv("GTX_CONFIG"), "release"))
        skip(); /* instrumented code asks for more */
    lines = 0;
    each_line("nm -D --undefined-only libgeotex.so | awk '{sub(/@.*/, \"\", $2); print $2}'",
              asked_for);
    assert_true(lines > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(core_needs_libc_only),
        cmocka_unit_test(cook_needs_no_images_and_no_windows),
        cmocka_unit_test(only_gtx_symbols_are_exported),
        cmocka_unit_test(core_prints_nothing_and_calls_no_gl),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
