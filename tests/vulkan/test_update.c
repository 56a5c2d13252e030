/* Edits by Vulkan: what is drawn behind one in the same commands shows the edited asset, what is
 * drawn before it does not; OpenGL's picture; nothing waits, and the validation layer is silent. */
#include "both.h"

#include "render/edited.h"
#include "render/painted.h"

static gtx_picture before;

static void draw_in(gtx_host_vulkan *d, const gtx_picture *in, const gtx_vk_model *model,
                    const gtx_view *view)
{
    gtx_error error = {0};
    const gtx_picture_clear clear = {.depth = 1};
    const gtx_vk_target target = {.render_pass = in->pass, .color_count = 1,
                                  .color_formats = {in->desc.colors[0]},
                                  .depth_format = VK_FORMAT_D32_SFLOAT, .y_up = 1};
    gtx_vk_instance placed = {.model = model};
    memcpy(placed.instance.transform, identity, sizeof identity);
    gtx_picture_begin(d, in, true, true, &clear);
    must(gtx_vk_draw(vk, d->commands, &target, view, &placed, 1, &error), &error);
    gtx_picture_end(d, in, true);
    gtx_picture_read(d, in);
}

/* The picture of a model, an update, and another picture: one submission. */
static void draw_twice(gtx_host_vulkan *d, const pair *p, const gtx_asset *to,
                       const uint32_t *patches, uint32_t count, const gtx_view *view)
{
    gtx_error error = {0};
    gtx_vk_next_frame(vk);
    must(gtx_host_vulkan_begin(d, &error), &error);
    draw_in(d, &before, p->uploaded, view);
    must(gtx_vk_update(vk, d->commands, p->uploaded, to, patches, count, &error), &error);
    draw_in(d, &shown, p->uploaded, view);
    must(gtx_host_vulkan_run(d, &error), &error);
}

static void expect_close(const stage *s, int one_in)
{
    const uint8_t *found = gtx_picture_bytes(&shown, 0);
    int far = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        int most = 0;
        for (int c = 0; c < 4; ++c) {
            const int difference = abs(found[4 * i + c] - s->color[4 * i + c]);
            most = difference > most ? difference : most;
        }
        far += most > 2;
    }
    if (far * one_in > STAGE_PIXELS)
        fail_msg("%d of %d pixels are more than 2 codes away", far, STAGE_PIXELS);
}

/* From one asset to another, of which some patches differ. */
static void check(stage *s, gtx_host_vulkan *d, gtx_asset *from, gtx_asset *to,
                  const uint32_t *patches, uint32_t count, gtx_compression compress)
{
    enum { BYTES = 4 * STAGE_PIXELS };
    static uint8_t first[BYTES], whole[BYTES];
    gtx_error error = {0};
    pair p = pair_open_as(s, d, from, compress), q = pair_open_as(s, d, to, compress);
    const gtx_camera camera = camera_around(from);
    for (int i = 0; i < 3; ++i) {
        const gtx_method method = i == 1 ? GTX_METHOD_GRID : GTX_METHOD_CAST;
        gtx_view view = view_of(&camera);
        view.method = method;
        if (i == 2)
            by_tiles(&view);
        const gtx_view own = for_vulkan(view, camera, true);
        draw_twice(d, &q, to, patches, 0, &own); /* an update of nothing */
        memcpy(whole, gtx_picture_bytes(&shown, 0), BYTES);
        draw_twice(d, &p, to, patches, count, &own);
        memcpy(first, gtx_picture_bytes(&before, 0), BYTES);
        assert_memory_equal(gtx_picture_bytes(&shown, 0), whole, BYTES);
        assert_memory_not_equal(first, whole, BYTES);
        for (uint32_t k = 0; k < count; ++k)
            must(gtx_model_update(s->renderer, p.gl.model, to, patches[k], &error), &error);
        stage_draw(s, &view, &p.gl.instance, 1);
        expect_close(s, gtx_map_data(from, GTX_MAP_MATERIAL, 0, NULL) ? 200 : 10000);
        draw_twice(d, &p, from, patches, count, &own); /* and back again */
        assert_memory_equal(gtx_picture_bytes(&before, 0), whole, BYTES);
        assert_memory_equal(gtx_picture_bytes(&shown, 0), first, BYTES);
        for (uint32_t k = 0; k < count; ++k)
            must(gtx_model_update(s->renderer, p.gl.model, from, patches[k], &error), &error);
    }
    pair_close(s, &p);
    pair_close(s, &q);
}

