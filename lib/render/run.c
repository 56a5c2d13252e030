/* Drawing a run of instances: by an LOD mesh, cast, or patch by patch, each in its own way. */
#include "render/run.h"

static gtx_material_kind material_of(const gtx_model *model)
{
    if (model->emission_scale > 0)
        return MATERIAL_MAPS;
    if (model->has_material)
        return model->has_constant_material ? MATERIAL_CONSTANT : MATERIAL_MAPS;
    return model->has_color ? MATERIAL_COLORS : MATERIAL_NONE;
}

static const gtx_program *program_of(const gtx_submission *draw, const gtx_model *model,
                                     gtx_technique technique)
{
    return gtx_program_of(draw->renderer, technique, draw->call.view->pass, material_of(model));
}

static void bind_textures(const gtx_gl *gl, const gtx_model *model)
{
    for (gl_uint i = 0; i < UNIT_COUNT; ++i) {
        const gl_enum target = i == UNIT_PATCHES ? GL_TEXTURE_2D : GL_TEXTURE_2D_ARRAY;
        gl->ActiveTexture(GL_TEXTURE0 + i);
        gl->BindTexture(target, model->textures[i]);
    }
}

/* Points the attributes at the data of instances from one on, the next one's after `divisor` of
 * those that are drawn. */
static void set_instances(const gtx_renderer *renderer, uint32_t instance, gl_uint divisor)
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
                                gtx_gl_offset(base + 16 * (size_t)i));
        gl->VertexAttribDivisor(index, divisor);
        gl->EnableVertexAttribArray(index);
    }
    gl->VertexAttribIPointer(ID_ATTRIBUTE, 1, GL_UNSIGNED_INT, sizeof(gtx_instance_data),
                             gtx_gl_offset(base + offsetof(gtx_instance_data, id)));
    gl->VertexAttribDivisor(ID_ATTRIBUTE, divisor);
    gl->EnableVertexAttribArray(ID_ATTRIBUTE);
}

/* The same, and at the vertices of proxies. */
static void set_attributes(const gtx_renderer *renderer, const gtx_run *r, uint32_t instance)
{
    const gtx_gl *gl = &renderer->gl;
    gl->BindBuffer(GL_ARRAY_BUFFER, r->model->vertices);
    gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(gtx_proxy_vertex), gtx_gl_offset(0));
    gl->VertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(gtx_proxy_vertex),
                             gtx_gl_offset(offsetof(gtx_proxy_vertex, patch)));
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, r->model->indices);
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
    set_instances(renderer, instance, 1);
}

/* Takes a program into use, with the model's uniforms. */
static void use_program(gtx_submission *draw, const gtx_program *program, const gtx_model *model)
{
    const gtx_gl *gl = &draw->renderer->gl;
    const gtx_frame *frame = &draw->call.frame;
    const float maps[4] = {(float)(model->mip_count - 1), model->has_color ? 1.0f : 0.0f,
                           model->emission_scale, model->has_material ? 1.0f : 0.0f};
    if (program != draw->program) {
        gl->UseProgram(program->object);
        gl->UniformMatrix4fv(program->clip_from_world, 1, GL_FALSE, frame->clip_from_world);
        gl->Uniform4fv(program->depth, 1, frame->depth);
        gl->Uniform4fv(program->light, 1, frame->light);
        gl->Uniform4fv(program->detail, 1, frame->detail);
        gl->Uniform4fv(program->search, 1, frame->search);
        draw->program = program;
    }
    gl->Uniform4fv(program->maps, 1, maps);
    gl->Uniform4fv(program->constant_material, 1, model->constant_material);
}

/* Which faces a run of proxies is drawn by: boxes by their back faces, so that a camera inside
 * still sees the patch, hulls by their front faces, where rays begin. */
static void face(const gtx_gl *gl, const gtx_run *r, bool back)
{
    gl->FrontFace(r->mirrored != back ? GL_CW : GL_CCW);
}

