/* Extends normals and trim to texels without a height: normals ring by ring, trim by sweeps. */
#include "asset/fill.h"

#include "asset/lanes.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* What eight levels of mips call for; it also bounds the work on hostile bytes. */
#define MAX_RINGS 128u
#define FAR 255u

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
    return rings < 1 ? 1 : rings < MAX_RINGS ? rings : MAX_RINGS;
}

static uint8_t least(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

/* A sum that is at most FAR, in bytes all along, for vectors of them. */
static uint8_t add_steps(uint8_t from, uint8_t steps)
{
    return (uint8_t)(least(from, (uint8_t)(FAR - steps)) + steps);
}

/* One step more than the least of three neighbours in the row swept before. */
static void step_from_row(uint8_t *restrict row, const uint8_t *restrict before, uint32_t width)
{
    uint32_t last = width - 1, next = last ? 1 : 0, next_to_last = last - next;
    row[0] = least(row[0], add_steps(least(before[0], before[next]), 1));
    for (uint32_t i = 1; i < last; ++i) {
        const uint8_t near = least(least(before[i - 1], before[i]), before[i + 1]);
        row[i] = least(row[i], add_steps(near, 1));
    }
    row[last] = least(row[last], add_steps(least(before[next_to_last], before[last]), 1));
}

/* Distances in steps to any of 8 neighbours, by one sweep down and one up (Rosenfeld and Pfaltz
 * 1968): a texel of ring r has a neighbour of ring r - 1. */
static void measure_rings(const gtx_fill *area)
{
    uint32_t width = area->width, height = area->height;
    for (uint32_t j = 0; j < height; ++j) {
        uint8_t *row = area->ring + j * area->stride;
        int near = FAR;           /* of the texel before, and one step more */
        for (uint32_t i = 0; i < width; ++i)
            row[i] = row[i] ? row[i] : FAR;
        if (j)
            step_from_row(row, row - area->stride, width);
        for (uint32_t i = 0; i < width; ++i, ++near)
            row[i] = (uint8_t)(near = row[i] < near ? row[i] : near);
    }
    for (uint32_t j = height; j-- > 0;) {
        uint8_t *row = area->ring + j * area->stride;
        int near = FAR;
        if (j + 1 < height)
            step_from_row(row, row + area->stride, width);
        for (uint32_t i = width; i-- > 0; ++near)
            row[i] = (uint8_t)(near = row[i] < near ? row[i] : near);
    }
}

/* The texel at `p`: the mean of neighbours, so many steps to each side, of smaller rings. */
static void fill_normal(const gtx_fill *area, const uint8_t *p, int x0, int x1, int y0, int y1)
{
    gtx_normal_sum sum = {0, 0, 0};
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const uint8_t *from = p + y * (ptrdiff_t)area->stride + x;
            gtx_normal_add_if(&sum, area->codes + 2 * (from - area->ring), *from < *p);
        }
    gtx_normal_mean(&sum, area->codes + 2 * (p - area->ring));
}

/* Texels that are filled together: their neighbours take one lane more on each side. */
enum { TOGETHER = GTX_LANES - 2 };

/* The same of those among TOGETHER texels from `p` on whose ring is `mark`. */
static void fill_together(const gtx_fill *area, const uint8_t *p, uint8_t mark, int y0, int y1)
{
    gtx_lane_sums column = {{0}, {0}, {0}}, sums;
    uint16_t code[GTX_LANES];
    uint8_t ring[GTX_LANES];
    for (int y = y0; y <= y1; ++y) {
        const uint8_t *from = p - 1 + y * (ptrdiff_t)area->stride;
        memcpy(ring, from, sizeof ring);
        memcpy(code, area->codes + 2 * (from - area->ring), sizeof code);
        gtx_lanes_order(code);
        gtx_lanes_add(&column, code, ring, mark - 1);
    }
    gtx_lanes_spread(&column, &sums);
    uint8_t *out = area->codes + 2 * (p - 1 - area->ring);
    memcpy(ring, p - 1, sizeof ring);
    memcpy(code, out, sizeof code);
    gtx_lanes_order(code);
    ring[0] = ring[GTX_LANES - 1] = 0;
    gtx_lanes_mean(&sums, ring, mark, code);
    gtx_lanes_order(code);
    memcpy(out, code, sizeof code);
}

