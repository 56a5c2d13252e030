/* geotex through a render hardware interface: what uploads a model, and submits a draw. Only these
 * functions know both. */
#ifndef RHI_SUBMIT_H
#define RHI_SUBMIT_H

#include "rhi.h"

#include <geotex/frame.h>
#include <stdbool.h>

typedef struct rhi_model {
    GLuint textures[GTX_SLOT_COUNT], is_array[GTX_SLOT_COUNT];
    GLuint buffers[GTX_BUFFER_GRID_VERTICES];
} rhi_model;

typedef struct rhi_frames {
    rhi r;
    /* Which is a gtx_model's: here all models that draws name are this one. */
    rhi_model *model;
    GLuint instances, constants, grid[2];
    GLuint pipelines[GTX_PIPELINE_COUNT]; /* made when they are first drawn by */
} rhi_frames;

static inline void rhi_upload(const rhi *r, gtx_model *model, rhi_model *out)
{
    static const rhi_format formats[] = {
        [GTX_FORMAT_R8] = RHI_R8, [GTX_FORMAT_RG8] = RHI_RG8, [GTX_FORMAT_RGBA8] = RHI_RGBA8,
        [GTX_FORMAT_RGB8_SRGB] = RHI_RGB8_SRGB, [GTX_FORMAT_RGBA8_SRGB] = RHI_RGBA8_SRGB,
        [GTX_FORMAT_R8_UINT] = RHI_R8_UINT, [GTX_FORMAT_R16_UINT] = RHI_R16_UINT,
        [GTX_FORMAT_RGBA32_FLOAT] = RHI_RGBA32_FLOAT};
    for (int slot = 0; slot < GTX_SLOT_COUNT; ++slot) {
        gtx_texture t;
        if (!gtx_model_texture(model, (gtx_slot)slot, &t))
            continue;
        out->is_array[slot] = t.is_array;
        out->textures[slot] =
            rhi_texture(r, &(rhi_texture_desc){formats[t.format], t.width, t.height, t.layers,
                                               t.levels, t.is_array, t.is_filtered, t.texels});
    }
    for (int b = 0; b < GTX_BUFFER_GRID_VERTICES; ++b) {
        uint64_t size;
        const void *data = gtx_model_buffer(model, (gtx_buffer)b, &size);
        rhi_fill(r, &out->buffers[b], data, size);
    }
    gtx_model_uploaded(model);
}

static inline GLuint rhi_pipeline(const rhi *r, uint32_t number)
{
    const char *texts[2][2 + GTX_MAX_SHADER_TEXTS] = {{0}};
    uint32_t counts[2];
    for (int k = 0; k < 2; ++k) {
        texts[k][0] = "#version 420 core\n";
        texts[k][1] = "#define GTX_RHI\n";
        counts[k] =
            2 + gtx_pipeline_source(number, (gtx_stage)k, NULL, texts[k] + 2);
    }
    return rhi_program(r, texts[0], counts[0], texts[1], counts[1]);
}

static inline void rhi_bind_vertices(const rhi *r, GLuint vertices, GLuint instances,
                                     const gtx_frame_draw *d)
{
    const GLsizei size = (GLsizei)d->vertex_size;
    if (d->vertices == GTX_BUFFER_PROXY_VERTICES)
        rhi_attribute(r, 0, vertices, 3, GL_FLOAT, size, d->vertex_offset, 0);
    else
        rhi_attribute(r, 0, vertices, 4, GL_UNSIGNED_SHORT, size, d->vertex_offset, 0);
    if (size == 8)
        rhi_attribute(r, 1, vertices, 1, GL_UNSIGNED_SHORT, size, d->vertex_offset + 6, 0);
    else
        rhi_attribute(r, 1, vertices, 1, GL_UNSIGNED_INT, size,
                      d->vertex_offset + d->vertex_size - 4, 0);
    const uint64_t first = d->first_instance * sizeof(gtx_instance_data);
    for (GLuint k = 0; k < 7; ++k)
        rhi_attribute(r, 2 + k, instances, 4, GL_FLOAT, sizeof(gtx_instance_data),
                      first + 16 * (uint64_t)k, 1);
    rhi_attribute(r, 9, instances, 1, GL_UNSIGNED_INT, sizeof(gtx_instance_data),
                  first + offsetof(gtx_instance_data, id), 1);
}

/* A gtx_submit; `user` is rhi_frames. */
static inline void rhi_submit(const gtx_frame_draw *d, void *user)
{
    rhi_frames *f = user;
    const rhi *r = &f->r;
    const bool is_grid = d->vertices == GTX_BUFFER_GRID_VERTICES;
    if (!f->pipelines[d->pipeline])
        f->pipelines[d->pipeline] = rhi_pipeline(r, d->pipeline);
    if (d->vertex_data)
        rhi_fill(r, &f->grid[0], d->vertex_data, d->vertex_bytes);
    if (d->index_data)
        rhi_fill(r, &f->grid[1], d->index_data, d->index_bytes);
    rhi_fill(r, &f->constants, d->constants, sizeof *d->constants);
    for (GLuint slot = 0; slot < GTX_SLOT_COUNT; ++slot) {
        r->ActiveTexture(GL_TEXTURE0 + slot);
        r->BindTexture(f->model->is_array[slot] ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D,
                       f->model->textures[slot]);
    }
    r->UseProgram(f->pipelines[d->pipeline]);
    r->BindBufferBase(GL_UNIFORM_BUFFER, 8, f->constants);
    (d->cull == GTX_CULL_NONE ? r->Disable : r->Enable)(GL_CULL_FACE);
    r->CullFace(d->cull == GTX_CULL_FRONT ? GL_FRONT : GL_BACK);
    r->FrontFace(d->clockwise ? GL_CW : GL_CCW);
    r->BindVertexArray(r->vertex_array);
    rhi_bind_vertices(r, is_grid ? f->grid[0] : f->model->buffers[d->vertices], f->instances, d);
    r->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, is_grid ? f->grid[1] : f->model->buffers[d->indices]);
    for (const gtx_range *range = d->ranges; range < d->ranges + d->range_count; ++range)
        r->DrawElementsInstancedBaseVertex(
            GL_TRIANGLES, (GLsizei)range->count,
            d->index_size == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT,
            (const void *)(uintptr_t)(d->index_offset + range->first * (uint64_t)d->index_size),
            (GLsizei)d->instance_count, (GLint)range->base_vertex);
}

#endif
