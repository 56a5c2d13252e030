/* Instances that are drawn together. */
#ifndef GTX_RENDER_RUN_H
#define GTX_RENDER_RUN_H

#include "frame/lod.h"
#include "frame/model.h"
#include "render/renderer.h"

/* Of one model, drawn alike, and of one winding. */
typedef struct gtx_run {
    const gtx_model *model;   /* NULL: nothing */
    uint32_t first, count;
    uint8_t way;              /* as gtx_choose has it */
    bool mirrored;
} gtx_run;

/* One gtx_draw, for its steps. */
typedef struct gtx_submission {
    gtx_draw_call call;
    gtx_renderer *renderer;
    const gtx_program *program; /* in use */
} gtx_submission;

/* Draws a run whose data is in the instance buffer. */
void gtx_run_draw(gtx_submission *draw, const gtx_run *r);

/* lod_draw.c: draws the parts, an array of gtx_lod_part by patch, or with NULL all patches that are
 * not edited; of those seen from one side or from two. Program, textures and the attributes of
 * instances are set, the vertex array is bound. `instances` is 0 for a program that takes the
 * transform of a single one as a uniform. Sets attributes 0 and 1 and binds the indices. */
void gtx_lod_draw(const gtx_gl *gl, const gtx_lod_meshes *lods, uint32_t level, bool two_sided,
                  uint32_t instances, const uint8_t *parts);

#endif
