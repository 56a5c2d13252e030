/* Casters: rays that degenerate, intervals, levels, and what is refused. */
#include "trace/balls.h"

static void degenerate_rays_hit_nothing(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_caster *caster = caster_of(asset, 0);
    const gtx_ray good = {.origin = {1, 1, 8}, .direction = {0, 0, -1}};
    const float bad[3] = {NAN, INFINITY, -INFINITY};
    assert_int_equal(cast(caster, good, 0).patch, 0);
    for (int flags = 0; flags < 8; ++flags)
        for (int field = 0; field < 8; ++field)
            for (int b = 0; b < 3; ++b) {
                gtx_ray ray = good;
                float value = bad[b];
                memcpy((char *)&ray + 4 * field, &value, 4);
                gtx_hit hit = cast(caster, ray, (uint32_t)flags);
                /* Infinite ends of the interval are intervals. */
                if ((field == 3 && b == 2) || (field == 7 && b > 0))
                    continue;
                assert_int_equal(hit.patch, UINT32_MAX);
                assert_true(isinf(hit.t));
            }
    gtx_ray still = good;
    still.direction[2] = 0;
    assert_int_equal(cast(caster, still, 0).patch, UINT32_MAX);
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

static void extreme_rays_end(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_caster *caster = caster_of(asset, 0);
    const gtx_ray good = {.origin = {1, 1, 8}, .direction = {0, 0, -1}};
    gtx_ray tiny = good, huge = good, far = good;
    tiny.direction[2] = -1e-37f;
    assert_int_equal(cast(caster, tiny, 0).patch, 0);
    huge.direction[2] = -3e38f;
    assert_int_equal(cast(caster, huge, 0).patch, 0);
    far.origin[2] = 1e9f;
    assert_int_equal(cast(caster, far, 0).patch, 0);
    uint64_t seed = 9; /* any finite floats: an answer, whatever it is */
    for (int i = 0; i < 200000; ++i) {
        gtx_ray ray = {.t_max = 0};
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = (float)((uniform(&seed) - 0.5) * pow(10, 76 * uniform(&seed) - 38));
            ray.direction[k] = (float)((uniform(&seed) - 0.5) * pow(10, 76 * uniform(&seed) - 38));
        }
        gtx_hit hit = cast(caster, ray, GTX_RAY_TWO_SIDED);
        assert_false(isnan(hit.t) || isnan(hit.facet[0]) || isnan(hit.normal[0]));
    }
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

static void interval_is_respected(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_caster *caster = caster_of(asset, 0);
    gtx_ray ray = {.origin = {1.01f, 1.02f, 2.5f}, .direction = {0, 0, -1}};
    for (uint32_t flags = 0; flags <= GTX_RAY_EXHAUSTIVE; flags += GTX_RAY_EXHAUSTIVE) {
        ray.t_min = 0;
        ray.t_max = 0;
        assert_float_equal(cast(caster, ray, flags).t, 2, 1e-6f);
        ray.t_max = 1.999f;
        assert_int_equal(cast(caster, ray, flags).patch, UINT32_MAX);
        ray.t_max = 2.001f;
        assert_int_equal(cast(caster, ray, flags).patch, 0);
        ray.t_max = -1;
        ray.t_min = 1.999f;
        assert_int_equal(cast(caster, ray, flags).patch, 0);
        ray.t_min = 2.001f;
        assert_int_equal(cast(caster, ray, flags).patch, UINT32_MAX);
        ray.t_max = 2;
        assert_int_equal(cast(caster, ray, flags).patch, UINT32_MAX);
    }
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

static void any_hit_is_a_hit(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(1, 48, 8);
    gtx_caster *caster = caster_of(asset, 0);
    gtx_info info;
    gtx_get_info(asset, &info);
    uint64_t seed = 3;
    for (int i = 0; i < 20000; ++i) {
        gtx_ray ray = random_ray(&info, &seed);
        gtx_hit any = cast(caster, ray, GTX_RAY_ANY), nearest = cast(caster, ray, 0);
        assert_int_equal(any.patch == UINT32_MAX, nearest.patch == UINT32_MAX);
        assert_true(any.t >= nearest.t);
    }
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

/* Along the direction of projection a coarser level shows all that a finer one does. */
static void coverage_only_grows(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_bumpy(8, 0);
    const gtx_patch *p = gtx_patches(asset);
    gtx_caster *casters[8];
    for (uint32_t level = 0; level < 8; ++level)
        casters[level] = caster_of(asset, level);
    uint64_t seed = 21;
    int hits[8] = {0};
    for (int i = 0; i < 20000; ++i) {
        double a = uniform(&seed) * p->extent_x, b = uniform(&seed) * p->extent_y;
        gtx_ray ray = {.t_max = 0};
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = (float)(p->origin[k] + a * p->axis_x[k] + b * p->axis_y[k] +
                                    9 * p->axis_z[k]);
            ray.direction[k] = -p->axis_z[k];
        }
        int finer = 0;
        for (uint32_t level = 0; level < 8; ++level) {
            int hit = cast(casters[level], ray, 0).patch != UINT32_MAX;
            assert_true(hit >= finer);
            finer = hit;
            hits[level] += hit;
        }
    }
    assert_true(hits[0] > 5000 && hits[7] > hits[0]);
    for (uint32_t level = 0; level < 8; ++level)
        gtx_caster_destroy(casters[level]);
    gtx_close(asset);
}

/* How many of the same rays two casters answer alike, and by how far answers differ at most. */
static int same_answers(const gtx_asset *asset, const gtx_caster *a, const gtx_caster *b, int count,
                        float *farthest)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    uint64_t seed = 33;
    int same = 0;
    *farthest = 0;
    for (int i = 0; i < count; ++i) {
        gtx_ray ray = random_ray(&info, &seed);
        gtx_hit one = cast(a, ray, 0), other = cast(b, ray, 0);
        same += one.patch == other.patch && (one.patch == UINT32_MAX || one.t == other.t);
        if (one.patch == other.patch && one.patch != UINT32_MAX)
            *farthest = fmaxf(*farthest, fabsf(one.t - other.t));
    }
    return same;
}

/* Levels by an error: none allows none but the finest, much the coarsest that has mips. */
static void an_error_chooses_levels(void **state)
{
    (void)state;
    enum { RAYS = 20000 };
    gtx_asset *asset = fixture_sphere(1, 64, 8);
    gtx_info info;
    gtx_get_info(asset, &info);
    assert_true(info.mip_count > 1);
    gtx_caster *finest = caster_of(asset, 0), *coarsest = caster_of(asset, info.mip_count - 1);
    float farthest;
    assert_true(same_answers(asset, finest, coarsest, RAYS, &farthest) < RAYS);
    const struct {
        float error;
        const gtx_caster *like;
    } cases[] = {{1e-9f, finest}, {10, coarsest}};
    for (int i = 0; i < 2; ++i) {
        gtx_caster *chosen = NULL;
        gtx_caster_desc desc = {.max_error = cases[i].error};
        assert_int_equal(gtx_caster_create(asset, &desc, &chosen, NULL), GTX_OK);
        assert_int_equal(same_answers(asset, chosen, cases[i].like, RAYS, &farthest), RAYS);
        gtx_caster_destroy(chosen);
    }
    gtx_caster_destroy(finest);
    gtx_caster_destroy(coarsest);
    gtx_close(asset);
}

static void bad_arguments(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_caster *caster = NULL;
    gtx_error error = {0};
    gtx_caster_desc desc = {.level = 8};
    assert_int_equal(gtx_caster_create(NULL, NULL, &caster, &error), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_caster_create(asset, &desc, &caster, &error), GTX_ERROR_ARGUMENT);
    const float bad_errors[] = {-1, NAN, INFINITY};
    for (int i = 0; i < 3; ++i) {
        desc = (gtx_caster_desc){.max_error = bad_errors[i]};
        assert_int_equal(gtx_caster_create(asset, &desc, &caster, &error), GTX_ERROR_ARGUMENT);
    }
    desc = (gtx_caster_desc){.max_error = 1, .level = 1};
    assert_int_equal(gtx_caster_create(asset, &desc, &caster, &error), GTX_ERROR_ARGUMENT);
    desc = (gtx_caster_desc){.reserved = {0, 0, 1}};
    assert_int_equal(gtx_caster_create(asset, &desc, &caster, &error), GTX_ERROR_NOT_ZEROED);
    assert_null(caster);
    caster = caster_of(asset, 0);
    gtx_hit hit;
    gtx_ray ray = {.direction = {1, 0, 0}};
    assert_int_equal(gtx_raycast(NULL, &ray, &hit, 1, 0), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_raycast(caster, NULL, &hit, 1, 0), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_raycast(caster, &ray, &hit, 1, 64), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_raycast(caster, NULL, NULL, 0, 0), GTX_OK);
    gtx_caster_destroy(caster);
    gtx_caster_destroy(NULL);
    gtx_close(asset);
}

static void memory_may_run_out(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(1, 48, 8);
    counter c = {0};
    const gtx_allocator hooks = {counted_alloc, counted_free, &c};
    gtx_caster *caster = NULL;
    int failures = 0;
    for (;; ++failures) {
        c.until_failure = failures;
        gtx_result result = gtx_caster_create(
            asset, &(gtx_caster_desc){.allocator = &hooks, .level = 1}, &caster, NULL);
        if (result == GTX_OK)
            break;
        assert_int_equal(result, GTX_ERROR_MEMORY);
        assert_null(caster);
        assert_int_equal(c.bytes, 0);
    }
    assert_true(failures > 8);
    gtx_close(asset); /* a caster needs no asset */
    assert_int_equal(cast(caster, (gtx_ray){.origin = {0.1f, 0.2f, 5}, .direction = {0, 0, -1}}, 0)
                         .patch, 4);
    gtx_caster_destroy(caster);
    assert_int_equal(c.bytes, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(degenerate_rays_hit_nothing),
        cmocka_unit_test(extreme_rays_end),
        cmocka_unit_test(interval_is_respected),
        cmocka_unit_test(any_hit_is_a_hit),
        cmocka_unit_test(coverage_only_grows),
        cmocka_unit_test(an_error_chooses_levels),
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
