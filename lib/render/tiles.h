/* Casting by tiles: what one instance has in each tile of 4 x 4 pixels. */
#ifndef GTX_RENDER_TILES_H
#define GTX_RENDER_TILES_H

#include "render/plan.h"
#include "render/scratch.h"

/* What shaders read are the parts of one stream: records of patches, slabs, heads of the lists, and
 * the lists. */
typedef struct gtx_tiles {
    gl_uint vertex_array, corner_buffer, stream_buffer, stream_texture;
    gl_int max_texels;
    gtx_scratch visible, order, heads, records, slabs, lists, corners;
    uint32_t visible_count, tile_count, corner_count;
    uint32_t first_column, first_row, columns, rows; /* the rectangle of tiles that have heads */
    uint32_t record_texels, slab_texels, head_texels, list_texels;
    float place[GTX_PLACE_ROWS][4];
    uint64_t draws;           /* by tiles, so far: tests look whether there were any */
} gtx_tiles;

/* tiles.c: fills the renderer's tiles from its plan. False when there is no memory for it, or it is
 * more than the context takes or pays. */
bool gtx_tiles_fill(const gtx_draw_call *draw, const gtx_model *model,
                    const gtx_instance_data *placed);

/* stream.c. */
void gtx_tiles_free(gtx_renderer *renderer);

/* The objects of casting by tiles. Where they cannot be made, nothing is cast so. */
void gtx_tile_stream_create(gtx_renderer *renderer);
void gtx_tile_stream_destroy(gtx_renderer *renderer);
/* Whether what a view casts is cast by tiles. */
bool gtx_tile_stream_suits(const gtx_renderer *renderer, const gtx_view *view);
/* Draws what the tiles hold by the program in use. Leaves the tiles' vertex array. */
void gtx_tile_stream_draw(const gtx_draw_call *draw, const gtx_instance_data *placed);

#endif
