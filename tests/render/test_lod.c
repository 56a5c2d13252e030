/* The LOD mesh: drawn as casting draws, at the level that the error allows. */
#include "frame/frustum.h"
#include "parts.h"

/* From many sides: no hole, the outline, and colours, which show the normals. */
static void as_cast(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    gtx_camera camera = camera_around(shown.asset);
    for (int i = 0; i < 12; ++i) {
        camera.azimuth = 36 * (float)i;
        camera.elevation = 80 - 14 * (float)i;
        camera.orthographic = i % 2;
        gtx_view view = view_of(&camera);
        view.level = 1;
        draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
        draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &second);
        const difference d = compare(&first, &second);
        expect_alike(&d, 0.995, 0.6, 16); /* at the outline mip levels differ */
    }
    subject_close(s, &shown);
}

/* Without colours, and with materials and emission; tinted, from dark to over-bright. */
static void all_looks(void **state)
{
    STAGE_OR_SKIP(state);
    static const lod_looks looks[] = {LOD_PLAIN, LOD_SHINY};
    for (int i = 0; i < 4; ++i) {
        gtx_asset *sphere = fixture_sphere(radius, TEXELS, 8);
        subject shown =
            subject_open(s, with_lod_as(sphere, radius, LOD_LEVELS,
                                        i / 2 ? GTX_PATCH_TWO_SIDED : 0, looks[i % 2]));
        memcpy(shown.instance.tint, (float[4]){0.02f, 0.4f, 1.6f, 1}, 4 * sizeof(float));
        gtx_camera camera = camera_around(shown.asset);
        gtx_view view = view_of(&camera);
        view.level = 1;
        view.light_direction[1] = 1;
        draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
        draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &second);
        const difference d = compare(&first, &second);
        expect_alike(&d, 0.995, 0.6, 24);
        subject_close(s, &shown);
    }
}

/* One material all over is not looked up, and looks the same; two are. */
static void one_material_looks_the_same(void **state)
{
    STAGE_OR_SKIP(state);
    for (int i = 0; i < 2; ++i) {
        const lod_looks looks[2] = {i ? LOD_UNEVEN : LOD_EVEN,
                                    i ? LOD_UNEVEN_DARK : LOD_EVEN_DARK};
        for (int k = 0; k < 2; ++k) {
            subject shown = subject_open(s, with_lod_as(fixture_sphere(radius, TEXELS, 8), radius,
                                                        LOD_LEVELS, 0, looks[k]));
            gtx_camera camera = camera_around(shown.asset);
            gtx_view view = view_of(&camera);
            draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, k ? &second : &first);
            subject_close(s, &shown);
        }
        const difference d = compare(&first, &second);
        expect_alike(&d, 1, 0.01, 1);
    }
}

/* Within an error of half a pixel, whatever LOD mesh and of the maps that takes. */
static void levels_keep_the_looks(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    gtx_camera camera = camera_around(shown.asset);
    for (int i = 0; i < 6; ++i) {
        camera.distance = 3 + 1.5f * (float)i;
        camera.azimuth = 50 * (float)i;
        gtx_view view = view_of(&camera);
        view.viewport_height = STAGE_HEIGHT;
        draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
        draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &second);
        const difference d = compare(&first, &second);
        const double iou = (double)d.both / (double)d.either;
        if (iou < 0.975 || d.holes || d.mean > 3)
            fail_msg("IoU %g, %ld holes, colours differ by %g", iou, d.holes, d.mean);
    }
    subject_close(s, &shown);
}

/* Which level a view draws an instance by: n for level n - 1; 0 none, patch by patch. */
static uint32_t drawn_as(stage *s, const gtx_view *view, const gtx_instance *instance)
{
    gtx_view forced = *view;
    uint32_t found = UINT32_MAX;
    draw(s, view, view->method, instance, 1, &first);
    for (uint32_t way = 1; way <= LOD_LEVELS; ++way) {
        forced.level = way;
        draw(s, &forced, GTX_METHOD_LOD, instance, 1, &second);
        if (memcmp(first.color, second.color, sizeof first.color) == 0) {
            assert_int_equal(found, UINT32_MAX); /* or the test could not tell */
            found = way;
        }
    }
    if (found != UINT32_MAX)
        return found;
    assert_int_equal(view->method, GTX_METHOD_AUTO);
    return 0;
}

