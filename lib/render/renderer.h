/* gtx_renderer: its programs, and the buffers and textures through which frames are streamed. */
#ifndef GTX_RENDER_RENDERER_H
#define GTX_RENDER_RENDERER_H

#include "frame/planner.h"
#include "render/program.h"

/* What tiles and displaced grids are sent through. */
typedef struct gtx_tile_stream {
    gl_uint vertex_array, corner_buffer, buffer, texture;
} gtx_tile_stream;

typedef struct gtx_grid_stream {
    gl_uint vertex_array, vertex_buffer, index_buffer;
} gtx_grid_stream;

/* What blocks are displaced from: the triangles of any, and which ones. */
typedef struct gtx_block_stream {
    gl_uint vertex_array, index_buffer, buffer;
} gtx_block_stream;

struct gtx_renderer {
    gtx_allocator allocator;
    gtx_jobs jobs;            /* the host's, or zeros */
    gtx_gl gl;
    bool compress;
    void (*log)(const char *message, void *user);
    void *log_user;
    gtx_program programs[GTX_PIPELINE_COUNT]; /* 0: not needed yet */
    gl_uint vertex_array, instance_buffer, picked_buffer;
    gtx_planner planner;
    uint32_t lacking;         /* of the shading of the last draw, what is still to be compiled */
    gtx_tile_stream tile_stream;
    gtx_grid_stream grid_stream;
    gtx_block_stream block_stream;
};

/* stream.c: the objects of casting by tiles. Where they cannot be made, nothing is cast so. */
void gtx_tile_stream_create(gtx_renderer *renderer);
void gtx_tile_stream_destroy(gtx_renderer *renderer);
/* Uploads what a draw brings along and draws it by the program in use. */
void gtx_tile_stream_draw(gtx_renderer *renderer, const gtx_program *program,
                          const gtx_frame_draw *draw);

/* blocks.c: the objects of blocks that the GPU displaces, made when they are first drawn. Uploads
 * what a draw brings along and binds their vertex array. */
void gtx_block_stream_begin(gtx_renderer *renderer, const gtx_frame_draw *draw);
void gtx_block_stream_destroy(gtx_renderer *renderer);

/* grid.c: the objects of displaced grids, which all models share. */
void gtx_grid_stream_create(gtx_renderer *renderer);
void gtx_grid_stream_destroy(gtx_renderer *renderer);
/* Uploads what a draw brings along and binds the grids' vertex array. */
void gtx_grid_stream_begin(gtx_renderer *renderer, const gtx_frame_draw *draw);

#endif
