/* Vulkan draws what OpenGL draws: at most one pixel in 10,000 is more than two codes away, or close
 * to what shines, where llvmpipe's eight bits between texels of a normal are some codes of a
 * highlight, one in 200. The validation layer, where it is installed, has nothing to say. */
#include "both.h"

#include "host/target.h"
#include "render/look.h"
#include "render/painted.h"

/* Every method and both passes with a depth of their own, far and near, one instance and several;
 * by a render pass and without, either way up, both orders of depth. */
static void check_all(stage *s, gtx_host_vulkan *d, gtx_asset *asset, int near_one_in)
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

/* In the forward pass and that of depth, one instance and several, mirrored, either way up, both
 * orders of depth; far and so near that the near plane cuts. */
static void tiles_are_cast(void **state)
{
    BOTH_OR_SKIP(state);
    const uint64_t *draws = &vk->planner->tiles.draws, before = *draws;
    gtx_instance instances[COUNT];
    pair p = pair_open(s, d, with_lod_as(fixture_sphere(2, 64, 8), 2, 3, 0, LOD_SHINY));
    gtx_camera camera = camera_around(p.gl.asset);
    place(p.gl.model, camera.radius, instances);
    for (int i = 0; i < 16; ++i) {
        camera.distance = i & 1 ? 0.8f : 3.1f;
        camera.reversed_z = i >> 2 & 1;
        gtx_view view = view_of(&camera);
        view.pass = i & 2 ? GTX_PASS_DEPTH : GTX_PASS_FORWARD;
        view.method = GTX_METHOD_CAST;
        by_tiles(&view);
        const way w = {.by_pass = i % 3 == 0 || !d->renders, .y_up = i & 8};
        expect_alike(s, d, &p, camera, view, instances, i % 2 ? COUNT : 1, w, 200);
    }
    /* Where llvmpipe draws. */
    if (strstr(d->name, "llvmpipe"))
        assert_true(*draws >= before + 16);
    pair_close(s, &p);
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

/* The same where a GPU displaces height fields, alone and beside LOD meshes. */
static void blocks_are_displaced(void **state)
{
    BOTH_OR_SKIP(state);
    const bool usual = vk->planner->on_gpu;
    vk->planner->on_gpu = s->renderer->planner.on_gpu = true;
    const uint64_t before = vk->planner->grids.drawn;
    check_all(s, d, fixture_sphere_without(2, 64, 8, 5), 10000);
    check_all(s, d, with_lod(fixture_sphere(2, 64, 8), 2, 3, GTX_PATCH_TWO_SIDED), 10000);
    check_all(s, d, with_lod_as(fixture_sphere(2, 64, 8), 2, 3, 0, LOD_EVEN), 200);
    assert_true(vk->planner->grids.drawn > before);
    vk->planner->on_gpu = s->renderer->planner.on_gpu = usual;
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

/* Of several samples inside is as of one, and where the outline cuts a pixel some samples are
 * covered: in most of the pixels along it, by polygons and by casts once a sample; none by casts
 * once a pixel. */
static void check_samples(gtx_host_vulkan *d, const pair *p, const gtx_picture *four, way w,
                          gtx_method method, uint32_t flags)
{
    const gtx_camera camera = camera_around(p->gl.asset);
    gtx_view view = for_vulkan(view_of(&camera), camera, true);
    int partial = 0, outline = 0, differ = 0;
    view.method = method;
    view.flags |= flags;
    by_tiles(&view);
    draw_by(d, &shown, p, &view, &p->gl.instance, 1, w);
    draw_by(d, four, p, &view, &p->gl.instance, 1, w);
    const uint8_t *a = gtx_picture_bytes(&shown, 0), *b = gtx_picture_bytes(four, 0);
    for (int i = STAGE_WIDTH; i < STAGE_PIXELS - STAGE_WIDTH; ++i) {
        const bool covered = a[4 * i + 3];
        const bool inside = covered && a[4 * i - 1] && a[4 * i + 7] &&
                            a[4 * (i - STAGE_WIDTH) + 3] && a[4 * (i + STAGE_WIDTH) + 3];
        outline += covered && !inside;
        partial += b[4 * i + 3] > 0 && b[4 * i + 3] < 255;
        differ += inside && abs(a[4 * i] - b[4 * i]) > 3;
    }
    assert_true(outline > 200);
    if (method == GTX_METHOD_LOD || flags)
        assert_in_range(partial, outline / 2, 3 * outline);
    else
        assert_int_equal(partial, 0);
    assert_true(differ * 1000 < STAGE_PIXELS);
}

static void samples_smooth_outlines(void **state)
{
    BOTH_OR_SKIP(state);
    pair p = pair_open(s, d, with_lod(fixture_sphere(2, 64, 8), 2, 3, 0));
    gtx_picture four = picture_of(d, 1, VK_FORMAT_R8G8B8A8_UNORM, 4, VK_SAMPLE_COUNT_4_BIT);
    for (int by_pass = !d->renders; by_pass < 2; ++by_pass) {
        const way w = {.by_pass = by_pass, .y_up = true};
        check_samples(d, &p, &four, w, GTX_METHOD_LOD, 0);
        check_samples(d, &p, &four, w, GTX_METHOD_CAST, 0);
        if (d->by_samples)
            check_samples(d, &p, &four, w, GTX_METHOD_CAST, GTX_VIEW_BY_SAMPLES);
    }
    gtx_picture_destroy(d, &four);
    pair_close(s, &p);
}

/* Into what encodes: the picture that is written in sRGB. */
static void linear_light_is_encoded(void **state)
{
    BOTH_OR_SKIP(state);
    pair p = pair_open(s, d, with_lod_as(fixture_sphere(2, 64, 8), 2, 3, 0, LOD_EVEN));
    gtx_picture srgb = picture_of(d, 1, VK_FORMAT_R8G8B8A8_SRGB, 4, 1);
    const gtx_camera camera = camera_around(p.gl.asset);
    const way w = {.by_pass = true, .y_up = true};
    for (gtx_method method = GTX_METHOD_CAST; method <= GTX_METHOD_LOD; ++method) {
        gtx_view view = for_vulkan(view_of(&camera), camera, true);
        view.method = method;
        view.viewport_height = STAGE_HEIGHT;
        draw_by(d, &shown, &p, &view, &p.gl.instance, 1, w);
        view.flags |= GTX_VIEW_LINEAR;
        draw_by(d, &srgb, &p, &view, &p.gl.instance, 1, w);
        assert_true(apart(gtx_picture_bytes(&shown, 0), gtx_picture_bytes(&srgb, 0), 4, 4, 1) *
                        1000 < STAGE_PIXELS);
    }
    gtx_picture_destroy(d, &srgb);
    pair_close(s, &p);
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

/* Ids, or a G-buffer of bytes. */
static void check_pass(stage *s, gtx_host_vulkan *d, gtx_pass pass, uint32_t colors)
{
    static uint8_t expected[16 * STAGE_PIXELS];
    const bool ids = pass == GTX_PASS_ID;
    GLenum formats[COLORS + 1] = {0};
    gtx_error error = {0};
    gtx_target target;
    gtx_instance instances[COUNT];
    for (uint32_t i = 0; i < colors; ++i)
        formats[i] = ids ? GL_RGBA32UI : GL_RGBA8;
    must(gtx_target_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT, formats, &target, &error), &error);
    gtx_picture own = picture_of(
        d, colors, ids ? VK_FORMAT_R32G32B32A32_UINT : VK_FORMAT_R8G8B8A8_UNORM, ids ? 16 : 4, 1);
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
        view.viewport_width = view.method == GTX_METHOD_CAST ? STAGE_WIDTH : 0;
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
            const uint8_t *found = gtx_picture_bytes(&own, (int)c);
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
    gtx_picture_destroy(d, &own);
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
    desc.tiles = (gtx_tiling)3;
    assert_int_equal(gtx_vk_create(&desc, &other, &error), GTX_ERROR_ARGUMENT);
    desc.tiles = GTX_TILES_AUTO;
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

/* Both read the same blocks; where a device reads none of a kind, both say so. */
static void blocks_are_read(void **state)
{
    BOTH_OR_SKIP(state);
    gtx_error error = {0};
    gtx_asset *plain = fixture_sphere(2, 64, 8);
    gtx_camera camera = camera_around(plain);
    const gtx_view view = view_of(&camera);
    for (int kind = GTX_COMPRESS_BC; kind <= GTX_COMPRESS_BC_SMALL; ++kind) {
        pair p = {.gl.asset = painted(plain, 3, UINT32_MAX, false)};
        const gtx_model_desc desc = {.first_provokes = 1, .compress = (gtx_compression)kind,
                                     .compress_normals = 1};
        must(gtx_model_prepare(p.gl.asset, &desc, &p.gl.model, &error), &error);
        must(gtx_model_prepare(p.gl.asset, &desc, &p.model, &error), &error);
        must(gtx_host_vulkan_begin(d, &error), &error);
        const gtx_result by_gl = gtx_model_upload(s->renderer, p.gl.model, 0, NULL, &error);
        const gtx_result by_vk = gtx_vk_upload(vk, d->commands, p.model, &p.uploaded, &error);
        must(gtx_host_vulkan_run(d, &error), &error);
        gtx_instance instance = {.model = p.gl.model};
        memcpy(instance.transform, identity, sizeof identity);
        if (by_gl || by_vk)
            assert_true(by_gl == GTX_ERROR_UNSUPPORTED || by_vk == GTX_ERROR_UNSUPPORTED);
        else
            expect_alike(s, d, &p, camera, view, &instance, 1, (way){.y_up = 1}, 1000);
        pair_close(s, &p);
    }
    gtx_close(plain);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_are_drawn),
        cmocka_unit_test(tiles_are_cast),
        cmocka_unit_test(lod_meshes_are_drawn),
        cmocka_unit_test(blocks_are_displaced),
        cmocka_unit_test(materials_and_emission_are_drawn),
        cmocka_unit_test(samples_smooth_outlines),
        cmocka_unit_test(linear_light_is_encoded),
        cmocka_unit_test(ids_and_g_buffers_are_drawn),
        cmocka_unit_test(blocks_are_read),
        cmocka_unit_test(misuse_is_refused),
        cmocka_unit_test(the_layer_is_silent),
    };
    return cmocka_run_group_tests(tests, open_both, close_both);
}
