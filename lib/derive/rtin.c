/* Networks of right triangles: their triangles, and the error of each. */
#include "derive/rtin.h"

#include "asset/patch.h"
#include "base/alloc.h"
#include "base/error.h"
#include "derive/codes.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { CELLS = GTX_RTIN_CELLS, NODES = CELLS + 1, PART = 2, PARTS = CELLS / PART };

/* Bounds of a triangle, in cells. */
typedef struct bounds {
    uint32_t low[2], high[2];
} bounds;

static bounds bounds_of(const gtx_rtin_triangle *t)
{
    bounds b = {{CELLS, CELLS}, {0, 0}};
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 2; ++k) {
            const uint32_t at = t->corner[c][k];
            b.low[k] = at < b.low[k] ? at : b.low[k];
            b.high[k] = at > b.high[k] ? at : b.high[k];
        }
    return b;
}

/* Twice the area of corners a and b with a point, in units of the point: halves of cells if
 * `scale` is 2. */
static int32_t area(const uint8_t a[2], const uint8_t b[2], int32_t x, int32_t y, int32_t scale)
{
    return (scale * b[0] - scale * a[0]) * (y - scale * a[1]) -
           (scale * b[1] - scale * a[1]) * (x - scale * a[0]);
}

static bool is_over(const gtx_rtin_triangle *t, int32_t x, int32_t y, int32_t scale)
{
    return area(t->corner[0], t->corner[1], x, y, scale) >= 0 &&
           area(t->corner[1], t->corner[2], x, y, scale) >= 0 &&
           area(t->corner[2], t->corner[0], x, y, scale) >= 0;
}

/* A cell's diagonal is an edge or outside: its middle tells whether half of it is inside. */
static uint16_t parts_of(const gtx_rtin_triangle *t)
{
    const bounds b = bounds_of(t);
    uint16_t parts = 0;
    for (uint32_t y = b.low[1]; y < b.high[1]; ++y)
        for (uint32_t x = b.low[0]; x < b.high[0]; ++x)
            if (is_over(t, 2 * (int32_t)x + 1, 2 * (int32_t)y + 1, 2))
                parts |= (uint16_t)(1u << (y / PART * PARTS + x / PART));
    return parts;
}

/* From corners a to c, the last the right angle. */
static gtx_rtin_triangle triangle(const uint8_t a[2], const uint8_t b[2], const uint8_t c[2])
{
    gtx_rtin_triangle t = {.parts = 0};
    for (int k = 0; k < 2; ++k) {
        t.corner[0][k] = a[k];
        t.corner[1][k] = b[k];
        t.corner[2][k] = c[k];
        t.middle[k] = (uint8_t)((a[k] + b[k]) / 2);
    }
    return t;
}

/* All but their parts. */
static void halve(gtx_rtin_triangle out[GTX_RTIN_TRIANGLES])
{
    static const uint8_t corner[4][2] = {{0, 0}, {CELLS, 0}, {0, CELLS}, {CELLS, CELLS}};
    out[0] = out[1] = (gtx_rtin_triangle){.parts = 0};
    out[2] = triangle(corner[3], corner[0], corner[1]);
    out[3] = triangle(corner[0], corner[3], corner[2]);
    for (uint32_t t = 2; t < GTX_RTIN_LEAF; ++t) {
        const gtx_rtin_triangle *whole = &out[t];
        out[2 * t] = triangle(whole->corner[2], whole->corner[0], whole->middle);
        out[2 * t + 1] = triangle(whole->corner[1], whole->corner[2], whole->middle);
    }
}

void gtx_rtin_triangles(gtx_rtin_triangle out[GTX_RTIN_TRIANGLES])
{
    halve(out);
    for (uint32_t t = 2; t < GTX_RTIN_TRIANGLES; ++t)
        out[t].parts = parts_of(&out[t]);
}

static float greater(float a, float b)
{
    return a > b ? a : b;
}

