/* Rays in shaders: bad arguments, the same answers as rays on the CPU, in a shading and in a
 * program of the engine's own, by either kind of heights, as instances move; and no acne. */
#include "floor.h"
#include "host/target.h"

enum { ASSETS = 2, INSTANCES = 3 };

typedef struct scene {
    gtx_asset *assets[ASSETS];
    gtx_caster *casters[ASSETS];
    gtx_model *models[ASSETS];
    gtx_rays *rays;
} scene;

static void scene_open(stage *s, uint32_t bits, scene *out)
{
    gtx_error error = {0};
    out->assets[0] = fixture_sphere(1, 64, bits);
    out->assets[1] = fixture_bumpy(8, GTX_PATCH_TWO_SIDED);
    for (int i = 0; i < ASSETS; ++i) {
        must(gtx_caster_create(out->assets[i], NULL, &out->casters[i], &error), &error);
        must(gtx_model_create(s->renderer, out->assets[i], &out->models[i], &error), &error);
    }
    const gtx_asset *const list[ASSETS] = {out->assets[0], out->assets[1]};
    const gtx_rays_desc desc = {.assets = list, .asset_count = ASSETS,
                                .max_instances = INSTANCES};
    must(gtx_rays_create(s->renderer, &desc, &out->rays, &error), &error);
}

static void scene_close(stage *s, scene *c)
{
    gtx_rays_destroy(s->renderer, c->rays);
    for (int i = 0; i < ASSETS; ++i) {
        gtx_model_destroy(s->renderer, c->models[i]);
        gtx_caster_destroy(c->casters[i]);
        gtx_close(c->assets[i]);
    }
}

/* Places the instances everywhere: `kinds` are assets. */
static gtx_scene *place(stage *s, scene *c, const uint32_t kinds[INSTANCES],
                        const float transforms[INSTANCES][16], gtx_instance shown[INSTANCES])
{
    gtx_error error = {0};
    gtx_ray_instance placed[INSTANCES];
    gtx_scene_instance known[INSTANCES];
    gtx_scene *out = NULL;
    for (int i = 0; i < INSTANCES; ++i) {
        placed[i].asset = kinds[i];
        known[i].caster = c->casters[kinds[i]];
        shown[i] = (gtx_instance){.model = c->models[kinds[i]]};
        memcpy(placed[i].transform, transforms[i], sizeof identity);
        memcpy(known[i].transform, transforms[i], sizeof identity);
        memcpy(shown[i].transform, transforms[i], sizeof identity);
    }
    must(gtx_rays_place(s->renderer, c->rays, placed, INSTANCES, &error), &error);
    must(gtx_scene_create(known, INSTANCES, NULL, &out, &error), &error);
    return out;
}

