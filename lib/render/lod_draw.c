/* Drawing a level of the LOD mesh, or what is wanted of it. */
#include "render/run.h"

/* Triangles of a run. */
static void draw_run(const gtx_gl *gl, const gtx_lod_level *level, const gtx_lod_run *run,
                     uint32_t first, uint32_t last, uint32_t instances)
{
    const gl_enum type = level->index_size == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
    const gl_size count = (gl_size)(3 * (last - first));
    const void *indices =
        gtx_gl_offset(level->index_offset + 3 * (uint64_t)first * level->index_size);
    const uint64_t vertex =
        level->vertex_offset + run->first_vertex * (uint64_t)sizeof(gtx_lod_vertex);
    gl->VertexAttribPointer(0, 3, GL_UNSIGNED_SHORT, GL_FALSE, sizeof(gtx_lod_vertex),
                            gtx_gl_offset(vertex));
    gl->VertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(gtx_lod_vertex),
                             gtx_gl_offset(vertex + offsetof(gtx_lod_vertex, patch)));
    if (instances)
        gl->DrawElementsInstanced(GL_TRIANGLES, count, type, indices, (gl_size)instances);
    else
        gl->DrawRangeElements(GL_TRIANGLES, 0, run->vertex_count - 1, count, type, indices);
}

static void draw_range(const gtx_gl *gl, const gtx_lod_level *level, uint32_t first,
                       uint32_t last, uint32_t instances)
{
    uint32_t start = 0;
    for (uint32_t r = 0; r < level->run_count; start = level->runs[r++].end) {
        const gtx_lod_run *run = &level->runs[r];
        const uint32_t from = first > start ? first : start, to = last < run->end ? last : run->end;
        if (from < to)
            draw_run(gl, level, run, from, to, instances);
    }
}

/* What of patch order[i] is drawn. */
static gtx_lod_part part_of(const gtx_lod_meshes *lods, const uint8_t *parts, uint32_t i)
{
    const uint32_t patch = lods->order[i];
    if (parts)
        return (gtx_lod_part)parts[patch];
    return lods->edited[patch] ? GTX_LOD_NOTHING : GTX_LOD_ALL;
}

void gtx_lod_draw(const gtx_gl *gl, const gtx_lod_meshes *lods, uint32_t level, bool two_sided,
                  uint32_t instances, const uint8_t *parts)
{
    const gtx_lod_level *l = &lods->levels[level];
    const uint32_t begin = two_sided ? lods->one_sided : 0;
    const uint32_t end = two_sided ? lods->patch_count : lods->one_sided;
    gl->BindBuffer(GL_ARRAY_BUFFER, lods->vertex_buffer);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, lods->index_buffer);
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
    uint32_t from = l->first[begin], to = from; /* triangles wanted and not drawn yet */
    for (uint32_t i = begin; i < end; ++i) {
        const gtx_lod_part part = part_of(lods, parts, i);
        const uint32_t first = part == GTX_LOD_ALL      ? l->first[i]
                               : part == GTX_LOD_BORDER ? l->border[i]
                                                        : l->first[i + 1];
        if (first > to) {
            draw_range(gl, l, from, to, instances);
            from = first;
        }
        to = l->first[i + 1];
    }
    draw_range(gl, l, from, to, instances);
}
