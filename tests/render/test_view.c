/* Every camera: reversed depth, clip conventions, near and far planes, a camera inside a patch. */
#include "oracle.h"

/* Without glClipControl the pipeline maps -1..1, so the other convention is asked for through the
 * matrix alone: depth written by the draw still follows the flag. */
static void every_depth_convention(void **state)
{
    STAGE_OR_SKIP(state);
    subject scene = subject_open(s, fixture_sphere(2, 64, 8));
    for (int i = 0; i < 8; ++i) {
        gtx_camera camera = camera_around(scene.asset);
        camera.reversed_z = i & 1;
        camera.zero_to_one = i >> 1 & 1;
        camera.orthographic = i >> 2 & 1;
        const gtx_view view = view_of(&camera);
        expect_agreement(s, &scene, &view, 4000);
    }
    subject_close(s, &scene);
}

static void reversed_equals_ordinary(void **state)
{
    STAGE_OR_SKIP(state);
    subject scene = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(scene.asset);
    gtx_view view = view_of(&camera);
    stage_draw(s, &view, &scene.instance, 1);
    uint8_t *color = malloc(sizeof s->color);
    memcpy(color, s->color, sizeof s->color);
    camera.reversed_z = camera.zero_to_one = 1;
    view = view_of(&camera);
    stage_draw(s, &view, &scene.instance, 1);
    int differ = 0;
    for (int i = 0; i < 4 * STAGE_PIXELS; ++i)
        differ += abs(color[i] - s->color[i]) > 1;
    /* Only where two patches overlap may rounding prefer the other one. */
    assert_in_range(differ, 0, STAGE_PIXELS / 500);
    free(color);
    subject_close(s, &scene);
}

static void infinite_far_plane(void **state)
{
    STAGE_OR_SKIP(state);
    subject scene = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(scene.asset);
    camera.reversed_z = camera.zero_to_one = 1;
    gtx_view finite = view_of(&camera), view = finite;
    view.projection[10] = 0;
    view.projection[14] = 0.1f;
    stage_draw(s, &view, &scene.instance, 1);
    float *depth = malloc(sizeof s->depth);
    memcpy(depth, s->depth, sizeof s->depth);
    stage_draw(s, &finite, &scene.instance, 1);
    int hits = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        assert_int_equal(depth[i] > 0, s->depth[i] > 0);
        if (s->depth[i] > 0) {
            const float a = gtx_camera_distance(view.projection, 1, depth[i]);
            const float b = gtx_camera_distance(finite.projection, 1, s->depth[i]);
            assert_true(fabsf(a - b) < 1e-4f * b);
            ++hits;
        }
    }
    assert_true(hits > 4000);
    free(depth);
    subject_close(s, &scene);
}

static void depth_range(void **state)
{
    STAGE_OR_SKIP(state);
    subject scene = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(scene.asset);
    gtx_view view = view_of(&camera);
    stage_draw(s, &view, &scene.instance, 1);
    float *whole = malloc(sizeof s->depth);
    memcpy(whole, s->depth, sizeof s->depth);
    view.depth_range[0] = 0.25f;
    view.depth_range[1] = 0.5f;
    stage_draw(s, &view, &scene.instance, 1);
    for (int i = 0; i < STAGE_PIXELS; ++i)
        if (whole[i] < 1)
            assert_true(fabsf(s->depth[i] - (0.25f + 0.25f * whole[i])) < 1e-6f);
    free(whole);
    subject_close(s, &scene);
}

/* Planes that cut the model: what is beyond them must be gone, and what is behind must show. */
static void near_and_far_cut(void **state)
{
    STAGE_OR_SKIP(state);
    subject scene = subject_open(s, fixture_bumpy(8, GTX_PATCH_TWO_SIDED));
    for (int i = 0; i < 4; ++i) {
        gtx_camera camera = camera_around(scene.asset);
        camera.orthographic = i & 1;
        camera.radius *= 0.5f; /* planes at half the reach, */
        camera.distance *= 2;  /* from the same place */
        camera.elevation = i & 2 ? 33 : 8;
        const gtx_view view = view_of(&camera);
        expect_agreement(s, &scene, &view, 200);
    }
    subject_close(s, &scene);
}

