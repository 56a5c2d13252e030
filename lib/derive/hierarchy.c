/* The hierarchy over boxes: split where the surface area heuristic says (Goldsmith and Salmon 1987,
 * binned after Wald 2007). */
#include "derive/hierarchy.h"

#include "asset/patch.h"
#include "base/alloc.h"
#include "base/error.h"

#include <math.h>

enum { BINS = 16, BALANCED_DEPTH = 32 };

const gtx_box gtx_box_empty = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

typedef struct builder {
    const gtx_box *boxes;
    uint32_t *order;          /* of the boxes; a node owns a range */
    gtx_node *nodes;
    uint32_t node_count;
} builder;

static void include(gtx_box *a, const gtx_box *b)
{
    for (int k = 0; k < 3; ++k) {
        a->low[k] = a->low[k] < b->low[k] ? a->low[k] : b->low[k];
        a->high[k] = a->high[k] > b->high[k] ? a->high[k] : b->high[k];
    }
}

void gtx_box_widen(gtx_box *box)
{
    for (int k = 0; k < 3; ++k) {
        const float slack = 1e-6f * (fabsf(box->low[k]) + fabsf(box->high[k]));
        box->low[k] = nextafterf(box->low[k] - slack, -INFINITY);
        box->high[k] = nextafterf(box->high[k] + slack, INFINITY);
    }
}

static float half_area(const gtx_box *b)
{
    float x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
    return x < 0 ? 0 : x * y + y * z + z * x;
}

static float centre(const gtx_box *b, int axis)
{
    return b->low[axis] / 2 + b->high[axis] / 2;
}

typedef struct split {
    int axis;
    uint32_t bin;             /* boxes of bins below it go to the first child */
    float low, scale, cost;
} split;

static uint32_t bin_of(const gtx_box *b, const split *s)
{
    float bin = (centre(b, s->axis) - s->low) * s->scale;
    return bin < BINS - 1 ? (uint32_t)bin : BINS - 1;
}

/* Tries the planes between the bins of one axis. */
static void try_axis(const builder *b, const uint32_t *order, uint32_t count, int axis,
                     split *best)
{
    float low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < count; ++i) {
        float at = centre(&b->boxes[order[i]], axis);
        low = at < low ? at : low;
        high = at > high ? at : high;
    }
    split s = {.axis = axis, .low = low, .scale = BINS / (high - low)};
    if (!(high > low) || !isfinite(s.scale))
        return;
    gtx_box bins[BINS];
    uint32_t counts[BINS] = {0};
    for (int i = 0; i < BINS; ++i)
        bins[i] = gtx_box_empty;
    for (uint32_t i = 0; i < count; ++i) {
        const gtx_box *box = &b->boxes[order[i]];
        uint32_t bin = bin_of(box, &s);
        include(&bins[bin], box);
        ++counts[bin];
    }
    float right_cost[BINS];
    gtx_box sum = gtx_box_empty;
    uint32_t taken = 0;
    for (int i = BINS - 1; i > 0; --i) {
        include(&sum, &bins[i]);
        taken += counts[i];
        right_cost[i] = half_area(&sum) * (float)taken;
    }
    sum = gtx_box_empty;
    taken = 0;
    for (s.bin = 1; s.bin < BINS; ++s.bin) {
        include(&sum, &bins[s.bin - 1]);
        taken += counts[s.bin - 1];
        s.cost = half_area(&sum) * (float)taken + right_cost[s.bin];
        if (taken && taken < count && s.cost < best->cost)
            *best = s;
    }
}

/* Reorders the boxes of a node and returns how many the first child gets. Past a depth that only
 * degenerate boxes reach halves bound the depth. */
static uint32_t divide(const builder *b, uint32_t *order, uint32_t count, uint32_t depth)
{
    split best = {.cost = INFINITY};
    for (int axis = 0; axis < 3 && depth < BALANCED_DEPTH; ++axis)
        try_axis(b, order, count, axis, &best);
    if (best.cost == INFINITY)
        return count / 2;
    uint32_t low = 0, high = count;
    while (low < high) {
        if (bin_of(&b->boxes[order[low]], &best) < best.bin) {
            ++low;
        } else {
            uint32_t swap = order[--high];
            order[high] = order[low];
            order[low] = swap;
        }
    }
    return low;
}

