/* Calls that combine assets: what is refused, filled in, the same twice, and out of memory. */
#include "edit/combined.h"

#include "asset/section.h"

/* A copy without its colours. */
static gtx_asset *bare_copy(gtx_asset *asset)
{
    gtx_asset *out = NULL;
    asset->info.has_color = 0;
    must(gtx_edit_copy_checked(asset, &out, NULL));
    asset->info.has_color = 1;
    return out;
}

static void maps_are_filled_in(void **state)
{
    (void)state;
    gtx_asset *a = fixture_sphere(1, 48, 8), *b = bare_copy(a);
    moved(b, 3, 0, 0);
    const outcome o = combine(a, b, GTX_COMBINE_UNION);
    gtx_info info;
    gtx_get_info(o.asset, &info);
    assert_true(info.has_color && !info.has_material && !info.has_emission);
    assert_true(info.anchor[0] == 0 && info.lod_levels == 0);
    for (uint32_t p = 0; p < info.patch_count; ++p)
        for (uint32_t k = 0; k < info.mip_count; ++k) {
            const gtx_patch *patch = &o.asset->patches[p];
            const uint8_t *texel =
                gtx_edit_texel(o.asset, patch, GTX_SECTION_COLOR, k, 20u >> k, 20u >> k);
            if (p >= 6)
                assert_memory_equal(texel, "\377\377\377\377", 4);
        }
    size_t size;
    const char *meta = gtx_meta(o.asset, &size);
    assert_non_null(meta);
    assert_non_null(strstr(meta, "geotex combine"));
    gtx_close(o.asset);
    gtx_close(a);
    gtx_close(b);
}

static void what_does_not_fit_is_refused(void **state)
{
    (void)state;
    gtx_asset *a = fixture_sphere(1, 48, 8), *open = fixture_sphere_without(1, 48, 8, 1);
    const gtx_combine_desc dirty = {.reserved = {1}}, odd = {.op = (gtx_combine_op)3};
    const gtx_combine_desc few = {.limits = {.patches = 5}}, small = {.limits = {.memory = 9999}};
    gtx_combine_result told;
    gtx_asset *out = NULL;
    refused(NULL, a, NULL, GTX_ERROR_ARGUMENT, "two assets");
    refused(a, NULL, NULL, GTX_ERROR_ARGUMENT, "two assets");
    refused(a, a, &odd, GTX_ERROR_ARGUMENT, "union, intersect or subtract");
    refused(a, a, &dirty, GTX_ERROR_NOT_ZEROED, "");
    refused(a, a, &few, GTX_ERROR_LIMIT, "patches");
    refused(a, a, &small, GTX_ERROR_LIMIT, "");
    refused(a, open, NULL, GTX_ERROR_INPUT, "the second asset: the surface is open");
    refused(open, a, NULL, GTX_ERROR_INPUT, "the first asset: the surface is open");
    const gtx_combine_desc any = {.max_openness = 1};
    must(gtx_combine(a, open, &any, &out, &told, NULL));
    assert_true(told.facts[1].openness > 0.01 && told.facts[0].openness < 0.01);
    gtx_close(out);
    open->info.unit = 2;
    refused(a, open, &any, GTX_ERROR_INPUT, "different units");
    gtx_close(a);
    gtx_close(open);
}

static void bytes_are_the_same_in_any_order(void **state)
{
    (void)state;
    gtx_asset *a = fixture_sphere(1, 48, 8), *b = moved(fixture_sphere(1, 48, 8), 0.5, 0, 0);
    const gtx_jobs jobs = {run_backwards, NULL};
    for (int op = 0; op < 3; ++op) {
        const gtx_combine_desc desc = {.op = (gtx_combine_op)op, .jobs = &jobs};
        const outcome o = combine(a, b, (gtx_combine_op)op);
        gtx_asset *other = NULL;
        void *data[2];
        size_t size[2];
        must(gtx_combine(a, b, &desc, &other, NULL, NULL));
        must(gtx_encode(o.asset, NULL, &data[0], &size[0], NULL));
        must(gtx_encode(other, NULL, &data[1], &size[1], NULL));
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(data[0], data[1], size[0]);
        free(data[0]);
        free(data[1]);
        gtx_close(o.asset);
        gtx_close(other);
    }
    gtx_close(a);
    gtx_close(b);
}

static void memory_may_run_out(void **state)
{
    (void)state;
    gtx_asset *a = fixture_sphere(1, 48, 8), *b = moved(fixture_sphere(1, 48, 8), 0.5, 0, 0);
    gtx_result result = GTX_ERROR_MEMORY;
    for (long i = 0; result; i += 1 + i / 4) {
        counter c = {i, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        const gtx_combine_desc desc = {.op = GTX_COMBINE_SUBTRACT, .allocator = &hooks};
        gtx_asset *out = NULL;
        result = gtx_combine(a, b, &desc, &out, NULL, NULL);
        assert_true(result == GTX_OK || result == GTX_ERROR_MEMORY);
        assert_true((out != NULL) == (result == GTX_OK));
        gtx_close(out);
        assert_int_equal(c.bytes, 0);
        assert_true(i < 2000);
    }
    gtx_close(a);
    gtx_close(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_are_filled_in),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(bytes_are_the_same_in_any_order),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
