/* Hulls: tight proxies over blocks of a level's cells, a lid through the blocks' corners. */
#include "derive/hull.h"

#include "base/alloc.h"
#include "base/error.h"
#include "derive/codes.h"

#include <math.h>

/* Processors shade small triangles by whole groups of pixels, so that few large ones cost least. */
enum { BLOCK = GTX_HULL_BLOCK };
/* Codes that vectors may read beyond the last one. */
enum { SPARE = 3 };
_Static_assert((int)BLOCK <= (int)GTX_MAX_MOMENTS, "a block's sums fit");

/* Where a block's two triangles are: in the halves beside its diagonal. */
enum {
    RISING = 1,               /* the diagonal goes from corner 0 to 3, or else from 1 to 2 */
    FIRST = 2, SECOND = 4     /* the half of the corners 0, 1 and one more; the other */
};

static void load_nodes(gtx_hull *h)
{
    const uint32_t width = h->grid->nodes_x;
    for (uint32_t i = 0; i < width; ++i)
        h->columns[i] = gtx_hull_texel(h, 0, i);
    for (uint32_t j = 0; j < h->grid->nodes_y; ++j)
        for (uint32_t i = 0; i < width; i += GTX_CODES_RUN)
            gtx_load_codes(h->grid, i, width - i < GTX_CODES_RUN ? width - i : GTX_CODES_RUN, j,
                           h->codes + (size_t)j * width + i);
}

/* Which halves of a block are needed, with a cell to spare, so that the hull follows slanted
 * outlines by leaving halves out; and the block's sums. */
static void look_at_block(gtx_hull *h, uint32_t bi, uint32_t bj)
{
    const uint32_t from[2] = {gtx_hull_line(h, 0, bi), gtx_hull_line(h, 1, bj)};
    const uint32_t to[2] = {gtx_hull_line(h, 0, bi + 1), gtx_hull_line(h, 1, bj + 1)};
    const float du = 1 / (float)(to[0] - from[0]), dv = 1 / (float)(to[1] - from[1]);
    const float spare = 1.5f * (du + dv);
    const size_t b = (size_t)bj * h->blocks[0] + bi;
    float rise[2] = {INFINITY, -INFINITY}, fall[2] = {INFINITY, -INFINITY};
    for (uint32_t j = from[1]; j < to[1]; ++j) {
        const uint8_t *solid = h->grid->solid + (size_t)j * (h->grid->nodes_x - 1);
        uint32_t first = from[0], end = to[0];
        while (first < end && !solid[first])
            ++first;
        while (end > first && !solid[end - 1])
            --end;
        if (first == end)
            continue;
        const float v = dv * ((float)(j - from[1]) + 0.5f);
        const float u[2] = {du * ((float)(first - from[0]) + 0.5f),
                            du * ((float)(end - 1 - from[0]) + 0.5f)};
        rise[0] = gtx_lesser(rise[0], v - u[1]), rise[1] = gtx_greater(rise[1], v - u[0]);
        fall[0] = gtx_lesser(fall[0], u[0] + v - 1), fall[1] = gtx_greater(fall[1], u[1] + v - 1);
    }
    const gtx_moments m = gtx_moments_of(h->grid, from, to);
    const bool below = rise[0] < spare, above = rise[1] > -spare; /* the rising diagonal */
    const bool near = fall[0] < spare, far = fall[1] > -spare;    /* the falling one */
    if (m.n > 0 && below && above && !(near && far))
        h->block[b] = near ? FIRST : SECOND;
    else if (m.n > 0)
        h->block[b] = (uint8_t)(RISING | (below ? FIRST : 0) | (above ? SECOND : 0));
    h->sums[b] = m;
}

/* Whether there is a triangle on the inner side of a block's edge: below, right, above, left. */
static bool has_edge(uint8_t block, uint32_t side)
{
    static const uint8_t half[2][4] = {{FIRST, SECOND, SECOND, FIRST},
                                       {FIRST, FIRST, SECOND, SECOND}};
    return block & half[block & RISING][side];
}

