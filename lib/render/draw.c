/* Drawing: runs of instances of one model, in one draw where they are far away. */
#include "render/renderer.h"

#include "base/alloc.h"
#include "base/error.h"

/* Instances that are drawn together: of one model, in one way, and of one winding. */
typedef struct run {
    const gtx_model *model;
    uint32_t first, count;
    uint8_t way;              /* as gtx_choose_way has it */
    bool mirrored;
} run;

static gtx_result check(const gtx_renderer *renderer, const gtx_view *view,
                        const gtx_instance *instances, uint32_t count, gtx_error *error)
{
    const uint32_t flags =
        GTX_VIEW_REVERSED_Z | GTX_VIEW_DEPTH_ZERO_TO_ONE | GTX_VIEW_RESTORE_STATE;
    if (!renderer || !view || (count && !instances))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a draw needs a renderer, a view and instances");
    if (view->flags & ~flags || (unsigned)view->method > GTX_METHOD_LOD ||
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
    renderer->ways = gtx_alloc_array(hooks, count, sizeof *renderer->ways);
    if (renderer->instances && renderer->mirrored && renderer->ways)
        return GTX_OK;
    gtx_renderer_free_scratch(renderer);
    return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for %u instances", count);
}

/* What one draw holds on to: the frame, what is asked for, and the program in use. */
typedef struct pass {
    const gtx_frame *frame;
    const gtx_view *view;
    const gtx_program *current;
} pass;

/* The program of a pass relative to the method's first. */
static const int pass_programs[] = {[GTX_PASS_FORWARD] = 0,
                                    [GTX_PASS_DEPTH] = PROGRAM_CAST_DEPTH,
                                    [GTX_PASS_ID] = PROGRAM_CAST_ID,
                                    [GTX_PASS_GBUFFER] = PROGRAM_CAST_GBUFFER};

/* Compiles what the view is the first to need. */
static gtx_result need_programs(gtx_renderer *renderer, const gtx_view *view, gtx_error *error)
{
    const int offset = pass_programs[view->pass];
    const int method = view->method == GTX_METHOD_PAPER ? PROGRAM_PAPER : PROGRAM_CAST;
    gtx_result result = gtx_program_need(renderer, method + offset, error);
    if (!result && method == PROGRAM_CAST)
        result = gtx_program_need(renderer, PROGRAM_LOD + offset, error);
    if (!result && view->pass == GTX_PASS_DEPTH)
        result = gtx_program_need(renderer, PROGRAM_LOD_DEPTH_ALONE, error);
    if (!result && gtx_stream_suits(renderer, view))
        result = gtx_program_need(renderer, PROGRAM_TILES + offset, error);
    return result;
}

static bool shades(const gtx_model *model)
{
    return model->has_material || model->emission_scale > 0;
}

static bool has_even_material(const gtx_model *model)
{
    return model->has_even_material && !(model->emission_scale > 0);
}

static const gtx_program *program_of(const gtx_renderer *renderer, const gtx_view *view,
                                     const gtx_model *model, bool lod, bool front)
{
    if (view->shading)
        return lod ? &view->shading->lod : &view->shading->cast;
    int kind = lod                              ? PROGRAM_LOD
               : view->method == GTX_METHOD_PAPER ? PROGRAM_PAPER
                                                  : PROGRAM_CAST;
    if (view->pass != GTX_PASS_FORWARD)
        kind += pass_programs[view->pass];
    else if (shades(model))
        kind = !front                     ? kind + 1
               : has_even_material(model) ? PROGRAM_LOD_EVEN_FRONT
                                          : PROGRAM_LOD_MATERIAL_FRONT;
    else if (lod && model->has_color)
        kind = front ? PROGRAM_LOD_COLOR_FRONT : PROGRAM_LOD_COLOR;
    else if (front)
        kind = PROGRAM_LOD_FRONT;
    else if (kind == PROGRAM_CAST && model->has_color)
        kind = PROGRAM_CAST_COLOR;
    return &renderer->programs[kind];
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

/* Points the attributes at the data of instances from one on. */
static void set_instances(const gtx_renderer *renderer, uint32_t instance)
{
    const gtx_gl *gl = &renderer->gl;
    enum {
        FIRST_INSTANCE_ATTRIBUTE = 2,
        INSTANCE_ATTRIBUTES = offsetof(gtx_instance_data, id) / 16,
        ID_ATTRIBUTE = FIRST_INSTANCE_ATTRIBUTE + INSTANCE_ATTRIBUTES
    };
    const size_t base = instance * sizeof(gtx_instance_data);
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
}

/* The same, and at the vertices of proxies. */
static void set_attributes(const gtx_renderer *renderer, const run *r, uint32_t instance)
{
    const gtx_gl *gl = &renderer->gl;
    gl->BindBuffer(GL_ARRAY_BUFFER, r->model->vertices);
    gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(gtx_proxy_vertex), at(0));
    gl->VertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(gtx_proxy_vertex),
                             at(offsetof(gtx_proxy_vertex, patch)));
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, r->model->indices);
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
    set_instances(renderer, instance);
}

