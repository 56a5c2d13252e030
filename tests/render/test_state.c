/* The OpenGL state that a draw and an upload leave, against what render.h promises. */
#include "render/renderer.h"
#include "stage.h"

/* Functions beyond the host's table. */
static PFNGLACTIVETEXTUREPROC active_texture;
static PFNGLBINDTEXTUREPROC bind_texture;
static PFNGLGENTEXTURESPROC gen_textures;
static PFNGLBINDSAMPLERPROC bind_sampler;
static PFNGLGENSAMPLERSPROC gen_samplers;
static PFNGLGETBOOLEANI_VPROC get_boolean_at;
static PFNGLISENABLEDIPROC is_enabled_at;
static PFNGLENABLEIPROC enable_at;
static PFNGLCOLORMASKIPROC color_mask_at;
static PFNGLSCISSORPROC scissor;
static PFNGLSTENCILFUNCPROC stencil_func;

static int open_all(void **state)
{
    const int result = stage_open(state);
    active_texture = (PFNGLACTIVETEXTUREPROC)gtx_offscreen_load("glActiveTexture", NULL);
    bind_texture = (PFNGLBINDTEXTUREPROC)gtx_offscreen_load("glBindTexture", NULL);
    gen_textures = (PFNGLGENTEXTURESPROC)gtx_offscreen_load("glGenTextures", NULL);
    bind_sampler = (PFNGLBINDSAMPLERPROC)gtx_offscreen_load("glBindSampler", NULL);
    gen_samplers = (PFNGLGENSAMPLERSPROC)gtx_offscreen_load("glGenSamplers", NULL);
    get_boolean_at = (PFNGLGETBOOLEANI_VPROC)gtx_offscreen_load("glGetBooleani_v", NULL);
    is_enabled_at = (PFNGLISENABLEDIPROC)gtx_offscreen_load("glIsEnabledi", NULL);
    enable_at = (PFNGLENABLEIPROC)gtx_offscreen_load("glEnablei", NULL);
    color_mask_at = (PFNGLCOLORMASKIPROC)gtx_offscreen_load("glColorMaski", NULL);
    scissor = (PFNGLSCISSORPROC)gtx_offscreen_load("glScissor", NULL);
    stencil_func = (PFNGLSTENCILFUNCPROC)gtx_offscreen_load("glStencilFunc", NULL);
    return result;
}

/* Single values; more follow for texture units and draw buffers. */
static const GLenum singles[] = {
    GL_CURRENT_PROGRAM, GL_VERTEX_ARRAY_BINDING, GL_ARRAY_BUFFER_BINDING, GL_ACTIVE_TEXTURE,
    GL_DEPTH_FUNC, GL_CULL_FACE_MODE, GL_FRONT_FACE, GL_DEPTH_TEST, GL_DEPTH_WRITEMASK,
    GL_CULL_FACE, GL_ELEMENT_ARRAY_BUFFER_BINDING,
    /* what a draw may not touch at all */
    GL_DRAW_FRAMEBUFFER_BINDING, GL_READ_FRAMEBUFFER_BINDING, GL_SCISSOR_TEST, GL_STENCIL_TEST,
    GL_STENCIL_FUNC, GL_STENCIL_REF, GL_POLYGON_OFFSET_FILL, GL_MULTISAMPLE, GL_DEPTH_CLAMP,
    GL_UNIFORM_BUFFER_BINDING, GL_PRIMITIVE_RESTART, GL_FRAMEBUFFER_SRGB, GL_RASTERIZER_DISCARD,
    GL_UNPACK_ALIGNMENT, GL_PIXEL_UNPACK_BUFFER_BINDING};
enum {
    TOUCHED = 11, SINGLES = sizeof singles / sizeof *singles, UNITS = 9, BUFFERS = 8, STREAMS = 2,
    VALUES = SINGLES + 3 * UNITS + 5 * BUFFERS + STREAMS + 8
};

typedef struct snapshot {
    GLint value[VALUES];
} snapshot;

