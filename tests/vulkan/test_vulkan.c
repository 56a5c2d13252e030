/* Vulkan draws what OpenGL draws: at most one pixel in 10,000 is more than two codes away, or close
 * to what shines, where llvmpipe's eight bits between texels of a normal are some codes of a
 * highlight, one in 200. The validation layer, where it is installed, has nothing to say. */
#include "picture.h"

#include "host/target.h"
#include "render/look.h"

enum { COUNT = 5 };

static device the_device;
static gtx_vk *vk;
static picture shown;

static int open_both(void **state)
{
    gtx_error error = {0};
    if (stage_open(state))
        return -1;
    device *d = &the_device;
    if (!open_instance(d) || !open_device(d)) {
        fputs("no Vulkan driver\n", stderr);
        return 0; /* the tests skip */
    }
    fprintf(stderr, "validation layer: %s\n", d->validated ? "on" : "not installed");
    const gtx_vk_desc desc = {.load = d->load, .instance = d->instance,
                              .physical_device = d->physical, .device = d->device};
    if (gtx_vk_create(&desc, &vk, &error))
        fprintf(stderr, "%s\n", error.message);
    else
        make_picture(d, &shown, 1, (VkFormat[]){VK_FORMAT_R8G8B8A8_UNORM}, 4);
    return vk ? 0 : -1;
}

static int close_both(void **state)
{
    device *d = &the_device;
    if (vk) {
        gtx_vk_destroy(vk);
        free_picture(d, &shown);
    }
    close_device(d);
    return stage_close(state) || d->complaints ? -1 : 0;
}

#define BOTH_OR_SKIP(state)                                                                        \
    STAGE_OR_SKIP(state);                                                                          \
    device *d = &the_device;                                                                       \
    if (!vk)                                                                                       \
        skip()

/* An asset in both. */
typedef struct pair {
    subject gl;
    gtx_model *model;
    gtx_vk_model *uploaded;
} pair;

static pair pair_open(stage *s, device *d, gtx_asset *asset)
{
    gtx_error error = {0};
    pair p = {.gl = subject_open(s, asset)};
    const gtx_model_desc desc = {.first_provokes = 1};
    must(gtx_model_prepare(asset, &desc, &p.model, &error), &error);
    begin_commands(d);
    must(gtx_vk_upload(vk, d->commands, p.model, &p.uploaded, &error), &error);
    run_commands(d);
    gtx_vk_uploaded(vk, p.uploaded);
    return p;
}

static void pair_close(stage *s, pair *p)
{
    gtx_vk_model_destroy(vk, p->uploaded);
    gtx_model_free(p->model);
    subject_close(s, &p->gl);
}

/* How Vulkan draws it. */
typedef struct way {
    bool by_pass, y_up;
} way;

static void draw_by(device *d, const picture *in, const pair *p, const gtx_view *view,
                    const gtx_instance *instances, uint32_t count, way w)
{
    gtx_error error = {0};
    gtx_vk_instance placed[COUNT];
    gtx_vk_target target = {.render_pass = w.by_pass ? in->pass : VK_NULL_HANDLE,
                            .color_count = in->color_count,
                            .depth_format = VK_FORMAT_D32_SFLOAT, .y_up = w.y_up};
    memcpy(target.color_formats, in->formats, sizeof target.color_formats);
    memset(placed, 0, sizeof placed);
    for (uint32_t i = 0; i < count; ++i)
        placed[i] = (gtx_vk_instance){p->uploaded, instances[i]};
    gtx_vk_next_frame(vk);
    begin_commands(d);
    begin_picture(d, in, w.by_pass, view->flags & GTX_VIEW_REVERSED_Z ? 0.0f : 1.0f, w.y_up);
    must(gtx_vk_draw(vk, d->commands, &target, view, placed, count, &error), &error);
    end_picture(d, in, w.by_pass);
}

/* The view, with clip z and y as Vulkan has them. */
static gtx_view for_vulkan(gtx_view view, gtx_camera camera, bool y_up)
{
    camera.zero_to_one = 1;
    const gtx_view clip = view_of(&camera);
    memcpy(view.projection, clip.projection, sizeof view.projection);
    view.flags |= GTX_VIEW_DEPTH_ZERO_TO_ONE;
    for (int k = 1; k < 16 && !y_up; k += 4)
        view.projection[k] = -view.projection[k];
    return view;
}

/* OpenGL's picture, with its own clip z, in the stage; then Vulkan's. */
static void expect_alike(stage *s, device *d, const pair *p, gtx_camera camera, gtx_view view,
                         const gtx_instance *instances, uint32_t count, way w, int one_in)
{
    size_t far = 0, apart = 0, covered = 0;
    stage_draw(s, &view, instances, count);
    const gtx_view own = for_vulkan(view, camera, w.y_up);
    const uint8_t *found = shown.bytes + offset_of(0);
    const float *depth = (const float *)(const void *)(shown.bytes + offset_of(DEPTH));
    draw_by(d, &shown, p, &own, instances, count, w);
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        int most = 0;
        for (int c = 0; c < 4; ++c) {
            const int difference = abs(found[4 * i + c] - s->color[4 * i + c]);
            most = difference > most ? difference : most;
        }
        far += view.pass == GTX_PASS_FORWARD && most > 2;
        apart += fabsf(depth[i] - s->depth[i]) > 1e-4f;
        covered += s->depth[i] > 0 && s->depth[i] < 1;
    }
    assert_true(covered > 1000);
    if (far * (size_t)one_in > STAGE_PIXELS || apart * 10000 > STAGE_PIXELS)
        fail_msg("%zu of %d pixels are more than 2 codes away, %zu in depth", far, STAGE_PIXELS,
                 apart);
}

