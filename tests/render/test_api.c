/* What the functions of render.h refuse, and models that are uploaded piece by piece. */
#define _POSIX_C_SOURCE 200809L
#include "stage.h"

#include <pthread.h>

static gtx_gl_proc load_all_but(const char *name, void *user)
{
    return strcmp(name, user) == 0 ? NULL : gtx_offscreen_load(name, NULL);
}

static void fake_version(GLenum name, GLint *value)
{
    *value = name == GL_MAJOR_VERSION ? (getenv("GEOTEX_ES") ? 2 : 3)
                                      : name == GL_MINOR_VERSION ? 2 : 0;
}

static gtx_gl_proc load_old(const char *name, void *user)
{
    const gtx_gl_proc real = gtx_offscreen_load(name, user);
    return strcmp(name, "glGetIntegerv") ? real : (gtx_gl_proc)fake_version;
}

static void a_missing_function_is_named(void **state)
{
    STAGE_OR_SKIP(state);
    (void)s;
    static char names[][32] = {"glActiveTexture", "glDrawElementsInstanced",
                               "glVertexAttribPointer"};
    for (int i = 0; i < 3; ++i) {
        gtx_error error = {0};
        gtx_renderer *renderer = (gtx_renderer *)&error;
        const gtx_renderer_desc desc = {.load = load_all_but, .load_user = names[i]};
        assert_int_equal(gtx_renderer_create(&desc, &renderer, &error), GTX_ERROR_GL);
        assert_null(renderer);
        assert_non_null(strstr(error.message, names[i]));
    }
    gtx_error error = {0};
    gtx_renderer *renderer;
    const gtx_renderer_desc old = {.load = load_old};
    assert_int_equal(gtx_renderer_create(&old, &renderer, &error), GTX_ERROR_GL);
    assert_non_null(strstr(error.message, getenv("GEOTEX_ES") ? "2.2" : "3.2"));
}

