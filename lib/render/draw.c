/* Drawing: a frame is planned, and its draws submitted, with state around them. */
#include "render/submit.h"

#include "base/error.h"
#include "render/state.h"

static gtx_result check_ready(const gtx_instance *instances, uint32_t count, gtx_error *error)
{
    for (uint32_t i = 0; i < count; ++i)
        if (!instances[i].model->ready)
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "the model of instance %u is not uploaded",
                            i);
    return GTX_OK;
}

/* Compiles what the view is the first to need. */
static gtx_result need_programs(gtx_renderer *renderer, const gtx_view *view, gtx_error *error)
{
    const bool paper = view->method == GTX_METHOD_PAPER;
    const bool blocks = renderer->planner.on_gpu && !paper, grids = !blocks && !paper;
    const bool forward = view->pass == GTX_PASS_FORWARD;
    if (forward && view->shading)
        return GTX_OK;
    const bool wanted[TECHNIQUE_COUNT] = {
        [TECHNIQUE_CAST] = !paper,
        [TECHNIQUE_BOX] = !paper,
        [TECHNIQUE_PAPER] = paper,
        [TECHNIQUE_TILES] = gtx_tiles_suit(&renderer->planner.call),
        [TECHNIQUE_LOD] = !paper,
        [TECHNIQUE_LOD_FRONT] = !paper && forward,
        [TECHNIQUE_LOD_LIT] = !paper && forward,
        [TECHNIQUE_GRID] = grids,
        [TECHNIQUE_GRID_WHOLE] = grids,
        [TECHNIQUE_GRID_FRONT] = grids && forward,
        [TECHNIQUE_GRID_WHOLE_FRONT] = grids && forward,
        [TECHNIQUE_GRID_LIT] = grids && forward,
        [TECHNIQUE_GRID_WHOLE_LIT] = grids && forward,
        [TECHNIQUE_BLOCKS] = blocks,
        [TECHNIQUE_BLOCKS_WHOLE] = blocks,
        [TECHNIQUE_BLOCKS_FRONT] = blocks && forward,
        [TECHNIQUE_BLOCKS_WHOLE_FRONT] = blocks && forward,
        [TECHNIQUE_LOD_SINGLE] = !paper && view->pass == GTX_PASS_DEPTH};
    gtx_result result = GTX_OK;
    for (int i = 0; i < TECHNIQUE_COUNT && !result; ++i)
        if (wanted[i])
            result = gtx_programs_need(renderer, (gtx_technique)i, view->pass, error);
    return result;
}

static void begin(const gtx_gl *gl, const gtx_frame *frame, gl_bool color)
{
    for (gl_uint i = 0; i < UNIT_CLEARED; ++i)
        gl->BindSampler(i, 0);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(frame->nearer_is_greater ? GL_GREATER : GL_LESS);
    gl->DepthMask(GL_TRUE);
    gl->CullFace(GL_BACK);
    gl->Disable(GL_BLEND);
    gl->ColorMask(color, color, color, color);
}

gtx_result gtx_draw(gtx_renderer *renderer, const gtx_view *view, const gtx_instance *instances,
                    uint32_t count, gtx_error *error)
{
    gtx_view own;
    gtx_state state;
    gtx_frame frame;
    if (view && view->shading && !gtx_shading_has(view->shading, TECHNIQUE_OWN_TILES)) {
        own = *view;
        own.flags &= ~(uint32_t)GTX_VIEW_SHADING_BY_TILES;
        view = &own;
    }
    if (renderer && view)
        renderer->planner.own_vertices =
            view->shading && gtx_shading_has(view->shading, TECHNIQUE_OWN_LOD_LIT);
    if (renderer)
        renderer->lacking = 0;
    gtx_submission s = {.renderer = renderer, .view = view};
    gtx_result result = gtx_frame_begin(renderer ? &renderer->planner : NULL, view, instances,
                                        count, &frame, error);
    if (!result)
        result = check_ready(instances, count, error);
    if (!result)
        result = need_programs(renderer, view, error);
    if (result)
        return result;

    const gtx_gl *gl = &renderer->gl;
    const bool restore = view->flags & GTX_VIEW_RESTORE_STATE;
    if (restore)
        gtx_state_read(gl, &state);
    if (gl->PushDebugGroup)
        gl->PushDebugGroup(GL_DEBUG_SOURCE_THIRD_PARTY, 0, -1, "geotex draw");
    begin(gl, &frame, view->pass != GTX_PASS_DEPTH);
    gl->BindVertexArray(renderer->vertex_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, renderer->instance_buffer);
    gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)(count * sizeof *frame.instances),
                   frame.instances, GL_STREAM_DRAW);
    gtx_frame_draws(&renderer->planner, gtx_submit_draw, &s);
    if (view->flags & GTX_VIEW_BY_SAMPLES && gl->MinSampleShading)
        gl->Disable(GL_SAMPLE_SHADING);
    if (restore)
        gtx_state_restore(gl, &state);
    else
        gtx_state_leave(gl, frame.nearer_is_greater);
    if (gl->PopDebugGroup)
        gl->PopDebugGroup();
    return GTX_OK;
}
