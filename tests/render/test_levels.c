/* Levels of detail: which one is drawn where, and that mixed ones leave no holes. */
#include "stage.h"

#include "derive/derive.h"

/* Bound of the distance of each level of a patch from level 0, and the last level. */
static uint32_t measure(const gtx_asset *asset, uint32_t patch, double errors[GTX_MAX_MIPS])
{
    gtx_info info;
    gtx_error error = {0};
    gtx_get_info(asset, &info);
    gtx_grid finest;
    must(gtx_grid_build(asset, patch, 0, NULL, &finest, &error), &error);
    for (uint32_t k = 0; k < info.mip_count; ++k) {
        gtx_grid grid;
        must(gtx_grid_build(asset, patch, k, NULL, &grid, &error), &error);
        errors[k] = gtx_grid_error(asset, patch, &finest, &grid);
        if (k)
            errors[k] = fmax(errors[k], errors[k - 1]);
        gtx_grid_free(&grid, NULL);
    }
    gtx_grid_free(&finest, NULL);
    return info.mip_count - 1;
}

/* Pixels a unit of the asset, where the patch's sphere comes nearest, when scaled by `scale`. */
static double pixels_a_unit(const gtx_view *view, const gtx_patch *patch, const float place[16],
                            double scale)
{
    const double centre[3] = {patch->sphere[0], patch->sphere[1], patch->sphere[2]};
    const matrix eye = matrix_mul(matrix_of(view->view), matrix_of(place));
    double at[3];
    matrix_point(eye, centre, at);
    const double nearest = -at[2] - scale * patch->sphere[3];
    const double w = view->projection[15] > 0 ? 1 : nearest;
    return scale * view->projection[5] * STAGE_HEIGHT / 2 / w;
}

static void is_drawn_as(stage *s, const gtx_view *view, const gtx_instance *instance,
                        uint32_t level)
{
    static uint8_t drawn[sizeof s->color];
    gtx_view by_error = *view;
    by_error.method = GTX_METHOD_CAST;
    gtx_view forced = by_error;
    stage_draw(s, &by_error, instance, 1);
    memcpy(drawn, s->color, sizeof drawn);
    for (uint32_t k = 0; k < 4; ++k) {
        forced.level = k + 1;
        stage_draw(s, &forced, instance, 1);
        if ((memcmp(drawn, s->color, sizeof drawn) == 0) != (k == level))
            fail_msg("level %u: %s level %u", level, k == level ? "not" : "as", k);
    }
}

static void the_coarsest_within_the_error(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_bumpy(8, 0));
    double errors[GTX_MAX_MIPS];
    const uint32_t last = measure(shown.asset, 0, errors);
    assert_int_equal(last, 3);
    for (int i = 0; i < 4; ++i) {
        gtx_camera camera = camera_around(shown.asset);
        gtx_instance placed = shown.instance;
        const float scale = i & 2 ? 0.5f : 1;
        camera.orthographic = i & 1;
        camera.field = 40;
        gtx_view view = view_of(&camera);
        /* Scaled evenly, and mirrored. */
        placed.transform[0] = placed.transform[5] = placed.transform[10] = scale;
        if (i & 2)
            placed.transform[0] = -scale;
        const double pixels = pixels_a_unit(&view, gtx_patches(shown.asset), placed.transform,
                                            scale);
        view.viewport_height = STAGE_HEIGHT;
        for (uint32_t k = 1; k <= last; ++k) {
            view.max_error = (float)(errors[k] * pixels * 1.001);
            is_drawn_as(s, &view, &placed, k);
            view.max_error = (float)(errors[k] * pixels * 0.999);
            is_drawn_as(s, &view, &placed, k - 1);
        }
        view.viewport_height = 0; /* unknown */
        view.max_error = 1e6f;
        is_drawn_as(s, &view, &placed, 0);
    }
    subject_close(s, &shown);
}

