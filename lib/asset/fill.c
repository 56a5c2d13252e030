/* Rings around what has a height, filled from the inside outwards; means of normals. */
#include "asset/fill.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* What eight levels of mips call for; it also bounds the work on hostile bytes. */
#define MOST_RINGS 128u
/* From the least code of a shown texel to the largest code, in steps of a texel. */
#define TRIM_RINGS 16u
#define FAR 255u

void gtx_normal_add(gtx_normal_sum *sum, const uint8_t code[2])
{
    int32_t a = 2 * code[0] - 255, b = 2 * code[1] - 255;
    sum->a += a;
    sum->b += b;
    sum->z += 255 - (abs(a) > abs(b) ? abs(a) : abs(b)); /* |x| + |y| = max(|x + y|, |x - y|) */
}

void gtx_normal_mean(const gtx_normal_sum *sum, uint8_t out[2])
{
    int32_t a = abs(sum->a), b = abs(sum->b), size = (a > b ? a : b) + sum->z;
    const int32_t part[2] = {sum->a, sum->b};
    for (int k = 0; k < 2; ++k) { /* floor(128 + 127.5 v), as an encoded normal */
        int32_t code = size ? (256 * size + 255 * part[k]) / (2 * size) : 128;
        out[k] = (uint8_t)(code > 255 ? 255 : code);
    }
}

uint32_t gtx_fill_rings(const gtx_patch *patch, uint32_t level)
{
    uint32_t rings = (uint32_t)patch->dilation >> level;
    return rings < 1 ? 1 : rings < MOST_RINGS ? rings : MOST_RINGS;
}

static uint8_t nearer(uint8_t best, uint8_t neighbour)
{
    return neighbour < best ? (uint8_t)(neighbour + 1) : best;
}

/* Distances in steps to any of 8 neighbours, by one sweep down and one up (Rosenfeld and Pfaltz
 * 1968): a texel of ring r has a neighbour of ring r - 1. */
static void measure_rings(const gtx_fill *area)
{
    ptrdiff_t stride = (ptrdiff_t)area->stride;
    for (int sweep = 0; sweep < 2; ++sweep) {
        ptrdiff_t side = sweep ? 1 : -1, back = side * stride;
        for (uint32_t n = 0; n < area->height; ++n) {
            uint8_t *row = area->ring + (sweep ? area->height - 1 - n : n) * area->stride;
            for (uint32_t m = 0; m < area->width; ++m) {
                uint32_t i = sweep ? area->width - 1 - m : m;
                uint8_t *p = row + i, best = *p ? *p : FAR;
                if (best > 1) {
                    bool left = sweep ? i + 1 < area->width : i > 0;
                    bool right = sweep ? i > 0 : i + 1 < area->width;
                    if (left)
                        best = nearer(best, p[side]);
                    if (n)
                        best = nearer(best, p[back]);
                    if (n && left)
                        best = nearer(best, p[back + side]);
                    if (n && right)
                        best = nearer(best, p[back - side]);
                }
                *p = best;
            }
        }
    }
}

/* A texel to be filled, and where its rectangle ends. */
typedef struct place {
    const gtx_fill *area;
    size_t at;
    int x0, x1, y0, y1;           /* steps to the neighbours inside the rectangle */
} place;

typedef void fill_texel(const place *p, uint8_t ring);

static void fill_normal(const place *p, uint8_t ring)
{
    const gtx_fill *area = p->area;
    gtx_normal_sum sum = {0, 0, 0};
    for (int y = p->y0; y <= p->y1; ++y)
        for (int x = p->x0; x <= p->x1; ++x) {
            size_t from = p->at + (size_t)(y * (ptrdiff_t)area->stride + x);
            if (area->ring[from] < ring)
                gtx_normal_add(&sum, area->codes + 2 * from);
        }
    gtx_normal_mean(&sum, area->codes + 2 * p->at);
}

/* One texel is 16 codes; a diagonal 22.6 (chamfer distance, Borgefors 1986). */
static void fill_distance(const place *p, uint8_t ring)
{
    const gtx_fill *area = p->area;
    int best = GTX_FAR_TRIM;
    for (int y = p->y0; y <= p->y1; ++y)
        for (int x = p->x0; x <= p->x1; ++x) {
            size_t from = p->at + (size_t)(y * (ptrdiff_t)area->stride + x);
            int code = area->codes[from] + (x && y ? 23 : 16);
            if (area->ring[from] < ring && code < best)
                best = code;
        }
    area->codes[p->at] = (uint8_t)best;
}

static void fill_ring(const gtx_fill *area, uint8_t ring, fill_texel *fill)
{
    for (uint32_t j = 0; j < area->height; ++j) {
        const uint8_t *row = area->ring + j * area->stride, *end = row + area->width, *p = row;
        while ((p = memchr(p, ring, (size_t)(end - p))) != NULL) {
            const place at = {area, (size_t)(p - area->ring), p > row ? -1 : 0,
                              p + 1 < end ? 1 : 0, j > 0 ? -1 : 0, j + 1 < area->height ? 1 : 0};
            fill(&at, ring);
            ++p;
        }
    }
}

static void fill_rings(const gtx_fill *area, uint32_t rings, fill_texel *fill)
{
    measure_rings(area);
    for (uint32_t ring = 1; ring <= rings; ++ring)
        fill_ring(area, (uint8_t)(ring + 1), fill);
}

void gtx_fill_normals(const gtx_fill *area, uint32_t rings)
{
    fill_rings(area, rings, fill_normal);
}

void gtx_fill_trim(const gtx_fill *area)
{
    fill_rings(area, TRIM_RINGS, fill_distance);
}
