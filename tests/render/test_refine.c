/* The triangles of displaced grids: together they cover a height field without a crack, and none is
 * off by more than is allowed where it is. No OpenGL. */
#include "refined.h"

#include "asset/patch.h"

#include <stdlib.h>

static bool is_on_rim(const gtx_grid_vertex *a, const gtx_grid_vertex *b)
{
    return (a->x == b->x && (a->x == 0 || a->x == LAST_X)) ||
           (a->y == b->y && (a->y == 0 || a->y == LAST_Y));
}

static uint32_t key_of(const gtx_grid_vertex *v)
{
    return (uint32_t)v->y << 16 | v->x;
}

static uint64_t edge_of(const gtx_grid_vertex *a, const gtx_grid_vertex *b)
{
    return (uint64_t)key_of(a) << 32 | key_of(b);
}

static int compare_edges(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Of one view; returns how many edges end between nodes. */
static uint32_t expect_edges_to_fit(const subject *s, uint32_t view, uint32_t count)
{
    uint64_t *edges = malloc(3 * count * sizeof *edges);
    uint32_t between = 0;
    assert_non_null(edges);
    for (uint32_t i = 0; i < 3 * count; ++i)
        edges[i] = edge_of(corner_of(s, i), corner_of(s, i % 3 == 2 ? i - 2 : i + 1));
    qsort(edges, 3 * count, sizeof *edges, compare_edges);
    for (uint32_t i = 1; i < 3 * count; ++i)
        assert_true(edges[i - 1] < edges[i]);
    for (uint32_t i = 0; i < 3 * count; ++i) {
        const gtx_grid_vertex *a = corner_of(s, i), *b = corner_of(s, i % 3 == 2 ? i - 2 : i + 1);
        const uint64_t back = edge_of(b, a);
        between += a->x % PARTS || a->y % PARTS;
        if (!is_on_rim(a, b) && !bsearch(&back, edges, 3 * count, sizeof back, compare_edges))
            fail_msg("view %u: nothing beyond (%u, %u) to (%u, %u)", view, a->x, a->y, b->x, b->y);
    }
    free(edges);
    return between;
}

/* Each edge but those of the rim has a triangle on either side. */
static void expect_to_fit(bool colored)
{
    subject s;
    open_subject(&s, 8, colored);
    uint32_t least = UINT32_MAX, most = 0, between = 0;
    for (uint32_t n = 0; n < 100; ++n) {
        const uint32_t count = refine(&s, n);
        between += expect_edges_to_fit(&s, n, count) > 0;
        least = count < least ? count : least;
        most = count > most ? count : most;
    }
    assert_true(least < 100);
    assert_true(most > 2000);
    assert_true(between > 10); /* views with divided cells */
    close_subject(&s);
}

static void triangles_fit_together(void **state)
{
    (void)state;
    expect_to_fit(true);
    expect_to_fit(false);
}

/* The height of the surface, which is bilinear in a cell, in codes. */
static double height_at(const subject *s, double x, double y)
{
    const gtx_patch *p = gtx_patches(s->asset);
    const uint32_t i = x < WIDE - 1 ? (uint32_t)x : WIDE - 2;
    const uint32_t j = y < HIGH - 1 ? (uint32_t)y : HIGH - 2;
    const double u = x - i, v = y - j;
    return (1 - v) * ((1 - u) * gtx_height_code(s->asset, p, i, j) +
                      u * gtx_height_code(s->asset, p, i + 1, j)) +
           v * ((1 - u) * gtx_height_code(s->asset, p, i, j + 1) +
                u * gtx_height_code(s->asset, p, i + 1, j + 1));
}

/* Distance of the surface at a place from the plane of a triangle that it lies over, or -1. */
static double distance_from(const subject *s, uint32_t triangle, double x, double y)
{
    const gtx_patch *patch = gtx_patches(s->asset);
    const double step[3] = {patch->extent_x / WIDE, patch->extent_y / HIGH,
                            gtx_height_step(patch, s->bits)};
    double p[3][3], side[2][3], at[3] = {x, y, height_at(s, x, y)};
    for (uint32_t c = 0; c < 3; ++c)
        gtx_grid_place(corner_of(s, 3 * triangle + c), p[c]);
    for (int c = 0; c < 3; ++c) {
        const double *a = p[c], *b = p[(c + 1) % 3];
        if ((b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]) < 0)
            return -1;
    }
    for (int k = 0; k < 3; ++k) {
        side[0][k] = (p[1][k] - p[0][k]) * step[k];
        side[1][k] = (p[2][k] - p[0][k]) * step[k];
        at[k] = (at[k] - p[0][k]) * step[k];
    }
    double dot = 0, square = 0;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double normal = side[0][i] * side[1][j] - side[0][j] * side[1][i];
        dot += normal * at[k];
        square += normal * normal;
    }
    return fabs(dot) / sqrt(square);
}

