/* Cells whose bilinear surface is too far from their two halves, which are then divided. Its
 * sides are straight, so cells beside it follow it exactly. */
#include "frame/grid.h"

#include <math.h>
#include <string.h>

/* Of a cell; and those that a side is cut into. */
enum { PARTS = GTX_GRID_PARTS, SIDE_PARTS = 2, ROW = GTX_BLOCK_ROW };

/* How a cell is drawn: as two halves, which are as far from its surface as its diagonal; as four
 * triangles around its middle, which are a fourth as far from it; or so its four parts, a fourth
 * as far again. */
enum { HALVES = 0, QUARTERS = 1, IN_PARTS = 2 };

static double greater(double a, double b)
{
    return a > b ? a : b;
}

static uint8_t division_of(const gtx_refining *r, const gtx_refined *block, uint32_t at)
{
    const gtx_rtin_node *n = &block->nodes[at];
    const uint32_t a = n[0].code, b = n[1].code, c = n[ROW].code, d = n[ROW + 1].code;
    const double x = block->x + at % ROW - 0.5, y = block->y + at / ROW - 0.5;
    const double middle = 0.25 * (a + b + c + d);
    const double spread = greater(greater(fabs(a - middle), fabs(b - middle)),
                                  greater(fabs(c - middle), fabs(d - middle)));
    const double w = r->w[0] * x + r->w[1] * y + r->w[2] * middle + r->w[3] - r->reach_of_cell -
                     fabs(r->w[2]) * spread;
    const double error = 0.25 * gtx_rtin_twist(n, ROW) * r->code;
    return error > 4 * w ? IN_PARTS : error > w ? QUARTERS : HALVES;
}

static void find_divided(const gtx_refining *r, gtx_refined *b)
{
    enum { CELLS = GTX_RTIN_CELLS + 2 };
    uint8_t twisted[CELLS * CELLS]; /* which they are cannot be foreseen: no branch asks */
    uint32_t count = 0;
    b->found = true;
    memset(b->divided, HALVES, sizeof b->divided);
    memset(b->places, 0xff, sizeof b->places);
    for (uint32_t y = 0; y < CELLS; ++y)
        for (uint32_t at = ROW * y; at < ROW * y + CELLS; ++at) {
            const gtx_rtin_node *n = &b->nodes[at];
            twisted[count] = (uint8_t)at;
            count += (gtx_rtin_twist(n, ROW) > b->twist) & (n->bits / GTX_RTIN_SOLID & 1);
        }
    for (uint32_t i = 0; i < count; ++i)
        b->divided[twisted[i]] = division_of(r, b, twisted[i]);
}

bool gtx_is_divided(const gtx_refining *r, gtx_refined *b, const uint8_t cell[2])
{
    if (!b->found)
        find_divided(r, b);
    const uint8_t *d = &b->divided[gtx_block_node(cell[0], cell[1])];
    return *d || (d[-1] | d[1] | d[-ROW] | d[ROW]) & IN_PARTS;
}

/* Triangles of half a cell so far. */
typedef struct cut {
    const gtx_refined *block;
    uint32_t count;
    gtx_grid_point (*out)[3];
} cut;

static void add(cut *c, gtx_grid_point p, gtx_grid_point q, gtx_grid_point o)
{
    gtx_grid_point *to = c->out[c->count++];
    to[0] = p;
    to[1] = q;
    to[2] = o;
}

/* Half way. */
static gtx_grid_point between(const gtx_refined *b, gtx_grid_point p, gtx_grid_point q)
{
    const uint32_t x = (p.x + q.x) / SIDE_PARTS, y = (p.y + q.y) / SIDE_PARTS;
    const uint32_t i = x % PARTS, j = y % PARTS;
    const gtx_rtin_node *n = &b->nodes[gtx_block_node(x / PARTS, y / PARTS)];
    return (gtx_grid_point){x, y, (PARTS - j) * ((PARTS - i) * n[0].code + i * n[1].code) +
                                      j * ((PARTS - i) * n[ROW].code + i * n[ROW + 1].code)};
}

/* Triangles from a side, as a whole or from its parts, to a point beyond. */
static void add_side(cut *c, bool is_cut, gtx_grid_point p, gtx_grid_point q, gtx_grid_point to)
{
    const gtx_grid_point middle = is_cut ? between(c->block, p, q) : q;
    add(c, p, middle, to);
    if (is_cut)
        add(c, middle, q, to);
}

/* A fourth of the cell, and half of two: around the middle of each. */
static void add_parts(cut *c, const gtx_grid_point corner[3])
{
    const gtx_refined *block = c->block;
    const gtx_grid_point a = corner[0], b = corner[1], o = corner[2], middle = between(block, a, b);
    const gtx_grid_point beside_a = between(block, o, a), beside_b = between(block, o, b);
    const gtx_grid_point inner = between(block, o, middle), toward_a = between(block, a, middle);
    const gtx_grid_point toward_b = between(block, b, middle);
    add(c, o, beside_a, inner);
    add(c, beside_a, middle, inner);
    add(c, middle, beside_b, inner);
    add(c, beside_b, o, inner);
    add(c, beside_a, a, toward_a);
    add(c, middle, beside_a, toward_a);
    add(c, beside_b, middle, toward_b);
    add(c, b, beside_b, toward_b);
}

/* Whether the cell beyond the side from p to q of a cell has points on it. */
static bool is_cut(const uint8_t *divided, const uint8_t cell[2], gtx_grid_point p,
                   gtx_grid_point q)
{
    const int beyond = p.x == q.x ? p.x == PARTS * cell[0] ? -1 : 1
                                  : p.y == PARTS * cell[1] ? -ROW : ROW;
    return divided[beyond] == IN_PARTS;
}

uint32_t gtx_divide_half(const gtx_refined *block, const uint8_t cell[2],
                         const gtx_grid_point corner[3],
                         gtx_grid_point out[GTX_HALF_TRIANGLES][3])
{
    const gtx_grid_point a = corner[0], b = corner[1], o = corner[2];
    const uint8_t *divided = &block->divided[gtx_block_node(cell[0], cell[1])];
    const bool cut_a = is_cut(divided, cell, o, a), cut_b = is_cut(divided, cell, b, o);
    cut c = {block, 0, out};
    if (*divided == IN_PARTS) {
        add_parts(&c, corner);
    } else if (*divided == QUARTERS) {
        const gtx_grid_point middle = between(block, a, b);
        add_side(&c, cut_a, o, a, middle);
        add_side(&c, cut_b, b, o, middle);
    } else if (cut_a) {
        const gtx_grid_point last = cut_b ? between(block, b, o) : b;
        if (cut_b)
            add(&c, b, last, a);
        add_side(&c, true, o, a, last);
    } else if (cut_b) {
        add_side(&c, true, b, o, a);
    } else {
        add(&c, a, b, o);
    }
    return c.count;
}
