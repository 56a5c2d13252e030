/* Height fields drawn as displaced grids: which blocks of their cells are in view, and the draw. */
#ifndef GTX_RENDER_GRID_H
#define GTX_RENDER_GRID_H

#include "render/plan.h"
#include "render/scratch.h"

/* A block of GTX_SLAB_CELLS^2 cells, as geotex_lod.vert reads it. */
typedef struct gtx_block {
    uint32_t patch;           /* + 2^28 * level */
    uint32_t cell;            /* its first one, x + 2^16 y */
} gtx_block;

enum { GTX_BLOCK_TRIANGLES = GTX_SLAB_CELLS * GTX_SLAB_CELLS * 2 };

/* Drawn alike, in this order: first those seen from the front alone, of either those that show
 * whole, which leave the depth test first. */
enum { GTX_BLOCK_TRIMMED = 1, GTX_BLOCK_TWO_SIDED = 2, GTX_BLOCK_KINDS = 4 };

typedef struct gtx_grids {
    gl_uint vertex_array, nodes, indices, stream;
    gtx_scratch found, blocks;
    uint32_t counts[GTX_BLOCK_KINDS];
    uint64_t triangles;       /* drawn so far: tests look at them */
} gtx_grids;

/* blocks.c: takes those patches out of the renderer's plan that are drawn so, and fills its blocks
 * with theirs: those in view that may face the eye, in the order of the plan. Without memory for
 * that it leaves all to be cast, and is false. */
bool gtx_blocks_fill(const gtx_draw_call *draw, const gtx_model *model,
                     const gtx_instance_data *placed);

/* grid.c: the objects that all models share. */
void gtx_grids_create(gtx_renderer *renderer);
void gtx_grids_destroy(gtx_renderer *renderer);
/* Uploads the blocks and binds the grids' vertex array. */
void gtx_grids_begin(gtx_renderer *renderer);
/* Draws a kind of the blocks by the program in use; one instance's attributes are set. */
void gtx_grids_draw(gtx_renderer *renderer, uint32_t kind);

#endif