/* At nodes and in cells, but for triangles that cannot be smaller. */
static void errors_are_kept(void **state)
{
    (void)state;
    for (uint32_t bits = 8; bits <= 16; bits += 8) {
        subject s;
        uint32_t met = 0, within = 0, low[2], high[2];
        open_subject(&s, bits, true);
        for (uint32_t n = 0; n < 12; ++n) {
            const uint32_t count = refine(&s, n);
            for (uint32_t i = 0; i < count; ++i) {
                const bool smallest = place_of(&s, i, low, high);
                for (uint32_t b = 2 * low[1]; b <= 2 * high[1]; ++b)
                    for (uint32_t a = 2 * low[0]; a <= 2 * high[0]; ++a) {
                        const double x = a / (2.0 * PARTS), y = b / (2.0 * PARTS);
                        const double distance = distance_from(&s, i, x, y);
                        const double w = s.w[0] * x + s.w[1] * y + s.w[2] * height_at(&s, x, y) +
                                         s.w[3];
                        const double allowed = fmax(0, w / s.view.scale) + 1e-5;
                        met += distance > 0.2 * allowed;
                        within += distance > 0.2 * allowed && (a | b) % (2 * PARTS);
                        if (distance > 1.01 * allowed && !smallest)
                            fail_msg("view %u: %g at (%g, %g) where %g is allowed", n, distance, x,
                                     y, allowed);
                    }
            }
        }
        assert_true(met > 100 && within > 100); /* what is allowed is made use of */
        close_subject(&s);
    }
}

/* A level of the view sets how often all are halved. */
static void levels_are_uniform(void **state)
{
    (void)state;
    subject s;
    open_subject(&s, 8, true);
    const double eye[4] = {0, 0, 1e6, 1}, w[4] = {0, 0, 0, 1};
    for (int32_t level = 0; level < 5; ++level) {
        const gtx_frustum view = {.level = level, .scale = 1};
        const gtx_refining r = gtx_refine(&view, s.model, 0, w, eye, &s.grids, &s.hooks);
        s.grids.vertex_count = s.grids.index_count[0] = s.grids.index_count[GTX_GRID_MAPPED] = 0;
        for (uint32_t b = 0; b < r.rtin->columns * r.rtin->rows; ++b)
            assert_true(gtx_refine_block(&r, b % r.rtin->columns, b / r.rtin->columns));
        const uint32_t step = 1u << (level < 3 ? level : 3);
        const uint32_t cells = (WIDE - 1) / step * ((HIGH - 1) / step);
        const uint32_t mapped = s.grids.index_count[GTX_GRID_MAPPED] / 3;
        assert_int_equal(lit_of(&s) + mapped, 2 * cells);
        assert_int_equal(s.grids.vertex_count, ((WIDE - 1) / step + 1) * ((HIGH - 1) / step + 1));
    }
    close_subject(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_fit_together),
        cmocka_unit_test(errors_are_kept),
        cmocka_unit_test(levels_are_uniform),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
