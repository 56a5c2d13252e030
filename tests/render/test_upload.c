/* Uploads in slices, under a microscope: what each call sends, and what a small GPU answers. */
#include "stage.h"

/* What the renderer asked of OpenGL, and how OpenGL is made to answer. */
static struct {
    uint64_t sent, row;       /* bytes in this call, and the largest row among them */
    int side;                 /* GL_MAX_TEXTURE_SIZE, 0 for the real one */
    int until_out_of_memory;  /* calls of glGetError before the one that says so; -1: none */
} spy;

static uint64_t texel_size(GLenum format, GLenum type)
{
    const uint64_t channels = format == GL_RED || format == GL_RED_INTEGER ? 1
                              : format == GL_RG                            ? 2
                              : format == GL_RGB                           ? 3
                                                                           : 4;
    return channels * (type == GL_FLOAT ? 4 : type == GL_UNSIGNED_SHORT ? 2 : 1);
}

static void note(GLsizei width, GLsizei rows, GLenum format, GLenum type)
{
    const uint64_t row = (uint64_t)width * texel_size(format, type);
    spy.sent += row * (uint64_t)rows;
    spy.row = row > spy.row ? row : spy.row;
}

#define REAL(type, name) ((type)gtx_offscreen_load(name, NULL))

static void APIENTRY sub_image_2d(GLenum target, GLint level, GLint x, GLint y, GLsizei w,
                                  GLsizei h, GLenum format, GLenum type, const void *data)
{
    note(w, h, format, type);
    REAL(PFNGLTEXSUBIMAGE2DPROC, "glTexSubImage2D")(target, level, x, y, w, h, format, type, data);
}

static void APIENTRY sub_image_3d(GLenum target, GLint level, GLint x, GLint y, GLint z, GLsizei w,
                                  GLsizei h, GLsizei d, GLenum format, GLenum type,
                                  const void *data)
{
    note(w, h * d, format, type);
    REAL(PFNGLTEXSUBIMAGE3DPROC, "glTexSubImage3D")(target, level, x, y, z, w, h, d, format, type,
                                                    data);
}

static void APIENTRY buffer_data(GLenum target, GLsizeiptr size, const void *data, GLenum usage)
{
    spy.sent += data ? (uint64_t)size : 0;
    REAL(PFNGLBUFFERDATAPROC, "glBufferData")(target, size, data, usage);
}

static void APIENTRY buffer_sub_data(GLenum target, GLintptr at, GLsizeiptr size, const void *data)
{
    spy.sent += (uint64_t)size;
    REAL(PFNGLBUFFERSUBDATAPROC, "glBufferSubData")(target, at, size, data);
}

static void APIENTRY get_integer(GLenum name, GLint *value)
{
    REAL(PFNGLGETINTEGERVPROC, "glGetIntegerv")(name, value);
    if (name == GL_MAX_TEXTURE_SIZE && spy.side)
        *value = spy.side;
}

static GLenum APIENTRY get_error(void)
{
    const GLenum real = REAL(PFNGLGETERRORPROC, "glGetError")();
    return spy.until_out_of_memory >= 0 && spy.until_out_of_memory-- == 0 ? GL_OUT_OF_MEMORY : real;
}

static gtx_gl_proc load_spy(const char *name, void *user)
{
    static const struct {
        const char *name;
        gtx_gl_proc proc;
    } ours[] = {{"glTexSubImage2D", (gtx_gl_proc)sub_image_2d},
                {"glTexSubImage3D", (gtx_gl_proc)sub_image_3d},
                {"glBufferData", (gtx_gl_proc)buffer_data},
                {"glBufferSubData", (gtx_gl_proc)buffer_sub_data},
                {"glGetIntegerv", (gtx_gl_proc)get_integer},
                {"glGetError", (gtx_gl_proc)get_error}};
    for (size_t i = 0; i < sizeof ours / sizeof *ours; ++i)
        if (!strcmp(name, ours[i].name))
            return ours[i].proc;
    return gtx_offscreen_load(name, user);
}

static gtx_renderer *spied_renderer(void)
{
    const gtx_renderer_desc desc = {.load = load_spy};
    gtx_renderer *renderer = NULL;
    gtx_error error = {0};
    memset(&spy, 0, sizeof spy);
    spy.until_out_of_memory = -1;
    must(gtx_renderer_create(&desc, &renderer, &error), &error);
    return renderer;
}

