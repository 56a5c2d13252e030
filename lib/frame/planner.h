/* What plans of frames are made in: scratch that lives from frame to frame. */
#ifndef GTX_FRAME_PLANNER_H
#define GTX_FRAME_PLANNER_H

#include "frame/grid.h"
#include "frame/plan.h"
#include "frame/tiles.h"
#include "frame/view.h"

typedef struct gtx_planner {
    gtx_allocator allocator;
    gtx_costs costs;          /* as told, or all 0 */
    /* An instance each: its data for shaders, whether its winding is turned, and what it is drawn
     * by, as gtx_choose has it. */
    gtx_instance_data *instances;
    bool *mirrored;
    uint8_t *ways;
    uint32_t instance_capacity;
    gtx_plan plan;            /* of one instance at a time, and so are tiles and grids */
    gtx_tiles tiles;
    gtx_grids grids;
} gtx_planner;

/* Of zeros, but for what is told. */
void gtx_planner_begin(gtx_planner *planner);
void gtx_planner_end(gtx_planner *planner);
/* Places instances and chooses what each is drawn by. Errors: ARGUMENT, UNSUPPORTED, MEMORY. */
gtx_result gtx_planner_place(const gtx_draw_call *draw, const gtx_instance *instances,
                             uint32_t count, gtx_error *error);

#endif
