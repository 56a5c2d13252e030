/* Rays in shaders by Vulkan: the shadows, hard and soft, and the sky of OpenGL's, as instances move
 * and an asset is edited; without rays nothing occludes; the validation layer is silent. */
#include "compile.h"
#include "render/edited.h"

/* The share of the sun, of a disc of it and of the sky, in a channel each. */
static const char own_main[] =
    "#pragma geotex tiles\n"
    "layout(location = 0) out vec4 color;\n"
    "void main()\n"
    "{\n"
    "    gtx_surface s;\n"
    "    if (!gtx_find(s))\n"
    "        discard;\n"
    "    vec3 point = gtx_world_point(s), n = gtx_world_normal(s);\n"
    "    vec3 sun = normalize(vec3(-0.5, 0.9, 0.4));\n"
    "    color.r = gtx_sunlight(point, n, sun, 0.0, 1, 0.0);\n"
    "    color.g = gtx_sunlight(point, n, sun, 0.3, 4, 0.3);\n"
    "    color.ba = vec2(gtx_skylight(point, n, 5.0, 3, 0.6), 1.0);\n"
    "    gtx_write_depth(s);\n"
    "}\n";

enum { INSTANCES = 3 };

/* A scene in both. */
typedef struct scene {
    pair p;
    gtx_shading *by_gl;
    gtx_vk_shading *shading;
    gtx_rays *gl_rays, *rays;
    gtx_vk_rays *uploaded;
} scene;

static void draw_in_both(stage *s, gtx_host_vulkan *d, const scene *c, const gtx_camera *camera,
                         const gtx_instance *instances, const gtx_ray_instance *placed,
                         const gtx_asset *change)
{
    static const uint32_t patch = 0;
    gtx_error error = {0};
    gtx_view view = view_of(camera);
    gtx_vk_instance own[INSTANCES];
    const gtx_picture_clear clear = {.depth = 1};
    const gtx_vk_target target = {.render_pass = shown.pass, .color_count = 1,
                                  .color_formats = {shown.desc.colors[0]},
                                  .depth_format = VK_FORMAT_D32_SFLOAT, .y_up = 1};
    for (int i = 0; i < INSTANCES; ++i)
        own[i] = (gtx_vk_instance){c->p.uploaded, instances[i]};
    view.method = GTX_METHOD_CAST;
    view.shading = c->by_gl;
    if (change)
        must(gtx_rays_update(s->renderer, c->gl_rays, 0, change, patch, &error), &error);
    must(gtx_rays_place(s->renderer, c->gl_rays, placed, INSTANCES, &error), &error);
    gtx_rays_bind(s->renderer, c->gl_rays, cast_program(c->by_gl));
    stage_draw(s, &view, instances, INSTANCES);
    view.shading = NULL;
    const gtx_view of_own = for_vulkan(view, *camera, true);
    gtx_vk_next_frame(vk);
    must(gtx_host_vulkan_begin(d, &error), &error);
    if (change)
        must(gtx_vk_rays_update(vk, d->commands, c->uploaded, 0, change, &patch, 1, &error),
             &error);
    must(gtx_vk_rays_place(vk, d->commands, c->uploaded, placed, INSTANCES, &error), &error);
    gtx_picture_begin(d, &shown, true, true, &clear);
    must(gtx_vk_draw_shaded(vk, d->commands, &target, &of_own, c->shading, own, INSTANCES, &error),
         &error);
    gtx_picture_end(d, &shown, true);
    gtx_picture_read(d, &shown);
    must(gtx_host_vulkan_run(d, &error), &error);
}

/* Rays that graze may fall either way. Returns how many pixels are in hard shadow. */
static int expect_same(const stage *s)
{
    const uint8_t *found = gtx_picture_bytes(&shown, 0);
    int far = 0, dark = 0, lit = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        int most = 0;
        for (int c = 0; c < 4; ++c) {
            const int difference = abs(found[4 * i + c] - s->color[4 * i + c]);
            most = difference > most ? difference : most;
        }
        far += most > 2;
        dark += found[4 * i + 3] && !found[4 * i];
        lit += found[4 * i + 3] && found[4 * i] == 255;
    }
    assert_true(dark + lit > 1000);
    if (far * 10000 > STAGE_PIXELS)
        fail_msg("%d of %d pixels are more than 2 codes away", far, STAGE_PIXELS);
    return dark;
}

