/* Casting by tiles against casting in fragments: the same picture, whatever is drawn. That it is
 * the caster's is looked at where casting in fragments is. The renderer falls back to fragments
 * silently, so each test looks at its count of draws by tiles. */
#include "render/renderer.h"
#include "stage.h"

static uint8_t other_color[4 * STAGE_PIXELS];
static float other_depth[STAGE_PIXELS];

static gtx_renderer *renderer_with(gtx_tiling tiles, const gtx_allocator *hooks)
{
    const gtx_renderer_desc desc = {
        .load = gtx_offscreen_load, .log = stage_log, .tiles = tiles, .allocator = hooks};
    gtx_renderer *renderer = NULL;
    gtx_error error = {0};
    must(gtx_renderer_create(&desc, &renderer, &error), &error);
    return renderer;
}

/* A stage whose renderer casts by tiles whatever the driver is. */
static int open_with_tiles(void **state)
{
    const int result = stage_open(state);
    stage *s = *state;
    if (result || !s->offscreen)
        return result;
    gtx_renderer_destroy(s->renderer);
    s->renderer = renderer_with(GTX_TILES_ALWAYS, NULL);
    return 0;
}

/* Draws, and by tiles, unless no instance is in view; OpenGL ES has no tiles. */
static void draw_by_tiles(stage *s, gtx_view *view, const gtx_instance *instances, uint32_t count,
                          bool in_view)
{
    const uint64_t before = s->renderer->planner.tiles.draws;
    by_tiles(view);
    stage_draw(s, view, instances, count);
    assert_int_equal(s->renderer->planner.tiles.draws > before, in_view && !s->renderer->gl.es);
}

/* How many pixels of the stage differ from those kept: in what they show, or in colour by more than
 * mip levels that fall on the other side of a half, or in depth. */
static int differences(const stage *s)
{
    int count = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        int differs = fabsf(s->depth[i] - other_depth[i]) > 2e-5f;
        for (int k = 0; k < 4; ++k)
            differs |= abs(s->color[4 * i + k] - other_color[4 * i + k]) > 12;
        count += differs;
    }
    return count;
}

static void keep(const stage *s)
{
    memcpy(other_color, s->color, sizeof other_color);
    memcpy(other_depth, s->depth, sizeof other_depth);
}

/* Three, of which one is mirrored, one is beside another, and one reaches behind the camera's near
 * plane. */
static void place(const subject *shown, gtx_instance out[3])
{
    for (int i = 0; i < 3; ++i) {
        out[i] = shown->instance;
        gtx_matrix_place((float)i - 1, 0.3f * (float)i, i == 2 ? 2.5f : 0, 25 * (float)i, 0.8f,
                         out[i].transform);
        out[i].id = 7 + (uint32_t)i;
    }
    for (int k = 0; k < 3; ++k)
        out[1].transform[k] *= -1;
    memcpy(out[1].tint, (float[4]){1, 0.5f, 0.25f, 1}, sizeof out[1].tint);
}

static void the_same_picture(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *assets[] = {fixture_sphere(2, 64, 8), fixture_bumpy(16, GTX_PATCH_TWO_SIDED)};
    for (int a = 0; a < 2; ++a) {
        subject shown = subject_open(s, assets[a]);
        gtx_instance three[3];
        place(&shown, three);
        for (int i = 0; i < 16; ++i) {
            gtx_camera camera = camera_around(shown.asset);
            camera.reversed_z = i & 1;
            camera.zero_to_one = camera.reversed_z;
            camera.orthographic = i >> 1 & 1;
            camera.distance = i & 4 ? 1.2f : 4;
            gtx_view view = view_of(&camera);
            view.level = i & 8 ? 3 : 1;
            view.method = GTX_METHOD_CAST;
            stage_draw(s, &view, three, 3);
            keep(s);
            draw_by_tiles(s, &view, three, 3, true);
            const int count = differences(s);
            if (count > 40)
                fail_msg("asset %d, view %d: %d pixels differ", a, i, count);
        }
        subject_close(s, &shown);
    }
}

