/* gtx_planner, for the files that plan a frame: what it keeps from one frame to the next. */
#ifndef GTX_FRAME_PLANNER_H
#define GTX_FRAME_PLANNER_H

#include "frame/grid.h"
#include "frame/occlusion.h"
#include "frame/plan.h"
#include "frame/tiles.h"
#include "frame/view.h"

struct gtx_planner {
    gtx_allocator allocator;
    gtx_costs costs;          /* as told, or all 0 */
    bool own_main;
    bool own_vertices;        /* the view's shading gives colours at vertices, too */
    bool on_gpu;              /* it displaces blocks, and costs are its, where none were told */
    /* An instance each: its data for shaders, whether its winding is turned, and what it is drawn
     * by, as gtx_choose has it. */
    gtx_instance_data *instances;
    bool *mirrored;
    uint8_t *ways;
    uint32_t instance_capacity;
    gtx_plan plan;            /* of one instance at a time, and so are tiles and grids */
    gtx_tiles tiles;
    gtx_grids grids;
    gtx_occlusion occlusion;  /* of them */
    gtx_scratch picked;       /* indices of what faces the eye */
    gtx_draw_call call;       /* the frame begun last */
    gtx_constants constants;  /* of its draws, one at a time */
};

/* Takes allocator and costs, and no memory yet. Errors: ARGUMENT. */
gtx_result gtx_planner_init(gtx_planner *planner, const gtx_allocator *allocator,
                            const gtx_costs *costs, gtx_error *error);
void gtx_planner_free(gtx_planner *planner);

/* facing.c: of a draw of one instance by a level with faces, whose ranges are the plan's, leaves
 * what faces the eye; nothing else without memory. */
void gtx_pick_faces(const gtx_draw_call *call, const gtx_lod_level *level, gtx_frame_draw *draw);

#endif