static const uint32_t seen[] = {0, 2, 4};

static void heights_and_colors(void **state)
{
    BOTH_OR_SKIP(state);
    for (uint32_t bits = 8; bits <= 16; bits += 8) {
        gtx_asset *from = fixture_sphere(2, 48, bits);
        check(s, d, from, edited(from, 2, bits == 8), seen + 1, 1, GTX_COMPRESS_NONE);
    }
}

/* Emission, three bytes a texel; a material that was the same everywhere; blocks. */
static void all_maps(void **state)
{
    BOTH_OR_SKIP(state);
    gtx_asset *plain = fixture_sphere(2, 48, 8);
    for (int blocks = 0; blocks < 2; ++blocks) {
        gtx_asset *from = painted(plain, 3, UINT32_MAX, !blocks);
        gtx_asset *to = painted(from, 5, 2, false);
        gtx_asset *more = painted(to, 8, 4, false);
        check(s, d, from, more, seen, 3, blocks ? GTX_COMPRESS_BC : GTX_COMPRESS_NONE);
        gtx_close(to);
    }
    gtx_close(plain);
}

static void no_piece(const gtx_texture_piece *piece, void *user)
{
    (void)piece, (void)user;
}

static void no_bytes(gtx_buffer buffer, uint64_t at, const void *data, uint64_t size, void *user)
{
    (void)buffer, (void)at, (void)data, (void)size, (void)user;
}

static void no_texture(gtx_slot slot, const gtx_texture *texture, void *user)
{
    (void)slot, (void)texture, (void)user;
}

static void misuse_is_refused(void **state)
{
    BOTH_OR_SKIP(state);
    gtx_error error = {0};
    pair p = pair_open(s, d, fixture_sphere(2, 48, 8));
    gtx_asset *other = fixture_sphere(2, 56, 8);
    const uint32_t none = 6;
    must(gtx_host_vulkan_begin(d, &error), &error);
    assert_int_equal(gtx_vk_update(vk, d->commands, p.uploaded, p.gl.asset, &none, 1, &error),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_vk_update(vk, d->commands, p.uploaded, other, seen, 1, &error),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_vk_update(vk, d->commands, NULL, other, seen, 1, &error),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_vk_update(vk, d->commands, p.uploaded, other, NULL, 1, &error),
                     GTX_ERROR_ARGUMENT);
    must(gtx_host_vulkan_run(d, &error), &error);
    gtx_model *waiting = NULL;
    const gtx_sink sink = {no_piece, no_bytes, no_texture, NULL};
    must(gtx_model_prepare(p.gl.asset, NULL, &waiting, &error), &error);
    assert_int_equal(gtx_model_edit(waiting, p.gl.asset, 0, &sink, &error), GTX_ERROR_ARGUMENT);
    gtx_model_uploaded(waiting);
    assert_int_equal(gtx_model_edit(waiting, p.gl.asset, 0, NULL, &error), GTX_ERROR_ARGUMENT);
    must(gtx_model_edit(waiting, p.gl.asset, 0, &sink, &error), &error);
    gtx_model_free(waiting);
    gtx_close(other);
    pair_close(s, &p);
}

static void the_layer_is_silent(void **state)
{
    BOTH_OR_SKIP(state);
    (void)s;
    assert_int_equal(d->complaints, 0);
}

static int open_all(void **state)
{
    const int failed = open_both(state);
    if (!failed && vk)
        before = picture_of(&the_device, 1, VK_FORMAT_R8G8B8A8_UNORM, 4, 1);
    return failed;
}

static int close_all(void **state)
{
    if (vk)
        gtx_picture_destroy(&the_device, &before);
    return close_both(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_and_colors),
        cmocka_unit_test(all_maps),
        cmocka_unit_test(misuse_is_refused),
        cmocka_unit_test(the_layer_is_silent),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
