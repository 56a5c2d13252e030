/* The beginning of a file is drawn by what is there of it: LOD meshes, and colours. */
#include "pictures.h"

/* Opens so many first bytes, and draws them as AUTO has it. */
static void draw_prefix(stage *s, const uint8_t *data, size_t size, const gtx_view *view,
                        gtx_prefix *prefix, picture *out)
{
    gtx_asset *asset = NULL;
    gtx_error error = {0};
    must(gtx_open_prefix(data, size, NULL, prefix, &asset, &error), &error);
    assert_non_null(asset);
    subject shown = subject_open(s, asset);
    draw(s, view, GTX_METHOD_AUTO, &shown.instance, 1, out);
    subject_close(s, &shown);
}

/* From the coarsest LOD mesh to the whole: no stage has a hole, and once colours are there hardly
 * anything changes. */
static void stages_come_nearer(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *asset = with_lod(fixture_sphere(radius, TEXELS, 8), radius, LOD_LEVELS, 0);
    gtx_camera camera = camera_around(asset);
    gtx_view view = view_of(&camera);
    view.viewport_width = STAGE_WIDTH;
    view.viewport_height = STAGE_HEIGHT;
    void *data;
    size_t size;
    assert_int_equal(gtx_encode(asset, NULL, &data, &size, NULL), GTX_OK);
    gtx_close(asset);
    gtx_prefix prefix;
    draw_prefix(s, data, size, &view, &prefix, &first);
    assert_int_equal(prefix.needed, 0);
    size_t at = 0;
    double before = 1e9;
    while (at < size) {
        gtx_asset *part;
        assert_int_equal(gtx_open_prefix(data, at, NULL, &prefix, &part, NULL), GTX_OK);
        if (part)
            draw_prefix(s, data, at, &view, &prefix, &second);
        gtx_close(part);
        assert_true(prefix.needed > at);
        at = prefix.needed;
        if (!part)
            continue;
        const difference d = compare(&first, &second);
        if ((double)d.both < 0.95 * (double)d.either || d.holes)
            fail_msg("%zu bytes: %ld of %ld pixels, %ld holes", at, d.both, d.either, d.holes);
        before = d.mean;
    }
    if (before > 1)
        fail_msg("with all colours, these differ by %g", before);
    free(data);
}

/* Casting and grids have nothing to show of it, and editing one patch ends nothing. */
static void heights_are_not_there(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *asset = with_lod(fixture_sphere(radius, TEXELS, 8), radius, LOD_LEVELS, 0), *part;
    void *data;
    size_t size;
    gtx_prefix prefix;
    assert_int_equal(gtx_encode(asset, NULL, &data, &size, NULL), GTX_OK);
    assert_int_equal(gtx_open_prefix(data, size - 64, NULL, &prefix, &part, NULL), GTX_OK);
    assert_int_equal(prefix.needed, size);
    gtx_camera camera = camera_around(asset);
    gtx_view view = view_of(&camera);
    gtx_close(asset);
    subject shown = subject_open(s, part);
    draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &first);
    for (int method = 0; method < 2; ++method) {
        draw(s, &view, method ? GTX_METHOD_GRID : GTX_METHOD_CAST, &shown.instance, 1, &second);
        const difference d = compare(&first, &second);
        assert_true(d.either > 1500);
        assert_int_equal(d.both, 0);
    }
    subject_close(s, &shown);
    free(data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(stages_come_nearer),
                                       cmocka_unit_test(heights_are_not_there)};
    return cmocka_run_group_tests_name("prefix", tests, open_stage, stage_close);
}
