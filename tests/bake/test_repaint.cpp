/* Maps made anew from level 0, which stays as it was painted; normals of heights; outlines. */
#include <cstdarg>
#include <csetjmp>
#include <cstddef>
#include <cstdint>

extern "C" {
#include <cmocka.h>
}

#include "bake/repaint.hpp"

#include "asset/patch.h"

#include <cmath>

using namespace gtx;

static constexpr uint32_t SIDE = 256, MIPS = 3;

/* One page that is one patch, turned in space. */
struct Page {
    gtx_patch patch = {};
    Vector<uint8_t> texels[MAP_COUNT][MIPS];
    PageMaps maps;

    Page()
    {
        const float c = std::cos(0.7f), s = std::sin(0.7f);
        const float x[] = {c, s, 0}, y[] = {-s * c, c * c, s}, z[] = {s * s, -s * c, c};
        for (int k = 0; k < 3; ++k) {
            patch.axis_x[k] = x[k];
            patch.axis_y[k] = y[k];
            patch.axis_z[k] = z[k];
        }
        patch.extent_x = patch.extent_y = float(SIDE);
        patch.extent_z = 253; /* a step of a height is a texel */
        patch.rect[2] = patch.rect[3] = SIDE;
        patch.dilation = 2;
        maps.width = maps.height = SIDE;
        maps.mip_count = MIPS;
        maps.bits = 8;
        for (int map = 0; map < MAP_COUNT; ++map)
            for (uint32_t k = 0; k < (map >= GTX_MAP_NORMAL ? MIPS : 1); ++k) {
                texels[map][k].assign(size_t(SIDE >> k) * (SIDE >> k) * MAP_TEXEL[map], 1);
                maps.levels[map][k] = texels[map][k].data();
            }
    }
};

static constexpr unsigned ALL = 1 << GTX_MAP_NORMAL | 1 << GTX_MAP_COLOR | 1 << GTX_MAP_MATERIAL |
                                1 << GTX_MAP_EMISSION;

/* Every code of a normal, and every byte of the others. */
static void what_was_painted_stays(void **)
{
    Page page;
    for (uint32_t t = 0; t < SIDE * SIDE; ++t) {
        page.texels[GTX_MAP_NORMAL][0][2 * t] = uint8_t(t);
        page.texels[GTX_MAP_NORMAL][0][2 * t + 1] = uint8_t(t >> 8);
        for (int map = GTX_MAP_COLOR; map < MAP_COUNT; ++map)
            for (uint32_t k = 0; k < MAP_TEXEL[map]; ++k)
                page.texels[map][0][MAP_TEXEL[map] * t + k] = uint8_t(t * (k + 1));
    }
    Vector<uint8_t> before[MAP_COUNT];
    for (int map = 0; map < MAP_COUNT; ++map)
        before[map] = page.texels[map][0];
    repaint_levels(page.maps, page.patch, ALL, false);
    for (int map = 0; map < MAP_COUNT; ++map)
        assert_memory_equal(page.texels[map][0].data(), before[map].data(), before[map].size());
    const uint8_t *coarse = page.texels[GTX_MAP_MATERIAL][1].data();
    assert_int_equal(coarse[0], 1); /* the mean of 0, 1, 0 and 1, rounded */
    assert_int_equal(coarse[4], 3); /* of 2, 3, 2 and 3 */
}

/* Maps that were not asked for stay, levels and all. */
static void others_stay(void **)
{
    Page page;
    repaint_levels(page.maps, page.patch, 1 << GTX_MAP_COLOR, false);
    assert_int_equal(page.texels[GTX_MAP_NORMAL][1][0], 1);
    assert_int_equal(page.texels[GTX_MAP_COLOR][1][0], 1);
    page.texels[GTX_MAP_COLOR][0].assign(page.texels[GTX_MAP_COLOR][0].size(), 200);
    page.maps.levels[GTX_MAP_COLOR][0] = page.texels[GTX_MAP_COLOR][0].data();
    repaint_levels(page.maps, page.patch, 1 << GTX_MAP_COLOR, false);
    assert_int_equal(page.texels[GTX_MAP_COLOR][2][0], 200);
    assert_int_equal(page.texels[GTX_MAP_MATERIAL][1][0], 1);
}

/* A slope of a texel a texel along x: 45 degrees. */
static void normals_are_those_of_heights(void **)
{
    Page page;
    for (uint32_t t = 0; t < SIDE * SIDE; ++t)
        page.texels[GTX_MAP_HEIGHT][0][t] = uint8_t(std::min(1 + t % SIDE, 255u));
    repaint_levels(page.maps, page.patch, 1 << GTX_MAP_NORMAL, true);
    for (uint32_t k = 0; k < MIPS; ++k) {
        float n[3];
        const size_t middle = size_t(SIDE >> k) * (SIDE >> k) / 2 + (SIDE >> k) / 2;
        gtx_decode_normal(&page.texels[GTX_MAP_NORMAL][k][2 * middle], n);
        float rows[3][3], along = 0, up = 0;
        gtx_normal_frame(&page.patch, rows);
        for (int j = 0; j < 3; ++j)
            for (int a = 0; a < 3; ++a) {
                along += n[j] * rows[j][a] * page.patch.axis_x[a];
                up += n[j] * rows[j][a] * page.patch.axis_z[a];
            }
        assert_true(std::fabs(along + std::sqrt(0.5f)) < 0.01f);
        assert_true(std::fabs(up - std::sqrt(0.5f)) < 0.01f);
    }
}

/* Half of the texels lose their height: the outline runs along the last cells that have theirs. */
static void outlines_are_those_of_cells(void **)
{
    Page page;
    for (uint32_t t = 0; t < SIDE * SIDE; ++t)
        page.texels[GTX_MAP_HEIGHT][0][t] = t % SIDE < SIDE / 2;
    repaint_trim(page.maps, page.patch);
    const uint8_t *row = page.texels[GTX_MAP_TRIM][0].data() + SIDE * SIDE / 2;
    assert_int_equal(row[SIDE / 2 - 1], 128);      /* on it */
    assert_int_equal(row[SIDE / 2 - 2], 128 - 16); /* a texel inside */
    assert_true(row[SIDE / 2] > 128);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(what_was_painted_stays),
        cmocka_unit_test(others_stay),
        cmocka_unit_test(normals_are_those_of_heights),
        cmocka_unit_test(outlines_are_those_of_cells),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
