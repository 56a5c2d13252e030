/* Preparing in a host's jobs: the same model, byte by byte, and the same errors. No OpenGL. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/fixture.h"
#include "common/runners.h"
#include "frame/model.h"

#include <stdlib.h>
#include <string.h>

static gtx_model *prepare(const gtx_asset *asset, const gtx_jobs *jobs, uint32_t borrow)
{
    const gtx_model_desc desc = {.jobs = jobs, .borrow = borrow};
    gtx_model *model;
    assert_int_equal(gtx_model_prepare(asset, &desc, &model, NULL), GTX_OK);
    return model;
}

static void expect_equal(const gtx_model *a, const gtx_model *b)
{
#define SAME(field, count)                                                                         \
    assert_memory_equal(a->field, b->field, (size_t)(count) * sizeof *a->field)
    const size_t slots = (size_t)a->kind_count * a->patch_count + 1;
    assert_int_equal(a->level_count, b->level_count);
    for (uint32_t i = 0; i < a->level_count; ++i) {
        const gtx_level *l = &a->levels[i];
        assert_int_equal(l->unit, b->levels[i].unit);
        SAME(levels[i].data, gtx_level_size(l));
    }
    SAME(first_vertex, slots);
    SAME(first_index, slots);
    SAME(proxies.vertices, a->first_vertex[slots - 1]);
    SAME(proxies.indices, a->first_index[slots - 1]);
    SAME(first_slab, a->mip_count * a->patch_count + 1);
    SAME(slabs, a->first_slab[a->mip_count * a->patch_count]);
    SAME(blocks, a->first_slab[a->patch_count]);
    SAME(rtins, a->patch_count);
    SAME(first_node, a->patch_count + 1);
    SAME(nodes, a->first_node[a->patch_count]);
    SAME(records, a->patch_count);
    SAME(facts, a->patch_count);
    SAME(sphere, 4);
    assert_int_equal(a->lods.vertex_bytes, b->lods.vertex_bytes);
    assert_int_equal(a->lods.index_bytes, b->lods.index_bytes);
    if (a->lods.level_count) {
        SAME(lods.vertices, a->lods.vertex_bytes / sizeof *a->lods.vertices);
        assert_memory_equal(a->lods.indices, b->lods.indices, a->lods.index_bytes);
    }
    assert_memory_equal(&a->size, &b->size, sizeof a->size);
}

static void expect_alike(gtx_asset *asset)
{
    gtx_model *alone = prepare(asset, NULL, 0);
    for (int i = 0; i < RUNNERS; ++i) {
        runner_log log;
        const gtx_jobs jobs = runner_of(i, &log);
        gtx_model *other = prepare(asset, &jobs, (uint32_t)i);
        assert_int_not_equal(log.runs, 0);
        const bool own = other->levels[2].data != gtx_map_data(asset, GTX_MAP_TRIM, 0, NULL);
        assert_int_equal(own, !i);
        expect_equal(alone, other);
        gtx_model_free(other);
    }
    gtx_model_free(alone);
    gtx_close(asset);
}

static void models_are_the_same(void **state)
{
    (void)state;
    expect_alike(fixture_flat(0.5, 8));
    expect_alike(fixture_bumpy(16, GTX_PATCH_TWO_SIDED));
    expect_alike(fixture_sphere(2, 96, 8));
}

/* Levels of an LOD mesh, and maps that may be absent. */
static void golden_models_are_the_same(void **state)
{
    (void)state;
    static const char *const paths[] = {"tests/golden/good/lod.gtx",
                                        "tests/golden/good/color.gtx",
                                        "tests/golden/good/material.gtx",
                                        "tests/golden/good/two-pages.gtx"};
    for (int i = 0; i < 4; ++i) {
        gtx_asset *asset;
        assert_int_equal(gtx_open_file(paths[i], NULL, &asset, NULL), GTX_OK);
        expect_alike(asset);
    }
}

typedef struct counter {
    long left, live;
} counter;

static void *counted_alloc(size_t size, void *user)
{
    counter *c = user;
    if (c->left-- <= 0)
        return NULL;
    ++c->live;
    return malloc(size);
}

static void counted_free(void *memory, size_t size, void *user)
{
    (void)size;
    --((counter *)user)->live;
    free(memory);
}

/* Jobs after one that failed go on, and the first patch's failure is told. */
static void expect_reports(gtx_asset *asset)
{
    runner_log log;
    const gtx_jobs jobs = runner_of(0, &log);
    gtx_result result = GTX_ERROR_MEMORY;
    for (long n = 0; result; ++n) {
        counter c = {n, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        const gtx_model_desc desc = {.allocator = &hooks, .jobs = &jobs};
        gtx_model *model = NULL;
        gtx_error error = {0};
        result = gtx_model_prepare(asset, &desc, &model, &error);
        if (result) {
            assert_int_equal(result, GTX_ERROR_MEMORY);
            assert_int_equal(error.result, GTX_ERROR_MEMORY);
            assert_null(model);
        }
        gtx_model_free(model);
        assert_int_equal(c.live, 0);
    }
    gtx_close(asset);
}

static void failed_allocations_are_reported(void **state)
{
    (void)state;
    gtx_asset *lod;
    assert_int_equal(gtx_open_file("tests/golden/good/lod.gtx", NULL, &lod, NULL), GTX_OK);
    expect_reports(lod);
    expect_reports(fixture_sphere(2, 48, 8));
}

static void reserved_fields_are_zero(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_model *model = NULL;
    const gtx_model_desc desc = {.reserved = {1}};
    assert_int_equal(gtx_model_prepare(asset, &desc, &model, NULL), GTX_ERROR_NOT_ZEROED);
    assert_null(model);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(models_are_the_same),
                                       cmocka_unit_test(golden_models_are_the_same),
                                       cmocka_unit_test(failed_allocations_are_reported),
                                       cmocka_unit_test(reserved_fields_are_zero)};
    return cmocka_run_group_tests_name("jobs", tests, NULL, NULL);
}
