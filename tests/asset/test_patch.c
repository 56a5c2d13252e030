/* What codes and records mean, against the numbers of format/gtx.md. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "asset/patch.h"

/* A box of 4 x 2 texels, a unit each, tilted in x; heights of 10. */
static const gtx_patch tilted = {
    .origin = {1, 2, 3}, .extent_x = 4, .extent_y = 2, .extent_z = 10, .axis_x = {0.8f, 0, 0.6f},
    .axis_y = {0, 1, 0}, .axis_z = {0, 0, 1}, .rect = {0, 0, 4, 2}};

static void assert_point(const double found[3], double x, double y, double z)
{
    assert_float_equal(found[0], x, 1e-6);
    assert_float_equal(found[1], y, 1e-6);
    assert_float_equal(found[2], z, 1e-6);
}

static void codes_are_heights_and_back(void **state)
{
    (void)state;
    assert_float_equal(gtx_code_height(1, 8), 0, 0);
    assert_float_equal(gtx_code_height(255, 8), 1, 0);
    assert_float_equal(gtx_code_height(65535, 16), 1, 0);
    for (uint32_t code = 1; code <= 255; ++code)
        assert_int_equal(gtx_nearest_code(gtx_code_height(code, 8) * 254, 8), code);
    assert_int_equal(gtx_nearest_code(-3, 16), 1);
    assert_int_equal(gtx_nearest_code(1e9, 16), 65535);
    assert_int_equal(gtx_nearest_code(NAN, 8), 1);
}

static void trim_is_in_sixteenths_of_texels(void **state)
{
    (void)state;
    for (uint32_t code = 0; code <= 255; ++code)
        assert_int_equal(gtx_nearest_trim((float)gtx_trim_distance(code)), code);
    assert_int_equal(gtx_nearest_trim(-100), 0);
    assert_int_equal(gtx_nearest_trim(100), 255);
    /* The last codes that show, level by level. */
    const uint32_t last[] = {132, 137, 147, 166, 204, 281};
    for (uint32_t level = 0; level < 6; ++level)
        assert_int_equal((uint32_t)gtx_trim_limit(level), last[level]);
}

static void frames_and_points_agree(void **state)
{
    (void)state;
    const gtx_patch_frame frame = gtx_patch_frame_of(&tilted, 8);
    double point[3];
    gtx_texel_point(&tilted, 3, 1, 0.5, point);
    assert_point(point, 1 + 3.5 * 0.8, 2 + 1.5, 3 + 3.5 * 0.6 + 5);
    double grid[3];
    for (int r = 0; r < 3; ++r) {
        grid[r] = frame.to_grid[r][3];
        for (int k = 0; k < 3; ++k)
            grid[r] += frame.to_grid[r][k] * point[k];
    }
    assert_point(grid, 3, 1, 128);
}

static void what_has_codes_is_measured(void **state)
{
    (void)state;
    const uint8_t codes[2][5] = {{0, 1, 0, 255, 9}, {0, 0, 0, 0, 9}};
    gtx_patch patch = tilted;
    const gtx_code_map map = {codes, 5, 1, 8};
    const gtx_patch_span span = gtx_measure_patch(&patch, &map);
    assert_int_equal(span.coded, 2);
    assert_float_equal(patch.coverage, 2. / 8, 1e-6);
    assert_point(span.low, 1 + 1.5 * 0.8, 2.5, 3 + 1.5 * 0.6);
    assert_point(span.high, 1 + 3.5 * 0.8, 2.5, 3 + 3.5 * 0.6 + 10);
    for (int k = 0; k < 3; ++k)
        assert_float_equal(patch.sphere[k], (span.low[k] + span.high[k]) / 2, 1e-6);
    assert_float_equal(patch.sphere[3], sqrt(1.6 * 1.6 + 11.2 * 11.2) / 2, 1e-4);
}

static void empty_patches_keep_their_sphere(void **state)
{
    (void)state;
    const uint8_t codes[2][8] = {{0}};
    gtx_patch patch = tilted;
    patch.sphere[3] = 7;
    const gtx_code_map map = {codes, 4, 2, 16};
    assert_int_equal(gtx_measure_patch(&patch, &map).coded, 0);
    assert_float_equal(patch.coverage, 0, 0);
    assert_float_equal(patch.sphere[3], 7, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(codes_are_heights_and_back),
        cmocka_unit_test(trim_is_in_sixteenths_of_texels),
        cmocka_unit_test(frames_and_points_agree),
        cmocka_unit_test(what_has_codes_is_measured),
        cmocka_unit_test(empty_patches_keep_their_sphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