/* A patch's network in the making. */
typedef struct making {
    gtx_rtin_triangle triangles[GTX_RTIN_TRIANGLES];
    gtx_rtin *rtin;
    gtx_rtin_node *nodes;
    float *error;             /* of each node, in object units */
    uint32_t row;             /* of nodes */
} making;

/* A block: codes of its nodes; how much distances from them count, 0 where no cell that shows has
 * the node; and which cells do. */
typedef struct block {
    float code[NODES * NODES], counts[NODES * NODES];
    bool solid[CELLS][CELLS];
} block;

static void load(const making *m, const gtx_grid *grid, uint32_t x, uint32_t y, block *b)
{
    for (uint32_t j = 0, n = 0; j < NODES; ++j)
        for (uint32_t i = 0; i < NODES; ++i, ++n) {
            b->code[n] = m->nodes[(size_t)(y + j) * m->row + x + i].code;
            b->counts[n] = 0;
        }
    for (uint32_t j = 0; j < CELLS; ++j)
        for (uint32_t i = 0; i < CELLS; ++i) {
            const bool within = x + i + 1 < grid->nodes_x && y + j + 1 < grid->nodes_y;
            b->solid[j][i] =
                within && grid->solid[(size_t)(y + j) * (grid->nodes_x - 1) + x + i];
        }
}

/* Nodes of parts at an outline count more. */
static void weigh(block *b, uint16_t whole)
{
    for (uint32_t j = 0; j < CELLS; ++j)
        for (uint32_t i = 0; i < CELLS; ++i) {
            const bool inner = whole >> (j / PART * PARTS + i / PART) & 1;
            for (uint32_t c = 0; b->solid[j][i] && c < 4; ++c) {
                float *counts = &b->counts[(j + c / 2) * NODES + i + c % 2];
                *counts = greater(*counts, inner ? 1 : GTX_BORDER_COUNTS);
            }
        }
}

/* Which parts show, and which as a whole: without a texel beyond the trim's limit. */
static gtx_rtin_block look_at_parts(const block *b, const uint8_t *trim, size_t row_texels)
{
    const uint8_t limit = (uint8_t)gtx_trim_limit(0);
    gtx_rtin_block out = {0, 0};
    for (uint32_t y = 0, part = 0; y < CELLS; y += PART)
        for (uint32_t x = 0; x < CELLS; x += PART, ++part) {
            bool some = false, whole = true;
            for (uint32_t j = y; j < y + PART; ++j)
                for (uint32_t i = x; i < x + PART; ++i) {
                    some = some || b->solid[j][i];
                    whole = whole && b->solid[j][i];
                }
            for (uint32_t j = y; whole && j <= y + PART; ++j)
                for (uint32_t i = x; i <= x + PART; ++i)
                    whole = whole && trim[j * row_texels + i] <= limit;
            out.some |= (uint16_t)(some << part);
            out.whole |= (uint16_t)(whole << part);
        }
    return out;
}

/* The greater of `most` and the distance, in codes, of nodes from the first on from a line over
 * them. */
static float distance_from(const block *b, int32_t first, int32_t step, int32_t count, float at,
                           float rise, float most)
{
    for (int32_t i = 0; i < count; ++i) {
        const int32_t n = first + i * step;
        most = greater(b->counts[n] * fabsf(at + (float)i * rise - b->code[n]), most);
    }
    return most;
}

static int32_t node_at(const uint8_t at[2])
{
    return at[1] * NODES + at[0];
}

/* The same, in all of a triangle: line by line, along a leg or the longest side, from the right
 * angle on. */