/* Several, near and far, one mirrored. */
static void place(const gtx_model *model, float radius, gtx_instance instances[COUNT])
{
    static const float across[COUNT] = {0, -0.8f, 0.8f, -0.4f, 0.4f};
    memset(instances, 0, COUNT * sizeof *instances);
    for (int i = 0; i < COUNT; ++i) {
        instances[i].model = model;
        memcpy(instances[i].transform, identity, sizeof identity);
        instances[i].transform[0] = i == 2 ? -1.0f : 1.0f;
        instances[i].transform[12] = radius * across[i];
        instances[i].transform[14] = -1.2f * radius * (float)i;
        instances[i].tint[i % 3] = instances[i].tint[3] = 1;
        instances[i].tint[(i + 1) % 3] = 0.6f;
    }
}

/* Every method and both passes with a depth of their own, far and near, one instance and several;
 * by a render pass and without, either way up, both orders of depth. */
static void check_all(stage *s, device *d, gtx_asset *asset, int near_one_in)
{
    gtx_instance instances[COUNT];
    gtx_info info;
    gtx_get_info(asset, &info);
    pair p = pair_open(s, d, asset);
    gtx_camera camera = camera_around(asset);
    place(p.gl.model, camera.radius, instances);
    for (int i = 0; i < 8 * (GTX_METHOD_GRID + 1); ++i) {
        camera.distance = i & 1 ? 0.8f : 3.1f;
        camera.reversed_z = i >> 2 & 1;
        gtx_view view = view_of(&camera);
        view.pass = i & 2 ? GTX_PASS_DEPTH : GTX_PASS_FORWARD;
        view.method = (gtx_method)(i / 8);
        view.viewport_height = STAGE_HEIGHT;
        if (view.method == GTX_METHOD_LOD && !info.lod_levels)
            continue;
        const way w = {.by_pass = i % 3 == 0 || !d->renders, .y_up = i % 5 < 3};
        expect_alike(s, d, &p, camera, view, instances, i % 2 ? COUNT : 1, w,
                     i % 2 ? near_one_in : 10000);
    }
    pair_close(s, &p);
}

static void heights_are_drawn(void **state)
{
    BOTH_OR_SKIP(state);
    check_all(s, d, fixture_sphere(2, 64, 16), 10000);
}

static void lod_meshes_are_drawn(void **state)
{
    BOTH_OR_SKIP(state);
    check_all(s, d, with_lod(fixture_sphere(2, 64, 8), 2, 3, 0), 10000);
    check_all(s, d, with_lod(fixture_sphere(2, 64, 8), 2, 3, GTX_PATCH_TWO_SIDED), 10000);
}

static void materials_and_emission_are_drawn(void **state)
{
    BOTH_OR_SKIP(state);
    check_all(s, d, with_lod_as(fixture_sphere(2, 64, 8), 2, 3, 0, LOD_EVEN), 200);
    const look shiny = {.color = {200, 90, 30, 255}, .material = {255, 90, 200, 255},
                        .emission = {9, 30, 5}};
    check_all(s, d, repaint(fixture_sphere(2, 64, 8), &shiny), 200);
}

/* Bytes of a colour of OpenGL's target, the uppermost row first. */
static void read_target(stage *s, int which, bool ids, uint8_t *out)
{
    const size_t row = (ids ? 16u : 4u) * STAGE_WIDTH;
    s->gl.ReadBuffer(GL_COLOR_ATTACHMENT0 + (GLenum)which);
    for (int y = 0; y < STAGE_HEIGHT; ++y)
        s->gl.ReadPixels(0, STAGE_HEIGHT - 1 - y, STAGE_WIDTH, 1,
                         ids ? GL_RGBA_INTEGER : GL_RGBA, ids ? GL_UNSIGNED_INT : GL_UNSIGNED_BYTE,
                         out + (size_t)y * row);
}

/* Pixels of which one of the first bytes is more than so much away. */
static size_t apart(const uint8_t *a, const uint8_t *b, size_t size, size_t first, int most)
{
    size_t count = 0;
    for (size_t i = 0; i < STAGE_PIXELS; ++i) {
        bool far = false;
        for (size_t k = i * size; k < i * size + first; ++k)
            far = far || abs(a[k] - b[k]) > most;
        count += far;
    }
    return count;
}

