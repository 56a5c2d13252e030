/* Slabs: slanted boxes, each close around a block of a level's cells. */
#include "derive/moments.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* How far slabs overlap, in cells, and stand off the height field, in codes: rounding must neither
 * open a seam between neighbours nor cut the height field off. */
static const float cell_overlap = 0.0002f, margin = 0.05f;

_Static_assert((int)GTX_SLAB_CELLS <= (int)GTX_MAX_MOMENTS, "a slab's sums fit");

/* Cells of a grid, from low to high - 1. */
typedef struct block {
    const gtx_grid *grid;
    uint32_t low[2], high[2];
    uint32_t last[2];         /* texel of the patch */
} block;

static uint32_t min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static uint32_t blocks_along(uint32_t texels, uint32_t level)
{
    return ((texels - 2) >> level) / GTX_SLAB_CELLS + 1;
}

uint32_t gtx_slab_count(const gtx_patch *patch, uint32_t level)
{
    return blocks_along(patch->rect[2], level) * blocks_along(patch->rect[3], level);
}

static float texel(const block *b, int axis, uint32_t i)
{
    return (float)min_u32(i << b->grid->level, b->last[axis]);
}

static const uint8_t *solid_row(const block *b, uint32_t j)
{
    return b->grid->solid + (size_t)j * (b->grid->nodes_x - 1);
}

/* Narrows the block to its solid cells; false when there is none. */
static bool narrow(block *b)
{
    uint8_t any[GTX_SLAB_CELLS] = {0};
    const uint32_t x0 = b->low[0], width = b->high[0] - x0;
    uint32_t first = UINT32_MAX, end = 0;
    for (uint32_t j = b->low[1]; j < b->high[1]; ++j) {
        const uint8_t *solid = solid_row(b, j) + x0;
        if (!memchr(solid, 1, width))
            continue;
        for (uint32_t i = 0; i < width; ++i)
            any[i] |= solid[i];
        first = min_u32(first, j);
        end = j + 1;
    }
    b->low[1] = first;
    b->high[1] = end;
    for (; first < end && !any[b->low[0] - x0]; ++b->low[0])
        continue;
    for (; first < end && !any[b->high[0] - 1 - x0]; --b->high[0])
        continue;
    return first < end;
}

/* The plane of least squares through the low corners of the solid cells: z = a x + b y + ... Few
 * cells do not tell a slope, and hold it back. */
static void fit_plane(const block *b, float slope[2])
{
    const gtx_moments m = gtx_moments_of(b->grid, b->low, b->high);
    const double xx = 1 + m.xx - m.x * m.x / m.n, xy = m.xy - m.x * m.y / m.n;
    const double yy = 1 + m.yy - m.y * m.y / m.n, xz = m.xz - m.x * m.z / m.n;
    const double yz = m.yz - m.y * m.z / m.n;
    const double det = (xx * yy - xy * xy) * (double)(1u << b->grid->level);
    slope[0] = (float)((xz * yy - yz * xy) / det);
    slope[1] = (float)((yz * xx - xz * xy) / det);
}

/* Nodes along a block, and places for them in vectors, one more on the right. */
enum { NODES = GTX_SLAB_CELLS + 1, LANES = (NODES + 3) / 4 * 4, STRIDE = LANES + 4 };

/* A block as vectors take it: codes of nodes, and cells with an empty one all around. */
typedef struct sample {
    float code[NODES + 1][STRIDE], x[STRIDE];
    int32_t solid[NODES + 1][STRIDE];
} sample;

static void load(const block *b, sample *out)
{
    const uint32_t cells = b->high[0] - b->low[0], rows = b->high[1] - b->low[1];
    memset(out, 0, sizeof *out);
    for (uint32_t j = 0; j <= rows; ++j) {
        const uint16_t *code =
            b->grid->code + (size_t)(b->low[1] + j) * b->grid->nodes_x + b->low[0];
        for (uint32_t i = 0; i <= cells; ++i)
            out->code[j][i] = code[i];
    }
    for (uint32_t j = 0; j < rows; ++j) {
        const uint8_t *solid = solid_row(b, b->low[1] + j) + b->low[0];
        for (uint32_t i = 0; i < cells; ++i)
            out->solid[j + 1][i + 1] = solid[i];
    }
    for (uint32_t i = 0; i < STRIDE; ++i)
        out->x[i] = texel(b, 0, b->low[0] + i);
}

