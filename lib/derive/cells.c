/* Height fields for the GPU: codes, or corner cells with the four codes of a cell in one texel; and
 * a level's distance from the finest one. */
#include "derive/codes.h"

#include "base/bytes.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Corners of a row of cells, and 0 where there is no cell. */
static void pack_8(const uint16_t *row, const uint16_t *next, const uint8_t *solid, size_t cells,
                   uint8_t *out)
{
    for (size_t i = 0; i < cells; ++i) {
        const uint32_t corners = row[i] | (uint32_t)row[i + 1] << 8 | (uint32_t)next[i] << 16 |
                                 (uint32_t)next[i + 1] << 24;
        const uint32_t texel = solid[i] ? gtx_first_low_u32(corners) : 0;
        memcpy(out + 4 * i, &texel, 4);
    }
}

static void pack_16(const uint16_t *row, const uint16_t *next, const uint8_t *solid, size_t cells,
                    uint8_t *out)
{
    for (size_t i = 0; i < cells; ++i) {
        const uint16_t corners[4] = {row[i], row[i + 1], next[i], next[i + 1]};
        if (solid[i])
            memcpy(out + 8 * i, corners, 8);
        else
            memset(out + 8 * i, 0, 8);
    }
}

void gtx_grid_cells(const gtx_grid *grid, uint32_t height_bits, size_t row_texels, void *out)
{
    const size_t cells = grid->nodes_x - 1, texel_size = height_bits / 2;
    for (size_t j = 0; j + 1 < grid->nodes_y; ++j) {
        const uint16_t *row = grid->code + j * grid->nodes_x, *next = row + grid->nodes_x;
        uint8_t *to = (uint8_t *)out + j * row_texels * texel_size;
        (height_bits == 8 ? pack_8 : pack_16)(row, next, grid->solid + j * cells, cells, to);
    }
}

/* The codes of a row of nodes, and 0 of those that are no cell's corner: beside them, from the
 * cells above and below. */
static void pack_nodes(const gtx_grid *grid, size_t j, size_t code_size, uint8_t *out)
{
    const size_t cells = grid->nodes_x - 1, last = grid->nodes_y - 2;
    const uint8_t *above = grid->solid + (j ? j - 1 : 0) * cells;
    const uint8_t *below = grid->solid + (j > last ? last : j) * cells;
    const uint16_t *row = grid->code + j * grid->nodes_x;
    uint8_t left = 0;
    for (size_t i = 0; i <= cells; ++i) {
        const uint8_t right = i < cells ? above[i] | below[i] : 0;
        const uint16_t code = left | right ? row[i] : 0;
        if (code_size == 1)
            out[i] = (uint8_t)code;
        else
            memcpy(out + 2 * i, &code, 2);
        left = right;
    }
}

/* The corners of a row of cells, two in each of two rows of codes. */
static void pack_pairs(const gtx_grid *grid, size_t j, size_t code_size, size_t row_codes,
                       uint8_t *out)
{
    const size_t cells = grid->nodes_x - 1;
    for (size_t k = 0; k < 2; ++k, out += row_codes * code_size) {
        const uint16_t *row = grid->code + (j + k) * grid->nodes_x;
        const uint8_t *solid = grid->solid + j * cells;
        for (size_t i = 0; i < cells; ++i) {
            const uint16_t pair[2] = {solid[i] ? row[i] : 0, solid[i] ? row[i + 1] : 0};
            const uint8_t narrow[2] = {(uint8_t)pair[0], (uint8_t)pair[1]};
            memcpy(out + 2 * i * code_size, code_size == 1 ? (const void *)narrow : pair,
                   2 * code_size);
        }
    }
}

void gtx_grid_codes(const gtx_grid *grid, uint32_t height_bits, size_t row_codes, void *out)
{
    const size_t size = height_bits / 8;
    uint8_t *to = out;
    for (size_t j = 0; !grid->level && j < grid->nodes_y; ++j)
        pack_nodes(grid, j, size, to + j * row_codes * size);
    for (size_t j = 0; grid->level && j + 1 < grid->nodes_y; ++j)
        pack_pairs(grid, j, size, row_codes, to + 2 * j * row_codes * size);
}

/* A level's height field over texel (x, y): its height in codes, and its slopes in codes a
 * texel. */
