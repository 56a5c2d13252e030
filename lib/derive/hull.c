/* Hulls: tight proxies over blocks of a level's cells, a lid through the blocks' corners. */
#include "derive/derive.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <stdbool.h>

/* Cells along the side of a block: processors shade small triangles by whole groups of pixels, so
 * that few large ones cost least. */
enum { BLOCK = 16 };
/* How much steeper than the sheet at its outline what lies beyond may be. */
static const float steeper = 1.5f;

/* Where a block's two triangles are: in the halves beside its diagonal. */
enum {
    RISING = 1,               /* the diagonal goes from corner 0 to 3, or else from 1 to 2 */
    FIRST = 2, SECOND = 4     /* the half of the corners 0, 1 and one more; the other */
};

/* Sums over what is solid of a block, for planes by least squares. */
typedef struct moments {
    double n, x, y, z, xx, xy, yy, xz, yz;
} moments;

/* A corner of blocks. */
typedef struct node {
    float x, y, z;            /* a point near the sheet */
    float away[2];            /* from the blocks, where they end */
    float up, down;           /* how far lid and floor are from the point */
    uint32_t top, bottom;     /* vertices, or NONE */
} node;

typedef struct triangle {
    uint32_t node[3];         /* counter-clockwise from above */
} triangle;

/* A triangle's edge where nothing is beside. */
typedef struct edge {
    uint32_t node[2];         /* the triangle is on the left */
    uint32_t block[2];        /* that the triangle is in */
} edge;

enum { NONE = UINT32_MAX };

typedef struct hull {
    const gtx_grid *grid;
    uint32_t last[2];         /* texel of the patch */
    bool two_sided;
    float grow;
    uint32_t low[2], high[2]; /* extent of the solid cells */
    uint32_t blocks[2];       /* how many */
    size_t block_count, node_count, triangle_count, edge_count;
    uint8_t *block;           /* RISING | FIRST | SECOND each */
    uint8_t *corner;          /* whether a node of the level is one of a solid cell */
    moments *sums;            /* a block each */
    node *nodes;              /* blocks[0] + 1 a row */
    triangle *triangles;
    edge *edges;              /* the outline */
    float highest, lowest;    /* of the sheet against the planes of the triangles */
} hull;

static uint32_t min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* First cell of block column or row i. */
static uint32_t line(const hull *h, int axis, uint32_t i)
{
    const uint32_t span = h->high[axis] - h->low[axis];
    return h->low[axis] + (uint32_t)((uint64_t)i * span / h->blocks[axis]);
}

/* Texel of a node of the level. */
static float texel(const hull *h, int axis, uint32_t i)
{
    return (float)min_u32(i << h->grid->level, h->last[axis]);
}

/* As fminf and fmaxf, of numbers, without a call. */
static float lesser(float a, float b)
{
    return a < b ? a : b;
}

static float greater(float a, float b)
{
    return a > b ? a : b;
}

static void find_corners(hull *h)
{
    const uint32_t width = h->grid->nodes_x - 1, height = h->grid->nodes_y - 1;
    for (uint32_t j = 0; j < height; ++j)
        for (uint32_t i = 0; i < width; ++i) {
            uint8_t *corner = h->corner + (size_t)j * h->grid->nodes_x + i;
            if (h->grid->solid[(size_t)j * width + i])
                corner[0] = corner[1] = corner[width + 1] = corner[width + 2] = 1;
        }
}

static void find_extent(hull *h)
{
    const uint32_t width = h->grid->nodes_x - 1, height = h->grid->nodes_y - 1;
    h->low[0] = h->low[1] = UINT32_MAX;
    for (uint32_t j = 0; j < height; ++j)
        for (uint32_t i = 0; i < width; ++i) {
            const uint32_t at[2] = {i, j};
            for (int a = 0; h->grid->solid[(size_t)j * width + i] && a < 2; ++a) {
                h->low[a] = min_u32(h->low[a], at[a]);
                h->high[a] = at[a] >= h->high[a] ? at[a] + 1 : h->high[a];
            }
        }
    for (int a = 0; a < 2; ++a)
        h->blocks[a] = h->high[0] ? (h->high[a] - h->low[a] + BLOCK - 1) / BLOCK : 0;
}

