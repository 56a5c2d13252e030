/* The hierarchy over sheets: boxes split where the surface area heuristic says (Goldsmith and
 * Salmon 1987, binned after Wald 2007). Same sheets, same tree. */
#include "trace/caster.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>

enum { BINS = 16, LEAF_SHEETS = 2, BALANCED_DEPTH = 32 };

typedef struct box {
    float low[3], high[3];
} box;

typedef struct builder {
    gtx_bvh *bvh;
    box *boxes; /* one a sheet */
} builder;

static const box EMPTY = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void join(box *a, const box *b)
{
    for (int k = 0; k < 3; ++k) {
        a->low[k] = fminf(a->low[k], b->low[k]);
        a->high[k] = fmaxf(a->high[k], b->high[k]);
    }
}

static float half_area(const box *b)
{
    float x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
    return x < 0 ? 0 : x * y + y * z + z * x;
}

static float centre(const box *b, int axis)
{
    return b->low[axis] / 2 + b->high[axis] / 2;
}

/* The box of a sheet's solid cells in object space, rounded outwards. */
static box sheet_box(const gtx_sheet *sheet)
{
    double from[3][3], det = 0;
    const double(*m)[4] = (const double(*)[4])sheet->to_grid;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            int r1 = (c + 1) % 3, r2 = (c + 2) % 3, c1 = (r + 1) % 3, c2 = (r + 2) % 3;
            from[r][c] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
        }
    for (int k = 0; k < 3; ++k)
        det += m[0][k] * from[k][0];
    box b = EMPTY;
    for (int corner = 0; corner < 8; ++corner)
        for (int k = 0; k < 3; ++k) {
            double p = 0;
            for (int a = 0; a < 3; ++a)
                p += from[k][a] / det * ((corner >> a & 1 ? sheet->high : sheet->low)[a] - m[a][3]);
            b.low[k] = fminf(b.low[k], (float)p);
            b.high[k] = fmaxf(b.high[k], (float)p);
        }
    for (int k = 0; k < 3; ++k) {
        float slack = 1e-6f * (fabsf(b.low[k]) + fabsf(b.high[k]));
        b.low[k] = nextafterf(b.low[k] - slack, -INFINITY);
        b.high[k] = nextafterf(b.high[k] + slack, INFINITY);
    }
    return b;
}

static uint32_t bin_of(const box *b, int axis, float low, float scale)
{
    float bin = (centre(b, axis) - low) * scale;
    return bin < BINS - 1 ? (uint32_t)bin : BINS - 1;
}

typedef struct split {
    int axis;
    uint32_t bin; /* sheets of bins below it go to the first child */
    float low, scale, cost;
} split;

/* Tries the planes between the bins of one axis. */
static void try_axis(const builder *b, const gtx_bvh_node *node, int axis, split *best)
{
    const uint32_t *order = b->bvh->order + node->first;
    float low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < node->count; ++i) {
        low = fminf(low, centre(&b->boxes[order[i]], axis));
        high = fmaxf(high, centre(&b->boxes[order[i]], axis));
    }
    float scale = BINS / (high - low);
    if (!(high > low) || !isfinite(scale))
        return;
    box bins[BINS];
    uint32_t counts[BINS] = {0};
    for (int i = 0; i < BINS; ++i)
        bins[i] = EMPTY;
    for (uint32_t i = 0; i < node->count; ++i) {
        uint32_t bin = bin_of(&b->boxes[order[i]], axis, low, scale);
        join(&bins[bin], &b->boxes[order[i]]);
        ++counts[bin];
    }
    float right_cost[BINS];
    box sum = EMPTY;
    uint32_t count = 0;
    for (int i = BINS - 1; i > 0; --i) {
        join(&sum, &bins[i]);
        count += counts[i];
        right_cost[i] = half_area(&sum) * (float)count;
    }
    sum = EMPTY;
    count = 0;
    for (uint32_t i = 1; i < BINS; ++i) {
        join(&sum, &bins[i - 1]);
        count += counts[i - 1];
        float cost = half_area(&sum) * (float)count + right_cost[i];
        if (count && count < node->count && cost < best->cost)
            *best = (split){axis, i, low, scale, cost};
    }
}

/* Reorders the node's sheets and returns how many the first child gets. */
static uint32_t divide(const builder *b, const gtx_bvh_node *node, uint32_t depth)
{
    split best = {.cost = INFINITY};
    for (int axis = 0; axis < 3 && depth < BALANCED_DEPTH; ++axis)
        try_axis(b, node, axis, &best);
    if (best.cost == INFINITY)
        return node->count / 2;
    uint32_t *order = b->bvh->order + node->first, low = 0, high = node->count;
    while (low < high) {
        if (bin_of(&b->boxes[order[low]], best.axis, best.low, best.scale) < best.bin) {
            ++low;
        } else {
            uint32_t swap = order[--high];
            order[high] = order[low];
            order[low] = swap;
        }
    }
    return low;
}

static void build_node(const builder *b, uint32_t index, uint32_t depth)
{
    gtx_bvh_node *node = &b->bvh->nodes[index];
    box whole = EMPTY;
    for (uint32_t i = 0; i < node->count; ++i)
        join(&whole, &b->boxes[b->bvh->order[node->first + i]]);
    for (int k = 0; k < 3; ++k) {
        node->low[k] = whole.low[k];
        node->high[k] = whole.high[k];
    }
    if (node->count <= LEAF_SHEETS)
        return;
    uint32_t left = divide(b, node, depth), child = b->bvh->node_count;
    b->bvh->node_count += 2;
    b->bvh->nodes[child].first = node->first;
    b->bvh->nodes[child].count = left;
    b->bvh->nodes[child + 1].first = node->first + left;
    b->bvh->nodes[child + 1].count = node->count - left;
    node->first = child;
    node->count = 0;
    build_node(b, child, depth + 1);
    build_node(b, child + 1, depth + 1);
}

gtx_result gtx_bvh_build(gtx_bvh *bvh, const gtx_sheet *sheets, uint32_t count,
                         const gtx_allocator *allocator, gtx_error *error)
{
    bvh->order = gtx_alloc_array(allocator, count, sizeof *bvh->order);
    bvh->nodes = gtx_alloc_array(allocator, 2 * (size_t)count, sizeof *bvh->nodes);
    bvh->sheet_count = count;
    builder b = {bvh, gtx_alloc_array(allocator, count, sizeof(box))};
    gtx_result result = GTX_OK;
    if (!bvh->order || !bvh->nodes || !b.boxes) {
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a hierarchy of %u patches",
                          count);
    } else {
        uint32_t used = 0;
        for (uint32_t i = 0; i < count; ++i)
            if (sheets[i].low[0] <= sheets[i].high[0]) {
                b.boxes[i] = sheet_box(&sheets[i]);
                bvh->order[used++] = i;
            }
        bvh->nodes[0].count = used;
        bvh->node_count = used ? 1 : 0;
        if (used)
            build_node(&b, 0, 0);
    }
    gtx_free_array(allocator, b.boxes, count, sizeof(box));
    return result;
}

void gtx_bvh_free(gtx_bvh *bvh, const gtx_allocator *allocator)
{
    gtx_free_array(allocator, bvh->order, bvh->sheet_count, sizeof *bvh->order);
    gtx_free_array(allocator, bvh->nodes, 2 * (size_t)bvh->sheet_count, sizeof *bvh->nodes);
}
