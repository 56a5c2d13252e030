/* Drawing the LOD mesh: instances, backs, smooth edges, the rims of maps. */
#include "pictures.h"

static void place(float m[16], const float rows[9], float x, float y, float z)
{
    memcpy(m, identity, sizeof identity);
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            m[4 * c + r] = rows[3 * r + c];
    m[12] = x;
    m[13] = y;
    m[14] = z;
}

/* Turned, mirrored, squashed, tinted; both depth orders; mirrored views. */
static void instances_are_placed(void **state)
{
    STAGE_OR_SKIP(state);
    enum { COUNT = 7 };
    subject shown = sphere_open(s);
    gtx_instance instances[COUNT];
    memset(instances, 0, sizeof instances);
    for (int i = 0; i < COUNT; ++i) {
        const float turn = 0.9f * (float)i, size = 0.6f + 0.1f * (float)i;
        const float c = size * cosf(turn), d = size * sinf(turn), m = i % 3 ? 1.0f : -1.0f;
        const float rows[9] = {m * c, 0, d, 0, i % 2 ? size : 0.5f * size, 0, -m * d, 0, c};
        instances[i].model = shown.model;
        instances[i].tint[i % 3] = instances[i].tint[3] = 1;
        instances[i].tint[(i + 1) % 3] = 0.5f;
        place(instances[i].transform, rows, 3.2f * (float)(i % 4) - 4.5f,
              3.0f * (float)(i / 4) - 1.5f, 0.8f * sinf((float)i));
    }
    gtx_camera camera = {.radius = 7, .azimuth = 20, .elevation = 15, .distance = 2.6f};
    for (int i = 0; i < 8; ++i) {
        camera.reversed_z = i & 1;
        camera.orthographic = i >> 1 & 1;
        gtx_view view = view_of(&camera);
        if (i & 4)
            view.projection[0] = -view.projection[0];
        view.level = 1;
        draw(s, &view, GTX_METHOD_CAST, instances, COUNT, &first);
        draw(s, &view, GTX_METHOD_LOD, instances, COUNT, &second);
        const difference d = compare(&first, &second);
        expect_alike(&d, 0.99, 0.5, 255); /* outlines of one before another */
    }
    subject_close(s, &shown);
}

/* Two squares side by side, whose rectangles lie one under the other: one red, one green, the
 * brighter the coarser the mip level. */
static void square_field(const gtx_patch *patch, double x, double y, const void *user,
                         fixture_texel *out)
{
    (void)patch, (void)y;
    int level = 0; /* texel i of level k is at x + 1/2 = (2 i + 1) 2^(k - 1) */
    for (double at = x + 0.5; level < 3 && at == floor(at); at /= 2)
        ++level;
    out->height = 0.5;
    out->trim = -1;
    out->color[*(const int *)user] = (uint8_t)(60 + 60 * level);
    out->color[1 - *(const int *)user] = out->color[2] = 0;
}

static gtx_asset *two_fields(void)
{
    static const int channels[2] = {0, 1};
    fixture_patch squares[2];
    for (int i = 0; i < 2; ++i) {
        const double corner[3] = {4 * i + 0.0625, 0.0625, 0};
        squares[i] = (fixture_patch){fixture_frame(corner, 32, 32, 0.125, 1), square_field,
                                     &channels[i]};
    }
    return fixture_build(squares, 2, 8, 4);
}

static gtx_asset *two_squares(void)
{
    static const uint32_t first_triangle[3] = {0, 2, 4};
    static const uint32_t indices[12] = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
    static const uint16_t positions[18] = {0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0, 8, 0, 0, 8, 4, 0};
    const gtx_lod_mesh lod = {.origin = {0, 0, 0.5f}, .step = 1, .vertex_count = 6,
                              .triangle_count = 4, .first = first_triangle, .indices = indices,
                              .positions = positions};
    return with_lod_meshes(two_fields(), &lod, 1, 0, LOD_COLORED);
}

/* Two height fields from above, where their maps are seen at a level; returns the side of a
 * pixel. */
static double draw_from_above(stage *s, const subject *shown, int level)
{
    const double pixel = 0.125 * (1 << level) * 1.2;
    gtx_camera camera = {.target = {4, 2, 0.5f}, .orthographic = 1, .distance = 3,
                         .radius = (float)(pixel * STAGE_HEIGHT / 2 * 0.96)};
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    view.ambient = 1;
    draw(s, &view, GTX_METHOD_LOD, &shown->instance, 1, &first);
    return pixel;
}

