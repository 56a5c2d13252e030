/* Masked depth of displaced grids: triangles fill the tiles of a picture, dot by dot. */
#include "frame/occlusion.h"

#include "frame/techniques.h"

#include <math.h>

/* Dots are squares of DOT x DOT pixels, filled where their middle is; tiles are SIDE x SIDE dots.
 * With dots of a pixel near views of a bunny take up to a tenth longer, of four as long. What
 * counts around things that are hidden, in dots, is as large as what triangles may fill by
 * mistake. */
enum { DOT = 2, SIDE = 8, AROUND = 4 };

/* Of a tile: up to where all of its dots are filled, and what is behind that is hidden; and dots
 * that are filled besides, no farther than `layer`. */
typedef struct tile {
    uint64_t filled;
    float layer, far;
} tile;

/* In dots, and the t of gtx_camera_rows. */
typedef struct point {
    float x, y, t;
} point;

/* How far, in shares, what is hidden has to lie behind. */
static const float clearance = 1e-4f;

/* Dots from first to last, and the least t. */
typedef struct bounds {
    double x[2], y[2], near;
} bounds;

/* Of a sphere in object space, from without. */
static bounds bounds_of(const gtx_camera_rows *c, const float sphere[3], double radius)
{
    double low[3], high[3];
    for (int r = 0; r < 3; ++r) {
        const double *row = c->row[r];
        const double at = row[0] * sphere[0] + row[1] * sphere[1] + row[2] * sphere[2] + row[3];
        const double reach =
            radius * sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
        low[r] = at - reach;
        high[r] = at + reach;
    }
    bounds b = {{low[0], high[0]}, {low[1], high[1]}, low[2]};
    if (c->perspective && low[2] > 0) {
        b.x[0] /= low[0] < 0 ? low[2] : high[2];
        b.x[1] /= high[0] < 0 ? high[2] : low[2];
        b.y[0] /= low[1] < 0 ? low[2] : high[2];
        b.y[1] /= high[1] < 0 ? high[2] : low[2];
    } else if (c->perspective) {
        b = (bounds){{0, c->width}, {0, c->height}, low[2]};
    }
    return b;
}

static int32_t within(double value, int32_t low, int32_t high)
{
    return (int32_t)fmin(fmax(floor(value), low), high);
}

void gtx_occlusion_end(gtx_occlusion *o)
{
    o->columns = o->rows = 0;
}

void gtx_occlusion_begin(gtx_occlusion *o, const gtx_draw_call *draw, const gtx_model *model,
                         const gtx_instance_data *placed)
{
    float place[GTX_PLACE_ROWS][4];
    gtx_occlusion_end(o);
    if (!gtx_tiles_suit(draw) ||
        (gtx_is_own(draw) && !(draw->view->flags & GTX_VIEW_SHADING_SOLID)))
        return;
    o->camera = gtx_camera_rows_of(draw, placed, place);
    for (int r = 0; r < 2; ++r)
        for (int k = 0; k < 4; ++k)
            o->camera.row[r][k] /= DOT;
    o->camera.width = (o->camera.width + DOT - 1) / DOT;
    o->camera.height = (o->camera.height + DOT - 1) / DOT;
    const bounds b = bounds_of(&o->camera, model->sphere, (double)model->sphere[3]);
    const int32_t width = (int32_t)o->camera.width, height = (int32_t)o->camera.height;
    o->x = within(b.x[0], 0, width);
    o->y = within(b.y[0], 0, height);
    const int32_t columns = (within(b.x[1] + 1, 0, width) - o->x + SIDE - 1) / SIDE;
    const int32_t rows = (within(b.y[1] + 1, 0, height) - o->y + SIDE - 1) / SIDE;
    const size_t count = (size_t)columns * (size_t)rows;
    tile *tiles = gtx_scratch_reserve(&draw->planner->allocator, &o->tiles, count, sizeof *tiles);
    if (!tiles)
        return;
    for (size_t i = 0; i < count; ++i)
        tiles[i] = (tile){0, -INFINITY, INFINITY};
    o->columns = columns;
    o->rows = rows;
}

/* ---- what hides ---- */

static void fill(tile *in, uint64_t dots, float t)
{
    in->filled |= dots;
    in->layer = t > in->layer ? t : in->layer;
    if (in->filled == UINT64_MAX) {
        in->far = in->layer < in->far ? in->layer : in->far;
        in->filled = 0;
        in->layer = -INFINITY;
    }
}

/* The first dot of an axis whose centre is not before `at`, but for rounding: of triangles at an
 * edge both have the same. */
static inline int32_t first_from(float at, int32_t end)
{
    const int32_t first = (int32_t)((at > 0 ? at : 0) + 0.49999f);
    return first < end ? first : end;
}