/* In a part of the framebuffer whose sides are not whole tiles. */
static void viewports_of_any_place(void **state)
{
    STAGE_OR_SKIP(state);
    enum { LEFT = 21, BOTTOM = 13, WIDTH = 131, HEIGHT = 77 };
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    gtx_error error = {0};
    gtx_camera_matrices(&camera, (float)WIDTH / HEIGHT, view.view, view.projection);
    view.level = 1;
    for (int tiles = 0; tiles < 2; ++tiles) {
        keep(s);
        view.viewport_width = tiles ? WIDTH : 0;
        view.viewport_height = HEIGHT;
        stage_clear(s, &view);
        s->gl.Viewport(LEFT, BOTTOM, WIDTH, HEIGHT);
        const uint64_t before = s->renderer->planner.tiles.draws;
        must(gtx_draw(s->renderer, &view, &shown.instance, 1, &error), &error);
        assert_int_equal(s->renderer->planner.tiles.draws > before, tiles && !s->renderer->gl.es);
        gtx_framebuffer_read_color(&s->gl, &s->framebuffer, s->color);
        gtx_framebuffer_read_depth(&s->gl, &s->framebuffer, s->depth);
    }
    long covered = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        const int x = i % STAGE_WIDTH - LEFT, y = STAGE_HEIGHT - 1 - i / STAGE_WIDTH - BOTTOM;
        covered += s->depth[i] < 1;
        if (x < 0 || y < 0 || x >= WIDTH || y >= HEIGHT)
            assert_true(s->depth[i] == 1);
    }
    if (covered < 900 || differences(s) > 10)
        fail_msg("%ld pixels covered, %d differ", covered, differences(s));
    subject_close(s, &shown);
}

/* Across each border of the picture and every corner, and nowhere in it: the tiles that have lists
 * are a rectangle of its own each time. */
static void across_the_borders(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    camera.azimuth = camera.elevation = 0;
    gtx_view view = view_of(&camera);
    view.level = 1;
    const float aside[4] = {-1.5f, 0, 1.5f, 40}; /* radii */
    for (int i = 0; i < 16; ++i) {
        gtx_instance moved = shown.instance;
        gtx_matrix_place(aside[i & 3] * camera.radius, aside[i >> 2] * camera.radius, 0, 0, 1,
                         moved.transform);
        view.viewport_width = 0;
        stage_draw(s, &view, &moved, 1);
        keep(s);
        const int outside = (i & 3) == 3 || i >> 2 == 3, whole = (i & 3) == 1 && i >> 2 == 1;
        draw_by_tiles(s, &view, &moved, 1, !outside);
        int covered = 0, at_border = 0;
        for (int k = 0; k < STAGE_PIXELS; ++k) {
            const int x = k % STAGE_WIDTH, y = k / STAGE_WIDTH;
            covered += s->depth[k] < 1;
            at_border += s->depth[k] < 1 && (x == 0 || y == 0 || x == STAGE_WIDTH - 1 ||
                                             y == STAGE_HEIGHT - 1);
        }
        if (differences(s) > 40 || (covered > 0) == outside ||
            (at_border > 0) == (outside || whole))
            fail_msg("place %d: %d pixels covered, %d at a border, %d differ", i, covered,
                     at_border, differences(s));
    }
    subject_close(s, &shown);
}

