/* Slabs: slanted boxes, each close around a block of a level's cells. */
#include "derive/derive.h"

#include <math.h>
#include <stdbool.h>

/* How far slabs overlap, in cells, and stand off the sheet, in codes: rounding must neither open a
 * seam between neighbours nor cut the sheet off. */
static const float cell_overlap = 0.0002f, margin = 0.05f;

/* Cells of a grid, from low to high. */
typedef struct block {
    const gtx_grid *grid;
    uint32_t low[2], high[2]; /* inclusive */
    uint32_t last[2];         /* texel of the patch */
} block;

static uint32_t min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static uint32_t max_u32(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
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

static bool is_solid(const block *b, uint32_t i, uint32_t j)
{
    return b->grid->solid[(size_t)j * (b->grid->nodes_x - 1) + i];
}

/* Narrows the block to its solid cells; false when there is none. */
static bool narrow(block *b)
{
    block tight = {b->grid, {UINT32_MAX, UINT32_MAX}, {0, 0}, {b->last[0], b->last[1]}};
    for (uint32_t j = b->low[1]; j <= b->high[1]; ++j)
        for (uint32_t i = b->low[0]; i <= b->high[0]; ++i)
            if (is_solid(b, i, j)) {
                tight.low[0] = min_u32(tight.low[0], i);
                tight.low[1] = min_u32(tight.low[1], j);
                tight.high[0] = max_u32(tight.high[0], i);
                tight.high[1] = j;
            }
    *b = tight;
    return b->low[0] != UINT32_MAX;
}

/* The plane of least squares through the low corners of the solid cells: z = a x + b y + ... Few
 * cells do not tell a slope, and hold it back. */
static void fit_plane(const block *b, float *a, float *c)
{
    double n = 0, x = 0, y = 0, z = 0, xx = 1, xy = 0, yy = 1, xz = 0, yz = 0;
    for (uint32_t j = b->low[1]; j <= b->high[1]; ++j)
        for (uint32_t i = b->low[0]; i <= b->high[0]; ++i) {
            if (!is_solid(b, i, j))
                continue;
            const double u = i - b->low[0], v = j - b->low[1];
            const double w = b->grid->code[(size_t)j * b->grid->nodes_x + i];
            n += 1, x += u, y += v, z += w;
            xx += u * u, xy += u * v, yy += v * v, xz += u * w, yz += v * w;
        }
    xx -= x * x / n, xy -= x * y / n, yy -= y * y / n, xz -= x * z / n, yz -= y * z / n;
    const double det = (xx * yy - xy * xy) * (double)(1u << b->grid->level);
    *a = (float)((xz * yy - yz * xy) / det);
    *c = (float)((yz * xx - xz * xy) / det);
}

static void extend(float range[2], float value)
{
    range[0] = value < range[0] ? value : range[0];
    range[1] = value > range[1] ? value : range[1];
}

/* Takes a cell in: its corners over the plane, and the slopes of its sides against it. */
static void take_cell(const block *b, uint32_t i, uint32_t j, gtx_slab *s)
{
    const uint16_t *row = b->grid->code + (size_t)j * b->grid->nodes_x + i;
    const uint16_t *next = row + b->grid->nodes_x;
    const float x[2] = {texel(b, 0, i), texel(b, 0, i + 1)};
    const float y[2] = {texel(b, 1, j), texel(b, 1, j + 1)};
    const float code[2][2] = {{row[0], row[1]}, {next[0], next[1]}};
    for (int k = 0; k < 4; ++k)
        extend(s->height, code[k >> 1][k & 1] - s->slope[0] * x[k & 1] - s->slope[1] * y[k >> 1]);
    for (int k = 0; k < 2; ++k) {
        extend(s->rise_x, (code[k][1] - code[k][0]) / (x[1] - x[0]) - s->slope[0]);
        extend(s->rise_y, (code[1][k] - code[0][k]) / (y[1] - y[0]) - s->slope[1]);
    }
}

static gtx_slab slab_of(block b)
{
    gtx_slab s = {.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY},
                  .height = {INFINITY, -INFINITY}, .rise_x = {INFINITY, -INFINITY},
                  .rise_y = {INFINITY, -INFINITY}};
    if (!narrow(&b))
        return s;
    fit_plane(&b, &s.slope[0], &s.slope[1]);
    for (uint32_t j = b.low[1]; j <= b.high[1]; ++j)
        for (uint32_t i = b.low[0]; i <= b.high[0]; ++i)
            if (is_solid(&b, i, j))
                take_cell(&b, i, j, &s);
    const float overlap = cell_overlap * (float)(1u << b.grid->level);
    for (int k = 0; k < 2; ++k) {
        s.low[k] = texel(&b, k, b.low[k]) - overlap;
        s.high[k] = texel(&b, k, b.high[k] + 1) + overlap;
    }
    /* Within the overlap the sheet goes on as steeply as it may. */
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
                                     {min_u32(i + GTX_SLAB_CELLS, cells[0]) - 1,
                                      min_u32(j + GTX_SLAB_CELLS, cells[1]) - 1},
                                     {patch->rect[2] - 1u, patch->rect[3] - 1u}});
}
