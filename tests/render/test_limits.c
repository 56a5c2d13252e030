/* What models and sets of rays may take: known before it is taken, and refused by limits. */
#include "frame/model.h"
#include "lods.h"

#include "common/mad.h"

/* Hooks that know the most that was taken at once. */
typedef struct ledger {
    uint64_t now, most;
} ledger;

static void *ledger_alloc(size_t size, void *user)
{
    ledger *l = user;
    l->now += size;
    l->most = l->now > l->most ? l->now : l->most;
    return malloc(size);
}

static void ledger_free(void *memory, size_t size, void *user)
{
    ((ledger *)user)->now -= size;
    free(memory);
}

static void check_memory(gtx_asset *asset)
{
    for (uint32_t borrow = 0; borrow < 2; ++borrow) {
        ledger l = {0, 0};
        const gtx_allocator hooks = {ledger_alloc, ledger_free, &l};
        const gtx_model_desc desc = {.allocator = &hooks, .borrow = borrow};
        const uint64_t said = gtx_model_memory(asset, &desc);
        gtx_model *model;
        gtx_error error = {0};
        must(gtx_model_prepare(asset, &desc, &model, &error), &error);
        gtx_model_destroy(NULL, model);
        assert_int_equal(l.now, 0);
        if (l.most > said || l.most < said / 8)
            fail_msg("%llu bytes taken, %llu said", (unsigned long long)l.most,
                     (unsigned long long)said);
        l.most = 0;
        const gtx_model_desc less = {.allocator = &hooks, .borrow = borrow,
                                     .limits.memory = said - 1};
        assert_int_equal(gtx_model_prepare(asset, &less, &model, &error), GTX_ERROR_LIMIT);
        assert_string_equal(error.limit, "memory");
        assert_null(model);
        assert_int_equal(l.most, 0);
    }
    gtx_close(asset);
}

static void memory_is_known_before(void **state)
{
    (void)state;
    check_memory(fixture_sphere(2, 64, 8));
    check_memory(fixture_bumpy(16, GTX_PATCH_TWO_SIDED));
    check_memory(with_lod(fixture_sphere(2, 48, 8), 2, 2, 0));
    check_memory(mad_asset(3000, 2, MAD_SHEET, MAD_GAUZE));
    check_memory(mad_asset(100, 32, MAD_STACK, MAD_RIDGES));
    check_memory(mad_asset(1, 1024, MAD_STACK, MAD_NEEDLES));
}

static void crowds_are_refused(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *asset = mad_asset(65535, 8, MAD_STACK, MAD_GAUZE);
    gtx_model *model;
    gtx_rays *rays;
    gtx_error error = {0};
    assert_int_equal(gtx_model_create(s->renderer, asset, &model, &error), GTX_ERROR_LIMIT);
    assert_string_equal(error.limit, "cells");
    const gtx_asset *const list[] = {asset};
    gtx_rays_desc desc = {.assets = list, .asset_count = 1, .max_instances = 1};
    assert_int_equal(gtx_rays_create(s->renderer, &desc, &rays, &error), GTX_ERROR_LIMIT);
    assert_string_equal(error.limit, "cells");
    desc.limits = (gtx_limits){.cells = UINT64_MAX, .memory = 10000000};
    assert_int_equal(gtx_rays_create(s->renderer, &desc, &rays, &error), GTX_ERROR_LIMIT);
    assert_string_equal(error.limit, "memory");
    gtx_close(asset);
}

static void reserved_limits_must_be_zero(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *asset = fixture_flat(0.5, 8);
    const gtx_asset *const list[] = {asset};
    gtx_model *model;
    gtx_rays *rays;
    const gtx_model_desc a = {.limits.reserved = {1}};
    const gtx_rays_desc b = {list, 1, .limits.reserved = {0, 1}};
    assert_int_equal(gtx_model_prepare(asset, &a, &model, NULL), GTX_ERROR_NOT_ZEROED);
    assert_int_equal(gtx_rays_create(s->renderer, &b, &rays, NULL), GTX_ERROR_NOT_ZEROED);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_is_known_before),
        cmocka_unit_test(crowds_are_refused),
        cmocka_unit_test(reserved_limits_must_be_zero),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
