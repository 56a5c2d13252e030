/* The slow reference: every cell of a height field, crossings found by bisection. It shares with
 * the walk only what defines the surface: the cell's corners and the trim. */
#include "trace/caster.h"

typedef struct interval {
    double t0, t1;
} interval;

/* The part of `i` where the line's coordinate along the axis lies within [low, high]; empty when
 * t0 > t1. */
static inline interval cut(interval i, const gtx_line *line, int axis, double inverse, double low,
                           double high)
{
    const interval none = {1, 0};
    double o = line->origin[axis];
    if (line->direction[axis] == 0)
        return o < low || o > high ? none : i;
    double near = ((inverse > 0 ? low : high) - o) * inverse;
    double far = ((inverse > 0 ? high : low) - o) * inverse;
    return (interval){near > i.t0 ? near : i.t0, far < i.t1 ? far : i.t1};
}

/* The ray's height above the surface of the cell. */
static double above(const gtx_line *line, const gtx_cell *cell, double t)
{
    double u = (line->origin[0] + t * line->direction[0] - cell->x0) / (cell->x1 - cell->x0);
    double v = (line->origin[1] + t * line->direction[1] - cell->y0) / (cell->y1 - cell->y0);
    double z = line->origin[2] + t * line->direction[2];
    return z - (cell->c + cell->cx * u + cell->cy * v + cell->cxy * u * v);
}

/* Where `above` changes sign between t0 and t1, given that it does so once. */
static double bisect(const gtx_line *line, const gtx_cell *cell, double t0, double t1)
{
    bool start = above(line, cell, t0) > 0;
    for (;;) {
        double middle = t0 + (t1 - t0) / 2;
        if (!(middle > t0 && middle < t1))
            return t1;
        if ((above(line, cell, middle) > 0) == start)
            t0 = middle;
        else
            t1 = middle;
    }
}

/* Where the parabola through three of its values on [t0, t1] turns; t1 when it does not. */
static double turn(double t0, double t1, double f0, double middle, double f1)
{
    double a = f0 - 2 * middle + f1, b = f1 - f0, x = a == 0 ? 1 : -b / (4 * a);
    return x > -0.5 && x < 0.5 ? t0 + (0.5 + x) * (t1 - t0) : t1;
}

/* What is looked for in the cells of a height field. */
typedef struct search {
    const gtx_height_field *field;
    uint32_t index;
    gtx_line line;
    bool both;                /* crossings from below, too */
} search;

static void search_cell(const search *s, const gtx_cell *cell, interval i, gtx_crossing *best)
{
    const gtx_line *line = &s->line;
    double f0 = above(line, cell, i.t0), f1 = above(line, cell, i.t1);
    double middle = above(line, cell, i.t0 + (i.t1 - i.t0) / 2);
    double split = turn(i.t0, i.t1, f0, middle, f1);
    const double end[3] = {i.t0, split, i.t1};
    for (int k = 0; k < 2; ++k) {
        bool from = above(line, cell, end[k]) > 0, to = above(line, cell, end[k + 1]) > 0;
        if (from == to || (!from && !s->both))
            continue;
        double t = bisect(line, cell, end[k], end[k + 1]);
        double x = line->origin[0] + t * line->direction[0];
        double y = line->origin[1] + t * line->direction[1];
        if (!(t < best->t || (t == best->t && s->index < best->field)) ||
            !gtx_field_shows(s->field, x, y))
            continue;
        *best = (gtx_crossing){t, s->index, x, y, !from, best->visited};
        return;
    }
}

/* The codes at the corners of a cell, and a code more on both sides. */
static void code_range(const gtx_height_field *field, uint32_t i, uint32_t j, double *low,
                       double *high)
{
    const uint16_t *row = field->code + (size_t)j * field->nodes_x + i;
    const uint16_t *next = row + field->nodes_x;
    const uint16_t corner[4] = {row[0], row[1], next[0], next[1]};
    uint16_t least = corner[0], most = corner[0];
    for (int k = 1; k < 4; ++k) {
        least = corner[k] < least ? corner[k] : least;
        most = corner[k] > most ? corner[k] : most;
    }
    *low = least - 1.0;
    *high = most + 1.0;
}

void gtx_search_field(const gtx_caster *caster, uint32_t field, const gtx_line *ray, bool both,
                      gtx_crossing *best)
{
    const gtx_height_field *f = &caster->fields[field];
    const search s = {f, field, gtx_field_line(f, ray), both || f->two_sided};
    const double *d = s.line.direction, inverse[3] = {1 / d[0], 1 / d[1], 1 / d[2]};
    for (uint32_t j = 0; j + 1 < f->nodes_y; ++j) {
        gtx_cell first = gtx_field_cell(f, 0, j);
        interval row = {ray->t_min, best->t};
        row = cut(row, &s.line, 1, inverse[1], first.y0, first.y1);
        for (uint32_t i = 0; row.t0 <= row.t1 && i + 1 < f->nodes_x; ++i) {
            double low, high;
            if (!gtx_field_solid(caster, f, i, j))
                continue;
            code_range(f, i, j, &low, &high);
            interval inside = cut(row, &s.line, 2, inverse[2], low, high);
            if (inside.t0 > inside.t1)
                continue;
            gtx_cell cell = gtx_field_cell(f, i, j);
            inside = cut(inside, &s.line, 0, inverse[0], cell.x0, cell.x1);
            if (inside.t0 <= inside.t1)
                search_cell(&s, &cell, inside, best);
        }
    }
}
