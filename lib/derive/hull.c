/* Hulls: tight proxies over blocks of a level's cells, a lid through the blocks' corners. */
#include "derive/derive.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <stdbool.h>

/* Cells along the side of a block. */
enum { BLOCK = 8 };

/* Where a block's two triangles are: in the halves beside its diagonal. */
enum {
    RISING = 1,               /* the diagonal goes from corner 0 to 3, or else from 1 to 2 */
    FIRST = 2, SECOND = 4     /* the half of the corners 0, 1 and one more; the other */
};

/* A corner of blocks. */
typedef struct node {
    float x, y, z;            /* a point near the sheet */
    float up, down;           /* how far lid and floor must be from it */
    uint32_t top, bottom;     /* vertices, or NONE */
} node;

enum { NONE = UINT32_MAX };

typedef struct hull {
    const gtx_asset *asset;
    const gtx_patch *patch;
    const gtx_grid *grid;
    uint8_t *shown;           /* a cell each */
    uint32_t low[2], high[2]; /* extent of those, in cells */
    uint32_t blocks[2];       /* how many */
    uint8_t *block;           /* RISING | FIRST | SECOND each */
    float highest, lowest;    /* of the solid cells against the planes of the blocks */
    node *nodes;              /* blocks[0] + 1 a row */
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
    return (float)min_u32(i << h->grid->level, h->patch->rect[2 + axis] - 1u);
}

/* Marks the solid cells that have a texel within the level's trim limit (format/gtx.md, 4.2): no
 * point of others shows. */
static void find_shown(hull *h)
{
    const uint32_t level = h->grid->level, width = h->grid->nodes_x - 1;
    const uint32_t height = h->grid->nodes_y - 1;
    const uint32_t limit = 128 + (48u << level) / 10;
    for (uint32_t y = 0; y < h->patch->rect[3]; ++y) {
        const uint32_t j0 = (y ? y - 1 : 0) >> level, j1 = min_u32(y >> level, height - 1);
        for (uint32_t x = 0; x < h->patch->rect[2]; ++x) {
            if (gtx_trim_code(h->asset, h->patch, x, y) > limit)
                continue;
            const uint32_t i0 = (x ? x - 1 : 0) >> level, i1 = min_u32(x >> level, width - 1);
            h->shown[(size_t)j0 * width + i0] = h->shown[(size_t)j0 * width + i1] = 1;
            h->shown[(size_t)j1 * width + i0] = h->shown[(size_t)j1 * width + i1] = 1;
        }
    }
    for (int a = 0; a < 2; ++a) {
        h->low[a] = UINT32_MAX;
        h->high[a] = 0;
    }
    for (uint32_t j = 0; j < height; ++j)
        for (uint32_t i = 0; i < width; ++i) {
            uint8_t *shown = &h->shown[(size_t)j * width + i];
            *shown &= h->grid->solid[(size_t)j * width + i];
            if (!*shown)
                continue;
            const uint32_t at[2] = {i, j};
            for (int a = 0; a < 2; ++a) {
                h->low[a] = min_u32(h->low[a], at[a]);
                h->high[a] = at[a] >= h->high[a] ? at[a] + 1 : h->high[a];
            }
        }
}

/* Which halves of a block are needed, with a cell to spare: the hull's outline follows slanted ones
 * by leaving halves out. */
static uint8_t halves_of(const hull *h, uint32_t bi, uint32_t bj)
{
    const uint32_t x0 = line(h, 0, bi), x1 = line(h, 0, bi + 1);
    const uint32_t y0 = line(h, 1, bj), y1 = line(h, 1, bj + 1);
    const float du = 1 / (float)(x1 - x0), dv = 1 / (float)(y1 - y0), spare = 1.5f * (du + dv);
    bool any = false, below = false, above = false, near = false, far = false;
    for (uint32_t j = y0; j < y1; ++j)
        for (uint32_t i = x0; i < x1; ++i) {
            if (!h->shown[(size_t)j * (h->grid->nodes_x - 1) + i])
                continue;
            const float u = du * ((float)(i - x0) + 0.5f), v = dv * ((float)(j - y0) + 0.5f);
            any = true;
            below = below || u - v > -spare; /* the rising diagonal */
            above = above || v - u > -spare;
            near = near || u + v - 1 < spare; /* the falling one */
            far = far || u + v - 1 > -spare;
        }
    if (!any)
        return 0;
    if (below && above && !(near && far))
        return near ? FIRST : SECOND;
    return (uint8_t)(RISING | (below ? FIRST : 0) | (above ? SECOND : 0));
}

