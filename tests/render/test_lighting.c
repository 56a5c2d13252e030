/* geotex_lighting.frag: the engine's lights, shadow map and fog, and motion, by every method. */
#include "host/target.h"
#include "lods.h"

#include <stdbool.h>

static float shown[2][4 * STAGE_PIXELS]; /* colour, motion; rows from the top */

typedef struct scene {
    gtx_shading *shading;
    GLuint block, shadow_map, before;
} scene;

#define LOADED(type, name) const type name = (type)gtx_offscreen_load("gl" #name, NULL)

static void prepare_program(stage *s, const scene *c, GLuint program)
{
    LOADED(PFNGLGETUNIFORMBLOCKINDEXPROC, GetUniformBlockIndex);
    LOADED(PFNGLUNIFORMBLOCKBINDINGPROC, UniformBlockBinding);
    LOADED(PFNGLBINDBUFFERBASEPROC, BindBufferBase);
    UniformBlockBinding(program, GetUniformBlockIndex(program, "gtx_lighting"), 1);
    BindBufferBase(GL_UNIFORM_BUFFER, 1, c->block);
    s->gl.UseProgram(program);
    s->gl.Uniform1i(s->gl.GetUniformLocation(program, "gtx_shadow_map"), 8);
    s->gl.Uniform1i(s->gl.GetUniformLocation(program, "gtx_before"), 9);
    s->gl.UseProgram(0);
}

/* A map of 2 x 1: in shadow where x is below one half. */
static GLuint make_shadow_map(stage *s)
{
    static const float depths[2] = {0, 1};
    GLuint map;
    s->gl.GenTextures(1, &map);
    s->gl.BindTexture(GL_TEXTURE_2D, map);
    s->gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, 2, 1, 0, GL_DEPTH_COMPONENT,
                     GL_FLOAT, depths);
    s->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    s->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    s->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    s->gl.BindTexture(GL_TEXTURE_2D, 0);
    return map;
}

static scene open_scene(stage *s)
{
    gtx_error error = {0};
    scene c = {0};
    must(gtx_shading_create(s->renderer, gtx_shader_source("geotex_lighting.frag"), &c.shading,
                            &error), &error);
    s->gl.GenBuffers(1, &c.block);
    c.shadow_map = make_shadow_map(s);
    s->gl.GenTextures(1, &c.before);
    uint32_t programs[GTX_SHADING_PROGRAMS];
    const uint32_t count = gtx_shading_programs(c.shading, programs);
    for (uint32_t i = 0; i < count; ++i)
        prepare_program(s, &c, programs[i]);
    return c;
}

static void close_scene(stage *s, scene *c)
{
    gtx_shading_destroy(s->renderer, c->shading);
    s->gl.DeleteTextures(1, &c->shadow_map);
    s->gl.DeleteTextures(1, &c->before);
    s->gl.DeleteBuffers(1, &c->block);
}

static void draw_scene(stage *s, const scene *c, const gtx_lighting *block, gtx_view view,
                       const gtx_instance *instance)
{
    const GLenum formats[3] = {GL_RGBA16F, block ? GL_RGBA16F : 0, 0};
    gtx_error error = {0};
    gtx_target target;
    must(gtx_target_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT, formats, &target, &error), &error);
    gtx_target_begin(&s->gl, &target);
    for (int k = 0; k < 2; ++k)
        s->gl.ClearBufferfv(GL_COLOR, k, (const GLfloat[4]){0});
    if (block) {
        s->gl.BindBuffer(GL_UNIFORM_BUFFER, c->block);
        s->gl.BufferData(GL_UNIFORM_BUFFER, sizeof *block, block, GL_STREAM_DRAW);
        s->gl.ActiveTexture(GL_TEXTURE8);
        s->gl.BindTexture(GL_TEXTURE_2D, c->shadow_map);
        s->gl.ActiveTexture(GL_TEXTURE9);
        s->gl.BindTexture(GL_TEXTURE_2D, c->before);
        view.shading = c->shading;
        view.flags |= GTX_VIEW_SHADING_BY_TILES;
    } else {
        view.flags |= GTX_VIEW_LINEAR;
    }
    must(gtx_draw(s->renderer, &view, instance, 1, &error), &error);
    for (int k = 0; k < (block ? 2 : 1); ++k) {
        s->gl.ReadBuffer(GL_COLOR_ATTACHMENT0 + (GLenum)k);
        for (int y = 0; y < STAGE_HEIGHT; ++y)
            s->gl.ReadPixels(0, STAGE_HEIGHT - 1 - y, STAGE_WIDTH, 1, GL_RGBA, GL_FLOAT,
                             shown[k] + 4 * STAGE_WIDTH * y);
    }
    gtx_target_destroy(&s->gl, &target);
}

