/* Numbers of any size in assets and edits: what no asset can hold is refused, in good time. */
#include "edit/edits.h"

static void flat(const gtx_patch *patch, double x, double y, const void *user, fixture_texel *out)
{
    (void)patch;
    (void)x;
    (void)y;
    (void)user;
    out->height = 0.5;
    out->trim = -7;
}

/* Two patches, whose texels are `large` and `small`. */
static gtx_asset *two_sizes(double large, double small)
{
    static const double corner[3] = {0, 0, 0};
    fixture_patch patches[2] = {{fixture_frame(corner, 16, 16, large, large), flat, NULL},
                                {fixture_frame(corner, 16, 16, small, small), flat, NULL}};
    return fixture_build(patches, 2, 8, 4);
}

/* Three deviations reach over more texels of the small patch than an int can count. */
static void a_blur_reaches_over_any_number_of_texels(void **state)
{
    (void)state;
    gtx_asset *asset = two_sizes(1, 1e-10);
    gtx_edit *edit = begin(asset);
    const gtx_edit_blur blur = {.radius = 10, .flags = GTX_EDIT_WORLD | GTX_EDIT_PER_PATCH};
    gtx_error error = {0};
    const gtx_result result = gtx_edit_gaussian(edit, &blur, &error);
    if (result && result != GTX_ERROR_LIMIT)
        fail_msg("%s", error.message);
    gtx_close(finish(edit));
    gtx_close(asset);
}

static void a_blur_of_too_many_texels_is_refused(void **state)
{
    (void)state;
    gtx_asset *asset = two_sizes(1, 1e-10);
    for (uint32_t flags = GTX_EDIT_WORLD; flags <= (GTX_EDIT_WORLD | GTX_EDIT_PER_PATCH);
         flags += GTX_EDIT_PER_PATCH) {
        gtx_edit *edit = begin(asset);
        const gtx_edit_blur blur = {.radius = gtx_edit_texel_size(edit) * 20000, .flags = flags};
        assert_int_equal(gtx_edit_gaussian(edit, &blur, NULL), GTX_ERROR_LIMIT);
        gtx_edit_end(edit);
    }
    gtx_close(asset);
}

static void move(const gtx_edit_field *field, void *user)
{
    const float *by = user;
    for (uint32_t t = 0; t < field->width * field->height; ++t)
        for (int k = 0; k < 3 && field->kind[t] == GTX_TEXEL_OWN; ++k)
            field->point[t][k] = field->point[t][k] * by[0] + by[1] * (float)k;
}

/* As far as floats go: sideways, apart, and into one point. */
static void points_go_anywhere(void **state)
{
    (void)state;
    static const float moves[][2] = {{1, 1e30f}, {1e30f, 0}, {-1e30f, 1e30f}, {1e20f, -1e38f},
                                     {0, 0},     {1e-30f, 0}, {1, 5},         {300, 0}};
    for (size_t i = 0; i < sizeof moves / sizeof *moves; ++i) {
        gtx_asset *asset = fixture_flat(0.5, 8), *out = NULL;
        gtx_edit *edit = begin(asset);
        float by[2] = {moves[i][0], moves[i][1]};
        gtx_error error = {0};
        must(gtx_edit_apply(edit, move, by, NULL));
        const gtx_result result = gtx_edit_finish(edit, &out, &error);
        if (result && result != GTX_ERROR_LIMIT)
            fail_msg("move %zu: result %d, %s", i, result, error.message);
        const gtx_asset *live;
        const uint32_t *patches;
        uint32_t count;
        must(gtx_edit_refresh(edit, &live, &patches, &count, NULL));
        gtx_close(out);
        gtx_edit_end(edit);
        gtx_close(asset);
    }
}

/* A sphere eight times as large is one; one of as many texels as pages hold is refused. */
static void a_surface_does_not_grow_without_end(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(1, 48, 8), *out = NULL;
    for (int large = 0; large < 2; ++large) {
        gtx_edit *edit = begin(asset);
        float by[2] = {large ? 64 : 8, 0};
        gtx_error error = {0};
        must(gtx_edit_apply(edit, move, by, NULL));
        const gtx_result result = gtx_edit_finish(edit, &out, &error);
        assert_int_equal(result, large ? GTX_ERROR_LIMIT : GTX_OK);
        assert_true(!large || strstr(error.message, "times as many"));
        gtx_close(out);
        out = NULL;
        gtx_edit_end(edit);
    }
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_blur_reaches_over_any_number_of_texels),
        cmocka_unit_test(a_blur_of_too_many_texels_is_refused),
        cmocka_unit_test(points_go_anywhere),
        cmocka_unit_test(a_surface_does_not_grow_without_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
