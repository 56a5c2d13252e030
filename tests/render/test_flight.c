/* A camera that flies through a patch: in every frame of the way each pixel is what the caster
 * finds, in ordinary and in reversed depth. */
#include "stage.h"

enum { FRAMES = 24 };

/* On a line through the middle of the bounds, `way` radii from it. The near plane is so far off
 * that it cuts the height field in some frames while the eye is outside in others. */
static gtx_view view_on_line(const gtx_asset *asset, double way, int reversed)
{
    gtx_camera camera = camera_around(asset);
    camera.azimuth = 27;
    camera.elevation = 33;
    camera.zero_to_one = camera.reversed_z = reversed;
    gtx_view view = view_of(&camera);
    /* Along the view's own axis: eye space z of the middle is -distance * radius. */
    view.view[14] += (float)((camera.distance - way) * camera.radius);
    const float near = 0.06f * camera.radius, far = 8 * camera.radius;
    view.projection[10] = reversed ? near / (far - near) : -(far + near) / (far - near);
    view.projection[14] = reversed ? near * far / (far - near) : -2 * near * far / (far - near);
    return view;
}

static void fly(stage *s, gtx_asset *asset, uint32_t level, int tiles)
{
    subject shown = subject_open(s, asset);
    long hits = 0;
    for (int reversed = 0; reversed < 2; ++reversed)
        for (int i = 0; i < FRAMES; ++i) {
            gtx_view view = view_on_line(shown.asset, 1.2 - 2.0 * i / FRAMES, reversed);
            view.level = level;
            if (tiles)
                by_tiles(&view);
            const agreement a = stage_compare(s, shown.asset, &view, &shown.instance, 1);
            if (a.wrong || a.excluded * 100 > a.hits + 100)
                fail_msg("frame %d%s: %ld hits, %ld wrong, %ld excluded", i,
                         reversed ? ", reversed" : "", a.hits, a.wrong, a.excluded);
            hits += a.hits;
        }
    assert_true(hits > FRAMES * STAGE_PIXELS / 8);
    subject_close(s, &shown);
}

static void through_a_field(void **state)
{
    STAGE_OR_SKIP(state);
    for (int tiles = 0; tiles < 2; ++tiles) {
        fly(s, fixture_bumpy(8, GTX_PATCH_TWO_SIDED), 1, tiles);
        fly(s, fixture_bumpy(8, GTX_PATCH_TWO_SIDED), 2, tiles);
    }
}

static void through_a_closed_model(void **state)
{
    STAGE_OR_SKIP(state);
    fly(s, fixture_sphere(2, 64, 8), 1, 0);
    fly(s, fixture_sphere(2, 64, 8), 1, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(through_a_field),
        cmocka_unit_test(through_a_closed_model),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