static node *node_at(const hull *h, uint32_t bi, uint32_t bj)
{
    return &h->nodes[(size_t)bj * (h->blocks[0] + 1) + bi];
}

static uint8_t block_at(const hull *h, int64_t bi, int64_t bj)
{
    const bool inside = bi >= 0 && bj >= 0 && bi < h->blocks[0] && bj < h->blocks[1];
    return inside ? h->block[(size_t)bj * h->blocks[0] + (size_t)bi] : 0;
}

/* The code of a node of the level, or the mean of the nearest around it that are not empty. */
static float height_near(const hull *h, uint32_t i, uint32_t j)
{
    const gtx_grid *g = h->grid;
    uint32_t sum = g->code[(size_t)j * g->nodes_x + i], count = sum > 0;
    for (uint32_t reach = 1; !count && reach <= 2 * BLOCK; reach *= 2)
        for (uint32_t y = j > reach ? j - reach : 0; y <= min_u32(j + reach, g->nodes_y - 1); ++y)
            for (uint32_t x = i > reach ? i - reach : 0; x <= min_u32(i + reach, g->nodes_x - 1);
                 ++x) {
                const uint32_t code = g->code[(size_t)y * g->nodes_x + x];
                sum += code;
                count += code > 0;
            }
    return count ? (float)sum / (float)count : 1;
}

/* Nodes at the outline stand off by `grow` texels, away from where there are blocks. */
static void place_nodes(const hull *h, float grow)
{
    for (uint32_t bj = 0; bj <= h->blocks[1]; ++bj)
        for (uint32_t bi = 0; bi <= h->blocks[0]; ++bi) {
            const uint32_t i = line(h, 0, bi), j = line(h, 1, bj);
            const int has[4] = {block_at(h, bi - 1ll, bj - 1ll) != 0,
                                block_at(h, bi, bj - 1ll) != 0,
                                block_at(h, bi - 1ll, bj) != 0, block_at(h, bi, bj) != 0};
            const int x = has[0] + has[2] - has[1] - has[3], y = has[0] + has[1] - has[2] - has[3];
            node *n = node_at(h, bi, bj);
            *n = (node){texel(h, 0, i), texel(h, 1, j), 0, -INFINITY, -INFINITY, NONE, NONE};
            n->x += grow * (float)((x > 0) - (x < 0));
            n->y += grow * (float)((y > 0) - (y < 0));
            if (has[0] || has[1] || has[2] || has[3])
                n->z = height_near(h, i, j);
        }
}

/* The corners of a block's triangle, counter-clockwise from above. */
static void triangle_of(const hull *h, uint32_t bi, uint32_t bj, uint8_t half, node *corner[3])
{
    const uint8_t kind = block_at(h, bi, bj);
    static const uint8_t corners[4][3] = {{0, 1, 2}, {0, 1, 3}, {1, 3, 2}, {0, 3, 2}};
    const uint8_t *c = corners[2 * (half == SECOND) + (kind & RISING)];
    for (int k = 0; k < 3; ++k)
        corner[k] = node_at(h, bi + (c[k] & 1), bj + (c[k] >> 1));
}

/* z = a + b x + c y */
typedef struct plane {
    float a, b, c;
} plane;

static plane plane_through(node *const n[3])
{
    const float x1 = n[1]->x - n[0]->x, y1 = n[1]->y - n[0]->y, z1 = n[1]->z - n[0]->z;
    const float x2 = n[2]->x - n[0]->x, y2 = n[2]->y - n[0]->y, z2 = n[2]->z - n[0]->z;
    const float det = x1 * y2 - x2 * y1;
    const float b = (z1 * y2 - z2 * y1) / det, c = (x1 * z2 - x2 * z1) / det;
    return (plane){n[0]->z - b * n[0]->x - c * n[0]->y, b, c};
}

/* Whether one of the cells around node (i, j) is marked. */
static bool is_corner(const hull *h, const uint8_t *marks, uint32_t i, uint32_t j)
{
    const uint32_t width = h->grid->nodes_x - 1, height = h->grid->nodes_y - 1;
    const uint32_t i0 = i ? i - 1 : 0, j0 = j ? j - 1 : 0;
    const uint32_t i1 = min_u32(i, width - 1), j1 = min_u32(j, height - 1);
    return marks[(size_t)j0 * width + i0] || marks[(size_t)j0 * width + i1] ||
           marks[(size_t)j1 * width + i0] || marks[(size_t)j1 * width + i1];
}

