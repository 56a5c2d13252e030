/* What each instance is drawn by, and which proxy each of its patches is cast by. */
#ifndef GTX_FRAME_PLAN_H
#define GTX_FRAME_PLAN_H

#include "frame/model.h"
#include "frame/order.h"
#include "frame/view.h"

/* How a patch in view is drawn. From GTX_BY_LOD on: by level n - GTX_BY_LOD of the LOD mesh. */
enum { GTX_OUT_OF_VIEW, GTX_BY_HEIGHT_FIELD, GTX_BY_LOD };

/* A patch that is drawn by its height field. */
typedef struct gtx_plan_entry {
    float distance;           /* how far behind the near plane; negative: it is cut, and cast by
                                 its box */
    uint32_t patch, level;
} gtx_plan_entry;

/* What is drawn of one instance. Entries are in the order of their distance: displaced grids are
 * taken out of them, and the others cast by ranges of the proxies' indices: first the boxes, level
 * by level, then the hulls. */
typedef struct gtx_plan {
    uint32_t capacity, count;
    gtx_plan_entry *entries, *found; /* found: room to sort them */
    gtx_rank *ranks;          /* two a patch, likewise */
    uint8_t *ways, *parts;    /* of each patch: how it is drawn, and what of it by one LOD mesh */
    bool any_lod;
    uint32_t box_count[GTX_MAX_MIPS], hull_count; /* boxes by the level that is cast */
    gtx_range *ranges;        /* two a patch: so many has a level of the LOD mesh at most */
} gtx_plan;

/* How an instance is drawn: patch by patch, each in its own way; by an LOD mesh, level n - 1; or
 * cast. */
enum { GTX_DRAW_PATCHES = 0, GTX_DRAW_CAST = 255 };

/* choose.c: how an instance is drawn. Errors: UNSUPPORTED (the view wants an LOD mesh and there is
 * none). */
gtx_result gtx_choose(const gtx_draw_call *draw, const gtx_model *model,
                      const gtx_instance_data *placed, uint8_t *out, gtx_error *error);
/* choose.c: the error that an instance is allowed at its nearest point, in object units. */
double gtx_allowed_anywhere(const gtx_draw_call *draw, const gtx_model *model,
                            const gtx_instance_data *placed);
/* choose.c: how many levels of the LOD mesh, the finest first, are never drawn, for casting is
 * thought to take less at a size between those where it and the next are just fine enough. */
uint32_t gtx_levels_cast(const gtx_draw_call *draw, const gtx_model *model);
/* choose.c: how many levels, the finest first, an instance may be drawn by: where the last of them
 * is lit at its vertices, coarser ones within the error are thought to take more. */
uint32_t gtx_levels_worth(const gtx_draw_call *draw, const gtx_model *model,
                          const gtx_instance_data *placed);
/* choose.c: what displaced grids of so many triangles are thought to take, over so many pixels; the
 * same where the GPU displaces them; and casting so many patches. */
double gtx_grid_cost(const gtx_draw_call *draw, uint32_t triangles, double pixels);
double gtx_displaced_cost(const gtx_draw_call *draw, uint32_t triangles, double pixels);
double gtx_cast_cost(const gtx_draw_call *draw, uint32_t patches, double pixels);

/* plan.c: makes room for plans of so many patches. Errors: MEMORY. */
gtx_result gtx_plan_reserve(gtx_planner *planner, uint32_t patches, gtx_error *error);
void gtx_plan_free(gtx_planner *planner);
/* The kind of proxy that all patches of an instance get, if its bounds alone tell, or 0. */
uint32_t gtx_plan_whole(const gtx_draw_call *draw, const gtx_model *model,
                        const gtx_instance_data *placed);
/* Whether no two-sided patch has too many triangles of the level to be drawn by them. */
bool gtx_plan_suits_whole(const gtx_draw_call *draw, const gtx_model *model, uint32_t level);
/* Fills the planner's plan: each patch in view, by the coarsest of the first `levels` of the LOD
 * mesh that is good enough where it is, or by its height field; of those that are edited, the
 * latter. */
void gtx_plan_patches(const gtx_draw_call *draw, const gtx_model *model,
                      const gtx_instance_data *placed, uint32_t levels, bool edited_only);
/* The ranges of the entries that are left. */
void gtx_plan_proxies(gtx_plan *plan, const gtx_model *model);
/* What a level of the LOD mesh draws: its patches, and the borders of those beside them that are
 * drawn finer, so that both overlap. False when that is nothing. */
bool gtx_plan_parts(gtx_plan *plan, const gtx_lod_meshes *lods, uint32_t level);

#endif
