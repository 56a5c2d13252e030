/* Right-triangulated irregular networks over height fields (Evans, Kirkpatrick, Townsend,
 * Right-Triangulated Irregular Networks, Algorithmica 30, 2001): triangles that are halved as often
 * as the surface asks for, from two over a block of cells of level 0 to two over a cell. */
#ifndef GTX_DERIVE_RTIN_H
#define GTX_DERIVE_RTIN_H

#include "derive/derive.h"

/* A block's triangles form two binary trees: 2 and 3 are the roots, 2 t and 2 t + 1 the halves of
 * t, and those from GTX_RTIN_LEAF on are not halved. */
enum {
    GTX_RTIN_CELLS = GTX_SLAB_CELLS, GTX_RTIN_LEVELS = 6, GTX_RTIN_LEAF = 2 << GTX_RTIN_LEVELS,
    GTX_RTIN_TRIANGLES = 2 * GTX_RTIN_LEAF
};

/* A triangle of a block, seen from above the height field counterclockwise: the last corner is the
 * right angle, and `middle`, of the longest side, is where a half ends. In cells of the block. */
typedef struct gtx_rtin_triangle {
    uint8_t corner[3][2], middle[2];
    uint16_t parts;           /* those of the block that it lies over, as gtx_rtin_block has them */
} gtx_rtin_triangle;

/* Fills in all but the first two. */
void gtx_rtin_triangles(gtx_rtin_triangle out[GTX_RTIN_TRIANGLES]);

/* The level of a triangle's middle: 0 for roots, GTX_RTIN_LEVELS for leaves, which have none. */
static inline uint32_t gtx_rtin_level(uint32_t triangle)
{
    uint32_t level = 0;
    while (triangle >> (level + 2))
        ++level;
    return level;
}

/* A node of the blocks; beyond the grid it repeats the last one. The error is 0 where blocks begin,
 * and else what the triangles are off by that it is the middle of, and all that come of halving
 * them: never less than that of a node that a half of them has for a middle. They are rough where
 * maps at their corners do not make those over them; then so is a node whose halves' middle it
 * is. */
typedef struct gtx_rtin_node {
    uint16_t code, bits;      /* bits: the error, and those below */
} gtx_rtin_node;

/* SOLID: the cell from the node on exists; WITHIN: the trim lets the node show. */
enum {
    GTX_RTIN_ROUGH = 0x8000, GTX_RTIN_SOLID = 0x4000, GTX_RTIN_WITHIN = 0x2000,
    GTX_RTIN_MAX_ERROR = 0x1fff, GTX_RTIN_ERRORS = 14
};

/* What shows of a block: its 4x4 parts of 2x2 cells, in rows. */
typedef struct gtx_rtin_block {
    uint16_t some, whole;     /* a cell of it shows; all its cells exist and show all over */
} gtx_rtin_block;

/* A patch's network. A triangle's middle is to be halved where its error is more than is allowed:
 * if that is never more at a middle than at those of the halves, as it is where it is a linear
 * function of place less reach, the triangles fit together without a crack. Leaves are halves of
 * cells; where the surface bends away from them they are divided when they are drawn. */
typedef struct gtx_rtin {
    uint32_t columns, rows;   /* blocks */
    uint32_t halved[GTX_RTIN_ERRORS]; /* nodes of an error of 2^k and more that the trim
                                         lets show, about */
    float unit;               /* of errors, in object units */
    uint16_t rise[GTX_RTIN_LEVELS]; /* codes from a middle of the level to those of the halves, at
                                       most, where they have an error; of the last level from the
                                       middles of cells to their corners */
    float twist;              /* the most that a cell's surface is off two triangles, in codes */
    float code;               /* what a code is square to the surface, at most: object units */
    bool glossy;              /* light at corners does not tell of its highlights */
} gtx_rtin;

static inline uint32_t gtx_rtin_row(const gtx_rtin *r)
{
    return r->columns * GTX_RTIN_CELLS + 1;
}

/* Nodes that the network of a patch has, in rows, and its blocks: by the rectangle alone. */
size_t gtx_rtin_nodes(const gtx_patch *patch);

/* What a network is made of: a patch's level 0, trimmed, `filled` by gtx_grid_fill before, and its
 * slabs, of gtx_grid_slabs. */
typedef struct gtx_rtin_source {
    const gtx_asset *asset;
    uint32_t patch;
    const gtx_grid *finest;
    const uint16_t *filled;
    const gtx_slab *slabs;
} gtx_rtin_source;

/* Errors at outlines, where neighbours meet, count GTX_BORDER_COUNTS times. `nodes` has room for
 * gtx_rtin_nodes, `blocks` for gtx_slab_count. Errors: MEMORY. */
gtx_result gtx_rtin_build(const gtx_rtin_source *source, const gtx_allocator *allocator,
                          gtx_rtin *out, gtx_rtin_node *nodes, gtx_rtin_block *blocks,
                          gtx_error *error);

/* How far the surface of the cell from a node on is from two triangles, in fourths of a code: in
 * its middle, wherever its diagonal is (`row`: nodes a row). */
static inline uint32_t gtx_rtin_twist(const gtx_rtin_node *node, size_t row)
{
    const int32_t twist = node[0].code - node[1].code - node[row].code + node[row + 1].code;
    return (uint32_t)(twist < 0 ? -twist : twist);
}

/* twist.c: finds the most of that, and adds it to the `error` of the nodes at which halves of cells
 * have their right angles, so that both halves of a cell are there where it is divided. */
void gtx_rtin_add_twist(const gtx_grid *finest, gtx_rtin *rtin, const gtx_rtin_node *nodes,
                        float *error);

/* marks.c: what nodes tell besides their errors, how many there are of these, and whether the patch
 * is glossy. `scratch` has room for a number a node. */
void gtx_rtin_mark(const gtx_rtin_source *source, gtx_rtin *rtin, gtx_rtin_node *nodes,
                   float *scratch);

#endif
