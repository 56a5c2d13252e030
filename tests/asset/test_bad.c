/* One bad file for every rule, and more ways to break some: exactly that rule is named, at the
 * right byte, and opening refuses.
 *
 *   test_bad --write   makes tests/golden/bad anew from tests/golden/good */
#include "asset/bads.h"

static void test_bytes(void **state)
{
    (void)state;
    for (int i = 0; i < BAD_COUNT; ++i) {
        char path[256];
        path_of(&bads[i], path);
        bytes kept = read_file(path), made = make_bad(&bads[i]);
        assert_non_null(kept.data);
        assert_int_equal(kept.size, made.size);
        assert_memory_equal(kept.data, made.data, kept.size);
        free(kept.data);
        free(made.data);
    }
}

/* What validation said. */
typedef struct hearing {
    const bad *expected;
    uint32_t issues, others;
    uint64_t offset;
} hearing;

static void hear(const gtx_issue *issue, void *user)
{
    hearing *h = user;
    if (h->issues++ == 0)
        h->offset = issue->offset;
    if (issue->rule != h->expected->rule || strcmp(issue->name, h->expected->name)) {
        ++h->others;
        print_error("%u-%s: also %u %s at %" PRIu64 ": %s\n", h->expected->rule,
                    h->expected->name, issue->rule, issue->name, issue->offset, issue->message);
    }
    assert_true(issue->is_error);
    assert_true(strlen(issue->message) > 10);
}

static bool needs_zstd(const bad *b)
{
    return !strncmp(b->base, "zstd", 4);
}

static uint64_t reported_offset(const bad *b, bytes file)
{
    return b->edit == break_frame ? gtx_load_u64(file.data + ZSTD_HGHT + 16) : b->reported;
}

static void test_validate(void **state)
{
    (void)state;
    for (int i = 0; i < BAD_COUNT + VARIANT_COUNT; ++i) {
        const bad *b = bad_at(i);
        if (needs_zstd(b) && !gtx_has_zstd())
            continue;
        bytes file = make_bad(b);
        hearing h = {.expected = b};
        gtx_error error = {0};
        gtx_result result = gtx_validate(file.data, file.size, NULL, hear, &h, &error);
        assert_int_not_equal(result, GTX_OK);
        assert_int_equal(h.others, 0);
        if (h.issues != 1 || h.offset != reported_offset(b, file))
            print_error("%u-%s, row %d: %u issues, at %" PRIu64 "\n", b->rule, b->name, i, h.issues,
                        h.offset);
        assert_int_equal(h.issues, b->edit == material_before_color ? 4
                                   : b->edit == patches_before_lods ? 2 : 1);
        assert_int_equal(h.offset, reported_offset(b, file));
        assert_int_equal(error.rule, b->rule);
        assert_string_equal(error.rule_name, b->name);
        free(file.data);
    }
}

static gtx_result result_of(uint32_t rule)
{
    switch (rule) {
    case 100: return GTX_ERROR_NOT_GTX;
    case 101: return GTX_ERROR_VERSION;
    case 118: return GTX_ERROR_TRUNCATED;
    case 103: case 201: return GTX_ERROR_UNSUPPORTED;
    default: return GTX_ERROR_CORRUPT;
    }
}

static void test_open(void **state)
{
    (void)state;
    for (int i = 0; i < BAD_COUNT + VARIANT_COUNT; ++i) {
        const bad *b = bad_at(i);
        if (needs_zstd(b) && !gtx_has_zstd())
            continue;
        bytes file = make_bad(b);
        gtx_asset *asset = (gtx_asset *)&file;
        gtx_error error = {0};
        gtx_result result = gtx_open_memory(file.data, file.size, NULL, &asset, &error);
        assert_int_equal(result, result_of(b->rule));
        assert_int_equal(error.result, result);
        assert_int_equal(error.rule, b->rule);
        assert_int_equal(error.offset, reported_offset(b, file));
        assert_null(asset);
        free(file.data);
    }
}

/* Every rule has its bad file. */
static void test_complete(void **state)
{
    (void)state;
    static const struct {
        uint32_t number;
        const char *name;
    } rules[] = {
#define GTX_RULE(number, id, name, result, sentence) {number, name},
#include "asset/rules.def"
#undef GTX_RULE
    };
    assert_int_equal(BAD_COUNT, sizeof rules / sizeof rules[0]);
    for (int i = 0; i < BAD_COUNT; ++i) {
        assert_int_equal(bads[i].rule, rules[i].number);
        assert_string_equal(bads[i].name, rules[i].name);
    }
}

typedef struct several {
    uint32_t rules[8], count;
} several;

static void list(const gtx_issue *issue, void *user)
{
    several *s = user;
    assert_true(s->count < 8);
    s->rules[s->count++] = issue->rule;
}

/* Validation goes on after a broken rule where it can. */
static void test_several(void **state)
{
    (void)state;
    bytes file = read_golden("two-pages");
    gtx_store_u32(file.data + 96, 0);                       /* unit */
    gtx_store_f32(file.data + RECORD + 60, 0.25f);          /* coverage of patch 0 */
    file.data[RECORD + 128 + 78] = 2;                       /* flags of patch 1 */
    rehash_sections(file);
    several s = {0};
    gtx_error error = {0};
    assert_int_equal(gtx_validate(file.data, file.size, NULL, list, &s, &error), GTX_ERROR_CORRUPT);
    assert_int_equal(error.rule, 113);
    assert_int_equal(s.count, 3);
    assert_int_equal(s.rules[0], 113);
    assert_int_equal(s.rules[1], 307);
    assert_int_equal(s.rules[2], 304);
    assert_int_equal(gtx_validate(file.data, file.size, NULL, NULL, NULL, NULL), GTX_ERROR_CORRUPT);
    free(file.data);
}

static int write_bads(void)
{
    for (int i = 0; i < BAD_COUNT; ++i) {
        char path[256];
        path_of(&bads[i], path);
        bytes file = make_bad(&bads[i]);
        write_file(path, file);
        free(file.data);
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "--write"))
        return write_bads();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_complete), cmocka_unit_test(test_bytes),
        cmocka_unit_test(test_validate), cmocka_unit_test(test_open),
        cmocka_unit_test(test_several),
    };
    return cmocka_run_group_tests_name("bad", tests, NULL, NULL);
}
