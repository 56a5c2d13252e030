/* Coming nearer and walking: no part is drawn coarser again, nor off by more than the error. */
#include "parts.h"

/* What was met on the way to a sphere. */
typedef struct approach {
    uint32_t changes, mixed;
} approach;

/* Comes nearer until a part is beside the picture, and on into the sphere. */
static approach come_nearer(stage *s, const subject *shown, float max_error, bool tiles)
{
    gtx_camera camera = camera_around(shown->asset);
    approach met = {0, 0};
    int before[6] = {LOD_LEVELS, LOD_LEVELS, LOD_LEVELS, LOD_LEVELS, LOD_LEVELS, LOD_LEVELS};
    for (camera.distance = 60; camera.distance > 0.2f; camera.distance *= 0.9f) {
        gtx_view view = view_of(&camera);
        view.viewport_height = STAGE_HEIGHT;
        view.viewport_width = tiles ? STAGE_WIDTH : 0;
        view.max_error = max_error;
        int now[6], least = LOD_LEVELS, most = 0;
        parts_of(s, &view, &shown->instance, now);
        for (int p = 0; p < 6; ++p) {
            if (now[p] < 0)
                continue;
            if (now[p] > before[p])
                fail_msg("patch %d: level %d after %d, %g radii away, within %g pixels", p, now[p],
                         before[p], (double)camera.distance, (double)max_error);
            met.changes += now[p] != before[p];
            before[p] = now[p];
            least = now[p] < least ? now[p] : least;
            most = now[p] > most ? now[p] : most;
        }
        met.mixed += least < most;
    }
    return met;
}

/* As a camera comes nearer no part is drawn by a coarser level, nor by a mesh again once it was
 * cast, not even where casting is cheap while it covers few pixels; in view as a whole or not. */
static void nearer_is_never_coarser(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_planner *planner = &s->renderer->planner;
    const gtx_costs usual = planner->costs;
    approach met = {0, 0};
    for (int i = 0; i < 4; ++i) {
        gtx_asset *sphere = fixture_sphere(radius, TEXELS, 8);
        subject shown = subject_open(s, with_lod_as(sphere, radius, LOD_LEVELS,
                                                    i & 1 ? GTX_PATCH_TWO_SIDED : 0, LOD_COLORED));
        planner->costs = (gtx_costs){100, 25, i & 2 ? 5500 : 500, i & 2 ? 75 : 160, 350};
        for (float allowed = 4; allowed > 0.02f; allowed /= 2) {
            const approach a = come_nearer(s, &shown, allowed, i & 2);
            met.changes += a.changes;
            met.mixed += a.mixed;
        }
        subject_close(s, &shown);
    }
    planner->costs = usual;
    assert_true(met.changes > 100);
    assert_true(met.mixed > 50);
}

/* What a walk close to the sphere met: changes of parts' levels since they showed last, and pixels
 * that either of AUTO and the cast shows more than a pixel beyond the other's outline. */
typedef struct stroll {
    uint32_t changes;
    long beyond;
} stroll;

static stroll walk(stage *s, const subject *shown, float max_error)
{
    int last[6] = {-1, -1, -1, -1, -1, -1};
    stroll met = {0, 0};
    for (int i = 0; i < 90; ++i) {
        gtx_view view = standing(0.05f * (float)i);
        view.max_error = max_error;
        by_tiles(&view);
        int now[6];
        parts_of(s, &view, &shown->instance, now);
        draw(s, &view, GTX_METHOD_CAST, &shown->instance, 1, &second);
        for (int p = 0; p < 6; ++p) {
            met.changes += now[p] >= 0 && last[p] >= 0 && now[p] != last[p];
            last[p] = now[p] >= 0 ? now[p] : last[p];
        }
        met.beyond += compare(&first, &second).holes + compare(&second, &first).holes;
    }
    return met;
}

/* Within the error what is drawn never jumps by more. */
static void a_walk_keeps_the_error(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, with_lod_as(fixture_sphere(radius, TEXELS, 8), radius,
                                                LOD_LEVELS, 0, LOD_COLORED));
    uint32_t changes = 0;
    for (float max_error = 0.4f; max_error <= 1; max_error += 0.2f) {
        const stroll met = walk(s, &shown, max_error);
        if (met.beyond)
            fail_msg("%ld pixels, within an error of %g", met.beyond, (double)max_error);
        changes += met.changes;
    }
    assert_true(changes > 4);
    assert_true(walk(s, &shown, 12).beyond > 0); /* or the test could not tell */
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nearer_is_never_coarser),
        cmocka_unit_test(a_walk_keeps_the_error),
    };
    return cmocka_run_group_tests(tests, open_stage, stage_close);
}