/* Mirrored by the view, by the instance, by both and by neither. */
static void camera_inside_boxes(void **state)
{
    STAGE_OR_SKIP(state);
    subject ball = subject_open(s, fixture_sphere(2, 64, 8));
    subject field = subject_open(s, fixture_bumpy(8, GTX_PATCH_TWO_SIDED));
    subject *subjects[2] = {&ball, &field};
    for (int k = 0; k < 2; ++k)
        for (int i = 0; i < 8; ++i) {
            gtx_camera camera = camera_around(subjects[k]->asset);
            camera.distance = k ? 0.02f + 0.1f * (float)i : 0.63f + 0.01f * (float)i;
            camera.azimuth = 60.0f * (float)i;
            camera.elevation = 20;
            gtx_view view = view_of(&camera);
            if (i & 1)
                view.projection[0] = -view.projection[0];
            if (i & 2) { /* about the plane x = target[0] */
                subjects[k]->instance.transform[0] = -1;
                subjects[k]->instance.transform[12] = 2 * camera.target[0];
            }
            expect_agreement(s, subjects[k], &view, 100);
            memcpy(subjects[k]->instance.transform, identity, sizeof identity);
        }
    subject_close(s, &ball);
    subject_close(s, &field);
}

/* A two-sided height field is lit on the side that is seen. */
static void the_back_is_lit_too(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_bumpy(8, GTX_PATCH_TWO_SIDED));
    shown.instance.tint[0] = shown.instance.tint[3] = 1;
    double mean[2] = {0, 0};
    for (int side = 0; side < 2; ++side) {
        gtx_camera camera = camera_around(shown.asset);
        camera.azimuth = side ? 36.87f + 180 : 36.87f; /* along the patch's z, (0.6, 0, 0.8) */
        camera.elevation = 0;
        const gtx_view view = view_of(&camera);
        stage_draw(s, &view, &shown.instance, 1);
        long hits = 0;
        for (int i = 0; i < STAGE_PIXELS; ++i)
            if (s->depth[i] < 1) {
                mean[side] += s->color[4 * i];
                ++hits;
            }
        assert_true(hits > 2000);
        mean[side] /= (double)hits;
    }
    assert_true(fabs(mean[0] - mean[1]) < 0.1 * mean[0]);
    subject_close(s, &shown);
}

static void headlight_and_light(void **state)
{
    STAGE_OR_SKIP(state);
    subject scene = subject_open(s, fixture_flat(0.5, 8));
    gtx_camera camera = camera_around(scene.asset);
    camera.azimuth = 0;
    camera.elevation = 0; /* along the height field's normal: +Z */
    camera.orthographic = 1;
    gtx_view view = view_of(&camera);
    const int middle = 4 * (STAGE_HEIGHT / 2 * STAGE_WIDTH + STAGE_WIDTH / 2);
    stage_draw(s, &view, &scene.instance, 1);
    const uint8_t head[3] = {s->color[middle], s->color[middle + 1], s->color[middle + 2]};
    assert_true(head[0] > 0 && s->color[middle + 3] == 255);
    view.light_direction[2] = 5;
    stage_draw(s, &view, &scene.instance, 1);
    for (int c = 0; c < 3; ++c)
        assert_in_range(s->color[middle + c], head[c] - 1, head[c] + 1);
    view.light_direction[2] = -5; /* from behind: ambient alone, a fifth of the linear light */
    stage_draw(s, &view, &scene.instance, 1);
    for (int c = 0; c < 3; ++c) {
        const double lit = pow((head[c] / 255.0 + 0.055) / 1.055, 2.4);
        const double dark = pow((s->color[middle + c] / 255.0 + 0.055) / 1.055, 2.4);
        if (head[c] > 40)
            assert_true(fabs(dark / lit - 0.2) < 0.02);
    }
    subject_close(s, &scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_depth_convention), cmocka_unit_test(reversed_equals_ordinary),
        cmocka_unit_test(infinite_far_plane),     cmocka_unit_test(depth_range),
        cmocka_unit_test(near_and_far_cut),       cmocka_unit_test(camera_inside_boxes),
        cmocka_unit_test(headlight_and_light),    cmocka_unit_test(the_back_is_lit_too),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