/* Every part by the coarsest level within the error where its sphere is nearest, of a whole that is
 * `distance` away; or all by one that is within it everywhere. Returns whether they were looked at
 * one by one. */
static bool each_by_its_own(stage *s, const gtx_view *view, const subject *shown,
                            double distance)
{
    gtx_planner *planner = &s->renderer->planner;
    const gtx_lod_meshes *lods = &shown->model->lods;
    int levels[6];
    parts_of(s, view, &shown->instance, levels);
    const bool whole = planner->ways[0] != GTX_DRAW_PATCHES;
    const gtx_frustum f = gtx_frustum_of(&planner->call, shown->model, planner->instances);
    for (int p = 0; p < 6; ++p) {
        const double allowed =
            fmax(gtx_allowed_error(&f, shown->model->facts[p].sphere), distance / f.scale);
        int expected = 0;
        while (expected < LOD_LEVELS && lods->levels[expected].error <= allowed)
            ++expected;
        if (whole ? levels[p] > expected : levels[p] != expected)
            fail_msg("patch %d: level %d for %d, error %g", p, levels[p], expected,
                     (double)view->max_error);
    }
    return !whole;
}

/* The coarsest level within the error at the nearest corner of the bounds. */
static void the_coarsest_within_the_error(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    gtx_camera camera = camera_around(shown.asset);
    camera.azimuth = camera.elevation = 0; /* the nearest point of the bounds is on the axis */
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    const double distance = camera.distance * camera.radius - radius;
    const double pixels = view.projection[5] * STAGE_HEIGHT / 2 / distance;
    uint32_t by_parts = 0;
    for (uint32_t k = 0; k < LOD_LEVELS; ++k) {
        gtx_lod_mesh level;
        assert_int_equal(gtx_get_lod_mesh(shown.asset, k, &level), GTX_OK);
        for (int over = 0; over < 2; ++over) {
            view.max_error = (float)(level.error * pixels * (over ? 1.02 : 0.98));
            by_parts += each_by_its_own(s, &view, &shown, distance);
            view.method = GTX_METHOD_LOD; /* at its finest where none is within the error */
            assert_int_equal(drawn_as(s, &view, &shown.instance), k + (over || !k ? 1 : 0));
        }
    }
    assert_true(by_parts > 0 && by_parts < 2 * LOD_LEVELS);
    /* A large instance far away is as near. */
    for (int i = 0; i < 15; i += 5)
        shown.instance.transform[i] = 3;
    camera.radius *= 3;
    view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    view.method = GTX_METHOD_LOD;
    gtx_lod_mesh level;
    assert_int_equal(gtx_get_lod_mesh(shown.asset, 1, &level), GTX_OK);
    for (int over = 0; over < 2; ++over) {
        view.max_error = (float)(level.error * pixels * (over ? 1.02 : 0.98));
        assert_int_equal(drawn_as(s, &view, &shown.instance), over ? 2 : 1);
    }
    subject_close(s, &shown);
}

static void casts_when_it_must(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    view.max_error = 50;
    assert_int_equal(drawn_as(s, &view, &shown.instance), 0); /* the viewport is unknown */
    view.viewport_height = STAGE_HEIGHT;
    assert_int_equal(drawn_as(s, &view, &shown.instance), LOD_LEVELS);
    camera.distance = 0.4f; /* inside */
    view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    view.max_error = 50;
    draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &first);
    draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &second);
    assert_memory_equal(first.color, second.color, sizeof first.color);
    subject_close(s, &shown);

    shown = subject_open(s, fixture_sphere(radius, TEXELS, 8));
    gtx_error error = {0};
    view.method = GTX_METHOD_LOD;
    assert_int_equal(gtx_draw(s->renderer, &view, &shown.instance, 1, &error),
                     GTX_ERROR_UNSUPPORTED);
    assert_non_null(strstr(error.message, "LOD mesh"));
    subject_close(s, &shown);
}