static float distance_of(const block *b, const gtx_rtin_triangle *t, uint32_t level)
{
    const int32_t cells = CELLS >> (level + 1) / 2; /* of a leg; or to the middle */
    const int32_t n[3] = {node_at(t->corner[0]), node_at(t->corner[1]), node_at(t->corner[2])};
    const float z[3] = {b->code[n[0]], b->code[n[1]], b->code[n[2]]};
    float most = 0;
    if (level % 2 == 0) {
        const int32_t across = (n[0] - n[2]) / cells, along = (n[1] - n[2]) / cells;
        const float away = (z[0] - z[2]) / (float)cells, rise = (z[1] - z[2]) / (float)cells;
        for (int32_t i = 0; i <= cells; ++i)
            most = distance_from(b, n[2] + i * across, along, cells + 1 - i,
                                 z[2] + (float)i * away, rise, most);
        return most;
    }
    const int32_t middle = node_at(t->middle);
    const int32_t across = (middle - n[2]) / cells, along = (n[1] - middle) / cells;
    const float rise = (z[1] - z[0]) / (float)(2 * cells);
    const float away = (z[0] - z[2]) / (float)cells;
    for (int32_t i = 1; i <= cells; ++i)
        most = distance_from(b, n[2] + i * (across - along), along, 2 * i + 1,
                             z[2] + (float)i * away, rise, most);
    return most;
}

/* gtx_square_to of the flattest that a slab holds: of slopes next to none, or for frames askew of
 * an extreme. */
static double flattest(const gtx_patch *p, const double step[3], const gtx_slab *s)
{
    double low[2], high[2], near[2];
    for (int k = 0; k < 2; ++k) {
        const float *rise = k ? s->rise_y : s->rise_x;
        low[k] = (double)s->slope[k] + rise[0];
        high[k] = (double)s->slope[k] + rise[1];
        near[k] = fmax(low[k], fmin(high[k], 0));
    }
    double most = gtx_square_to(p, step, near[0], near[1]);
    for (int c = 0; c < 4; ++c)
        most = fmax(most, gtx_square_to(p, step, c & 1 ? high[0] : low[0],
                                        c & 2 ? high[1] : low[1]));
    return most;
}

/* Of the block that begins at a node. */
static void measure_block(const making *m, const block *b, float *error, double unit)
{
    for (uint32_t t = 2; t < GTX_RTIN_LEAF; ++t) {
        const gtx_rtin_triangle *of = &m->triangles[t];
        float *most = &error[of->middle[1] * m->row + of->middle[0]];
        *most = greater(*most, (float)(distance_of(b, of, gtx_rtin_level(t)) * unit));
    }
}

/* Takes the greatest error of halves to the middles of a level; so that the next coarser one can
 * follow. Middles are in the middle of a square of cells, where the level is even, or of a side. */
static void gather(const making *m, uint32_t level)
{
    static const int32_t around[2][4][2] = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}},
                                            {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
    const int32_t odd = level & 1, half = CELLS >> (level / 2 + 1), away = odd ? half / 2 : half;
    const int32_t width = (int32_t)m->row, height = (int32_t)m->rtin->rows * CELLS + 1;
    for (int32_t y = odd ? 0 : half; y < height; y += odd ? half : 2 * half)
        for (int32_t x = odd && y / half % 2 ? 0 : half; x < width; x += 2 * half) {
            const int32_t own = y * width + x;
            for (int k = 0; k < 4; ++k) {
                const int32_t i = x + away * around[odd][k][0], j = y + away * around[odd][k][1];
                if (i < 0 || j < 0 || i >= width || j >= height)
                    continue;
                const int32_t other = j * width + i;
                const int32_t rise = abs(m->nodes[own].code - m->nodes[other].code);
                if (m->error[other] <= 0)
                    continue;
                m->error[own] = greater(m->error[own], m->error[other]);
                if (rise > m->rtin->rise[level])
                    m->rtin->rise[level] = (uint16_t)rise;
            }
        }
}