/* Which halves of a block are needed, with a cell to spare, so that the hull follows slanted
 * outlines by leaving halves out; and the block's sums. */
static void look_at_block(hull *h, uint32_t bi, uint32_t bj)
{
    const uint32_t x0 = line(h, 0, bi), x1 = line(h, 0, bi + 1);
    const uint32_t y0 = line(h, 1, bj), y1 = line(h, 1, bj + 1);
    const float du = 1 / (float)(x1 - x0), dv = 1 / (float)(y1 - y0), spare = 1.5f * (du + dv);
    const size_t b = (size_t)bj * h->blocks[0] + bi;
    moments m = {0};
    float rise[2] = {INFINITY, -INFINITY}, fall[2] = {INFINITY, -INFINITY};
    for (uint32_t j = y0; j < y1; ++j)
        for (uint32_t i = x0; i < x1; ++i) {
            if (!h->grid->solid[(size_t)j * (h->grid->nodes_x - 1) + i])
                continue;
            const float u = du * ((float)(i - x0) + 0.5f), v = dv * ((float)(j - y0) + 0.5f);
            rise[0] = lesser(rise[0], v - u), rise[1] = greater(rise[1], v - u);
            fall[0] = lesser(fall[0], u + v - 1), fall[1] = greater(fall[1], u + v - 1);
            const double x = i - x0, y = j - y0;
            const double z = h->grid->code[(size_t)j * h->grid->nodes_x + i];
            m.n += 1, m.x += x, m.y += y, m.z += z;
            m.xx += x * x, m.xy += x * y, m.yy += y * y, m.xz += x * z, m.yz += y * z;
        }
    const bool below = rise[0] < spare, above = rise[1] > -spare; /* the rising diagonal */
    const bool near = fall[0] < spare, far = fall[1] > -spare;    /* the falling one */
    if (m.n > 0 && below && above && !(near && far))
        h->block[b] = near ? FIRST : SECOND;
    else if (m.n > 0)
        h->block[b] = (uint8_t)(RISING | (below ? FIRST : 0) | (above ? SECOND : 0));
    h->sums[b] = m;
}

static uint8_t block_at(const hull *h, int64_t bi, int64_t bj)
{
    const bool inside = bi >= 0 && bj >= 0 && bi < h->blocks[0] && bj < h->blocks[1];
    return inside ? h->block[(size_t)bj * h->blocks[0] + (size_t)bi] : 0;
}

/* Whether there is a triangle on the inner side of a block's edge: below, right, above, left. */
static bool has_edge(uint8_t block, uint32_t side)
{
    static const uint8_t half[2][4] = {{FIRST, SECOND, SECOND, FIRST},
                                       {FIRST, FIRST, SECOND, SECOND}};
    return block & half[block & RISING][side];
}

