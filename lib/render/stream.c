/* Casting by tiles in OpenGL: its memory and objects, the upload of its stream, and the draw. */
#include "render/renderer.h"
#include "frame/units.h"

void gtx_tile_stream_create(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_tile_stream *t = &renderer->tile_stream;
    gl_int most = 0;
    if (!gl->TexBuffer)
        return;
    gl->GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    /* Halves of texels are counted, in ints. */
    renderer->planner.tiles.max_texels = most > 1 << 29 ? 1u << 29 : (uint32_t)most;
    gl->GenVertexArrays(1, &t->vertex_array);
    gl->BindVertexArray(t->vertex_array);
    gtx_gl_label(gl, GL_VERTEX_ARRAY, t->vertex_array, "geotex tile corners");
    gl->GenBuffers(1, &t->corner_buffer);
    gl->BindBuffer(GL_ARRAY_BUFFER, t->corner_buffer);
    gtx_gl_label(gl, GL_BUFFER, t->corner_buffer, "geotex tile corners");
    gl->VertexAttribPointer(0, 2, GL_UNSIGNED_SHORT, GL_FALSE, 0, NULL);
    gl->EnableVertexAttribArray(0);
    gl->BindVertexArray(0);
    gl->GenBuffers(1, &t->buffer);
    gl->GenTextures(1, &t->texture);
    gl->BindBuffer(GL_ARRAY_BUFFER, t->buffer);
    gtx_gl_label(gl, GL_BUFFER, t->buffer, "geotex tiles");
    gl->BindTexture(GL_TEXTURE_BUFFER, t->texture);
    gtx_gl_label(gl, GL_TEXTURE, t->texture, "geotex tiles");
    gl->TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32UI, t->buffer);
    gl->BindTexture(GL_TEXTURE_BUFFER, 0);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
}

void gtx_tile_stream_destroy(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_tile_stream *t = &renderer->tile_stream;
    if (!t->vertex_array)
        return;
    gl->DeleteVertexArrays(1, &t->vertex_array);
    gl->DeleteBuffers(1, &t->corner_buffer);
    gl->DeleteBuffers(1, &t->buffer);
    gl->DeleteTextures(1, &t->texture);
}

/* Uploads the parts of the stream, one after the other. */
static void send(const gtx_gl *gl, gl_uint buffer, const gtx_tiles *t)
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
    gl->BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl->BufferData(GL_ARRAY_BUFFER, at, NULL, GL_STREAM_DRAW);
    at = 0;
    for (int i = 0; i < 4; ++i) {
        const gl_pointer size = 16 * (gl_pointer)parts[i].texels;
        gl->BufferSubData(GL_ARRAY_BUFFER, at, size, parts[i].data);
        at += size;
    }
}

void gtx_tile_stream_draw(gtx_renderer *renderer, const gtx_program *program,
                          const gtx_instance_data *placed)
{
    const gtx_gl *gl = &renderer->gl;
    const gtx_tile_stream *stream = &renderer->tile_stream;
    const gtx_tiles *t = &renderer->planner.tiles;
    send(gl, stream->buffer, t);
    gl->BindBuffer(GL_ARRAY_BUFFER, stream->corner_buffer);
    gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)t->corner_count * 4, t->corners.data,
                   GL_STREAM_DRAW);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_STREAM);
    gl->BindTexture(GL_TEXTURE_BUFFER, stream->texture);
    gl->Uniform4fv(program->place, GTX_PLACE_ROWS, t->place[0]);
    gl->Uniform4fv(program->tint, 1, placed->tint);
    gl->Uniform1ui(program->instance, placed->id);
    gl->BindVertexArray(stream->vertex_array);
    gl->DrawArrays(GL_TRIANGLES, 0, (gl_size)t->corner_count);
    gl->BindVertexArray(renderer->vertex_array);
}
