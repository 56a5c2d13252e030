/* Drawing: what is asked for is checked, each instance placed, and runs of alike ones drawn. */
#include "render/run.h"

#include "base/alloc.h"
#include "base/error.h"
#include "render/renderer.h"
#include "render/state.h"

static gtx_result check(const gtx_renderer *renderer, const gtx_view *view,
                        const gtx_instance *instances, uint32_t count, gtx_error *error)
{
    const uint32_t flags =
        GTX_VIEW_REVERSED_Z | GTX_VIEW_DEPTH_ZERO_TO_ONE | GTX_VIEW_RESTORE_STATE;
    if (!renderer || !view || (count && !instances))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a draw needs a renderer, a view and instances");
    if (view->flags & ~flags || (unsigned)view->method > GTX_METHOD_GRID ||
        (unsigned)view->pass > GTX_PASS_GBUFFER)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the view asks for an unknown flag, method or pass");
    if (view->shading && (view->pass != GTX_PASS_FORWARD || view->method == GTX_METHOD_PAPER))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a shading takes the forward pass's place, and not by the paper's search");
    gtx_result result = gtx_check_reserved(view->reserved, 1, error);
    for (uint32_t i = 0; !result && i < count; ++i) {
        result = gtx_check_reserved(instances[i].reserved, 3, error);
        if (!result && (!instances[i].model || !instances[i].model->ready))
            result = gtx_fail(error, GTX_ERROR_ARGUMENT,
                              "instance %u has no model, or one that is not uploaded", i);
    }
    return result;
}

/* Makes room for as many ranges as a model has patches. */
static gtx_result reserve(gtx_renderer *renderer, const gtx_instance *instances, uint32_t count,
                          gtx_error *error)
{
    uint32_t most = renderer->range_capacity;
    for (uint32_t i = 0; i < count; ++i)
        if (instances[i].model->patch_count > most)
            most = instances[i].model->patch_count;
    if (most == renderer->range_capacity)
        return GTX_OK;
    gtx_renderer_free_ranges(renderer);
    const gtx_allocator *hooks = &renderer->allocator;
    renderer->range_capacity = most;
    renderer->counts = gtx_alloc_array(hooks, most, sizeof *renderer->counts);
    renderer->offsets = gtx_alloc_array(hooks, most, sizeof *renderer->offsets);
    if (renderer->counts && renderer->offsets)
        return GTX_OK;
    gtx_renderer_free_ranges(renderer);
    return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to draw %u patches", most);
}

/* Compiles what the view is the first to need. */
static gtx_result need_programs(const gtx_submission *draw, gtx_error *error)
{
    const gtx_view *view = draw->call.view;
    const bool paper = view->method == GTX_METHOD_PAPER;
    const bool wanted[TECHNIQUE_COUNT] = {
        [TECHNIQUE_CAST] = !paper,
        [TECHNIQUE_BOX] = !paper,
        [TECHNIQUE_PAPER] = paper,
        [TECHNIQUE_TILES] = gtx_tiles_suit(&draw->call),
        [TECHNIQUE_LOD] = !paper,
        [TECHNIQUE_LOD_FRONT] = !paper && view->pass == GTX_PASS_FORWARD,
        [TECHNIQUE_GRID] = !paper,
        [TECHNIQUE_GRID_WHOLE] = !paper,
        [TECHNIQUE_GRID_FRONT] = !paper && view->pass == GTX_PASS_FORWARD,
        [TECHNIQUE_GRID_WHOLE_FRONT] = !paper && view->pass == GTX_PASS_FORWARD,
        [TECHNIQUE_GRID_LIT] = !paper && view->pass == GTX_PASS_FORWARD,
        [TECHNIQUE_GRID_WHOLE_LIT] = !paper && view->pass == GTX_PASS_FORWARD,
        [TECHNIQUE_LOD_SINGLE] = !paper && view->pass == GTX_PASS_DEPTH};
    gtx_result result = GTX_OK;
    for (int i = 0; i < TECHNIQUE_COUNT && !result; ++i)
        if (wanted[i])
            result = gtx_programs_need(draw->renderer, (gtx_technique)i, view->pass, error);
    return result;
}

static void begin(const gtx_gl *gl, const gtx_frame *frame, gl_bool color)
{
    for (gl_uint i = 0; i < UNIT_CLEARED; ++i)
        gl->BindSampler(i, 0);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(frame->reversed ? GL_GREATER : GL_LESS);
    gl->DepthMask(GL_TRUE);
    gl->CullFace(GL_BACK);
    gl->Disable(GL_BLEND);
    gl->ColorMask(color, color, color, color);
}

/* Draws instances whose data is in the instance buffer. */
static void draw_runs(gtx_submission *draw, const gtx_instance *instances, uint32_t count)
{
    const gtx_planner *planner = draw->call.planner;
    gtx_run r = {0};
    for (uint32_t i = 0; i < count; ++i) {
        if (instances[i].model != r.model || planner->ways[i] != r.way ||
            planner->mirrored[i] != r.mirrored) {
            gtx_run_draw(draw, &r);
            r = (gtx_run){instances[i].model, i, 0, planner->ways[i], planner->mirrored[i]};
        }
        ++r.count;
    }
    gtx_run_draw(draw, &r);
}

gtx_result gtx_draw(gtx_renderer *renderer, const gtx_view *view, const gtx_instance *instances,
                    uint32_t count, gtx_error *error)
{
    gtx_submission draw = {.call = {.planner = renderer ? &renderer->planner : NULL, .view = view},
                           .renderer = renderer};
    gtx_state state;
    gtx_result result = check(renderer, view, instances, count, error);
    if (!result)
        result = gtx_frame_from_view(view, &draw.call.frame, error);
    if (!result)
        result = reserve(renderer, instances, count, error);
    if (!result)
        result = gtx_planner_place(&draw.call, instances, count, error);
    if (!result)
        result = need_programs(&draw, error);
    if (result)
        return result;

    const gtx_gl *gl = &renderer->gl;
    const bool restore = view->flags & GTX_VIEW_RESTORE_STATE;
    if (restore)
        gtx_state_read(gl, &state);
    if (gl->PushDebugGroup)
        gl->PushDebugGroup(GL_DEBUG_SOURCE_THIRD_PARTY, 0, -1, "geotex draw");
    begin(gl, &draw.call.frame, view->pass != GTX_PASS_DEPTH);
    gl->BindVertexArray(renderer->vertex_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, renderer->instance_buffer);
    gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)(count * sizeof *renderer->planner.instances),
                   renderer->planner.instances, GL_STREAM_DRAW);
    draw_runs(&draw, instances, count);
    if (restore)
        gtx_state_restore(gl, &state);
    else
        gtx_state_leave(gl, draw.call.frame.reversed);
    if (gl->PopDebugGroup)
        gl->PopDebugGroup();
    return GTX_OK;
}