/* The block of a sun at the camera's light and of light from everywhere. */
static gtx_lighting sun_of(const gtx_view *view)
{
    gtx_lighting b = {.around = {0.2f, 0.2f, 0.2f, 1},
                   .lamps = {{{0, 0, 0, 0}, {0.8f, 0.8f, 0.8f, -1}, {0, 0, 0, 0}}}};
    memcpy(b.lamps[0].place, view->light_direction, sizeof view->light_direction);
    const matrix clip = matrix_mul(matrix_of(view->projection), matrix_of(view->view));
    for (int i = 0; i < 16; ++i)
        b.clip[i] = b.clip_before[i] = (float)clip.m[i];
    return b;
}

static void one_sun_is_the_stock_light(void **state)
{
    STAGE_OR_SKIP(state);
    static float stock[4 * STAGE_PIXELS];
    subject p = subject_open(s, with_lod_as(fixture_sphere(2, 64, 8), 2, 3, 0, LOD_SHINY));
    const gtx_camera camera = camera_around(p.asset);
    scene c = open_scene(s);
    for (int i = 0; i < 2 * (GTX_METHOD_GRID + 1); ++i) {
        gtx_view view = view_of(&camera);
        view.light_direction[0] = 0.6f;
        view.light_direction[1] = 0.8f;
        view.method = (gtx_method)(i / 2);
        by_tiles(&view);
        view.viewport_width = i & 1 ? STAGE_WIDTH : 0;
        if (view.method == GTX_METHOD_PAPER)
            continue;
        const gtx_lighting block = sun_of(&view);
        int far = 0, covered = 0;
        draw_scene(s, &c, NULL, view, &p.instance);
        memcpy(stock, shown[0], sizeof stock);
        draw_scene(s, &c, &block, view, &p.instance);
        for (int k = 0; k < 4 * STAGE_PIXELS; ++k) {
            covered += stock[k] > 0;
            far += fabsf(stock[k] - shown[0][k]) > 0.01f + 0.02f * stock[k];
        }
        assert_true(covered > 10000);
        if (far > covered / 100)
            fail_msg("method %d: %d of %d differ", i / 2, far, covered);
    }
    close_scene(s, &c);
    subject_close(s, &p);
}

/* The point of the world that a pixel shows, by what is drawn without the main: false for none. */
static bool point_of(const stage *s, const matrix *back, int p, double at[3])
{
    if (s->depth[p] == 1)
        return false;
    matrix_point(*back, (double[3]){2 * (p % STAGE_WIDTH + 0.5) / STAGE_WIDTH - 1,
                                    1 - 2 * (p / STAGE_WIDTH + 0.5) / STAGE_HEIGHT,
                                    2 * (double)s->depth[p] - 1}, at);
    return true;
}

/* A sphere under the light of a view, and what shows in it of that light alone, and without. */
typedef struct lit_sphere {
    subject p;
    gtx_camera camera;
    scene c;
    gtx_view view;
    gtx_lighting sun;
    float with_sun[4 * STAGE_PIXELS], without[4 * STAGE_PIXELS];
} lit_sphere;

static void open_lit(stage *s, lit_sphere *l)
{
    l->p = subject_open(s, with_lod_as(fixture_sphere(2, 64, 8), 2, 3, 0, LOD_EVEN));
    l->camera = camera_around(l->p.asset);
    l->c = open_scene(s);
    l->view = view_of(&l->camera);
    l->view.method = GTX_METHOD_CAST;
    by_tiles(&l->view);
    l->view.light_direction[1] = 0.6f;
    l->view.light_direction[2] = 0.8f;
    stage_draw(s, &l->view, &l->p.instance, 1);
    l->sun = sun_of(&l->view);
    l->sun.around[0] = l->sun.around[1] = l->sun.around[2] = 0;
    draw_scene(s, &l->c, &l->sun, l->view, &l->p.instance);
    memcpy(l->with_sun, shown[0], sizeof l->with_sun);
    gtx_lighting dark = l->sun;
    dark.around[3] = 0;
    draw_scene(s, &l->c, &dark, l->view, &l->p.instance);
    memcpy(l->without, shown[0], sizeof l->without);
}

static void close_lit(stage *s, lit_sphere *l)
{
    close_scene(s, &l->c);
    subject_close(s, &l->p);
}

/* A lamp at a place, alone, gives what a sun from there gives, by the square of the distance; two
 * lights give the sum; a spot only within its cone. */
