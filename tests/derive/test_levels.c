/* Levels of height fields: their nodes, cells and errors. */
#include "derive/ramps.h"

static void level_0_is_the_map(void **state)
{
    (void)state;
    gtx_asset *asset = make(&RAGGED, 7, 5);
    gtx_grid grid;
    assert_int_equal(gtx_grid_build(asset, 0, 0, NULL, &grid, NULL), GTX_OK);
    assert_int_equal(grid.nodes_x, 7);
    assert_int_equal(grid.nodes_y, 5);
    for (int j = 0; j < 5; ++j)
        for (int i = 0; i < 7; ++i) {
            int digit = RAGGED.rows[j][i] - '0';
            assert_int_equal(grid.code[7 * j + i], digit ? digit + 1 : 0);
        }
    const char *solid = "100001"
                        "010000"
                        "000000"
                        "000000";
    for (int k = 0; k < 24; ++k)
        assert_int_equal(grid.solid[k], solid[k] - '0');
    gtx_grid_free(&grid, NULL);
    gtx_close(asset);
}

static void level_1_follows_the_rule(void **state)
{
    (void)state;
    gtx_asset *asset = make(&RAGGED, 7, 5);
    gtx_grid grid;
    assert_int_equal(gtx_grid_build(asset, 0, 1, NULL, &grid, NULL), GTX_OK);
    assert_int_equal(grid.nodes_x, 4);
    assert_int_equal(grid.nodes_y, 3);
    /* Nodes (0, 0), (3, 0) and (0, 2) have codes of their own. Node (0, 1) at texel (0, 2) is empty
     * and has seven codes of 10 and two of 6 around it, 9.1 in the mean; (3, 1) four of 2 and one
     * of 4, 2.4; (2, 2) a 10 and a 4; (3, 2) the 4. */
    const uint32_t node[7] = {0, 3, 8, 4, 7, 10, 11}, code[7] = {10, 2, 6, 9, 2, 7, 4};
    for (int k = 0; k < 7; ++k)
        assert_int_equal(grid.code[node[k]], code[k]);
    const char *solid = "101"
                        "000";
    for (int k = 0; k < 6; ++k)
        assert_int_equal(grid.solid[k], solid[k] - '0');
    gtx_grid_free(&grid, NULL);
    gtx_close(asset);
}

/* The rule again, in the most literal way. */
static uint32_t literal_code(const gtx_asset *asset, uint32_t i, uint32_t j, uint32_t level)
{
    const gtx_patch *p = gtx_patches(asset);
    int w = p->rect[2], h = p->rect[3], reach = 1 << level;
    int x = (int)fmin((double)(i * (1u << level)), w - 1);
    int y = (int)fmin((double)(j * (1u << level)), h - 1);
    if (gtx_height_code(asset, p, (uint32_t)x, (uint32_t)y))
        return gtx_height_code(asset, p, (uint32_t)x, (uint32_t)y);
    double sum = 0, count = 0;
    for (int b = 0; b < h; ++b)
        for (int a = 0; a < w; ++a) {
            uint32_t code = gtx_height_code(asset, p, (uint32_t)a, (uint32_t)b);
            if (code && abs(a - x) <= reach && abs(b - y) <= reach) {
                sum += code;
                count += 1;
            }
        }
    return level && count > 0 ? (uint32_t)floor(sum / count + 0.5) : 0;
}

