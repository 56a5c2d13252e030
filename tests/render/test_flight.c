/* A camera that flies through a patch: in every frame of the way each pixel is what the caster
 * finds, in ordinary and in reversed depth. */
#include "render/renderer.h"
#include "oracle.h"

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

/* Of someone who stands on a sphere. */
static gtx_view view_along(const gtx_asset *asset)
{
    const gtx_camera camera = camera_around(asset);
    gtx_view view = view_of(&camera);
    const float *target = camera.target, radius = camera.radius;
    const float axes[3][3] = {{0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};
    const float eye[3] = {target[0], target[1], target[2] + 0.6f * radius};
    for (int row = 0; row < 3; ++row) {
        view.view[12 + row] = 0;
        for (int k = 0; k < 3; ++k) {
            view.view[4 * k + row] = axes[row][k];
            view.view[12 + row] -= axes[row][k] * eye[k];
        }
    }
    const float near = 0.01f * radius, far = 4 * radius;
    view.projection[10] = -(far + near) / (far - near);
    view.projection[14] = -2 * near * far / (far - near);
    return view;
}

/* Slabs beside the eye, which the plane through it cuts, are not listed all over the picture. */
static void lists_stay_short(void **state)
{
    STAGE_OR_SKIP(state);
    if (!s->renderer->planner.tiles.max_texels)
        skip();
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    const gtx_tiles *t = &s->renderer->planner.tiles;
    const uint64_t before = t->draws;
    gtx_view view = view_along(shown.asset);
    view.level = 1;
    by_tiles(&view);
    const agreement a = stage_compare(s, shown.asset, &view, &shown.instance, 1);
    assert_int_equal(t->draws, before + 1);
    const double entries = 2.0 * t->list_texels / fmax(1, t->tile_count);
    if (a.wrong || a.hits < STAGE_PIXELS / 8 || entries > 4)
        fail_msg("%ld hits, %ld wrong; %g of %u slabs a tile", a.hits, a.wrong, entries,
                 t->visible_count);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(through_a_field),
        cmocka_unit_test(through_a_closed_model),
        cmocka_unit_test(lists_stay_short),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