/* How far the sheet is above and below a triangle's plane where it shows, over the cells that the
 * triangle meets: over a cell the difference is bilinear, and greatest in a corner. */
static void measure_half(hull *h, uint32_t bi, uint32_t bj, uint8_t half, float *up,
                         float *down)
{
    const uint8_t kind = block_at(h, bi, bj);
    const uint32_t x0 = line(h, 0, bi), x1 = line(h, 0, bi + 1);
    const uint32_t y0 = line(h, 1, bj), y1 = line(h, 1, bj + 1);
    const float du = 1 / (float)(x1 - x0), dv = 1 / (float)(y1 - y0), spare = du + dv + 1e-4f;
    node *corner[3];
    triangle_of(h, bi, bj, half, corner);
    const plane p = plane_through(corner);
    for (uint32_t j = y0; j <= y1; ++j)
        for (uint32_t i = x0; i <= x1; ++i) {
            const float u = du * (float)(i - x0), v = dv * (float)(j - y0);
            const float side = kind & RISING ? v - u : u + v - 1; /* above 0 in the second half */
            if ((half == FIRST ? side : -side) > spare || !is_corner(h, h->grid->solid, i, j))
                continue;
            const float code = h->grid->code[(size_t)j * h->grid->nodes_x + i];
            const float over = code - (p.a + p.b * texel(h, 0, i) + p.c * texel(h, 1, j));
            h->highest = fmaxf(h->highest, over);
            h->lowest = fminf(h->lowest, over);
            if (!is_corner(h, h->shown, i, j))
                continue;
            *up = fmaxf(*up, over);
            *down = fmaxf(*down, -over);
        }
}

/* Lifts the nodes until all triangles are clear of the sheet. Returns the hull's thickness. */
static float lift_nodes(hull *h)
{
    float lid = 0, floor = 0;
    for (uint32_t bj = 0; bj < h->blocks[1]; ++bj)
        for (uint32_t bi = 0; bi < h->blocks[0]; ++bi)
            for (uint8_t half = FIRST; half <= SECOND; half = (uint8_t)(2 * half)) {
                node *corner[3];
                float up = 0, down = 0;
                if (!(block_at(h, bi, bj) & half))
                    continue;
                measure_half(h, bi, bj, half, &up, &down);
                triangle_of(h, bi, bj, half, corner);
                for (int k = 0; k < 3; ++k) {
                    corner[k]->up = fmaxf(corner[k]->up, up);
                    corner[k]->down = fmaxf(corner[k]->down, down);
                }
            }
    for (size_t n = 0; n < ((size_t)h->blocks[0] + 1) * (h->blocks[1] + 1); ++n) {
        lid = fmaxf(lid, h->nodes[n].up);
        floor = fmaxf(floor, h->nodes[n].down);
    }
    return fmaxf(lid - h->lowest, h->highest + floor);
}

static uint32_t add_vertex(gtx_proxies *out, const node *n, float z, uint32_t patch)
{
    out->vertices[out->vertex_count] = (gtx_proxy_vertex){n->x, n->y, z, patch};
    return out->vertex_count++;
}

static uint32_t top_of(gtx_proxies *out, node *n, float grow, uint32_t patch)
{
    if (n->top == NONE)
        n->top = add_vertex(out, n, n->z + n->up + grow, patch);
    return n->top;
}

static uint32_t bottom_of(gtx_proxies *out, node *n, float grow, uint32_t patch)
{
    if (n->bottom == NONE)
        n->bottom = add_vertex(out, n, n->z - n->down - grow, patch);
    return n->bottom;
}

static void add_triangle(gtx_proxies *out, uint32_t a, uint32_t b, uint32_t c)
{
    out->indices[out->index_count++] = a;
    out->indices[out->index_count++] = b;
    out->indices[out->index_count++] = c;
}

/* Whether there is a triangle on the inner side of a block's edge: below, right, above, left. */
static bool has_edge(uint8_t block, int edge)
{
    static const uint8_t half[2][4] = {{FIRST, SECOND, SECOND, FIRST},
                                       {FIRST, FIRST, SECOND, SECOND}};
    return block & half[block & RISING][edge];
}

