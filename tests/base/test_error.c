/* Errors: every field is set, and the message is a line that a terminal shows as it is. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/warnings.h"

#include <stdio.h>
#include <string.h>

static void every_field_is_set(void **state)
{
    gtx_error error;
    (void)state;
    memset(&error, 0xa5, sizeof error);
    assert_int_equal(gtx_fail(&error, GTX_ERROR_READ, "no %s", "file"), GTX_ERROR_READ);
    assert_true(error.result == GTX_ERROR_READ && !error.rule && !error.rule_name);
    assert_true(!error.offset && !error.limit);
    assert_string_equal(error.message, "no file");
    assert_int_equal(gtx_fail_limit(&error, GTX_LIMITED_PIXELS, "a", 2, 1), GTX_ERROR_LIMIT);
    assert_string_equal(error.limit, "pixels");
}

static void messages_are_printable(void **state)
{
    static const struct {
        const char *text, *shown;
    } cases[] = {
        {"plain, ~", "plain, ~"},
        {"\x1b[31mred\x1b[0m", "?[31mred?[0m"},
        {"a\nb\r\tc\x7f", "a?b??c?"},
        {"Lévy ⊥ \xf0\x9f\x8c\x8d", "Lévy ⊥ \xf0\x9f\x8c\x8d"},
        {"c1 \xc2\x9b\x31m, \xc2\xa0", "c1 ??1m, \xc2\xa0"},
        {"\xff\xfe \x80 \xc3", "?? ? ?"},
        {"\xc0\xaf \xe0\x80\xaf", "?? ???"},                     /* more bytes than it takes */
        {"\xed\xa0\x80 \xf4\x90\x80\x80", "??? ????"},           /* half a pair; beyond the last */
        {"a\xe2\x80\xaetxt \xe2\x80\xa8 \xe2\x81\xa6", "a???txt ??? ???"},
        {"\xe2\x8a", "??"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        gtx_error error;
        gtx_fail(&error, GTX_ERROR_INPUT, "%s", cases[i].text);
        assert_string_equal(error.message, cases[i].shown);
    }
    gtx_error error; /* a message that is too long ends with a whole character, or ?s */
    char many[400];
    memset(many, 0, sizeof many);
    for (size_t i = 0; i + 2 < sizeof many; i += 2)
        memcpy(many + i, "\xc3\xa9", 2);
    gtx_fail(&error, GTX_ERROR_INPUT, "%s", many);
    assert_int_equal(strlen(error.message), sizeof error.message - 1);
    assert_int_equal(error.message[sizeof error.message - 2], '?');
}

/* Words in lower case with dashes between them, no two alike. */
static void warnings_have_names(void **state)
{
    (void)state;
    for (int i = 0; i < GTX_WARNING_COUNT; ++i) {
        const char *name = gtx_warning_name((gtx_warning)i);
        assert_int_equal(strspn(name, "abcdefghijklmnopqrstuvwxyz-"), strlen(name));
        assert_true(name[0] != '-' && !strstr(name, "--"));
        for (int j = 0; j < i; ++j)
            assert_string_not_equal(name, gtx_warning_name((gtx_warning)j));
    }
}

/* Those of models, of which comparing knows no suitability; GRIDS_DIFFER and what follows is of
 * grids and of the command alone. */
static void schemas_know_the_names(void **state)
{
    static const char *const schemas[] = {"format/cook-report.schema.json",
                                          "format/compare-report.schema.json"};
    static char text[1 << 16];
    (void)state;
    for (int k = 0; k < 2; ++k) {
        FILE *file = fopen(schemas[k], "r");
        assert_non_null(file);
        text[fread(text, 1, sizeof text - 1, file)] = 0;
        fclose(file);
        for (int i = 0; i < GTX_WARNING_COUNT; ++i) {
            char quoted[64];
            snprintf(quoted, sizeof quoted, "\"%s\"", gtx_warning_name((gtx_warning)i));
            const int end = k ? GTX_WARNING_FEW_TRIANGLES : GTX_WARNING_GRIDS_DIFFER;
            assert_int_equal(strstr(text, quoted) != NULL, i < end);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_field_is_set),
        cmocka_unit_test(messages_are_printable),
        cmocka_unit_test(warnings_have_names),
        cmocka_unit_test(schemas_know_the_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
