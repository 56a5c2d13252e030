/* Displaced grids in OpenGL: one pattern of triangles, an instance for each block. */
#include "render/grid.h"
#include "render/renderer.h"

enum {
    CELLS = GTX_SLAB_CELLS,
    NODES_A_ROW = CELLS + 1,
    INDICES = 3 * GTX_BLOCK_TRIANGLES
};

/* The last vertex of a cell's triangles, which tells what is flat, is the cell's own. */
static void send_pattern(const gtx_gl *gl)
{
    uint8_t nodes[NODES_A_ROW * NODES_A_ROW][4] = {{0}};
    uint16_t indices[INDICES], *next = indices;
    for (int j = 0; j < NODES_A_ROW; ++j)
        for (int i = 0; i < NODES_A_ROW; ++i) {
            nodes[j * NODES_A_ROW + i][0] = (uint8_t)i;
            nodes[j * NODES_A_ROW + i][1] = (uint8_t)j;
        }
    for (int j = 0; j < CELLS; ++j)
        for (int i = 0; i < CELLS; ++i) {
            const uint16_t own = (uint16_t)(j * NODES_A_ROW + i), right = own + 1;
            const uint16_t above = own + NODES_A_ROW, across = above + 1;
            const uint16_t corners[6] = {right, across, own, across, above, own};
            for (int c = 0; c < 6; ++c)
                *next++ = corners[c];
        }
    gl->BufferData(GL_ARRAY_BUFFER, sizeof nodes, nodes, GL_STATIC_DRAW);
    gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof indices, indices, GL_STATIC_DRAW);
}

void gtx_grids_create(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_grids *g = &renderer->grids;
    gl->GenVertexArrays(1, &g->vertex_array);
    gl->BindVertexArray(g->vertex_array);
    gtx_gl_label(gl, GL_VERTEX_ARRAY, g->vertex_array, "geotex grids");
    gl->GenBuffers(1, &g->nodes);
    gl->GenBuffers(1, &g->indices);
    gl->GenBuffers(1, &g->stream);
    gl->BindBuffer(GL_ARRAY_BUFFER, g->nodes);
    gtx_gl_label(gl, GL_BUFFER, g->nodes, "geotex grid nodes");
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, g->indices);
    gtx_gl_label(gl, GL_BUFFER, g->indices, "geotex grid indices");
    send_pattern(gl);
    gl->VertexAttribIPointer(0, 2, GL_UNSIGNED_BYTE, 4, NULL);
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
    gl->VertexAttribDivisor(1, 1);
    gl->BindBuffer(GL_ARRAY_BUFFER, g->stream);
    gtx_gl_label(gl, GL_BUFFER, g->stream, "geotex grid blocks");
    gl->BindVertexArray(0);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
}

void gtx_grids_destroy(gtx_renderer *renderer)
{
    gtx_grids *g = &renderer->grids;
    renderer->gl.DeleteVertexArrays(1, &g->vertex_array);
    renderer->gl.DeleteBuffers(1, &g->nodes);
    renderer->gl.DeleteBuffers(1, &g->indices);
    renderer->gl.DeleteBuffers(1, &g->stream);
    gtx_scratch_free(&renderer->allocator, &g->found);
    gtx_scratch_free(&renderer->allocator, &g->blocks);
}

void gtx_grids_begin(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_grids *g = &renderer->grids;
    size_t count = 0;
    for (int k = 0; k < GTX_BLOCK_KINDS; ++k)
        count += g->counts[k];
    gl->BindVertexArray(g->vertex_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, g->stream);
    gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)(count * sizeof(gtx_block)), g->blocks.data,
                   GL_STREAM_DRAW);
}

void gtx_grids_draw(gtx_renderer *renderer, uint32_t kind)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_grids *g = &renderer->grids;
    size_t first = 0;
    for (uint32_t k = 0; k < kind; ++k)
        first += g->counts[k];
    gl->BindBuffer(GL_ARRAY_BUFFER, g->stream);
    gl->VertexAttribIPointer(1, 2, GL_UNSIGNED_INT, sizeof(gtx_block),
                             gtx_gl_offset(first * sizeof(gtx_block)));
    gl->DrawElementsInstanced(GL_TRIANGLES, INDICES, GL_UNSIGNED_SHORT, NULL,
                              (gl_size)g->counts[kind]);
    g->triangles += (uint64_t)g->counts[kind] * GTX_BLOCK_TRIANGLES;
}