/* Errors as numbers of 13 bits, rounded up; what floats cannot tell is the most. */
static void store_errors(const making *m, size_t count)
{
    float most = 0;
    for (size_t i = 0; i < count; ++i)
        most = greater(most, m->error[i] < FLT_MAX ? m->error[i] : FLT_MAX);
    m->rtin->unit = most / GTX_RTIN_MAX_ERROR;
    for (size_t i = 0; i < count; ++i) {
        const float share = m->error[i] < most ? m->error[i] / most : 1;
        const float units = most > 0 ? share * GTX_RTIN_MAX_ERROR : 0;
        const uint16_t below = (uint16_t)units;
        m->nodes[i].bits = (uint16_t)(below + (below < units && below < GTX_RTIN_MAX_ERROR));
    }
}

static void load_codes(const making *m, const gtx_rtin_source *source)
{
    const gtx_grid *finest = source->finest;
    for (uint32_t y = 0; y <= m->rtin->rows * CELLS; ++y)
        for (uint32_t x = 0; x < m->row; ++x) {
            const uint32_t i = x < finest->nodes_x ? x : finest->nodes_x - 1;
            const uint32_t j = y < finest->nodes_y ? y : finest->nodes_y - 1;
            m->nodes[y * m->row + x].code = source->filled[(size_t)j * finest->nodes_x + i];
        }
}

static void measure(const making *m, const gtx_rtin_source *source, gtx_rtin_block *blocks)
{
    const gtx_asset *asset = source->asset;
    const gtx_patch *p = &asset->patches[source->patch];
    const size_t row_texels = asset->info.page_width;
    const uint8_t *trim =
        asset->trim + ((size_t)p->page * asset->info.page_height + p->rect[1]) * row_texels +
        p->rect[0];
    const double step[3] = {(double)p->extent_x / p->rect[2], (double)p->extent_y / p->rect[3],
                            gtx_height_step(p, asset->info.height_bits)};
    for (uint32_t i = 0; i < m->rtin->columns * m->rtin->rows; ++i) {
        const uint32_t x = i % m->rtin->columns * CELLS, y = i / m->rtin->columns * CELLS;
        block b;
        load(m, source->finest, x, y, &b);
        blocks[i] = look_at_parts(&b, trim + y * row_texels + x, row_texels);
        if (!blocks[i].some)
            continue;
        const double unit = flattest(p, step, &source->slabs[i]);
        weigh(&b, blocks[i].whole);
        measure_block(m, &b, m->error + (size_t)y * m->row + x, unit);
        m->rtin->code = greater(m->rtin->code, (float)unit);
    }
    gtx_rtin_add_twist(source->finest, m->rtin, m->nodes, m->error);
}

size_t gtx_rtin_nodes(const gtx_patch *patch)
{
    const size_t columns = (patch->rect[2] - 2u) / CELLS + 1;
    const size_t rows = (patch->rect[3] - 2u) / CELLS + 1;
    return (columns * CELLS + 1) * (rows * CELLS + 1);
}

gtx_result gtx_rtin_build(const gtx_rtin_source *source, const gtx_allocator *allocator,
                          gtx_rtin *out, gtx_rtin_node *nodes, gtx_rtin_block *blocks,
                          gtx_error *error)
{
    const size_t count = gtx_rtin_nodes(&source->asset->patches[source->patch]);
    making m = {.rtin = out, .nodes = nodes,
                .error = gtx_alloc_array(allocator, count, sizeof *m.error)};
    if (!m.error)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a patch's network of triangles");
    *out = (gtx_rtin){.columns = (source->finest->nodes_x - 2) / CELLS + 1,
                      .rows = (source->finest->nodes_y - 2) / CELLS + 1};
    m.row = gtx_rtin_row(out);
    halve(m.triangles);
    load_codes(&m, source);
    measure(&m, source, blocks);
    for (uint32_t level = GTX_RTIN_LEVELS - 1; level-- > 0;)
        gather(&m, level);
    store_errors(&m, count);
    gtx_rtin_mark(source, out, nodes, m.error);
    gtx_free_array(allocator, m.error, count, sizeof *m.error);
    return GTX_OK;
}
