/* Two views in one pass: in each layer the picture that its eye alone gets; the validation layer is
 * silent. */
#include "both.h"

static gtx_picture two;

/* Two eyes, a little apart, and both off the middle. */
static void eyes_of(const gtx_camera *camera, gtx_camera out[2])
{
    for (int i = 0; i < 2; ++i) {
        out[i] = *camera;
        out[i].zero_to_one = 1;
        out[i].azimuth += i ? 3.0f : -3.0f;
        out[i].pan[0] += 0.1f * camera->radius * (i ? 1.0f : -1.0f);
    }
}

static gtx_view seen_by(const gtx_camera *eye, const gtx_view *as)
{
    gtx_view view = *as;
    const gtx_view own = view_of(eye);
    memcpy(view.view, own.view, sizeof view.view);
    memcpy(view.projection, own.projection, sizeof view.projection);
    view.flags |= GTX_VIEW_DEPTH_ZERO_TO_ONE | (eye->reversed_z ? GTX_VIEW_REVERSED_Z : 0);
    return view;
}

/* One pass for both, and each alone: how many pixels differ, of so many that show something. What
 * AUTO draws as a displaced grid for an eye alone has about the same depth. */
static size_t difference(gtx_host_vulkan *d, const pair *p, const gtx_camera *camera,
                         const gtx_view *as, const gtx_instance *instances, uint32_t count, way w,
                         size_t *covered)
{
    gtx_camera eyes[2];
    gtx_eye other;
    size_t far = 0;
    eyes_of(camera, eyes);
    gtx_view view = seen_by(&eyes[0], as);
    const gtx_view second = seen_by(&eyes[1], as);
    memcpy(other.view, second.view, sizeof other.view);
    memcpy(other.projection, second.projection, sizeof other.projection);
    view.other = &other;
    draw_by(d, &two, p, &view, instances, count, w);
    const uint8_t *color = gtx_picture_bytes(&two, 0);
    const float *depth = gtx_picture_bytes(&two, GTX_PICTURE_DEPTH);
    for (int i = 0; i < 2; ++i) {
        const gtx_view alone = seen_by(&eyes[i], as);
        draw_by(d, &shown, p, &alone, instances, count, w);
        const uint8_t *a = gtx_picture_bytes(&shown, 0);
        const uint8_t *b = color + 4 * i * STAGE_PIXELS;
        const float *x = gtx_picture_bytes(&shown, GTX_PICTURE_DEPTH);
        const float *y = depth + i * STAGE_PIXELS;
        for (int k = 0; k < STAGE_PIXELS; ++k) {
            const bool lit = as->pass == GTX_PASS_FORWARD && as->method != GTX_METHOD_AUTO;
            bool differs = fabsf(x[k] - y[k]) > (as->method ? 1e-4f : 1e-2f);
            for (int c = 4 * k; c < 4 * k + 4; ++c)
                differs = differs || (lit && abs(a[c] - b[c]) > 2);
            far += differs;
            *covered += x[k] > 0 && x[k] < 1;
        }
    }
    return far;
}

/* Mesa 22.3's puts triangles that the near plane or the edges of the picture cut into any of the
 * two layers, also where both eyes are the same. */
static bool clips(const gtx_host_vulkan *d)
{
    return !strstr(d->name, "llvmpipe");
}

static void each_eye_has_its_picture(void **state)
{
    BOTH_OR_SKIP(state);
    if (!d->multiview)
        skip();
    static const gtx_method methods[] = {GTX_METHOD_AUTO, GTX_METHOD_CAST, GTX_METHOD_LOD,
                                         GTX_METHOD_PAPER};
    gtx_instance instances[COUNT];
    pair p = pair_open(s, d, with_lod(fixture_sphere(2, 48, 8), 2, 3, 0));
    gtx_camera camera = camera_around(p.gl.asset);
    place(p.gl.model, 0.3f * camera.radius, instances);
    for (int i = 0; i < COUNT; ++i) /* all within the sphere that the camera looks at */
        for (int k = 0; k < 15; ++k)
            instances[i].transform[k] *= i % 2 || k > 11 ? 0.5f : 0.8f;
    for (int i = 0; i < 16; ++i) {
        const bool near = i & 1 && clips(d);
        size_t covered = 0;
        camera.distance = near ? 0.8f : 3.1f;
        camera.reversed_z = i >> 2 & 1;
        const gtx_view view = {.light_direction = {0.3f, 0.5f, 0.8f},
                               .method = methods[i / 4], .viewport_height = STAGE_HEIGHT,
                               .level = methods[i / 4] == GTX_METHOD_LOD ? 1 : 0,
                               .pass = i & 2 ? GTX_PASS_DEPTH : GTX_PASS_FORWARD};
        const way w = {.by_pass = i % 3 == 0 || !d->renders, .y_up = true};
        const size_t far = difference(d, &p, &camera, &view, instances, i & 1 ? COUNT : 1, w,
                                      &covered);
        assert_true(covered > 1000);
        if (far * (view.method ? 10000 : 200) > 2 * STAGE_PIXELS)
            fail_msg("%zu of %d pixels differ in %d", far, 2 * STAGE_PIXELS, i);
    }
    pair_close(s, &p);
}

