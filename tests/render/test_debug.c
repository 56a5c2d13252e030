/* What a debugger sees: labels on every object, a group around a draw, and no complaint. */
#include "render/renderer.h"
#include "lods.h"
#include "witness.h"

static void a_draw_is_a_silent_group(void **state)
{
    STAGE_OR_SKIP(state);
    if (!has_debug(s))
        skip();
    witness w = {0};
    static const gtx_method methods[] = {GTX_METHOD_CAST, GTX_METHOD_PAPER, GTX_METHOD_LOD};
    witness_call(s, &w);
    subject shown = subject_open(s, with_lod(fixture_sphere(2, 48, 8), 2, 2, 0));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    for (int i = 0; i < 6; ++i) {
        view.method = methods[i % 3];
        view.flags = i / 3 ? GTX_VIEW_RESTORE_STATE : 0;
        stage_draw(s, &view, &shown.instance, 1);
    }
    must(gtx_model_update(s->renderer, shown.model, shown.asset, 0, NULL), &(gtx_error){0});
    subject_close(s, &shown);
    witness_dismiss(s);
    assert_int_equal(w.complaints, 0);
    assert_int_equal(w.groups, 6);
}

/* How many objects of a kind carry a label of ours. */
static int labelled(GLenum kind)
{
    if (!gtx_offscreen_load("glGetObjectLabel", NULL))
        return 0;
    PFNGLGETOBJECTLABELPROC get_label =
        (PFNGLGETOBJECTLABELPROC)gtx_offscreen_load("glGetObjectLabel", NULL);
    PFNGLISTEXTUREPROC is_texture = (PFNGLISTEXTUREPROC)gtx_offscreen_load("glIsTexture", NULL);
    PFNGLISBUFFERPROC is_buffer = (PFNGLISBUFFERPROC)gtx_offscreen_load("glIsBuffer", NULL);
    PFNGLISPROGRAMPROC is_program = (PFNGLISPROGRAMPROC)gtx_offscreen_load("glIsProgram", NULL);
    int count = 0;
    for (GLuint i = 1; i < 200; ++i) {
        char text[64] = "";
        const GLboolean there = kind == GL_TEXTURE  ? is_texture(i)
                                : kind == GL_BUFFER ? is_buffer(i)
                                                    : is_program(i);
        if (there)
            get_label(kind, i, sizeof text, NULL, text);
        count += !strncmp(text, "geotex ", 7);
    }
    return count;
}

static void objects_carry_labels(void **state)
{
    STAGE_OR_SKIP(state);
    if (!has_debug(s))
        skip();
    subject shown = subject_open(s, with_lod(fixture_sphere(2, 48, 8), 2, 2, 0));
    const int tiles = s->renderer->planner.tiles.max_texels > 0;
    const int grids = s->renderer->planner.on_gpu ? 30 : 38; /* of blocks there are fewer */
    assert_int_equal(labelled(GL_PROGRAM), tiles ? grids + 3 : grids);
    assert_int_equal(labelled(GL_TEXTURE), tiles ? 6 : 5);
    assert_int_equal(labelled(GL_BUFFER), tiles ? 9 : 7);
    subject_close(s, &shown);
    assert_int_equal(labelled(GL_TEXTURE), tiles ? 1 : 0); /* deleted with the model */
    s->gl.GetError();
}

static void remember(const char *message, void *user)
{
    snprintf(user, 256, "%s", message);
}

static void the_log_names_the_context(void **state)
{
    STAGE_OR_SKIP(state);
    char line[256] = "";
    const gtx_renderer_desc desc = {.load = gtx_offscreen_load, .log = remember, .log_user = line};
    gtx_renderer *renderer = NULL;
    gtx_error error = {0};
    must(gtx_renderer_create(&desc, &renderer, &error), &error);
    gtx_renderer_destroy(renderer);
    assert_true(!strncmp(line, "geotex: OpenGL ", 15));
    assert_non_null(strstr(line, (const char *)s->gl.GetString(GL_RENDERER)));
}

/* A renderer, a model, a draw and an update, with the n-th allocation failing. */
static gtx_result use(stage *s, const gtx_asset *asset, const gtx_allocator *hooks)
{
    const gtx_renderer_desc desc = {.load = gtx_offscreen_load, .allocator = hooks};
    gtx_renderer *renderer = NULL;
    gtx_model *model = NULL;
    gtx_camera camera = camera_around(asset);
    const gtx_view view = view_of(&camera);
    stage_clear(s, &view);
    gtx_result result = gtx_renderer_create(&desc, &renderer, NULL);
    if (!result)
        result = gtx_model_create(renderer, asset, &model, NULL);
    gtx_instance instance = {.model = model};
    memcpy(instance.transform, identity, sizeof identity);
    if (!result)
        result = gtx_draw(renderer, &view, &instance, 1, NULL);
    if (!result)
        result = gtx_model_update(renderer, model, asset, 0, NULL);
    gtx_model_destroy(renderer, model);
    gtx_renderer_destroy(renderer);
    return result;
}

static void every_allocation_goes_through_the_hooks(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *asset = with_lod(fixture_sphere(2, 48, 8), 2, 2, 0);
    gtx_result result = GTX_ERROR_MEMORY;
    const GLenum kinds[3] = {GL_PROGRAM, GL_TEXTURE, GL_BUFFER};
    int objects[3];
    for (int k = 0; k < 3; ++k)
        objects[k] = labelled(kinds[k]);
    long n = 0;
    for (; result; ++n) {
        counter c = {n, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        result = use(s, asset, &hooks);
        assert_true(result == GTX_OK || result == GTX_ERROR_MEMORY);
        assert_int_equal(c.bytes, 0);
        for (int k = 0; k < 3; ++k)
            assert_int_equal(labelled(kinds[k]), objects[k]);
        assert_true(n < 300);
    }
    assert_true(n > 12);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_draw_is_a_silent_group),
        cmocka_unit_test(objects_carry_labels),
        cmocka_unit_test(the_log_names_the_context),
        cmocka_unit_test(every_allocation_goes_through_the_hooks),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