static void bad_arguments(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *asset = fixture_flat(0.5, 8);
    const gtx_asset *list[2] = {asset, NULL};
    gtx_rays *rays = NULL;
    const gtx_rays_desc bad[] = {{.assets = list}, {.asset_count = 1}, {.assets = list, 2},
                                 {.assets = list, 1, .max_instances = UINT32_MAX}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        assert_int_equal(gtx_rays_create(s->renderer, &bad[i], &rays, NULL), GTX_ERROR_ARGUMENT);
    const gtx_rays_desc dirty = {.assets = list, 1, .reserved = {0, 1}};
    assert_int_equal(gtx_rays_create(s->renderer, &dirty, &rays, NULL), GTX_ERROR_NOT_ZEROED);
    assert_null(rays);
    gtx_rays_destroy(s->renderer, NULL);

    const gtx_rays_desc good = {.assets = list, 1, .max_instances = 1};
    gtx_error error = {0};
    must(gtx_rays_create(s->renderer, &good, &rays, &error), &error);
    gtx_ray_instance instance = {.asset = 1};
    memcpy(instance.transform, identity, sizeof identity);
    assert_int_equal(gtx_rays_place(s->renderer, rays, &instance, 1, NULL), GTX_ERROR_ARGUMENT);
    instance.asset = 0;
    assert_int_equal(gtx_rays_place(s->renderer, rays, &instance, 2, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_rays_place(s->renderer, rays, NULL, 1, NULL), GTX_ERROR_ARGUMENT);
    instance.transform[5] = 0;
    assert_int_equal(gtx_rays_place(s->renderer, rays, &instance, 1, NULL), GTX_ERROR_ARGUMENT);
    gtx_rays_destroy(s->renderer, rays);
    assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
    gtx_close(asset);
}

/* Each failure gives everything back. */
static void memory_runs_out(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *asset = fixture_sphere(1, 48, 8);
    const gtx_asset *const list[1] = {asset};
    const gtx_rays_desc desc = {.assets = list, 1, .max_instances = 2};
    int failures = 0;
    for (long n = 0;; ++n) {
        counter c = {-1, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        const gtx_renderer_desc own = {.load = gtx_offscreen_load, .allocator = &hooks};
        gtx_renderer *renderer;
        gtx_rays *rays = NULL;
        gtx_error error = {0};
        if (n % 8 && n > 24) /* each makes a renderer */
            continue;
        must(gtx_renderer_create(&own, &renderer, &error), &error);
        const long before = c.bytes;
        c.until_failure = n;
        const gtx_result result = gtx_rays_create(renderer, &desc, &rays, &error);
        c.until_failure = -1;
        if (result)
            assert_int_equal(result, GTX_ERROR_MEMORY);
        failures += result != GTX_OK;
        gtx_rays_destroy(renderer, rays);
        assert_int_equal(c.bytes, before);
        gtx_renderer_destroy(renderer);
        assert_int_equal(c.bytes, 0);
        if (!result)
            break;
    }
    assert_true(failures > 10);
    gtx_close(asset);
}

/* Red: a shadow, green: half a sky in 16 rays; of points that are drawn beside it. */
static const char lighting[] =
    "uniform vec4 sun;\n"
    "layout(location = 0) out vec4 color;\n"
    "layout(location = 1) out vec4 place;\n"
    "layout(location = 2) out vec4 facing;\n"
    "void shade(vec3 point, vec3 n) {\n"
    "    color = vec4(gtx_sunlight(point, n, sun.xyz, sun.w, sun.w > 0.0 ? 16 : 1, 0.25),\n"
    "                 gtx_skylight(point, n, 2.0, 16, 0.75), 0.0, 1.0);\n"
    "    place = vec4(point, 1.0);\n"
    "    facing = vec4(n, 1.0);\n"
    "}\n";
static const char patch_main[] = "void main() {\n"
                                 "    gtx_surface s;\n"
                                 "    if (!gtx_find(s)) discard;\n"
                                 "    shade(gtx_world_point(s), gtx_world_normal(s));\n"
                                 "    gtx_write_depth(s);\n"
                                 "}\n";

typedef struct picture {
    uint8_t color[4 * STAGE_PIXELS];
    float place[4 * STAGE_PIXELS], facing[4 * STAGE_PIXELS];
} picture;

static picture the_picture;

typedef void (*read_buffer)(GLenum buffer);

static void read_back(stage *s, GLenum from, GLenum type, void *out)
{
    ((read_buffer)gtx_offscreen_load("glReadBuffer", NULL))(from);
    s->gl.ReadPixels(0, 0, STAGE_WIDTH, STAGE_HEIGHT, GL_RGBA, type, out);
}

/* Compares pixels with gtx_scene_light at the very points; grain of a few pixels at the edges of
 * shadows is float's. */
static void compare(const gtx_scene *known, const float sun[4], long least, long *differ)
{
    gtx_light_desc light = {.spread = sun[3], .rays = sun[3] > 0 ? 16 : 1}, sky = {.reach = 2,
                                                                                 .rays = 16};
    memcpy(light.direction, sun, sizeof light.direction);
    long seen = 0, dark = 0;
    const picture *p = &the_picture;
    for (int i = 0; i < STAGE_PIXELS; i += 3) {
        if (p->place[4 * i + 3] == 0)
            continue;
        gtx_lit_point point = {.turn = 0.25f};
        memcpy(point.position, &p->place[4 * i], sizeof point.position);
        memcpy(point.normal, &p->facing[4 * i], sizeof point.normal);
        float share[2];
        assert_int_equal(gtx_scene_light(known, &light, &point, &share[0], 1), GTX_OK);
        point.turn = 0.75f;
        assert_int_equal(gtx_scene_light(known, &sky, &point, &share[1], 1), GTX_OK);
        ++seen;
        dark += share[0] < 0.5f;
        for (int k = 0; k < 2; ++k)
            *differ += fabs(p->color[4 * i + k] / 255.0 - (double)share[k]) > 0.005;
    }
    assert_true(seen > least && dark > seen / 20 && dark < seen);
    print_message("# %ld points, %ld dark, %ld differ\n", seen, dark, *differ);
    assert_true(*differ * 200 <= seen);
}

static const float transforms[2][INSTANCES][16] = {
    {{1.2f, 0, 0, 0, 0, 1.2f, 0, 0, 0, 0, 1.2f, 0, 0, 0, 0, 1},
     {0.3f, 0.1f, 0, 0, -0.1f, 0.5f, 0, 0, 0, 0, 0.4f, 0, 1.2f, 1.1f, 0.9f, 1},
     {-0.6f, 0, 0, 0, 0, 0, 0.6f, 0, 0, 0.6f, 0, 0, -1.6f, -1.8f, 0.3f, 1}},
    {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.2f, 0.4f, 0, 1},
     {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0, -0.8f, 0.9f, 1.2f, 1},
     {0.7f, 0, 0, 0, 0, 0.7f, 0, 0, 0, 0, 0.7f, 0, -1.6f, -2.2f, -1, 1}}};

static void shaders_agree_with_the_cpu(void **state)
{
    STAGE_OR_SKIP(state);
    static const uint32_t kinds[2][INSTANCES] = {{0, 0, 1}, {0, 0, 1}};
    const float suns[2][4] = {{0.41f, 0.82f, 0.4f, 0}, {0.30f, 0.64f, 0.707f, 0.2f}};
    const gtx_camera camera = {.radius = 2.6f, .azimuth = 20, .elevation = 25, .distance = 2.2f};
    gtx_view view = view_of(&camera);
    gtx_error error = {0};
    gtx_shading *shading;
    gtx_target target;
    char text[4096];
    snprintf(text, sizeof text, "%s%s", lighting, patch_main);
    must(gtx_shading_create(s->renderer, text, &shading, &error), &error);
    view.shading = shading;
    must(gtx_target_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT,
                           (GLenum[]){GL_RGBA8, GL_RGBA16F, GL_RGBA16F, 0}, &target, &error),
         &error);
    /* Sixteen bits of a float would move the points: those of the picture are 32. */
    for (int k = 1; k < 3; ++k) {
        s->gl.BindTexture(GL_TEXTURE_2D, target.colors[k]);
        s->gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, STAGE_WIDTH, STAGE_HEIGHT, 0, GL_RGBA,
                         GL_FLOAT, NULL);
    }
    const GLuint program = cast_program(shading);
    for (uint32_t bits = 8; bits <= 16; bits += 8) {
        scene c;
        scene_open(s, bits, &c);
        gtx_rays_bind(s->renderer, c.rays, program);
        for (int turn = 0; turn < 2; ++turn) {
            gtx_instance shown[INSTANCES];
            gtx_scene *known = place(s, &c, kinds[turn], transforms[turn], shown);
            long differ = 0;
            s->gl.UseProgram(program);
            gtx_set_vector(&s->gl, program, "sun", suns[turn]);
            gtx_target_begin(&s->gl, &target);
            must(gtx_draw(s->renderer, &view, shown, INSTANCES, &error), &error);
            read_back(s, GL_COLOR_ATTACHMENT0, GL_UNSIGNED_BYTE, the_picture.color);
            read_back(s, GL_COLOR_ATTACHMENT1, GL_FLOAT, the_picture.place);
            read_back(s, GL_COLOR_ATTACHMENT2, GL_FLOAT, the_picture.facing);
            assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
            compare(known, suns[turn], 2000, &differ);
            gtx_scene_destroy(known);
        }
        gtx_rays_bind(s->renderer, NULL, 0);
        scene_close(s, &c);
    }
    gtx_target_destroy(&s->gl, &target);
    gtx_shading_destroy(s->renderer, shading);
}