/* Ids, or a G-buffer of bytes. */
static void check_pass(stage *s, device *d, gtx_pass pass, uint32_t colors)
{
    static uint8_t expected[16 * STAGE_PIXELS];
    const bool ids = pass == GTX_PASS_ID;
    GLenum formats[COLORS + 1] = {0};
    VkFormat of_vulkan[COLORS];
    gtx_error error = {0};
    gtx_target target;
    picture own;
    gtx_instance instances[COUNT];
    for (uint32_t i = 0; i < colors; ++i) {
        formats[i] = ids ? GL_RGBA32UI : GL_RGBA8;
        of_vulkan[i] = ids ? VK_FORMAT_R32G32B32A32_UINT : VK_FORMAT_R8G8B8A8_UNORM;
    }
    must(gtx_target_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT, formats, &target, &error), &error);
    make_picture(d, &own, colors, of_vulkan, ids ? 16 : 4);
    pair p = pair_open(s, d, with_lod_as(fixture_sphere(2, 64, 8), 2, 3, 0, LOD_SHINY));
    gtx_camera camera = camera_around(p.gl.asset);
    place(p.gl.model, camera.radius, instances);
    for (int i = 0; i < 2 * (GTX_METHOD_GRID + 1); ++i) {
        const way w = {.by_pass = i & 1 || !d->renders, .y_up = i & 1};
        camera.distance = i & 1 ? 1.2f : 3.1f;
        gtx_view view = view_of(&camera);
        view.pass = pass;
        view.method = (gtx_method)(i / 2);
        view.viewport_height = STAGE_HEIGHT;
        gtx_target_begin(&s->gl, &target);
        for (uint32_t c = 0; c < colors; ++c) {
            static const GLuint no_ids[4] = {0};
            static const GLfloat nothing[4] = {0};
            if (ids)
                s->gl.ClearBufferuiv(GL_COLOR, (GLint)c, no_ids);
            else
                s->gl.ClearBufferfv(GL_COLOR, (GLint)c, nothing);
        }
        must(gtx_draw(s->renderer, &view, instances, COUNT, &error), &error);
        const gtx_view of_own = for_vulkan(view, camera, w.y_up);
        draw_by(d, &own, &p, &of_own, instances, COUNT, w);
        for (uint32_t c = 0; c < colors; ++c) {
            const uint8_t *found = own.bytes + offset_of((int)c);
            read_target(s, (int)c, ids, expected);
            const size_t far = apart(expected, found, ids ? 16 : 4, 4, ids ? 0 : 2);
            if (far * 10000 > STAGE_PIXELS)
                fail_msg("%zu of %d pixels of colour %u differ", far, STAGE_PIXELS, c);
            /* On the line between two cells either is right. */
            if (ids)
                assert_true(apart(expected, found, 16, 16, 0) * 1000 <= STAGE_PIXELS);
        }
    }
    pair_close(s, &p);
    free_picture(d, &own);
    gtx_target_destroy(&s->gl, &target);
}

static void ids_and_g_buffers_are_drawn(void **state)
{
    BOTH_OR_SKIP(state);
    check_pass(s, d, GTX_PASS_ID, 1);
    check_pass(s, d, GTX_PASS_GBUFFER, 4);
    check_pass(s, d, GTX_PASS_GBUFFER, 2);
}

static void the_layer_is_silent(void **state)
{
    BOTH_OR_SKIP(state);
    (void)s;
    if (!d->validated)
        skip();
    assert_int_equal(d->complaints, 0);
}

static void misuse_is_refused(void **state)
{
    BOTH_OR_SKIP(state);
    gtx_error error = {0};
    gtx_vk *other;
    gtx_vk_desc desc = {.load = d->load, .instance = d->instance,
                        .physical_device = d->physical, .device = d->device};
    desc.frames = 9;
    assert_int_equal(gtx_vk_create(&desc, &other, &error), GTX_ERROR_ARGUMENT);
    desc.frames = 0;
    desc.reserved[1] = 1;
    assert_int_equal(gtx_vk_create(&desc, &other, &error), GTX_ERROR_NOT_ZEROED);
    desc.reserved[1] = 0;
    desc.costs.cast_pixel = -1;
    assert_int_equal(gtx_vk_create(&desc, &other, &error), GTX_ERROR_ARGUMENT);
    pair p = pair_open(s, d, fixture_sphere(2, 64, 8));
    gtx_vk_model *again;
    assert_int_equal(gtx_vk_upload(vk, d->commands, p.model, &again, &error), GTX_ERROR_ARGUMENT);
    const gtx_camera camera = camera_around(p.gl.asset);
    const gtx_view view = view_of(&camera);
    const gtx_vk_target target = {.color_count = 1};
    assert_int_equal(gtx_vk_draw(vk, d->commands, &target, &view, NULL, 0, &error),
                     GTX_ERROR_ARGUMENT); /* clip z in -1..1 */
    pair_close(s, &p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_are_drawn),
        cmocka_unit_test(lod_meshes_are_drawn),
        cmocka_unit_test(materials_and_emission_are_drawn),
        cmocka_unit_test(ids_and_g_buffers_are_drawn),
        cmocka_unit_test(misuse_is_refused),
        cmocka_unit_test(the_layer_is_silent),
    };
    return cmocka_run_group_tests(tests, open_both, close_both);
}