/* Draws all proxies of a kind, of `count` instances. */
static void cast_whole(const gtx_renderer *renderer, const gtx_run *r, uint32_t kind,
                       uint32_t instance, uint32_t count)
{
    const gtx_model *model = r->model;
    const uint32_t *first = &model->first_index[kind * model->patch_count];
    const uint32_t indices = first[model->patch_count] - first[0];
    if (!indices)
        return;
    renderer->gl.Enable(GL_CULL_FACE);
    set_attributes(renderer, r, instance);
    face(&renderer->gl, r, kind == 0);
    renderer->gl.DrawElementsInstanced(GL_TRIANGLES, (gl_size)indices, GL_UNSIGNED_INT,
                                       gtx_gl_offset(first[0] * sizeof(uint32_t)), (gl_size)count);
}

/* Draws ranges of a plan, of the instance that the attributes point at. */
static void cast_parts(const gtx_renderer *renderer, const gtx_plan *plan, uint32_t first,
                       uint32_t count)
{
    const gtx_gl *gl = &renderer->gl;
    for (uint32_t i = 0; i < count; ++i) {
        const gtx_range *range = &plan->ranges[first + i];
        const void *offset = gtx_gl_offset(range->first * sizeof(uint32_t));
        if (gl->MultiDrawElements) {
            renderer->counts[i] = (gl_size)range->count;
            renderer->offsets[i] = offset;
        } else {
            gl->DrawElementsInstanced(GL_TRIANGLES, (gl_size)range->count, GL_UNSIGNED_INT,
                                      offset, 1);
        }
    }
    if (gl->MultiDrawElements && count)
        gl->MultiDrawElements(GL_TRIANGLES, renderer->counts, GL_UNSIGNED_INT, renderer->offsets,
                              (gl_size)count);
}

/* Casts an instance by tiles; false when it has to be done otherwise. */
static bool cast_tiles(gtx_submission *draw, const gtx_run *r, uint32_t instance)
{
    gtx_renderer *renderer = draw->renderer;
    const gtx_instance_data *placed = &renderer->planner.instances[instance];
    if (!gtx_tiles_suit(&draw->call) || !gtx_tiles_fill(&draw->call, r->model, placed))
        return false;
    if (!renderer->planner.tiles.tile_count)
        return true;
    use_program(draw, program_of(draw, r->model, TECHNIQUE_TILES), r->model);
    gtx_tile_stream_draw(renderer, draw->program, placed);
    renderer->gl.BindVertexArray(renderer->vertex_array);
    return true;
}

static const gtx_program *cast_program(const gtx_submission *draw, const gtx_model *model, bool box)
{
    const gtx_view *view = draw->call.view;
    const gtx_technique technique = view->method == GTX_METHOD_PAPER ? TECHNIQUE_PAPER
                                    : box                            ? TECHNIQUE_BOX
                                                                     : TECHNIQUE_CAST;
    return view->shading ? &view->shading->cast : program_of(draw, model, technique);
}

static const gtx_program *grid_program(const gtx_submission *draw, const gtx_model *model,
                                       uint32_t looks, bool keeps_angles)
{
    static const gtx_technique techniques[2][2] = {
        {TECHNIQUE_GRID_WHOLE, TECHNIQUE_GRID_WHOLE_FRONT},
        {TECHNIQUE_GRID, TECHNIQUE_GRID_FRONT}};
    const gtx_view *view = draw->call.view;
    const bool forward = view->pass == GTX_PASS_FORWARD, whole = !(looks & GTX_GRID_TRIMMED);
    const bool front = forward && keeps_angles && !(looks & GTX_GRID_BEHIND);
    if (forward && !view->shading && !(looks & GTX_GRID_MAPPED))
        return program_of(draw, model, whole ? TECHNIQUE_GRID_WHOLE_LIT : TECHNIQUE_GRID_LIT);
    return view->shading ? &view->shading->grid
                         : program_of(draw, model, techniques[!whole][front]);
}

static const gtx_program *lod_program(const gtx_submission *draw, const gtx_run *r, bool front)
{
    const bool forward = draw->call.view->pass == GTX_PASS_FORWARD;
    const gtx_technique technique = forward && front ? TECHNIQUE_LOD_FRONT : TECHNIQUE_LOD;
    return draw->call.view->shading ? &draw->call.view->shading->lod
                                    : program_of(draw, r->model, technique);
}

