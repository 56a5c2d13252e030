/* Which texels of a patch bound the result. */
#include "edit/combine/combine.h"

#include "asset/section.h"

#include <math.h>

/* Cosine of the 11 degrees within which surfaces that are near enough coincide. */
static const double PARALLEL = 0.98;

static bool coded(const gtx_cut *cut, uint32_t x, uint32_t y)
{
    return gtx_height_code(cut->operand->asset, cut->patch, x, y) != 0;
}

/* Between texels: on the bilinear patch of their cell, whose corners all have codes, or on its edge
 * between two that have. */
void gtx_cut_point(const gtx_cut *cut, double x, double y, double out[3])
{
    const gtx_asset *asset = cut->operand->asset;
    const uint32_t i = (uint32_t)x, j = (uint32_t)y;
    const double u = x - i, v = y - j;
    double code = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        const double weight = (k & 1 ? u : 1 - u) * (k >> 1 ? v : 1 - v);
        if (weight > 0)
            code += weight * gtx_height_code(asset, cut->patch, i + (k & 1), j + (k >> 1));
    }
    gtx_texel_point(cut->patch, x, y, gtx_code_height(code, asset->info.height_bits), out);
}

/* To the nearest texel that has a code beside (x, y) along an axis, or to it. */
static uint32_t beside(const gtx_cut *cut, uint32_t x, uint32_t y, int axis, bool ahead)
{
    const uint32_t at = axis ? y : x, end = axis ? cut->height : cut->width;
    if (ahead ? at + 1 >= end : at == 0)
        return at;
    const uint32_t to = ahead ? at + 1 : at - 1;
    return coded(cut, axis ? x : to, axis ? to : y) ? to : at;
}

/* A unit vector outwards; false where too little is known. */
static bool find_normal(const gtx_cut *cut, double x, double y, double out[3])
{
    const uint32_t i = (uint32_t)(x + 0.5), j = (uint32_t)(y + 0.5);
    double along[2][3], square = 0;
    for (int axis = 0; axis < 2; ++axis) {
        double ends[2][3];
        for (int end = 0; end < 2; ++end) {
            const uint32_t to = beside(cut, i, j, axis, end);
            gtx_cut_point(cut, axis ? i : to, axis ? to : j, ends[end]);
        }
        for (int k = 0; k < 3; ++k)
            along[axis][k] = ends[1][k] - ends[0][k];
    }
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        out[k] = along[0][a] * along[1][b] - along[0][b] * along[1][a];
        square += out[k] * out[k];
    }
    for (int k = 0; k < 3; ++k)
        out[k] /= sqrt(square);
    return square > 0;
}

/* Of the map, at the texel nearest to (x, y). */
static void find_shading_normal(const gtx_cut *cut, double x, double y, float out[3])
{
    float rows[3][3], n[3];
    const uint32_t i = (uint32_t)(x + 0.5), j = (uint32_t)(y + 0.5);
    gtx_normal_frame(cut->patch, rows);
    gtx_decode_normal(gtx_edit_texel(cut->operand->asset, cut->patch, GTX_SECTION_NORMAL, 0, i, j),
                      n);
    for (int k = 0; k < 3; ++k)
        out[k] = n[0] * rows[0][k] + n[1] * rows[1][k] + n[2] * rows[2][k];
}

/* A place, and the nearest of the other surface's that coincides with it. */
typedef struct meeting {
    const gtx_caster *caster;
    double normal[3];
    float shading[3];
    double nearest;
    int way;                  /* that one faces: 1 the same way, -1 the opposite one; 0: none */
} meeting;

/* Either kind of normal may tell: in rough places those of cells differ, as each cooks them, and
 * those of maps may have details of their own. */
