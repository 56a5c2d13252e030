/* Light among instances: shadows and occlusion against what is known of spheres and planes. */
#include "trace/scenes.h"

/* The point of the scene's surface under a ray towards the origin. */
static bool surface_point(const gtx_scene *scene, const double from[3], gtx_lit_point *out)
{
    gtx_ray ray = {.t_max = 0};
    gtx_hit hit;
    for (int k = 0; k < 3; ++k) {
        ray.origin[k] = (float)(5 * from[k]);
        ray.direction[k] = (float)-from[k];
    }
    gtx_scene_raycast(scene, &ray, &hit, NULL, 1, 0);
    for (int k = 0; k < 3; ++k) {
        out->position[k] = ray.origin[k] + hit.t * ray.direction[k];
        out->normal[k] = hit.normal[k];
    }
    return hit.patch != UINT32_MAX;
}

/* A sphere has no hollow: what faces the light at all, by its normals, is lit. */
static void no_acne_on_a_sphere(void **state)
{
    (void)state;
    for (uint32_t bits = 8; bits <= 16; bits += 8)
        for (uint16_t texels = 48; texels <= 128; texels += 80) {
            gtx_asset *asset = fixture_sphere(2, texels, bits);
            gtx_caster *caster = caster_of(asset);
            const gtx_scene_instance one = placed(caster, identity);
            gtx_scene *scene = scene_of(&one, 1);
            long facing = 0, grazing = 0, dark = 0;
            uint64_t seed = 8;
            for (int k = 0; k < 40000; ++k) {
                const double z = 1 - (k + 0.5) / 20000, turn = 2.399963 * k, r = sqrt(1 - z * z);
                const double from[3] = {r * cos(turn), r * sin(turn), z};
                gtx_lit_point point = {.turn = 0};
                assert_true(surface_point(scene, from, &point));
                /* A light very low over the point's horizon, or anywhere above it. */
                gtx_light_desc light = {.rays = 1};
                double way[3], along = 0;
                const double least = bits == 8 ? 0.001 : 0.01; /* normals are bytes */
                const double low = uniform(&seed) < 0.5 ? least : uniform(&seed);
                for (int a = 0; a < 3; ++a) {
                    way[a] = uniform(&seed) - 0.5;
                    along += way[a] * point.normal[a];
                }
                for (int a = 0; a < 3; ++a)
                    light.direction[a] = (float)(way[a] + (low - along) * point.normal[a]);
                float share;
                gtx_scene_light(scene, &light, &point, &share, 1);
                ++facing;
                grazing += low == least;
                dark += share < 1;
            }
            print_message("# %u bits, %u texels: %ld lit points, %ld grazing, %ld dark\n", bits,
                          texels, facing, grazing, dark);
            assert_int_equal(dark, 0);
            assert_true(grazing > 10000);
            gtx_scene_destroy(scene);
            gtx_caster_destroy(caster);
            gtx_close(asset);
        }
}

static void gentle_slope(const gtx_patch *patch, double x, double y, const void *user,
                         fixture_texel *out)
{
    (void)patch;
    (void)user;
    out->height = 0.3 + (0.031 * x + 0.017 * y) / 254; /* a step of code in some 30 texels */
    out->trim = -5;
    out->normal[0] = -0.031;
    out->normal[1] = -0.017;
    out->normal[2] = 1;
}

/* The stairs that 8 bits make of a gentle slope are no hollows, as they would be without offset. */
static void no_acne_on_stairs(void **state)
{
    (void)state;
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 128, 128, 1, 254), gentle_slope, NULL};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 1);
    gtx_caster *caster = caster_of(asset);
    const gtx_scene_instance one = placed(caster, identity);
    gtx_scene *scene = scene_of(&one, 1);
    assert_float_equal(gtx_scene_offset(scene), 2, 1e-6f);
    long dark[2] = {0, 0};
    uint64_t seed = 4;
    for (int i = 0; i < 40000; ++i) {
        const gtx_ray down = {.origin = {(float)(2 + 123 * uniform(&seed)),
                                         (float)(2 + 123 * uniform(&seed)), 500},
                              .direction = {0, 0, -1}};
        gtx_hit hit;
        gtx_scene_raycast(scene, &down, &hit, NULL, 1, 0);
        gtx_lit_point point = {{down.origin[0], down.origin[1], 500 - hit.t}, {0, 0, 0}, 0};
        memcpy(point.normal, hit.normal, sizeof hit.normal);
        const double a = 6.2831853 * uniform(&seed), x = cos(a), y = sin(a);
        gtx_light_desc light = {.direction = {(float)x, (float)y,
                                              (float)(0.031 * x + 0.017 * y + 0.01)}};
        for (int k = 0; k < 2; ++k) {
            float share;
            light.offset = k ? 1e-3f : 0;
            gtx_scene_light(scene, &light, &point, &share, 1);
            dark[k] += share < 1;
        }
    }
    print_message("# dark: %ld with the offset, %ld without\n", dark[0], dark[1]);
    assert_int_equal(dark[0], 0);
    assert_true(dark[1] > 1000);
    gtx_scene_destroy(scene);
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

