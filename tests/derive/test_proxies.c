/* Boxes, hulls and slabs hold what shows, and little more. */
#include "derive/ramps.h"

/* Signed volume of the triangles; with `closed` every edge must be met once in each direction. */
static double volume_of(const gtx_proxies *p, uint32_t tag, bool closed)
{
    double volume = 0;
    for (uint32_t i = 0; i < p->index_count; i += 3) {
        const gtx_proxy_vertex *v[3];
        for (int k = 0; k < 3; ++k) {
            v[k] = &p->vertices[p->indices[i + k]];
            assert_int_equal(v[k]->patch, tag);
            uint32_t a = p->indices[i + k], b = p->indices[i + (k + 1) % 3], twins = 0;
            for (uint32_t j = 0; j < p->index_count; ++j)
                twins += p->indices[j] == b &&
                         p->indices[j % 3 == 2 ? j - 2 : j + 1] == a;
            if (closed)
                assert_int_equal(twins, 1);
        }
        volume += (v[0]->x * ((double)v[1]->y * v[2]->z - (double)v[1]->z * v[2]->y) +
                   v[0]->y * ((double)v[1]->z * v[2]->x - (double)v[1]->x * v[2]->z) +
                   v[0]->z * ((double)v[1]->x * v[2]->y - (double)v[1]->y * v[2]->x)) / 6;
    }
    return volume;
}

static gtx_result add_box(const gtx_asset *asset, float grow, const gtx_allocator *hooks,
                          gtx_proxies *out)
{
    gtx_grid finest;
    gtx_result result = gtx_grid_build(asset, 0, 0, NULL, &finest, NULL);
    if (!result)
        result = gtx_add_box(0, &finest, grow, hooks, out, NULL);
    gtx_grid_free(&finest, NULL);
    return result;
}

static void boxes_fit(void **state)
{
    (void)state;
    gtx_asset *asset = make(&RAGGED, 7, 5);
    gtx_proxies boxes = {0};
    assert_int_equal(add_box(asset, 0.5f, NULL, &boxes), GTX_OK);
    float low[3] = {9, 9, 99}, high[3] = {-9, -9, -9};
    for (uint32_t i = 0; i < boxes.vertex_count; ++i) {
        const float p[3] = {boxes.vertices[i].x, boxes.vertices[i].y, boxes.vertices[i].z};
        for (int a = 0; a < 3; ++a) {
            low[a] = fminf(low[a], p[a]);
            high[a] = fmaxf(high[a], p[a]);
        }
    }
    /* Solid cells: (0, 0), (5, 0), (1, 1); their codes are 10 and 2. */
    const float expected_low[3] = {-0.5f, -0.5f, 1.5f}, expected_high[3] = {6.5f, 2.5f, 10.5f};
    for (int a = 0; a < 3; ++a) {
        assert_float_equal(low[a], expected_low[a], 1e-6f);
        assert_float_equal(high[a], expected_high[a], 1e-6f);
    }
    assert_float_equal(volume_of(&boxes, 0, true), 7.0 * 3.0 * 9.0, 1e-3);
    gtx_proxies_free(&boxes, NULL);
    assert_int_equal(add_box(asset, NAN, NULL, &boxes), GTX_ERROR_ARGUMENT);
    assert_int_equal(add_box(asset, -1, NULL, &boxes), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_add_box(0, NULL, 1, NULL, &boxes, NULL), GTX_ERROR_ARGUMENT);
    gtx_close(asset);
}

/* Low ground up to x = 20, and high texels without a cell at (24, 8 j). */
static void lonely(const gtx_patch *patch, double x, double y, const void *user, fixture_texel *out)
{
    (void)patch;
    (void)user;
    const int peak = fmod(x, 24) == 0 && x > 0 && fmod(y, 8) == 0;
    *out = (fixture_texel){peak ? 0.9 : x < 20 ? 0.3 : -1, -4, {0, 0, 1}, {255, 255, 255, 255}};
}

