/* Proxies: memory for them, and the boxes around the solid cells of a patch. */
#include "derive/codes.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

/* Texels and codes of the solid cells of a patch, both ends included; none when max[0] is 0. */
typedef struct extent {
    uint32_t min[3], max[3];
} extent;

static extent solid_extent(const gtx_grid *g)
{
    extent e = {{0, 0, 0}, {0, 0, 0}};
    if (!gtx_solid_extent(g, e.min, e.max))
        return e;
    /* Coarse nodes take the codes of texels, with a cell or not, or their means. */
    uint16_t most = 0, least = UINT16_MAX; /* of one less than each code, an empty one wraps */
    for (size_t n = 0; n < (size_t)g->nodes_x * g->nodes_y; ++n) {
        const uint16_t code = g->code[n], wrapped = (uint16_t)(code - 1);
        most = code > most ? code : most;
        least = wrapped < least ? wrapped : least;
    }
    e.min[2] = least + 1u;
    e.max[2] = most;
    return e;
}

/* Vertex k takes the far side along axis a where bit a of k is set; triangles are
 * counter-clockwise seen from outside. */
static void append_box(gtx_proxies *out, uint32_t patch, const extent *e, float grow)
{
    static const uint8_t corner[GTX_BOX_INDICES] = {
        0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, /* x- x+ */
        0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, /* y- y+ */
        0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6  /* z- z+ */
    };
    for (uint32_t k = 0; k < GTX_BOX_INDICES; ++k)
        out->indices[out->index_count++] = out->vertex_count + corner[k];
    for (uint32_t k = 0; k < GTX_BOX_VERTICES; ++k) {
        float p[3] = {0, 0, 0};
        for (int a = 0; a < 3 && e->max[0] > 0; ++a)
            p[a] = k >> a & 1 ? (float)e->max[a] + grow : (float)e->min[a] - grow;
        out->vertices[out->vertex_count++] = (gtx_proxy_vertex){p[0], p[1], p[2], patch};
    }
}

/* An array of more room with the same beginning; NULL without memory. */
static void *enlarge(void *old, size_t count, size_t room, size_t wanted, size_t size,
                     const gtx_allocator *hooks)
{
    void *grown = gtx_alloc_raw(hooks, wanted, size);
    if (grown && count)
        memcpy(grown, old, count * size);
    if (grown)
        gtx_free_array(hooks, old, room, size);
    return grown;
}

gtx_result gtx_proxies_reserve(gtx_proxies *p, size_t vertices, size_t indices,
                               const gtx_allocator *allocator, gtx_error *error)
{
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    const size_t v = p->vertex_count + vertices, i = p->index_count + indices;
    bool made = v <= UINT32_MAX / 2 && i <= UINT32_MAX / 2;
    if (made && v > p->vertex_room) {
        const uint32_t room = (uint32_t)(v + v / 2);
        void *grown = enlarge(p->vertices, p->vertex_count, p->vertex_room, room,
                              sizeof *p->vertices, &hooks);
        made = grown != NULL;
        if (made) {
            p->vertices = grown;
            p->vertex_room = room;
        }
    }
    if (made && i > p->index_room) {
        const uint32_t room = (uint32_t)(i + i / 2);
        void *grown = enlarge(p->indices, p->index_count, p->index_room, room,
                              sizeof *p->indices, &hooks);
        made = grown != NULL;
        if (made) {
            p->indices = grown;
            p->index_room = room;
        }
    }
    return made ? GTX_OK : gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the proxies");
}

gtx_result gtx_add_box(uint32_t patch, const gtx_grid *finest, float grow,
                       const gtx_allocator *allocator, gtx_proxies *out, gtx_error *error)
{
    if (!finest || finest->level || !out || !(grow >= 0) || isinf(grow))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a box needs a patch's level 0 and a finite growth >= 0");
    gtx_result result =
        gtx_proxies_reserve(out, GTX_BOX_VERTICES, GTX_BOX_INDICES, allocator, error);
    if (!result) {
        const extent e = solid_extent(finest);
        append_box(out, patch, &e, grow);
    }
    return result;
}

void gtx_proxies_free(gtx_proxies *proxies, const gtx_allocator *allocator)
{
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    gtx_free_array(&hooks, proxies->vertices, proxies->vertex_room, sizeof *proxies->vertices);
    gtx_free_array(&hooks, proxies->indices, proxies->index_room, sizeof *proxies->indices);
    *proxies = (gtx_proxies){0};
}
