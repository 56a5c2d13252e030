/* Edits: what is refused, the same bytes twice, and memory that runs out. */
#include "edit/edits.h"

static void same_bytes(const gtx_asset *a, const gtx_asset *b)
{
    void *data[2];
    size_t size[2];
    must(gtx_encode(a, NULL, &data[0], &size[0], NULL));
    must(gtx_encode(b, NULL, &data[1], &size[1], NULL));
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(data[0], data[1], size[0]);
    free(data[0]);
    free(data[1]);
}

static void expect_unchanged(const gtx_edit *edit, const gtx_asset *asset)
{
    gtx_asset *out = NULL;
    must(gtx_edit_finish(edit, &out, NULL));
    same_bytes(out, asset);
    gtx_close(out);
}

/* ---- what is refused ---- */

static void empty_field(const gtx_patch *patch, double x, double y, const void *user,
                        fixture_texel *out)
{
    (void)patch, (void)x, (void)y, (void)user;
    out->height = -1;
}

static void an_empty_asset_is_refused(void **state)
{
    (void)state;
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 16, 16, 1, 1), empty_field, NULL};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 4);
    gtx_edit *edit = NULL;
    gtx_error error = {0};
    assert_int_equal(gtx_edit_begin(asset, NULL, &edit, &error), GTX_ERROR_EMPTY);
    assert_null(edit);
    assert_non_null(strstr(error.message, "no texel"));
    assert_int_equal(gtx_edit_begin(NULL, NULL, &edit, NULL), GTX_ERROR_ARGUMENT);
    const gtx_edit_desc dirty = {.reserved = {1}};
    assert_int_equal(gtx_edit_begin(asset, &dirty, &edit, NULL), GTX_ERROR_NOT_ZEROED);
    gtx_edit_end(NULL);
    gtx_close(asset);
}

static void bad_blurs_change_nothing(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_bumpy(8, 0);
    gtx_edit *edit = begin(asset);
    const struct {
        gtx_edit_blur blur;
        gtx_result result;
    } bad[] = {{{.radius = 0}, GTX_ERROR_ARGUMENT},
               {{.radius = -1}, GTX_ERROR_ARGUMENT},
               {{.radius = NAN}, GTX_ERROR_ARGUMENT},
               {{.radius = INFINITY}, GTX_ERROR_ARGUMENT},
               {{.radius = 1, .flags = 64}, GTX_ERROR_ARGUMENT},
               {{.radius = 1, .reserved = {7}}, GTX_ERROR_NOT_ZEROED},
               {{.radius = 65}, GTX_ERROR_LIMIT}, /* texels; the patch has 64 */
               {{.radius = 4.1f, .flags = GTX_EDIT_WORLD}, GTX_ERROR_LIMIT}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        gtx_error error = {0};
        assert_int_equal(gtx_edit_gaussian(edit, &bad[i].blur, &error), bad[i].result);
        assert_int_equal(gtx_edit_high_boost(edit, &bad[i].blur, 1, &error), bad[i].result);
        assert_true(bad[i].result == GTX_ERROR_NOT_ZEROED || error.message[0]);
    }
    const gtx_edit_blur fine = {.radius = 1};
    const float amounts[] = {0, -1, 17, NAN};
    for (size_t i = 0; i < 4; ++i)
        assert_int_equal(gtx_edit_high_boost(edit, &fine, amounts[i], NULL), GTX_ERROR_ARGUMENT);
    expect_unchanged(edit, asset);
    gtx_edit_end(edit);
    gtx_close(asset);
}

