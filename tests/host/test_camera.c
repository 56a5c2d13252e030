/* The orbit camera: where it stands, what it sees, and the depth it writes. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

#include "host/camera.h"

#include <math.h>

static void project(const gtx_camera *camera, const float point[3], float clip[4])
{
    float view[16], projection[16], both[16];
    gtx_camera_matrices(camera, 1.5f, view, projection);
    gtx_matrix_multiply(projection, view, both);
    for (int i = 0; i < 4; ++i)
        clip[i] = both[i] * point[0] + both[4 + i] * point[1] + both[8 + i] * point[2] +
                  both[12 + i];
}

/* Azimuth 0 stands on +Z; azimuth turns towards +X, elevation towards +Y. */
static void where_it_stands(void **state)
{
    (void)state;
    static const float angles[][2] = {{0, 0}, {90, 0}, {180, 0}, {0, 90}, {0, -90}, {45, 0}};
    static const float away[][3] = {{0, 0, 1}, {1, 0, 0}, {0, 0, -1},
                                    {0, 1, 0}, {0, -1, 0}, {0.70710678f, 0, 0.70710678f}};
    for (int i = 0; i < 6; ++i) {
        gtx_camera camera = {.target = {4, 5, 6}, .radius = 2, .distance = 3};
        float view[16], projection[16];
        camera.azimuth = angles[i][0];
        camera.elevation = angles[i][1];
        gtx_camera_matrices(&camera, 1, view, projection);
        for (int row = 0; row < 3; ++row) { /* the eye is the origin of eye space */
            float sum = view[12 + row];
            for (int k = 0; k < 3; ++k)
                sum += view[4 * k + row] * (camera.target[k] + 6 * away[i][k]);
            assert_true(fabsf(sum) < 1e-5f);
        }
    }
}

static void framing_a_box(void **state)
{
    (void)state;
    gtx_camera camera = {.azimuth = 7, .distance = 3};
    gtx_camera_frame(&camera, (float[3]){-1, 0, 2}, (float[3]){3, 2, 6});
    const float target[3] = {1, 1, 4};
    for (int k = 0; k < 3; ++k)
        assert_true(camera.target[k] == target[k]);
    assert_true(camera.radius == 3 && camera.azimuth == 7 && camera.distance == 3);
}

static void up_is_up_and_right_is_right(void **state)
{
    (void)state;
    for (int ortho = 0; ortho < 2; ++ortho) {
        const gtx_camera camera = {.radius = 1, .distance = 3, .orthographic = ortho};
        float clip[4];
        project(&camera, (float[3]){0.5f, 0.25f, 0}, clip);
        assert_true(clip[0] > 0 && clip[1] > 0 && clip[3] > 0);
    }
}

/* Every point of the sphere lies between the planes, in every convention, and its distance comes
 * back from its depth. */
static void depth_of_the_sphere(void **state)
{
    (void)state;
    for (int i = 0; i < 8; ++i)
        for (int turn = 0; turn < 12; ++turn) {
            gtx_camera camera = {.target = {1, 2, 3}, .radius = 2, .azimuth = 30.0f * (float)turn,
                                 .elevation = 20, .distance = 3};
            float clip[4], view[16], projection[16];
            camera.orthographic = i & 1;
            camera.reversed_z = i >> 1 & 1;
            camera.zero_to_one = i >> 2 & 1;
            const float point[3] = {1, 2, 3 + 2};
            project(&camera, point, clip);
            const float ndc = clip[2] / clip[3], low = camera.zero_to_one ? 0 : -1;
            assert_true(ndc >= low && ndc <= 1);
            gtx_camera_matrices(&camera, 1.5f, view, projection);
            float along = -view[14];
            for (int k = 0; k < 3; ++k)
                along -= view[4 * k + 2] * point[k];
            const float depth = camera.zero_to_one ? ndc : 0.5f + 0.5f * ndc;
            const float found = gtx_camera_distance(projection, camera.zero_to_one, depth);
            assert_true(fabsf(found - along) < 1e-3f * along);
        }
}

