/* The triangles of displaced grids: together they cover a height field without a crack, none is
 * off by more than is allowed where it is, and those that are lit at their corners are even. No
 * OpenGL. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/asset.h"
#include "asset/patch.h"
#include "base/alloc.h"
#include "common/fixture.h"
#include "frame/grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDE = 49, HIGH = 41, NODES = WIDE * HIGH };

static void wavy(const gtx_patch *patch, double x, double y, const void *user, fixture_texel *out)
{
    (void)patch;
    (void)user;
    const double ridge = fabs(x - 0.7 * y - 9) / 30;
    *out = (fixture_texel){.height = 0.45 + 0.2 * sin(0.31 * x) * cos(0.23 * y) +
                                     0.3 * fmin(ridge, 0.4) + 0.01 * sin(2.9 * x + 1.7 * y),
                           .trim = -8, .normal = {x < 24 ? 0.01 * x : 0.3 * sin(2 * x + y), 0, 1},
                           .color = {90, (uint8_t)(2 * y), y < 20 ? 10 : (uint8_t)(5 * x), 255}};
}

/* A height field that ends where its blocks do, and what is drawn of it. */
typedef struct subject {
    gtx_asset *asset;
    uint32_t bits;            /* of heights */
    gtx_model *model;
    gtx_allocator hooks;
    gtx_grids grids;
    double w[4];
    gtx_frustum view;
} subject;

/* Closes the asset. */
static gtx_asset *without_colors(gtx_asset *asset)
{
    const uint8_t *normal[1] = {asset->normal[0]};
    const gtx_info *info = &asset->info;
    gtx_asset_desc desc = {.patches = asset->patches, .patch_count = 1, .page_count = 1,
                           .page_width = info->page_width, .page_height = info->page_height,
                           .mip_count = 1, .height_bits = info->height_bits,
                           .height = asset->height, .trim = asset->trim, .normal = normal};
    gtx_asset *out = NULL;
    memcpy(desc.bounds_min, info->bounds_min, sizeof desc.bounds_min);
    memcpy(desc.bounds_max, info->bounds_max, sizeof desc.bounds_max);
    assert_int_equal(gtx_create(&desc, &out, NULL), GTX_OK);
    gtx_close(asset);
    return out;
}

static void open_subject(subject *s, uint32_t height_bits, bool colored)
{
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, WIDE, HIGH, 0.5, 6), wavy, NULL};
    patch.frame.flags = GTX_PATCH_TWO_SIDED;
    *s = (subject){.asset = fixture_build(&patch, 1, height_bits, 1), .bits = height_bits,
                   .hooks = gtx_allocator_or_default(NULL)};
    const gtx_model_desc desc = {.borrow = 1};
    if (!colored)
        s->asset = without_colors(s->asset);
    assert_int_equal(gtx_model_prepare(s->asset, &desc, &s->model, NULL), GTX_OK);
    gtx_rtin_triangles(s->grids.triangles);
    assert_non_null(gtx_scratch_reserve(&s->hooks, &s->grids.slots, NODES, sizeof(uint32_t)));
}

static void close_subject(subject *s)
{
    gtx_scratch_free(&s->hooks, &s->grids.vertices);
    gtx_scratch_free(&s->hooks, &s->grids.slots);
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        gtx_scratch_free(&s->hooks, &s->grids.indices[k]);
    gtx_model_free(s->model);
    gtx_close(s->asset);
}

/* Number n of a sequence, from 0 to 1. */
static double number(uint32_t n)
{
    n = (n ^ 61) ^ (n >> 16);
    n *= 9;
    n = (n ^ (n >> 4)) * 0x27d4eb2du;
    return (n ^ (n >> 15)) / (double)UINT32_MAX;
}

/* How many of its triangles may be lit at their corners; they come before those that are not. */
static uint32_t lit_of(const subject *s)
{
    return s->grids.index_count[0] / 3;
}