static void boxes_hold_the_nodes_of_all_levels(void **state)
{
    (void)state;
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {.frame = fixture_frame(corner, 32, 24, 0.1, 1), .field = lonely};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 4);
    gtx_proxies boxes = {0};
    uint32_t highest = 0;
    assert_int_equal(add_box(asset, 0, NULL, &boxes), GTX_OK);
    const gtx_proxy_vertex *low = &boxes.vertices[0], *high = &boxes.vertices[7];
    for (uint32_t level = 0; level < 4; ++level) {
        gtx_grid grid;
        assert_int_equal(gtx_grid_build(asset, 0, level, NULL, &grid, NULL), GTX_OK);
        for (uint32_t j = 0; j + 1 < grid.nodes_y; ++j)
            for (uint32_t i = 0; i + 1 < grid.nodes_x; ++i)
                for (uint32_t k = 0; k < 4 && grid.solid[j * (grid.nodes_x - 1) + i]; ++k) {
                    const uint32_t code = grid.code[(j + (k >> 1)) * grid.nodes_x + i + (k & 1)];
                    assert_in_range(code, (uint32_t)low->z, (uint32_t)high->z);
                    highest = code > highest ? code : highest;
                }
        gtx_grid_free(&grid, NULL);
    }
    assert_true(highest > 200); /* there was such a node */
    assert_true(high->x < 20);  /* while x and y are those of level 0 */
    gtx_proxies_free(&boxes, NULL);
    gtx_close(asset);
}

static gtx_proxies hull_of(const gtx_asset *asset, uint32_t level, float grow, float *thickness)
{
    gtx_grid grid;
    gtx_proxies hull = {0};
    assert_int_equal(gtx_grid_build(asset, 0, level, NULL, &grid, NULL), GTX_OK);
    gtx_grid_trim(asset, 0, &grid);
    assert_int_equal(gtx_add_hull(asset, 0, &grid, grow, NULL, &hull, thickness, NULL), GTX_OK);
    gtx_grid_free(&grid, NULL);
    return hull;
}

/* The slab of a cell, among those of its level. */
static const gtx_slab *slab_at(const gtx_slab *slabs, const gtx_grid *grid, uint32_t i, uint32_t j)
{
    const uint32_t row = (grid->nodes_x - 2) / GTX_SLAB_CELLS + 1;
    return &slabs[j / GTX_SLAB_CELLS * row + i / GTX_SLAB_CELLS];
}

/* Each corner of a solid cell is in its cell's slab, the sides are no steeper than it says; slabs
 * without a solid cell are empty, and the others not much thicker than what is in them. */
static void check_slabs(const gtx_asset *asset, uint32_t patch, uint32_t level)
{
    const gtx_patch *p = &gtx_patches(asset)[patch];
    gtx_grid grid;
    assert_int_equal(gtx_grid_build(asset, patch, level, NULL, &grid, NULL), GTX_OK);
    gtx_grid_trim(asset, patch, &grid);
    const uint32_t count = gtx_slab_count(p, level), width = grid.nodes_x - 1;
    gtx_slab *slabs = calloc(count, sizeof *slabs);
    uint32_t *used = calloc(count, sizeof *used);
    gtx_grid_slabs(p, &grid, slabs);
    for (uint32_t c = 0; c < width * (grid.nodes_y - 1); ++c) {
        const uint32_t i = c % width, j = c / width;
        const gtx_slab *s = slab_at(slabs, &grid, i, j);
        assert_true(s < slabs + count);
        if (!grid.solid[c])
            continue;
        ++used[s - slabs];
        for (uint32_t k = 0; k < 4; ++k) {
            const uint32_t u = i + (k & 1), v = j + (k >> 1);
            const double x = fmin(u << level, p->rect[2] - 1), y = fmin(v << level, p->rect[3] - 1);
            const double z = grid.code[v * grid.nodes_x + u] - s->slope[0] * x - s->slope[1] * y;
            assert_true(x >= s->low[0] && x <= s->high[0] && y >= s->low[1] && y <= s->high[1]);
            assert_true(z > s->height[0] && z < s->height[1]);
        }
        const uint16_t *row = &grid.code[j * grid.nodes_x + i];
        const double side = fmin((i + 1) << level, p->rect[2] - 1) - (i << level);
        const double rise = (row[1] - row[0]) / side - s->slope[0];
        assert_true(rise >= s->rise_x[0] - 2e-3 && rise <= s->rise_x[1] + 2e-3);
    }
    for (uint32_t n = 0; n < count; ++n)
        assert_int_equal(used[n] > 0, slabs[n].low[0] <= slabs[n].high[0]);
    free(used);
    free(slabs);
    gtx_grid_free(&grid, NULL);
}

