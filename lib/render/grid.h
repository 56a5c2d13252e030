/* Height fields drawn as displaced grids: which blocks of their cells are in view, and the draw. */
#ifndef GTX_RENDER_GRID_H
#define GTX_RENDER_GRID_H

#include "render/plan.h"
#include "render/scratch.h"

/* A block of GTX_BLOCK_CELLS^2 cells of level 0, or a part of one, as geotex_lod.vert reads it. */
typedef struct gtx_block {
    uint32_t patch, place;
} gtx_block;

_Static_assert((int)GTX_BLOCK_CELLS == (int)GTX_SLAB_CELLS, "a block of a slab");

/* Drawn alike: by looks, first those seen from the front alone, of either those that show whole,
 * which leave the depth test first; and by pattern, 8, 4, 2 or 1 strides along a side. */
enum {
    GTX_GRID_PATTERNS = 4, GTX_BLOCK_TRIMMED = 1, GTX_BLOCK_TWO_SIDED = 2, GTX_BLOCK_LOOKS = 4,
    GTX_BLOCK_KINDS = GTX_BLOCK_LOOKS * GTX_GRID_PATTERNS
};

typedef struct gtx_grids {
    gl_uint vertex_array, nodes, indices, stream;
    gtx_scratch found, blocks, strides;
    uint32_t counts[GTX_BLOCK_KINDS];
    uint64_t triangles;       /* drawn so far: tests look at them */
} gtx_grids;

static inline uint32_t gtx_pattern_triangles(uint32_t pattern)
{
    const uint32_t side = (uint32_t)GTX_BLOCK_CELLS >> pattern;
    return 2 * side * side;
}

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