static void every_level_follows_the_rule(void **state)
{
    (void)state;
    for (uint32_t bits = 8; bits <= 16; bits += 8) {
        gtx_asset *asset = fixture_bumpy(bits, 0);
        for (uint32_t level = 0; level < 8; ++level) {
            gtx_grid grid, finer;
            assert_int_equal(gtx_grid_build(asset, 0, level, NULL, &grid, NULL), GTX_OK);
            assert_int_equal(gtx_grid_build(asset, 0, 0, NULL, &finer, NULL), GTX_OK);
            assert_int_equal(grid.nodes_x, (uint32_t)ceil(63.0 / (1 << level)) + 1);
            assert_int_equal(grid.nodes_y, (uint32_t)ceil(47.0 / (1 << level)) + 1);
            for (uint32_t j = 0; j < grid.nodes_y; ++j)
                for (uint32_t i = 0; i < grid.nodes_x; ++i)
                    assert_int_equal(grid.code[j * grid.nodes_x + i],
                                     literal_code(asset, i, j, level));
            uint8_t *expected = calloc(63 * 47, 1);
            for (uint32_t y = 0; y < 47; ++y)
                for (uint32_t x = 0; x < 63; ++x)
                    if (finer.solid[y * 63 + x])
                        expected[(y >> level) * (grid.nodes_x - 1) + (x >> level)] = 1;
            for (uint32_t j = 0; j + 1 < grid.nodes_y; ++j)
                for (uint32_t i = 0; i + 1 < grid.nodes_x; ++i) {
                    uint32_t cell = j * (grid.nodes_x - 1) + i, node = j * grid.nodes_x + i;
                    assert_int_equal(grid.solid[cell], expected[cell]);
                    if (grid.solid[cell])
                        assert_true(grid.code[node] && grid.code[node + 1] &&
                                    grid.code[node + grid.nodes_x] &&
                                    grid.code[node + grid.nodes_x + 1]);
                }
            free(expected);
            gtx_grid_free(&grid, NULL);
            gtx_grid_free(&finer, NULL);
        }
        gtx_close(asset);
    }
}

static void no_such_patch_or_level(void **state)
{
    (void)state;
    gtx_asset *asset = make(&RAGGED, 7, 5);
    gtx_grid grid;
    gtx_error error = {0};
    assert_int_equal(gtx_grid_build(asset, 1, 0, NULL, &grid, &error), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_grid_build(asset, 0, 8, NULL, &grid, &error), GTX_ERROR_ARGUMENT);
    assert_true(error.message[0]);
    gtx_grid finest;
    assert_int_equal(gtx_grid_build(asset, 0, 0, NULL, &finest, &error), GTX_OK);
    assert_int_equal(gtx_grid_coarsen(&finest, 0, NULL, &grid, &error), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_grid_coarsen(&finest, 8, NULL, &grid, &error), GTX_ERROR_ARGUMENT);
    gtx_grid_free(&finest, NULL);
    gtx_close(asset);
}

static void cells_hold_their_corners(void **state)
{
    (void)state;
    enum { ROW = 50 }; /* texels; wider than any level */
    for (uint32_t bits = 8; bits <= 16; bits += 8)
        for (uint32_t level = 0; level < 4; ++level) {
            gtx_asset *asset = fixture_sphere(1, 48, bits);
            gtx_grid grid;
            gtx_error error = {0};
            uint32_t solid = 0;
            const size_t size = (size_t)ROW * (48 >> level) * 4 * bits / 8;
            uint8_t *cells = malloc(size);
            memset(cells, 0xaa, size);
            assert_int_equal(gtx_grid_build(asset, 2, level, NULL, &grid, &error), GTX_OK);
            assert_in_range(grid.nodes_x - 1, 1, 48 >> level);
            gtx_grid_cells(&grid, bits, ROW, cells);
            for (uint32_t y = 0; y < 48u >> level; ++y)
                for (uint32_t x = 0; x < ROW; ++x) {
                    const int cell = x + 1 < grid.nodes_x && y + 1 < grid.nodes_y;
                    const int exists = cell && grid.solid[y * (grid.nodes_x - 1) + x];
                    solid += (uint32_t)exists;
                    for (uint32_t k = 0; k < 4; ++k) {
                        const size_t at = 4 * ((size_t)y * ROW + x) + k;
                        const size_t node = (y + (k >> 1)) * grid.nodes_x + x + (k & 1);
                        const uint32_t code = bits == 8 ? cells[at]
                                                        : ((uint16_t *)(void *)cells)[at];
                        if (cell)
                            assert_int_equal(code, exists ? grid.code[node] : 0);
                        else /* left alone */
                            assert_int_equal(code, bits == 8 ? 0xaa : 0xaaaa);
                    }
                }
            assert_true(solid << (2 * level) > 1000);
            free(cells);
            gtx_grid_free(&grid, NULL);
            gtx_close(asset);
        }
}

static uint32_t code_at(const uint8_t *codes, uint32_t bits, size_t at)
{
    return bits == 8 ? codes[at] : ((const uint16_t *)(const void *)codes)[at];
}

