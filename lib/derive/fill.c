/* Extrapolates heights beyond a height field, so that triangles over several of its cells can end
 * there. */
#include "derive/derive.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

/* A patch's codes while they grow. */
typedef struct growth {
    uint16_t *code;
    int32_t width, height;
    uint32_t *ring, *next;    /* texels that get their code now; and after that */
    uint8_t *waiting;         /* of each texel: it is in a ring */
} growth;

static bool is_within(const growth *g, int32_t x, int32_t y)
{
    return x >= 0 && y >= 0 && x < g->width && y < g->height;
}

static const int8_t around[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0},
                                    {1, 0},   {-1, 1}, {0, 1},  {1, 1}};

/* The mean of what lines through two texels, or one, say of the texel beyond. */
static uint16_t continued(const growth *g, uint32_t at, uint32_t most)
{
    const int32_t x = (int32_t)at % g->width, y = (int32_t)at / g->width;
    int64_t sum = 0, count = 0;
    for (int k = 0; k < 8; ++k) {
        const int32_t dx = around[k][0], dy = around[k][1];
        if (!is_within(g, x + dx, y + dy))
            continue;
        const int64_t one = g->code[(y + dy) * g->width + x + dx];
        const int64_t two = is_within(g, x + 2 * dx, y + 2 * dy)
                                ? g->code[(y + 2 * dy) * g->width + x + 2 * dx] : 0;
        sum += one ? two ? 2 * one - two : one : 0;
        count += one != 0;
    }
    const int64_t mean = count ? (sum + count / 2) / count : 1;
    return (uint16_t)(mean < 1 ? 1 : mean > most ? most : mean);
}

static uint32_t add_around(const growth *g, uint32_t at, uint32_t *ring, uint32_t count)
{
    const int32_t x = (int32_t)at % g->width, y = (int32_t)at / g->width;
    for (int k = 0; k < 8; ++k) {
        const int32_t i = x + around[k][0], j = y + around[k][1];
        if (!is_within(g, i, j) || g->code[j * g->width + i] || g->waiting[j * g->width + i])
            continue;
        g->waiting[j * g->width + i] = 1;
        ring[count++] = (uint32_t)(j * g->width + i);
    }
    return count;
}

/* A ring's codes follow from those inside it alone. */
static void grow(growth *g, uint16_t *room, uint32_t most)
{
    const uint32_t texels = (uint32_t)(g->width * g->height);
    uint32_t count = 0;
    for (uint32_t t = 0; t < texels; ++t)
        if (g->code[t])
            count = add_around(g, t, g->ring, count);
    for (int ring = 0; ring < GTX_SLAB_CELLS && count; ++ring) {
        uint32_t more = 0;
        for (uint32_t i = 0; i < count; ++i)
            room[i] = continued(g, g->ring[i], most);
        for (uint32_t i = 0; i < count; ++i)
            g->code[g->ring[i]] = room[i];
        for (uint32_t i = 0; i < count; ++i)
            more = add_around(g, g->ring[i], g->next, more);
        uint32_t *const done = g->ring;
        g->ring = g->next;
        g->next = done;
        count = more;
    }
}

gtx_result gtx_grid_fill(const gtx_grid *finest, uint32_t height_bits,
                         const gtx_allocator *hooks, uint16_t **out, gtx_error *error)
{
    const size_t texels = (size_t)finest->nodes_x * finest->nodes_y;
    uint32_t *rings = gtx_alloc_raw(hooks, texels, 2 * sizeof *rings);
    uint16_t *room = gtx_alloc_raw(hooks, texels, sizeof *room);
    growth g = {.code = gtx_alloc_raw(hooks, texels, sizeof *g.code),
                .width = (int32_t)finest->nodes_x, .height = (int32_t)finest->nodes_y,
                .waiting = gtx_alloc_array(hooks, texels, 1)};
    const bool made = rings && room && g.code && g.waiting;
    if (made) {
        g.ring = rings;
        g.next = rings + texels;
        memcpy(g.code, finest->code, texels * sizeof *g.code);
        grow(&g, room, height_bits == 8 ? UINT8_MAX : UINT16_MAX);
    }
    gtx_free_array(hooks, rings, texels, 2 * sizeof *rings);
    gtx_free_array(hooks, room, texels, sizeof *room);
    gtx_free_array(hooks, g.waiting, texels, 1);
    if (!made) {
        gtx_free_array(hooks, g.code, texels, sizeof *g.code);
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the heights around a patch");
    }
    *out = g.code;
    return GTX_OK;
}
