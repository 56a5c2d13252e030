/* What is drawn of a level of the LOD mesh, as ranges of its indices. */
#include "frame/lod.h"

/* Of triangles first..last - 1, a range a run. Returns how many ranges there are then. */
static uint32_t add_ranges(const gtx_lod_level *level, uint32_t first, uint32_t last,
                           gtx_range *ranges, uint32_t count)
{
    uint32_t start = 0;
    for (uint32_t r = 0; r < level->run_count; start = level->runs[r++].end) {
        const gtx_lod_run *run = &level->runs[r];
        const uint32_t from = first > start ? first : start, to = last < run->end ? last : run->end;
        if (from < to)
            ranges[count++] = (gtx_range){.first = 3 * from, .count = 3 * (to - from),
                                          .base_vertex = run->first_vertex,
                                          .vertex_count = run->vertex_count};
    }
    return count;
}

/* What of patch order[i] is drawn. */
static gtx_lod_part part_of(const gtx_lod_meshes *lods, const uint8_t *parts, uint32_t i)
{
    const uint32_t patch = lods->order[i];
    if (parts)
        return (gtx_lod_part)parts[patch];
    return lods->edited[patch] ? GTX_LOD_NOTHING : GTX_LOD_ALL;
}

uint32_t gtx_lod_ranges(const gtx_lod_meshes *lods, uint32_t level, bool two_sided,
                        const uint8_t *parts, gtx_range *ranges)
{
    const gtx_lod_level *l = &lods->levels[level];
    const uint32_t begin = two_sided ? lods->one_sided : 0;
    const uint32_t end = two_sided ? lods->patch_count : lods->one_sided;
    uint32_t from = l->first[begin], to = from; /* triangles wanted and not told yet */
    uint32_t count = 0;
    for (uint32_t i = begin; i < end; ++i) {
        const gtx_lod_part part = part_of(lods, parts, i);
        const uint32_t first = part == GTX_LOD_ALL      ? l->first[i]
                               : part == GTX_LOD_BORDER ? l->border[i]
                                                        : l->first[i + 1];
        if (first > to) {
            count = add_ranges(l, from, to, ranges, count);
            from = first;
        }
        to = l->first[i + 1];
    }
    return add_ranges(l, from, to, ranges, count);
}
