/* Limits: their defaults grow with what is read, and what passes one is told of by its name. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/limits.h"

#include <string.h>

static void defaults_grow_with_the_bytes_read(void **state)
{
    (void)state;
    const gtx_limits zeros = {0};
    assert_int_equal(gtx_limit_of(NULL, GTX_LIMITED_MEMORY, 0), 256u << 20);
    assert_int_equal(gtx_limit_of(&zeros, GTX_LIMITED_MEMORY, 1000), (256u << 20) + 2000000);
    assert_int_equal(gtx_limit_of(&zeros, GTX_LIMITED_TRIANGLES, 100), (1u << 19) + 150);
    for (int i = 0; i < GTX_LIMITED_COUNT; ++i) {
        const gtx_limited which = (gtx_limited)i;
        assert_true(gtx_limit_of(&zeros, which, 1 << 20) >= gtx_limit_of(&zeros, which, 0));
        assert_true(gtx_limit_of(&zeros, which, UINT64_MAX) >= gtx_limit_of(&zeros, which, 0));
    }
}

static void what_is_given_holds(void **state)
{
    (void)state;
    const gtx_limits limits = {.memory = 1, .triangles = UINT64_MAX, .patches = 7, .work = 8};
    assert_int_equal(gtx_limit_of(&limits, GTX_LIMITED_MEMORY, 1 << 30), 1);
    assert_true(gtx_limit_of(&limits, GTX_LIMITED_TRIANGLES, 0) == UINT64_MAX);
    assert_int_equal(gtx_limit_of(&limits, GTX_LIMITED_PATCHES, 0), 7);
    assert_int_equal(gtx_limit_of(&limits, GTX_LIMITED_WORK, 0), 8);
}

static void a_reserved_field_is_zero(void **state)
{
    (void)state;
    gtx_limits limits = {0};
    assert_int_equal(gtx_check_limits(&limits, NULL), GTX_OK);
    limits.reserved[sizeof limits.reserved / sizeof *limits.reserved - 1] = 1;
    assert_int_equal(gtx_check_limits(&limits, NULL), GTX_ERROR_NOT_ZEROED);
}

static void the_sentence_names_both_numbers(void **state)
{
    (void)state;
    gtx_error error;
    memset(&error, 0xa5, sizeof error);
    assert_int_equal(gtx_fail_limit(&error, GTX_LIMITED_PIXELS, "the image", 1000, 999),
                     GTX_ERROR_LIMIT);
    assert_string_equal(error.message,
                        "the image takes 1000 pixels, more than the 999 allowed");
    assert_string_equal(error.limit, "pixels");
    assert_int_equal(error.rule, 0);
    assert_int_equal(gtx_fail_limit(NULL, GTX_LIMITED_PIXELS, "the image", 2, 1), GTX_ERROR_LIMIT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_grow_with_the_bytes_read),
        cmocka_unit_test(what_is_given_holds),
        cmocka_unit_test(a_reserved_field_is_zero),
        cmocka_unit_test(the_sentence_names_both_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
