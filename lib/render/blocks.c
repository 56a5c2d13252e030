/* Blocks that the GPU displaces, in OpenGL: triangles that all share, drawn once a block. */
#include "render/renderer.h"

static void create(gtx_renderer *renderer, const gtx_frame_draw *draw)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_block_stream *b = &renderer->block_stream;
    gl->GenVertexArrays(1, &b->vertex_array);
    gl->BindVertexArray(b->vertex_array);
    gtx_gl_label(gl, GL_VERTEX_ARRAY, b->vertex_array, "geotex blocks");
    gl->GenBuffers(1, &b->index_buffer);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, b->index_buffer);
    gtx_gl_label(gl, GL_BUFFER, b->index_buffer, "geotex block triangles");
    gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, (gl_pointer)draw->index_bytes, draw->index_data,
                   GL_STATIC_DRAW);
    gl->GenBuffers(1, &b->buffer);
    gl->BindBuffer(GL_ARRAY_BUFFER, b->buffer);
    gtx_gl_label(gl, GL_BUFFER, b->buffer, "geotex blocks");
    gl->VertexAttribIPointer(0, 2, GL_UNSIGNED_INT, sizeof(gtx_displaced_block), NULL);
    gl->VertexAttribDivisor(0, 1);
    gl->EnableVertexAttribArray(0);
}

void gtx_block_stream_begin(gtx_renderer *renderer, const gtx_frame_draw *draw)
{
    const gtx_gl *gl = &renderer->gl;
    if (!renderer->block_stream.vertex_array)
        create(renderer, draw);
    gl->BindVertexArray(renderer->block_stream.vertex_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, renderer->block_stream.buffer);
    gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)draw->vertex_bytes, draw->vertex_data,
                   GL_STREAM_DRAW);
}

void gtx_block_stream_destroy(gtx_renderer *renderer)
{
    gtx_block_stream *b = &renderer->block_stream;
    if (!b->vertex_array)
        return;
    renderer->gl.DeleteVertexArrays(1, &b->vertex_array);
    renderer->gl.DeleteBuffers(1, &b->index_buffer);
    renderer->gl.DeleteBuffers(1, &b->buffer);
}