/* Level 0 by its nodes, coarser ones by 2 x 2 a cell: of either the four codes are a cell's. */
static void codes_are_those_of_cells(void **state)
{
    (void)state;
    enum { ROW = 50, ROWS = 48 };
    for (uint32_t bits = 8; bits <= 16; bits += 8)
        for (uint32_t level = 0; level < 4; ++level) {
            gtx_asset *asset = fixture_sphere(1, 48, bits);
            gtx_grid grid;
            gtx_error error = {0};
            uint32_t solid = 0;
            const uint32_t step = level ? 2 : 1;
            uint8_t codes[ROW * ROWS * 2] = {0};
            assert_int_equal(gtx_grid_build(asset, 2, level, NULL, &grid, &error), GTX_OK);
            gtx_grid_codes(&grid, bits, ROW, codes);
            for (uint32_t y = 0; y + 1 < grid.nodes_y; ++y)
                for (uint32_t x = 0; x + 1 < grid.nodes_x; ++x) {
                    uint32_t exists = 1;
                    for (uint32_t k = 0; k < 4; ++k) {
                        const size_t at = (size_t)(y * step + (k >> 1)) * ROW + x * step + (k & 1);
                        const size_t node = (y + (k >> 1)) * grid.nodes_x + x + (k & 1);
                        const uint32_t code = code_at(codes, bits, at);
                        assert_true(!code || code == grid.code[node]);
                        exists &= code != 0;
                    }
                    assert_int_equal(exists, grid.solid[y * (grid.nodes_x - 1) + x]);
                    solid += exists;
                }
            assert_true(solid << (2 * level) > 1000);
            gtx_grid_free(&grid, NULL);
            gtx_close(asset);
        }
}

/* A wave along x of eight texels' length, and a ramp with a step at every other texel. */
static void wave(const gtx_patch *patch, double x, double y, const void *user, fixture_texel *out)
{
    static const int codes[8] = {100, 101, 102, 101, 100, 99, 98, 99};
    (void)patch;
    (void)y;
    const int column = (int)x, ramp = 40 + 4 * column + 2 * (column % 2);
    const int code = user ? ramp : codes[column % 8];
    *out = (fixture_texel){(code - 1) / 254.0, -4, {0, 0, 1}, {255, 255, 255, 255}};
}

static void check_errors(const void *ramp, double pitch, const double codes[4])
{
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {.frame = fixture_frame(corner, 32, 24, pitch, 1), .field = wave,
                           .user = ramp};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 4);
    gtx_grid finest, grid;
    assert_int_equal(gtx_grid_build(asset, 0, 0, NULL, &finest, NULL), GTX_OK);
    for (uint32_t level = 0; level < 4; ++level) {
        assert_int_equal(gtx_grid_build(asset, 0, level, NULL, &grid, NULL), GTX_OK);
        const double expected = fmax(codes[level] / 254, 0.3 * ((1 << level) - 1) * pitch);
        const double error = gtx_grid_error(asset, 0, &finest, &grid);
        if (fabs(error - expected) > 1e-6)
            fail_msg("level %u: %g instead of %g", level, error, expected);
        gtx_grid_free(&grid, NULL);
    }
    gtx_grid_free(&finest, NULL);
    gtx_close(asset);
}

static void errors_are_distances_from_level_0(void **state)
{
    (void)state;
    /* Every second texel keeps the turns; every fourth and eighth has code 100. */
    const double flat[4] = {0, 0, 2, 2};
    check_errors(NULL, 0.001, flat);
    check_errors(NULL, 0.1, flat); /* the trim's limit rules */
    /* Two codes above a slope of four a texel, as far as it is steep. */
    const double steep = 2 / sqrt(1 + 16 / (254 * 254 * 0.004 * 0.004));
    check_errors(flat, 0.004, (const double[4]){0, steep, steep, steep});
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(level_0_is_the_map),
        cmocka_unit_test(level_1_follows_the_rule),
        cmocka_unit_test(every_level_follows_the_rule),
        cmocka_unit_test(no_such_patch_or_level),
        cmocka_unit_test(cells_hold_their_corners),
        cmocka_unit_test(codes_are_those_of_cells),
        cmocka_unit_test(errors_are_distances_from_level_0),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
