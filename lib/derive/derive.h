/* What loading derives from an asset by the normative rules of format/gtx.md: level-of-detail
 * grids, min-max bounds, corner cells and proxies. No GL, no files. */
#ifndef GTX_DERIVE_DERIVE_H
#define GTX_DERIVE_DERIVE_H

#include "asset/asset.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One level of a patch's height field, as height codes. (gtx_height_field adds what casting needs;
 * gtx_field_span is a height field that is being edited.) Level k has nodes (i, j) at texels
 * (min(i << k, w - 1), min(j << k, h - 1)), and codes by the rule of format/gtx.md, section 5. A
 * cell (i, j) lies between 2x2 nodes and exists where `solid` is 1. */
typedef struct gtx_grid {
    uint32_t level, nodes_x, nodes_y;  /* cells are one fewer on each axis */
    uint16_t *code;                    /* nodes_x * nodes_y */
    uint8_t *solid;                    /* (nodes_x - 1) * (nodes_y - 1) */
} gtx_grid;

gtx_result gtx_grid_build(const gtx_asset *asset, uint32_t patch, uint32_t level,
                          const gtx_allocator *allocator, gtx_grid *out, gtx_error *error);
/* The same from level 0 of the patch, untrimmed. Errors: ARGUMENT, MEMORY. */
gtx_result gtx_grid_coarsen(const gtx_grid *finest, uint32_t level, const gtx_allocator *allocator,
                            gtx_grid *out, gtx_error *error);
void gtx_grid_free(gtx_grid *grid, const gtx_allocator *allocator);

/* Leaves solid only the cells that have a texel within the level's trim limit (format/gtx.md,
 * sections 4.2 and 5). Rays pass through the others. */
void gtx_grid_trim(const gtx_asset *asset, uint32_t patch, gtx_grid *grid);

/* Corner cells of a level, for shaders that fetch a whole cell: texel (i, j) gets the codes of
 * the nodes (i, j), (i+1, j), (i, j+1), (i+1, j+1), as 4 x uint8_t or 4 x uint16_t; all four are
 * zero where the cell does not exist. `out` is the first of rows of `row_texels` texels. Every
 * level has at most rect[2] >> level by rect[3] >> level cells, so level k of a patch fits its
 * rectangle at mip level k. */
void gtx_grid_cells(const gtx_grid *grid, uint32_t height_bits, size_t row_texels, void *out);

/* The same for shaders that gather: codes as uint8_t or uint16_t, `row_codes` per row. Level 0 has
 * a code per node, 0 if the node is a corner of no cell; so a cell that gtx_grid_trim removed
 * between four others still seems to exist. Coarser levels have 2 x 2 codes per cell at (2i, 2j),
 * or zeros. Level k > 0 of a patch fits its rectangle at mip level k - 1. */
void gtx_grid_codes(const gtx_grid *grid, uint32_t height_bits, size_t row_codes, void *out);

/* The distance, in object units, of a level of a patch's height field from level 0, `finest`: the
 * largest distance of a texel from the tangent plane of the level's height field over it, or the
 * width that the level's larger trim limit adds, whichever is more. At the border, where a
 * neighbour's height field continues, distances count four times: there even an invisible distance
 * opens a hole. */
double gtx_grid_error(const gtx_asset *asset, uint32_t patch, const gtx_grid *finest,
                      const gtx_grid *grid);

/* Proxies: triangles around a patch's solid cells, whose fragments cast rays. Front faces point
 * outward in the patch's own space. Coordinates: texels in x and y (texel i at x = i), height codes
 * in z (the surface of code c at z = c). `patch` holds the patch's index in its low bits, and in
 * the bits from GTX_PROXY_KIND_SHIFT 0 for a box, or k + 1 for a hull of level k. */
typedef struct gtx_proxy_vertex {
    float x, y, z;
    uint32_t patch;
} gtx_proxy_vertex;

enum { GTX_PROXY_KIND_SHIFT = 28, GTX_PROXY_PATCH_MASK = (1 << GTX_PROXY_KIND_SHIFT) - 1 };

/* Grows as proxies are added; begins as all zeros. */
typedef struct gtx_proxies {
    gtx_proxy_vertex *vertices;
    uint32_t *indices;                 /* three a triangle */
    uint32_t vertex_count, index_count;
    uint32_t vertex_room, index_room;
} gtx_proxies;

enum { GTX_BOX_VERTICES = 8, GTX_BOX_INDICES = 36 };

/* Adds the box around the solid cells of a patch at level 0, from the lowest to the highest code of
 * its texels, between which all levels lie; enlarged by `grow` texels and codes. A point if the
 * patch has no solid cell. Errors: ARGUMENT, MEMORY. */
gtx_result gtx_add_box(uint32_t patch, const gtx_grid *finest, float grow,
                       const gtx_allocator *allocator, gtx_proxies *out, gtx_error *error);

enum { GTX_HULL_BLOCK = 16 };          /* cells along the side of a hull's block */

/* Adds a tight hull of the solid cells of a level: a lid over blocks of cells, above the height
 * field, and walls at the ends of the blocks, down to below it. Two-sided patches have a floor too,
 * so that the hull is closed. Every ray from outside that hits the height field from above (if it
 * is two-sided, from either side) passes a front face first. The hull keeps a distance of `grow`
 * codes, and texels at the outline. *thickness, in codes, bounds the distance along z between any
 * point in the hull and the height field. Adds nothing for a height field without a solid cell.
 * Errors: ARGUMENT, MEMORY. */
gtx_result gtx_add_hull(const gtx_asset *asset, uint32_t patch, const gtx_grid *grid, float grow,
                        const gtx_allocator *allocator, gtx_proxies *out, float *thickness,
                        gtx_error *error);

/* A slab: low <= (x, y) <= high, and height[0] <= z - slope[0] x - slope[1] y <= height[1], in the
 * coordinates of proxies. If the block has no solid cell, low is above high. rise_x and rise_y
 * bound the height field's slopes relative to the slab's. Three texels of four floats. */
typedef struct gtx_slab {
    float low[2], high[2], slope[2], height[2], rise_x[2], rise_y[2];
} gtx_slab;

enum { GTX_SLAB_CELLS = 8 };

/* Slabs of a level of a patch, one around the solid cells of each block of GTX_SLAB_CELLS^2 cells,
 * row by row. Neighbours overlap a little. gtx_slab_count gives their number, which depends on the
 * rectangle alone. */
uint32_t gtx_slab_count(const gtx_patch *patch, uint32_t level);
void gtx_grid_slabs(const gtx_patch *patch, const gtx_grid *grid, gtx_slab *out);
/* Gives the codes of level 0, nodes_x * nodes_y of them from the allocator, where empty ones within
 * a block of others are extrapolated. Errors: MEMORY. */
gtx_result gtx_grid_fill(const gtx_grid *finest, uint32_t height_bits,
                         const gtx_allocator *allocator, uint16_t **out, gtx_error *error);

/* Makes room for more. Errors: MEMORY. */
gtx_result gtx_proxies_reserve(gtx_proxies *proxies, size_t vertices, size_t indices,
                               const gtx_allocator *allocator, gtx_error *error);
void gtx_proxies_free(gtx_proxies *proxies, const gtx_allocator *allocator);

#ifdef __cplusplus
}
#endif
#endif
