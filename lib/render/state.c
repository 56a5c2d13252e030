/* The OpenGL state around a draw: the fixed one it leaves, and reading and restoring the host's. */
#include "render/state.h"

/* Leaves unit UNIT_STREAM active. */
static void bind_stream(const gtx_gl *gl, gl_uint texture)
{
    if (!gl->TexBuffer)
        return;
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_STREAM);
    gl->BindTexture(GL_TEXTURE_BUFFER, texture);
}

void gtx_state_leave(const gtx_gl *gl, bool reversed)
{
    gl->UseProgram(0);
    gl->BindVertexArray(0);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
    bind_stream(gl, 0);
    for (gl_uint i = UNIT_CLEARED; i-- > 0;) {
        gl->ActiveTexture(GL_TEXTURE0 + i);
        gl->BindTexture(GL_TEXTURE_2D, 0);
        gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
        gl->BindSampler(i, 0);
    }
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(reversed ? GL_GREATER : GL_LESS);
    gl->DepthMask(GL_TRUE);
    gl->Disable(GL_CULL_FACE);
    gl->CullFace(GL_BACK);
    gl->FrontFace(GL_CCW);
    gl->Disable(GL_BLEND);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

static void read_draw_buffers(const gtx_gl *gl, gtx_state *state)
{
    if (!gl->IsEnabledi) {
        state->blend[0] = gl->IsEnabled(GL_BLEND);
        gl->GetBooleanv(GL_COLOR_WRITEMASK, state->color_mask[0]);
        return;
    }
    gl->GetIntegerv(GL_MAX_DRAW_BUFFERS, &state->draw_buffers);
    if (state->draw_buffers > GTX_MAX_DRAW_BUFFERS)
        state->draw_buffers = GTX_MAX_DRAW_BUFFERS;
    for (gl_int i = 0; i < state->draw_buffers; ++i) {
        state->blend[i] = gl->IsEnabledi(GL_BLEND, (gl_uint)i);
        gl->GetBooleani_v(GL_COLOR_WRITEMASK, (gl_uint)i, state->color_mask[i]);
    }
}

void gtx_state_read(const gtx_gl *gl, gtx_state *state)
{
    gl->GetIntegerv(GL_CURRENT_PROGRAM, &state->program);
    gl->GetIntegerv(GL_VERTEX_ARRAY_BINDING, &state->vertex_array);
    gl->GetIntegerv(GL_ARRAY_BUFFER_BINDING, &state->array_buffer);
    gl->GetIntegerv(GL_ACTIVE_TEXTURE, &state->unit);
    for (gl_uint i = 0; i < UNIT_CLEARED; ++i) {
        gl->ActiveTexture(GL_TEXTURE0 + i);
        gl->GetIntegerv(GL_TEXTURE_BINDING_2D, &state->textures[i]);
        gl->GetIntegerv(GL_TEXTURE_BINDING_2D_ARRAY, &state->arrays[i]);
        gl->GetIntegerv(GL_SAMPLER_BINDING, &state->samplers[i]);
    }
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_STREAM);
    if (gl->TexBuffer)
        gl->GetIntegerv(GL_TEXTURE_BINDING_BUFFER, &state->stream);
    gl->GetIntegerv(GL_DEPTH_FUNC, &state->depth_func);
    gl->GetIntegerv(GL_CULL_FACE_MODE, &state->cull_mode);
    gl->GetIntegerv(GL_FRONT_FACE, &state->front_face);
    state->depth_test = gl->IsEnabled(GL_DEPTH_TEST);
    gl->GetBooleanv(GL_DEPTH_WRITEMASK, &state->depth_mask);
    state->cull = gl->IsEnabled(GL_CULL_FACE);
    if (gl->MinSampleShading)
        state->by_samples = gl->IsEnabled(GL_SAMPLE_SHADING);
    read_draw_buffers(gl, state);
}

static void set(const gtx_gl *gl, gl_enum cap, gl_bool on)
{
    (on ? gl->Enable : gl->Disable)(cap);
}

static void restore_draw_buffers(const gtx_gl *gl, const gtx_state *state)
{
    const gl_bool *mask = state->color_mask[0];
    if (!gl->IsEnabledi) {
        set(gl, GL_BLEND, state->blend[0]);
        gl->ColorMask(mask[0], mask[1], mask[2], mask[3]);
        return;
    }
    for (gl_int i = 0; i < state->draw_buffers; ++i, mask += 4) {
        (state->blend[i] ? gl->Enablei : gl->Disablei)(GL_BLEND, (gl_uint)i);
        gl->ColorMaski((gl_uint)i, mask[0], mask[1], mask[2], mask[3]);
    }
}

void gtx_state_restore(const gtx_gl *gl, const gtx_state *state)
{
    gl->UseProgram((gl_uint)state->program);
    gl->BindVertexArray((gl_uint)state->vertex_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, (gl_uint)state->array_buffer);
    for (gl_uint i = 0; i < UNIT_CLEARED; ++i) {
        gl->ActiveTexture(GL_TEXTURE0 + i);
        gl->BindTexture(GL_TEXTURE_2D, (gl_uint)state->textures[i]);
        gl->BindTexture(GL_TEXTURE_2D_ARRAY, (gl_uint)state->arrays[i]);
        gl->BindSampler(i, (gl_uint)state->samplers[i]);
    }
    bind_stream(gl, (gl_uint)state->stream);
    gl->ActiveTexture((gl_enum)state->unit);
    set(gl, GL_DEPTH_TEST, state->depth_test);
    gl->DepthFunc((gl_enum)state->depth_func);
    gl->DepthMask(state->depth_mask);
    set(gl, GL_CULL_FACE, state->cull);
    if (gl->MinSampleShading)
        set(gl, GL_SAMPLE_SHADING, state->by_samples);
    gl->CullFace((gl_enum)state->cull_mode);
    gl->FrontFace((gl_enum)state->front_face);
    restore_draw_buffers(gl, state);
}
