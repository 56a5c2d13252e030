/* Casting into one sheet: a front-to-back walk down a min-max tree to exact bilinear crossings.
 *
 * The tree descends as in Tevs, Ihrke, Seidel, "Maximum Mipmaps for Fast, Accurate, and Scalable
 * Dynamic Height Field Rendering", I3D 2008, with minima too and without a stack: leaving a node
 * ascends one level when its parent is left as well. Nodes are integers and the time at which the
 * ray meets a plane comes from one expression, so no node is skipped or met twice: a line pierces
 * at most 2 N / 2^l - 1 nodes of level l, hence at most 4 N nodes are tested. */
#include "trace/caster.h"

#include <math.h>

/* Texels by which neighbouring cells overlap along the ray, so that none slips between them. */
static const double OVERLAP = 1e-7;
/* Codes added to both ends of a node's range against rounding. */
static const double RANGE_SLACK = 1e-3;

typedef struct walk {
    const gtx_caster *caster;
    const gtx_sheet *sheet;
    uint32_t index;
    bool both;
    double origin[3], direction[3]; /* grid space, from where the ray enters the box */
    double inverse[2];
    double start, length;           /* the ray's t there, and how far the box reaches */
    double overlap;                 /* OVERLAP in t */
    double t_min;
    gtx_crossing *best;
} walk;

/* Cuts [*t0, *t1] to the part of the line inside the box of the solid cells. */
static bool clip(const gtx_sheet *sheet, const gtx_line *line, double *t0, double *t1)
{
    for (int a = 0; a < 3; ++a) {
        double o = line->origin[a], d = line->direction[a];
        if (d == 0) {
            if (o < sheet->low[a] || o > sheet->high[a])
                return false;
            continue;
        }
        double near = (sheet->low[a] - o) / d, far = (sheet->high[a] - o) / d;
        if (near > far) {
            double swap = near;
            near = far;
            far = swap;
        }
        *t0 = near > *t0 ? near : *t0;
        *t1 = far < *t1 ? far : *t1;
    }
    return *t0 <= *t1;
}

/* The plane before node `n` of tree level `l`, in texels. */
static double plane(const walk *w, int axis, uint32_t n, uint32_t l)
{
    uint32_t last = (axis ? w->sheet->height : w->sheet->width) - 1;
    uint32_t texel = n << (l + w->sheet->level);
    return texel < last ? texel : last;
}

static double time_at(const walk *w, int axis, double texel)
{
    return w->direction[axis] == 0 ? INFINITY : (texel - w->origin[axis]) * w->inverse[axis];
}

/* Which of the two children of node `n` the ray is in at time t. */
static uint32_t child(const walk *w, int axis, uint32_t n, uint32_t l, double t)
{
    double split = plane(w, axis, 2 * n + 1, l - 1);
    if (split == (axis ? w->sheet->height : w->sheet->width) - 1)
        return 2 * n;
    if (w->direction[axis] == 0)
        return 2 * n + (w->origin[axis] >= split);
    bool passed = t >= time_at(w, axis, split);
    return 2 * n + (passed == (w->direction[axis] > 0));
}

/* Takes the crossing at time s after t when it counts. */
static bool accept(const walk *w, double t, double s, bool back)
{
    double when = w->start + (t + s);
    gtx_crossing *best = w->best;
    if (when < w->t_min || !(when < best->t || (when == best->t && w->index < best->sheet)))
        return false;
    double x = w->origin[0] + (t + s) * w->direction[0];
    double y = w->origin[1] + (t + s) * w->direction[1];
    if (!gtx_sheet_shows(w->sheet, x, y))
        return false;
    *best = (gtx_crossing){when, w->index, x, y, back};
    return true;
}

/* Crossings of cell (i, j) while the ray is over it, from t to `exit`. The ray's height above the
 * bilinear patch is f(s) = a s^2 + b s + c with s = 0 at t; where it crosses from above f' is
 * -root, from below +root, and each is solved in the form that does not cancel. */