static void build_node(builder *b, uint32_t first, uint32_t count, uint32_t depth)
{
    uint32_t *order = b->order + first;
    gtx_node *node = &b->nodes[b->node_count++];
    gtx_box whole = gtx_box_empty;
    for (uint32_t i = 0; i < count; ++i)
        include(&whole, &b->boxes[order[i]]);
    for (int k = 0; k < 3; ++k) {
        node->low[k] = whole.low[k];
        node->high[k] = whole.high[k];
    }
    node->link = GTX_LEAF + order[0];
    if (count > 1) {
        uint32_t left = divide(b, order, count, depth);
        build_node(b, first, left, depth + 1);
        node->link = b->node_count;
        build_node(b, first + left, count - left, depth + 1);
    }
    node->skip = b->node_count;
}

gtx_result gtx_hierarchy_build(const gtx_box *boxes, uint32_t count,
                               const gtx_allocator *allocator, gtx_hierarchy *out,
                               gtx_error *error)
{
    *out = (gtx_hierarchy){0};
    uint32_t used = 0;
    for (uint32_t i = 0; i < count; ++i)
        used += boxes[i].low[0] <= boxes[i].high[0];
    if (used >= GTX_LEAF / 2)
        return gtx_fail(error, GTX_ERROR_LIMIT, "a hierarchy over %u boxes is too large", used);
    if (!used)
        return GTX_OK;
    builder b = {.boxes = boxes, .order = gtx_alloc_array(allocator, used, sizeof *b.order)};
    out->capacity = 2 * used - 1;
    out->nodes = b.nodes = gtx_alloc_array(allocator, out->capacity, sizeof *b.nodes);
    if (!b.order || !b.nodes) {
        gtx_free_array(allocator, b.order, used, sizeof *b.order);
        gtx_hierarchy_free(out, allocator);
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a hierarchy over %u boxes", used);
    }
    for (uint32_t i = 0, k = 0; i < count; ++i)
        if (boxes[i].low[0] <= boxes[i].high[0])
            b.order[k++] = i;
    build_node(&b, 0, used, 0);
    out->node_count = b.node_count;
    gtx_free_array(allocator, b.order, used, sizeof *b.order);
    return GTX_OK;
}

void gtx_hierarchy_free(gtx_hierarchy *hierarchy, const gtx_allocator *allocator)
{
    gtx_free_array(allocator, hierarchy->nodes, hierarchy->capacity, sizeof *hierarchy->nodes);
    *hierarchy = (gtx_hierarchy){0};
}

static uint32_t min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* A bilinear height field lies in the hull of its corners. */
static void include_cell(gtx_box *box, const gtx_patch_frame *f, const gtx_patch *patch,
                         const gtx_grid *grid, uint32_t i, uint32_t j)
{
    for (uint32_t corner = 0; corner < 4; ++corner) {
        const uint32_t x = i + (corner & 1), y = j + (corner >> 1);
        const double at[3] = {min_u32(x << grid->level, patch->rect[2] - 1u),
                              min_u32(y << grid->level, patch->rect[3] - 1u),
                              grid->code[(size_t)y * grid->nodes_x + x]};
        for (int k = 0; k < 3; ++k) {
            const float p = (float)(f->origin[k] + at[0] * f->axis[0][k] + at[1] * f->axis[1][k] +
                                    at[2] * f->axis[2][k]);
            box->low[k] = p < box->low[k] ? p : box->low[k];
            box->high[k] = p > box->high[k] ? p : box->high[k];
        }
    }
}

void gtx_grid_boxes(const gtx_asset *asset, uint32_t patch, const gtx_grid *grid, gtx_box *out)
{
    const gtx_patch *record = &asset->patches[patch];
    const gtx_patch_frame f = gtx_patch_frame_of(record, asset->info.height_bits);
    const uint32_t cells_x = grid->nodes_x - 1, cells_y = grid->nodes_y - 1;
    const uint32_t wide = gtx_blocks_of(cells_x), count = wide * gtx_blocks_of(cells_y);
    for (uint32_t b = 0; b < count; ++b) {
        const uint32_t i0 = b % wide * GTX_BLOCK, j0 = b / wide * GTX_BLOCK;
        out[b] = gtx_box_empty;
        for (uint32_t j = j0; j < min_u32(j0 + GTX_BLOCK, cells_y); ++j)
            for (uint32_t i = i0; i < min_u32(i0 + GTX_BLOCK, cells_x); ++i)
                if (grid->solid[(size_t)j * cells_x + i])
                    include_cell(&out[b], &f, record, grid, i, j);
        if (out[b].low[0] <= out[b].high[0])
            gtx_box_widen(&out[b]);
    }
}
