/* Fits hulls closely to the height field: positions of their nodes, height of the lid, depth of
 * walls and floor. */
#include "derive/hull.h"

#include <math.h>

/* How much steeper than the height field at its outline what lies beyond may be. */
static const float steeper = 1.5f;

/* The height at node (bi, bj) of a plane that is as near as can be to the height field of the
 * blocks around. Slopes are held back a little, where few cells do not tell them. */
static float plane_at(const gtx_hull *h, uint32_t bi, uint32_t bj)
{
    gtx_moments m = {.xx = 1, .yy = 1};
    for (uint32_t k = 0; k < 4; ++k) {
        const int64_t i = (int64_t)bi - (k & 1), j = (int64_t)bj - (k >> 1);
        if (!gtx_hull_block(h, i, j))
            continue;
        /* From the block's first cell to the node: cells. */
        const gtx_moments *b = &h->sums[(size_t)j * h->blocks[0] + (size_t)i];
        const double x = (double)gtx_hull_line(h, 0, (uint32_t)i) - gtx_hull_line(h, 0, bi);
        const double y = (double)gtx_hull_line(h, 1, (uint32_t)j) - gtx_hull_line(h, 1, bj);
        m.n += b->n, m.x += b->x + b->n * x, m.y += b->y + b->n * y, m.z += b->z;
        m.xx += b->xx + x * (2 * b->x + b->n * x), m.yy += b->yy + y * (2 * b->y + b->n * y);
        m.xy += b->xy + x * b->y + y * b->x + b->n * x * y;
        m.xz += b->xz + x * b->z, m.yz += b->yz + y * b->z;
    }
    if (m.n == 0)
        return 0;
    const double xx = m.xx - m.x * m.x / m.n, xy = m.xy - m.x * m.y / m.n;
    const double yy = m.yy - m.y * m.y / m.n, det = xx * yy - xy * xy;
    const double xz = m.xz - m.x * m.z / m.n, yz = m.yz - m.y * m.z / m.n;
    const double slope_x = (xz * yy - yz * xy) / det, slope_y = (yz * xx - xz * xy) / det;
    return (float)((m.z - slope_x * m.x - slope_y * m.y) / m.n);
}

/* At the outline, nodes stand off. */
static void place_nodes(gtx_hull *h)
{
    for (size_t e = 0; e < h->edge_count; ++e) {
        const uint32_t row = h->blocks[0] + 1, *ends = h->edges[e].node;
        const int dx = (int)(ends[1] % row) - (int)(ends[0] % row);
        const int dy = (int)(ends[1] / row) - (int)(ends[0] / row);
        for (int k = 0; k < 2; ++k) {
            h->nodes[ends[k]].away[0] += (float)dy;
            h->nodes[ends[k]].away[1] -= (float)dx;
        }
    }
    for (uint32_t i = 0; i < h->node_count; ++i) {
        gtx_hull_node *n = &h->nodes[i];
        const uint32_t bi = i % (h->blocks[0] + 1), bj = i / (h->blocks[0] + 1);
        n->x = gtx_hull_texel(h, 0, gtx_hull_line(h, 0, bi)) +
               copysignf(n->away[0] != 0 ? h->grow : 0, n->away[0]);
        n->y = gtx_hull_texel(h, 1, gtx_hull_line(h, 1, bj)) +
               copysignf(n->away[1] != 0 ? h->grow : 0, n->away[1]);
        n->z = plane_at(h, bi, bj);
        n->up = n->down = 0;
        n->top = n->bottom = GTX_HULL_NONE;
    }
}

/* A function over texels: a + b x + c y. */
typedef struct plane {
    float a, b, c;
} plane;

/* A triangle as it lies now: the share of each corner, and the plane of the nodes' points. */
typedef struct shape {
    plane share[3], height;
    uint32_t from[2], to[2];  /* nodes of the level around it */
} shape;

