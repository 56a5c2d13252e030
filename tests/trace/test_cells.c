/* The cells that rays visit against what gtx_ray_cells says: never more, and where patches are
 * stacked hardly less; and what is refused for it. */
#include "scenes.h"

#include "common/mad.h"
#include "trace/caster.h"

/* The most that any ray of a pattern visits: along the axes and askew, through and past. */
static uint64_t most_visited(const gtx_asset *asset)
{
    const gtx_caster_desc desc = {.limits.cells = UINT64_MAX};
    gtx_caster *caster;
    gtx_info info;
    uint64_t most = 0, seed = 1;
    assert_int_equal(gtx_caster_create(asset, &desc, &caster, NULL), GTX_OK);
    gtx_get_info(asset, &info);
    const gtx_patch *first = gtx_patches(asset);
    const double height = first->origin[2] + first->extent_z / 2.0;
    for (int i = 0; i < 4000; ++i) {
        gtx_line line = {.t_max = INFINITY};
        for (int k = 0; k < 3; ++k) {
            const double low = info.bounds_min[k], size = info.bounds_max[k] - low;
            const double to = k == 2 && i % 2 ? height : low + uniform(&seed) * size;
            line.origin[k] = low + (3 * uniform(&seed) - 1) * size;
            if (k == 2 && i % 2) /* skims the patches */
                line.origin[k] = height;
            line.direction[k] = to - line.origin[k];
        }
        const gtx_crossing crossing = gtx_cast_line(caster, &line, i % 3 ? GTX_RAY_TWO_SIDED : 0);
        most = crossing.visited > most ? crossing.visited : most;
    }
    gtx_caster_destroy(caster);
    return most;
}

static void expect_bound(gtx_asset *asset, double share)
{
    const uint64_t bound = gtx_ray_cells(asset), most = most_visited(asset);
    if (most > bound || (double)most < share * (double)bound)
        fail_msg("%llu cells visited, at most %llu", (unsigned long long)most,
                 (unsigned long long)bound);
    gtx_close(asset);
}

static void no_ray_visits_more(void **state)
{
    (void)state;
    expect_bound(fixture_sphere(2, 64, 8), 0.01);
    expect_bound(fixture_bumpy(16, GTX_PATCH_TWO_SIDED), 0.1);
    expect_bound(mad_asset(1, 256, MAD_STACK, MAD_GAUZE), 0.5);
    expect_bound(mad_asset(100, 32, MAD_STACK, MAD_GAUZE), 0.5);
    expect_bound(mad_asset(3000, 2, MAD_STACK, MAD_GAUZE), 0.1);
    expect_bound(mad_asset(400, 16, MAD_SHEET, MAD_GAUZE), 0.05);
    expect_bound(mad_asset(1, 512, MAD_STACK, MAD_NEEDLES), 0);
}

/* A stack adds up; what lies side by side does not, for no ray meets it all. */
static void only_what_is_crowded_adds_up(void **state)
{
    (void)state;
    gtx_asset *stack = mad_asset(400, 16, MAD_STACK, MAD_GAUZE);
    gtx_asset *sheet = mad_asset(400, 16, MAD_SHEET, MAD_GAUZE);
    const uint64_t sum = 400 * (16 + 16);
    assert_int_equal(gtx_ray_cells(stack), sum);
    assert_in_range(gtx_ray_cells(sheet), 20 * (16 + 16), sum / 2);
    assert_int_equal(gtx_ray_cells(NULL), 0);
    gtx_close(stack);
    gtx_close(sheet);
}

static void crowds_are_refused(void **state)
{
    (void)state;
    gtx_asset *asset = mad_asset(400, 16, MAD_STACK, MAD_GAUZE);
    const uint64_t cells = gtx_ray_cells(asset);
    gtx_caster *caster = NULL;
    gtx_error error = {0};
    const gtx_caster_desc less = {.limits.cells = cells - 1}, enough = {.limits.cells = cells};
    assert_int_equal(gtx_caster_create(asset, &less, &caster, &error), GTX_ERROR_LIMIT);
    assert_string_equal(error.limit, "cells");
    assert_null(caster);
    assert_int_equal(gtx_caster_create(asset, &enough, &caster, &error), GTX_OK);
    gtx_caster_destroy(caster);
    const gtx_caster_desc dirty = {.limits.reserved = {0, 1}};
    assert_int_equal(gtx_caster_create(asset, &dirty, &caster, NULL), GTX_ERROR_NOT_ZEROED);
    gtx_close(asset);
}

/* 65,535 patches in one place are more than is taken unasked. */
static void mad_stacks_are_refused_by_default(void **state)
{
    (void)state;
    gtx_asset *asset = mad_asset(65535, 8, MAD_STACK, MAD_GAUZE);
    gtx_caster *caster;
    gtx_error error = {0};
    assert_int_equal(gtx_caster_create(asset, NULL, &caster, &error), GTX_ERROR_LIMIT);
    assert_string_equal(error.limit, "cells");
    gtx_close(asset);
}

/* All that a caster takes is allowed before it is taken, and is not much less than what is said. */
static void memory_is_refused_before_it_is_taken(void **state)
{
    (void)state;
    gtx_asset *asset = mad_asset(400, 16, MAD_STACK, MAD_GAUZE);
    gtx_caster *caster = NULL;
    counter c = {1000000, 0};
    const gtx_allocator hooks = {counted_alloc, counted_free, &c};
    gtx_caster_desc desc = {.allocator = &hooks};
    assert_int_equal(gtx_caster_create(asset, &desc, &caster, NULL), GTX_OK);
    const uint64_t kept = (uint64_t)c.bytes;
    gtx_caster_destroy(caster);
    desc.limits.memory = kept / 2;
    gtx_error error = {0};
    assert_int_equal(gtx_caster_create(asset, &desc, &caster, &error), GTX_ERROR_LIMIT);
    assert_string_equal(error.limit, "memory");
    desc.limits.memory = 2 * kept;
    assert_int_equal(gtx_caster_create(asset, &desc, &caster, &error), GTX_OK);
    gtx_caster_destroy(caster);
    assert_int_equal(c.bytes, 0);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_ray_visits_more),
        cmocka_unit_test(only_what_is_crowded_adds_up),
        cmocka_unit_test(crowds_are_refused),
        cmocka_unit_test(mad_stacks_are_refused_by_default),
        cmocka_unit_test(memory_is_refused_before_it_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
