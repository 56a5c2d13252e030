/* Walking and flying: where the eye goes, and how it stands on the ground. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

#include "host/walk.h"

#include <math.h>
#include <string.h>

static void expect_eye(const gtx_camera *camera, float x, float y, float z)
{
    float eye[3];
    gtx_walk_eye(camera, eye);
    if (fabsf(eye[0] - x) + fabsf(eye[1] - y) + fabsf(eye[2] - z) > 1e-4f)
        fail_msg("the eye is at %g %g %g, not at %g %g %g", (double)eye[0], (double)eye[1],
                 (double)eye[2], (double)x, (double)y, (double)z);
}

/* What is seen does not change when walking begins, nor when it ends. */
static void it_begins_and_ends_where_the_eye_is(void **state)
{
    (void)state;
    gtx_camera camera = {.target = {1, 2, 3}, .radius = 2, .azimuth = 40, .elevation = 25,
                         .distance = 3, .pan = {0.5f, 0, 0}};
    float orbit[16], walk[16], again[16], projection[16], eye[3];
    gtx_camera_matrices(&camera, 1, orbit, projection);
    gtx_walk_eye(&camera, eye);
    gtx_walk_begin(&camera);
    assert_true(camera.distance == 0);
    expect_eye(&camera, eye[0], eye[1], eye[2]);
    gtx_camera_matrices(&camera, 1, walk, projection);
    gtx_walk_end(&camera, 3);
    assert_true(camera.distance == 3);
    gtx_camera_matrices(&camera, 1, again, projection);
    for (int i = 0; i < 16; ++i) {
        assert_true(fabsf(orbit[i] - walk[i]) < 1e-4f);
        assert_true(fabsf(orbit[i] - again[i]) < 1e-4f);
    }
}

/* Azimuth 0 looks along -Z, and turns to the left. */
static void steps_follow_the_view(void **state)
{
    (void)state;
    gtx_camera camera = {.radius = 1};
    gtx_walk_move(&camera, (float[3]){1, 2, 3}, 1);
    expect_eye(&camera, 1, 2, -3);
    camera.azimuth = 90;
    gtx_walk_move(&camera, (float[3]){0, 0, 2}, 1);
    expect_eye(&camera, -1, 2, -3);
    gtx_walk_move(&camera, (float[3]){4, 0, 0}, 1);
    expect_eye(&camera, -1, 2, -7);
}

/* Looking down, who walks goes on along the ground, and who flies goes down. */
static void walking_is_level_and_flying_is_not(void **state)
{
    (void)state;
    const float root = 0.70710678f;
    for (int level = 0; level < 2; ++level) {
        gtx_camera camera = {.radius = 1, .elevation = 45};
        gtx_walk_move(&camera, (float[3]){0, 0, 1}, level);
        expect_eye(&camera, 0, level ? 0 : -root, level ? -1 : -root);
    }
    gtx_camera camera = {.radius = 1, .elevation = 89};
    gtx_walk_move(&camera, (float[3]){0, 0, 1}, 1);
    expect_eye(&camera, 0, 0, -1); /* as fast straight down */
}

static void it_stands_on_the_ground(void **state)
{
    (void)state;
    gtx_camera camera = {.target = {0, 10, 0}, .radius = 1, .pan = {5, 0, 5}};
    gtx_walk_stand(&camera, 3, 2, 0);
    expect_eye(&camera, 5, 10, 5); /* in no time it does not fall */
    float last = 10, eye[3];
    for (int i = 0; i < 10; ++i) {
        gtx_walk_stand(&camera, 3, 2, 0.02f);
        gtx_walk_eye(&camera, eye);
        assert_true(eye[1] < last && eye[1] > 5);
        last = eye[1];
    }
    gtx_walk_stand(&camera, 3, 2, 10);
    expect_eye(&camera, 5, 5, 5);
    gtx_walk_stand(&camera, 9, 2, 0); /* into a hill: never below the ground */
    expect_eye(&camera, 5, 9.5f, 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_begins_and_ends_where_the_eye_is),
        cmocka_unit_test(steps_follow_the_view),
        cmocka_unit_test(walking_is_level_and_flying_is_not),
        cmocka_unit_test(it_stands_on_the_ground),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
