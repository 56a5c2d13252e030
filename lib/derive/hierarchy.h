/* A bounding volume hierarchy, for casting on the CPU and in shaders, and the boxes that it is
 * built over: blocks of a patch's cells. */
#ifndef GTX_DERIVE_HIERARCHY_H
#define GTX_DERIVE_HIERARCHY_H

#include "derive/derive.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Cells on a side of a block: few enough to be walked without a hierarchy of their own. */
enum { GTX_BLOCK_SHIFT = 3, GTX_BLOCK = 1 << GTX_BLOCK_SHIFT };

static inline uint32_t gtx_blocks_of(uint32_t cells)
{
    return (cells + GTX_BLOCK - 1) >> GTX_BLOCK_SHIFT;
}

/* Empty when low[0] > high[0]. */
typedef struct gtx_box {
    float low[3], high[3];
} gtx_box;

extern const gtx_box gtx_box_empty;

/* By a millionth of the coordinates: more than any of them was rounded by. */
void gtx_box_widen(gtx_box *box);

/* The box in object space of each block's solid cells, rounded outwards; rows of
 * gtx_blocks_of(nodes_x - 1), gtx_blocks_of(nodes_y - 1) of them. */
void gtx_grid_boxes(const gtx_asset *asset, uint32_t patch, const gtx_grid *grid, gtx_box *out);

/* Nodes lie depth first: the first child of an inner node follows it, and a walk that leaves a
 * subtree out goes on at its `skip`, so that no stack is needed where the order does not matter. */
typedef struct gtx_node {
    float low[3];
    uint32_t skip;            /* the node behind the subtree */
    float high[3];
    uint32_t link;            /* the second child, or GTX_LEAF + the index of the leaf's box */
} gtx_node;

#define GTX_LEAF 0x80000000u

enum { GTX_HIERARCHY_DEPTH = 64 }; /* of inner nodes, at most */

typedef struct gtx_hierarchy {
    gtx_node *nodes;
    uint32_t node_count, capacity;
} gtx_hierarchy;

/* Over the boxes that are not empty. The same boxes make the same nodes. Errors: MEMORY, LIMIT. */
gtx_result gtx_hierarchy_build(const gtx_box *boxes, uint32_t count,
                               const gtx_allocator *allocator, gtx_hierarchy *out,
                               gtx_error *error);
void gtx_hierarchy_free(gtx_hierarchy *hierarchy, const gtx_allocator *allocator);

#ifdef __cplusplus
}
#endif
#endif