/* The block's triangles, and those of their edges where nothing is beside. */
static void split_block(gtx_hull *h, uint32_t bi, uint32_t bj)
{
    static const int beside[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    static const uint8_t corners[4][3] = {{0, 1, 3}, {0, 1, 2}, {1, 2, 3}, {0, 2, 3}};
    const uint8_t kind = gtx_hull_block(h, bi, bj);
    const uint32_t row = h->blocks[0] + 1, first = bj * row + bi;
    const uint32_t ring[4] = {first, first + 1, first + row + 1, first + row};
    for (int second = 0; second < 2; ++second) {
        const uint8_t *c = corners[2 * second + (kind & RISING)];
        if (kind & (second ? SECOND : FIRST))
            h->triangles[h->triangle_count++] =
                (gtx_hull_triangle){{ring[c[0]], ring[c[1]], ring[c[2]]}};
    }
    for (uint32_t e = 0; e < 4; ++e)
        if (has_edge(kind, e) && !has_edge(gtx_hull_block(h, (int64_t)bi + beside[e][0],
                                                    (int64_t)bj + beside[e][1]), (e + 2) % 4))
            h->edges[h->edge_count++] = (gtx_hull_edge){{ring[e], ring[(e + 1) % 4]}, {bi, bj}};
    const int lower = kind & RISING ? 2 : 1, upper = kind & RISING ? 0 : 3;
    if ((kind & FIRST) && !(kind & SECOND))
        h->edges[h->edge_count++] = (gtx_hull_edge){{ring[lower], ring[upper]}, {bi, bj}};
    if ((kind & SECOND) && !(kind & FIRST))
        h->edges[h->edge_count++] = (gtx_hull_edge){{ring[upper], ring[lower]}, {bi, bj}};
}

/* More than the height field is under the lid, or over the floor. */
static float thickness_of(const gtx_hull *h)
{
    float lid = 0, floor = 0;
    for (size_t i = 0; i < h->node_count; ++i) {
        lid = gtx_greater(lid, h->nodes[i].up);
        floor = gtx_greater(floor, h->nodes[i].down);
    }
    return gtx_greater(lid - h->lowest, h->highest + floor) + 1;
}

static uint32_t add_vertex(gtx_proxies *out, const gtx_hull_node *n, float z, uint32_t tag)
{
    out->vertices[out->vertex_count] = (gtx_proxy_vertex){n->x, n->y, z, tag};
    return out->vertex_count++;
}

static uint32_t top_of(gtx_proxies *out, gtx_hull_node *n, uint32_t tag)
{
    if (n->top == GTX_HULL_NONE)
        n->top = add_vertex(out, n, n->z + n->up, tag);
    return n->top;
}

static uint32_t bottom_of(gtx_proxies *out, gtx_hull_node *n, uint32_t tag)
{
    if (n->bottom == GTX_HULL_NONE)
        n->bottom = add_vertex(out, n, n->z - n->down, tag);
    return n->bottom;
}

static void add_triangle(gtx_proxies *out, uint32_t a, uint32_t b, uint32_t c)
{
    out->indices[out->index_count++] = a;
    out->indices[out->index_count++] = b;
    out->indices[out->index_count++] = c;
}

static void emit(const gtx_hull *h, uint32_t tag, gtx_proxies *out)
{
    for (size_t i = 0; i < h->triangle_count; ++i) {
        gtx_hull_node *n[3];
        for (int k = 0; k < 3; ++k)
            n[k] = &h->nodes[h->triangles[i].node[k]];
        add_triangle(out, top_of(out, n[0], tag), top_of(out, n[1], tag), top_of(out, n[2], tag));
        if (h->two_sided)
            add_triangle(out, bottom_of(out, n[0], tag), bottom_of(out, n[2], tag),
                         bottom_of(out, n[1], tag));
    }
    for (size_t e = 0; e < h->edge_count; ++e) {
        gtx_hull_node *a = &h->nodes[h->edges[e].node[0]], *b = &h->nodes[h->edges[e].node[1]];
        const uint32_t below = bottom_of(out, a, tag);
        add_triangle(out, top_of(out, b, tag), top_of(out, a, tag), below);
        add_triangle(out, top_of(out, b, tag), below, bottom_of(out, b, tag));
    }
}

static void build(gtx_hull *h)
{
    load_nodes(h);
    for (uint32_t b = 0; b < h->block_count; ++b)
        look_at_block(h, b % h->blocks[0], b / h->blocks[0]);
    for (uint32_t b = 0; b < h->block_count; ++b)
        split_block(h, b % h->blocks[0], b / h->blocks[0]);
    gtx_hull_fit(h);
}

/* One piece of memory for all arrays, the best aligned first. Returns its bytes, 0 without
 * memory. */
static size_t allocate(gtx_hull *h, const gtx_allocator *hooks)
{
    h->block_count = (size_t)h->blocks[0] * h->blocks[1];
    h->node_count = ((size_t)h->blocks[0] + 1) * (h->blocks[1] + 1);
    const size_t level_nodes = (size_t)h->grid->nodes_x * h->grid->nodes_y;
    const size_t size =
        h->block_count * (sizeof *h->sums + 2 * sizeof *h->triangles + 5 * sizeof *h->edges +
                          sizeof *h->block) + h->node_count * sizeof *h->nodes +
        (h->grid->nodes_x + level_nodes + SPARE) * sizeof *h->codes;
    h->sums = gtx_alloc_array(hooks, size, 1);
    if (!h->sums)
        return 0;
    h->nodes = (gtx_hull_node *)(h->sums + h->block_count);
    h->triangles = (gtx_hull_triangle *)(h->nodes + h->node_count);
    h->edges = (gtx_hull_edge *)(h->triangles + 2 * h->block_count);
    h->columns = (float *)(h->edges + 5 * h->block_count);
    h->codes = h->columns + h->grid->nodes_x;
    h->block = (uint8_t *)(h->codes + level_nodes + SPARE);
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
    gtx_hull h = {.grid = grid, .last = {p->rect[2] - 1u, p->rect[3] - 1u},
              .two_sided = p->flags & GTX_PATCH_TWO_SIDED, .grow = grow};
    *thickness = 0;
    if (!gtx_solid_extent(grid, h.low, h.high))
        return GTX_OK;
    for (int a = 0; a < 2; ++a)
        h.blocks[a] = (h.high[a] - h.low[a] + BLOCK - 1) / BLOCK;
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
