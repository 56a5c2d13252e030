/* The boundary of the triangles that came so far, along which LOD meshes are put in order and coded
 * (format/gtx.md, section 6.1). */
#ifndef GTX_ASSET_BOUNDARY_H
#define GTX_ASSET_BOUNDARY_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GTX_LATEST_EDGES 16u
#define GTX_NO_NEIGHBOUR 0xffffffu  /* of a vertex that is not on the boundary */

/* Bytes of the links of so many vertices. */
#define GTX_LINK_BYTES(vertices) (6 * (size_t)(vertices))

/* An edge as a triangle sees it that joins it, and the corner across it. */
typedef struct gtx_boundary_edge {
    uint32_t from, to, across;
} gtx_boundary_edge;

typedef struct gtx_boundary {
    uint8_t *links;        /* of a vertex, 3 bytes each: the one after it, the one before it */
    uint32_t vertices;     /* below GTX_NO_NEIGHBOUR */
    uint32_t count;        /* of the latest edges that are open, GTX_LATEST_EDGES at most */
    uint32_t end;          /* behind the newest; there is room for more, so that few are moved */
    gtx_boundary_edge edges[4 * GTX_LATEST_EDGES];
} gtx_boundary;

/* The latest edges by their age, from 0 for the newest to count - 1. */
static inline const gtx_boundary_edge *gtx_boundary_latest(const gtx_boundary *b, uint32_t age)
{
    return &b->edges[b->end - 1 - age];
}

/* `links` are the caller's, GTX_LINK_BYTES of them, with any content. */
void gtx_boundary_begin(gtx_boundary *b, uint8_t *links, uint32_t vertices);

/* Neighbours along the boundary, which runs as the edges of triangles that join it; where several
 * parts of it meet, those of the latest. None where there is no such vertex. */
uint32_t gtx_boundary_after(const gtx_boundary *b, uint32_t vertex);
uint32_t gtx_boundary_before(const gtx_boundary *b, uint32_t vertex);

/* Adds a triangle: its edges close those of the boundary that they meet, and else are new ones. One
 * that has joined an edge of the latest meets it by its first. Corners may be any numbers. */
void gtx_boundary_add(gtx_boundary *b, const uint32_t corner[3], bool joined);

#ifdef __cplusplus
}
#endif
#endif
