/* Internal to hulls: their state while they are built. */
#ifndef GTX_DERIVE_HULL_H
#define GTX_DERIVE_HULL_H

#include "derive/moments.h"

#include <stdbool.h>

/* A corner of blocks. */
typedef struct gtx_hull_node {
    float x, y, z;            /* a point near the height field */
    float away[2];            /* from the blocks, where they end */
    float up, down;           /* how far lid and floor are from the point */
    uint32_t top, bottom;     /* vertices, or GTX_HULL_NONE */
} gtx_hull_node;

#define GTX_HULL_NONE UINT32_MAX

typedef struct gtx_hull_triangle {
    uint32_t node[3];         /* counter-clockwise from above */
} gtx_hull_triangle;

/* A triangle's edge where nothing is beside. */
typedef struct gtx_hull_edge {
    uint32_t node[2];         /* the triangle is on the left */
    uint32_t block[2];        /* that the triangle is in */
} gtx_hull_edge;

typedef struct gtx_hull {
    const gtx_grid *grid;
    uint32_t last[2];         /* texel of the patch */
    bool two_sided;
    float grow;
    uint32_t low[2], high[2]; /* extent of the solid cells */
    uint32_t blocks[2];       /* how many */
    size_t block_count, node_count, triangle_count, edge_count;
    uint8_t *block;           /* of each, what hull.c has of its triangles; 0 where none is */
    gtx_moments *sums;        /* a block each */
    gtx_hull_node *nodes;     /* blocks[0] + 1 a row */
    gtx_hull_triangle *triangles;
    gtx_hull_edge *edges;     /* the outline */
    float *columns;           /* texels of the level's nodes */
    float *codes;             /* of its nodes, NaN where no solid cell has a corner */
    float highest, lowest;    /* of the height field against the planes of the triangles */
} gtx_hull;

/* First cell of block column or row i. */
static inline uint32_t gtx_hull_line(const gtx_hull *h, int axis, uint32_t i)
{
    const uint32_t span = h->high[axis] - h->low[axis];
    return h->low[axis] + (uint32_t)((uint64_t)i * span / h->blocks[axis]);
}

/* Texel of a node of the level. */
static inline float gtx_hull_texel(const gtx_hull *h, int axis, uint32_t i)
{
    const uint32_t at = i << h->grid->level;
    return (float)(at < h->last[axis] ? at : h->last[axis]);
}

static inline uint8_t gtx_hull_block(const gtx_hull *h, int64_t bi, int64_t bj)
{
    const bool inside = bi >= 0 && bj >= 0 && bi < h->blocks[0] && bj < h->blocks[1];
    return inside ? h->block[(size_t)bj * h->blocks[0] + (size_t)bi] : 0;
}

/* As fminf and fmaxf, of numbers, without a call. */
static inline float gtx_lesser(float a, float b)
{
    return a < b ? a : b;
}

static inline float gtx_greater(float a, float b)
{
    return a > b ? a : b;
}

/* hull_fit.c: places nodes near the height field, lifts and sinks lid and floor until they are
 * clear of it, and sinks the walls' feet. Columns and codes are filled. */
void gtx_hull_fit(gtx_hull *h);

#endif
