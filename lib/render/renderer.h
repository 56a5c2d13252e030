/* The inside of renderers. */
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

struct gtx_renderer {
    gtx_allocator allocator;
    gtx_jobs jobs;            /* the host's, or zeros */
    gtx_gl gl;
    void (*log)(const char *message, void *user);
    void *log_user;
    gtx_program programs[TECHNIQUE_COUNT][GTX_PASS_COUNT][MATERIAL_COUNT]; /* 0: not needed yet */
    gl_uint vertex_array, instance_buffer;
    gtx_planner planner;
    /* Ranges of indices, as glMultiDrawElements takes them. */
    gl_size *counts;
    const void **offsets;
    uint32_t range_capacity;
    gtx_tile_stream tile_stream;
    gtx_grid_stream grid_stream;
};

/* Gives the memory of ranges back. */
void gtx_renderer_free_ranges(gtx_renderer *renderer);

/* stream.c: the objects of casting by tiles. Where they cannot be made, nothing is cast so. */
void gtx_tile_stream_create(gtx_renderer *renderer);
void gtx_tile_stream_destroy(gtx_renderer *renderer);
/* Draws what the tiles hold by the program in use. Leaves the tiles' vertex array. */
void gtx_tile_stream_draw(gtx_renderer *renderer, const gtx_program *program,
                          const gtx_instance_data *placed);

/* grid.c: the objects of displaced grids, which all models share. */
void gtx_grid_stream_create(gtx_renderer *renderer);
void gtx_grid_stream_destroy(gtx_renderer *renderer);
/* Uploads the triangles and binds the grids' vertex array. */
void gtx_grid_stream_begin(gtx_renderer *renderer);
/* Draws those of some looks by the program in use; one instance's attributes are set. */
void gtx_grid_stream_draw(gtx_renderer *renderer, uint32_t looks);

#endif