static void slabs_hold_their_cells(void **state)
{
    (void)state;
    gtx_asset *assets[] = {fixture_bumpy(8, 0), fixture_bumpy(16, GTX_PATCH_TWO_SIDED),
                           fixture_flat(0.5, 8), fixture_sphere(2, 64, 8)};
    for (size_t a = 0; a < sizeof assets / sizeof *assets; ++a) {
        gtx_info info;
        gtx_get_info(assets[a], &info);
        for (uint32_t patch = 0; patch < info.patch_count; ++patch)
            for (uint32_t level = 0; level < info.mip_count; ++level)
                check_slabs(assets[a], patch, level);
        gtx_close(assets[a]);
    }
    const picture holes = {{"1010101", "0101010", "1010101"}};
    gtx_asset *asset = make(&holes, 7, 3);
    check_slabs(asset, 0, 0);
    gtx_close(asset);
}

static void a_patch_without_cells_has_a_point_and_no_hull(void **state)
{
    (void)state;
    const picture holes = {{"1010101", "0101010", "1010101"}};
    gtx_asset *asset = make(&holes, 7, 3);
    gtx_proxies boxes = {0};
    float thickness;
    assert_int_equal(add_box(asset, 1, NULL, &boxes), GTX_OK);
    assert_int_equal(boxes.index_count, GTX_BOX_INDICES);
    for (uint32_t v = 0; v < boxes.vertex_count; ++v)
        assert_true(boxes.vertices[v].x == 0 && boxes.vertices[v].y == 0);
    gtx_proxies hull = hull_of(asset, 0, 1, &thickness);
    assert_int_equal(hull.index_count, 0);
    gtx_proxies_free(&hull, NULL);
    gtx_proxies_free(&boxes, NULL);
    gtx_close(asset);
}

/* z of the triangles that face up, at (x, y): the highest; -1 where there is none. */
static double lid_at(const gtx_proxies *p, double x, double y, double side)
{
    double best = -1;
    for (uint32_t i = 0; i < p->index_count; i += 3) {
        const gtx_proxy_vertex *v[3];
        for (int k = 0; k < 3; ++k)
            v[k] = &p->vertices[p->indices[i + k]];
        const double x1 = v[1]->x - v[0]->x, y1 = v[1]->y - v[0]->y;
        const double x2 = v[2]->x - v[0]->x, y2 = v[2]->y - v[0]->y;
        const double det = x1 * y2 - x2 * y1;
        if (det * side < 1e-6)
            continue;
        const double s = ((x - v[0]->x) * y2 - x2 * (y - v[0]->y)) / det;
        const double t = (x1 * (y - v[0]->y) - (x - v[0]->x) * y1) / det;
        if (s >= -1e-6 && t >= -1e-6 && s + t <= 1 + 1e-6)
            best = v[0]->z + s * ((double)v[1]->z - v[0]->z) + t * ((double)v[2]->z - v[0]->z);
    }
    return best;
}

/* Each point that shows lies under the lid, and above the floor if there is one, by the margin, and
 * no deeper than the thickness says. */