static void lamps_and_spots(void **state)
{
    STAGE_OR_SKIP(state);
    static lit_sphere l;
    static float lamp[4 * STAGE_PIXELS];
    const float far = 100;
    open_lit(s, &l);
    /* So far away that it is a sun, but for the distance. */
    gtx_lighting b = l.sun;
    for (int k = 0; k < 3; ++k) {
        b.lamps[0].place[k] *= far;
        b.lamps[0].color[k] *= far * far;
    }
    b.lamps[0].place[3] = 1000 * far;
    draw_scene(s, &l.c, &b, l.view, &l.p.instance);
    memcpy(lamp, shown[0], sizeof lamp);
    int checked = 0, cut = 0;
    for (int i = 0; i < 4 * STAGE_PIXELS; ++i)
        if (i % 4 < 3 && l.with_sun[i] > 0.05f) {
            assert_true(fabsf(lamp[i] / l.with_sun[i] - 1) < 0.08f);
            ++checked;
        }
    assert_true(checked > 5000);
    b.lamps[1] = b.lamps[0];
    b.around[3] = 2;
    draw_scene(s, &l.c, &b, l.view, &l.p.instance);
    for (int i = 0; i < 4 * STAGE_PIXELS; ++i)
        assert_true(i % 4 == 3 || fabsf(shown[0][i] + l.without[i] - 2 * lamp[i]) <=
                                      0.004f * lamp[i] + 1e-4f);
    /* A spot of which the sphere takes up more than the cone. */
    b.around[3] = 1;
    for (int k = 0; k < 3; ++k)
        b.lamps[0].axis[k] = -b.lamps[0].place[k] / far;
    b.lamps[0].color[3] = cosf(0.006f);
    b.lamps[0].axis[3] = cosf(0.003f);
    draw_scene(s, &l.c, &b, l.view, &l.p.instance);
    checked = 0;
    for (int i = 0; i < 4 * STAGE_PIXELS; i += 4) {
        cut += l.with_sun[i] > 0.05f && shown[0][i] <= l.without[i] + 1e-4f;
        checked += l.with_sun[i] > 0.05f && fabsf(shown[0][i] - lamp[i]) < 1e-3f;
    }
    assert_true(cut > 1000 && checked > 100);
    close_lit(s, &l);
}

/* Rows of the transform that the instance had in the frame before. */
static const float before[12] = {1, 0, 0, 0.1f, 0, 1, 0, -0.05f, 0, 0, 1, 0.2f};

static void bind_before(stage *s, const scene *c)
{
    s->gl.ActiveTexture(GL_TEXTURE9);
    s->gl.BindTexture(GL_TEXTURE_2D, c->before);
    s->gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 3, 1, 0, GL_RGBA, GL_FLOAT, before);
    s->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    s->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

/* Fog hides by distance; the shadow map takes the sun where x is below 0; and a moved instance
 * moves by what its points move. */
static void fog_shadow_and_motion(void **state)
{
    STAGE_OR_SKIP(state);
    static lit_sphere l;
    const float eye_distance = 3.1f;
    open_lit(s, &l);
    const gtx_view *view = &l.view;
    const matrix clip = matrix_mul(matrix_of(view->projection), matrix_of(view->view));
    const matrix back = matrix_inverse(clip);
    const float eye[3] = {view->view[2] * eye_distance, view->view[6] * eye_distance,
                          view->view[10] * eye_distance};
    const float to_map[16] = {0.125f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.5f, 0.5f, 0.5f, 1};
    gtx_lighting b = l.sun;
    b.fog[1] = 0.5f;
    b.fog[3] = 0.3f;
    memcpy(b.eye, eye, sizeof eye);
    memcpy(b.shadow, to_map, sizeof to_map);
    b.options[0] = 1;
    b.options[1] = 0.001f;
    b.options[2] = 1;
    bind_before(s, &l.c);
    draw_scene(s, &l.c, &b, *view, &l.p.instance);
    int checked = 0, dark = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        double at[3], was[3], now[3], then[3], square = 0;
        if (!point_of(s, &back, i, at) || fabs(at[0]) < 0.02)
            continue;
        for (int k = 0; k < 3; ++k) {
            was[k] = at[k] + (double)before[4 * k + 3];
            square += (at[k] - (double)eye[k]) * (at[k] - (double)eye[k]);
        }
        const double fog = 1 - exp(-0.3 * sqrt(square));
        const bool lit = at[0] > 0;
        const double light = (double)(lit ? l.with_sun : l.without)[4 * i + 1];
        assert_true(fabs((double)shown[0][4 * i + 1] - ((1 - fog) * light + fog * 0.5)) < 0.01);
        matrix_point(clip, at, now);
        matrix_point(clip, was, then);
        for (int k = 0; k < 2; ++k)
            assert_true(fabs(0.5 * (now[k] - then[k]) - (double)shown[1][4 * i + k]) < 1e-3);
        dark += !lit;
        ++checked;
    }
    assert_true(checked > 3000 && dark > 300);
    close_lit(s, &l);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_sun_is_the_stock_light),
                                       cmocka_unit_test(lamps_and_spots),
                                       cmocka_unit_test(fog_shadow_and_motion)};
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