typedef struct gtx_surface {
    double z, dx, dy;
} gtx_surface;

static gtx_surface surface_at(const gtx_grid *grid, const gtx_patch *patch, uint32_t x, uint32_t y)
{
    const uint32_t last[2] = {patch->rect[2] - 1u, patch->rect[3] - 1u}, at[2] = {x, y};
    const uint32_t cells[2] = {grid->nodes_x - 1, grid->nodes_y - 1};
    uint32_t cell[2];
    double f[2], width[2];
    for (int a = 0; a < 2; ++a) {
        cell[a] = at[a] >> grid->level < cells[a] ? at[a] >> grid->level : cells[a] - 1;
        const uint32_t low = cell[a] << grid->level, step = 1u << grid->level;
        width[a] = low + step < last[a] ? step : last[a] - low;
        f[a] = (at[a] - low) / width[a];
    }
    const uint16_t *row = grid->code + (size_t)cell[1] * grid->nodes_x + cell[0];
    const uint16_t *next = row + grid->nodes_x;
    const double low = (1 - f[0]) * row[0] + f[0] * row[1];
    const double high = (1 - f[0]) * next[0] + f[0] * next[1];
    const double dx = (1 - f[1]) * (row[1] - row[0]) + f[1] * (next[1] - next[0]);
    return (gtx_surface){(1 - f[1]) * low + f[1] * high, dx / width[0], (high - low) / width[1]};
}

double gtx_square_to(const gtx_patch *p, const double step[3], double dx, double dy)
{
    double u[3], v[3], along = 0, length = 0;
    for (int k = 0; k < 3; ++k) {
        u[k] = step[0] * p->axis_x[k] + dx * step[2] * p->axis_z[k];
        v[k] = step[1] * p->axis_y[k] + dy * step[2] * p->axis_z[k];
    }
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const double n = u[a] * v[b] - u[b] * v[a];
        along += n * p->axis_z[k];
        length += n * n;
    }
    return fabs(along) * step[2] / sqrt(length);
}

/* From a texel inside the outline on, distances count GTX_BORDER_COUNTS times. */
static const uint8_t border_code = GTX_TRIM_OUTLINE - GTX_TRIM_TEXEL;

static void weigh(const uint8_t *trim, uint32_t count, float *out)
{
    for (uint32_t i = 0; i < count; ++i)
        out[i] = trim[i] > border_code ? GTX_BORDER_COUNTS : 1;
}

/* Heights over `count` texels of each of some cells of a row, from the heights at their sides;
 * a cell is `width` texels wide. */
static inline void lay_cells(const float *side, uint32_t cells, uint32_t width, uint32_t count,
                             float *out)
{
    const float share = 1 / (float)width;
    for (uint32_t c = 0; c < cells; ++c) {
        const float rise = (side[c + 1] - side[c]) * share;
        for (uint32_t i = 0; i < count; ++i)
            *out++ = side[c] + (float)i * rise;
    }
}

/* The same with steps that are known, for vectors. */
static void lay_whole_cells(const float *side, uint32_t cells, uint32_t step, float *out)
{
    switch (step) {
    case 2: lay_cells(side, cells, 2, 2, out); break;
    case 4: lay_cells(side, cells, 4, 4, out); break;
    case 8: lay_cells(side, cells, 8, 8, out); break;
    default: lay_cells(side, cells, step, step, out);
    }
}

/* What is measured between a patch's height field at a level and at level 0. */
typedef struct comparison {
    const gtx_patch *patch;
    const gtx_grid *finest, *grid;
    const uint8_t *trim;      /* code of texel (0, 0) */
    size_t row_texels;        /* from one code to that below */
    double step[3];           /* object units a texel, and a code */
    double greatest;          /* so far, object units */
} comparison;

/* Texels of a row from (x0, y) on: their codes, what the level's height field has there, and how
 * much a distance counts. */
typedef struct run {
    uint32_t x0, y, count;
    float texels[GTX_CODES_RUN], field[GTX_CODES_RUN], weights[GTX_CODES_RUN];
} run;

/* The distance of a texel from the height field as floats have it. NaNs are not beyond any
 * limit. */
static inline float distance_of(const run *r, uint32_t i)
{
    return fabsf(r->field[i] - r->texels[i]) * r->weights[i];
}

