/* Cells whose bilinear surface is too far from their two halves, which are then divided. Its
 * sides are straight, so cells beside it follow it exactly. */
#include "frame/grid.h"

#include <math.h>
#include <string.h>

enum { PARTS = GTX_GRID_PARTS, ROW = GTX_BLOCK_ROW };

/* How a cell is drawn: as two halves, which are as far from its surface as its diagonal; as four
 * triangles around its middle, which are a fourth as far from it; or so its four parts, a fourth
 * as far again. */
enum { HALVES = 0, QUARTERS = 1, IN_PARTS = 2 };

static uint8_t division_of(const gtx_refining *r, const gtx_refined *block, uint32_t at)
{
    const gtx_rtin_node *n = &block->nodes[at];
    const uint32_t a = n[0].code, b = n[1].code, c = n[ROW].code, d = n[ROW + 1].code;
    const double x = block->x + at % ROW - 0.5, y = block->y + at / ROW - 0.5;
    const double middle = 0.25 * (a + b + c + d);
    const double spread = gtx_grid_greater(gtx_grid_greater(fabs(a - middle), fabs(b - middle)),
                                           gtx_grid_greater(fabs(c - middle), fabs(d - middle)));
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

/* Triangles by the points of half a cell, of which there are so many, with no side, the one from o
 * to a, the one from b to o, or both cut by the cell beyond. */
static const char *const triangles[2][4] = {
    {"012", "241401", "150520", "150245405"},
    {"203123", "243403123", "203153523", "243403153523"}};
static const char in_parts[] = "246436356526407347538158";

const char *gtx_divide_half(const gtx_refined *b, const uint8_t cell[2],
                            gtx_grid_point points[GTX_HALF_POINTS])
{
    /* Which two the points after the corners a, b and o are half way between. */
    static const char ends[] = "012021230313";
    const uint8_t *divided = &b->divided[gtx_block_node(cell[0], cell[1])];
    uint32_t cut = 0;
    for (uint32_t k = 0; k < 2; ++k) {
        const gtx_grid_point *p = &points[k], *o = &points[2];
        const int beyond = p->x == o->x ? p->x == PARTS * cell[0] ? -1 : 1
                                        : p->y == PARTS * cell[1] ? -ROW : ROW;
        cut |= (uint32_t)(divided[beyond] == IN_PARTS) << k;
    }
    for (uint32_t k = 3; k < GTX_HALF_POINTS; ++k) {
        const gtx_grid_point *p = &points[ends[2 * k - 6] - '0'];
        const gtx_grid_point *q = &points[ends[2 * k - 5] - '0'];
        const uint32_t x = (p->x + q->x) / 2, y = (p->y + q->y) / 2, i = x % PARTS, j = y % PARTS;
        const gtx_rtin_node *n = &b->nodes[gtx_block_node(x / PARTS, y / PARTS)];
        const uint32_t above = (PARTS - i) * n[0].code + i * n[1].code;
        const uint32_t below = (PARTS - i) * n[ROW].code + i * n[ROW + 1].code;
        points[k] = (gtx_grid_point){x, y, (PARTS - j) * above + j * below};
    }
    return *divided == IN_PARTS ? in_parts : triangles[*divided][cut];
}