/* The block's triangles, and those of their edges where nothing is beside. */
static void split_block(hull *h, uint32_t bi, uint32_t bj)
{
    static const int beside[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    static const uint8_t corners[4][3] = {{0, 1, 3}, {0, 1, 2}, {1, 2, 3}, {0, 2, 3}};
    const uint8_t kind = block_at(h, bi, bj);
    const uint32_t row = h->blocks[0] + 1, first = bj * row + bi;
    const uint32_t ring[4] = {first, first + 1, first + row + 1, first + row};
    for (int second = 0; second < 2; ++second) {
        const uint8_t *c = corners[2 * second + (kind & RISING)];
        if (kind & (second ? SECOND : FIRST))
            h->triangles[h->triangle_count++] = (triangle){{ring[c[0]], ring[c[1]], ring[c[2]]}};
    }
    for (uint32_t e = 0; e < 4; ++e)
        if (has_edge(kind, e) && !has_edge(block_at(h, (int64_t)bi + beside[e][0],
                                                    (int64_t)bj + beside[e][1]), (e + 2) % 4))
            h->edges[h->edge_count++] = (edge){{ring[e], ring[(e + 1) % 4]}, {bi, bj}};
    const int lower = kind & RISING ? 2 : 1, upper = kind & RISING ? 0 : 3;
    if ((kind & FIRST) && !(kind & SECOND))
        h->edges[h->edge_count++] = (edge){{ring[lower], ring[upper]}, {bi, bj}};
    if ((kind & SECOND) && !(kind & FIRST))
        h->edges[h->edge_count++] = (edge){{ring[upper], ring[lower]}, {bi, bj}};
}

/* The height at node (bi, bj) of a plane that is as near as can be to the sheet of the blocks
 * around. Slopes are held back a little, where few cells do not tell them. */
static float plane_at(const hull *h, uint32_t bi, uint32_t bj)
{
    moments m = {.xx = 1, .yy = 1};
    for (uint32_t k = 0; k < 4; ++k) {
        const int64_t i = (int64_t)bi - (k & 1), j = (int64_t)bj - (k >> 1);
        if (!block_at(h, i, j))
            continue;
        /* From the block's first cell to the node: cells. */
        const moments *b = &h->sums[(size_t)j * h->blocks[0] + (size_t)i];
        const double x = (double)line(h, 0, (uint32_t)i) - line(h, 0, bi);
        const double y = (double)line(h, 1, (uint32_t)j) - line(h, 1, bj);
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
static void place_nodes(hull *h)
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
        node *n = &h->nodes[i];
        const uint32_t bi = i % (h->blocks[0] + 1), bj = i / (h->blocks[0] + 1);
        n->x = texel(h, 0, line(h, 0, bi)) + copysignf(n->away[0] != 0 ? h->grow : 0, n->away[0]);
        n->y = texel(h, 1, line(h, 1, bj)) + copysignf(n->away[1] != 0 ? h->grow : 0, n->away[1]);
        n->z = plane_at(h, bi, bj);
        n->up = n->down = 0;
        n->top = n->bottom = NONE;
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

static shape shape_of(const hull *h, const triangle *t)
{
    const node *n[3] = {&h->nodes[t->node[0]], &h->nodes[t->node[1]], &h->nodes[t->node[2]]};
    const float det = (n[1]->x - n[0]->x) * (n[2]->y - n[0]->y) -
                      (n[2]->x - n[0]->x) * (n[1]->y - n[0]->y);
    shape s = {.height = {0, 0, 0}};
    for (int k = 0; k < 3; ++k) {
        const node *p = n[(k + 1) % 3], *q = n[(k + 2) % 3];
        s.share[k] = (plane){(p->x * q->y - q->x * p->y) / det, (p->y - q->y) / det,
                             (q->x - p->x) / det};
        s.height.a += n[k]->z * s.share[k].a;
        s.height.b += n[k]->z * s.share[k].b;
        s.height.c += n[k]->z * s.share[k].c;
    }
    const float cell = (float)(1u << h->grid->level);
    const float low[2] = {lesser(n[0]->x, lesser(n[1]->x, n[2]->x)),
                          lesser(n[0]->y, lesser(n[1]->y, n[2]->y))};
    const float high[2] = {greater(n[0]->x, greater(n[1]->x, n[2]->x)),
                           greater(n[0]->y, greater(n[1]->y, n[2]->y))};
    const uint32_t count[2] = {h->grid->nodes_x, h->grid->nodes_y};
    for (int a = 0; a < 2; ++a) {
        s.from[a] = (uint32_t)(greater(low[a] / cell - 1, 0));
        s.to[a] = min_u32((uint32_t)(greater(high[a] / cell, 0)) + 2, count[a]);
    }
    return s;
}

/* Lifts and sinks the nodes of a triangle until lid and floor are clear of the sheet over all cells
 * that it meets: over a cell the difference is bilinear, and greatest in a corner. */
static void lift(hull *h, const triangle *t)
{
    const shape s = shape_of(h, t);
    const float cell = (float)(1u << h->grid->level);
    float slack[3], highest = -INFINITY, lowest = INFINITY;
    for (int k = 0; k < 3; ++k)
        slack[k] = -cell * (fabsf(s.share[k].b) + fabsf(s.share[k].c)) - 1e-4f;
    for (uint32_t j = s.from[1]; j < s.to[1]; ++j) {
        const size_t row = (size_t)j * h->grid->nodes_x;
        const float y = texel(h, 1, j), z = s.height.a + s.height.c * y;
        float base[3];
        for (int k = 0; k < 3; ++k)
            base[k] = s.share[k].a + s.share[k].c * y - slack[k];
        for (uint32_t i = s.from[0]; i < s.to[0]; ++i) {
            const float x = texel(h, 0, i);
            const bool meets = (base[0] + s.share[0].b * x >= 0) &
                               (base[1] + s.share[1].b * x >= 0) &
                               (base[2] + s.share[2].b * x >= 0) & h->corner[row + i];
            const float over = h->grid->code[row + i] - (z + s.height.b * x);
            highest = meets ? greater(highest, over) : highest;
            lowest = meets ? lesser(lowest, over) : lowest;
        }
    }
    for (int k = 0; k < 3; ++k) {
        node *n = &h->nodes[t->node[k]];
        n->up = greater(n->up, highest + h->grow);
        n->down = greater(n->down, h->two_sided ? h->grow - lowest : 0);
    }
    h->highest = greater(h->highest, highest);
    h->lowest = lesser(h->lowest, lowest);
}

/* The least height of a cell's corners. */
static float least_code(const gtx_grid *grid, uint32_t i, uint32_t j)
{
    const uint16_t *row = grid->code + (size_t)j * grid->nodes_x + i, *next = row + grid->nodes_x;
    return lesser(lesser(row[0], row[1]), lesser(next[0], next[1]));
}

/* How much the sheet falls outward over a cell, in the mean of the first few behind cell (i, j). */
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
    return count > 1 ? greater(last - first, 0) / (count - 1) : 0;
}

/* Sinks the foot of the wall on an edge of the outline. It is below the first cells behind it,
 * wherever their lines meet the wall: as columns if `axis` is 0, or else as rows; and where they
 * begin some way behind, below where the sheet would go on to, a half more steeply: rays that graze
 * it come from there. */
static void sink(hull *h, const edge *e, int axis)
{
    const uint32_t row = h->blocks[0] + 1, width = h->grid->nodes_x - 1;
    node *a = &h->nodes[e->node[0]], *b = &h->nodes[e->node[1]];
    const uint32_t at[2][2] = {{line(h, 0, e->node[0] % row), line(h, 1, e->node[0] / row)},
                               {line(h, 0, e->node[1] % row), line(h, 1, e->node[1] / row)}};
    const float along = (float)at[1][axis] - (float)at[0][axis];
    if (along == 0)
        return;
    /* Inward is to the left of the edge: of (dx, dy) that is (-dy, dx). */
    const bool upward = (axis ? -along : along) > 0;
    const uint32_t first = line(h, axis, e->block[axis]), end = line(h, axis, e->block[axis] + 1);
    const uint32_t from = line(h, !axis, e->block[!axis]), to = line(h, !axis, e->block[!axis] + 1);
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
            const float beyond = greater(apart, 0) * fall_at(h->grid, i, j, !axis, upward);
            deepest = greater(deepest, a->z + share * (b->z - a->z) -
                                     least_code(h->grid, i, j) + steeper * beyond);
            break;
        }
    a->down = greater(a->down, deepest + h->grow);
    b->down = greater(b->down, deepest + h->grow);
}

/* More than the sheet is under the lid, or over the floor. */
static float thickness_of(const hull *h)
{
    float lid = 0, floor = 0;
    for (size_t i = 0; i < h->node_count; ++i) {
        lid = greater(lid, h->nodes[i].up);
        floor = greater(floor, h->nodes[i].down);
    }
    return greater(lid - h->lowest, h->highest + floor) + 1;
}

static uint32_t add_vertex(gtx_proxies *out, const node *n, float z, uint32_t tag)
{
    out->vertices[out->vertex_count] = (gtx_proxy_vertex){n->x, n->y, z, tag};
    return out->vertex_count++;
}

static uint32_t top_of(gtx_proxies *out, node *n, uint32_t tag)
{
    if (n->top == NONE)
        n->top = add_vertex(out, n, n->z + n->up, tag);
    return n->top;
}

static uint32_t bottom_of(gtx_proxies *out, node *n, uint32_t tag)
{
    if (n->bottom == NONE)
        n->bottom = add_vertex(out, n, n->z - n->down, tag);
    return n->bottom;
}

static void add_triangle(gtx_proxies *out, uint32_t a, uint32_t b, uint32_t c)
{
    out->indices[out->index_count++] = a;
    out->indices[out->index_count++] = b;
    out->indices[out->index_count++] = c;
}

static void emit(const hull *h, uint32_t tag, gtx_proxies *out)
{
    for (size_t i = 0; i < h->triangle_count; ++i) {
        node *n[3];
        for (int k = 0; k < 3; ++k)
            n[k] = &h->nodes[h->triangles[i].node[k]];
        add_triangle(out, top_of(out, n[0], tag), top_of(out, n[1], tag), top_of(out, n[2], tag));
        if (h->two_sided)
            add_triangle(out, bottom_of(out, n[0], tag), bottom_of(out, n[2], tag),
                         bottom_of(out, n[1], tag));
    }
    for (size_t e = 0; e < h->edge_count; ++e) {
        node *a = &h->nodes[h->edges[e].node[0]], *b = &h->nodes[h->edges[e].node[1]];
        const uint32_t below = bottom_of(out, a, tag);
        add_triangle(out, top_of(out, b, tag), top_of(out, a, tag), below);
        add_triangle(out, top_of(out, b, tag), below, bottom_of(out, b, tag));
    }
}

static void build(hull *h)
{
    find_corners(h);
    for (uint32_t b = 0; b < h->block_count; ++b)
        look_at_block(h, b % h->blocks[0], b / h->blocks[0]);
    for (uint32_t b = 0; b < h->block_count; ++b)
        split_block(h, b % h->blocks[0], b / h->blocks[0]);
    place_nodes(h);
    for (size_t i = 0; i < h->triangle_count; ++i)
        lift(h, &h->triangles[i]);
    for (size_t e = 0; e < h->edge_count; ++e)
        for (int axis = 0; axis < 2; ++axis)
            sink(h, &h->edges[e], axis);
}

/* One piece of memory for all arrays, the best aligned first; how many bytes, or 0 without memory. */
static size_t allocate(hull *h, const gtx_allocator *hooks)
{
    h->block_count = (size_t)h->blocks[0] * h->blocks[1];
    h->node_count = ((size_t)h->blocks[0] + 1) * (h->blocks[1] + 1);
    const size_t corners = (size_t)h->grid->nodes_x * h->grid->nodes_y;
    const size_t size =
        h->block_count * (sizeof *h->sums + 2 * sizeof *h->triangles + 5 * sizeof *h->edges +
                          sizeof *h->block) + h->node_count * sizeof *h->nodes + corners;
    h->sums = gtx_alloc_array(hooks, size, 1);
    if (!h->sums)
        return 0;
    h->nodes = (node *)(h->sums + h->block_count);
    h->triangles = (triangle *)(h->nodes + h->node_count);
    h->edges = (edge *)(h->triangles + 2 * h->block_count);
    h->block = (uint8_t *)(h->edges + 5 * h->block_count);
    h->corner = h->block + h->block_count;
    return size;
}

gtx_result gtx_add_hull(const gtx_asset *asset, uint32_t patch, const gtx_grid *grid, float grow,
                        const gtx_allocator *allocator, gtx_proxies *out, float *thickness,
                        gtx_error *error)
{
    if (!asset || !grid || !out || !thickness || patch >= asset->info.patch_count ||
        !(grow >= 0) || isinf(grow))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a hull needs an asset, its patch, a level and a finite growth >= 0");
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    const gtx_patch *p = &asset->patches[patch];
    hull h = {.grid = grid, .last = {p->rect[2] - 1u, p->rect[3] - 1u},
              .two_sided = p->flags & GTX_PATCH_TWO_SIDED, .grow = grow};
    *thickness = 0;
    find_extent(&h);
    if (!h.high[0])
        return GTX_OK;
    const size_t size = allocate(&h, &hooks);
    if (!size)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a hull");
    build(&h);
    gtx_result result = gtx_proxies_reserve(out, 2 * h.node_count,
                                            6 * (h.triangle_count + h.edge_count), &hooks, error);
    if (!result) {
        *thickness = thickness_of(&h);
        emit(&h, patch | (grid->level + 1) << GTX_PROXY_KIND_SHIFT, out);
    }
    gtx_free_array(&hooks, h.sums, size, 1);
    return result;
}