/* An edge from the upper end down: both triangles at it find the same dots. */
typedef struct edge {
    float x, y, slope;
} edge;

static edge edge_of(const point *upper, const point *lower)
{
    const float height = lower->y - upper->y;
    return (edge){upper->x, upper->y, height > 0 ? (lower->x - upper->x) / height : 0};
}

static float edge_at(const edge *e, float y)
{
    return e->x + (y - e->y) * e->slope;
}

/* Rows of a tile that a triangle has dots in: of each the first one, and the one behind the
 * last. */
typedef struct spans {
    int32_t top, bottom, first[SIDE], end[SIDE];
} spans;

static inline uint32_t dots_before(int32_t x)
{
    return (1u << (x < 0 ? 0 : x > SIDE ? SIDE : x)) - 1;
}

/* Dots of the tile that begins at x. */
static inline uint64_t dots_of(const spans *s, int32_t x)
{
    uint64_t out = 0;
    for (int32_t r = s->top; r < s->bottom; ++r)
        out |= (uint64_t)(dots_before(s->end[r] - x) & ~dots_before(s->first[r] - x))
               << (SIDE * r);
    return out;
}

static void swap_if(bool wanted, const point **a, const point **b)
{
    const point *const first = *a;
    if (wanted) {
        *a = *b;
        *b = first;
    }
}

static float least_of(float a, float b, float c)
{
    const float ab = a < b ? a : b;
    return ab < c ? ab : c;
}

/* Whether there is no dot between first and end in x and y, or all are in a tile that is filled
 * before t, as they mostly are. */
static bool adds_nothing(const gtx_occlusion *o, const int32_t x[2], const int32_t y[2], float t)
{
    if (x[0] >= x[1] || y[0] >= y[1])
        return true;
    const tile *in = (const tile *)o->tiles.data + y[0] / SIDE * o->columns + x[0] / SIDE;
    return x[0] / SIDE == (x[1] - 1) / SIDE && y[0] / SIDE == (y[1] - 1) / SIDE && t >= in->far;
}

/* Fills the dots whose centres are in a triangle. */
static void fill_triangle(const gtx_occlusion *o, const point *a, const point *b, const point *c)
{
    tile *tiles = o->tiles.data;
    const int32_t width = o->columns * SIDE, height = o->rows * SIDE;
    const float t = -least_of(-a->t, -b->t, -c->t);
    const int32_t across[2] = {first_from(least_of(a->x, b->x, c->x), width),
                               first_from(-least_of(-a->x, -b->x, -c->x), width)};
    const int32_t down[2] = {first_from(least_of(a->y, b->y, c->y), height),
                             first_from(-least_of(-a->y, -b->y, -c->y), height)};
    if (adds_nothing(o, across, down, t))
        return;
    swap_if(b->y < a->y, &a, &b);
    swap_if(c->y < b->y, &b, &c);
    swap_if(b->y < a->y, &a, &b);
    const int32_t end = down[1];
    const edge whole = edge_of(a, c), upper = edge_of(a, b), lower = edge_of(b, c);
    for (int32_t y = down[0]; y < end;) {
        const int32_t row = y / SIDE, from = row * SIDE;
        spans s = {.top = y - from, .bottom = (end - from < SIDE ? end - from : SIDE)};
        int32_t first = width, last = 0;
        for (int32_t r = s.top; r < s.bottom; ++r, ++y) {
            const float at = (float)y + 0.5f;
            const float one = edge_at(&whole, at);
            const float other = edge_at(at < b->y ? &upper : &lower, at);
            const int32_t begin = first_from(one < other ? one : other, width);
            const int32_t behind = first_from(one < other ? other : one, width);
            s.first[r] = begin;
            s.end[r] = behind;
            first = begin < first ? begin : first;
            last = behind > last ? behind : last;
        }
        for (int32_t x = first / SIDE; x * SIDE < last; ++x)
            if (t < tiles[row * o->columns + x].far)
                fill(&tiles[row * o->columns + x], dots_of(&s, x * SIDE), t);
    }
}

/* Whether it is no larger than what counts around things hidden. */
static bool is_small(const point *a, const point *b, const point *c)
{
    const float most = AROUND;
    return fabsf(a->x - b->x) <= most && fabsf(b->x - c->x) <= most && fabsf(c->x - a->x) <= most &&
           fabsf(a->y - b->y) <= most && fabsf(b->y - c->y) <= most && fabsf(c->y - a->y) <= most;
}

gtx_patch_view gtx_occlusion_view(const gtx_occlusion *o, gtx_record record)
{
    gtx_patch_view v = {.perspective = o->camera.perspective};
    gtx_camera_over_patch(&o->camera, (const float (*)[4])record, &v);
    return v;
}

