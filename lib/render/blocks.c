/* Blocks that the GPU displaces, in OpenGL: a grid of nodes that all share, drawn once a block. */
#include "render/renderer.h"

enum { SIDE = GTX_SLAB_CELLS + 1, INDICES = 3 * GTX_BLOCK_TRIANGLES };

static void fill_corners(const gtx_gl *gl)
{
    uint8_t corners[SIDE * SIDE][4] = {{0}};
    for (uint32_t i = 0; i < SIDE * SIDE; ++i) {
        corners[i][0] = (uint8_t)(i % SIDE);
        corners[i][1] = (uint8_t)(i / SIDE);
    }
    gl->BufferData(GL_ARRAY_BUFFER, sizeof corners, corners, GL_STATIC_DRAW);
}

/* Counterclockwise from above the height field. */
static void fill_indices(const gtx_gl *gl)
{
    uint16_t indices[INDICES];
    for (uint32_t c = 0; c < GTX_SLAB_CELLS * GTX_SLAB_CELLS; ++c) {
        const uint32_t a = c / GTX_SLAB_CELLS * SIDE + c % GTX_SLAB_CELLS;
        const uint32_t corners[6] = {a, a + 1, a + SIDE, a + SIDE, a + 1, a + SIDE + 1};
        for (int k = 0; k < 6; ++k)
            indices[6 * c + k] = (uint16_t)corners[k];
    }
    gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof indices, indices, GL_STATIC_DRAW);
}

static void create(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_block_stream *b = &renderer->block_stream;
    gl->GenVertexArrays(1, &b->vertex_array);
    gl->BindVertexArray(b->vertex_array);
    gtx_gl_label(gl, GL_VERTEX_ARRAY, b->vertex_array, "geotex blocks");
    gl->GenBuffers(1, &b->index_buffer);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, b->index_buffer);
    gtx_gl_label(gl, GL_BUFFER, b->index_buffer, "geotex block triangles");
    fill_indices(gl);
    gl->GenBuffers(1, &b->corner_buffer);
    gl->BindBuffer(GL_ARRAY_BUFFER, b->corner_buffer);
    gtx_gl_label(gl, GL_BUFFER, b->corner_buffer, "geotex block corners");
    fill_corners(gl);
    gl->VertexAttribIPointer(0, 2, GL_UNSIGNED_BYTE, 4, NULL);
    gl->EnableVertexAttribArray(0);
    gl->GenBuffers(1, &b->buffer);
    gl->BindBuffer(GL_ARRAY_BUFFER, b->buffer);
    gtx_gl_label(gl, GL_BUFFER, b->buffer, "geotex blocks");
    gl->VertexAttribIPointer(1, 2, GL_UNSIGNED_INT, sizeof(gtx_displaced_block), NULL);
    gl->VertexAttribDivisor(1, 1);
    gl->EnableVertexAttribArray(1);
}

void gtx_block_stream_begin(gtx_renderer *renderer, const gtx_frame_draw *draw)
{
    const gtx_gl *gl = &renderer->gl;
    if (!renderer->block_stream.vertex_array)
        create(renderer);
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
    renderer->gl.DeleteBuffers(1, &b->corner_buffer);
    renderer->gl.DeleteBuffers(1, &b->index_buffer);
    renderer->gl.DeleteBuffers(1, &b->buffer);
}
