/* Cells whose bilinear surface is too far from their two halves, which are then divided. Its
 * sides are straight, so cells beside it follow it exactly. */
#include "frame/grid.h"

#include <math.h>
#include <string.h>

/* Of a cell; and those that a side is cut into. */
enum { PARTS = GTX_GRID_PARTS, SIDE_PARTS = 2 };

gtx_division gtx_cell_division(const gtx_refining *r, int64_t x, int64_t y)
{
    if (!(r->code > 0) || x < 0 || y < 0 || x + 1 >= r->row ||
        y >= (int64_t)r->rtin->rows * GTX_RTIN_CELLS)
        return GTX_CELL_HALVES;
    const gtx_rtin_node *n = &r->nodes[(size_t)y * r->row + (size_t)x];
    const double twist = (double)gtx_rtin_twist(n, r->row);
    if (!(n->bits & GTX_RTIN_SOLID) || !(twist > 0))
        return GTX_CELL_HALVES;
    const double middle = 0.25 * (n[0].code + n[1].code + n[r->row].code + n[r->row + 1].code);
    const double spread = fmax(fmax(fabs(n[0].code - middle), fabs(n[1].code - middle)),
                               fmax(fabs(n[r->row].code - middle),
                                    fabs(n[r->row + 1].code - middle)));
    const double w = r->w[0] * ((double)x + 0.5) + r->w[1] * ((double)y + 0.5) +
                     r->w[2] * middle + r->w[3] - r->reach_of_cell - fabs(r->w[2]) * spread;
    const double error = twist * r->code;
    return error > 4 * w ? GTX_CELL_PARTS : error > w ? GTX_CELL_QUARTERS : GTX_CELL_HALVES;
}

/* Triangles of half a cell so far. */
typedef struct cut {
    uint32_t count, (*out)[3][2];
} cut;

static void add(cut *c, const uint32_t p[2], const uint32_t q[2], const uint32_t o[2])
{
    uint32_t (*to)[2] = c->out[c->count++];
    memcpy(to[0], p, sizeof to[0]);
    memcpy(to[1], q, sizeof to[1]);
    memcpy(to[2], o, sizeof to[2]);
}

/* The point of a line that is k parts away from its first end. */
static void point_of(const uint32_t p[2], const uint32_t q[2], uint32_t k, uint32_t out[2])
{
    for (int a = 0; a < 2; ++a)
        out[a] = ((SIDE_PARTS - k) * p[a] + k * q[a]) / SIDE_PARTS;
}

/* Triangles from the first `count` parts of a side to a point beyond. */
static void add_fan(cut *c, const uint32_t p[2], const uint32_t q[2], uint32_t count,
                    const uint32_t to[2])
{
    for (uint32_t k = 0; k < count; ++k) {
        uint32_t from[2], next[2];
        point_of(p, q, k, from);
        point_of(p, q, k + 1, next);
        add(c, from, next, to);
    }
}

/* A fourth of the cell, and half of two: around the middle of each. */
static void add_parts(cut *c, uint32_t corner[3][2])
{
    const uint32_t *a = corner[0], *b = corner[1], *o = corner[2];
    uint32_t beside_a[2], beside_b[2], middle[2], inner[2], toward_a[2], toward_b[2];
    point_of(o, a, 1, beside_a);
    point_of(o, b, 1, beside_b);
    point_of(a, b, 1, middle);
    point_of(o, middle, 1, inner);
    point_of(a, middle, 1, toward_a);
    point_of(b, middle, 1, toward_b);
    add(c, o, beside_a, inner);
    add(c, beside_a, middle, inner);
    add(c, middle, beside_b, inner);
    add(c, beside_b, o, inner);
    add(c, beside_a, a, toward_a);
    add(c, middle, beside_a, toward_a);
    add(c, beside_b, middle, toward_b);
    add(c, b, beside_b, toward_b);
}

/* Whether the cell beyond the side from p to q of the cell at `cell` has points on it. */
static bool is_cut(const gtx_refining *r, const uint32_t cell[2], const uint32_t p[2],
                   const uint32_t q[2])
{
    int64_t beyond[2];
    for (int k = 0; k < 2; ++k)
        beyond[k] = p[k] != q[k] ? cell[k] : p[k] == cell[k] * PARTS ? (int64_t)cell[k] - 1
                                                                     : (int64_t)cell[k] + 1;
    return gtx_cell_division(r, beyond[0], beyond[1]) == GTX_CELL_PARTS;
}

uint32_t gtx_divide_half(const gtx_refining *r, uint32_t corner[3][2],
                         uint32_t out[GTX_HALF_TRIANGLES][3][2])
{
    const uint32_t *a = corner[0], *b = corner[1], *o = corner[2];
    uint32_t cell[2], middle[2];
    cut c = {0, out};
    for (int k = 0; k < 2; ++k) {
        middle[k] = (a[k] + b[k]) / 2;
        cell[k] = middle[k] / PARTS;
    }
    const gtx_division division = gtx_cell_division(r, cell[0], cell[1]);
    if (division == GTX_CELL_PARTS) {
        add_parts(&c, corner);
        return c.count;
    }
    const bool cut_a = is_cut(r, cell, o, a), cut_b = is_cut(r, cell, b, o);
    if (division == GTX_CELL_QUARTERS) {
        if (cut_a)
            add_fan(&c, o, a, SIDE_PARTS, middle);
        else
            add(&c, o, a, middle);
        if (cut_b)
            add_fan(&c, b, o, SIDE_PARTS, middle);
        else
            add(&c, b, o, middle);
    } else if (cut_a && cut_b) {
        uint32_t last[2];
        point_of(b, o, SIDE_PARTS - 1, last);
        add_fan(&c, b, o, SIDE_PARTS - 1, a);
        add_fan(&c, o, a, SIDE_PARTS, last);
    } else if (cut_a) {
        add_fan(&c, o, a, SIDE_PARTS, b);
    } else if (cut_b) {
        add_fan(&c, b, o, SIDE_PARTS, a);
    } else {
        add(&c, a, b, o);
    }
    return c.count;
}