/* Takes a program into use, with the model's uniforms. */
static void use_program(const gtx_gl *gl, pass *p, const gtx_program *program,
                        const gtx_model *model)
{
    const float maps[4] = {(float)(model->mip_count - 1), model->has_color ? 1.0f : 0.0f,
                           model->emission_scale, model->has_material ? 1.0f : 0.0f};
    if (program != p->current) {
        gl->UseProgram(program->object);
        gl->UniformMatrix4fv(program->clip_from_world, 1, GL_FALSE, p->frame->clip_from_world);
        gl->Uniform4fv(program->depth, 1, p->frame->depth);
        gl->Uniform4fv(program->light, 1, p->frame->light);
        gl->Uniform4fv(program->detail, 1, p->frame->detail);
        gl->Uniform4fv(program->search, 1, p->frame->search);
        p->current = program;
    }
    gl->Uniform4fv(program->maps, 1, maps);
    gl->Uniform4fv(program->even, 1, model->even_material);
}

/* Which faces a run of proxies is drawn by: boxes by their back faces, so that a camera inside
 * still sees the patch, hulls by their front faces, where rays begin. */
static void face(const gtx_gl *gl, const run *r, bool back)
{
    gl->FrontFace(r->mirrored != back ? GL_CW : GL_CCW);
}

/* Draws all proxies of a kind, of `count` instances. */
static void cast_whole(const gtx_renderer *renderer, const run *r, uint32_t kind, uint32_t instance,
                       uint32_t count)
{
    const gtx_model *model = r->model;
    const uint32_t *first = &model->first_index[kind * model->patch_count];
    const uint32_t indices = first[model->patch_count] - first[0];
    if (!indices)
        return;
    set_attributes(renderer, r, instance);
    face(&renderer->gl, r, kind == 0);
    renderer->gl.DrawElementsInstanced(GL_TRIANGLES, (gl_size)indices, GL_UNSIGNED_INT,
                                       at(first[0] * sizeof(uint32_t)), (gl_size)count);
}

/* Draws parts of a plan, of the instance that the attributes point at. */
static void cast_parts(const gtx_gl *gl, const gtx_plan *plan, uint32_t first, uint32_t count)
{
    if (gl->MultiDrawElements && count)
        gl->MultiDrawElements(GL_TRIANGLES, plan->counts + first, GL_UNSIGNED_INT,
                              plan->offsets + first, (gl_size)count);
    for (uint32_t i = first; !gl->MultiDrawElements && i < first + count; ++i)
        gl->DrawElementsInstanced(GL_TRIANGLES, plan->counts[i], GL_UNSIGNED_INT, plan->offsets[i],
                                  1);
}

/* Casts an instance by tiles; false when it has to be done otherwise. */
static bool cast_tiles(gtx_renderer *renderer, pass *p, const run *r, uint32_t instance)
{
    const gtx_gl *gl = &renderer->gl;
    const gtx_instance_data *placed = &renderer->instances[instance];
    if (!gtx_stream_suits(renderer, p->view) ||
        !gtx_tiles_fill(renderer, p->view, p->frame, r->model, placed))
        return false;
    if (!renderer->tiles.tile_count)
        return true;
    int kind = PROGRAM_TILES + pass_programs[p->view->pass];
    if (p->view->pass == GTX_PASS_FORWARD && shades(r->model))
        kind = PROGRAM_TILES_MATERIAL;
    else if (p->view->pass == GTX_PASS_FORWARD && r->model->has_color)
        kind = PROGRAM_TILES_COLOR;
    use_program(gl, p, &renderer->programs[kind], r->model);
    gtx_stream_draw(renderer, p->current, placed);
    gl->BindVertexArray(renderer->vertex_array);
    return true;
}

/* Draws an instance patch by patch, nearest first. Boxes are told their level by a uniform. */
static void cast_sorted(gtx_renderer *renderer, pass *p, const run *r, uint32_t instance,
                        bool edited_only)
{
    const gtx_gl *gl = &renderer->gl;
    const gtx_plan *plan = &renderer->plan;
    uint32_t first = 0;
    gtx_plan_patches(renderer, p->view, p->frame, r->model, &renderer->instances[instance],
                     edited_only);
    if (cast_tiles(renderer, p, r, instance))
        return;
    use_program(gl, p, program_of(renderer, p->view, r->model, false, false), r->model);
    set_attributes(renderer, r, instance);
    face(gl, r, true);
    for (uint32_t level = 0; level < r->model->mip_count; ++level) {
        const float *d = p->frame->detail, detail[4] = {d[0], d[1], (float)level, d[3]};
        if (!plan->box_count[level])
            continue;
        gl->Uniform4fv(p->current->detail, 1, detail);
        cast_parts(gl, plan, first, plan->box_count[level]);
        first += plan->box_count[level];
    }
    face(gl, r, false);
    cast_parts(gl, plan, first, plan->hull_count);
}

