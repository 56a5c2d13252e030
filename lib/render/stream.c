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
    renderer->planner.tiles.max_texels = gtx_tiles_most((uint32_t)most);
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
static void send(const gtx_gl *gl, gl_uint buffer, const gtx_tile_draw *t)
{
    gl_pointer at = 0;
    for (int i = 0; i < GTX_TILE_PARTS; ++i)
        at += (gl_pointer)t->part_bytes[i];
    gl->BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl->BufferData(GL_ARRAY_BUFFER, at, NULL, GL_STREAM_DRAW);
    at = 0;
    for (int i = 0; i < GTX_TILE_PARTS; ++i) {
        gl->BufferSubData(GL_ARRAY_BUFFER, at, (gl_pointer)t->part_bytes[i], t->parts[i]);
        at += (gl_pointer)t->part_bytes[i];
    }
}

void gtx_tile_stream_draw(gtx_renderer *renderer, const gtx_program *program,
                          const gtx_frame_draw *draw)
{
    const gtx_gl *gl = &renderer->gl;
    const gtx_tile_stream *stream = &renderer->tile_stream;
    const gtx_tile_constants *c = draw->tiles->constants;
    send(gl, stream->buffer, draw->tiles);
    gl->BindBuffer(GL_ARRAY_BUFFER, stream->corner_buffer);
    gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)draw->vertex_bytes, draw->vertex_data,
                   GL_STREAM_DRAW);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_STREAM);
    gl->BindTexture(GL_TEXTURE_BUFFER, stream->texture);
    gl->Uniform4fv(program->place, GTX_TILE_ROWS, c->place[0]);
    gl->Uniform4fv(program->tint, 1, c->tint);
    gl->Uniform1ui(program->instance, c->id);
    gl->BindVertexArray(stream->vertex_array);
    gl->DrawArrays(GL_TRIANGLES, 0, (gl_size)draw->ranges->count);
    gl->BindVertexArray(renderer->vertex_array);
}