/* Adds the lid, the walls and, if the patch is two-sided, the floor of a block. */
static void add_block(const hull *h, uint32_t bi, uint32_t bj, float grow, uint32_t tag,
                      gtx_proxies *out)
{
    static const int beside[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    const uint8_t kind = block_at(h, bi, bj);
    node *const ring[4] = {node_at(h, bi, bj), node_at(h, bi + 1, bj), node_at(h, bi + 1, bj + 1),
                           node_at(h, bi, bj + 1)};
    node *wall[6][2];
    int walls = 0;
    for (uint8_t half = FIRST; half <= SECOND; half = (uint8_t)(2 * half)) {
        node *c[3];
        if (!(kind & half))
            continue;
        triangle_of(h, bi, bj, half, c);
        add_triangle(out, top_of(out, c[0], grow, tag), top_of(out, c[1], grow, tag),
                     top_of(out, c[2], grow, tag));
        if (h->patch->flags & GTX_PATCH_TWO_SIDED)
            add_triangle(out, bottom_of(out, c[0], grow, tag), bottom_of(out, c[2], grow, tag),
                         bottom_of(out, c[1], grow, tag));
    }
    for (int e = 0; e < 4; ++e)
        if (has_edge(kind, e) &&
            !has_edge(block_at(h, (int64_t)bi + beside[e][0], (int64_t)bj + beside[e][1]),
                      (e + 2) % 4)) {
            wall[walls][0] = ring[e];
            wall[walls++][1] = ring[(e + 1) % 4];
        }
    if ((kind & FIRST) && !(kind & SECOND)) { /* along the diagonal, the triangle on its left */
        wall[walls][0] = kind & RISING ? ring[2] : ring[1];
        wall[walls++][1] = kind & RISING ? ring[0] : ring[3];
    } else if ((kind & SECOND) && !(kind & FIRST)) {
        wall[walls][0] = kind & RISING ? ring[0] : ring[3];
        wall[walls++][1] = kind & RISING ? ring[2] : ring[1];
    }
    for (int w = 0; w < walls; ++w) {
        const uint32_t a = top_of(out, wall[w][0], grow, tag);
        const uint32_t b = top_of(out, wall[w][1], grow, tag);
        const uint32_t below = bottom_of(out, wall[w][0], grow, tag);
        add_triangle(out, b, a, below);
        add_triangle(out, b, below, bottom_of(out, wall[w][1], grow, tag));
    }
}

static gtx_result build(hull *h, uint32_t patch, float grow, const gtx_allocator *hooks,
                        gtx_proxies *out, float *thickness, gtx_error *error)
{
    const size_t blocks = (size_t)h->blocks[0] * h->blocks[1];
    const size_t nodes = ((size_t)h->blocks[0] + 1) * (h->blocks[1] + 1);
    h->block = gtx_alloc_array(hooks, blocks, sizeof *h->block);
    h->nodes = gtx_alloc_array(hooks, nodes, sizeof *h->nodes);
    gtx_result result = h->block && h->nodes
                            ? gtx_proxies_reserve(out, 2 * nodes, 36 * blocks, hooks, error)
                            : gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a hull");
    if (!result) {
        const uint32_t tag = patch | (h->grid->level + 1) << GTX_PROXY_KIND_SHIFT;
        for (size_t b = 0; b < blocks; ++b)
            h->block[b] = halves_of(h, (uint32_t)(b % h->blocks[0]), (uint32_t)(b / h->blocks[0]));
        place_nodes(h, grow);
        *thickness = lift_nodes(h) + 2 * grow + 1;
        for (size_t b = 0; b < blocks; ++b)
            if (h->block[b])
                add_block(h, (uint32_t)(b % h->blocks[0]), (uint32_t)(b / h->blocks[0]), grow,
                          tag, out);
    }
    gtx_free_array(hooks, h->nodes, nodes, sizeof *h->nodes);
    gtx_free_array(hooks, h->block, blocks, sizeof *h->block);
    return result;
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
    hull h = {.asset = asset, .patch = &asset->patches[patch], .grid = grid};
    const size_t cells = (size_t)(grid->nodes_x - 1) * (grid->nodes_y - 1);
    h.shown = gtx_alloc_array(&hooks, cells, sizeof *h.shown);
    if (!h.shown)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a hull");
    gtx_result result = GTX_OK;
    *thickness = 0;
    find_shown(&h);
    if (h.high[0]) {
        for (int a = 0; a < 2; ++a)
            h.blocks[a] = (h.high[a] - h.low[a] + BLOCK - 1) / BLOCK;
        result = build(&h, patch, grow, &hooks, out, thickness, error);
    }
    gtx_free_array(&hooks, h.shown, cells, sizeof *h.shown);
    return result;
}
