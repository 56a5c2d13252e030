/* The JSON writer: its text, and its memory. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Every value there is, nested, with empty nests and what has to be escaped. */
static void write_everything(gtx_json *json)
{
    gtx_json_begin_object(json, NULL);
    gtx_json_string(json, "a \"key\"", "tab\t, quote\", back\\, caf\xc3\xa9");
    gtx_json_number(json, "half", 0.5);
    gtx_json_number(json, "nothing", NAN);
    gtx_json_integer(json, "most", UINT64_MAX);
    gtx_json_hash(json, "hash", 0xab);
    gtx_json_begin_array(json, "list");
    gtx_json_bool(json, NULL, true);
    gtx_json_bool(json, NULL, false);
    gtx_json_null(json, NULL);
    gtx_json_begin_object(json, NULL);
    gtx_json_end_object(json);
    gtx_json_end_array(json);
    gtx_json_begin_array(json, "empty");
    gtx_json_end_array(json);
    gtx_json_end_object(json);
}

static const char everything[] = "{\n"
    "  \"a \\\"key\\\"\": \"tab\\u0009, quote\\\", back\\\\, caf\xc3\xa9\",\n"
    "  \"half\": 0.5,\n"
    "  \"nothing\": null,\n"
    "  \"most\": 18446744073709551615,\n"
    "  \"hash\": \"0x00000000000000ab\",\n"
    "  \"list\": [\n"
    "    true,\n"
    "    false,\n"
    "    null,\n"
    "    {}\n"
    "  ],\n"
    "  \"empty\": []\n"
    "}\n";

static void zeros_write_with_malloc(void **state)
{
    (void)state;
    gtx_json json = {0};
    write_everything(&json);
    assert_false(json.failed);
    assert_string_equal(json.text, everything);
    assert_int_equal(json.size, strlen(everything));
    gtx_json_free(&json);
    assert_null(json.text);
    gtx_json_free(&json);
}

typedef struct meter {
    size_t live, calls, fail_at; /* this call alone; 0 = never */
} meter;

static void *meter_alloc(size_t size, void *user)
{
    meter *m = user;
    if (++m->calls == m->fail_at)
        return NULL;
    m->live += size;
    void *memory = malloc(size);
    assert_non_null(memory);
    return memory;
}

static void meter_free(void *memory, size_t size, void *user)
{
    meter *m = user;
    assert_true(m->live >= size);
    m->live -= size;
    free(memory);
}

static void any_allocation_may_fail(void **state)
{
    (void)state;
    for (size_t fail_at = 1;; ++fail_at) {
        meter m = {.fail_at = fail_at};
        gtx_json json = {.allocator = {meter_alloc, meter_free, &m}};
        write_everything(&json);
        bool failed = json.failed;
        if (!failed)
            assert_string_equal(json.text, everything);
        else if (json.text)
            assert_int_equal(strlen(json.text), json.size);
        assert_int_equal(failed, m.calls >= fail_at);
        gtx_json_free(&json);
        assert_int_equal(m.live, 0);
        if (!failed) {
            assert_in_range(m.calls, 2, 4); /* it grew, and not by a character at a time */
            return;
        }
    }
}

/* What was freed writes again, with the same hooks. */
static void a_writer_is_used_again(void **state)
{
    (void)state;
    meter m = {0};
    gtx_json json = {.allocator = {meter_alloc, meter_free, &m}};
    for (int i = 0; i < 2; ++i) {
        write_everything(&json);
        assert_string_equal(json.text, everything);
        assert_true(m.live > json.size);
        gtx_json_free(&json);
        assert_int_equal(m.live, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(zeros_write_with_malloc),
        cmocka_unit_test(any_allocation_may_fail),
        cmocka_unit_test(a_writer_is_used_again),
    };
    return cmocka_run_group_tests_name("json", tests, NULL, NULL);
}