/* No texel of the one in the picture of the other, at no mip level; and the right level. */
static void maps_end_at_their_rectangles(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, two_squares());
    for (int level = 0; level < 4; ++level) {
        const double pixel = draw_from_above(s, &shown, level);
        long counts[2] = {0, 0};
        for (int i = 0; i < STAGE_PIXELS; ++i) {
            const uint8_t *c = first.color + 4 * i;
            if (first.depth[i] == first.empty)
                continue;
            ++counts[c[1] > c[0]];
            if (abs(c[0] + c[1] - 60 - 60 * level) > 1 || (c[0] && c[1]) || c[2])
                fail_msg("level %d: a pixel of (%d, %d, %d)", level, c[0], c[1], c[2]);
        }
        const double each = 16 / (pixel * pixel);
        assert_true((double)counts[0] > 0.7 * each && (double)counts[1] > 0.7 * each);
    }
    subject_close(s, &shown);
}

/* One square of a far level across both patches is all of the first one's colour. */
static void far_triangles_show_one_patch(void **state)
{
    STAGE_OR_SKIP(state);
    static const uint32_t first_triangle[3] = {0, 2, 2};
    static const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    static const uint16_t positions[12] = {0, 0, 0, 8, 0, 0, 8, 4, 0, 0, 4, 0};
    const gtx_lod_mesh lod = {.origin = {0, 0, 0.5f}, .step = 1, .vertex_count = 4,
                              .triangle_count = 2, .flags = GTX_LOD_FAR, .first = first_triangle,
                              .indices = indices, .positions = positions};
    subject shown = subject_open(s, with_lod_meshes(two_fields(), &lod, 1, 0, LOD_COLORED));
    for (int level = 0; level < 4; ++level) {
        const double pixel = draw_from_above(s, &shown, level);
        long count = 0;
        for (int i = 0; i < STAGE_PIXELS; ++i) {
            const uint8_t *c = first.color + 4 * i;
            if (first.depth[i] == first.empty)
                continue;
            ++count;
            assert_true(abs(c[0] - 60 - 60 * level) <= 1 && !c[1] && !c[2]);
        }
        assert_true((double)count > 0.85 * 32 / (pixel * pixel));
    }
    subject_close(s, &shown);
}

/* What the test counts: questions to OpenGL between two points. */
static int questions;
static PFNGLGETINTEGERVPROC real_get;
static PFNGLISENABLEDPROC real_is_enabled;

static void counted_get(GLenum name, GLint *value)
{
    ++questions;
    real_get(name, value);
}

static GLboolean counted_is_enabled(GLenum name)
{
    ++questions;
    return real_is_enabled(name);
}

static gtx_gl_proc load_counted(const char *name, void *user)
{
    const gtx_gl_proc real = gtx_offscreen_load(name, user);
    if (strcmp(name, "glGetIntegerv") == 0) {
        real_get = (PFNGLGETINTEGERVPROC)real;
        return (gtx_gl_proc)counted_get;
    }
    if (strcmp(name, "glIsEnabled") == 0) {
        real_is_enabled = (PFNGLISENABLEDPROC)real;
        return (gtx_gl_proc)counted_is_enabled;
    }
    return real;
}

static void a_draw_asks_nothing(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_renderer *usual = s->renderer;
    gtx_error error = {0};
    const gtx_renderer_desc desc = {.load = load_counted, .costs = {0, 0, 1, 1}};
    must(gtx_renderer_create(&desc, &s->renderer, &error), &error);
    subject shown = sphere_open(s);
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    view.max_error = 2;
    for (int restore = 0; restore < 2; ++restore) {
        view.flags = restore ? GTX_VIEW_RESTORE_STATE : 0;
        questions = 0;
        draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &first);
        draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &first);
        assert_int_equal(questions > 0, restore); /* or the test counts nothing */
    }
    subject_close(s, &shown);
    gtx_renderer_destroy(s->renderer);
    s->renderer = usual;
}

/* Leaves what is 15 pixels or less from the middle. */
static void crop_to_middle(picture *p)
{
    for (int i = 0; i < STAGE_PIXELS; ++i)
        if (hypot(i % STAGE_WIDTH - STAGE_WIDTH / 2, i / STAGE_WIDTH - STAGE_HEIGHT / 2) > 15)
            p->depth[i] = p->empty;
}

/* A sphere with a face missing shows the backs of the others, lit as cast: within its rim,
 * which the height fields have a little farther out. */
static void backs_of_two_sided_patches(void **state)
{
    STAGE_OR_SKIP(state);
    for (int two_sided = 0; two_sided < 2; ++two_sided) {
        subject shown = subject_open(
            s, with_lod(fixture_sphere_without(radius, TEXELS, 8, 1 << 4), radius, LOD_LEVELS,
                        two_sided ? GTX_PATCH_TWO_SIDED : 0));
        gtx_camera camera = camera_around(shown.asset);
        camera.target[0] = camera.target[1] = camera.target[2] = 0;
        camera.azimuth = 10; /* before the missing face */
        camera.elevation = 5;
        gtx_view view = view_of(&camera);
        view.level = 1;
        draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
        draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &second);
        assert_int_equal(covers(&second, STAGE_WIDTH / 2, STAGE_HEIGHT / 2), two_sided);
        if (two_sided) {
            crop_to_middle(&first);
            crop_to_middle(&second);
            const difference d = compare(&first, &second);
            assert_int_equal(d.both, d.either);
            assert_true(d.mean < 1 && d.worst < 12);
        }
        subject_close(s, &shown);
    }
}

