/* Drawing: one instanced draw for each run of instances of one model. */
#include "render/renderer.h"

#include "base/alloc.h"
#include "base/error.h"

/* Instances that one call draws: of one model, and of one winding. */
typedef struct run {
    const gtx_model *model;
    uint32_t first, count;
    bool mirrored;
} run;

static gtx_result check(const gtx_renderer *renderer, const gtx_view *view,
                        const gtx_instance *instances, uint32_t count, gtx_error *error)
{
    const uint32_t flags =
        GTX_VIEW_REVERSED_Z | GTX_VIEW_DEPTH_ZERO_TO_ONE | GTX_VIEW_RESTORE_STATE;
    if (!renderer || !view || (count && !instances))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a draw needs a renderer, a view and instances");
    if (view->flags & ~flags || (unsigned)view->method > GTX_METHOD_PAPER ||
        (unsigned)view->pass > GTX_PASS_GBUFFER)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the view asks for an unknown flag, method or pass");
    if (view->shading && (view->pass != GTX_PASS_FORWARD || view->method == GTX_METHOD_PAPER))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a shading of one's own is cast, in place of the forward pass");
    gtx_result result = gtx_check_reserved(view->reserved, 2, error);
    for (uint32_t i = 0; !result && i < count; ++i) {
        result = gtx_check_reserved(instances[i].reserved, 3, error);
        if (!result && (!instances[i].model || !instances[i].model->ready))
            result = gtx_fail(error, GTX_ERROR_ARGUMENT,
                              "instance %u has no model, or one that is not uploaded", i);
    }
    return result;
}

/* Makes room for the data of `count` instances. */
static gtx_result reserve(gtx_renderer *renderer, uint32_t count, gtx_error *error)
{
    if (count <= renderer->instance_capacity)
        return GTX_OK;
    gtx_renderer_free_scratch(renderer);
    const gtx_allocator *hooks = &renderer->allocator;
    renderer->instance_capacity = count;
    renderer->instances = gtx_alloc_array(hooks, count, sizeof *renderer->instances);
    renderer->mirrored = gtx_alloc_array(hooks, count, sizeof *renderer->mirrored);
    if (renderer->instances && renderer->mirrored)
        return GTX_OK;
    gtx_renderer_free_scratch(renderer);
    return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for %u instances", count);
}

/* What one draw holds on to: the frame, its programs, and the one in use. */
typedef struct pass {
    const gtx_frame *frame;
    const gtx_program *plain, *material, *current;
} pass;

/* Compiles what the view is the first to need. */
static gtx_result choose_programs(gtx_renderer *renderer, const gtx_view *view, pass *p,
                                  gtx_error *error)
{
    static const int offsets[] = {[GTX_PASS_FORWARD] = PROGRAM_CAST,
                                  [GTX_PASS_DEPTH] = PROGRAM_CAST_DEPTH,
                                  [GTX_PASS_ID] = PROGRAM_CAST_ID,
                                  [GTX_PASS_GBUFFER] = PROGRAM_CAST_GBUFFER};
    if (view->shading) {
        p->plain = p->material = &view->shading->program;
        return GTX_OK;
    }
    const int method = view->method == GTX_METHOD_PAPER ? PROGRAM_PAPER : PROGRAM_CAST;
    const int plain = method + offsets[view->pass];
    p->plain = &renderer->programs[plain];
    p->material = p->plain + (view->pass == GTX_PASS_FORWARD);
    return gtx_program_need(renderer, plain, error);
}

static void begin(const gtx_gl *gl, const gtx_frame *frame, gl_bool color)
{
    for (gl_uint i = 0; i < UNIT_COUNT; ++i)
        gl->BindSampler(i, 0);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(frame->reversed ? GL_GREATER : GL_LESS);
    gl->DepthMask(GL_TRUE);
    gl->Enable(GL_CULL_FACE);
    gl->CullFace(GL_BACK);
    gl->Disable(GL_BLEND);
    gl->ColorMask(color, color, color, color);
}

static void bind_textures(const gtx_gl *gl, const gtx_model *model)
{
    for (gl_uint i = 0; i < UNIT_COUNT; ++i) {
        const gl_enum target = i == UNIT_PATCHES ? GL_TEXTURE_2D : GL_TEXTURE_2D_ARRAY;
        gl->ActiveTexture(GL_TEXTURE0 + i);
        gl->BindTexture(target, model->textures[i]);
    }
}

static const void *at(size_t offset)
{
    return (const char *)NULL + offset;
}

