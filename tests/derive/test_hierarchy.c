/* The hierarchy: empty, one box, boxes on one spot, order and cover of the nodes, and blocks that
 * hold their cells. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "asset/patch.h"
#include "base/alloc.h"
#include "common/fixture.h"
#include "derive/placement.h"

#include <math.h>
#include <stdlib.h>

static const gtx_allocator *hooks(void)
{
    static gtx_allocator standard;
    standard = gtx_allocator_or_default(NULL);
    return &standard;
}

static double uniform(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

/* Every leaf once, children within parents, subtrees that end where `skip` says, and no deeper than
 * stacks are. */
static uint32_t walk(const gtx_hierarchy *h, uint32_t at, uint32_t depth, uint8_t *seen)
{
    const gtx_node *node = &h->nodes[at];
    assert_true(depth <= GTX_HIERARCHY_DEPTH && at < h->node_count);
    if (node->link & GTX_LEAF) {
        assert_int_equal(seen[node->link - GTX_LEAF]++, 0);
        assert_int_equal(node->skip, at + 1);
        return 1;
    }
    uint32_t leaves = 0;
    const uint32_t children[2] = {at + 1, node->link};
    for (int c = 0; c < 2; ++c) {
        const gtx_node *child = &h->nodes[children[c]];
        for (int k = 0; k < 3; ++k)
            assert_true(child->low[k] >= node->low[k] && child->high[k] <= node->high[k]);
        leaves += walk(h, children[c], depth + 1, seen);
    }
    assert_int_equal(h->nodes[at + 1].skip, node->link);
    assert_int_equal(h->nodes[node->link].skip, node->skip);
    return leaves;
}

static void expect_whole(const gtx_box *boxes, uint32_t count, uint32_t filled)
{
    gtx_hierarchy h, again;
    uint8_t *seen = calloc(count + 1, 1);
    assert_int_equal(gtx_hierarchy_build(boxes, count, hooks(), &h, NULL), GTX_OK);
    assert_int_equal(gtx_hierarchy_build(boxes, count, hooks(), &again, NULL), GTX_OK);
    assert_int_equal(h.node_count, filled ? 2 * filled - 1 : 0);
    if (filled) {
        assert_int_equal(walk(&h, 0, 0, seen), filled);
        assert_int_equal(h.nodes[0].skip, h.node_count);
        assert_memory_equal(h.nodes, again.nodes, h.node_count * sizeof *h.nodes);
    }
    free(seen);
    gtx_hierarchy_free(&h, hooks());
    gtx_hierarchy_free(&again, hooks());
}

static void any_boxes(void **state)
{
    (void)state;
    enum { COUNT = 3000 };
    static gtx_box boxes[COUNT];
    uint64_t seed = 1;
    expect_whole(NULL, 0, 0);
    boxes[0] = gtx_box_empty;
    expect_whole(boxes, 1, 0);
    boxes[0] = (gtx_box){{1, 2, 3}, {1, 2, 3}};
    expect_whole(boxes, 1, 1);
    for (int kind = 0; kind < 4; ++kind) {
        uint32_t filled = 0;
        for (int i = 0; i < COUNT; ++i) {
            const double spreads[4] = {0, pow(2, -i / 40), 1, 1e37}, spread = spreads[kind];
            for (int k = 0; k < 3; ++k) {
                boxes[i].low[k] = (float)(spread * uniform(&seed));
                boxes[i].high[k] = boxes[i].low[k] + (float)(0.01 * spread * uniform(&seed));
            }
            if (i % 7 == 3)
                boxes[i] = gtx_box_empty;
            filled += i % 7 != 3;
        }
        expect_whole(boxes, COUNT, filled);
    }
}

/* The points of a level's solid cells lie in the boxes of their blocks. */
static void blocks_hold_their_cells(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_bumpy(8, 0);
    const gtx_patch *patch = gtx_patches(asset);
    const gtx_patch_frame f = gtx_patch_frame_of(patch, 8);
    for (uint32_t level = 0; level < 3; ++level) {
        gtx_grid grid;
        assert_int_equal(gtx_grid_build(asset, 0, level, hooks(), &grid, NULL), GTX_OK);
        const uint32_t wide = gtx_blocks_of(grid.nodes_x - 1);
        gtx_box *boxes = calloc(wide * gtx_blocks_of(grid.nodes_y - 1), sizeof *boxes);
        gtx_grid_boxes(asset, 0, &grid, boxes);
        long cells = 0;
        for (uint32_t j = 0; j + 1 < grid.nodes_y; ++j)
            for (uint32_t i = 0; i + 1 < grid.nodes_x; ++i) {
                const gtx_box *box = &boxes[j / GTX_BLOCK * wide + i / GTX_BLOCK];
                if (!grid.solid[j * (grid.nodes_x - 1) + i])
                    continue;
                ++cells;
                const double x = fmin((i + 1) << level, patch->rect[2] - 1);
                const double y = fmin((j + 1) << level, patch->rect[3] - 1);
                const double z = grid.code[(j + 1) * grid.nodes_x + i + 1];
                for (int k = 0; k < 3; ++k) {
                    const double p = f.origin[k] + x * f.axis[0][k] + y * f.axis[1][k] +
                                     z * f.axis[2][k];
                    assert_true(p >= box->low[k] && p <= box->high[k]);
                }
            }
        assert_true(cells > 20);
        free(boxes);
        gtx_grid_free(&grid, hooks());
    }
    gtx_close(asset);
}

static void placements_invert(void **state)
{
    (void)state;
    const float turned[16] = {0, 2, 0, 0, -3, 0, 1, 0, 0.5f, 0, 1, 0, 7, -8, 9, 1};
    gtx_placement p;
    assert_true(gtx_placement_of(turned, &p));
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) {
            double sum = c == 3 ? p.object[r][3] : 0;
            for (int k = 0; k < 3; ++k)
                sum += p.object[r][k] * p.world[k][c];
            assert_float_equal(sum, r == c, 1e-12);
        }
    assert_true(p.stretch >= sqrt(10) && p.stretch < 4);
    const gtx_box unit = {{-1, -1, -1}, {1, 1, 1}}, none = gtx_box_empty;
    const gtx_box box = gtx_placement_box(&p, &unit), still_none = gtx_placement_box(&p, &none);
    assert_float_equal(box.low[0], 7 - 3.5, 1e-4);
    assert_float_equal(box.high[2], 9 + 2, 1e-4);
    assert_true(still_none.low[0] > still_none.high[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_boxes),
        cmocka_unit_test(blocks_hold_their_cells),
        cmocka_unit_test(placements_invert),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
