/* Edits of a model on the GPU: as if it had been made of the edited asset. */
#include "edited.h"

static void an_updated_model_is_the_edited_one(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    subject shown = subject_open(s, fixture_sphere(2, 48, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    uint8_t *before = malloc(sizeof s->color), *expected = malloc(sizeof s->color);
    for (uint32_t i = 0; i < 6; ++i) { /* those towards the camera, a level each */
        const uint32_t patch = 2 * (i / 2);
        view.level = patch + 1;
        view.method = i % 2 ? GTX_METHOD_GRID : GTX_METHOD_CAST;
        if (patch == 2)
            by_tiles(&view);
        stage_draw(s, &view, &shown.instance, 1);
        memcpy(before, s->color, sizeof s->color);
        gtx_asset *change = edited(shown.asset, patch, 1);
        subject whole = subject_open(s, change);
        stage_draw(s, &view, &whole.instance, 1);
        memcpy(expected, s->color, sizeof s->color);
        assert_memory_not_equal(expected, before, sizeof s->color);
        must(gtx_model_update(s->renderer, shown.model, change, patch, &error), &error);
        stage_draw(s, &view, &shown.instance, 1);
        assert_memory_equal(expected, s->color, sizeof s->color);
        must(gtx_model_update(s->renderer, shown.model, shown.asset, patch, &error), &error);
        stage_draw(s, &view, &shown.instance, 1); /* and back again */
        assert_memory_equal(before, s->color, sizeof s->color);
        subject_close(s, &whole);
    }
    free(before);
    free(expected);
    subject_close(s, &shown);
}

/* Where the near plane cuts them, patches are cast in boxes, by slabs that follow the edit. */
static void cut_patches_are_the_edited_ones(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    subject shown = subject_open(s, fixture_sphere(2, 48, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    uint8_t *expected = malloc(sizeof s->color);
    const float near = (camera.distance - 0.5f) * camera.radius, far = 4 * near;
    view.projection[10] = -(far + near) / (far - near);
    view.projection[14] = -2 * far * near / (far - near);
    view.method = GTX_METHOD_CAST;
    for (uint32_t patch = 0; patch < 6; patch += 2) {
        gtx_asset *change = edited(shown.asset, patch, 1);
        subject whole = subject_open(s, change);
        view.level = patch / 2 + 1;
        stage_draw(s, &view, &whole.instance, 1);
        memcpy(expected, s->color, sizeof s->color);
        stage_draw(s, &view, &shown.instance, 1);
        assert_memory_not_equal(expected, s->color, sizeof s->color);
        must(gtx_model_update(s->renderer, shown.model, change, patch, &error), &error);
        stage_draw(s, &view, &shown.instance, 1);
        assert_memory_equal(expected, s->color, sizeof s->color);
        must(gtx_model_update(s->renderer, shown.model, shown.asset, patch, &error), &error);
        subject_close(s, &whole);
    }
    free(expected);
    subject_close(s, &shown);
}

static void others_are_refused(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 48, 8));
    gtx_asset *other = fixture_sphere(2, 56, 8), *deep = fixture_sphere(2, 48, 16);
    gtx_asset *moved = fixture_sphere(2, 48, 8); /* two rectangles have changed places */
    gtx_patch *patches = (gtx_patch *)(uintptr_t)gtx_patches(moved);
    uint16_t rect[4];
    memcpy(rect, patches[0].rect, sizeof rect);
    memcpy(patches[0].rect, patches[1].rect, sizeof rect);
    memcpy(patches[1].rect, rect, sizeof rect);
    gtx_model *waiting = NULL;
    assert_int_equal(gtx_model_prepare(shown.asset, NULL, &waiting, NULL), GTX_OK);
    const struct {
        gtx_model *model;
        const gtx_asset *asset;
        uint32_t patch;
    } bad[] = {{shown.model, other, 0}, {shown.model, deep, 0},    {shown.model, shown.asset, 6},
               {shown.model, moved, 0},
               {shown.model, NULL, 0},  {NULL, shown.asset, 0},    {waiting, shown.asset, 0}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        assert_int_equal(gtx_model_update(s->renderer, bad[i].model, bad[i].asset, bad[i].patch,
                                          NULL), GTX_ERROR_ARGUMENT);
    gtx_model_destroy(s->renderer, waiting);
    gtx_close(other);
    gtx_close(deep);
    gtx_close(moved);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_updated_model_is_the_edited_one),
        cmocka_unit_test(cut_patches_are_the_edited_ones),
        cmocka_unit_test(others_are_refused),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
