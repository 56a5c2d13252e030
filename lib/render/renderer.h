/* The inside of renderers. */
#ifndef GTX_RENDER_RENDERER_H
#define GTX_RENDER_RENDERER_H

#include "render/grid.h"
#include "render/plan.h"
#include "render/program.h"
#include "render/tiles.h"
#include "render/view.h"

struct gtx_renderer {
    gtx_allocator allocator;
    gtx_jobs jobs;            /* the host's, or zeros */
    gtx_gl gl;
    void (*log)(const char *message, void *user);
    void *log_user;
    gtx_program programs[TECHNIQUE_COUNT][GTX_PASS_COUNT][MATERIAL_COUNT]; /* 0: not needed yet */
    gl_uint vertex_array, instance_buffer;
    /* Scratch of gtx_draw, an instance each: what is uploaded, whether its winding is turned, and
     * what it is drawn by, as gtx_choose has it. */
    gtx_instance_data *instances;
    bool *mirrored;
    uint8_t *ways;
    uint32_t instance_capacity;
    gtx_plan plan;
    gtx_tiles tiles;
    gtx_grids grids;
    gtx_costs costs;          /* as told, or all 0 */
};

/* Gives the scratch back. */
void gtx_renderer_free_scratch(gtx_renderer *renderer);

#endif