/* Texels of a row whose ring is `mark`. */
static void fill_row(const gtx_fill *area, uint32_t j, uint8_t mark)
{
    const uint8_t *row = area->ring + j * area->stride, *end = row + area->width, *p = row;
    const int y0 = j > 0 ? -1 : 0, y1 = j + 1 < area->height ? 1 : 0;
    while ((p = memchr(p, mark, (size_t)(end - p))) != NULL) {
        if (p > row && p + 1 < end && area->width >= GTX_LANES) {
            p = end - p > TOGETHER ? p : end - 1 - TOGETHER;
            fill_together(area, p, mark, y0, y1);
            p += TOGETHER;
        } else {
            fill_normal(area, p, p > row ? -1 : 0, p + 1 < end ? 1 : 0, y0, y1);
            ++p;
        }
    }
}

void gtx_fill_normals(const gtx_fill *area, uint32_t rings)
{
    measure_rings(area);
    uint8_t farthest = 1;
    for (uint32_t j = 0; j < area->height; ++j)
        for (uint32_t i = 0; i < area->width; ++i) {
            const uint8_t ring = area->ring[j * area->stride + i];
            farthest = ring > farthest ? ring : farthest;
        }
    for (uint32_t ring = 1; ring <= rings && ring < farthest; ++ring)
        for (uint32_t j = 0; j < area->height; ++j)
            fill_row(area, j, (uint8_t)(ring + 1));
}

/* From the row swept last: one texel is 16 codes, a diagonal 22.6. */
static void step_trim_across(uint8_t *restrict row, const uint8_t *restrict ring,
                             const uint8_t *restrict before, uint32_t width)
{
    const uint32_t last = width - 1;
    for (uint32_t i = 0; i < width; i += last ? last : 1) { /* the ends */
        const uint8_t aside = least(i ? before[i - 1] : FAR, i < last ? before[i + 1] : FAR);
        const uint8_t best = least(add_steps(before[i], 16), add_steps(aside, 23));
        row[i] = ring[i] ? row[i] : least(row[i], best);
    }
    for (uint32_t i = 1; i < last; ++i) {
        const uint8_t aside = least(before[i - 1], before[i + 1]), here = row[i];
        const uint8_t best = least(add_steps(before[i], 16), add_steps(aside, 23));
        row[i] = ring[i] ? here : least(here, best);
    }
}

static void step_trim_along(uint8_t *row, const uint8_t *ring, uint32_t width, int side)
{
    uint32_t i = side < 0 ? 0 : width - 1;
    int best = row[i];
    for (uint32_t n = 1; n < width; ++n) {
        i -= (uint32_t)side;
        best = ring[i] || row[i] < best + 16 ? row[i] : best + 16;
        row[i] = (uint8_t)best;
    }
}

/* Chamfer distances (Borgefors 1986), by one sweep down and one up. */
void gtx_fill_trim(const gtx_fill *area)
{
    const uint32_t height = area->height, width = area->width;
    for (uint32_t j = 0; j < height; ++j) {
        uint8_t *row = area->codes + j * area->stride;
        const uint8_t *ring = area->ring + j * area->stride;
        if (j)
            step_trim_across(row, ring, row - area->stride, width);
        step_trim_along(row, ring, width, -1);
    }
    for (uint32_t j = height; j-- > 0;) {
        uint8_t *row = area->codes + j * area->stride;
        const uint8_t *ring = area->ring + j * area->stride;
        if (j + 1 < height)
            step_trim_across(row, ring, row + area->stride, width);
        step_trim_along(row, ring, width, 1);
    }
}