static void meet(const gtx_crossing *crossing, void *user)
{
    meeting *m = user;
    const gtx_height_field *field = &m->caster->fields[crossing->field];
    const gtx_hit hit = gtx_describe(m->caster, crossing);
    double cosine[2] = {0, 0};
    for (int k = 0; k < 3; ++k) {
        cosine[0] += m->normal[k] * (double)hit.facet[k];
        cosine[1] += (double)m->shading[k] * (double)hit.normal[k];
    }
    const double most = fmax(cosine[0], cosine[1]), least = fmin(cosine[0], cosine[1]);
    if (fabs(crossing->t) >= m->nearest || fmax(most, -least) < PARALLEL ||
        gtx_field_trim(field, crossing->x, crossing->y) > GTX_TRIM_OUTLINE) /* the rim of it */
        return;
    m->nearest = fabs(crossing->t);
    m->way = most > PARALLEL ? 1 : -1;
}

static int coincide(gtx_cut *cut, double x, double y, const double point[3])
{
    meeting m = {.caster = cut->operand->other->caster, .nearest = INFINITY};
    gtx_line line = {.t_min = -cut->apart, .t_max = cut->apart};
    if (!find_normal(cut, x, y, m.normal))
        return 0;
    find_shading_normal(cut, x, y, m.shading);
    for (int k = 0; k < 3; ++k) {
        line.origin[k] = point[k];
        line.direction[k] = m.normal[k];
    }
    cut->steps += 1 + gtx_cast_each(m.caster, &line, meet, &m);
    return m.way;
}

bool gtx_cut_keeps(gtx_cut *cut, double x, double y)
{
    const gtx_keep *keep = &cut->operand->keep;
    double point[3];
    gtx_cut_point(cut, x, y, point);
    for (int k = 0; k < 3; ++k)
        point[k] += cut->operand->shift[k];
    const int way = coincide(cut, x, y, point);
    cut->coincided |= way != 0;
    if (way)
        return way > 0 ? keep->alike : keep->opposed;
    return (gtx_winding_at(cut->operand->other, point, &cut->steps) > 0.5) == keep->inside;
}

/* Around the texels from (x0, y0) and those behind the block, so that an edge between two blocks is
 * in one; in the other's coordinates. Empty when none has a code. */
static gtx_box box_of(const gtx_cut *cut, uint32_t x0, uint32_t y0)
{
    gtx_box box = gtx_box_empty;
    for (uint32_t y = y0; y <= y0 + GTX_BLOCK && y < cut->height; ++y)
        for (uint32_t x = x0; x <= x0 + GTX_BLOCK && x < cut->width; ++x) {
            double point[3];
            if (!coded(cut, x, y))
                continue;
            gtx_cut_point(cut, x, y, point);
            for (int k = 0; k < 3; ++k) {
                const double at = point[k] + cut->operand->shift[k];
                box.low[k] = fminf(box.low[k], (float)(at - cut->apart));
                box.high[k] = fmaxf(box.high[k], (float)(at + cut->apart));
            }
        }
    gtx_box_widen(&box);
    return box;
}

/* Far from the other surface one texel speaks for its block. */
static void label_block(gtx_cut *cut, uint32_t x0, uint32_t y0)
{
    const gtx_box box = box_of(cut, x0, y0);
    if (!(box.low[0] <= box.high[0]))
        return;
    const bool near = gtx_solid_meets(cut->operand->other, &box);
    uint8_t last = GTX_NO_LABEL;
    for (uint32_t y = y0; y < y0 + GTX_BLOCK && y < cut->height; ++y)
        for (uint32_t x = x0; x < x0 + GTX_BLOCK && x < cut->width; ++x) {
            if (!coded(cut, x, y))
                continue;
            if (near || last == GTX_NO_LABEL)
                last = gtx_cut_keeps(cut, x, y) ? GTX_KEPT : GTX_DROPPED;
            cut->label[(size_t)y * cut->width + x] = last;
        }
}

void gtx_cut_label(gtx_cut *cut)
{
    for (uint32_t y = 0; y < cut->height && cut->steps <= cut->left; y += GTX_BLOCK)
        for (uint32_t x = 0; x < cut->width; x += GTX_BLOCK)
            label_block(cut, x, y);
}