static snapshot take(stage *s)
{
    snapshot out = {{0}};
    GLint unit;
    int n = 0;
    for (int i = 0; i < SINGLES; ++i)
        s->gl.GetIntegerv(singles[i], &out.value[n++]);
    s->gl.GetIntegerv(GL_ACTIVE_TEXTURE, &unit);
    for (int i = 0; i < UNITS; ++i) {
        active_texture(GL_TEXTURE0 + (GLenum)i);
        s->gl.GetIntegerv(GL_TEXTURE_BINDING_2D, &out.value[n++]);
        s->gl.GetIntegerv(GL_TEXTURE_BINDING_2D_ARRAY, &out.value[n++]);
        s->gl.GetIntegerv(GL_SAMPLER_BINDING, &out.value[n++]);
    }
    active_texture((GLenum)unit);
    for (GLuint i = 0; i < BUFFERS; ++i) {
        GLboolean mask[4];
        get_boolean_at(GL_COLOR_WRITEMASK, i, mask);
        out.value[n++] = is_enabled_at(GL_BLEND, i);
        for (int k = 0; k < 4; ++k)
            out.value[n++] = mask[k];
    }
    for (int i = 0; !getenv("GEOTEX_ES") && i < STREAMS; ++i) { /* buffers of units 15, 16 */
        active_texture(GL_TEXTURE15 + (GLenum)i);
        s->gl.GetIntegerv(GL_TEXTURE_BINDING_BUFFER, &out.value[n + i]);
    }
    active_texture((GLenum)unit);
    n += STREAMS;
    s->gl.GetIntegerv(GL_VIEWPORT, &out.value[n]);
    s->gl.GetIntegerv(GL_SCISSOR_BOX, &out.value[n + 4]);
    return out;
}

/* A state unlike the default in everything that a draw touches. */
static void disturb(stage *s)
{
    GLuint name;
    s->gl.DepthFunc(GL_GEQUAL);
    s->gl.CullFace(GL_FRONT);
    s->gl.FrontFace(GL_CW);
    s->gl.Disable(GL_DEPTH_TEST);
    s->gl.DepthMask(GL_FALSE);
    s->gl.Enable(GL_CULL_FACE);
    scissor(3, 4, 500, 600);
    stencil_func(GL_LESS, 7, 1);
    for (int i = 0; i < UNITS; ++i) {
        active_texture(GL_TEXTURE0 + (GLenum)i);
        gen_textures(1, &name);
        bind_texture(GL_TEXTURE_2D, name);
        gen_textures(1, &name);
        bind_texture(GL_TEXTURE_2D_ARRAY, name);
        gen_samplers(1, &name);
        bind_sampler((GLuint)i, name);
    }
    for (int i = 0; !getenv("GEOTEX_ES") && i < STREAMS; ++i) {
        active_texture(GL_TEXTURE15 + (GLenum)i);
        gen_textures(1, &name);
        bind_texture(GL_TEXTURE_BUFFER, name);
    }
    enable_at(GL_BLEND, 1);
    enable_at(GL_BLEND, 3);
    color_mask_at(0, GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    color_mask_at(2, GL_TRUE, GL_FALSE, GL_FALSE, GL_FALSE);
    s->gl.GenVertexArrays(1, &name);
    s->gl.BindVertexArray(name);
    s->gl.GenBuffers(1, &name);
    s->gl.BindBuffer(GL_ARRAY_BUFFER, name);
    s->gl.GenBuffers(1, &name);
    s->gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, name);
    gtx_polygon_program program;
    gtx_error error;
    must(gtx_polygon_program_create(&s->gl, &program, &error), &error);
    s->gl.UseProgram(program.program);
}

