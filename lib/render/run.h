/* Instances that are drawn together. */
#ifndef GTX_RENDER_RUN_H
#define GTX_RENDER_RUN_H

#include "render/model.h"
#include "render/view.h"

/* Of one model, drawn alike, and of one winding. */
typedef struct gtx_run {
    const gtx_model *model;   /* NULL: nothing */
    uint32_t first, count;
    uint8_t way;              /* as gtx_choose has it */
    bool mirrored;
} gtx_run;

/* Draws a run whose data is in the instance buffer. */
void gtx_run_draw(gtx_draw_call *draw, const gtx_run *r);

#endif