/* With glClipControl, where the context has it. */
static void pictures_that_stand_on_their_heads(void **state)
{
    STAGE_OR_SKIP(state);
    const PFNGLCLIPCONTROLPROC clip_control =
        (PFNGLCLIPCONTROLPROC)gtx_offscreen_load("glClipControl", NULL);
    if (!clip_control)
        skip();
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    view.level = 1;
    view.method = GTX_METHOD_CAST;
    clip_control(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    stage_draw(s, &view, &shown.instance, 1);
    keep(s);
    draw_by_tiles(s, &view, &shown.instance, 1, true);
    clip_control(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    const int turned = differences(s);
    keep(s);
    stage_draw(s, &view, &shown.instance, 1);
    if (turned > 10 || differences(s) < 100)
        fail_msg("%d pixels differ, %d from the upright picture", turned, differences(s));
    subject_close(s, &shown);
}

static void what_was_drawn_before_stays_in_front(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    gtx_error error = {0};
    view.level = 1;
    draw_by_tiles(s, &view, &shown.instance, 1, true);
    const float middle = s->depth[STAGE_PIXELS / 2 + STAGE_WIDTH / 2];
    for (int i = 0; i < 2; ++i) {
        stage_clear(s, &view);
        s->gl.ClearDepthf(middle + (i ? 1e-3f : -1e-3f)); /* a wall just behind, or before */
        s->gl.Clear(GL_DEPTH_BUFFER_BIT);
        must(gtx_draw(s->renderer, &view, &shown.instance, 1, &error), &error);
        gtx_framebuffer_read_color(&s->gl, &s->framebuffer, s->color);
        assert_int_equal(s->color[4 * (STAGE_PIXELS / 2 + STAGE_WIDTH / 2) + 3] > 0, i);
    }
    subject_close(s, &shown);
}

static void passes_have_one_depth(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    view.level = 1;
    draw_by_tiles(s, &view, &shown.instance, 1, true);
    keep(s);
    view.pass = GTX_PASS_DEPTH;
    draw_by_tiles(s, &view, &shown.instance, 1, true);
    assert_memory_equal(s->depth, other_depth, sizeof other_depth);
    view.pass = GTX_PASS_GBUFFER;
    draw_by_tiles(s, &view, &shown.instance, 1, true);
    assert_memory_equal(s->depth, other_depth, sizeof other_depth);
    subject_close(s, &shown);
}

/* A renderer that may not, and viewports that are none, cast in fragments; so do those without
 * memory for tiles. */
static void others_cast_in_fragments(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_renderer *own = s->renderer;
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    view.level = 1;
    const uint64_t before = own->planner.tiles.draws;
    stage_draw(s, &view, &shown.instance, 1);
    keep(s);
    by_tiles(&view);
    view.viewport_width = UINT32_MAX;
    stage_draw(s, &view, &shown.instance, 1);
    assert_int_equal(s->renderer->planner.tiles.draws, before);
    assert_memory_equal(s->color, other_color, sizeof other_color);
    by_tiles(&view);
    for (long n = 0; n < 8; ++n) {
        counter c = {1000, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        s->renderer = renderer_with(n ? GTX_TILES_ALWAYS : GTX_TILES_NEVER, &hooks);
        subject again = subject_open(s, fixture_sphere(2, 64, 8));
        stage_clear(s, &view);
        c.until_failure = n ? 6 + n : 1000; /* those of instances and of the plan come first */
        if (gtx_draw(s->renderer, &view, &again.instance, 1, NULL) == GTX_OK) {
            gtx_framebuffer_read_color(&s->gl, &s->framebuffer, s->color);
            gtx_framebuffer_read_depth(&s->gl, &s->framebuffer, s->depth);
            assert_true(differences(s) < 40);
            if (!n)
                assert_int_equal(s->renderer->planner.tiles.draws, 0);
        }
        subject_close(s, &again);
        gtx_renderer_destroy(s->renderer);
        assert_int_equal(c.bytes, 0);
    }
    s->renderer = own;
    subject_close(s, &shown);
}

static void unknown_tilings_are_refused(void **state)
{
    STAGE_OR_SKIP(state);
    (void)s;
    gtx_renderer *renderer;
    const gtx_renderer_desc desc = {.load = gtx_offscreen_load, .tiles = (gtx_tiling)3};
    assert_int_equal(gtx_renderer_create(&desc, &renderer, NULL), GTX_ERROR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_picture),
        cmocka_unit_test(viewports_of_any_place),
        cmocka_unit_test(across_the_borders),
        cmocka_unit_test(pictures_that_stand_on_their_heads),
        cmocka_unit_test(what_was_drawn_before_stays_in_front),
        cmocka_unit_test(passes_have_one_depth),
        cmocka_unit_test(others_cast_in_fragments),
        cmocka_unit_test(unknown_tilings_are_refused),
    };
    return cmocka_run_group_tests(tests, open_with_tiles, stage_close);
}