/* Stretched along one axis, errors grow by as much. */
static void uneven_scale_is_bounded(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_bumpy(8, 0));
    double errors[GTX_MAX_MIPS];
    measure(shown.asset, 0, errors);
    gtx_camera camera = camera_around(shown.asset);
    camera.orthographic = 1;
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    const double pixels = pixels_a_unit(&view, gtx_patches(shown.asset), identity, 1);
    shown.instance.transform[5] = 3;
    view.max_error = (float)(errors[1] * pixels * 3.003);
    is_drawn_as(s, &view, &shown.instance, 1);
    view.max_error = (float)(errors[1] * pixels * 2.997);
    is_drawn_as(s, &view, &shown.instance, 0);
    subject_close(s, &shown);
}

static void the_camera_may_stand_in_the_patch(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_bumpy(8, 0));
    gtx_camera camera = camera_around(shown.asset);
    camera.distance = 0.4f;
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    view.max_error = 1000;
    is_drawn_as(s, &view, &shown.instance, 0);
    subject_close(s, &shown);
}

/* Every pixel of a view in which levels mix is covered if level 0 covers it, but for a rim. */
static void mixed_levels_leave_no_holes(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    static float fine[STAGE_PIXELS];
    double errors[GTX_MAX_MIPS];
    measure(shown.asset, 0, errors);
    long mixed = 0;
    for (int i = 0; i < 24; ++i) {
        camera.azimuth = 15.f * (float)i;
        camera.elevation = 35.f - 3.f * (float)i;
        camera.distance = 1.9f + 0.1f * (float)i;
        gtx_view view = view_of(&camera);
        static uint8_t images[5][4 * STAGE_PIXELS];
        view.viewport_height = STAGE_HEIGHT;
        /* Patch 0 barely has level 1, 2 or 3; nearer ones have a finer one. */
        const double pixels = pixels_a_unit(&view, gtx_patches(shown.asset), identity, 1);
        view.max_error = (float)(errors[1 + i % 3] * pixels * 1.01);
        for (uint32_t k = 0; k < 5; ++k) {
            view.level = (k + 1) % 5;
            stage_draw(s, &view, &shown.instance, 1);
            memcpy(images[k], s->color, sizeof images[k]);
            if (k == 0)
                memcpy(fine, s->depth, sizeof fine);
        }
        int pure = 0;
        for (int k = 0; k < 4; ++k)
            pure += memcmp(images[k], images[4], sizeof images[4]) == 0;
        mixed += !pure;
        for (int p = STAGE_WIDTH + 1; p < STAGE_PIXELS - STAGE_WIDTH - 1; ++p) {
            int inside = 1;
            for (int d = 0; d < 9; ++d)
                inside = inside && fine[p + (d / 3 - 1) * STAGE_WIDTH + d % 3 - 1] < 1;
            if (inside && s->depth[p] == 1)
                fail_msg("view %d: a hole at %d, %d", i, p % STAGE_WIDTH, p / STAGE_WIDTH);
        }
    }
    assert_true(mixed >= 12);
    subject_close(s, &shown);
}

static void bad_errors_and_levels_are_refused(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_flat(0.5, 8));
    const gtx_camera camera = camera_around(shown.asset);
    const struct {
        float max_error;
        uint32_t level;
    } bad[] = {{-1, 0}, {NAN, 0}, {INFINITY, 0}, {0, GTX_MAX_MIPS + 1}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        gtx_view view = view_of(&camera);
        view.max_error = bad[i].max_error;
        view.level = bad[i].level;
        assert_int_equal(gtx_draw(s->renderer, &view, &shown.instance, 1, NULL),
                         GTX_ERROR_ARGUMENT);
    }
    gtx_view view = view_of(&camera); /* beyond the last level of the asset is its last */
    view.level = GTX_MAX_MIPS;
    stage_draw(s, &view, &shown.instance, 1);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_coarsest_within_the_error),
        cmocka_unit_test(uneven_scale_is_bounded),
        cmocka_unit_test(the_camera_may_stand_in_the_patch),
        cmocka_unit_test(mixed_levels_leave_no_holes),
        cmocka_unit_test(bad_errors_and_levels_are_refused),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
