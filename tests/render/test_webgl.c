/* WebGL 2's own rules, held against what the renderer asks of OpenGL: a buffer that has been bound
 * for indices is bound for nothing else, and several draws in one call have another name. */
#include "lods.h"
#include "stage.h"

#include <stdbool.h>

enum { MAX_NAMES = 4096 };
static struct {
    GLenum target[MAX_NAMES]; /* what each buffer was bound to first */
    int broken, multi_draws;
    bool web;                  /* the context says that it is WebGL */
} spy;

#define REAL(type, name) ((type)gtx_offscreen_load(name, NULL))

static void APIENTRY bind_buffer(GLenum target, GLuint name)
{
    if (name && name < MAX_NAMES) {
        GLenum *first = &spy.target[name];
        spy.broken += *first && (*first == GL_ELEMENT_ARRAY_BUFFER) !=
                                    (target == GL_ELEMENT_ARRAY_BUFFER);
        *first = *first ? *first : target;
    }
    REAL(PFNGLBINDBUFFERPROC, "glBindBuffer")(target, name);
}

static void APIENTRY delete_buffers(GLsizei count, const GLuint *names)
{
    for (GLsizei i = 0; i < count; ++i)
        if (names[i] < MAX_NAMES)
            spy.target[names[i]] = 0;
    REAL(PFNGLDELETEBUFFERSPROC, "glDeleteBuffers")(count, names);
}

static const GLubyte *APIENTRY get_string(GLenum name)
{
    if (spy.web && name == GL_VERSION)
        return (const GLubyte *)"OpenGL ES 3.0 (WebGL 2.0 (OpenGL ES 3.0 Chromium))";
    return REAL(PFNGLGETSTRINGPROC, "glGetString")(name);
}

static const GLubyte *APIENTRY get_string_of(GLenum name, GLuint index)
{
    (void)name;
    return (const GLubyte *)(index == 0 ? "GL_WEBGL_multi_draw" : "GL_OES_texture_float_linear");
}

static void APIENTRY get_integer(GLenum name, GLint *value)
{
    REAL(PFNGLGETINTEGERVPROC, "glGetIntegerv")(name, value);
    if (spy.web && (name == GL_NUM_EXTENSIONS || name == GL_MAJOR_VERSION ||
                    name == GL_MINOR_VERSION))
        *value = name == GL_NUM_EXTENSIONS ? 2 : name == GL_MAJOR_VERSION ? 3 : 0;
}

static void APIENTRY multi_draw(GLenum mode, const GLsizei *counts, GLenum type,
                                const void *const *offsets, GLsizei draws)
{
    ++spy.multi_draws;
    REAL(PFNGLMULTIDRAWELEMENTSPROC, "glMultiDrawElements")(mode, counts, type, offsets, draws);
}

static gtx_gl_proc load_spy(const char *name, void *user)
{
    static const struct {
        const char *name;
        gtx_gl_proc proc;
    } ours[] = {{"glBindBuffer", (gtx_gl_proc)bind_buffer},
                {"glDeleteBuffers", (gtx_gl_proc)delete_buffers},
                {"glGetString", (gtx_gl_proc)get_string},
                {"glGetStringi", (gtx_gl_proc)get_string_of},
                {"glGetIntegerv", (gtx_gl_proc)get_integer},
                {"glMultiDrawElementsWEBGL", (gtx_gl_proc)multi_draw}};
    for (size_t i = 0; i < sizeof ours / sizeof *ours; ++i)
        if (!strcmp(name, ours[i].name) && (spy.web || i < 2))
            return ours[i].proc;
    return gtx_offscreen_load(name, user);
}

static gtx_renderer *spied_renderer(bool web)
{
    const gtx_renderer_desc desc = {.load = load_spy};
    gtx_renderer *renderer = NULL;
    gtx_error error = {0};
    memset(&spy, 0, sizeof spy);
    spy.web = web;
    must(gtx_renderer_create(&desc, &renderer, &error), &error);
    return renderer;
}

static void draw_every_way(stage *s, gtx_renderer *renderer, const gtx_asset *asset,
                           const gtx_model *model)
{
    gtx_camera camera = camera_around(asset);
    gtx_instance instance = {.model = model};
    gtx_error error = {0};
    memcpy(instance.transform, identity, sizeof identity);
    for (int method = 0; method <= GTX_METHOD_GRID; ++method) {
        gtx_view view = view_of(&camera);
        view.method = (gtx_method)method;
        by_tiles(&view);
        stage_clear(s, &view);
        must(gtx_draw(renderer, &view, &instance, 1, &error), &error);
        assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
    }
}

/* Also the host's own: its vertex array stays bound, with the indices it had. */
static void index_buffers_hold_indices_alone(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_renderer *renderer = spied_renderer(false);
    gtx_asset *asset = with_lod(fixture_sphere(2, 48, 8), 1, 2, 0);
    gtx_model *model = NULL;
    gtx_error error = {0};
    GLuint array = 0, indices = 0;
    GLint bound = 0;
    s->gl.GenVertexArrays(1, &array);
    s->gl.BindVertexArray(array);
    s->gl.GenBuffers(1, &indices);
    s->gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices);
    must(gtx_model_create(renderer, asset, &model, &error), &error);
    must(gtx_model_update(renderer, model, asset, 1, &error), &error);
    REAL(PFNGLGETINTEGERVPROC, "glGetIntegerv")(GL_VERTEX_ARRAY_BINDING, &bound);
    assert_int_equal(bound, array);
    REAL(PFNGLGETINTEGERVPROC, "glGetIntegerv")(GL_ELEMENT_ARRAY_BUFFER_BINDING, &bound);
    assert_int_equal(bound, indices);
    draw_every_way(s, renderer, asset, model);
    assert_int_equal(spy.broken, 0);
    gtx_model_destroy(renderer, model);
    gtx_close(asset);
    s->gl.DeleteVertexArrays(1, &array);
    s->gl.DeleteBuffers(1, &indices);
    gtx_renderer_destroy(renderer);
}

static void several_draws_are_one_call(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_renderer *renderer = spied_renderer(true);
    gtx_asset *asset = with_lod(fixture_sphere(2, 48, 8), 1, 2, 0);
    gtx_model *model = NULL;
    gtx_error error = {0};
    must(gtx_model_create(renderer, asset, &model, &error), &error);
    draw_every_way(s, renderer, asset, model);
    assert_true(spy.multi_draws > 0);
    assert_int_equal(spy.broken, 0);
    gtx_model_destroy(renderer, model);
    gtx_close(asset);
    gtx_renderer_destroy(renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(index_buffers_hold_indices_alone),
        cmocka_unit_test(several_draws_are_one_call),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