/* A sphere in light from the side: whatever faces it is lit, and without rays everything. */
static void no_acne(void **state)
{
    STAGE_OR_SKIP(state);
    static const char text[] =
        "uniform vec4 sun;\n"
        "layout(location = 0) out vec4 color;\n"
        "void main() {\n"
        "    gtx_surface s;\n"
        "    if (!gtx_find(s)) discard;\n"
        "    vec3 n = gtx_world_normal(s);\n"
        "    float lit = gtx_sunlight(gtx_world_point(s), n, sun.xyz, 0.0, 1, 0.0);\n"
        "    color = vec4(lit, dot(n, sun.xyz) > 0.002 ? 1.0 : 0.0, 0.0, 1.0);\n"
        "    gtx_write_depth(s);\n"
        "}\n";
    gtx_error error = {0};
    gtx_shading *shading;
    gtx_rays *rays;
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    const gtx_asset *const list[1] = {shown.asset};
    const gtx_rays_desc desc = {.assets = list, 1, .max_instances = 1};
    gtx_ray_instance instance = {.asset = 0};
    memcpy(instance.transform, identity, sizeof identity);
    must(gtx_shading_create(s->renderer, text, &shading, &error), &error);
    must(gtx_rays_create(s->renderer, &desc, &rays, &error), &error);
    must(gtx_rays_place(s->renderer, rays, &instance, 1, &error), &error);
    const GLuint program = cast_program(shading);
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    view.shading = shading;
    for (int bound = 1; bound >= 0; --bound) {
        gtx_rays_bind(s->renderer, bound ? rays : NULL, program);
        long facing = 0, dark = 0, shaded = 0;
        for (int i = 0; i < 6; ++i) {
            const float a = 1.1f * (float)i, sun[4] = {cosf(a), 0.1f * (float)i, sinf(a), 0};
            const float length = sqrtf(1 + sun[1] * sun[1]);
            s->gl.UseProgram(program);
            gtx_set_vector(&s->gl, program, "sun",
                           (float[4]){sun[0] / length, sun[1] / length, sun[2] / length, 0});
            stage_draw(s, &view, &shown.instance, 1);
            for (int k = 0; k < STAGE_PIXELS; ++k) {
                facing += s->color[4 * k + 1] > 0;
                dark += s->color[4 * k + 1] > 0 && s->color[4 * k] == 0;
                shaded += s->depth[k] < 1 && s->color[4 * k] == 0;
            }
        }
        print_message("# %ld pixels face the light, %ld of them dark, %ld dark in all\n", facing,
                      dark, shaded);
        assert_true(facing > 15000);
        assert_int_equal(dark, 0);
        assert_true(shaded > 10000); /* under the horizon nothing needs a ray */
    }
    gtx_rays_destroy(s->renderer, rays);
    gtx_shading_destroy(s->renderer, shading);
    subject_close(s, &shown);
}