static gtx_model *prepared(const gtx_asset *asset)
{
    gtx_model *model = NULL;
    gtx_error error = {0};
    must(gtx_model_prepare(asset, NULL, &model, &error), &error);
    return model;
}

/* The picture of the model, by a renderer that nobody spies on. */
static void take_picture(stage *s, const gtx_asset *asset, const gtx_model *model, uint8_t *out)
{
    gtx_camera camera = camera_around(asset);
    const gtx_view view = view_of(&camera);
    gtx_instance instance = {.model = model};
    memcpy(instance.transform, identity, sizeof identity);
    stage_draw(s, &view, &instance, 1);
    memcpy(out, s->color, sizeof s->color);
}

static void slices_keep_to_their_bytes(void **state)
{
    STAGE_OR_SKIP(state);
    static const uint64_t limits[] = {1, 100, 5000, 60000};
    gtx_renderer *renderer = spied_renderer();
    gtx_asset *asset = fixture_sphere(2, 48, 8);
    for (size_t i = 0; i < sizeof limits / sizeof *limits; ++i) {
        gtx_model *model = prepared(asset);
        uint64_t sum = 0, calls = 0;
        for (uint32_t done = 0; !done && calls < 100000; ++calls) {
            spy.sent = spy.row = 0;
            must(gtx_model_upload(renderer, model, limits[i], &done, NULL), &(gtx_error){0});
            assert_true(spy.sent > 0);
            assert_true(spy.sent < limits[i] + (spy.row ? spy.row : 1));
            sum += spy.sent;
        }
        const gtx_model_size size = gtx_model_gpu_size(model);
        assert_true(sum == size.geometry + size.color && calls > 1);
        gtx_model_destroy(renderer, model);
    }
    gtx_close(asset);
    gtx_renderer_destroy(renderer);
}

static void a_small_gpu_is_a_limit(void **state)
{
    STAGE_OR_SKIP(state);
    (void)s;
    gtx_renderer *renderer = spied_renderer();
    gtx_asset *asset = fixture_sphere(2, 48, 8);
    gtx_model *model = NULL;
    gtx_error error = {0};
    spy.side = 64;
    spy.sent = 0;
    assert_int_equal(gtx_model_create(renderer, asset, &model, &error), GTX_ERROR_LIMIT);
    assert_non_null(strstr(error.message, "64"));
    assert_null(model);
    assert_int_equal(spy.sent, 0);
    gtx_close(asset);
    gtx_renderer_destroy(renderer);
}

/* Out of memory in the n-th slice: said so, and the upload that follows is a whole one. */
static void out_of_memory_begins_anew(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_renderer *renderer = spied_renderer();
    gtx_asset *asset = fixture_sphere(2, 48, 8);
    uint8_t *expected = malloc(sizeof s->color), *drawn = malloc(sizeof s->color);
    gtx_model *model = prepared(asset);
    must(gtx_model_upload(renderer, model, 0, NULL, NULL), &(gtx_error){0});
    take_picture(s, asset, model, expected);
    gtx_model_destroy(renderer, model);
    for (int n = 0; n < 8; ++n) {
        gtx_error error = {0};
        gtx_result result = GTX_OK;
        model = prepared(asset);
        spy.until_out_of_memory = n;
        for (uint32_t done = 0; !done && !result;)
            result = gtx_model_upload(renderer, model, 8192, &done, &error);
        assert_int_equal(result, GTX_ERROR_GL);
        assert_non_null(strstr(error.message, "memory"));
        uint32_t done = 0;
        must(gtx_model_upload(renderer, model, 0, &done, &error), &error);
        assert_int_equal(done, 1);
        take_picture(s, asset, model, drawn);
        assert_memory_equal(expected, drawn, sizeof s->color);
        gtx_model_destroy(renderer, model);
    }
    free(expected);
    free(drawn);
    gtx_close(asset);
    gtx_renderer_destroy(renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slices_keep_to_their_bytes),
        cmocka_unit_test(a_small_gpu_is_a_limit),
        cmocka_unit_test(out_of_memory_begins_anew),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