/* Of the texels first to end - 1, in turn, those beyond the limit. */
static void compare_exactly(comparison *c, const run *r, uint32_t first, uint32_t end, float limit)
{
    for (uint32_t i = first; i < end; ++i) {
        if (!(distance_of(r, i) > limit))
            continue;
        const gtx_surface s = surface_at(c->grid, c->patch, r->x0 + i, r->y);
        const double codes = fabs(s.z - r->texels[i]) * (double)r->weights[i];
        /* or it cannot be greater square to the height field */
        if (codes * c->step[2] > c->greatest)
            c->greatest = fmax(c->greatest, codes * gtx_square_to(c->patch, c->step, s.dx, s.dy));
    }
}

/* Whether a texel is so far from the height field. */
static bool any_beyond(const run *r, uint32_t first, uint32_t end, float limit)
{
    int beyond = 0;
    for (uint32_t i = first; i < end; ++i)
        beyond |= distance_of(r, i) > limit;
    return beyond;
}

/* Of a row of texels, those over cells first to end - 1 of the level. */
static void compare_run(comparison *c, uint32_t first, uint32_t end, uint32_t y)
{
    enum { PIECE = 16 };
    const gtx_grid *grid = c->grid;
    const uint32_t step = 1u << grid->level, cells_y = grid->nodes_y - 1;
    const uint32_t j = y >> grid->level < cells_y ? y >> grid->level : cells_y - 1;
    const uint32_t low = j << grid->level, last = c->finest->nodes_y - 1;
    const float f = (float)(y - low) / (float)(low + step < last ? step : last - low);
    const uint16_t *row = grid->code + (size_t)j * grid->nodes_x + first;
    const uint16_t *next = row + grid->nodes_x;
    float side[GTX_CODES_RUN];
    for (uint32_t i = 0; i <= end - first; ++i)
        side[i] = (float)row[i] + f * (float)(next[i] - row[i]);
    /* The last cell of a row may be narrower, and has texels on both of its sides. */
    const bool ends = end == grid->nodes_x - 1;
    const uint32_t x0 = first << grid->level, whole = end - first - ends;
    const uint32_t rest = ends ? c->finest->nodes_x - x0 - whole * step : 0;
    run r;
    r.x0 = x0;
    r.y = y;
    r.count = whole * step + rest;
    gtx_load_codes(c->finest, x0, r.count, y, r.texels);
    weigh(c->trim + y * c->row_texels + x0, r.count, r.weights);
    lay_whole_cells(side, whole, step, r.field);
    if (ends)
        lay_cells(side + whole, 1, rest - 1, rest, r.field + whole * step);
    for (uint32_t i = 0; i < r.count; i += PIECE) {
        const uint32_t piece_end = r.count - i < PIECE ? r.count : i + PIECE;
        /* Floats are off by less than this. */
        const float limit = (float)(0.9999 * c->greatest / c->step[2]) - 0.05f * GTX_BORDER_COUNTS;
        if (any_beyond(&r, i, piece_end, limit))
            compare_exactly(c, &r, i, piece_end, limit);
    }
}

double gtx_grid_error(const gtx_asset *asset, uint32_t patch, const gtx_grid *finest,
                      const gtx_grid *grid)
{
    const gtx_patch *p = &asset->patches[patch];
    const uint32_t row_texels = asset->info.page_width;
    const size_t row = (size_t)p->page * asset->info.page_height + p->rect[1];
    comparison c = {p, finest, grid, asset->trim + row * row_texels + p->rect[0], row_texels,
                    {(double)p->extent_x / p->rect[2], (double)p->extent_y / p->rect[3],
                     gtx_height_step(p, asset->info.height_bits)}, 0};
    /* What the wider limit of the trim lets stick out. */
    c.greatest = GTX_TRIM_SHOWN * ((1u << grid->level) - 1) * fmax(c.step[0], c.step[1]);
    /* The difference of two bilinear height fields is greatest at a corner of the finer cells. */
    const uint32_t cells = (GTX_CODES_RUN >> grid->level) - 1, width = grid->nodes_x - 1;
    for (uint32_t y = 0; grid->level && y < finest->nodes_y; ++y)
        for (uint32_t first = 0; first < width; first += cells)
            compare_run(&c, first, first + cells < width ? first + cells : width, y);
    return c.greatest;
}