static bool cross_cell(const walk *w, uint32_t i, uint32_t j, double t, double exit)
{
    gtx_cell cell = gtx_sheet_cell(w->sheet, i, j);
    const double *o = w->origin, *d = w->direction;
    double width = cell.x1 - cell.x0, height = cell.y1 - cell.y0;
    double u = (o[0] + t * d[0] - cell.x0) / width, du = d[0] / width;
    double v = (o[1] + t * d[1] - cell.y0) / height, dv = d[1] / height;
    double c = o[2] + t * d[2] - (cell.c + cell.cx * u + cell.cy * v + cell.cxy * u * v);
    double b = d[2] - (cell.cx * du + cell.cy * dv + cell.cxy * (u * dv + v * du));
    double a = -cell.cxy * du * dv;
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

static bool range_met(const walk *w, gtx_range range, double t, double exit)
{
    double z0 = w->origin[2] + t * w->direction[2], z1 = w->origin[2] + exit * w->direction[2];
    return range.min <= range.max && (z0 < z1 ? z0 : z1) <= range.max + RANGE_SLACK &&
           (z0 < z1 ? z1 : z0) >= range.min - RANGE_SLACK;
}

static void walk_tree(const walk *w)
{
    uint32_t top = w->sheet->levels - 1, l = top, node[2] = {0, 0};
    const uint32_t ahead[2] = {w->direction[0] > 0, w->direction[1] > 0};
    const double far[2] = {ahead[0] ? w->sheet->width - 1 : 0,
                           ahead[1] ? w->sheet->height - 1 : 0};
    double t = 0;
    for (;;) {
        double edge[2], leave[2];
        for (int a = 0; a < 2; ++a) {
            edge[a] = plane(w, a, node[a] + ahead[a], l);
            leave[a] = time_at(w, a, edge[a]);
        }
        int axis = leave[1] < leave[0];
        double exit = leave[axis] < w->length ? leave[axis] : w->length;
        exit = exit > t ? exit : t;
        gtx_range range = w->sheet->tree[l][(size_t)node[1] * w->sheet->tree_width[l] + node[0]];
        if (range_met(w, range, t, exit)) {
            if (l > 0) {
                for (int a = 0; a < 2; ++a)
                    node[a] = child(w, a, node[a], l, t);
                --l;
                continue;
            }
            if (cross_cell(w, node[0], node[1], t, exit))
                return;
        }
        if (exit >= w->length || edge[axis] == far[axis])
            return;
        t = exit;
        uint32_t parent = node[axis] >> 1;
        node[axis] = ahead[axis] ? node[axis] + 1 : node[axis] - 1;
        if (node[axis] >> 1 != parent && l < top) {
            node[0] >>= 1;
            node[1] >>= 1;
            ++l;
        }
    }
}

void gtx_walk_sheet(const gtx_caster *caster, uint32_t sheet, const gtx_line *ray, bool both,
                    gtx_crossing *best)
{
    const gtx_sheet *s = &caster->sheets[sheet];
    gtx_line line = gtx_sheet_line(s, ray);
    double t0 = ray->t_min, t1 = best->t;
    if (s->low[0] > s->high[0] || !clip(s, &line, &t0, &t1))
        return;
    walk w = {.caster = caster, .sheet = s, .index = sheet, .both = both || s->two_sided,
              .start = t0, .length = t1 - t0, .t_min = ray->t_min, .best = best};
    double fastest = 1e-300; /* of x and y; a ray along z never leaves its cell */
    for (int a = 0; a < 3; ++a) {
        w.direction[a] = line.direction[a];
        w.origin[a] = line.origin[a] + t0 * line.direction[a];
        if (a < 2) {
            w.inverse[a] = 1 / w.direction[a];
            fastest = fmax(fastest, fabs(w.direction[a]));
        }
    }
    w.overlap = OVERLAP / fastest;
    walk_tree(&w);
}
