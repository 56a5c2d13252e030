/* What loading derives from an asset by the normative rules of format/gtx.md: level-of-detail
 * grids, min-max bounds, corner cells and proxies. No GL, no files. */
#ifndef GTX_DERIVE_DERIVE_H
#define GTX_DERIVE_DERIVE_H

#include "asset/asset.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One level of a patch's height field: heights alone, as codes. (gtx_height_field adds what a ray
 * needs, gtx_field_span is one whose points move.) Level k has nodes (i, j) at texels
 * (min(i << k, w - 1), min(j << k, h - 1)), and codes by the rule of format/gtx.md, section 5. A
 * cell (i, j) lies between 2x2 nodes and exists where `solid` is 1. */
typedef struct gtx_grid {
    uint32_t level, nodes_x, nodes_y;  /* cells are one fewer on each axis */
    uint16_t *code;                    /* nodes_x * nodes_y */
    uint8_t *solid;                    /* (nodes_x - 1) * (nodes_y - 1) */
} gtx_grid;

gtx_result gtx_grid_build(const gtx_asset *asset, uint32_t patch, uint32_t level,
                          const gtx_allocator *allocator, gtx_grid *out, gtx_error *error);
/* The same of a patch whose level 0 is there, not trimmed. Errors: ARGUMENT, MEMORY. */
gtx_result gtx_grid_coarsen(const gtx_grid *finest, uint32_t level, const gtx_allocator *allocator,
                            gtx_grid *out, gtx_error *error);
void gtx_grid_free(gtx_grid *grid, const gtx_allocator *allocator);

/* Leaves solid only the cells of which something shows: those with a texel within the level's trim
 * limit (format/gtx.md, sections 4.2 and 5). A ray that meets the others goes on behind them. */
void gtx_grid_trim(const gtx_asset *asset, uint32_t patch, gtx_grid *grid);

/* Corner cells of a level, for kernels that fetch a cell at once: texel (i, j) gets the codes of
 * the nodes (i, j), (i+1, j), (i, j+1), (i+1, j+1), as 4 x uint8_t or 4 x uint16_t; all four are
 * zero where the cell does not exist. `out` is the first of rows of `row_texels` texels. Every
 * level has at most rect[2] >> level by rect[3] >> level cells, so level k of a patch fits its
 * rectangle at mip level k. */
void gtx_grid_cells(const gtx_grid *grid, uint32_t height_bits, size_t row_texels, void *out);

/* The same for kernels that gather: codes as uint8_t or uint16_t, `row_codes` a row. Of level 0 the
 * nodes', 0 where no cell has them as a corner: then a cell between four others may seem to be
 * there that gtx_grid_trim has taken. Of coarser levels 2 x 2 a cell, at (2i, 2j), or zeros. Level
 * k > 0 of a patch fits its rectangle at mip level k - 1. */
void gtx_grid_codes(const gtx_grid *grid, uint32_t height_bits, size_t row_codes, void *out);

/* How far, in object units, a patch's height field at a level is from that at level 0, `finest`:
 * the largest distance of a texel from the plane that touches the level's height field over it, or
 * what the wider trim limit lets stick out, if that is more. At the border, where a neighbour's
 * height field goes on, a distance counts four times: what is too little to be seen opens a hole
 * there. */
double gtx_grid_error(const gtx_asset *asset, uint32_t patch, const gtx_grid *finest,
                      const gtx_grid *grid);

/* Proxies: triangles around a patch's solid cells, to be rasterised so that rays are cast where
 * they may hit. Front faces point outward in the patch's own space. Coordinates: texels in x and
 * y (texel i at x = i), height codes in z (the surface of code c at z = c). `patch` is the
 * patch's index, and above it 0 for a box or one more than the level that a hull is made for. */
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

/* Adds the box around the solid cells of a patch at level 0, from the lowest code of its texels to
 * the highest, between which all levels lie; grown by `grow` texels and codes. Of a patch without a
 * solid cell it is a point. Errors: ARGUMENT, MEMORY. */
gtx_result gtx_add_box(uint32_t patch, const gtx_grid *finest, float grow,
                       const gtx_allocator *allocator, gtx_proxies *out, gtx_error *error);

enum { GTX_HULL_BLOCK = 16 };          /* cells along the side of a hull's block */

/* Adds a tight hull of the solid cells of a level: over blocks of cells a lid above the height
 * field, and walls where the blocks end, down to below it. Two-sided patches have a floor too, and
 * a closed hull. Every ray from outside that crosses the height field from above, and if it is
 * two-sided from below, passes a front face before. The hull stands off by `grow` codes, and texels
 * at the outline. `*thickness`, in codes, is more than a point in the hull lies above the height
 * field, or below. A height field without a solid cell has no triangle. Errors: ARGUMENT,
 * MEMORY. */
gtx_result gtx_add_hull(const gtx_asset *asset, uint32_t patch, const gtx_grid *grid, float grow,
                        const gtx_allocator *allocator, gtx_proxies *out, float *thickness,
                        gtx_error *error);

/* A slab: low <= (x, y) <= high, and height[0] <= z - slope[0] x - slope[1] y <= height[1], in the
 * coordinates of proxies. Of a block without a solid cell low is above high. `rise` bounds the
 * height field's slopes over those of the slab. Three texels of four floats. */
typedef struct gtx_slab {
    float low[2], high[2], slope[2], height[2], rise_x[2], rise_y[2];
} gtx_slab;

enum { GTX_SLAB_CELLS = 8 };

/* Slabs of a patch's level, one around each block of GTX_SLAB_CELLS^2 cells, in rows. The solid
 * cells are held, and neighbours overlap a little. gtx_slab_count says how many; it goes by the
 * rectangle alone. */
uint32_t gtx_slab_count(const gtx_patch *patch, uint32_t level);
void gtx_grid_slabs(const gtx_patch *patch, const gtx_grid *grid, gtx_slab *out);
/* The codes of level 0, nodes_x * nodes_y from the allocator, and around them as far as a block
 * reaches what continues them. Errors: MEMORY. */
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
