/* A patch's new outline: where its surface crosses the other's, as distances in its trim. */
#include "edit/combine/combine.h"

#include "base/alloc.h"

#include <math.h>
#include <string.h>

/* Distances are found this far from the outline, in texels: what shows ends at 0.3, at level 3 at
 * 2.4. */
static const float REACH = 3;
/* Halvings of an edge until a place is within a code of the trim. */
enum { HALVINGS = 5 };
/* In texels: within it surfaces coincide. Armadillo cooked in two ways, as cuts and as layers: the
 * union, intersection and difference are off by 1.5e-5 of its volume, 1 in 1000 of its area. */
static const double COINCIDE = 0.25;

typedef struct outline {
    gtx_cut cut;
    float *distance;          /* to the new outline, texels */
    uint8_t *crossing;        /* of the edges from each texel along x and y: 1 + where the label
                                 changes, in shares of 2^HALVINGS; 0: not yet known */
    double longest;           /* diagonal of a cell that is cut */
} outline;

static size_t texel_at(const outline *o, uint32_t x, uint32_t y)
{
    return (size_t)y * o->cut.width + x;
}

static bool kept_at(const outline *o, uint32_t x, uint32_t y)
{
    return o->cut.label[texel_at(o, x, y)] == GTX_KEPT;
}

/* Where the label changes between (x, y) and the next texel along an axis, by halving. */
static void find_crossing(outline *o, uint32_t x, uint32_t y, int axis, double out[2])
{
    uint8_t *memo = &o->crossing[2 * texel_at(o, x, y) + (size_t)axis];
    if (!*memo) {
        const bool first = kept_at(o, x, y);
        uint32_t low = 0;
        for (uint32_t step = 1u << (HALVINGS - 1); step; step /= 2) {
            const double at = ldexp(low + step, -HALVINGS);
            if (gtx_cut_keeps(&o->cut, axis ? x : x + at, axis ? y + at : y) == first)
                low += step;
        }
        *memo = (uint8_t)(1 + low);
    }
    const double at = ldexp(*memo - 0.5, -HALVINGS);
    out[0] = axis ? x : x + at;
    out[1] = axis ? y + at : y;
}

static float distance_to(const double p[2], const double q[2], double x, double y)
{
    const double ex = q[0] - p[0], ey = q[1] - p[1], square = ex * ex + ey * ey;
    double t = square > 0 ? ((x - p[0]) * ex + (y - p[1]) * ey) / square : 0;
    t = t > 0 ? t < 1 ? t : 1 : 0;
    const double dx = p[0] + t * ex - x, dy = p[1] + t * ey - y;
    return (float)sqrt(dx * dx + dy * dy);
}

/* Part of the outline, within the cell (x, y). */
static void splat(outline *o, uint32_t x, uint32_t y, const double p[2], const double q[2])
{
    const uint32_t reach = (uint32_t)REACH, width = o->cut.width, height = o->cut.height;
    for (uint32_t j = y > reach ? y - reach : 0; j <= y + 1 + reach && j < height; ++j)
        for (uint32_t i = x > reach ? x - reach : 0; i <= x + 1 + reach && i < width; ++i) {
            float *distance = &o->distance[texel_at(o, i, j)];
            *distance = fminf(*distance, distance_to(p, q, i, j));
        }
}

static void measure_cell(outline *o, uint32_t x, uint32_t y)
{
    for (uint32_t k = 0; k < 2; ++k) {
        double a[3], b[3], square = 0;
        gtx_cut_point(&o->cut, x + k, y, a);
        gtx_cut_point(&o->cut, x + 1 - k, y + 1, b);
        for (int c = 0; c < 3; ++c)
            square += (a[c] - b[c]) * (a[c] - b[c]);
        o->longest = fmax(o->longest, sqrt(square));
    }
}

/* Marching squares (Lorensen and Cline 1987, in the plane): corners and edges are numbered
 *   2 -3- 3
 *   1     2
 *   0 -0- 1   */
static void outline_cell(outline *o, uint32_t x, uint32_t y)
{
    bool kept[4];
    uint32_t count = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        if (o->cut.label[texel_at(o, x + (k & 1), y + (k >> 1))] == GTX_NO_LABEL)
            return;
        kept[k] = kept_at(o, x + (k & 1), y + (k >> 1));
        count += kept[k];
    }
    if (count == 0 || count == 4)
        return;
    measure_cell(o, x, y);
    static const uint8_t ends[4][2] = {{0, 1}, {0, 2}, {1, 3}, {2, 3}};
    static const uint8_t from[4][3] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 0}};
    double place[4][2];
    uint32_t met[4], crossings = 0;
    for (uint32_t e = 0; e < 4; ++e)
        if (kept[ends[e][0]] != kept[ends[e][1]]) {
            met[crossings++] = e;
            find_crossing(o, x + from[e][0], y + from[e][1], from[e][2], place[e]);
        }
    if (crossings == 2) {
        splat(o, x, y, place[met[0]], place[met[1]]);
    } else { /* of a saddle, the middle tells which corners are joined */
        const bool joined = gtx_cut_keeps(&o->cut, x + 0.5, y + 0.5) == kept[0];
        splat(o, x, y, place[0], place[joined ? 2 : 1]);
        splat(o, x, y, place[3], place[joined ? 1 : 2]);
    }
}

/* The greater of both distances: what shows is inside both outlines. */
static void write_trim(const outline *o, gtx_piece *piece)
{
    const gtx_cut *cut = &o->cut;
    for (uint32_t y = 0; y < cut->height; ++y)
        for (uint32_t x = 0; x < cut->width; ++x) {
            const size_t t = texel_at(o, x, y);
            const float distance = kept_at(o, x, y) ? -o->distance[t] : o->distance[t];
            const uint8_t code = gtx_nearest_trim(distance + cut->operand->keep.inset);
            piece->trim[t] = (uint8_t)gtx_trim_code(cut->operand->asset, cut->patch, x, y);
            if (cut->label[t] != GTX_NO_LABEL && code > piece->trim[t])
                piece->trim[t] = code;
        }
}

