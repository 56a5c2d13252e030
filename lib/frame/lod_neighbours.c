/* Which patches of an LOD mesh meet: those that share a vertex. */
#include "frame/lod.h"

#include "base/alloc.h"

/* Of hostile assets, in which everything meets in a point, not all that meets is found. */
enum { MAX_NEIGHBOURS = 64, MAX_AT_VERTEX = 16 };

/* A patch at a vertex, and the one met before it: a list a vertex. */
typedef struct meeting {
    uint32_t patch, before;   /* before: one more than its place, 0: none */
} meeting;

typedef struct search {
    const gtx_lod_mesh *source;
    uint32_t patch_count;
    uint32_t *last;           /* of each vertex, one more than the place of the latest meeting */
    meeting *meetings;
    uint32_t *found;          /* of each patch, one more than the patch that it was found for */
    uint32_t *count;          /* of each patch's neighbours */
} search;

static void join(const search *s, uint32_t a, uint32_t b, const uint32_t *first, uint32_t *out)
{
    if (s->found[a] == b + 1 || s->count[a] == MAX_NEIGHBOURS || s->count[b] == MAX_NEIGHBOURS)
        return;
    s->found[a] = b + 1;
    if (out) {
        out[first[a] + s->count[a]] = b;
        out[first[b] + s->count[b]] = a;
    }
    ++s->count[a];
    ++s->count[b];
}

/* Counts the neighbours of each patch or, where there is room for them, writes them. */
static void find(const search *s, const uint32_t *first, uint32_t *out)
{
    uint32_t met = 0;
    for (uint32_t v = 0; v < s->source->vertex_count; ++v)
        s->last[v] = 0;
    for (uint32_t p = 0; p < s->patch_count; ++p)
        s->found[p] = s->count[p] = 0;
    for (uint32_t p = 0; p < s->patch_count; ++p) {
        const uint32_t *of = &s->source->first[p];
        for (uint64_t c = 3 * (uint64_t)of[0]; c < 3 * (uint64_t)of[1]; ++c) {
            uint32_t *last = &s->last[s->source->indices[c]];
            if (*last && s->meetings[*last - 1].patch == p)
                continue;
            uint32_t at = *last;
            for (int k = 0; at && k < MAX_AT_VERTEX; ++k, at = s->meetings[at - 1].before)
                join(s, s->meetings[at - 1].patch, p, first, out);
            s->meetings[met] = (meeting){p, *last};
            *last = ++met;
        }
    }
}

bool gtx_lod_find_neighbours(const gtx_lod_mesh *source, uint32_t meetings,
                             const gtx_allocator *allocator, gtx_lod_meshes *out)
{
    const uint32_t patches = out->patch_count;
    search s = {source, patches,
                gtx_alloc_raw(allocator, source->vertex_count, sizeof *s.last),
                gtx_alloc_raw(allocator, meetings, sizeof *s.meetings),
                gtx_alloc_raw(allocator, patches, sizeof *s.found),
                gtx_alloc_raw(allocator, patches, sizeof *s.count)};
    out->first_neighbour =
        gtx_alloc_array(allocator, patches + 1, sizeof *out->first_neighbour);
    bool made = s.last && s.meetings && s.found && s.count && out->first_neighbour;
    if (made) {
        find(&s, NULL, NULL);
        for (uint32_t p = 0; p < patches; ++p)
            out->first_neighbour[p + 1] = out->first_neighbour[p] + s.count[p];
        out->neighbour_count = out->first_neighbour[patches];
        out->neighbours =
            gtx_alloc_raw(allocator, out->neighbour_count, sizeof *out->neighbours);
        made = out->neighbours || !out->neighbour_count;
    }
    if (made)
        find(&s, out->first_neighbour, out->neighbours);
    gtx_free_array(allocator, s.last, source->vertex_count, sizeof *s.last);
    gtx_free_array(allocator, s.meetings, meetings, sizeof *s.meetings);
    gtx_free_array(allocator, s.found, patches, sizeof *s.found);
    gtx_free_array(allocator, s.count, patches, sizeof *s.count);
    return made;
}