/* What only one of the eyes has in view. */
static void what_one_eye_sees_is_drawn(void **state)
{
    BOTH_OR_SKIP(state);
    if (!d->multiview)
        skip();
    size_t covered = 0;
    pair p = pair_open(s, d, with_lod(fixture_sphere(2, 48, 8), 2, 3, 0));
    gtx_camera camera = camera_around(p.gl.asset);
    camera.distance = 2;
    gtx_instance beside = p.gl.instance;
    for (int side = -1; side < 2; side += 2) {
        beside.transform[12] = 2.15f * camera.radius * (float)side;
        const gtx_view view = {.light_direction = {0.3f, 0.5f, 0.8f},
                               .method = clips(d) ? GTX_METHOD_CAST : GTX_METHOD_LOD};
        const size_t far = difference(d, &p, &camera, &view, &beside, 1,
                                      (way){.by_pass = true, .y_up = true}, &covered);
        assert_true(far * 10000 <= 2 * STAGE_PIXELS);
    }
    assert_true(covered > 100);
    pair_close(s, &p);
}

static void misuse_is_refused(void **state)
{
    BOTH_OR_SKIP(state);
    gtx_error error = {0};
    gtx_asset *asset = fixture_sphere(2, 48, 8);
    const gtx_camera camera = camera_around(asset);
    gtx_view view = for_vulkan(view_of(&camera), camera, true);
    gtx_eye other;
    gtx_vk_target target = {.color_count = 1};
    memcpy(other.view, view.view, sizeof other.view);
    memcpy(other.projection, view.projection, sizeof other.projection);
    view.other = &other;
    assert_int_equal(gtx_vk_draw(vk, d->commands, &target, &view, NULL, 0, &error),
                     GTX_ERROR_ARGUMENT); /* two eyes, one layer */
    target.view_mask = 3;
    view.method = GTX_METHOD_GRID;
    assert_int_equal(gtx_vk_draw(vk, d->commands, &target, &view, NULL, 0, &error),
                     GTX_ERROR_UNSUPPORTED);
    view.method = GTX_METHOD_AUTO;
    other.view[3] = NAN;
    assert_int_equal(gtx_vk_draw(vk, d->commands, &target, &view, NULL, 0, &error),
                     GTX_ERROR_ARGUMENT);
    memset(other.view, 0, sizeof other.view);
    assert_int_equal(gtx_vk_draw(vk, d->commands, &target, &view, NULL, 0, &error),
                     GTX_ERROR_ARGUMENT);
    view.other = NULL;
    assert_int_equal(gtx_vk_draw(vk, d->commands, &target, &view, NULL, 0, &error),
                     GTX_ERROR_ARGUMENT);
    (void)s;
    gtx_close(asset);
}

static void the_layer_is_silent(void **state)
{
    BOTH_OR_SKIP(state);
    (void)s;
    assert_int_equal(d->complaints, 0);
}

static int open_all(void **state)
{
    gtx_error error = {0};
    const gtx_picture_desc desc = {.width = STAGE_WIDTH, .height = STAGE_HEIGHT, .color_count = 1,
                                   .colors = {VK_FORMAT_R8G8B8A8_UNORM}, .pixel_size = 4,
                                   .views = 2};
    const int failed = open_both(state);
    if (!failed && vk && the_device.multiview)
        must(gtx_picture_create(&the_device, &desc, &two, &error), &error);
    return failed;
}

static int close_all(void **state)
{
    if (vk && the_device.multiview)
        gtx_picture_destroy(&the_device, &two);
    return close_both(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_eye_has_its_picture),
        cmocka_unit_test(what_one_eye_sees_is_drawn),
        cmocka_unit_test(misuse_is_refused),
        cmocka_unit_test(the_layer_is_silent),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
