/* Which technique draws what of a frame. */
#ifndef GTX_FRAME_TECHNIQUES_H
#define GTX_FRAME_TECHNIQUES_H

#include "frame/pipelines.h"
#include "frame/planner.h"

gtx_material_kind gtx_material_of(const gtx_model *model);
/* Whether an engine's own main shades. */
bool gtx_is_own(const gtx_draw_call *call);
/* Whether normals at the vertices of a level of the LOD mesh are enough: both sides of it are drawn
 * in one pass. */
bool gtx_is_lit(const gtx_draw_call *call, const gtx_model *model, uint32_t level);

gtx_technique gtx_cast_technique(const gtx_draw_call *call, bool box);
/* `front`: front faces alone, under transforms that keep angles; with an engine's own main those of
 * one instance. */
gtx_technique gtx_lod_technique(const gtx_draw_call *call, const gtx_model *model, uint32_t level,
                                bool front);
/* `looks` of GTX_GRID_..., and of GTX_BLOCKS_.... */
gtx_technique gtx_grid_technique(const gtx_draw_call *call, const gtx_model *model, uint32_t looks,
                                 bool keeps_angles);
gtx_technique gtx_block_technique(const gtx_draw_call *call, uint32_t looks, bool keeps_angles);

#endif