static void check_hull(const gtx_asset *asset, uint32_t level, bool two_sided)
{
    const float grow = 0.25f;
    const gtx_patch *patch = gtx_patches(asset);
    float thickness;
    gtx_grid grid;
    gtx_proxies hull = hull_of(asset, level, grow, &thickness);
    assert_int_equal(gtx_grid_build(asset, 0, level, NULL, &grid, NULL), GTX_OK);
    const uint32_t limit = 128 + (48u << level) / 10;
    uint32_t shown = 0;
    for (uint32_t y = 0; y < patch->rect[3]; ++y)
        for (uint32_t x = 0; x < patch->rect[2]; ++x) {
            const uint32_t i = x >> level, j = y >> level, step = 1u << level;
            if (gtx_trim_code(asset, patch, x, y) > limit || i + 1 >= grid.nodes_x ||
                j + 1 >= grid.nodes_y || !grid.solid[j * (grid.nodes_x - 1) + i])
                continue;
            const double w = fmin(step, patch->rect[2] - 1.0 - i * step);
            const double h = fmin(step, patch->rect[3] - 1.0 - j * step);
            const double u = (x - i * step) / w, v = (y - j * step) / h;
            const uint16_t *c = grid.code + j * grid.nodes_x + i, *d = c + grid.nodes_x;
            const double z = (1 - v) * ((1 - u) * c[0] + u * c[1]) +
                             v * ((1 - u) * d[0] + u * d[1]);
            const double lid = lid_at(&hull, x, y, 1);
            assert_true(lid >= z + 0.999 * grow - 1e-5 * z);
            assert_true(lid - z < thickness);
            if (two_sided)
                assert_true(lid_at(&hull, x, y, -1) <= z - 0.999 * grow + 1e-5 * z);
            ++shown;
        }
    assert_true(shown > 400);
    if (two_sided)
        assert_true(volume_of(&hull, (level + 1) << GTX_PROXY_KIND_SHIFT, true) > 0);
    else
        volume_of(&hull, (level + 1) << GTX_PROXY_KIND_SHIFT, false);
    gtx_grid_free(&grid, NULL);
    gtx_proxies_free(&hull, NULL);
}

static void hulls_hold_what_shows(void **state)
{
    (void)state;
    for (uint32_t bits = 8; bits <= 16; bits += 8)
        for (int two_sided = 0; two_sided < 2; ++two_sided) {
            gtx_asset *asset = fixture_bumpy(bits, two_sided ? GTX_PATCH_TWO_SIDED : 0);
            for (uint32_t level = 0; level < 4; ++level)
                check_hull(asset, level, two_sided);
            gtx_close(asset);
        }
}

/* Against boxes that is what they are for. */
static void hulls_are_thin(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 64, 8);
    gtx_proxies box = {0}, hull;
    float thickness;
    assert_int_equal(add_box(asset, 0, NULL, &box), GTX_OK);
    hull = hull_of(asset, 0, 0, &thickness);
    double above = 0;
    for (int i = 12; i < 52; ++i)
        above = fmax(above, lid_at(&hull, i, 32, 1) -
                                gtx_height_code(asset, gtx_patches(asset), (uint32_t)i, 32));
    assert_true(above < 0.1 * (box.vertices[7].z - box.vertices[0].z));
    gtx_proxies_free(&box, NULL);
    gtx_proxies_free(&hull, NULL);
    gtx_close(asset);
}

static void memory_may_run_out(void **state)
{
    (void)state;
    gtx_asset *asset = make(&RAGGED, 7, 5);
    counter c = {0};
    const gtx_allocator hooks = {counted_alloc, counted_free, &c};
    gtx_grid grid;
    for (int n = 0;; ++n) {
        c.until_failure = n;
        gtx_result result = gtx_grid_build(asset, 0, 2, &hooks, &grid, NULL);
        if (result == GTX_OK)
            break;
        assert_int_equal(result, GTX_ERROR_MEMORY);
        assert_int_equal(c.bytes, 0);
    }
    for (int n = 0;; ++n) {
        gtx_proxies proxies = {0};
        float thickness;
        c.until_failure = n;
        gtx_result result = add_box(asset, 0, &hooks, &proxies);
        if (!result)
            result = gtx_add_hull(asset, 0, &grid, 0, &hooks, &proxies, &thickness, NULL);
        gtx_proxies_free(&proxies, &hooks);
        if (result == GTX_OK)
            break;
        assert_int_equal(result, GTX_ERROR_MEMORY);
    }
    gtx_grid_free(&grid, &hooks);
    assert_int_equal(c.bytes, 0);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_fit),
        cmocka_unit_test(boxes_hold_the_nodes_of_all_levels),
        cmocka_unit_test(a_patch_without_cells_has_a_point_and_no_hull),
        cmocka_unit_test(hulls_hold_what_shows),
        cmocka_unit_test(slabs_hold_their_cells),
        cmocka_unit_test(hulls_are_thin),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