/* Casts the patches of a run, or only those that are edited. Instances that stand alone are sorted,
 * those that need it are looked at patch by patch, and others drawn together. */
static void cast_run(gtx_renderer *renderer, pass *p, const run *r, bool edited_only)
{
    const gtx_model *model = r->model;
    const bool paper = p->view->method == GTX_METHOD_PAPER;
    const gtx_program *program = program_of(renderer, p->view, model, false, false);
    renderer->gl.Enable(GL_CULL_FACE);
    if (paper) {
        use_program(&renderer->gl, p, program, model);
        cast_whole(renderer, r, 0, r->first, r->count);
        return;
    }
    for (uint32_t i = r->first, end = r->first + r->count; i < end;) {
        uint32_t last = i, kind = 0;
        if (r->count > 1 && !edited_only)
            kind = gtx_plan_whole(p->view, p->frame, model, &renderer->instances[i]);
        for (++last; kind && last < end; ++last)
            if (gtx_plan_whole(p->view, p->frame, model, &renderer->instances[last]) != kind)
                break;
        if (kind) {
            use_program(&renderer->gl, p, program, model);
            cast_whole(renderer, r, kind, i, last - i);
        } else {
            cast_sorted(renderer, p, r, i, edited_only);
        }
        i = last;
    }
}

/* Draws an LOD mesh: patches with a back face culled, then those without. */
static void draw_lod(const gtx_renderer *renderer, pass *p, const run *r)
{
    const gtx_gl *gl = &renderer->gl;
    const gtx_lod_meshes *lods = &r->model->lods;
    const uint32_t level = r->way - 1u;
    const bool alone = p->view->pass == GTX_PASS_DEPTH && r->count == 1;
    bool keeps_angles = true;
    for (uint32_t i = 0; i < r->count; ++i)
        keeps_angles = keeps_angles && gtx_keeps_angles(&renderer->instances[r->first + i]);
    if (!alone)
        set_instances(renderer, r->first);
    gl->FrontFace(r->mirrored ? GL_CW : GL_CCW);
    for (int two_sided = 0; two_sided < 2; ++two_sided) {
        if (lods->one_sided == (two_sided ? lods->patch_count : 0))
            continue;
        use_program(gl, p, alone ? &renderer->programs[PROGRAM_LOD_DEPTH_ALONE]
                                 : program_of(renderer, p->view, r->model, true,
                                              keeps_angles && !two_sided), r->model);
        if (alone)
            gl->Uniform4fv(p->current->place, 3, renderer->instances[r->first].world[0]);
        gl->Uniform4fv(p->current->lod, 1, lods->levels[level].place);
        (two_sided ? gl->Disable : gl->Enable)(GL_CULL_FACE);
        gtx_lod_draw(gl, lods, level, two_sided, alone ? 0 : r->count);
    }
}

static void draw_run(gtx_renderer *renderer, pass *p, const run *r)
{
    if (!r->model) /* before the first run */
        return;
    bind_textures(&renderer->gl, r->model);
    if (r->way)
        draw_lod(renderer, p, r);
    if (!r->way || r->model->lods.edited_count)
        cast_run(renderer, p, r, r->way);
}

/* Draws instances whose data is in the instance buffer. */
static void draw_runs(gtx_renderer *renderer, pass *p, const gtx_instance *instances,
                      uint32_t count)
{
    run r = {0};
    for (uint32_t i = 0; i < count; ++i) {
        if (instances[i].model != r.model || renderer->ways[i] != r.way ||
            renderer->mirrored[i] != r.mirrored) {
            draw_run(renderer, p, &r);
            r = (run){instances[i].model, i, 0, renderer->ways[i], renderer->mirrored[i]};
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
    pass p = {.frame = &frame, .view = view};
    gtx_result result = check(renderer, view, instances, count, error);
    if (!result)
        result = gtx_frame_from_view(view, &frame, error);
    if (!result)
        result = reserve(renderer, count, error);
    for (uint32_t i = 0; !result && i < count; ++i) {
        result = gtx_plan_reserve(renderer, instances[i].model->patch_count, error);
        if (!result)
            result = gtx_place_instance(&frame, &instances[i], &renderer->instances[i],
                                        &renderer->mirrored[i], error);
        if (!result)
            result = gtx_choose_way(renderer, view, &frame, instances[i].model,
                                    &renderer->instances[i], &renderer->ways[i], error);
    }
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