/* Draws those patches of a level that are seen from one side or from two, by the program for front
 * faces or the one for all. */
static void draw_side(gtx_submission *draw, const gtx_run *r, uint32_t level, const uint8_t *parts,
                      bool two_sided, bool front)
{
    const gtx_renderer *renderer = draw->renderer;
    const gtx_gl *gl = &renderer->gl;
    const gtx_lod_meshes *lods = &r->model->lods;
    const bool single = draw->call.view->pass == GTX_PASS_DEPTH && r->count == 1;
    use_program(draw, single ? program_of(draw, r->model, TECHNIQUE_LOD_SINGLE)
                             : lod_program(draw, r, front), r->model);
    if (single)
        gl->Uniform4fv(draw->program->place, 3, renderer->planner.instances[r->first].world[0]);
    gl->Uniform4fv(draw->program->lod, 1, lods->levels[level].place);
    gtx_lod_draw(gl, lods, level, two_sided, single ? 0 : r->count, parts);
}

/* Draws an LOD mesh, or parts of it: patches with a back face culled, then those without. Of these
 * the front faces first, by their own program: most back faces lie hidden behind them. */
static void draw_lod(gtx_submission *draw, const gtx_run *r, uint32_t level, const uint8_t *parts)
{
    const gtx_renderer *renderer = draw->renderer;
    const gtx_gl *gl = &renderer->gl;
    const gtx_lod_meshes *lods = &r->model->lods;
    bool front = draw->call.view->pass == GTX_PASS_FORWARD && !draw->call.view->shading;
    for (uint32_t i = 0; i < r->count; ++i)
        front = front && gtx_keeps_angles(&renderer->planner.instances[r->first + i]);
    if (draw->call.view->pass != GTX_PASS_DEPTH || r->count > 1)
        set_instances(renderer, r->first, 1);
    gl->FrontFace(r->mirrored ? GL_CW : GL_CCW);
    gl->Enable(GL_CULL_FACE);
    if (lods->one_sided)
        draw_side(draw, r, level, parts, false, front);
    if (lods->one_sided == lods->patch_count)
        return;
    if (front) {
        draw_side(draw, r, level, parts, true, true);
        gl->CullFace(GL_FRONT);
    } else {
        gl->Disable(GL_CULL_FACE);
    }
    draw_side(draw, r, level, parts, true, false);
    gl->CullFace(GL_BACK);
}

/* Draws displaced grids. */
static void draw_grids(gtx_submission *draw, const gtx_run *r, uint32_t instance)
{
    gtx_renderer *renderer = draw->renderer;
    const gtx_gl *gl = &renderer->gl;
    const gtx_instance_data *placed = &renderer->planner.instances[instance];
    const gl_uint all = 1u << 30;
    bool begun = false;
    for (uint32_t looks = 0; looks < GTX_GRID_LOOKS; ++looks) {
        if (!renderer->planner.grids.index_count[looks])
            continue;
        if (!begun) {
            gtx_grid_stream_begin(renderer);
            set_instances(renderer, instance, all);
            gl->FrontFace(r->mirrored ? GL_CW : GL_CCW);
            gl->Disable(GL_CULL_FACE);
            begun = true;
        }
        use_program(draw, grid_program(draw, r->model, looks, gtx_keeps_angles(placed)), r->model);
        gl->Uniform4fv(draw->program->lod, 1,
                       (float[4]){looks & GTX_GRID_BEHIND ? 1.0f : 0.0f, 0, 0, 0});
        gtx_grid_stream_draw(renderer, looks);
    }
    if (begun)
        gl->BindVertexArray(renderer->vertex_array);
}

