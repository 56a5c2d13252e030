/* Edits of a model that is drawn: the next frame is that of the edited asset, uploaded anew. */
#include "stage.h"

#include <geotex/edit.h>

/* Draws the model, and another made of the asset, and holds them against each other. */
static void expect_model_of(stage *s, const gtx_view *view, const subject *shown,
                            const gtx_asset *asset, uint8_t *scratch)
{
    gtx_error error = {0};
    gtx_instance fresh = shown->instance;
    gtx_model *model = NULL;
    stage_draw(s, view, &shown->instance, 1);
    memcpy(scratch, s->color, sizeof s->color);
    must(gtx_model_create(s->renderer, asset, &model, &error), &error);
    fresh.model = model;
    stage_draw(s, view, &fresh, 1);
    assert_memory_equal(scratch, s->color, sizeof s->color);
    gtx_model_destroy(s->renderer, model);
}

/* Every patch that a refresh tells of; returns how many. */
static uint32_t send(stage *s, gtx_edit *edit, const subject *shown, const gtx_asset **live)
{
    gtx_error error = {0};
    const uint32_t *patches;
    uint32_t count;
    must(gtx_edit_refresh(edit, live, &patches, &count, &error), &error);
    for (uint32_t i = 0; i < count; ++i)
        must(gtx_model_update(s->renderer, shown->model, *live, patches[i], &error), &error);
    return count;
}

static void stamps_show_in_the_next_frame(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    uint8_t *before = malloc(sizeof s->color), *scratch = malloc(sizeof s->color);
    const gtx_asset *live;
    gtx_edit *edit = NULL;
    must(gtx_edit_begin(shown.asset, NULL, &edit, &error), &error);
    for (int i = 0; i < 4; ++i) { /* craters and hills: some leave the patches' ranges of heights */
        const float x = 0.5f + 0.2f * (float)i, z = 1.2f - 0.3f * (float)i;
        const float y = sqrtf(4 - x * x - z * z);
        const gtx_edit_stamp_desc stamp = {.centre = {x, y, z}, .radius = 0.7f,
                                           .direction = {-x, -y, -z},
                                           .depth = i % 2 ? -0.4f : 0.25f};
        stage_draw(s, &view, &shown.instance, 1);
        memcpy(before, s->color, sizeof s->color);
        must(gtx_edit_stamp(edit, &stamp, &error), &error);
        assert_true(send(s, edit, &shown, &live) >= 1);
        view.level = (uint32_t)i % 3;
        expect_model_of(s, &view, &shown, live, scratch);
        assert_memory_not_equal(before, s->color, sizeof s->color);
    }
    gtx_edit_end(edit);
    free(before);
    free(scratch);
    subject_close(s, &shown);
}

static void a_rectangle_takes_its_neighbours_along(void **state)
{
    STAGE_OR_SKIP(state);
    enum { SIDE = 40 };
    gtx_error error = {0};
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    uint8_t *scratch = malloc(sizeof s->color);
    float heights[SIDE * SIDE];
    const gtx_asset *live;
    gtx_edit *edit = NULL;
    must(gtx_edit_begin(shown.asset, NULL, &edit, &error), &error);
    for (int i = 0; i < SIDE * SIDE; ++i)
        heights[i] = 0.6f;
    const uint32_t rectangle[4] = {24, 24, SIDE, SIDE}; /* up to the patch's corner */
    must(gtx_edit_set_heights(edit, 0, rectangle, heights, &error), &error);
    assert_true(send(s, edit, &shown, &live) > 1);
    expect_model_of(s, &view, &shown, live, scratch);
    gtx_edit_end(edit);
    free(scratch);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stamps_show_in_the_next_frame),
        cmocka_unit_test(a_rectangle_takes_its_neighbours_along),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