/* Refines for the n-th view: w grows across the height field, and may be behind the eye. */
static uint32_t refine(subject *s, uint32_t n)
{
    for (uint32_t k = 0; k < 2; ++k)
        s->w[k] = 2 * number(4 * n + k) - 1;
    s->w[2] = 0.02 * (number(4 * n + 2) - 0.5);
    s->w[3] = 40 * number(4 * n + 3) - 10;
    const double eye[4] = {0, 0, 1e6, 1};
    s->view = (gtx_frustum){.level = -1, .scale = exp(12 * number(7 * n) - 2),
                            .pixels = n % 2 ? 400 * number(11 * n) : 0};
    s->grids.vertex_count = 0;
    memset(s->grids.index_count, 0, sizeof s->grids.index_count);
    const gtx_refining r = gtx_refine(&s->view, s->model, 0, s->w, eye, &s->grids, &s->hooks);
    for (uint32_t b = 0; b < r.rtin->columns * r.rtin->rows; ++b)
        assert_true(gtx_refine_block(&r, b % r.rtin->columns, b / r.rtin->columns));
    for (uint32_t k = GTX_GRID_TRIMMED; k < GTX_GRID_LOOKS; ++k)
        assert_int_equal(s->grids.index_count[k], 0); /* it shows all over, and from above */
    return lit_of(s) + s->grids.index_count[GTX_GRID_MAPPED] / 3;
}

static const gtx_grid_vertex *corner_of(const subject *s, uint32_t i)
{
    const uint32_t lit = s->grids.index_count[0], look = i < lit ? 0 : GTX_GRID_MAPPED;
    const uint32_t *indices = s->grids.indices[look].data;
    const uint32_t index = indices[look ? i - lit : i];
    assert_true(index < s->grids.vertex_count);
    return (const gtx_grid_vertex *)s->grids.vertices.data + index;
}

static bool is_on_rim(const gtx_grid_vertex *a, const gtx_grid_vertex *b)
{
    return (a->x == b->x && (a->x == 0 || a->x == WIDE - 1)) ||
           (a->y == b->y && (a->y == 0 || a->y == HIGH - 1));
}

/* Each edge but those of the rim has a triangle on either side. */
static void expect_to_fit(bool colored)
{
    subject s;
    open_subject(&s, 8, colored);
    uint8_t *met = calloc((size_t)NODES * NODES, 1); /* by first and second node */
    uint32_t least = UINT32_MAX, most = 0;
    assert_non_null(met);
    for (uint32_t n = 0; n < 200; ++n) {
        const uint32_t count = refine(&s, n);
        memset(met, 0, (size_t)NODES * NODES);
        for (int pass = 0; pass < 2; ++pass)
            for (uint32_t i = 0; i < 3 * count; ++i) {
                const gtx_grid_vertex *a = corner_of(&s, i);
                const gtx_grid_vertex *b = corner_of(&s, i % 3 == 2 ? i - 2 : i + 1);
                const size_t p = a->y * WIDE + a->x, q = b->y * WIDE + b->x;
                if (pass == 0)
                    assert_int_equal(met[p * NODES + q]++, 0);
                else if (!met[q * NODES + p] && !is_on_rim(a, b))
                    fail_msg("view %u: nothing beyond (%u, %u) to (%u, %u)", n, a->x, a->y, b->x,
                             b->y);
            }
        least = count < least ? count : least;
        most = count > most ? count : most;
    }
    assert_true(least < 100);
    assert_true(most > 2000);
    free(met);
    close_subject(&s);
}

static void triangles_fit_together(void **state)
{
    (void)state;
    expect_to_fit(true);
    expect_to_fit(false);
}