static void open_scene(stage *s, gtx_host_vulkan *d, gtx_asset *asset, compiled *c, scene *out)
{
    gtx_error error = {0};
    const gtx_vk_shading_desc desc = {.fragment = compile, .user = c};
    const gtx_asset *const list = asset;
    const gtx_rays_desc rays = {.assets = &list, .asset_count = 1, .max_instances = INSTANCES};
    out->p = pair_open(s, d, asset);
    must(gtx_shading_create(s->renderer, own_main, &out->by_gl, &error), &error);
    must(gtx_vk_shading_create(vk, &desc, &out->shading, &error), &error);
    must(gtx_rays_create(s->renderer, &rays, &out->gl_rays, &error), &error);
    must(gtx_rays_prepare(&rays, &out->rays, &error), &error);
    must(gtx_host_vulkan_begin(d, &error), &error);
    must(gtx_vk_rays_upload(vk, d->commands, out->rays, &out->uploaded, &error), &error);
    must(gtx_host_vulkan_run(d, &error), &error);
    gtx_vk_rays_uploaded(vk, out->uploaded);
}

static void close_scene(stage *s, scene *c)
{
    gtx_vk_shading_destroy(vk, c->shading);
    gtx_shading_destroy(s->renderer, c->by_gl);
    gtx_vk_rays_destroy(vk, c->uploaded);
    gtx_rays_free(c->rays);
    gtx_rays_destroy(s->renderer, c->gl_rays);
    pair_close(s, &c->p);
}

static void shadows_are_those_of_opengl(void **state)
{
    BOTH_OR_SKIP(state);
    if (system("command -v glslangValidator >/dev/null"))
        skip();
    gtx_error error = {0};
    compiled c = {.main = own_main};
    begin_compiling(&c);
    for (uint32_t bits = 8; bits <= 16; bits += 8) {
        scene all = {.rays = NULL};
        gtx_asset *asset = fixture_sphere(2, 48, bits);
        gtx_asset *change = edited(asset, 0, bits == 8);
        gtx_instance instances[INSTANCES];
        gtx_ray_instance placed[INSTANCES];
        static uint8_t last[4 * STAGE_PIXELS];
        open_scene(s, d, asset, &c, &all);
        gtx_camera camera = camera_around(asset);
        camera.distance *= 2;
        for (int step = 0; step < (bits == 8 ? 3 : 1); ++step) {
            memset(instances, 0, sizeof instances);
            for (int i = 0; i < INSTANCES; ++i) {
                instances[i].model = all.p.gl.model;
                memcpy(instances[i].transform, identity, sizeof identity);
                const float along = (float)(i - 1) * (step ? 1.3f : 1.1f) * camera.radius;
                instances[i].transform[12] = 0.7f * along; /* away from the sun, about */
                instances[i].transform[13] = -0.9f * along;
                placed[i].asset = 0;
                memcpy(placed[i].transform, instances[i].transform, sizeof identity);
            }
            gtx_vk_shading_cast(all.shading, all.uploaded);
            draw_in_both(s, d, &all, &camera, instances, placed, step == 2 ? change : NULL);
            assert_true(expect_same(s) > 100);
            assert_true(memcmp(last, s->color, sizeof last));
            memcpy(last, s->color, sizeof last);
        }
        gtx_vk_shading_cast(all.shading, NULL);
        draw_in_both(s, d, &all, &camera, instances, placed, NULL);
        const uint8_t *found = gtx_picture_bytes(&shown, 0);
        for (int i = 0; i < STAGE_PIXELS; ++i) /* but for what faces away from the sun */
            assert_true(!found[4 * i + 3] || found[4 * i + 2] == 255);
        const uint32_t none = 6;
        must(gtx_host_vulkan_begin(d, &error), &error);
        assert_int_equal(gtx_vk_rays_update(vk, d->commands, all.uploaded, 0, change, &none, 1,
                                            &error), GTX_ERROR_ARGUMENT);
        assert_int_equal(gtx_vk_rays_place(vk, d->commands, all.uploaded, placed, 4, &error),
                         GTX_ERROR_ARGUMENT);
        gtx_vk_rays *again = NULL;
        assert_int_equal(gtx_vk_rays_upload(vk, d->commands, all.rays, &again, &error),
                         GTX_ERROR_ARGUMENT); /* its texels are gone */
        must(gtx_host_vulkan_run(d, &error), &error);
        gtx_close(change);
        close_scene(s, &all);
    }
    end_compiling(&c);
}

static void the_layer_is_silent(void **state)
{
    BOTH_OR_SKIP(state);
    (void)s;
    assert_int_equal(d->complaints, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shadows_are_those_of_opengl),
        cmocka_unit_test(the_layer_is_silent),
    };
    return cmocka_run_group_tests(tests, open_both, close_both);
}
