/* Blocks of cells as coarser triangles show them: what they are off by. */
#include "derive/codes.h"

#include "asset/patch.h"

#include <math.h>

enum { CELLS = GTX_SLAB_CELLS, NODES = CELLS + 1 };

/* A block of level 0: its first cell, how many cells there are, the codes of its nodes and which of
 * them belong to a cell that exists. */
typedef struct block {
    uint32_t x, y, cells[2];
    float code[NODES][NODES];
    bool shown[NODES][NODES];
    bool solid[CELLS][CELLS]; /* and those beyond the grid */
} block;

static uint32_t min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static void load(const gtx_grid *grid, const uint16_t *filled, uint32_t x, uint32_t y, block *b)
{
    *b = (block){.x = x, .y = y,
                 .cells = {min_u32(CELLS, grid->nodes_x - 1 - x),
                           min_u32(CELLS, grid->nodes_y - 1 - y)}};
    for (uint32_t j = 0; j <= b->cells[1]; ++j)
        for (uint32_t i = 0; i <= b->cells[0]; ++i)
            b->code[j][i] = filled[(size_t)(y + j) * grid->nodes_x + x + i];
    for (uint32_t j = 0; j < CELLS; ++j)
        for (uint32_t i = 0; i < CELLS; ++i) {
            const bool beyond = i >= b->cells[0] || j >= b->cells[1];
            b->solid[j][i] =
                beyond || grid->solid[(size_t)(y + j) * (grid->nodes_x - 1) + x + i];
            for (int c = 0; b->solid[j][i] && !beyond && c < 4; ++c)
                b->shown[j + (uint32_t)c / 2][i + (uint32_t)c % 2] = true;
        }
}

/* The greatest distance, in codes along z, of a node from triangles over `step` cells: those of
 * geotex_lod.vert, whose cells are cut from corner (0, 0) to (1, 1). */
static float distance_at(const block *b, uint32_t step)
{
    float most = 0;
    for (uint32_t j = 0; j <= b->cells[1]; ++j) {
        const uint32_t y = min_u32(j / step * step, (b->cells[1] - 1) / step * step);
        const uint32_t above = min_u32(y + step, b->cells[1]);
        const float v = (float)(j - y) / (float)(above - y);
        for (uint32_t i = 0; i <= b->cells[0]; ++i) {
            const uint32_t x = min_u32(i / step * step, (b->cells[0] - 1) / step * step);
            const uint32_t right = min_u32(x + step, b->cells[0]);
            const float u = (float)(i - x) / (float)(right - x);
            const float own = b->code[y][x], across = b->code[above][right];
            const float beside = u >= v ? b->code[y][right] : b->code[above][x];
            const float near = u >= v ? u : v, far = u >= v ? v : u;
            const float at = own + near * (beside - own) + far * (across - beside);
            const float distance = fabsf(at - b->code[j][i]);
            most = b->shown[j][i] && distance > most ? distance : most;
        }
    }
    return most;
}

/* gtx_square_to of the flattest that a slab holds, near enough: its plane and its steepest ones. */
static double flattest(const gtx_patch *p, const double step[3], const gtx_slab *s)
{
    double most = gtx_square_to(p, step, s->slope[0], s->slope[1]);
    for (int c = 0; c < 4; ++c)
        most = fmax(most, gtx_square_to(p, step, s->slope[0] + s->rise_x[c & 1],
                                    s->slope[1] + s->rise_y[c >> 1]));
    return most;
}

/* Fills in which parts show, and which as a whole: without a texel beyond the trim's limit. */
static void look_at_parts(const block *b, const uint8_t *trim, size_t row_texels,
                          gtx_block_facts *out)
{
    enum { SIDE = 2 };
    const uint8_t limit = (uint8_t)gtx_trim_limit(0);
    for (uint32_t y = 0, part = 0; y < CELLS; y += SIDE)
        for (uint32_t x = 0; x < CELLS; x += SIDE, ++part) {
            const uint32_t right = min_u32(x + SIDE, b->cells[0]);
            const uint32_t above = min_u32(y + SIDE, b->cells[1]);
            bool some = false, whole = true;
            for (uint32_t j = y; j < above; ++j)
                for (uint32_t i = x; i < right; ++i) {
                    some = some || b->solid[j][i];
                    whole = whole && b->solid[j][i];
                }
            for (uint32_t j = y; j <= above && x < right; ++j)
                for (uint32_t i = x; i <= right && y < above; ++i)
                    whole = whole && trim[(b->y + j) * row_texels + b->x + i] <= limit;
            out->some |= (uint16_t)(some << part);
            out->whole |= (uint16_t)(whole << part);
        }
}

void gtx_grid_blocks(const gtx_asset *asset, uint32_t patch, const gtx_grid *finest,
                     const uint16_t *filled, const gtx_slab *slabs, gtx_block_facts *out)
{
    const gtx_patch *p = &asset->patches[patch];
    const size_t row_texels = asset->info.page_width;
    const uint8_t *trim =
        asset->trim + ((size_t)p->page * asset->info.page_height + p->rect[1]) * row_texels +
        p->rect[0];
    const double step[3] = {(double)p->extent_x / p->rect[2], (double)p->extent_y / p->rect[3],
                            gtx_height_step(p, asset->info.height_bits)};
    block b;
    for (uint32_t y = 0; y + 1 < finest->nodes_y; y += CELLS)
        for (uint32_t x = 0; x + 1 < finest->nodes_x; x += CELLS, ++slabs, ++out) {
            *out = (gtx_block_facts){.some = 0};
            load(finest, filled, x, y, &b);
            look_at_parts(&b, trim, row_texels, out);
            if (!out->some)
                continue;
            const bool whole = out->whole == UINT16_MAX;
            const double unit = flattest(p, step, slabs) * (whole ? 1 : GTX_BORDER_COUNTS);
            for (uint32_t k = 1; k < GTX_BLOCK_STRIDES; ++k) {
                const float error = (float)(distance_at(&b, 1u << k) * unit);
                out->error[k] = error > out->error[k - 1] ? error : out->error[k - 1];
            }
        }
}