static shape shape_of(const gtx_hull *h, const gtx_hull_triangle *t)
{
    const gtx_hull_node *n[3] = {&h->nodes[t->node[0]], &h->nodes[t->node[1]],
                                 &h->nodes[t->node[2]]};
    const float det = (n[1]->x - n[0]->x) * (n[2]->y - n[0]->y) -
                      (n[2]->x - n[0]->x) * (n[1]->y - n[0]->y);
    shape s = {.height = {0, 0, 0}};
    for (int k = 0; k < 3; ++k) {
        const gtx_hull_node *p = n[(k + 1) % 3], *q = n[(k + 2) % 3];
        s.share[k] = (plane){(p->x * q->y - q->x * p->y) / det, (p->y - q->y) / det,
                             (q->x - p->x) / det};
        s.height.a += n[k]->z * s.share[k].a;
        s.height.b += n[k]->z * s.share[k].b;
        s.height.c += n[k]->z * s.share[k].c;
    }
    const float cell = (float)(1u << h->grid->level);
    const float low[2] = {gtx_lesser(n[0]->x, gtx_lesser(n[1]->x, n[2]->x)),
                          gtx_lesser(n[0]->y, gtx_lesser(n[1]->y, n[2]->y))};
    const float high[2] = {gtx_greater(n[0]->x, gtx_greater(n[1]->x, n[2]->x)),
                           gtx_greater(n[0]->y, gtx_greater(n[1]->y, n[2]->y))};
    const uint32_t count[2] = {h->grid->nodes_x, h->grid->nodes_y};
    for (int a = 0; a < 2; ++a) {
        s.from[a] = (uint32_t)(gtx_greater(low[a] / cell - 1, 0));
        s.to[a] = (uint32_t)(gtx_greater(high[a] / cell, 0)) + 2;
        s.to[a] = s.to[a] < count[a] ? s.to[a] : count[a];
    }
    return s;
}

/* Columns that are looked at together. */
enum { COLUMNS = 32 };

/* What a triangle's functions are along a row of nodes: bases and slopes. */
typedef struct row_shape {
    float base[3], slope[3], height, rise;
} row_shape;

/* How far the height field's nodes in a row that the triangle meets, by the bases of its shares,
 * are above its plane, and below; column by column, which makes vectors of it. */
static void measure_row(const row_shape *row, const float *restrict x, const float *restrict code,
                        size_t count, float *restrict highest, float *restrict lowest)
{
    const row_shape s = *row;
    for (size_t i = 0; i < count; ++i) {
        const float over = code[i] - (s.height + s.rise * x[i]);
        const int meets = (s.base[0] + s.slope[0] * x[i] >= 0) &
                          (s.base[1] + s.slope[1] * x[i] >= 0) &
                          (s.base[2] + s.slope[2] * x[i] >= 0);
        highest[i] = (meets & (over > highest[i])) ? over : highest[i];
        lowest[i] = (meets & (over < lowest[i])) ? over : lowest[i];
    }
}

/* The same over a triangle's columns from `first` on, at most COLUMNS. */
static void measure(const gtx_hull *h, const shape *s, uint32_t first, float *highest,
                    float *lowest)
{
    const float cell = (float)(1u << h->grid->level);
    const uint32_t left = s->to[0] - first, count = left < COLUMNS ? left : COLUMNS;
    const uint32_t lanes = (count + 3) / 4 * 4; /* the last of them in vain */
    row_shape row = {.rise = s->height.b};
    float slack[3], up[COLUMNS], down[COLUMNS];
    for (int k = 0; k < 3; ++k) {
        slack[k] = -cell * (fabsf(s->share[k].b) + fabsf(s->share[k].c)) - 1e-4f;
        row.slope[k] = s->share[k].b;
    }
    for (uint32_t i = 0; i < lanes; ++i)
        up[i] = -INFINITY, down[i] = INFINITY;
    for (uint32_t j = s->from[1]; j < s->to[1]; ++j) {
        const float y = gtx_hull_texel(h, 1, j);
        row.height = s->height.a + s->height.c * y;
        for (int k = 0; k < 3; ++k)
            row.base[k] = s->share[k].a + s->share[k].c * y - slack[k];
        measure_row(&row, h->columns + first, h->codes + (size_t)j * h->grid->nodes_x + first,
                    lanes, up, down);
    }
    for (uint32_t i = 0; i < count; ++i) {
        *highest = gtx_greater(*highest, up[i]);
        *lowest = gtx_lesser(*lowest, down[i]);
    }
}

/* Lifts and sinks the nodes of a triangle until lid and floor are clear of the height field over
 * all cells that it meets: over a cell the difference is bilinear, and greatest in a corner. */