static void restored_when_asked(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    subject shown = subject_open(s, fixture_sphere(2, 48, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    view.flags |= GTX_VIEW_RESTORE_STATE;
    for (int tiles = 0; tiles < 2; ++tiles) {
        if (tiles)
            by_tiles(&view);
        disturb(s);
        const snapshot before = take(s);
        must(gtx_draw(s->renderer, &view, &shown.instance, 1, &error), &error);
        const snapshot after = take(s);
        for (int i = 0; i < VALUES; ++i)
            if (before.value[i] != after.value[i])
                fail_msg("value %d was %d and is %d", i, before.value[i], after.value[i]);
    }
    subject_close(s, &shown);
}

static void fixed_otherwise(void **state)
{
    STAGE_OR_SKIP(state);
    static const GLint promised[TOUCHED] = {0, 0, 0, GL_TEXTURE0, GL_LESS, GL_BACK,
                                            GL_CCW, 1, 1, 0, 0};
    gtx_error error = {0};
    subject shown = subject_open(s, fixture_sphere(2, 48, 8));
    gtx_camera camera = camera_around(shown.asset);
    for (int reversed = 0; reversed < 2; ++reversed) {
        camera.reversed_z = reversed;
        gtx_view view = view_of(&camera);
        by_tiles(&view);
        disturb(s);
        const snapshot before = take(s);
        must(gtx_draw(s->renderer, &view, &shown.instance, 1, &error), &error);
        const snapshot after = take(s);
        for (int i = 0; i < TOUCHED; ++i) {
            const int turned = singles[i] == GL_DEPTH_FUNC && reversed;
            const GLint expected = turned ? GL_GREATER : promised[i];
            if (after.value[i] != expected)
                fail_msg("0x%x is %d, not %d", singles[i], after.value[i], expected);
        }
        for (int i = TOUCHED; i < SINGLES; ++i)
            assert_int_equal(after.value[i], before.value[i]);
        for (int i = 0; i < 3 * UNITS; ++i) /* units 0..7 are cleared, the others the host's */
            assert_int_equal(after.value[SINGLES + i], i < 24 ? 0 : before.value[SINGLES + i]);
        for (int i = 0; i < 5 * BUFFERS; ++i)
            assert_int_equal(after.value[SINGLES + 3 * UNITS + i], i % 5 != 0);
        const int last_unit = VALUES - 8 - 1; /* that of lists of tiles */
        const bool tiles = s->renderer->planner.tiles.draws > 0;
        assert_int_equal(after.value[last_unit - 1], before.value[last_unit - 1]);
        assert_int_equal(after.value[last_unit], tiles ? 0 : before.value[last_unit]);
        for (int i = VALUES - 8; i < VALUES; ++i)
            assert_int_equal(after.value[i], before.value[i]);
    }
    subject_close(s, &shown);
}

/* A draw into a disturbed state is the same picture. */
static void independent_of_the_hosts_state(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    subject shown = subject_open(s, fixture_sphere(2, 48, 8));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    by_tiles(&view);
    stage_draw(s, &view, &shown.instance, 1);
    uint8_t *plain = malloc(sizeof s->color);
    memcpy(plain, s->color, sizeof s->color);
    stage_clear(s, &view);
    disturb(s);
    must(gtx_draw(s->renderer, &view, &shown.instance, 1, &error), &error);
    gtx_framebuffer_read_color(&s->gl, &s->framebuffer, s->color);
    assert_memory_equal(plain, s->color, sizeof s->color);
    free(plain);
    subject_close(s, &shown);
}

static void uploads_leave_vertex_arrays_alone(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_model *model;
    disturb(s);
    s->gl.PixelStorei(GL_UNPACK_ALIGNMENT, 8);
    s->gl.PixelStorei(GL_UNPACK_ROW_LENGTH, 77);
    GLint array, elements, now;
    s->gl.GetIntegerv(GL_VERTEX_ARRAY_BINDING, &array);
    s->gl.GetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &elements);
    must(gtx_model_create(s->renderer, asset, &model, &error), &error);
    s->gl.GetIntegerv(GL_VERTEX_ARRAY_BINDING, &now);
    assert_int_equal(now, array);
    s->gl.GetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &now);
    assert_int_equal(now, elements);
    s->gl.GetIntegerv(GL_UNPACK_ALIGNMENT, &now);
    assert_int_equal(now, 4);
    s->gl.GetIntegerv(GL_UNPACK_ROW_LENGTH, &now);
    assert_int_equal(now, 0);
    s->gl.GetIntegerv(GL_ARRAY_BUFFER_BINDING, &now);
    assert_int_equal(now, 0);
    gtx_model_destroy(s->renderer, model);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(restored_when_asked),
        cmocka_unit_test(fixed_otherwise),
        cmocka_unit_test(independent_of_the_hosts_state),
        cmocka_unit_test(uploads_leave_vertex_arrays_alone),
    };
    return cmocka_run_group_tests(tests, open_all, stage_close);
}