/* Keeps the corners of cells of which something shows. False if that is but the rim beyond the
 * outline. */
static bool find_kept(const outline *o, gtx_piece *piece)
{
    const uint8_t limit = (uint8_t)gtx_trim_limit(0);
    bool inside = false;
    for (uint32_t y = 0; y + 1 < o->cut.height; ++y)
        for (uint32_t x = 0; x + 1 < o->cut.width; ++x) {
            bool whole = true, shows = false, deep = false;
            for (uint32_t k = 0; k < 4; ++k) {
                const size_t t = texel_at(o, x + (k & 1), y + (k >> 1));
                whole = whole && o->cut.label[t] != GTX_NO_LABEL;
                shows = shows || piece->trim[t] <= limit;
                deep = deep || piece->trim[t] < GTX_TRIM_OUTLINE;
            }
            inside = inside || (whole && deep);
            for (uint32_t k = 0; k < 4 && whole && shows; ++k)
                piece->kept[texel_at(o, x + (k & 1), y + (k >> 1))] = 1;
        }
    return inside;
}

/* Around what is kept, at multiples of the grain. */
static void find_window(const outline *o, uint32_t grain, gtx_piece *piece)
{
    const uint32_t side[2] = {o->cut.width, o->cut.height};
    uint32_t low[2] = {UINT32_MAX, UINT32_MAX}, high[2] = {0, 0};
    for (uint32_t y = 0; y < side[1]; ++y)
        for (uint32_t x = 0; x < side[0]; ++x)
            for (int a = 0; a < 2 && piece->kept[texel_at(o, x, y)]; ++a) {
                const uint32_t at = a ? y : x;
                low[a] = at < low[a] ? at : low[a];
                high[a] = at + 1 > high[a] ? at + 1 : high[a];
            }
    for (int a = 0; a < 2; ++a) {
        piece->low[a] = high[a] ? low[a] / grain * grain : 0;
        piece->size[a] = (high[a] - piece->low[a] + grain - 1) / grain * grain;
        if (piece->low[a] + piece->size[a] > side[a]) { /* with one mip level sides may be odd */
            piece->size[a] = piece->size[a] < side[a] ? piece->size[a] : side[a];
            piece->low[a] = side[a] - piece->size[a];
        }
    }
}

static void cut_along(outline *o, uint32_t grain, gtx_piece *piece)
{
    for (size_t t = 0; t < (size_t)o->cut.width * o->cut.height; ++t)
        o->distance[t] = REACH;
    for (uint32_t y = 0; y + 1 < o->cut.height && o->cut.steps <= o->cut.left; ++y)
        for (uint32_t x = 0; x + 1 < o->cut.width; ++x)
            outline_cell(o, x, y);
    write_trim(o, piece);
    if (find_kept(o, piece))
        find_window(o, grain, piece);
    else
        piece->size[0] = piece->size[1] = 0;
    piece->error = o->longest / 2 + (o->cut.coincided ? o->cut.apart : 0);
}

gtx_piece gtx_cut_patch(const gtx_operand *operand, uint32_t patch, uint32_t grain, uint64_t left,
                        const gtx_allocator *hooks)
{
    const gtx_patch *record = &operand->asset->patches[patch];
    const uint32_t w = record->rect[2], h = record->rect[3];
    const size_t count = (size_t)w * h;
    const double texel = fmax((double)record->extent_x / w, (double)record->extent_y / h);
    gtx_piece piece = {.size = {w, h}};
    outline o = {.cut = {.operand = operand, .patch = record, .width = w, .height = h,
                         .apart = COINCIDE * texel, .left = left}};
    o.cut.label = gtx_alloc_array(hooks, count, 1);
    o.crossing = gtx_alloc_array(hooks, count, 2);
    o.distance = gtx_alloc_raw(hooks, count, sizeof *o.distance);
    piece.trim = gtx_alloc_array(hooks, count, 1);
    piece.kept = gtx_alloc_array(hooks, count, 1);
    if (o.cut.label && o.crossing && o.distance && piece.trim && piece.kept) {
        gtx_cut_label(&o.cut);
        const bool some = memchr(o.cut.label, GTX_KEPT, count);
        if (some && memchr(o.cut.label, GTX_DROPPED, count))
            cut_along(&o, grain, &piece);
        else if (!some)
            piece.size[0] = piece.size[1] = 0;
        if (!piece.size[0] || !memchr(o.cut.label, GTX_DROPPED, count)) {
            gtx_free_array(hooks, piece.trim, count, 1);
            gtx_free_array(hooks, piece.kept, count, 1);
            piece.trim = piece.kept = NULL;
        }
    } else {
        piece.result = GTX_ERROR_MEMORY;
    }
    piece.steps = o.cut.steps;
    gtx_free_array(hooks, o.cut.label, count, 1);
    gtx_free_array(hooks, o.crossing, count, 2);
    gtx_free_array(hooks, o.distance, count, sizeof *o.distance);
    return piece;
}

void gtx_free_piece(const gtx_operand *operand, uint32_t patch, gtx_piece *piece,
                    const gtx_allocator *hooks)
{
    const uint16_t *rect = operand->asset->patches[patch].rect;
    gtx_free_array(hooks, piece->trim, (size_t)rect[2] * rect[3], 1);
    gtx_free_array(hooks, piece->kept, (size_t)rect[2] * rect[3], 1);
}
