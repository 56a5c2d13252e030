/* Every public header compiles alone, in every dialect an engine may use. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>

static const char *const headers[] = {"geotex", "edit",   "solid", "render",
                                      "stream", "cook", "export"};

static void compile(const char *compiler, const char *language, const char *standard)
{
    for (size_t i = 0; i < sizeof headers / sizeof *headers; ++i) {
        char command[512];
        snprintf(command, sizeof command,
                 "echo '#include <geotex/%s.h>' | %s -x %s -std=%s -Wall -Wextra -Wpedantic "
                 "-Werror -Iinclude -fsyntax-only -", headers[i], compiler, language, standard);
        assert_int_equal(system(command), 0);
    }
}

static const char *or_default(const char *name, const char *fallback)
{
    const char *value = getenv(name);
    return value && *value ? value : fallback;
}

static void c99(void **state) { (void)state; compile(or_default("CC", "cc"), "c", "c99"); }
static void c11(void **state) { (void)state; compile(or_default("CC", "cc"), "c", "c11"); }
static void cxx11(void **state) { (void)state; compile(or_default("CXX", "c++"), "c++", "c++11"); }
static void cxx20(void **state) { (void)state; compile(or_default("CXX", "c++"), "c++", "c++20"); }

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(c99),
        cmocka_unit_test(c11),
        cmocka_unit_test(cxx11),
        cmocka_unit_test(cxx20),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