/* Casts what the plan holds, nearest first. Boxes are told their level by a uniform. */
static void cast_plan(gtx_submission *draw, const gtx_run *r, uint32_t instance)
{
    const gtx_renderer *renderer = draw->renderer;
    const gtx_gl *gl = &renderer->gl;
    gtx_plan *plan = &draw->renderer->planner.plan;
    uint32_t first = 0;
    if (!plan->count || cast_tiles(draw, r, instance))
        return;
    gtx_plan_proxies(plan, r->model);
    gl->Enable(GL_CULL_FACE);
    set_attributes(renderer, r, instance);
    face(gl, r, true);
    for (uint32_t level = 0; level < r->model->mip_count; ++level) {
        const float *d = draw->call.frame.detail, detail[4] = {d[0], d[1], (float)level, d[3]};
        if (!plan->box_count[level])
            continue;
        use_program(draw, cast_program(draw, r->model, true), r->model);
        gl->Uniform4fv(draw->program->detail, 1, detail);
        cast_parts(renderer, plan, first, plan->box_count[level]);
        first += plan->box_count[level];
    }
    face(gl, r, false);
    if (plan->hull_count)
        use_program(draw, cast_program(draw, r->model, false), r->model);
    cast_parts(renderer, plan, first, plan->hull_count);
}

/* How many levels of the LOD mesh may be mixed with height fields, the finest first. */
static uint32_t levels_to_mix(const gtx_submission *draw, const gtx_run *r)
{
    const gtx_lod_meshes *lods = &r->model->lods;
    uint32_t count = 0;
    if (draw->call.view->method != GTX_METHOD_AUTO || r->way != GTX_DRAW_PATCHES)
        return 0;
    while (count < lods->level_count && !lods->levels[count].far)
        ++count;
    return count;
}

/* Draws an instance patch by patch, each in its own way. */
static void draw_patches(gtx_submission *draw, const gtx_run *r, uint32_t instance,
                         bool edited_only)
{
    gtx_renderer *renderer = draw->renderer;
    gtx_plan *plan = &renderer->planner.plan;
    const gtx_lod_meshes *lods = &r->model->lods;
    const gtx_instance_data *placed = &renderer->planner.instances[instance];
    gtx_plan_patches(&draw->call, r->model, placed, levels_to_mix(draw, r), edited_only);
    if (r->way != GTX_DRAW_CAST && gtx_blocks_fill(&draw->call, r->model, placed))
        draw_grids(draw, r, instance);
    cast_plan(draw, r, instance);
    const gtx_run one = {r->model, instance, 1, 0, r->mirrored};
    for (uint32_t k = 0; plan->any_lod && k < lods->level_count; ++k)
        if (gtx_plan_parts(plan, lods, k))
            draw_lod(draw, &one, k, plan->parts);
}

/* Draws the patches of a run, or only those that are edited. Instances that stand alone are sorted,
 * those that need it are looked at patch by patch, and others cast together. */
static void draw_height_fields(gtx_submission *draw, const gtx_run *r, bool edited_only)
{
    const gtx_renderer *renderer = draw->renderer;
    const gtx_model *model = r->model;
    const gtx_program *program = cast_program(draw, model, false);
    if (draw->call.view->method == GTX_METHOD_PAPER) {
        use_program(draw, program, model);
        cast_whole(renderer, r, 0, r->first, r->count);
        return;
    }
    for (uint32_t i = r->first, end = r->first + r->count; i < end;) {
        uint32_t last = i, kind = 0;
        if (r->count > 1 && !edited_only && draw->call.view->method != GTX_METHOD_GRID &&
            (r->way == GTX_DRAW_CAST || !model->lods.level_count))
            kind = gtx_plan_whole(&draw->call, model, &renderer->planner.instances[i]);
        for (++last; kind && last < end; ++last)
            if (gtx_plan_whole(&draw->call, model, &renderer->planner.instances[last]) != kind)
                break;
        if (kind) {
            use_program(draw, program, model);
            cast_whole(renderer, r, kind, i, last - i);
        } else {
            draw_patches(draw, r, i, edited_only);
        }
        i = last;
    }
}

void gtx_run_draw(gtx_submission *draw, const gtx_run *r)
{
    if (!r->model) /* before the first run */
        return;
    const bool lod = r->way != GTX_DRAW_PATCHES && r->way != GTX_DRAW_CAST;
    bind_textures(&draw->renderer->gl, r->model);
    if (lod)
        draw_lod(draw, r, r->way - 1u, NULL);
    if (!lod || r->model->lods.edited_count)
        draw_height_fields(draw, r, lod);
}
