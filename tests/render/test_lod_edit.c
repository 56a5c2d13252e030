/* Edited patches among those of the LOD mesh: they are cast. */
#include "pictures.h"

/* A patch that is edited leaves the LOD mesh: it is cast, as it has become, and the others stay. */
static void an_edited_patch_is_cast(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    gtx_error error = {0};
    gtx_asset *small = fixture_sphere(0.9 * radius, TEXELS, 8);
    gtx_camera camera = camera_around(shown.asset);
    camera.azimuth = camera.elevation = 3;
    gtx_view view = view_of(&camera);
    view.level = 1;
    draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &first);
    must(gtx_model_update(s->renderer, shown.model, small, 4, &error), &error); /* towards +z */
    draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &second);
    long nearer = 0, farther = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
nearer += second.depth[i] < first.depth[i];
        farther += second.depth[i] > first.depth[i];
    }
    assert_true(farther > 1000);
    assert_int_equal(nearer, 0);
    view.pass = GTX_PASS_DEPTH;
    draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &first);
    assert_memory_equal(first.depth, second.depth, sizeof first.depth);
    view.pass = GTX_PASS_FORWARD;
    view.level = 0;
    view.viewport_height = STAGE_HEIGHT;
    view.max_error = 2;
    const int middle = STAGE_HEIGHT / 2 * STAGE_WIDTH + STAGE_WIDTH / 2;
    draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &first);
    draw(s, &view, GTX_METHOD_GRID, &shown.instance, 1, &second);
    const float as_grid = second.depth[middle];
    draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &second);
    assert_true(first.depth[middle] == second.depth[middle] || first.depth[middle] == as_grid);
    const difference d = compare(&second, &first);
    assert_true(d.worst > 0); /* the others are not cast */
    gtx_close(small);
    subject_close(s, &shown);
}

/* A far level has no place for a patch that is edited: the coarsest of the others is drawn then. */
static void no_far_level_beside_edited_patches(void **state)
{
    STAGE_OR_SKIP(state);
    static lod_level made[2];
    gtx_asset *sphere = fixture_sphere(radius, TEXELS, 8);
    gtx_lod_mesh lods[2];
    for (int k = 0; k < 2; ++k) {
        make_lod_level(gtx_patches(sphere), 6, radius, k ? 4 : 8, &made[k]);
        lods[k] = made[k].lod;
    }
    lods[1].flags = GTX_LOD_FAR;
    subject shown = subject_open(s, with_lod_meshes(sphere, lods, 2, 0, LOD_COLORED));
    gtx_camera camera = camera_around(shown.asset);
    camera.azimuth = 180; /* behind the one that is edited */
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    view.max_error = 50;
    gtx_view levels[2] = {view, view};
    levels[0].level = 1;
    levels[1].level = 2;
    for (int edited = 0; edited < 2; ++edited) {
        if (edited)
            must(gtx_model_update(s->renderer, shown.model, shown.asset, 4, &(gtx_error){0}),
                 &(gtx_error){0});
        for (int k = 0; k < 2; ++k) {
            draw(s, &view, k ? GTX_METHOD_AUTO : GTX_METHOD_LOD, &shown.instance, 1, &first);
            draw(s, &levels[1 - edited], GTX_METHOD_LOD, &shown.instance, 1, &second);
            assert_memory_equal(first.color, second.color, sizeof first.color);
        }
    }
    draw(s, &levels[0], GTX_METHOD_LOD, &shown.instance, 1, &first);
    draw(s, &levels[1], GTX_METHOD_LOD, &shown.instance, 1, &second); /* not even if asked for */
    assert_memory_equal(first.color, second.color, sizeof first.color);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_edited_patch_is_cast),
        cmocka_unit_test(no_far_level_beside_edited_patches),
    };
    return cmocka_run_group_tests(tests, open_stage, stage_close);
}