/* Pixels of the outline are in between: covered by some samples of four. */
static void multisampling_smooths_edges(void **state)
{
    STAGE_OR_SKIP(state);
    PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC storage =
        (PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC)gtx_offscreen_load(
            "glRenderbufferStorageMultisample", NULL);
    subject shown = sphere_open(s);
    GLuint object, buffers[2];
    s->gl.GenFramebuffers(1, &object);
    s->gl.GenRenderbuffers(2, buffers);
    s->gl.BindFramebuffer(GL_FRAMEBUFFER, object);
    for (int i = 0; i < 2; ++i) {
        s->gl.BindRenderbuffer(GL_RENDERBUFFER, buffers[i]);
        storage(GL_RENDERBUFFER, 4, i ? GL_DEPTH_COMPONENT24 : GL_RGBA8, STAGE_WIDTH, STAGE_HEIGHT);
        s->gl.FramebufferRenderbuffer(GL_FRAMEBUFFER,
                                      i ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0,
                                      GL_RENDERBUFFER, buffers[i]);
    }
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    long between[2];
    for (int i = 0; i < 2; ++i) {
        view.method = i ? GTX_METHOD_LOD : GTX_METHOD_CAST;
        view.level = 1;
        stage_clear(s, &view);
        s->gl.BindFramebuffer(GL_FRAMEBUFFER, object);
        s->gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        must(gtx_draw(s->renderer, &view, &shown.instance, 1, NULL), &(gtx_error){0});
        s->gl.BindFramebuffer(GL_READ_FRAMEBUFFER, object);
        s->gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, s->framebuffer.object);
        s->gl.BlitFramebuffer(0, 0, STAGE_WIDTH, STAGE_HEIGHT, 0, 0, STAGE_WIDTH, STAGE_HEIGHT,
                              GL_COLOR_BUFFER_BIT, GL_NEAREST);
        gtx_framebuffer_read_color(&s->gl, &s->framebuffer, s->color);
        between[i] = 0;
        for (int p = 0; p < STAGE_PIXELS; ++p) /* alpha is coverage */
            between[i] += s->color[4 * p + 3] > 0 && s->color[4 * p + 3] < 255;
    }
    s->gl.DeleteFramebuffers(1, &object);
    s->gl.DeleteRenderbuffers(2, buffers);
    gtx_framebuffer_bind(&s->gl, &s->framebuffer);
    subject_close(s, &shown);
    if (between[1] < 150)
        fail_msg("%ld pixels in between, cast %ld", between[1], between[0]);
}

static void slices_and_size(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *plain = fixture_sphere(radius, TEXELS, 8), *asset = with_lod(
        fixture_sphere(radius, TEXELS, 8), radius, LOD_LEVELS, 0);
    gtx_model *models[2];
    gtx_error error = {0};
    uint32_t done = 0;
    int slices = 0;
    must(gtx_model_prepare(plain, NULL, &models[0], &error), &error);
    must(gtx_model_prepare(asset, NULL, &models[1], &error), &error);
    gtx_lod_mesh level;
    uint64_t least = 0; /* two bytes an index, eight a vertex */
    for (uint32_t k = 0; k < LOD_LEVELS; ++k) {
        gtx_get_lod_mesh(asset, k, &level);
        least += 6 * (uint64_t)level.triangle_count + 8 * (uint64_t)level.vertex_count;
    }
    const uint64_t extra =
        gtx_model_gpu_size(models[1]).geometry - gtx_model_gpu_size(models[0]).geometry;
    assert_in_range(extra, least, 3 * least);
    for (; !done; ++slices)
        must(gtx_model_upload(s->renderer, models[1], 4096, &done, &error), &error);
    assert_true(slices > 20);
    subject shown = {asset, models[1], {.model = models[1]}};
    memcpy(shown.instance.transform, identity, sizeof identity);
    subject whole = sphere_open(s);
    gtx_camera camera = camera_around(asset);
    gtx_view view = view_of(&camera);
    view.level = 2;
    draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &first);
    draw(s, &view, GTX_METHOD_LOD, &whole.instance, 1, &second);
    assert_memory_equal(first.color, second.color, sizeof first.color);
    gtx_model_destroy(s->renderer, models[0]);
    gtx_close(plain);
    subject_close(s, &whole);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(instances_are_placed),
        cmocka_unit_test(a_draw_asks_nothing),
        cmocka_unit_test(backs_of_two_sided_patches),
        cmocka_unit_test(multisampling_smooths_edges),
        cmocka_unit_test(slices_and_size),
        cmocka_unit_test(maps_end_at_their_rectangles),
        cmocka_unit_test(far_triangles_show_one_patch),
    };
    return cmocka_run_group_tests(tests, open_stage, stage_close);
}
