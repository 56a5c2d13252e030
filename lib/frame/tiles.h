/* Casting by tiles: what one instance has in each tile of 4 x 4 pixels. */
#ifndef GTX_FRAME_TILES_H
#define GTX_FRAME_TILES_H

#include "frame/plan.h"
#include "frame/scratch.h"

/* What shaders read are the parts of one stream: records of patches, slabs, heads of the lists, and
 * the lists. */
typedef struct gtx_tiles {
    uint32_t max_texels;      /* of a stream; 0: nothing is cast by tiles */
    gtx_scratch visible, order, heads, records, slabs, lists, corners;
    uint32_t visible_count, tile_count, corner_count;
    uint32_t first_column, first_row, columns, rows; /* the rectangle of tiles that have heads */
    uint32_t record_texels, slab_texels, head_texels, list_texels;
    float place[GTX_TILE_ROWS][4];
    uint64_t draws;           /* by tiles, so far: tests look whether there were any */
} gtx_tiles;

/* Texels that streams may have where a buffer has so many. */
uint32_t gtx_tiles_most(uint32_t texels);

/* tiles.c: fills the planner's tiles from its plan. False when there is no memory for it, or it is
 * more than a stream takes or pays. */
bool gtx_tiles_fill(const gtx_draw_call *draw, const gtx_model *model,
                    const gtx_instance_data *placed);

/* Whether what the view casts is cast by tiles. */
bool gtx_tiles_suit(const gtx_draw_call *draw);
void gtx_tiles_free(gtx_tiles *tiles, const gtx_allocator *allocator);

#endif
