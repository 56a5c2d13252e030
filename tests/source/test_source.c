/* What the sources keep to: files that are one room, lines that fit, includes that run one way. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <ftw.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_LINES = 350, MAX_COLUMNS = 100 };

static const struct {
    const char *path, *reason;
} long_files[] = {
    {"format/gtx_decode.c", "the independent decoder is one file that stands alone"},
    {"include/geotex/geotex.h", "an engine programmer reads one header, most of it prose"},
};
static bool met[sizeof long_files / sizeof *long_files];

static bool may_be_long(const char *path)
{
    for (size_t i = 0; i < sizeof long_files / sizeof *long_files; ++i)
        if (strcmp(path, long_files[i].path) == 0)
            return met[i] = true;
    return false;
}

static bool is_code(const char *path)
{
    static const char *const endings[] = {".c", ".h", ".cpp", ".hpp", ".def", ".glsl", ".vert",
                                          ".frag", ".sh", ".awk", ".mk", ".ci/run", "tests/run",
                                          "Makefile", "bench/tune"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; ++i) {
        const size_t all = strlen(path), end = strlen(endings[i]);
        if (all >= end && strcmp(path + all - end, endings[i]) == 0)
            return true;
    }
    return false;
}

/* Characters, not bytes, of UTF-8. */
static size_t columns_of(const char *line)
{
    size_t count = 0;
    for (; *line && *line != '\n'; ++line)
        count += ((unsigned char)*line & 0xc0) != 0x80;
    return count;
}

static int files, faults;

static int check_file(const char *path, const struct stat *about, int type, struct FTW *where)
{
    (void)about;
    (void)where;
    path += strncmp(path, "./", 2) == 0 ? 2 : 0;
    if (type != FTW_F || !is_code(path))
        return 0;
    FILE *file = fopen(path, "r");
    if (!file)
        return -1;
    char line[4096];
    int count = 0;
    while (fgets(line, sizeof line, file))
        if (++count, columns_of(line) > MAX_COLUMNS)
            ++faults, fprintf(stderr, "%s:%d: %zu columns\n", path, count, columns_of(line));
    fclose(file);
    ++files;
    if (count > MAX_LINES && !may_be_long(path))
        ++faults, fprintf(stderr, "%s: %d lines\n", path, count);
    return 0;
}

static void files_and_lines_are_short(void **state)
{
    (void)state;
    static const char *const tops[] = {"lib", "include", "format", "shaders", "samples", "tests",
                                       ".ci", "Makefile"};
    for (size_t i = 0; i < sizeof tops / sizeof *tops; ++i)
        assert_int_equal(nftw(tops[i], check_file, 16, FTW_PHYS), 0);
    assert_true(files > 300);
    assert_int_equal(faults, 0);
    for (size_t i = 0; i < sizeof long_files / sizeof *long_files; ++i)
        assert_true(met[i]); /* it has gone: so may its line above */
}

/* Whether a file of a room may include a header. */
static bool compiles(const char *room, const char *header)
{
    char command[1024];
    snprintf(command, sizeof command,
             "echo '#include \"%s\"' | %s -std=c++17 -x c++ -Iinclude -I'%s/sees/lib/%s' "
             "-fsyntax-only - 2>/dev/null", header, getenv("CXX"), getenv("GTX_OUT"), room);
    return system(command) == 0;
}

static void a_wrong_include_does_not_compile(void **state)
{
    (void)state;
    if (!getenv("GTX_OUT"))
        skip();
    static const struct {
        const char *room, *header;
        bool may;
    } cases[] = {
        {"asset", "base/alloc.h", true},       {"asset", "derive/derive.h", false},
        {"derive", "asset/asset.h", true},     {"derive", "trace/caster.h", false},
        {"frame", "derive/derive.h", true},    {"frame", "render/gl.h", false},
        {"render", "frame/lod.h", true},       {"render", "trace/caster.h", false},
        {"trace", "derive/hierarchy.h", true}, {"trace", "frame/rays.h", false},
        {"mesh", "image/image.h", true},       {"mesh", "chart/chart.hpp", false},
        {"bake", "mesh/vec.hpp", true},        {"bake", "cook/options.hpp", false},
        {"measure", "trace/caster.h", true},   {"measure", "bake/bake.hpp", false},
        {"export", "cook/options.hpp", true},  {"cook", "export/export.hpp", false},
        {"world", "cook/options.hpp", true},   {"cook", "world/world.hpp", false},
        {"stream", "asset/asset.h", true},     {"stream", "frame/model.h", false},
        {"host", "image/image.h", true},       {"host", "asset/asset.h", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i)
        if (compiles(cases[i].room, cases[i].header) != cases[i].may)
            fail_msg("%s %s %s", cases[i].room, cases[i].may ? "needs" : "sees", cases[i].header);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_and_lines_are_short),
        cmocka_unit_test(a_wrong_include_does_not_compile),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
