/* What engines draw into: linear light, which encoded is what is written in sRGB and has no bound
 * above; and several samples a pixel. */
#include "host/target.h"
#include "lods.h"
#include "look.h"

static float linear[4 * STAGE_PIXELS];

/* Into floats, rows from the top. */
static void draw_linear(stage *s, gtx_view view, const gtx_instance *instance)
{
    const GLenum formats[2] = {GL_RGBA16F, 0};
    gtx_error error = {0};
    gtx_target target;
    must(gtx_target_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT, formats, &target, &error), &error);
    gtx_target_begin(&s->gl, &target);
    s->gl.ClearBufferfv(GL_COLOR, 0, (const GLfloat[4]){0});
    view.flags |= GTX_VIEW_LINEAR;
    must(gtx_draw(s->renderer, &view, instance, 1, &error), &error);
    s->gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
    for (int y = 0; y < STAGE_HEIGHT; ++y)
        s->gl.ReadPixels(0, STAGE_HEIGHT - 1 - y, STAGE_WIDTH, 1, GL_RGBA, GL_FLOAT,
                         linear + 4 * STAGE_WIDTH * y);
    gtx_target_destroy(&s->gl, &target);
}

static double encoded(double c)
{
    c = c < 1 ? c : 1;
    return 255 * (c < 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055);
}

/* By every method, by tiles and in fragments. */
static void check(stage *s, gtx_asset *asset)
{
    subject shown = subject_open(s, asset);
    gtx_camera camera = camera_around(asset);
    shown.instance.tint[0] = 0.9f;
    shown.instance.tint[1] = 0.4f;
    shown.instance.tint[2] = 0.02f;
    shown.instance.tint[3] = 1;
    for (int i = 0; i < 2 * (GTX_METHOD_GRID + 1); ++i) {
        int far = 0, covered = 0;
        gtx_view view = view_of(&camera);
        view.method = (gtx_method)(i / 2);
        by_tiles(&view);
        view.viewport_width = i & 1 ? STAGE_WIDTH : 0;
        stage_draw(s, &view, &shown.instance, 1);
        draw_linear(s, view, &shown.instance);
        for (int p = 0; p < STAGE_PIXELS; ++p)
            for (int c = 0; c < 3; ++c) {
                covered += s->color[4 * p + c] > 0;
                far += fabs(encoded((double)linear[4 * p + c]) - s->color[4 * p + c]) > 1.5;
            }
        assert_true(covered > 10000);
        /* Displaced grids are lit at corners: between them sRGB is not linear. */
        if (far > (view.method == GTX_METHOD_GRID ? covered / 100 : covered / 2000))
            fail_msg("method %d: %d of %d are apart", i / 2, far, covered);
    }
    subject_close(s, &shown);
}

static void light_is_linear(void **state)
{
    STAGE_OR_SKIP(state);
    check(s, with_lod(fixture_sphere(2, 64, 8), 2, 3, 0));
    check(s, with_lod_as(fixture_sphere(2, 64, 8), 2, 3, 0, LOD_PLAIN));
    check(s, with_lod_as(fixture_sphere(2, 64, 8), 2, 3, 0, LOD_SHINY));
}

/* A highlight is brighter than white. */
static void light_has_no_bound(void **state)
{
    STAGE_OR_SKIP(state);
    const look smooth = {{220, 220, 220, 255}, {255, 60, 0, 255}, {0, 0, 0}};
    subject shown = subject_open(s, repaint(fixture_sphere(2, 64, 8), &smooth));
    const gtx_camera camera = camera_around(shown.asset);
    float most = 0;
    draw_linear(s, view_of(&camera), &shown.instance);
    for (int p = 0; p < STAGE_PIXELS; ++p)
        most = linear[4 * p] > most ? linear[4 * p] : most;
    assert_true(most > 2);
    subject_close(s, &shown);
}

/* Pixels that the outline cuts, of four samples. */
static int cut_pixels(stage *s, gtx_view view, const gtx_instance *instance)
{
    const PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC storage =
        (PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC)gtx_offscreen_load(
            "glRenderbufferStorageMultisample", NULL);
    static const GLenum formats[2] = {GL_RGBA8, GL_DEPTH_COMPONENT32F};
    static const GLenum places[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    GLuint framebuffer, buffers[2];
    gtx_error error = {0};
    int cut = 0;
    s->gl.GenFramebuffers(1, &framebuffer);
    s->gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    s->gl.GenRenderbuffers(2, buffers);
    for (int i = 0; i < 2; ++i) {
        s->gl.BindRenderbuffer(GL_RENDERBUFFER, buffers[i]);
        storage(GL_RENDERBUFFER, 4, formats[i], STAGE_WIDTH, STAGE_HEIGHT);
        s->gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, buffers[i]);
    }
    s->gl.Viewport(0, 0, STAGE_WIDTH, STAGE_HEIGHT);
    s->gl.DepthMask(GL_TRUE);
    s->gl.ClearDepthf(1);
    s->gl.ClearColor(0, 0, 0, 0);
    s->gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    must(gtx_draw(s->renderer, &view, instance, 1, &error), &error);
    assert_false(s->gl.IsEnabled(0x8C36)); /* GL_SAMPLE_SHADING */
    s->gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, s->framebuffer.object);
    s->gl.BlitFramebuffer(0, 0, STAGE_WIDTH, STAGE_HEIGHT, 0, 0, STAGE_WIDTH, STAGE_HEIGHT,
                          GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gtx_framebuffer_read_color(&s->gl, &s->framebuffer, s->color);
    for (int p = 0; p < STAGE_PIXELS; ++p)
        cut += s->color[4 * p + 3] > 0 && s->color[4 * p + 3] < 255;
    s->gl.DeleteRenderbuffers(2, buffers);
    s->gl.DeleteFramebuffers(1, &framebuffer);
    return cut;
}

static void casts_are_smooth_by_samples(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, with_lod(fixture_sphere(2, 64, 8), 2, 3, 0));
    const gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    by_tiles(&view);
    view.method = GTX_METHOD_LOD;
    const int of_polygons = cut_pixels(s, view, &shown.instance);
    assert_true(of_polygons > 100);
    view.method = GTX_METHOD_CAST;
    assert_int_equal(cut_pixels(s, view, &shown.instance), 0);
    view.flags |= GTX_VIEW_BY_SAMPLES;
    assert_in_range(cut_pixels(s, view, &shown.instance), of_polygons * 3 / 4,
                    of_polygons * 5 / 4);
    view.flags |= GTX_VIEW_RESTORE_STATE;
    assert_true(cut_pixels(s, view, &shown.instance) > 100);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(light_is_linear),
                                       cmocka_unit_test(light_has_no_bound),
                                       cmocka_unit_test(casts_are_smooth_by_samples)};
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