static void bad_marks_change_nothing(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_bumpy(16, 0);
    gtx_edit *edit = begin(asset);
    const float grey[4] = {0, 1, 1, 0}, nan[4] = {0, NAN, 1, 0};
    const gtx_edit_image good = {grey, 2, 2}, dot = {grey, 1, 1}, none = {NULL, 2, 2};
    const gtx_edit_image holed = {nan, 2, 2}, huge = {grey, 2, 20000};
    assert_int_equal(gtx_edit_pattern(edit, &dot, 1, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &none, 1, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &holed, 1, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &huge, 1, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &good, NAN, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &good, 1, 0, NULL), GTX_ERROR_ARGUMENT);

    const uint32_t outside[][4] = {{0, 0, 0, 1}, {64, 0, 1, 1}, {60, 0, 5, 1}, {0, 48, 1, 1},
                                   {0, 1, 1, 48}, {1, 0, UINT32_MAX, 1}, {UINT32_MAX, 0, 1, 1}};
    for (size_t i = 0; i < sizeof outside / sizeof *outside; ++i) {
        gtx_error error = {0};
        assert_int_equal(gtx_edit_set_heights(edit, 0, outside[i], grey, &error),
                         GTX_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, "not within patch 0"));
    }
    const uint32_t two[4] = {30, 20, 2, 2};
    assert_int_equal(gtx_edit_set_heights(edit, 0, two, nan, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_set_heights(edit, 1, two, grey, NULL), GTX_ERROR_ARGUMENT);

    gtx_edit_stamp_desc stamp = {.centre = {0, 2, 2}, .radius = 1, .direction = {0, 0, 0}};
    assert_int_equal(gtx_edit_stamp(edit, &stamp, NULL), GTX_ERROR_ARGUMENT);
    stamp.direction[2] = -1;
    stamp.up[2] = 1; /* along it */
    assert_int_equal(gtx_edit_stamp(edit, &stamp, NULL), GTX_ERROR_ARGUMENT);
    stamp.up[2] = 0;
    stamp.depth = INFINITY;
    assert_int_equal(gtx_edit_stamp(edit, &stamp, NULL), GTX_ERROR_ARGUMENT);
    stamp.depth = 1;
    stamp.image = dot;
    assert_int_equal(gtx_edit_stamp(edit, &stamp, NULL), GTX_ERROR_ARGUMENT);
    stamp.image = (gtx_edit_image){0};
    stamp.centre[0] = 1e6f; /* far away: fine, and nothing happens */
    must(gtx_edit_stamp(edit, &stamp, NULL));
    expect_unchanged(edit, asset);
    gtx_edit_end(edit);
    gtx_close(asset);
}

static void throw_away(const gtx_edit_field *field, void *user)
{
    (void)user;
    for (uint32_t t = 0; t < field->width * field->height; ++t)
        if (field->kind[t] == GTX_TEXEL_OWN) {
            field->point[t][0] += 1;
            field->point[t][2] = NAN;
        }
}

static void an_operation_must_stay_finite(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_edit *edit = begin(asset);
    assert_int_equal(gtx_edit_apply(edit, throw_away, NULL, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_apply(edit, NULL, NULL, NULL), GTX_ERROR_ARGUMENT);
    expect_unchanged(edit, asset);
    gtx_edit_end(edit);
    gtx_close(asset);
}

static void the_same_bytes_twice(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 48, 8), *out[2];
    const float wave[9] = {0, 0.3f, 1, 0.2f, 0.9f, 0, 1, 0.4f, 0.1f};
    for (int i = 0; i < 2; ++i) {
        gtx_edit *edit = begin(asset);
        const gtx_edit_blur blur = {.radius = 2};
        must(gtx_edit_pattern(edit, &(gtx_edit_image){wave, 3, 3}, 0.1f, 0.7f, NULL));
        must(gtx_edit_gaussian(edit, &blur, NULL));
        must(gtx_edit_high_boost(edit, &blur, 0.7f, NULL));
        out[i] = finish(edit);
    }
    same_bytes(out[0], out[1]);
    gtx_close(out[0]);
    gtx_close(out[1]);
    gtx_close(asset);
}

static void running_out_of_memory_is_a_result(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    for (long n = 0;; ++n) {
        counter c = {n, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        const gtx_edit_desc desc = {.allocator = &hooks};
        const gtx_edit_blur blur = {.radius = 1}, alone = {.radius = 1, .flags = GTX_EDIT_ALONE};
        const gtx_edit_stamp_desc stamp = {.centre = {2, 1, 0.5f}, .radius = 1, .depth = 0.1f,
                                           .direction = {0, 0, -1}};
        const uint32_t *patches;
        uint32_t count;
        const gtx_asset *live;
        gtx_edit *edit = NULL;
        gtx_asset *out = NULL;
        gtx_result result = gtx_edit_begin(asset, &desc, &edit, NULL);
        result = result ? result : gtx_edit_gaussian(edit, &blur, NULL);
        result = result ? result : gtx_edit_gaussian(edit, &alone, NULL);
        result = result ? result : gtx_edit_stamp(edit, &stamp, NULL);
        result = result ? result : gtx_edit_refresh(edit, &live, &patches, &count, NULL);
        result = result ? result : gtx_edit_finish(edit, &out, NULL);
        gtx_close(out);
        gtx_edit_end(edit);
        assert_int_equal(c.bytes, 0);
        assert_int_equal(result, c.until_failure >= 0 ? GTX_OK : GTX_ERROR_MEMORY);
        if (!result)
            break;
        assert_true(n < 1000);
    }
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_asset_is_refused),
        cmocka_unit_test(bad_blurs_change_nothing),
        cmocka_unit_test(bad_marks_change_nothing),
        cmocka_unit_test(an_operation_must_stay_finite),
        cmocka_unit_test(the_same_bytes_twice),
        cmocka_unit_test(running_out_of_memory_is_a_result),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