/* Costs that the caller gives decide. */
static void costs_are_compared(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_renderer *usual = s->renderer;
    gtx_error error = {0};
    gtx_asset *asset = with_lod(fixture_sphere(radius, TEXELS, 8), radius, LOD_LEVELS, 0);
    gtx_camera camera = camera_around(asset);
    for (int i = 0; i < 2; ++i) {
        const gtx_renderer_desc desc = {.load = gtx_offscreen_load, .log = stage_log,
                                        .costs = {i ? 1e6f : 1, 1, 1e3f, 1}};
        must(gtx_renderer_create(&desc, &s->renderer, &error), &error);
        subject shown = subject_open(s, asset);
        gtx_view view = view_of(&camera);
        view.viewport_height = STAGE_HEIGHT;
        view.max_error = 2;
        assert_int_equal(drawn_as(s, &view, &shown.instance) == 0, i);
        gtx_model_destroy(s->renderer, shown.model);
        gtx_renderer_destroy(s->renderer);
    }
    const float bad[] = {-1, NAN, INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        const gtx_renderer_desc desc = {.load = gtx_offscreen_load,
                                        .costs.cast_pixel = bad[i]};
        assert_int_equal(gtx_renderer_create(&desc, &s->renderer, &error), GTX_ERROR_ARGUMENT);
    }
    s->renderer = usual;
    gtx_close(asset);
}

/* Mean change of a byte of colour where either picture shows something. */
static double change(const picture *a, const picture *b)
{
    double sum = 0;
    long count = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        if (a->depth[i] == a->empty && b->depth[i] == b->empty)
            continue;
        for (int k = 0; k < 3; ++k)
            sum += fabs((double)a->color[4 * i + k] - b->color[4 * i + k]);
        count += 3;
    }
    return sum / (double)count;
}

/* Comes nearer by little steps. What the worst change of level does to the picture, and the worst
 * step, beyond what it does when everything is cast. */
typedef struct zoom {
    int changes;
    double change, step;
} zoom;

static zoom zoom_in(stage *s, const subject *shown)
{
    static picture frames[2][2]; /* cast, auto; this and the last */
    zoom out = {0, 0, 0};
    uint32_t last = 0;
    gtx_camera camera = camera_around(shown->asset);
    for (int i = 0; i < 70; ++i) {
        camera.distance = 12 * powf(0.98f, (float)i);
        gtx_view view = view_of(&camera);
        view.viewport_height = STAGE_HEIGHT;
        draw(s, &view, GTX_METHOD_CAST, &shown->instance, 1, &frames[0][i % 2]);
        draw(s, &view, GTX_METHOD_AUTO, &shown->instance, 1, &frames[1][i % 2]);
        if (i == 0) {
            last = drawn_as(s, &view, &shown->instance);
            continue;
        }
        out.step = fmax(out.step, change(&frames[1][0], &frames[1][1]) -
                                      change(&frames[0][0], &frames[0][1]));
        gtx_view as_before = view;
        as_before.level = last;
        draw(s, &as_before, last ? GTX_METHOD_LOD : GTX_METHOD_CAST, &shown->instance, 1, &first);
        if (memcmp(first.color, frames[1][i % 2].color, sizeof first.color) == 0)
            continue;
        ++out.changes;
        out.change = fmax(out.change, change(&first, &frames[1][i % 2]));
        last = drawn_as(s, &view, &shown->instance);
    }
    return out;
}

static void a_zoom_is_smooth(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    const zoom z = zoom_in(s, &shown);
    if (z.changes < 2 || z.change > 6 || z.step > 8)
        fail_msg("%d changes of up to %g, steps %g", z.changes, z.change, z.step);
    /* The coarsest level from near is another picture, or this test could not tell. */
    gtx_camera camera = camera_around(shown.asset);
    camera.distance = 1.8f;
    gtx_view view = view_of(&camera);
    view.level = 1;
    draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &first);
    view.level = LOD_LEVELS;
    draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &second);
    const double seen = change(&first, &second);
    if (seen < 6)
        fail_msg("the coarsest level from near is %g away", seen);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_cast),
        cmocka_unit_test(all_looks),
        cmocka_unit_test(one_material_looks_the_same),
        cmocka_unit_test(levels_keep_the_looks),
        cmocka_unit_test(the_coarsest_within_the_error),
        cmocka_unit_test(casts_when_it_must),
        cmocka_unit_test(costs_are_compared),
        cmocka_unit_test(a_zoom_is_smooth),
    };
    return cmocka_run_group_tests(tests, open_stage, stage_close);
}
