/* Which technique draws what of a frame. */
#include "frame/techniques.h"

gtx_material_kind gtx_material_of(const gtx_model *model)
{
    if (model->emission_scale > 0)
        return MATERIAL_MAPS;
    if (model->has_material)
        return model->has_constant_material ? MATERIAL_CONSTANT : MATERIAL_MAPS;
    return model->has_color ? MATERIAL_COLORS : MATERIAL_NONE;
}

bool gtx_is_own(const gtx_draw_call *call)
{
    return call->view->pass == GTX_PASS_FORWARD && (call->view->shading || call->planner->own_main);
}

bool gtx_is_lit(const gtx_draw_call *call, const gtx_model *model, uint32_t level)
{
    return call->view->pass == GTX_PASS_FORWARD && model->lods.levels[level].lit &&
           gtx_material_of(model) == MATERIAL_NONE;
}

gtx_technique gtx_cast_technique(const gtx_draw_call *call, bool box)
{
    return gtx_is_own(call)                          ? TECHNIQUE_OWN_CAST
           : call->view->method == GTX_METHOD_PAPER ? TECHNIQUE_PAPER
           : box                                     ? TECHNIQUE_BOX
                                                     : TECHNIQUE_CAST;
}

gtx_technique gtx_lod_technique(const gtx_draw_call *call, const gtx_model *model, uint32_t level,
                                bool front)
{
    const bool lit = gtx_is_lit(call, model, level);
    if (gtx_is_own(call) && lit)
        return front && call->planner->own_vertices ? TECHNIQUE_OWN_LOD_LIT
                                                    : TECHNIQUE_OWN_LOD_NORMALS;
    if (gtx_is_own(call))
        return TECHNIQUE_OWN_LOD;
    return lit ? TECHNIQUE_LOD_LIT : front ? TECHNIQUE_LOD_FRONT : TECHNIQUE_LOD;
}

gtx_technique gtx_grid_technique(const gtx_draw_call *call, const gtx_model *model, uint32_t looks,
                                 bool keeps_angles)
{
    static const gtx_technique techniques[2][2] = {
        {TECHNIQUE_GRID_WHOLE, TECHNIQUE_GRID_WHOLE_FRONT},
        {TECHNIQUE_GRID, TECHNIQUE_GRID_FRONT}};
    const bool forward = call->view->pass == GTX_PASS_FORWARD, whole = !(looks & GTX_GRID_TRIMMED);
    const bool front = forward && keeps_angles && !(looks & GTX_GRID_BEHIND);
    const bool lit = forward && !(looks & GTX_GRID_MAPPED);
    const gtx_material_kind material = gtx_material_of(model);
    const bool albedo_alone = material == MATERIAL_NONE || material == MATERIAL_COLORS;
    if (gtx_is_own(call) && lit && call->planner->own_vertices && albedo_alone)
        return whole ? TECHNIQUE_OWN_GRID_WHOLE_LIT : TECHNIQUE_OWN_GRID_LIT;
    if (gtx_is_own(call))
        return lit && whole ? TECHNIQUE_OWN_GRID_NORMALS : TECHNIQUE_OWN_GRID;
    if (lit)
        return whole ? TECHNIQUE_GRID_WHOLE_LIT : TECHNIQUE_GRID_LIT;
    return techniques[!whole][front];
}

gtx_technique gtx_block_technique(const gtx_draw_call *call, uint32_t looks, bool keeps_angles)
{
    static const gtx_technique techniques[2][2] = {
        {TECHNIQUE_BLOCKS_WHOLE, TECHNIQUE_BLOCKS_WHOLE_FRONT},
        {TECHNIQUE_BLOCKS, TECHNIQUE_BLOCKS_FRONT}};
    const bool front =
        keeps_angles && !(looks & GTX_BLOCKS_TWO_SIDED) && call->view->pass == GTX_PASS_FORWARD;
    return gtx_is_own(call) ? TECHNIQUE_OWN_BLOCKS
                            : techniques[(looks & GTX_BLOCKS_TRIMMED) != 0][front];
}