static void bad_renderers(void **state)
{
    STAGE_OR_SKIP(state);
    (void)s;
    gtx_renderer *renderer;
    gtx_renderer_desc desc = {0};
    assert_int_equal(gtx_renderer_create(NULL, &renderer, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_renderer_create(&desc, &renderer, NULL), GTX_ERROR_ARGUMENT);
    desc.load = gtx_offscreen_load;
    assert_int_equal(gtx_renderer_create(&desc, NULL, NULL), GTX_ERROR_ARGUMENT);
    desc.reserved[1] = 1;
    assert_int_equal(gtx_renderer_create(&desc, &renderer, NULL), GTX_ERROR_NOT_ZEROED);
    gtx_renderer_destroy(NULL);
}

static void bad_models(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_model *model = NULL;
    gtx_asset *asset = fixture_flat(0.5, 8);
    assert_int_equal(gtx_model_prepare(NULL, NULL, &model, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_model_prepare(asset, NULL, NULL, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_model_create(NULL, asset, &model, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_model_create(s->renderer, NULL, &model, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_model_upload(s->renderer, NULL, 0, NULL, NULL), GTX_ERROR_ARGUMENT);
    assert_null(model);
    gtx_model_destroy(s->renderer, NULL);
    gtx_close(asset);
}

static void expect_refused(stage *s, gtx_result expected, const gtx_view *view,
                           const gtx_instance *instance)
{
    gtx_error error = {0};
    assert_int_equal(gtx_draw(s->renderer, view, instance, 1, &error), expected);
    assert_int_equal(error.result, expected);
    assert_true(error.message[0]);
}

static void bad_draws(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_flat(0.5, 8));
    gtx_camera camera = camera_around(shown.asset);
    const gtx_view good = view_of(&camera);
    const gtx_instance fine = shown.instance;
    gtx_view view;
    gtx_instance instance;

    assert_int_equal(gtx_draw(NULL, &good, &fine, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_draw(s->renderer, NULL, &fine, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_draw(s->renderer, &good, NULL, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_draw(s->renderer, &good, NULL, 0, NULL), GTX_OK);

#define VIEW_WITH(change, expected)                                                                \
    view = good, view.change, expect_refused(s, expected, &view, &fine)
    VIEW_WITH(flags = 1u << 20, GTX_ERROR_ARGUMENT);
    VIEW_WITH(method = (gtx_method)9, GTX_ERROR_ARGUMENT);
    VIEW_WITH(pass = (gtx_pass)4, GTX_ERROR_ARGUMENT);
    VIEW_WITH(reserved[0] = 1, GTX_ERROR_NOT_ZEROED);
    VIEW_WITH(search_steps[1] = 3, GTX_ERROR_ARGUMENT);
    VIEW_WITH(search_steps[0] = 1001, GTX_ERROR_ARGUMENT);
    VIEW_WITH(view[5] = NAN, GTX_ERROR_ARGUMENT);
    VIEW_WITH(projection[0] = INFINITY, GTX_ERROR_ARGUMENT);
    VIEW_WITH(projection[0] = 0, GTX_ERROR_ARGUMENT);
    VIEW_WITH(light_direction[1] = NAN, GTX_ERROR_ARGUMENT);
    VIEW_WITH(ambient = -1, GTX_ERROR_ARGUMENT);
    VIEW_WITH(depth_range[1] = 2, GTX_ERROR_ARGUMENT);
    view = (gtx_view){0};
    expect_refused(s, GTX_ERROR_ARGUMENT, &view, &fine);

#define INSTANCE_WITH(change, expected)                                                            \
    instance = fine, instance.change, expect_refused(s, expected, &good, &instance)
    INSTANCE_WITH(model = NULL, GTX_ERROR_ARGUMENT);
    INSTANCE_WITH(transform[15] = 0, GTX_ERROR_ARGUMENT);
    INSTANCE_WITH(transform[3] = 1, GTX_ERROR_ARGUMENT);
    INSTANCE_WITH(transform[0] = 0, GTX_ERROR_ARGUMENT);
    INSTANCE_WITH(transform[12] = NAN, GTX_ERROR_ARGUMENT);
    INSTANCE_WITH(tint[1] = NAN, GTX_ERROR_ARGUMENT);
    INSTANCE_WITH(reserved[0] = 1, GTX_ERROR_NOT_ZEROED);
    subject_close(s, &shown);
}

static void *prepare(void *user)
{
    subject *shown = user;
    gtx_error error;
    gtx_model_prepare(shown->asset, NULL, &shown->model, &error);
    return NULL;
}

/* Prepared on another thread, the asset closed, then uploaded a kilobyte at a time. */
static void prepared_elsewhere_and_uploaded_in_slices(void **state)
{
    STAGE_OR_SKIP(state);
    subject whole = subject_open(s, fixture_sphere(2, 48, 8));
    gtx_camera camera = camera_around(whole.asset);
    const gtx_view view = view_of(&camera);
    stage_draw(s, &view, &whole.instance, 1);
    uint8_t *expected = malloc(sizeof s->color);
    memcpy(expected, s->color, sizeof s->color);

    subject sliced = {.asset = fixture_sphere(2, 48, 8), .instance = whole.instance};
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, prepare, &sliced), 0);
    pthread_join(thread, NULL);
    assert_non_null(sliced.model);
    gtx_close(sliced.asset);
    sliced.asset = NULL;
    sliced.instance.model = sliced.model;
    expect_refused(s, GTX_ERROR_ARGUMENT, &view, &sliced.instance); /* not uploaded yet */
    uint32_t done = 0, slices = 0;
    gtx_error error = {0};
    for (; !done && slices < 10000; ++slices)
        must(gtx_model_upload(s->renderer, sliced.model, 1024, &done, &error), &error);
    assert_in_range(slices, 50, 9999);
    must(gtx_model_upload(s->renderer, sliced.model, 0, &done, &error), &error);
    assert_int_equal(done, 1);
    stage_draw(s, &view, &sliced.instance, 1);
    assert_memory_equal(expected, s->color, sizeof s->color);

    const gtx_model_size size = gtx_model_gpu_size(sliced.model);
    assert_true(size.geometry > 48 * 48 * 6 * 5 && size.color > 48 * 48 * 6 * 4);
    free(expected);
    subject_close(s, &sliced);
    subject_close(s, &whole);
}

static void every_failed_allocation_is_reported(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 48, 8);
    for (long n = 0;; ++n) {
        counter c = {n, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        const gtx_model_desc desc = {.allocator = &hooks};
        gtx_model *model = NULL;
        const gtx_result result = gtx_model_prepare(asset, &desc, &model, NULL);
        if (result == GTX_OK)
            gtx_model_destroy(NULL, model);
        else
            assert_int_equal(result, GTX_ERROR_MEMORY);
        assert_int_equal(c.bytes, 0);
        assert_true(n < 300);
        if (result == GTX_OK)
            break;
    }
    gtx_close(asset);
}

static void shader_files_are_there(void **state)
{
    (void)state;
    assert_non_null(strstr(gtx_shader_source("geotex_cast.glsl"), "gtx_cast"));
    assert_null(gtx_shader_source("geotex_nothing.glsl"));
    assert_null(gtx_shader_source(NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_missing_function_is_named),
        cmocka_unit_test(bad_renderers),
        cmocka_unit_test(bad_models),
        cmocka_unit_test(bad_draws),
        cmocka_unit_test(prepared_elsewhere_and_uploaded_in_slices),
        cmocka_unit_test(every_failed_allocation_is_reported),
        cmocka_unit_test(shader_files_are_there),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
