/* Every public header compiles alone, and all of them together, in every dialect that an engine may
 * use. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>

/* The others alone; then all, in the order of the alphabet, which need not be that of their own
 * includes. */
#define EACH "for h in $(cd include && ls geotex/*.h | grep -v vulkan); do echo \"#include <$h>\" "
#define ALL "(cd include && ls geotex/*.h | grep -v vulkan | sed 's/.*/#include <&>/') "
#define VULKAN "echo '#include <geotex/vulkan.h>' "

static void compile(const char *compiler, const char *language, const char *standard)
{
    char check[256], command[640];
    snprintf(check, sizeof check,
             "| %s -x %s -std=%s -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only -",
             compiler, language, standard);
    snprintf(command, sizeof command, EACH "%s || exit 1; done", check);
    assert_int_equal(system(command), 0);
    snprintf(command, sizeof command, ALL "%s", check);
    assert_int_equal(system(command), 0);
    snprintf(command, sizeof command,
             "if echo '#include <vulkan/vulkan_core.h>' | %s -E - >/dev/null 2>&1; then " VULKAN
             "%s; fi", compiler, check);
    assert_int_equal(system(command), 0);
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