/* A sphere of radius 1 whose centre is `h` above the middle of a plane of 31 x 23. */
static gtx_scene *ball_over_plane(gtx_caster *ball, gtx_caster *plane, float h)
{
    gtx_scene_instance instances[2] = {placed(ball, identity), placed(plane, identity)};
    const float wide[16] = {8, 0, 0, 0, 0, 8, 0, 0, 0, 0, 8, 0, -15.5f, -11.5f, -4, 1};
    memcpy(instances[1].transform, wide, sizeof wide);
    instances[0].transform[14] = h;
    return scene_of(instances, 2);
}

/* From under a sphere of radius r whose centre is h away, the share of the sky that is hidden, by
 * the cosine, is (r / h)^2; that of a disc of light is known too. */
static void light_past_a_sphere(void **state)
{
    (void)state;
    gtx_asset *round = fixture_sphere(1, 64, 16), *flat = fixture_flat(0.5, 16);
    gtx_caster *ball = caster_of(round), *plane = caster_of(flat);
    for (float h = 1.5f; h < 5; h += 0.5f) {
        gtx_scene *scene = ball_over_plane(ball, plane, h);
        gtx_lit_point under = {{0, 0, 0}, {0, 0, 1}, 0.3f};
        const gtx_light_desc sky = {.rays = 4000, .offset = 0.01f}, hard = {.direction = {0, 0, 2}},
                             near = {.rays = 4000, .reach = h - 1.05f};
        /* A disc of twice the sphere's tangent: a quarter of it is hidden. */
        const gtx_light_desc disc = {.direction = {0, 0, 1}, .rays = 4000,
                                     .offset = 0.01f, .spread = 2 / sqrtf(h * h - 1)};
        float share, again;
        gtx_scene_light(scene, &sky, &under, &share, 1);
        assert_float_equal(share, 1 - 1 / (h * h), 0.01);
        gtx_scene_light(scene, &sky, &under, &again, 1);
        assert_true(share == again);
        gtx_scene_light(scene, &near, &under, &share, 1);
        assert_float_equal(share, 1, 0);
        gtx_scene_light(scene, &disc, &under, &share, 1);
        assert_float_equal(share, 0.75, 0.01);
        gtx_scene_light(scene, &hard, &under, &share, 1);
        assert_float_equal(share, 0, 0);
        under.position[0] = 1.02f;
        gtx_scene_light(scene, &hard, &under, &share, 1);
        assert_float_equal(share, 1, 0);
        under.normal[2] = -1; /* the light is under its horizon */
        gtx_scene_light(scene, &hard, &under, &share, 1);
        assert_float_equal(share, 0, 0);
        gtx_scene_destroy(scene);
    }
    gtx_caster_destroy(ball);
    gtx_caster_destroy(plane);
    gtx_close(round);
    gtx_close(flat);
}

static void striped(const gtx_patch *patch, double x, double y, const void *user,
                    fixture_texel *out)
{
    (void)patch;
    (void)user;
    (void)y;
    out->height = 0.5;
    out->trim = -5;
    const uint8_t bright = (int)x & 1 ? 255 : 0;
    memcpy(out->color, (uint8_t[4]){bright, 188, 0, 255}, 4);
}

static void colours_mix_as_light_does(void **state)
{
    (void)state;
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 16, 16, 1, 1), striped, NULL};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 1);
    gtx_info info;
    gtx_get_info(asset, &info);
    assert_int_equal(info.has_color, 1);
    gtx_hit hits[4] = {{.x = 3, .y = 2.5f}, {.x = 3.25f, .y = 2}, {.x = 99, .y = -4},
                       {.patch = UINT32_MAX}};
    float colors[4][4];
    assert_int_equal(gtx_hit_colors(asset, hits, colors, 4), GTX_OK);
    assert_float_equal(colors[0][0], 1, 1e-6);
    assert_float_equal(colors[0][1], 0.5029, 1e-3); /* of 188 */
    assert_float_equal(colors[1][0], 0.75, 1e-6);
    assert_float_equal(colors[2][0], 1, 1e-6); /* the nearest texel */
    assert_float_equal(colors[3][2], 1, 0);
    hits[0].patch = 1;
    assert_int_equal(gtx_hit_colors(asset, hits, colors, 4), GTX_ERROR_ARGUMENT);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_acne_on_a_sphere),
        cmocka_unit_test(no_acne_on_stairs),
        cmocka_unit_test(light_past_a_sphere),
        cmocka_unit_test(colours_mix_as_light_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