/* Points the attributes of geotex_proxy.vert at the run. */
static void set_attributes(const gtx_renderer *renderer, const run *r)
{
    const gtx_gl *gl = &renderer->gl;
    enum {
        FIRST_INSTANCE_ATTRIBUTE = 2,
        INSTANCE_ATTRIBUTES = offsetof(gtx_instance_data, id) / 16,
        ID_ATTRIBUTE = FIRST_INSTANCE_ATTRIBUTE + INSTANCE_ATTRIBUTES
    };
    const size_t base = r->first * sizeof(gtx_instance_data);
    gl->BindBuffer(GL_ARRAY_BUFFER, r->model->vertices);
    gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(gtx_proxy_vertex), at(0));
    gl->VertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(gtx_proxy_vertex),
                             at(offsetof(gtx_proxy_vertex, patch)));
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
    gl->BindBuffer(GL_ARRAY_BUFFER, renderer->instance_buffer);
    for (gl_uint i = 0; i < INSTANCE_ATTRIBUTES; ++i) {
        const gl_uint index = FIRST_INSTANCE_ATTRIBUTE + i;
        gl->VertexAttribPointer(index, 4, GL_FLOAT, GL_FALSE, sizeof(gtx_instance_data),
                                at(base + 16 * (size_t)i));
        gl->VertexAttribDivisor(index, 1);
        gl->EnableVertexAttribArray(index);
    }
    gl->VertexAttribIPointer(ID_ATTRIBUTE, 1, GL_UNSIGNED_INT, sizeof(gtx_instance_data),
                             at(base + offsetof(gtx_instance_data, id)));
    gl->VertexAttribDivisor(ID_ATTRIBUTE, 1);
    gl->EnableVertexAttribArray(ID_ATTRIBUTE);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, r->model->indices);
}

/* Takes the program that the model needs into use. */
static const gtx_program *use_program(const gtx_renderer *renderer, pass *p, const gtx_model *model)
{
    const gtx_gl *gl = &renderer->gl;
    const bool shades = model->has_material || model->emission_scale > 0;
    const gtx_program *program = shades ? p->material : p->plain;
    if (program != p->current) {
        gl->UseProgram(program->object);
        gl->UniformMatrix4fv(program->clip_from_world, 1, GL_FALSE, p->frame->clip_from_world);
        gl->Uniform4fv(program->depth, 1, p->frame->depth);
        gl->Uniform4fv(program->light, 1, p->frame->light);
        gl->Uniform4fv(program->detail, 1, p->frame->detail);
        p->current = program;
    }
    return program;
}

static void draw_run(const gtx_renderer *renderer, pass *p, const run *r)
{
    const gtx_gl *gl = &renderer->gl;
    const gtx_model *model = r->model;
    if (!model || !model->index_count) /* before the first run, or no cell at all */
        return;
    const float maps[4] = {(float)(model->mip_count - 1), model->has_color ? 1.0f : 0.0f,
                           model->emission_scale, model->has_material ? 1.0f : 0.0f};
    const gtx_program *program = use_program(renderer, p, model);
    bind_textures(gl, model);
    set_attributes(renderer, r);
    gl->Uniform4fv(program->maps, 1, maps);
    /* Back faces are wanted, so front faces are named as what culling takes away. */
    gl->FrontFace(r->mirrored ? GL_CCW : GL_CW);
    gl->DrawElementsInstanced(GL_TRIANGLES, (gl_size)model->index_count, GL_UNSIGNED_INT, NULL,
                              (gl_size)r->count);
}

/* Draws instances whose data is in the instance buffer. */
static void draw_runs(const gtx_renderer *renderer, pass *p, const gtx_instance *instances,
                      uint32_t count)
{
    run r = {0};
    for (uint32_t i = 0; i < count; ++i) {
        if (instances[i].model != r.model || renderer->mirrored[i] != r.mirrored) {
            draw_run(renderer, p, &r);
            r = (run){instances[i].model, i, 0, renderer->mirrored[i]};
        }
        ++r.count;
    }
    draw_run(renderer, p, &r);
}

gtx_result gtx_draw(gtx_renderer *renderer, const gtx_view *view, const gtx_instance *instances,
                    uint32_t count, gtx_error *error)
{
    gtx_frame frame;
    gtx_state state;
    pass p = {.frame = &frame};
    gtx_result result = check(renderer, view, instances, count, error);
    if (!result)
        result = gtx_frame_from_view(view, &frame, error);
    if (!result)
        result = reserve(renderer, count, error);
    for (uint32_t i = 0; !result && i < count; ++i)
        result = gtx_place_instance(&frame, &instances[i], &renderer->instances[i],
                                    &renderer->mirrored[i], error);
    if (!result)
        result = choose_programs(renderer, view, &p, error);
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
    gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)(count * sizeof *renderer->instances),
                   renderer->instances, GL_STREAM_DRAW);
    draw_runs(renderer, &p, instances, count);
    if (restore)
        gtx_state_restore(gl, &state);
    else
        gtx_state_leave(gl, frame.reversed);
    if (gl->PopDebugGroup)
        gl->PopDebugGroup();
    return GTX_OK;
}