/* A floor under a sphere is dark where the CPU says so. */
static void a_floor_of_polygons(void **state)
{
    STAGE_OR_SKIP(state);
    scene c;
    gtx_instance shown[INSTANCES];
    static const uint32_t kinds[INSTANCES] = {0, 0, 1};
    const GLuint program = make_floor(s);
    scene_open(s, 8, &c);
    gtx_scene *known = place(s, &c, kinds, transforms[0], shown);
    draw_floor(s, c.rays, program);
    const gtx_light_desc light = {.direction = {0.6f, 0, 0.8f}};
    long dark = 0, differ = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        const float x = ((float)(i % STAGE_WIDTH) + 0.5f) / STAGE_WIDTH;
        const float y = 1 - ((float)(i / STAGE_WIDTH) + 0.5f) / STAGE_HEIGHT;
        const gtx_lit_point point = {{6 * x - 3, 6 * y - 3, -1.5f}, {0, 0, 1}, 0};
        float share;
        gtx_scene_light(known, &light, &point, &share, 1);
        dark += share == 0;
        differ += (share == 0) != (s->color[4 * i] == 0);
    }
    print_message("# %ld of %d dark, %ld differ\n", dark, STAGE_PIXELS, differ);
    assert_true(dark > STAGE_PIXELS / 20 && dark < STAGE_PIXELS / 2);
    assert_true(differ <= 10);
    s->gl.DeleteProgram(program);
    gtx_scene_destroy(known);
    gtx_rays_bind(s->renderer, NULL, 0);
    scene_close(s, &c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(memory_runs_out),
        cmocka_unit_test(shaders_agree_with_the_cpu),
        cmocka_unit_test(no_acne),
        cmocka_unit_test(a_floor_of_polygons),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