/* The least and the greatest of some values, column by column. */
typedef struct range {
    float low[LANES], high[LANES];
} range;

static inline void extend(range *r, int i, bool take, float value)
{
    r->low[i] = (take & (value < r->low[i])) ? value : r->low[i];
    r->high[i] = (take & (value > r->high[i])) ? value : r->high[i];
}

static void store_range(const range *r, float out[2])
{
    out[0] = INFINITY;
    out[1] = -INFINITY;
    for (int i = 0; i < LANES; ++i) {
        out[0] = r->low[i] < out[0] ? r->low[i] : out[0];
        out[1] = r->high[i] > out[1] ? r->high[i] : out[1];
    }
}

/* What the solid cells span: heights of their corners over the plane, and slopes of their sides
 * against it. */
static void measure(const block *b, gtx_slab *s)
{
    sample in;
    range height, rise_x, rise_y;
    const float slope[2] = {s->slope[0], s->slope[1]};
    load(b, &in);
    for (int i = 0; i < LANES; ++i) {
        height.low[i] = rise_x.low[i] = rise_y.low[i] = INFINITY;
        height.high[i] = rise_x.high[i] = rise_y.high[i] = -INFINITY;
    }
    for (uint32_t j = 0; j <= b->high[1] - b->low[1]; ++j) {
        const float *code = in.code[j], *next = in.code[j + 1];
        const int32_t *above = in.solid[j + 1], *below = in.solid[j];
        const float y = texel(b, 1, b->low[1] + j), up = texel(b, 1, b->low[1] + j + 1) - y;
        for (int i = 0; i < LANES; ++i) {
            const int32_t left = above[i] | below[i], right = above[i + 1] | below[i + 1];
            const float across = (code[i + 1] - code[i]) / (in.x[i + 1] - in.x[i]);
            extend(&height, i, (left | right) != 0, code[i] - slope[0] * in.x[i] - slope[1] * y);
            extend(&rise_x, i, right != 0, across - slope[0]);
            extend(&rise_y, i, (above[i] | above[i + 1]) != 0, (next[i] - code[i]) / up - slope[1]);
        }
    }
    store_range(&height, s->height);
    store_range(&rise_x, s->rise_x);
    store_range(&rise_y, s->rise_y);
}

static gtx_slab slab_of(block b)
{
    gtx_slab s = {.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY},
                  .height = {INFINITY, -INFINITY}, .rise_x = {INFINITY, -INFINITY},
                  .rise_y = {INFINITY, -INFINITY}};
    if (!narrow(&b))
        return s;
    fit_plane(&b, s.slope);
    measure(&b, &s);
    const float overlap = cell_overlap * (float)(1u << b.grid->level);
    for (int k = 0; k < 2; ++k) {
        s.low[k] = texel(&b, k, b.low[k]) - overlap;
        s.high[k] = texel(&b, k, b.high[k]) + overlap;
    }
    /* Within the overlap the height field goes on as steeply as it may. */
    const float off = margin + overlap * (fmaxf(-s.rise_x[0], s.rise_x[1]) +
                                          fmaxf(-s.rise_y[0], s.rise_y[1]));
    s.height[0] -= off;
    s.height[1] += off;
    return s;
}

void gtx_grid_slabs(const gtx_patch *patch, const gtx_grid *grid, gtx_slab *out)
{
    const uint32_t cells[2] = {grid->nodes_x - 1, grid->nodes_y - 1};
    for (uint32_t j = 0; j < cells[1]; j += GTX_SLAB_CELLS)
        for (uint32_t i = 0; i < cells[0]; i += GTX_SLAB_CELLS)
            *out++ = slab_of((block){grid, {i, j},
                                     {min_u32(i + GTX_SLAB_CELLS, cells[0]),
                                      min_u32(j + GTX_SLAB_CELLS, cells[1])},
                                     {patch->rect[2] - 1u, patch->rect[3] - 1u}});
}
