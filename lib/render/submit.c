/* Submitting draws: state, attributes and uniforms, set where they change. */
#include "render/submit.h"

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

static void set_proxies(const gtx_renderer *renderer, const gtx_model *model)
{
    const gtx_gl *gl = &renderer->gl;
    gl->BindBuffer(GL_ARRAY_BUFFER, model->vertices);
    gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(gtx_proxy_vertex), gtx_gl_offset(0));
    gl->VertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(gtx_proxy_vertex),
                             gtx_gl_offset(offsetof(gtx_proxy_vertex, patch)));
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, model->indices);
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
}

static void set_lods(const gtx_renderer *renderer, const gtx_frame_draw *draw)
{
    const gtx_gl *gl = &renderer->gl;
    const gtx_lod_meshes *lods = &draw->model->lods;
    gl->BindBuffer(GL_ARRAY_BUFFER, lods->vertex_buffer);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER,
                   draw->index_data ? renderer->picked_buffer : lods->index_buffer);
    if (draw->index_data)
        gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, (gl_pointer)draw->index_bytes, draw->index_data,
                       GL_STREAM_DRAW);
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
}

static void use_program(gtx_submission *s, const gtx_program *program,
                        const gtx_constants *constants)
{
    const bool same = program == s->program;
    if (!same)
        s->renderer->gl.UseProgram(program->object);
    gtx_program_set(&s->renderer->gl, program, constants, same ? &s->constants : NULL);
    s->program = program;
    s->constants = *constants;
}

static void cull(gtx_submission *s, const gtx_frame_draw *draw)
{
    const gtx_gl *gl = &s->renderer->gl;
    gl->FrontFace(draw->clockwise ? GL_CW : GL_CCW);
    if (draw->cull == GTX_CULL_NONE) {
        gl->Disable(GL_CULL_FACE);
        return;
    }
    gl->Enable(GL_CULL_FACE);
    gl->CullFace(draw->cull == GTX_CULL_FRONT ? GL_FRONT : GL_BACK);
}

static const gtx_program *program_of(const gtx_submission *s, const gtx_frame_draw *draw,
                                     bool single)
{
    const gtx_technique technique = gtx_pipeline_technique(draw->pipeline);
    if (technique >= TECHNIQUE_OWN_CAST)
        return &s->view->shading->programs[technique - TECHNIQUE_OWN_CAST];
    /* All materials are drawn alike in other passes than the forward one. */
    return &s->renderer->programs[single ? gtx_pipeline_of(TECHNIQUE_LOD_SINGLE, s->view->pass,
                                                           MATERIAL_NONE)
                                         : draw->pipeline];
}

/* What casts is cast once a sample; polygons need no more than once a pixel. */
static void shade_samples(const gtx_gl *gl, bool casts)
{
    (casts ? gl->Enable : gl->Disable)(GL_SAMPLE_SHADING);
    gl->MinSampleShading(1);
}

/* Several ranges of one instance in one call where the context can. */
static void draw_proxies(const gtx_gl *gl, const gtx_frame_draw *draw)
{
    enum { AT_ONCE = 256 };
    gl_size counts[AT_ONCE];
    const void *offsets[AT_ONCE];
    const bool multi = gl->MultiDrawElements && draw->instance_count == 1 && draw->range_count > 1;
    const gl_enum type = draw->index_size == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
    for (uint32_t i = 0, ready = 0; i < draw->range_count; ++i) {
        counts[ready] = (gl_size)draw->ranges[i].count;
        offsets[ready] = gtx_gl_offset((size_t)draw->ranges[i].first * draw->index_size);
        if (!multi) {
            gl->DrawElementsInstanced(GL_TRIANGLES, counts[0], type, offsets[0],
                                      (gl_size)draw->instance_count);
        } else if (++ready == AT_ONCE || i + 1 == draw->range_count) {
            gl->MultiDrawElements(GL_TRIANGLES, counts, type, offsets, (gl_size)ready);
            ready = 0;
        }
    }
}