static void lift(gtx_hull *h, const gtx_hull_triangle *t)
{
    const shape s = shape_of(h, t);
    float highest = -INFINITY, lowest = INFINITY;
    for (uint32_t first = s.from[0]; first < s.to[0]; first += COLUMNS)
        measure(h, &s, first, &highest, &lowest);
    for (int k = 0; k < 3; ++k) {
        gtx_hull_node *n = &h->nodes[t->node[k]];
        n->up = gtx_greater(n->up, highest + h->grow);
        n->down = gtx_greater(n->down, h->two_sided ? h->grow - lowest : 0);
    }
    h->highest = gtx_greater(h->highest, highest);
    h->lowest = gtx_lesser(h->lowest, lowest);
}

/* The least height of a cell's corners. */
static float least_code(const gtx_grid *grid, uint32_t i, uint32_t j)
{
    const uint16_t *row = grid->code + (size_t)j * grid->nodes_x + i, *next = row + grid->nodes_x;
    return gtx_lesser(gtx_lesser(row[0], row[1]), gtx_lesser(next[0], next[1]));
}

/* How much the height field falls outward over a cell, in the mean of the first few behind cell (i,
 * j). */
static float fall_at(const gtx_grid *grid, uint32_t i, uint32_t j, int axis, bool upward)
{
    enum { CELLS = 4 };
    const uint32_t width = grid->nodes_x - 1, height = grid->nodes_y - 1;
    float first = 0, last = 0, count = 0;
    for (uint32_t k = 0; k < CELLS; ++k) {
        const uint32_t x = axis ? i : upward ? i + k : i - k;
        const uint32_t y = !axis ? j : upward ? j + k : j - k;
        if (x >= width || y >= height || !grid->solid[(size_t)y * width + x])
            break;
        const float code = least_code(grid, x, y);
        first = k ? first : code;
        last = code;
        count += 1;
    }
    return count > 1 ? gtx_greater(last - first, 0) / (count - 1) : 0;
}

/* Sinks the foot of the wall on an edge of the outline. It is below the first cells behind it,
 * wherever their lines meet the wall: as columns if `axis` is 0, or else as rows; and where they
 * begin some way behind, below where the height field would go on to, a half more steeply: rays
 * that graze it come from there. */
static void sink(gtx_hull *h, const gtx_hull_edge *e, int axis)
{
    const uint32_t row = h->blocks[0] + 1, width = h->grid->nodes_x - 1;
    gtx_hull_node *a = &h->nodes[e->node[0]], *b = &h->nodes[e->node[1]];
    uint32_t at[2][2];
    for (int k = 0; k < 2; ++k) {
        at[k][0] = gtx_hull_line(h, 0, e->node[k] % row);
        at[k][1] = gtx_hull_line(h, 1, e->node[k] / row);
    }
    const float along = (float)at[1][axis] - (float)at[0][axis];
    if (along == 0)
        return;
    /* Inward is to the left of the edge: of (dx, dy) that is (-dy, dx). */
    const bool upward = (axis ? -along : along) > 0;
    const uint32_t *block = e->block;
    const uint32_t first = gtx_hull_line(h, axis, block[axis]);
    const uint32_t end = gtx_hull_line(h, axis, block[axis] + 1);
    const uint32_t from = gtx_hull_line(h, !axis, block[!axis]);
    const uint32_t to = gtx_hull_line(h, !axis, block[!axis] + 1);
    float deepest = 0;
    for (uint32_t l = first; l < end; ++l)
        for (uint32_t k = 0; k < to - from; ++k) {
            const uint32_t across = upward ? from + k : to - 1 - k;
            const uint32_t i = axis ? across : l, j = axis ? l : across;
            if (!h->grid->solid[(size_t)j * width + i])
                continue;
            const float share = ((float)l + 0.5f - (float)at[0][axis]) / along;
            const float wall = (float)at[0][!axis] +
                               share * ((float)at[1][!axis] - (float)at[0][!axis]);
            const float apart = upward ? (float)across - wall : wall - (float)across - 1;
            const float beyond =
                apart > 0 ? apart * fall_at(h->grid, i, j, !axis, upward) : 0;
            deepest = gtx_greater(deepest, a->z + share * (b->z - a->z) -
                                     least_code(h->grid, i, j) + steeper * beyond);
            break;
        }
    a->down = gtx_greater(a->down, deepest + h->grow);
    b->down = gtx_greater(b->down, deepest + h->grow);
}

void gtx_hull_fit(gtx_hull *h)
{
    place_nodes(h);
    for (size_t i = 0; i < h->triangle_count; ++i)
        lift(h, &h->triangles[i]);
    for (size_t e = 0; e < h->edge_count; ++e)
        for (int axis = 0; axis < 2; ++axis)
            sink(h, &h->edges[e], axis);
}
