/* Scenes: bad ones, instances against single casters, shadows and occlusion against what is known
 * of spheres and planes, and what stands on a surface. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "common/counter.h"
#include "common/fixture.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static double uniform(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static gtx_caster *caster_of(const gtx_asset *asset)
{
    gtx_caster *caster = NULL;
    assert_int_equal(gtx_caster_create(asset, NULL, &caster, NULL), GTX_OK);
    return caster;
}

static gtx_scene *scene_of(const gtx_scene_instance *instances, uint32_t count)
{
    gtx_scene *scene = NULL;
    gtx_error error = {0};
    if (gtx_scene_create(instances, count, NULL, &scene, &error))
        fail_msg("%s", error.message);
    return scene;
}

static gtx_scene_instance placed(const gtx_caster *caster, const float transform[16])
{
    gtx_scene_instance out = {.caster = caster};
    memcpy(out.transform, transform, sizeof out.transform);
    return out;
}

static void bad_scenes_are_refused(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_caster *caster = caster_of(asset);
    gtx_scene *scene = NULL;
    gtx_scene_instance bad[6];
    for (int i = 0; i < 6; ++i)
        bad[i] = placed(i ? caster : NULL, identity);
    bad[1].transform[0] = 0;
    bad[2].transform[15] = 2;
    bad[3].transform[3] = 1;
    bad[4].transform[12] = NAN;
    bad[5].transform[5] = 1e-45f; /* the inverse is not finite */
    for (int i = 0; i < 6; ++i)
        assert_int_equal(gtx_scene_create(&bad[i], 1, NULL, &scene, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_scene_create(NULL, 1, NULL, &scene, NULL), GTX_ERROR_ARGUMENT);
    assert_null(scene);
    gtx_scene_destroy(NULL);

    scene = scene_of(NULL, 0); /* an empty one is fine */
    const gtx_ray ray = {.origin = {1, 1, 8}, .direction = {0, 0, -1}};
    gtx_hit hit;
    uint32_t which = 0;
    assert_int_equal(gtx_scene_raycast(scene, &ray, &hit, &which, 1, 0), GTX_OK);
    assert_true(isinf(hit.t) && which == UINT32_MAX);
    assert_int_equal(gtx_scene_raycast(scene, &ray, NULL, &which, 1, 0), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_scene_raycast(scene, &ray, &hit, &which, 1, 8), GTX_ERROR_ARGUMENT);

    const gtx_light_desc lights[] = {{.spread = -1}, {.spread = NAN}, {.reach = -1},
                                     {.offset = INFINITY}, {.direction = {NAN, 0, 0}}};
    gtx_lit_point point = {.normal = {0, 0, 1}};
    float share;
    for (size_t i = 0; i < sizeof lights / sizeof *lights; ++i)
        assert_int_equal(gtx_scene_light(scene, &lights[i], &point, &share, 1),
                         GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_scene_light(scene, &(gtx_light_desc){.reserved = {1}}, &point, &share, 1),
                     GTX_ERROR_NOT_ZEROED);
    assert_int_equal(gtx_scene_light(scene, &(gtx_light_desc){0}, &point, &share, 1), GTX_OK);
    assert_float_equal(share, 1, 0);
    gtx_scene_destroy(scene);
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

static void memory_may_run_out(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_caster *caster = caster_of(asset);
    const gtx_scene_instance two[2] = {placed(caster, identity), placed(caster, identity)};
    for (long n = 0;; ++n) {
        counter c = {n, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        gtx_scene *scene = NULL;
        const gtx_result result = gtx_scene_create(two, 2, &hooks, &scene, NULL);
        c.until_failure = -1;
        gtx_scene_destroy(scene);
        assert_int_equal(c.bytes, 0);
        if (!result) {
            assert_true(n > 3);
            break;
        }
        assert_int_equal(result, GTX_ERROR_MEMORY);
        assert_null(scene);
    }
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

/* Turned, mirrored, scaled unevenly, and far away. */
static void random_transform(uint64_t *seed, float out[16])
{
    memcpy(out, identity, sizeof identity);
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            out[4 * c + r] = (float)((c == r) + 0.8 * (uniform(seed) - 0.5));
    if (uniform(seed) < 0.5)
        for (int r = 0; r < 3; ++r)
            out[r] = -out[r];
    for (int r = 0; r < 3; ++r)
        out[12 + r] = (float)(20 * (uniform(seed) - 0.5));
}

/* Each ray finds what the nearest of single scenes finds. */
static void a_crowd_agrees_with_each_alone(void **state)
{
    (void)state;
    enum { COUNT = 12, RAYS = 20000 };
    gtx_asset *ball = fixture_sphere(1.5, 48, 8), *bumpy = fixture_bumpy(8, GTX_PATCH_TWO_SIDED);
    gtx_caster *casters[2] = {caster_of(ball), caster_of(bumpy)};
    gtx_scene_instance instances[COUNT];
    gtx_scene *alone[COUNT];
    uint64_t seed = 3;
    for (int i = 0; i < COUNT; ++i) {
        float transform[16];
        random_transform(&seed, transform);
        instances[i] = placed(casters[i & 1], transform);
        alone[i] = scene_of(&instances[i], 1);
    }
    gtx_scene *crowd = scene_of(instances, COUNT);
    int hits = 0;
    for (int i = 0; i < RAYS; ++i) {
        gtx_ray ray = {.t_max = 0};
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = (float)(60 * (uniform(&seed) - 0.5));
            ray.direction[k] = (float)(20 * (uniform(&seed) - 0.5)) - ray.origin[k];
        }
        gtx_hit hit, best = {.t = INFINITY, .patch = UINT32_MAX}, any;
        uint32_t which, expected = UINT32_MAX, other;
        gtx_scene_raycast(crowd, &ray, &hit, &which, 1, 0);
        gtx_scene_raycast(crowd, &ray, &any, &other, 1, GTX_RAY_ANY);
        for (uint32_t k = 0; k < COUNT; ++k) {
            gtx_hit one;
            gtx_scene_raycast(alone[k], &ray, &one, NULL, 1, 0);
            if (one.t < best.t) {
                best = one;
                expected = k;
            }
        }
        assert_int_equal(which, expected);
        assert_memory_equal(&hit, &best, sizeof hit);
        assert_true((other == UINT32_MAX) == (which == UINT32_MAX) && any.t >= hit.t);
        hits += which != UINT32_MAX;
        if (which != UINT32_MAX) { /* what is seen faces the ray, in the world */
            double facing = 0, length = 0;
            for (int k = 0; k < 3; ++k) {
                facing += (double)hit.facet[k] * ray.direction[k];
                length += (double)hit.facet[k] * hit.facet[k];
            }
            assert_true(hit.back ? facing > 0 : facing < 0);
            assert_float_equal(length, 1, 1e-5);
        }
    }
    assert_true(hits > RAYS / 10);
    gtx_scene_destroy(crowd);
    for (int i = 0; i < COUNT; ++i)
        gtx_scene_destroy(alone[i]);
    for (int i = 0; i < 2; ++i)
        gtx_caster_destroy(casters[i]);
    gtx_close(ball);
    gtx_close(bumpy);
}

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

static void things_stand_on_a_sphere(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 96, 16);
    gtx_caster *caster = caster_of(asset);
    const float up[3] = {0, 0, 4}, none[3] = {0, 0, 0};
    const float points[][3] = {{0, 0, 3}, {0.5f, 0, 1.9f}, {0, 0.5f, 1}, {0, 3, 5}, {0, 0, -1}};
    gtx_hit hits[5];
    assert_int_equal(gtx_drop(caster, up, 0.2f, points, hits, 5, 0), GTX_OK);
    assert_float_equal(hits[0].t, 1, 1e-3);
    assert_float_equal(hits[1].t, 1.9 - sqrt(4 - 0.25), 1e-3); /* a little below the surface */
    assert_true(isinf(hits[2].t)); /* too far below it; the far side is seen from within */
    assert_true(isinf(hits[3].t) && isinf(hits[4].t));
    assert_int_equal(gtx_drop(caster, up, 0, points, hits, 5, GTX_RAY_TWO_SIDED), GTX_OK);
    assert_float_equal(hits[2].t, 1 + sqrt(4 - 0.25), 1e-3);
    assert_float_equal(hits[4].t, 1, 1e-3);
    assert_int_equal(gtx_drop(caster, none, 0, points, hits, 5, 0), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_drop(caster, up, -1, points, hits, 5, 0), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_drop(caster, up, NAN, points, hits, 5, 0), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_drop(caster, up, 0, NULL, hits, 5, 0), GTX_ERROR_ARGUMENT);
    gtx_caster_destroy(caster);
    gtx_close(asset);
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
        cmocka_unit_test(bad_scenes_are_refused),
        cmocka_unit_test(memory_may_run_out),
        cmocka_unit_test(a_crowd_agrees_with_each_alone),
        cmocka_unit_test(no_acne_on_a_sphere),
        cmocka_unit_test(no_acne_on_stairs),
        cmocka_unit_test(light_past_a_sphere),
        cmocka_unit_test(things_stand_on_a_sphere),
        cmocka_unit_test(colours_mix_as_light_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
