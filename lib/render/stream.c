/* Casting by tiles in OpenGL: its memory and objects, the upload of its stream, and the draw. */
#include "render/renderer.h"
#include "render/units.h"

void gtx_tiles_free(gtx_renderer *renderer)
{
    gtx_tiles *t = &renderer->tiles;
    gtx_scratch *all[] = {&t->visible,    &t->order, &t->heads,  &t->records,
                          &t->slabs, &t->lists, &t->corners};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        gtx_scratch_free(&renderer->allocator, all[i]);
}

void gtx_tile_stream_create(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_tiles *t = &renderer->tiles;
    if (!gl->TexBuffer)
        return;
    gl->GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &t->max_texels);
    if (t->max_texels > 1 << 29) /* halves of texels are counted, in ints */
        t->max_texels = 1 << 29;
    gl->GenVertexArrays(1, &t->vertex_array);
    gl->BindVertexArray(t->vertex_array);
    gtx_gl_label(gl, GL_VERTEX_ARRAY, t->vertex_array, "geotex tile corners");
    gl->GenBuffers(1, &t->corner_buffer);
    gl->BindBuffer(GL_ARRAY_BUFFER, t->corner_buffer);
    gtx_gl_label(gl, GL_BUFFER, t->corner_buffer, "geotex tile corners");
    gl->VertexAttribPointer(0, 2, GL_UNSIGNED_SHORT, GL_FALSE, 0, NULL);
    gl->EnableVertexAttribArray(0);
    gl->BindVertexArray(0);
    gl->GenBuffers(1, &t->stream_buffer);
    gl->GenTextures(1, &t->stream_texture);
    gl->BindBuffer(GL_ARRAY_BUFFER, t->stream_buffer);
    gtx_gl_label(gl, GL_BUFFER, t->stream_buffer, "geotex tiles");
    gl->BindTexture(GL_TEXTURE_BUFFER, t->stream_texture);
    gtx_gl_label(gl, GL_TEXTURE, t->stream_texture, "geotex tiles");
    gl->TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32UI, t->stream_buffer);
    gl->BindTexture(GL_TEXTURE_BUFFER, 0);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
}

void gtx_tile_stream_destroy(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_tiles *t = &renderer->tiles;
    if (!t->vertex_array)
        return;
    gl->DeleteVertexArrays(1, &t->vertex_array);
    gl->DeleteBuffers(1, &t->corner_buffer);
    gl->DeleteBuffers(1, &t->stream_buffer);
    gl->DeleteTextures(1, &t->stream_texture);
}

bool gtx_tile_stream_suits(const gtx_renderer *renderer, const gtx_view *view)
{
    const uint32_t most = 65528; /* corners are counted in 16 bits */
    return renderer->gl.TexBuffer && !view->shading && view->method != GTX_METHOD_PAPER &&
           view->viewport_width > 0 && view->viewport_width <= most &&
           view->viewport_height > 0 && view->viewport_height <= most;
}

/* Uploads the parts of the stream, one after the other. */
static void send(const gtx_gl *gl, const gtx_tiles *t)
{
    const struct {
        const void *data;
        uint32_t texels;
    } parts[4] = {{t->records.data, t->record_texels},
                  {t->slabs.data, t->slab_texels},
                  {t->heads.data, t->head_texels},
                  {t->lists.data, t->list_texels}};
    gl_pointer at = 0;
    for (int i = 0; i < 4; ++i)
        at += 16 * (gl_pointer)parts[i].texels;
    gl->BindBuffer(GL_ARRAY_BUFFER, t->stream_buffer);
    gl->BufferData(GL_ARRAY_BUFFER, at, NULL, GL_STREAM_DRAW);
    at = 0;
    for (int i = 0; i < 4; ++i) {
        const gl_pointer size = 16 * (gl_pointer)parts[i].texels;
        gl->BufferSubData(GL_ARRAY_BUFFER, at, size, parts[i].data);
        at += size;
    }
}

void gtx_tile_stream_draw(const gtx_draw_call *draw, const gtx_instance_data *placed)
{
    const gtx_gl *gl = &draw->renderer->gl;
    gtx_tiles *t = &draw->renderer->tiles;
    send(gl, t);
    gl->BindBuffer(GL_ARRAY_BUFFER, t->corner_buffer);
    gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)t->corner_count * 4, t->corners.data,
                   GL_STREAM_DRAW);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_STREAM);
    gl->BindTexture(GL_TEXTURE_BUFFER, t->stream_texture);
    gl->Uniform4fv(draw->program->place, GTX_PLACE_ROWS, t->place[0]);
    gl->Uniform4fv(draw->program->tint, 1, placed->tint);
    gl->Uniform1ui(draw->program->instance, placed->id);
    gl->BindVertexArray(t->vertex_array);
    gl->Disable(GL_CULL_FACE);
    gl->DrawArrays(GL_TRIANGLES, 0, (gl_size)t->corner_count);
    gl->Enable(GL_CULL_FACE);
    ++t->draws;
}
