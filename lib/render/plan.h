/* What each instance is drawn by, and which proxy each of its patches is cast by. */
#ifndef GTX_RENDER_PLAN_H
#define GTX_RENDER_PLAN_H

#include "render/model.h"
#include "render/view.h"

typedef struct gtx_plan_entry {
    float distance;           /* how far behind the near plane, of a hull; negative: a box */
    uint32_t slot;            /* of the proxy */
    uint32_t patch, level;
} gtx_plan_entry;

/* What is drawn of one instance that is cast, as glMultiDrawElements takes it: first the boxes of
 * patches that the near plane cuts, level by level, then the hulls of others, nearest first. */
typedef struct gtx_plan {
    uint32_t capacity, count;
    uint32_t box_count[GTX_MAX_MIPS], hull_count; /* boxes by the level that is cast */
    gl_size *counts;
    const void **offsets;     /* into the buffer of indices */
    gtx_plan_entry *entries;
} gtx_plan;

/* choose.c: what a model's instance is drawn by: 0 for casting, or one more than the level of the
 * LOD mesh. Errors: UNSUPPORTED (the view wants an LOD mesh and there is none). */
gtx_result gtx_choose_lod(const gtx_draw_call *draw, const gtx_model *model,
                          const gtx_instance_data *placed, uint8_t *lod, gtx_error *error);

/* plan.c: makes room for plans of so many patches. Errors: MEMORY. */
gtx_result gtx_plan_reserve(gtx_renderer *renderer, uint32_t patches, gtx_error *error);
void gtx_plan_free(gtx_renderer *renderer);
/* The kind of proxy that all patches of an instance have, if that is seen without looking at each,
 * or 0. */
uint32_t gtx_plan_whole(const gtx_draw_call *draw, const gtx_model *model,
                        const gtx_instance_data *placed);
/* Fills the renderer's plan: each patch in view, or each that is edited. */
void gtx_plan_patches(const gtx_draw_call *draw, const gtx_model *model,
                      const gtx_instance_data *placed, bool edited_only);

#endif
