/* A height field as displaced grids draw it, without OpenGL: for tests of their triangles. */
#ifndef GTX_TESTS_RENDER_REFINED_H
#define GTX_TESTS_RENDER_REFINED_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/asset.h"
#include "base/alloc.h"
#include "common/fixture.h"
#include "frame/grid.h"

#include <math.h>
#include <string.h>

enum {
    WIDE = 49, HIGH = 41, NODES = WIDE * HIGH, PARTS = GTX_GRID_PARTS,
    LAST_X = PARTS * (WIDE - 1), LAST_Y = PARTS * (HIGH - 1)
};

static inline void wavy(const gtx_patch *patch, double x, double y, const void *user,
                        fixture_texel *out)
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
static inline gtx_asset *without_colors(gtx_asset *asset)
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

static inline void open_subject(subject *s, uint32_t height_bits, bool colored)
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

static inline void close_subject(subject *s)
{
    gtx_scratch_free(&s->hooks, &s->grids.vertices);
    gtx_scratch_free(&s->hooks, &s->grids.slots);
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        gtx_scratch_free(&s->hooks, &s->grids.indices[k]);
    gtx_model_free(s->model);
    gtx_close(s->asset);
}

/* Number n of a sequence, from 0 to 1. */
static inline double number(uint32_t n)
{
    n = (n ^ 61) ^ (n >> 16);
    n *= 9;
    n = (n ^ (n >> 4)) * 0x27d4eb2du;
    return (n ^ (n >> 15)) / (double)UINT32_MAX;
}

/* How many of its triangles may be lit at their corners; they come before those that are not. */
static inline uint32_t lit_of(const subject *s)
{
    return s->grids.index_count[0] / 3;
}

/* Refines for the n-th view: w grows across the height field, and may be behind the eye. */
static inline uint32_t refine(subject *s, uint32_t n)
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

static inline const gtx_grid_vertex *corner_of(const subject *s, uint32_t i)
{
    const uint32_t lit = s->grids.index_count[0], look = i < lit ? 0 : GTX_GRID_MAPPED;
    const uint32_t *indices = s->grids.indices[look].data;
    const uint32_t index = indices[look ? i - lit : i];
    assert_true(index < s->grids.vertex_count);
    return (const gtx_grid_vertex *)s->grids.vertices.data + index;
}

/* The rectangle around a triangle, in parts of a cell; returns whether it is of the smallest. */
static inline bool place_of(const subject *s, uint32_t triangle, uint32_t low[2], uint32_t high[2])
{
    low[0] = low[1] = UINT32_MAX;
    high[0] = high[1] = 0;
    for (uint32_t c = 0; c < 3; ++c) {
        const gtx_grid_vertex *v = corner_of(s, 3 * triangle + c);
        const uint32_t at[2] = {v->x, v->y};
        for (int k = 0; k < 2; ++k) {
            low[k] = at[k] < low[k] ? at[k] : low[k];
            high[k] = at[k] > high[k] ? at[k] : high[k];
        }
    }
    return high[0] - low[0] <= PARTS / 2 && high[1] - low[1] <= PARTS / 2;
}

#endif
