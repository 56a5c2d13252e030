/* Casting into one block of a height field: from cell to cell along the ray (Amanatides and Woo
 * 1987), to exact bilinear crossings.
 *
 * The time at which the ray meets a plane comes from one expression, in a block and in its
 * neighbour, so no cell is skipped or met twice. */
#include "trace/caster.h"

#include <math.h>

/* Texels by which neighbouring cells overlap along the ray, so that none slips between them. */
static const double OVERLAP = 1e-7;
/* Codes added to both ends of a cell's range against rounding. */
static const double RANGE_SLACK = 1e-3;

typedef struct walk {
    const gtx_height_field *field;
    const gtx_block *block;
    bool both;
    double origin[3], direction[3]; /* grid space, from where the ray enters the block */
    double inverse[2];
    double start, length;           /* the ray's t there, and how far the block reaches */
    double overlap;                 /* OVERLAP in t */
    uint32_t cells[2];              /* of the block: fewer at the far edges */
    double t_min;
    gtx_crossing *best;
} walk;

/* The plane before cell `n` of the height field, in texels. */
static double plane(const gtx_height_field *field, int axis, uint32_t n)
{
    uint32_t last = (axis ? field->height : field->width) - 1, texel = n << field->level;
    return texel < last ? texel : last;
}

/* Takes the crossing at time s after t when it counts. */
static bool accept(const walk *w, double t, double s, bool back)
{
    double when = w->start + (t + s);
    gtx_crossing *best = w->best;
    const uint32_t index = w->block->field;
    if (when < w->t_min || !(when < best->t || (when == best->t && index < best->field)))
        return false;
    double x = w->origin[0] + (t + s) * w->direction[0];
    double y = w->origin[1] + (t + s) * w->direction[1];
    if (!gtx_field_shows(w->field, x, y))
        return false;
    *best = (gtx_crossing){when, index, x, y, back, best->visited};
    return true;
}

/* Crossings of a cell while the ray is over it, from t to `exit`. The ray's height above the
 * bilinear patch is f(s) = a s^2 + b s + c with s = 0 at t; where it crosses from above f' is
 * -root, from below +root, and each is solved in the form that does not cancel. */
static bool cross_cell(const walk *w, const gtx_cell *cell, double t, double exit)
{
    const double *o = w->origin, *d = w->direction;
    double width = cell->x1 - cell->x0, height = cell->y1 - cell->y0;
    double u = (o[0] + t * d[0] - cell->x0) / width, du = d[0] / width;
    double v = (o[1] + t * d[1] - cell->y0) / height, dv = d[1] / height;
    double c = o[2] + t * d[2] - (cell->c + cell->cx * u + cell->cy * v + cell->cxy * u * v);
    double b = d[2] - (cell->cx * du + cell->cy * dv + cell->cxy * (u * dv + v * du));
    double a = -cell->cxy * du * dv;
    double square = b * b - 4 * a * c;
    if (!(square > 0))
        return false;
    double root = sqrt(square), q = b < 0 ? root - b : -root - b;
    double front = b < 0 ? 2 * c / q : q / (2 * a);
    double back = b < 0 ? q / (2 * a) : 2 * c / q;

    const struct {
        double s;
        bool back;
    } crossing[2] = {{front < back ? front : back, !(front < back)},
                     {front < back ? back : front, front < back}};
    for (int k = 0; k < 2; ++k) {
        double s = crossing[k].s;
        if ((w->both || !crossing[k].back) && s >= -w->overlap && s <= exit - t + w->overlap &&
            accept(w, t, s, crossing[k].back))
            return true;
    }
    return false;
}

/* Whether the ray is among the cell's heights at any time from t to `exit`. */
static bool range_met(const walk *w, const gtx_cell *cell, double t, double exit)
{
    const double left = cell->c, right = left + cell->cx, across = left + cell->cy;
    const double far = right + cell->cy + cell->cxy;
    double z0 = w->origin[2] + t * w->direction[2], z1 = w->origin[2] + exit * w->direction[2];
    double low = z0 < z1 ? z0 : z1, high = z0 < z1 ? z1 : z0;
    low -= RANGE_SLACK;
    high += RANGE_SLACK;
    return (left >= low || right >= low || across >= low || far >= low) &&
           (left <= high || right <= high || across <= high || far <= high);
}

