/* The boundary of triangles, in links between vertices: three bytes each, so that they fit where a
 * decoder will put positions. After the active boundary of Touma and Gotsman 1998, but that nothing
 * depends on it being one: triangles may touch in any way. */
#include "asset/boundary.h"

#include <string.h>

enum { AFTER = 0, BEFORE = 3 };

static uint32_t load_link(const gtx_boundary *b, uint32_t vertex, size_t side)
{
    if (vertex >= b->vertices)
        return GTX_NO_NEIGHBOUR;
    const uint8_t *at = b->links + 6 * (size_t)vertex + side;
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16;
}

static void store_link(gtx_boundary *b, uint32_t vertex, size_t side, uint32_t to)
{
    uint8_t *at = b->links + 6 * (size_t)vertex + side;
    for (int k = 0; k < 3; ++k)
        at[k] = (uint8_t)(to >> 8 * k);
}

/* Either end is one of the vertices. */
static void link_ends(gtx_boundary *b, uint32_t from, uint32_t to, bool open)
{
    store_link(b, from, AFTER, open ? to : GTX_NO_NEIGHBOUR);
    store_link(b, to, BEFORE, open ? from : GTX_NO_NEIGHBOUR);
}

static void forget(gtx_boundary *b, uint32_t from, uint32_t to)
{
    for (uint32_t age = 0; age < b->count; ++age) {
        const gtx_boundary_edge *edge = gtx_boundary_latest(b, age);
        if (edge->from != from || edge->to != to)
            continue;
        for (uint32_t i = b->end - 1 - age; i + 1 < b->end; ++i)
            b->edges[i] = b->edges[i + 1];
        --b->count;
        --b->end;
        return;
    }
}

static void remember(gtx_boundary *b, gtx_boundary_edge edge)
{
    if (b->end == sizeof b->edges / sizeof *b->edges) {
        memcpy(b->edges, b->edges + b->end - b->count, b->count * sizeof *b->edges);
        b->end = b->count;
    }
    b->edges[b->end++] = edge;
    if (b->count < GTX_LATEST_EDGES)
        ++b->count;
}

void gtx_boundary_begin(gtx_boundary *b, uint8_t *links, uint32_t vertices)
{
    *b = (gtx_boundary){.links = links, .vertices = vertices};
    memset(links, 0xff, GTX_LINK_BYTES(vertices));
}

uint32_t gtx_boundary_after(const gtx_boundary *b, uint32_t vertex)
{
    return load_link(b, vertex, AFTER);
}

uint32_t gtx_boundary_before(const gtx_boundary *b, uint32_t vertex)
{
    return load_link(b, vertex, BEFORE);
}

void gtx_boundary_add(gtx_boundary *b, const uint32_t corner[3], bool joined)
{
    bool met[3];
    for (int k = 0; k < 3; ++k) {
        const uint32_t from = corner[k], to = corner[(k + 1) % 3];
        if (from >= b->vertices || to >= b->vertices)
            return;
        met[k] = gtx_boundary_after(b, from) == to;
    }
    for (int k = 0; k < 3; ++k)
        if (met[k])
            link_ends(b, corner[k], corner[(k + 1) % 3], false);
    for (int k = 0; k < 3; ++k) {
        const uint32_t from = corner[k], to = corner[(k + 1) % 3];
        if (met[k] || (joined && k == 0)) {
            forget(b, from, to);
            continue;
        }
        link_ends(b, to, from, true);
        remember(b, (gtx_boundary_edge){to, from, corner[(k + 2) % 3]});
    }
}
