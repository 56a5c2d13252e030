/* What a page never asks for, and need not wait for: its textures are uncompressed, and no encoder
 * of blocks is linked; WebGL has no buffer textures, by which tiles are cast, nor is anything
 * hidden where nothing is cast so; and what a page has a shading for is drawn by no other program.
 * Built by emscripten alone; see web.mk. */
#include "frame/compress.h"
#include "render/renderer.h"

void gtx_compress_rows(const gtx_asset *asset, const gtx_block_rows *rows)
{
    (void)asset, (void)rows;
}

gtx_result gtx_programs_create(gtx_renderer *renderer, gtx_error *error)
{
    (void)renderer, (void)error;
    return GTX_OK;
}

uint32_t gtx_tiles_most(uint32_t texels)
{
    (void)texels;
    return 0;
}

bool gtx_tiles_fill(const gtx_draw_call *draw, const gtx_model *model,
                    const gtx_instance_data *placed)
{
    (void)draw, (void)model, (void)placed;
    return false;
}

bool gtx_tiles_suit(const gtx_draw_call *draw)
{
    (void)draw;
    return false;
}

void gtx_tiles_free(gtx_tiles *tiles, const gtx_allocator *allocator)
{
    (void)tiles, (void)allocator;
}

void gtx_tile_stream_create(gtx_renderer *renderer)
{
    (void)renderer;
}

void gtx_tile_stream_destroy(gtx_renderer *renderer)
{
    (void)renderer;
}

void gtx_tile_stream_draw(gtx_renderer *renderer, const gtx_program *program,
                          const gtx_frame_draw *draw)
{
    (void)renderer, (void)program, (void)draw;
}

void gtx_occlusion_begin(gtx_occlusion *o, const gtx_draw_call *draw, const gtx_model *model,
                         const gtx_instance_data *placed)
{
    (void)o, (void)draw, (void)model, (void)placed;
}

void gtx_occlusion_end(gtx_occlusion *o)
{
    (void)o;
}

void gtx_occlusion_add(gtx_occlusion *o, const gtx_model *model, uint32_t patch,
                       const gtx_grids *grids, const gtx_grids_state *before,
                       const gtx_allocator *hooks)
{
    (void)o, (void)model, (void)patch, (void)grids, (void)before, (void)hooks;
}

gtx_patch_view gtx_occlusion_view(const gtx_occlusion *o, gtx_record record)
{
    (void)o, (void)record;
    return (gtx_patch_view){0};
}

bool gtx_is_slab_hidden(const gtx_occlusion *o, const gtx_patch_view *view, const gtx_slab *slab)
{
    (void)o, (void)view, (void)slab;
    return false;
}

bool gtx_is_sphere_hidden(const gtx_occlusion *o, const float sphere[3], double radius)
{
    (void)o, (void)sphere, (void)radius;
    return false;
}

void gtx_occlusion_free(gtx_occlusion *o, const gtx_allocator *allocator)
{
    (void)o, (void)allocator;
}