/* Without `instances` the program takes the transform of a single one as a uniform. */
static void draw_lods(const gtx_gl *gl, const gtx_frame_draw *draw, bool instances)
{
    const gl_enum type = draw->index_size == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
    const bool narrow = draw->vertex_size == sizeof(gtx_lod_narrow_vertex);
    const gl_enum patch_type = narrow ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
    const size_t patch_at = narrow ? offsetof(gtx_lod_narrow_vertex, patch)
                                   : offsetof(gtx_lod_vertex, patch);
    const gl_size size = (gl_size)draw->vertex_size;
    for (const gtx_range *r = draw->ranges; r < draw->ranges + draw->range_count; ++r) {
        const void *indices = gtx_gl_offset(draw->index_offset + r->first * draw->index_size);
        const uint64_t vertex =
            draw->vertex_offset + r->base_vertex * (uint64_t)draw->vertex_size;
        gl->VertexAttribPointer(0, 4, GL_UNSIGNED_SHORT, GL_FALSE, size, gtx_gl_offset(vertex));
        gl->VertexAttribIPointer(1, 1, patch_type, size, gtx_gl_offset(vertex + patch_at));
        if (instances)
            gl->DrawElementsInstanced(GL_TRIANGLES, (gl_size)r->count, type, indices,
                                      (gl_size)draw->instance_count);
        else
            gl->DrawRangeElements(GL_TRIANGLES, 0, r->vertex_count - 1, (gl_size)r->count, type,
                                  indices);
    }
}

/* Attributes of one instance serve all that is drawn. */
static void submit_grid(gtx_submission *s, const gtx_frame_draw *draw)
{
    const gtx_gl *gl = &s->renderer->gl;
    const gl_uint all = 1u << 30;
    gtx_grid_stream_begin(s->renderer, draw);
    if (draw->vertex_data)
        set_instances(s->renderer, draw->first_instance, all);
    gl->DrawRangeElements(GL_TRIANGLES, 0, draw->ranges->vertex_count - 1,
                          (gl_size)draw->ranges->count, GL_UNSIGNED_INT, gtx_gl_offset(0));
    gl->BindVertexArray(s->renderer->vertex_array);
}

/* A block each instance. */
static void submit_blocks(gtx_submission *s, const gtx_frame_draw *draw)
{
    const gtx_gl *gl = &s->renderer->gl;
    const gl_uint all = 1u << 30;
    gtx_block_stream_begin(s->renderer, draw);
    set_instances(s->renderer, draw->first_instance, all);
    gl->DrawElementsInstanced(GL_TRIANGLES, (gl_size)draw->ranges->count, GL_UNSIGNED_SHORT,
                              gtx_gl_offset(0), (gl_size)draw->instance_count);
    gl->BindVertexArray(s->renderer->vertex_array);
}

void gtx_submit_draw(const gtx_frame_draw *draw, void *user)
{
    gtx_submission *s = user;
    const gtx_renderer *renderer = s->renderer;
    const gtx_technique technique = gtx_pipeline_technique(draw->pipeline);
    const bool depth = s->view->pass == GTX_PASS_DEPTH && technique == TECHNIQUE_LOD &&
                       draw->instance_count == 1;
    const bool single = depth || technique == TECHNIQUE_OWN_LOD_LIT;
    const gtx_instance_data *placed = &renderer->planner.instances[draw->first_instance];
    const gtx_program *program = program_of(s, draw, depth);
    if (!program->object)
        s->renderer->lacking |= 1u << (technique - TECHNIQUE_OWN_CAST);
    if (renderer->lacking)
        return;
    if (draw->model != s->model)
        bind_textures(&renderer->gl, draw->model);
    s->model = draw->model;
    use_program(s, program, draw->constants);
    cull(s, draw);
    if (s->view->flags & GTX_VIEW_BY_SAMPLES && renderer->gl.MinSampleShading)
        shade_samples(&renderer->gl, draw->vertices == GTX_BUFFER_PROXY_VERTICES);
    if (draw->tiles) {
        gtx_tile_stream_draw(s->renderer, s->program, draw);
    } else if (draw->vertices == GTX_BUFFER_BLOCKS) {
        submit_blocks(s, draw);
    } else if (draw->vertices == GTX_BUFFER_GRID_VERTICES) {
        submit_grid(s, draw);
    } else if (draw->vertices == GTX_BUFFER_LOD_VERTICES) {
        if (single)
            renderer->gl.Uniform4fv(s->program->place, 7, placed->world[0]);
        else
            set_instances(renderer, draw->first_instance, 1);
        set_lods(renderer, draw);
        draw_lods(&renderer->gl, draw, !single);
    } else {
        set_proxies(renderer, draw->model);
        set_instances(renderer, draw->first_instance, 1);
        draw_proxies(&renderer->gl, draw);
    }
}
