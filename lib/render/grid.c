/* Displaced grids in OpenGL: streams of vertices and of triangles. */
#include "render/renderer.h"

void gtx_grid_stream_create(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_grid_stream *g = &renderer->grid_stream;
    gl->GenVertexArrays(1, &g->vertex_array);
    gl->BindVertexArray(g->vertex_array);
    gtx_gl_label(gl, GL_VERTEX_ARRAY, g->vertex_array, "geotex grids");
    gl->GenBuffers(1, &g->vertex_buffer);
    gl->GenBuffers(1, &g->index_buffer);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, g->index_buffer);
    gtx_gl_label(gl, GL_BUFFER, g->index_buffer, "geotex grid triangles");
    gl->BindBuffer(GL_ARRAY_BUFFER, g->vertex_buffer);
    gtx_gl_label(gl, GL_BUFFER, g->vertex_buffer, "geotex grid vertices");
    const gl_size size = sizeof(gtx_grid_vertex);
    gl->VertexAttribIPointer(0, 4, GL_UNSIGNED_SHORT, size, NULL);
    gl->VertexAttribIPointer(1, 1, GL_UNSIGNED_INT, size,
                             gtx_gl_offset(offsetof(gtx_grid_vertex, patch)));
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
    gl->BindVertexArray(0);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
}

void gtx_grid_stream_destroy(gtx_renderer *renderer)
{
    gtx_grid_stream *g = &renderer->grid_stream;
    renderer->gl.DeleteVertexArrays(1, &g->vertex_array);
    renderer->gl.DeleteBuffers(1, &g->vertex_buffer);
    renderer->gl.DeleteBuffers(1, &g->index_buffer);
}

void gtx_grid_stream_begin(gtx_renderer *renderer, const gtx_frame_draw *draw)
{
    const gtx_gl *gl = &renderer->gl;
    gl->BindVertexArray(renderer->grid_stream.vertex_array);
    if (draw->vertex_data) {
        gl->BindBuffer(GL_ARRAY_BUFFER, renderer->grid_stream.vertex_buffer);
        gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)draw->vertex_bytes, draw->vertex_data,
                       GL_STREAM_DRAW);
    }
    gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, (gl_pointer)draw->index_bytes, draw->index_data,
                   GL_STREAM_DRAW);
}
