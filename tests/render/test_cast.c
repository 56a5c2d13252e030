/* What is drawn against gtx_raycast, pixel by pixel and at every level: no wrong ray. */
#include "oracle.h"

typedef enum shape { FLAT, BUMPY, BUMPY_TWO_SIDED, SPHERE, HIGH } shape;

static gtx_asset *build(shape which, uint32_t height_bits)
{
    switch (which) {
    case FLAT: return fixture_flat(0.5, height_bits);
    case BUMPY: return fixture_bumpy(height_bits, 0);
    case BUMPY_TWO_SIDED: return fixture_bumpy(height_bits, GTX_PATCH_TWO_SIDED);
    case SPHERE: return fixture_sphere(2, 64, height_bits);
    case HIGH: return fixture_sphere(2, 552, height_bits); /* 3,312 rows: GTX_HIGH_PAGE */
    }
    return NULL;
}

static void check_shape(stage *s, shape which, uint32_t height_bits)
{
    subject shown = subject_open(s, build(which, height_bits));
    const float angles[][2] = {{27, 33}, {0, 90}, {118, 12}, {200, -40}, {0, 0}};
    const size_t views = which == HIGH ? 1 : sizeof angles / sizeof *angles;
    gtx_info info;
    gtx_get_info(shown.asset, &info);
    gtx_texture cells;
    assert_true(gtx_model_texture(shown.model, GTX_SLOT_CELLS, &cells));
    assert_in_range(cells.height, info.page_height, 8192);
    for (size_t i = 0; i < views; ++i)
        for (uint32_t level = 0; level < info.mip_count; ++level) {
            gtx_camera camera = camera_around(shown.asset);
            camera.azimuth = angles[i][0];
            camera.elevation = angles[i][1];
            camera.orthographic = (i + level) % 2 == 0;
            gtx_view view = view_of(&camera);
            view.level = level + 1;
            expect_agreement(s, &shown, &view, which >= SPHERE ? 4000 : 0);
            by_tiles(&view);
            expect_agreement(s, &shown, &view, which >= SPHERE ? 4000 : 0);
        }
    subject_close(s, &shown);
}

static void flat(void **state)
{
    STAGE_OR_SKIP(state);
    check_shape(s, FLAT, 8);
    check_shape(s, FLAT, 16);
}

static void bumpy(void **state)
{
    STAGE_OR_SKIP(state);
    check_shape(s, BUMPY, 8);
    check_shape(s, BUMPY, 16);
}

static void two_sided(void **state)
{
    STAGE_OR_SKIP(state);
    check_shape(s, BUMPY_TWO_SIDED, 8);
}

static void sphere(void **state)
{
    STAGE_OR_SKIP(state);
    check_shape(s, SPHERE, 8);
    check_shape(s, SPHERE, 16);
}

static void a_high_page(void **state)
{
    STAGE_OR_SKIP(state);
    check_shape(s, HIGH, 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flat),
        cmocka_unit_test(bumpy),
        cmocka_unit_test(two_sided),
        cmocka_unit_test(sphere),
        cmocka_unit_test(a_high_page),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
