/* Displaced grids in OpenGL: patterns of triangles, an instance for each block. */
#include "render/grid.h"
#include "render/renderer.h"

/* All patterns, one after another. */
enum { CELLS = GTX_BLOCK_CELLS, MAX_NODES = 119, MAX_INDICES = 510 };

typedef struct patterns {
    uint8_t nodes[MAX_NODES][4];
    uint16_t indices[MAX_INDICES];
    uint16_t node_count, index_count;
} patterns;

/* Cells are cut from their own node to the one across, which gtx_grid_blocks counts on. */
static void add_pattern(patterns *p, uint32_t cells)
{
    const uint16_t row = (uint16_t)(cells + 1), first = p->node_count;
    for (uint32_t j = 0; j <= cells; ++j)
        for (uint32_t i = 0; i <= cells; ++i) {
            uint8_t *node = p->nodes[p->node_count++];
            node[0] = (uint8_t)i;
            node[1] = (uint8_t)j;
        }
    for (uint32_t j = 0; j < cells; ++j)
        for (uint32_t i = 0; i < cells; ++i) {
            const uint16_t own = (uint16_t)(first + j * row + i), right = own + 1;
            const uint16_t above = own + row, across = above + 1;
            const uint16_t corners[6] = {right, across, own, across, above, own};
            for (int c = 0; c < 6; ++c)
                p->indices[p->index_count++] = corners[c];
        }
}

static void send_patterns(const gtx_gl *gl)
{
    patterns p = {.node_count = 0};
    for (uint32_t k = 0; k < GTX_GRID_PATTERNS; ++k)
        add_pattern(&p, CELLS >> k);
    gl->BufferData(GL_ARRAY_BUFFER, sizeof p.nodes, p.nodes, GL_STATIC_DRAW);
    gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof p.indices, p.indices, GL_STATIC_DRAW);
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
    send_patterns(gl);
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
    gtx_scratch_free(&renderer->allocator, &g->strides);
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
    size_t indices = 0;
    for (uint32_t k = 0; k < kind % GTX_GRID_PATTERNS; ++k)
        indices += 3 * gtx_pattern_triangles(k);
    const uint32_t triangles = gtx_pattern_triangles(kind % GTX_GRID_PATTERNS);
    gl->BindBuffer(GL_ARRAY_BUFFER, g->stream);
    gl->VertexAttribIPointer(1, 2, GL_UNSIGNED_INT, sizeof(gtx_block),
                             gtx_gl_offset(first * sizeof(gtx_block)));
    gl->DrawElementsInstanced(GL_TRIANGLES, (gl_size)(3 * triangles), GL_UNSIGNED_SHORT,
                              gtx_gl_offset(indices * sizeof(uint16_t)),
                              (gl_size)g->counts[kind]);
    g->triangles += (uint64_t)g->counts[kind] * triangles;
}