/* Distance of a node from the plane of a triangle that it lies over, or -1. */
static double distance_from(const subject *s, uint32_t triangle, uint32_t x, uint32_t y)
{
    const gtx_patch *patch = gtx_patches(s->asset);
    const double step[3] = {patch->extent_x / WIDE, patch->extent_y / HIGH,
                            gtx_height_step(patch, s->bits)};
    double p[3][3], side[2][3], at[3] = {x, y, gtx_height_code(s->asset, patch, x, y)};
    for (uint32_t c = 0; c < 3; ++c) {
        const gtx_grid_vertex *v = corner_of(s, 3 * triangle + c);
        const double of[3] = {v->x, v->y, v->code};
        memcpy(p[c], of, sizeof of);
    }
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

static void errors_are_kept(void **state)
{
    (void)state;
    for (uint32_t bits = 8; bits <= 16; bits += 8) {
        subject s;
        uint32_t met = 0;
        open_subject(&s, bits, true);
        for (uint32_t n = 0; n < 12; ++n) {
            const uint32_t count = refine(&s, n);
            for (uint32_t i = 0; i < count; ++i)
                for (uint32_t node = 0; node < NODES; ++node) {
                    const uint32_t x = node % WIDE, y = node / WIDE;
                    const double distance = distance_from(&s, i, x, y);
                    const uint32_t code = gtx_height_code(s.asset, gtx_patches(s.asset), x, y);
                    const double w = s.w[0] * x + s.w[1] * y + s.w[2] * code + s.w[3];
                    const double allowed = fmax(0, w / s.view.scale) + 1e-5;
                    met += distance > 0.2 * allowed;
                    if (distance > 1.01 * allowed)
                        fail_msg("view %u: %g at (%u, %u) where %g is allowed", n, distance, x, y,
                                 allowed);
                }
        }
        assert_true(met > 100); /* what is allowed is made use of */
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

/* A byte at a node: of the normal, then of the colour. */
static double byte_at(const subject *s, uint32_t x, uint32_t y, int k)
{
    const gtx_patch *p = s->asset->patches;
    const size_t row = p->rect[1] + y, column = p->rect[0] + x;
    const size_t at = row * s->asset->info.page_width + column;
    return k < 2 ? s->asset->normal[0][2 * at + (size_t)k]
                 : s->asset->color[0][4 * at + (size_t)k - 2];
}

/* How far what the corners make is from what is at a node that their triangle lies over, in
 * bytes. */
static double stray_at(const subject *s, uint32_t triangle, uint32_t x, uint32_t y)
{
    const gtx_grid_vertex *c[3];
    double area[3], most = 0;
    for (uint32_t i = 0; i < 3; ++i)
        c[i] = corner_of(s, 3 * triangle + i);
    for (int i = 0; i < 3; ++i) {
        const gtx_grid_vertex *a = c[(i + 1) % 3], *b = c[(i + 2) % 3];
        area[i] = (b->x - a->x) * ((double)y - a->y) - (b->y - a->y) * ((double)x - a->x);
        if (area[i] < 0)
            return 0;
    }
    for (int k = 0; k < (s->asset->info.has_color ? 6 : 2); ++k) {
        double mean = 0;
        for (int i = 0; i < 3; ++i)
            mean += area[i] * byte_at(s, c[i]->x, c[i]->y, k) / (area[0] + area[1] + area[2]);
        most = fmax(most, fabs(mean - byte_at(s, x, y, k)));
    }
    return most;
}

/* Those lit at their corners have the normals and colours that these make; and near they all
 * are. */
static void expect_to_be_even(bool colored)
{
    subject s;
    uint32_t large = 0, mapped = 0, near = 0;
    open_subject(&s, 8, colored);
    for (uint32_t n = 0; n < 40; ++n) {
        const uint32_t count = refine(&s, n), lit = lit_of(&s);
        const double least_w = s.w[3] + fmin(0, 48 * s.w[0]) + fmin(0, 40 * s.w[1]) - 255 * 0.01;
        const double most_w = least_w + 48 * fabs(s.w[0]) + 40 * fabs(s.w[1]) + 255 * 0.02;
        for (uint32_t i = 0; i < lit; ++i)
            for (uint32_t node = 0; node < NODES; ++node) {
                const double stray = stray_at(&s, i, node % WIDE, node / WIDE);
                large += stray > 0.4;
                if (stray > 3.01)
                    fail_msg("view %u: they stray by %g", n, stray);
            }
        mapped += count - lit;
        if (most_w < 0.5 * s.view.pixels / 8) { /* the side of a texel */
            assert_int_equal(lit, count);
            near += count < 2 * (WIDE - 1) * (HIGH - 1);
        }
    }
    assert_true(large > 100 && mapped > 1000 && near > 3);
    close_subject(&s);
}

static void lit_ones_are_even(void **state)
{
    (void)state;
    expect_to_be_even(false);
    expect_to_be_even(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_fit_together),
        cmocka_unit_test(errors_are_kept),
        cmocka_unit_test(lit_ones_are_even),
        cmocka_unit_test(levels_are_uniform),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