/* Vertices since `first`; those before the near plane, or far beside the picture, have no place. */
static bool place_points(gtx_occlusion *o, const gtx_patch_view *v, const gtx_grids *grids,
                         uint32_t first, const gtx_allocator *hooks)
{
    const float most = 1 << 20;
    const gtx_grid_vertex *vertices = grids->vertices.data;
    const uint32_t count = grids->vertex_count - first;
    point *points = gtx_scratch_reserve(hooks, &o->points, count, sizeof *points);
    for (uint32_t i = 0; points && i < count; ++i) {
        const gtx_grid_vertex *n = &vertices[first + i];
        double of[3];
        gtx_grid_place(n, of);
        const float p[3] = {(float)of[0], (float)of[1], (float)of[2]};
        float at[4];
        for (int k = 0; k < 4; ++k) {
            const float *row = k < 3 ? v->row[k] : v->near;
            at[k] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
        }
        const float per = v->perspective ? 1 / at[2] : 1;
        const float x = at[0] * per - (float)o->x, y = at[1] * per - (float)o->y;
        const bool is_placed = at[3] > 0 && fabsf(x) < most && fabsf(y) < most;
        points[i] = (point){x, y, is_placed ? at[2] : INFINITY};
    }
    return points;
}

void gtx_occlusion_add(gtx_occlusion *o, const gtx_model *model, uint32_t patch,
                       const gtx_grids *grids, const gtx_grids_state *before,
                       const gtx_allocator *hooks)
{
    if (!o->columns || !o->rows)
        return;
    const gtx_patch_view v = gtx_occlusion_view(o, model->records[patch]);
    if (!place_points(o, &v, grids, before->vertices, hooks))
        return;
    const point *points = o->points.data;
    for (uint32_t k = 0; k < GTX_GRID_LOOKS; ++k) {
        const uint32_t *index = grids->indices[k].data;
        for (uint32_t i = before->indices[k]; i < grids->index_count[k]; i += 3) {
            const point *a = &points[index[i] - before->vertices];
            const point *b = &points[index[i + 1] - before->vertices];
            const point *c = &points[index[i + 2] - before->vertices];
            if (a->t < INFINITY && b->t < INFINITY && c->t < INFINITY &&
                (!(k & GTX_GRID_TRIMMED) || is_small(a, b, c)))
                fill_triangle(o, a, b, c);
        }
    }
}

/* ---- what is hidden ---- */

/* Whether all tiles from dot to dot, of the viewport, are filled before `near`. */
static bool is_hidden(const gtx_occlusion *o, const int32_t x[2], const int32_t y[2], float near)
{
    const tile *tiles = o->tiles.data;
    const int32_t x0 = (x[0] > o->x ? x[0] - o->x : 0) / SIDE;
    const int32_t y0 = (y[0] > o->y ? y[0] - o->y : 0) / SIDE;
    const int32_t x1 = x[1] < o->x ? -1 : (x[1] - o->x) / SIDE;
    const int32_t y1 = y[1] < o->y ? -1 : (y[1] - o->y) / SIDE;
    for (int32_t j = y0; j <= y1 && j < o->rows; ++j)
        for (int32_t i = x0; i <= x1 && i < o->columns; ++i)
            if (!(tiles[j * o->columns + i].far < near))
                return false;
    return o->columns && o->rows;
}

bool gtx_is_slab_hidden(const gtx_occlusion *o, const gtx_patch_view *view, const gtx_slab *slab)
{
    gtx_visible_slab s;
    if (!o->columns || !o->rows)
        return false;
    if (!gtx_project_slab(&o->camera, view, slab, &s))
        return false; /* only nearly out of view, as others see it */
    const int32_t x[2] = {GTX_TILE * s.x0 - AROUND, GTX_TILE * (s.x1 + 1) + AROUND - 1};
    const int32_t y[2] = {GTX_TILE * s.y0 - AROUND, GTX_TILE * (s.y1 + 1) + AROUND - 1};
    return is_hidden(o, x, y, s.near - clearance * fabsf(s.near));
}

bool gtx_is_sphere_hidden(const gtx_occlusion *o, const float sphere[3], double radius)
{
    if (!o->columns || !o->rows)
        return false;
    const bounds b = bounds_of(&o->camera, sphere, radius);
    const int32_t width = (int32_t)o->camera.width, height = (int32_t)o->camera.height;
    const int32_t x[2] = {within(b.x[0] - AROUND, 0, width), within(b.x[1] + AROUND, 0, width)};
    const int32_t y[2] = {within(b.y[0] - AROUND, 0, height), within(b.y[1] + AROUND, 0, height)};
    const float near = (float)b.near;
    return is_hidden(o, x, y, near - clearance * fabsf(near));
}

void gtx_occlusion_free(gtx_occlusion *o, const gtx_allocator *allocator)
{
    gtx_scratch_free(allocator, &o->tiles);
    gtx_scratch_free(allocator, &o->points);
}
