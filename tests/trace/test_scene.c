/* Scenes: bad ones, instances against single casters, and what stands on a surface. */
#include "trace/scenes.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_scenes_are_refused),
        cmocka_unit_test(memory_may_run_out),
        cmocka_unit_test(a_crowd_agrees_with_each_alone),
        cmocka_unit_test(things_stand_on_a_sphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