static void nearer_is_smaller_unless_reversed(void **state)
{
    (void)state;
    for (int i = 0; i < 4; ++i) {
        gtx_camera camera = {.radius = 1, .distance = 3};
        float near[4], far[4];
        camera.orthographic = i & 1;
        camera.reversed_z = i >> 1;
        project(&camera, (float[3]){0, 0, 0.5f}, near);
        project(&camera, (float[3]){0, 0, -0.5f}, far);
        const int smaller = near[2] / near[3] < far[2] / far[3];
        assert_int_equal(smaller, !camera.reversed_z);
    }
}

/* An orthographic view inscribes the sphere in 96 % of the shorter side. */
static void orthographic_fit(void **state)
{
    (void)state;
    gtx_camera camera = {.radius = 5, .distance = 3, .orthographic = 1};
    float clip[4], view[16], projection[16];
    project(&camera, (float[3]){0, 5, 0}, clip);
    assert_true(fabsf(clip[1] - 0.96f) < 1e-5f);
    gtx_camera_matrices(&camera, 0.5f, view, projection);
    assert_true(fabsf(projection[0] * 5 - 0.96f) < 1e-5f);
}

static void placing(void **state)
{
    (void)state;
    float m[16];
    gtx_matrix_place(1, 2, 3, 90, 2, m); /* +Z goes to +X */
    const float x = m[8] + m[12], y = m[9] + m[13], z = m[10] + m[14];
    assert_true(fabsf(x - 3) < 1e-6f && fabsf(y - 2) < 1e-6f && fabsf(z - 3) < 1e-6f);

    /* The box 1..3 x 2..6 x 4..10 on (7, 8, 9), half as high: what is left is behind. */
    const float low[3] = {1, 2, 4}, high[3] = {3, 6, 10}, foot[3] = {7, 8, 9};
    gtx_matrix_stand(low, high, foot, 90, 2, m);
    const float at[3] = {m[0] + 2 * m[4] + 7 * m[8] + m[12], m[1] + 2 * m[5] + 7 * m[9] + m[13],
                         m[2] + 2 * m[6] + 7 * m[10] + m[14]}; /* the middle of its side at x = 1 */
    assert_true(fabsf(at[0] - 7) < 1e-5f && fabsf(at[1] - 8) < 1e-5f &&
                fabsf(at[2] - 9.5f) < 1e-5f);
}

/* Panned, the eye moves and looks along the same axis, and the planes still enclose the sphere. */
static void panning_keeps_the_sphere_between_the_planes(void **state)
{
    (void)state;
    for (int i = -3; i <= 3; ++i) {
        gtx_camera camera = {.radius = 2, .distance = 3, .azimuth = 30, .elevation = 10};
        float right[3], up[3], back[3], clip[4], nearest[3], farthest[3];
        gtx_camera_axes(&camera, right, up, back);
        for (int k = 0; k < 3; ++k) {
            camera.pan[k] = 0.7f * (float)i * (right[k] + 0.5f * back[k]);
            nearest[k] = camera.radius * back[k];
            farthest[k] = -camera.radius * back[k];
        }
        project(&camera, camera.pan, clip); /* what is looked at stays in the middle */
        assert_true(fabsf(clip[0]) < 1e-5f && fabsf(clip[1]) < 1e-5f);
        project(&camera, nearest, clip);
        assert_true(clip[2] > -clip[3] && clip[2] < clip[3]);
        project(&camera, farthest, clip);
        assert_true(clip[2] > -clip[3] && clip[2] < clip[3]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(panning_keeps_the_sphere_between_the_planes),
        cmocka_unit_test(framing_a_box),
        cmocka_unit_test(where_it_stands),     cmocka_unit_test(up_is_up_and_right_is_right),
        cmocka_unit_test(depth_of_the_sphere), cmocka_unit_test(nearer_is_smaller_unless_reversed),
        cmocka_unit_test(orthographic_fit),    cmocka_unit_test(placing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