static void walk_cells(const walk *w, uint32_t x, uint32_t y)
{
    const uint32_t ahead[2] = {w->direction[0] > 0, w->direction[1] > 0};
    uint32_t cell[2] = {x, y};
    double t = 0;
    for (;;) {
        double leave[2];
        for (int a = 0; a < 2; ++a) {
            const double edge = plane(w->field, a, cell[a] + ahead[a]);
            leave[a] = w->direction[a] == 0 ? INFINITY : (edge - w->origin[a]) * w->inverse[a];
        }
        const int axis = leave[1] < leave[0];
        double exit = leave[axis] < w->length ? leave[axis] : w->length;
        exit = exit > t ? exit : t;
        ++w->best->visited;
        const uint32_t i = cell[0] - w->block->x, j = cell[1] - w->block->y;
        if (w->block->solid >> (j * GTX_BLOCK + i) & 1) {
            const gtx_cell c = gtx_field_cell(w->field, cell[0], cell[1]);
            if (range_met(w, &c, t, exit) && cross_cell(w, &c, t, exit))
                return;
        }
        if (exit >= w->length)
            return;
        t = exit;
        cell[axis] += ahead[axis] ? 1u : -1u;
        if (cell[axis] - (axis ? w->block->y : w->block->x) >= w->cells[axis])
            return;
    }
}

/* The cell of the block that the ray is in where it enters; the first where that is no number. */
static uint32_t entry_cell(const gtx_height_field *field, uint32_t first, uint32_t last, double at)
{
    const double cell = at / (1u << field->level);
    return !(cell > first) ? first : cell >= last ? last : (uint32_t)cell;
}

/* Cuts [*t0, *t1] to where the line is between two planes across an axis. */
static bool cut(const gtx_line *line, int axis, double low, double high, double *t0, double *t1)
{
    const double o = line->origin[axis], d = line->direction[axis];
    if (d == 0)
        return o >= low && o <= high;
    const double near = ((d > 0 ? low : high) - o) * (1 / d);
    const double far = ((d > 0 ? high : low) - o) * (1 / d);
    *t0 = near > *t0 ? near : *t0;
    *t1 = far < *t1 ? far : *t1;
    return *t0 <= *t1;
}

void gtx_walk_block(const gtx_caster *caster, const gtx_block *block, const gtx_line *line,
                    bool both, gtx_crossing *best)
{
    const gtx_height_field *s = &caster->fields[block->field];
    const uint32_t first[2] = {block->x, block->y};
    const uint32_t cells[2] = {s->nodes_x - 1, s->nodes_y - 1};
    walk w = {.field = s, .block = block, .both = both || s->two_sided, .t_min = line->t_min,
              .best = best};
    double t0 = line->t_min, t1 = best->t, fastest = 1e-300; /* along z no cell is ever left */
    uint32_t last[2];
    for (int a = 0; a < 2; ++a) {
        last[a] = (first[a] + GTX_BLOCK < cells[a] ? first[a] + GTX_BLOCK : cells[a]) - 1;
        if (!cut(line, a, plane(s, a, first[a]), plane(s, a, last[a] + 1), &t0, &t1))
            return;
        w.cells[a] = last[a] + 1 - first[a];
        w.inverse[a] = 1 / line->direction[a];
        fastest = fmax(fastest, fabs(line->direction[a]));
    }
    /* A code more on both sides, so that a flat height field does not lie in the faces of its
     * box. */
    if (!cut(line, 2, block->low - 1.0, block->high + 1.0, &t0, &t1))
        return;
    for (int a = 0; a < 3; ++a) {
        w.direction[a] = line->direction[a];
        w.origin[a] = line->origin[a] + t0 * line->direction[a];
    }
    w.start = t0;
    w.length = t1 - t0;
    w.overlap = OVERLAP / fastest;
    walk_cells(&w, entry_cell(s, first[0], last[0], w.origin[0]),
               entry_cell(s, first[1], last[1], w.origin[1]));
}

/* The first and the last block along an axis that a line passes over up to t, with a texel to
 * either side for what is rounded; all where that is no number. */
static void blocks_along(const gtx_line *line, int axis, double t, double size, uint32_t count,
                         uint32_t out[2])
{
    const double o = line->origin[axis], d = line->direction[axis];
    const double from = d == 0 ? o : o + line->t_min * d, to = d == 0 ? o : o + t * d;
    const double first = (fmin(from, to) - 1) / size, last = (fmax(from, to) + 1) / size;
    out[0] = !(first > 0) ? 0 : first < count ? (uint32_t)first : count - 1;
    out[1] = !(last < count) ? count - 1 : last > 0 ? (uint32_t)last : 0;
}

void gtx_walk_field(const gtx_caster *caster, uint32_t field, const gtx_line *ray, bool both,
                    gtx_crossing *best)
{
    const gtx_height_field *s = &caster->fields[field];
    const gtx_line line = gtx_field_line(s, ray);
    const double size = (double)(GTX_BLOCK << s->level);
    uint32_t x[2], y[2];
    blocks_along(&line, 0, best->t, size, s->blocks_x, x);
    blocks_along(&line, 1, best->t, size, gtx_blocks_of(s->nodes_y - 1), y);
    for (uint32_t j = y[0]; j <= y[1]; ++j)
        for (uint32_t i = x[0]; i <= x[1]; ++i) {
            const gtx_block *block = &caster->blocks[s->first_block + j * s->blocks_x + i];
            if (block->solid)
                gtx_walk_block(caster, block, &line, both, best);
        }
}
