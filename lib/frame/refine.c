/* The triangles of displaced grids: halved until the view's error is kept. */
#include "frame/grid.h"

#include <math.h>
#include <string.h>

/* Texels of so many pixels across, square to the eye, are lit at their corners, for a triangle more
 * takes less than looking maps up in so many pixels. In views close to a terrain grids take up to
 * 15 % longer at double, and up to twice as long without it; at half a bunny takes as long. */
static const double near_texel = 8;

/* The same where materials are shaded. In a cave and a hall of one material (tests/bench/paths)
 * frames take up to 5 % longer at half, and 6 to 15 % at double. */
static const double near_texel_shaded = 4;

/* All bytes of a slot without a vertex. */
enum { NO_VERTEX = 0xff };

/* The side of a texel, of a square of the same area. */
static double texel_of(gtx_record record)
{
    const float *x = record[GTX_RECORD_AXIS_X], *y = record[GTX_RECORD_AXIS_Y];
    double square = 0;
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        square += pow((double)x[a] * y[b] - (double)x[b] * y[a], 2);
    }
    return sqrt(sqrt(square));
}

gtx_refining gtx_refine(const gtx_frustum *f, const gtx_model *model, uint32_t patch,
                        const double w[4], const double eye[4], gtx_grids *grids,
                        const gtx_allocator *hooks)
{
    const gtx_rtin *rtin = &model->rtins[patch];
    const bool shaded = model->has_material || model->has_emission;
    const float *sphere = model->facts[patch].sphere;
    gtx_refining r = {.hooks = hooks, .grids = grids, .rtin = rtin,
                      .nodes = model->nodes + model->first_node[patch],
                      .blocks = model->blocks + model->first_slab[patch],
                      .slabs = model->slabs + model->first_slab[patch],
                      .patch = patch, .row = gtx_rtin_row(rtin),
                      .two_sided = model->records[patch][GTX_RECORD_TWO_SIDED][3] > 0,
                      .mapped = rtin->glossy,
                      .turn = model->lods.first_provokes,
                      .depth = GTX_RTIN_LEVELS, .by_error = f->level < 0,
                      .w = {w[0], w[1], w[2], w[3]},
                      .eye = {eye[0], eye[1], eye[2], eye[3]}, .scale = f->scale * rtin->unit,
                      .near = f->pixels * texel_of(model->records[patch]) /
                              (shaded ? near_texel_shaded : near_texel)};
    if (f->level > 0)
        r.depth -= 2 * (uint32_t)(f->level < 3 ? f->level : 3);
    /* A middle's triangles reach as far as its halves' middles; those of the finest level a
     * cell. */
    double reach = fmax(fabs(w[0]), fabs(w[1]));
    r.reach_of_cell = (fabs(w[0]) + fabs(w[1])) / 2;
    if (rtin->twist > 0)
        reach = fmax(reach, 2 * (r.reach_of_cell + fabs(w[2]) * rtin->rise[GTX_RTIN_LEVELS - 1]));
    /* Where a patch is so far away that no cell is to be divided, none is looked at. */
    const double code = f->scale * (double)rtin->code;
    const double least = gtx_plane_at(&f->w, sphere) - f->w.slope * (double)sphere[3];
    if (r.by_error && code * (double)rtin->twist > least - reach)
        r.code = code;
    for (uint32_t level = GTX_RTIN_LEVELS; level-- > 0;) {
        const double away = GTX_RTIN_CELLS >> (level / 2 + 1);
        const double x = fabs(w[0]) * away, y = fabs(w[1]) * away;
        if (level + 1 < GTX_RTIN_LEVELS)
            reach += (level & 1 ? (x + y) / 2 : fmax(x, y)) + fabs(w[2]) * rtin->rise[level];
        r.reach[level] = reach;
    }
    memset(grids->slots.data, NO_VERTEX, r.row * ((size_t)rtin->rows * GTX_RTIN_CELLS + 1) *
                                             sizeof(uint32_t));
    return r;
}

/* Whether triangles are to end at a middle. */
static bool is_halved(const gtx_refining *r, uint32_t level, uint32_t x, uint32_t y)
{
    if (level >= r->depth)
        return false;
    const gtx_rtin_node *n = &r->nodes[y * r->row + x];
    if (!r->by_error)
        return true;
    const uint32_t error = n->bits & GTX_RTIN_MAX_ERROR;
    const double w = r->w[0] * x + r->w[1] * y + r->w[2] * n->code + r->w[3] - r->reach[level];
    return (error && error * r->scale > w) || (n->bits & GTX_RTIN_ROUGH && w < r->near);
}

/* The vertex of a node, which is there already where its slot tells of it. */
static uint32_t vertex_of(const gtx_refining *r, uint32_t x, uint32_t y)
{
    gtx_grids *g = r->grids;
    gtx_grid_vertex *vertices = g->vertices.data;
    const uint32_t node = y * r->row + x;
    uint32_t *slot = (uint32_t *)g->slots.data + node;
    if (*slot != UINT32_MAX)
        return *slot;
    *slot = g->vertex_count++;
    vertices[*slot] = (gtx_grid_vertex){.x = (uint16_t)(GTX_GRID_PARTS * x),
                                        .y = (uint16_t)(GTX_GRID_PARTS * y),
                                        .code = r->nodes[node].code, .patch = r->patch};
    return *slot;
}

/* The same of a place in parts of a cell; between nodes each triangle has its own. */
static uint32_t vertex_between(const gtx_refining *r, const uint32_t at[2])
{
    enum { PARTS = GTX_GRID_PARTS };
    const uint32_t x = at[0] / PARTS, y = at[1] / PARTS, i = at[0] % PARTS, j = at[1] % PARTS;
    if (!i && !j)
        return vertex_of(r, x, y);
    const gtx_rtin_node *n = &r->nodes[y * r->row + x];
    const uint32_t across = i ? 1 : 0, down = j ? r->row : 0; /* on a side there may be no other */
    const uint32_t height = (PARTS - j) * ((PARTS - i) * n[0].code + i * n[across].code) +
                            j * ((PARTS - i) * n[down].code + i * n[down + across].code);
    gtx_grid_vertex *vertices = r->grids->vertices.data;
    vertices[r->grids->vertex_count] = (gtx_grid_vertex){
        .x = (uint16_t)at[0], .y = (uint16_t)at[1], .code = (uint16_t)(height / (PARTS * PARTS)),
        .rest = (uint16_t)(height % (PARTS * PARTS)), .patch = r->patch};
    return r->grids->vertex_count++;
}

/* Whether the eye is above the plane through corners, counterclockwise seen from above. */
static bool is_front(const gtx_refining *r, const gtx_grid_vertex *const corner[3])
{
    double at[3], side[2][3];
    gtx_grid_place(corner[0], at);
    for (int i = 0; i < 2; ++i) {
        gtx_grid_place(corner[i + 1], side[i]);
        for (int k = 0; k < 3; ++k)
            side[i][k] -= at[k];
    }
    const double *a = side[0], *b = side[1], *e = r->eye;
    double above = 0;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        above += (a[i] * b[j] - a[j] * b[i]) * (e[k] - e[3] * at[k]);
    }
    return above >= 0;
}

/* What shows of a block, its first node, and whether the eye is above all of its triangles. */
typedef struct place {
    gtx_rtin_block shown;
    uint32_t x, y;
    bool front;
} place;

static double greater(double a, double b)
{
    return a > b ? a : b;
}

/* Whether the eye e is above the planes of all triangles of a slab whose cells are all there. That
 * through p, which is h above the slab's slope, it is by e.z - slope e.xy - w h -
 * rise (e.xy - w p.xy). Triangles halved along a diagonal rise by what edges do, and half of what
 * those of the other axis differ by. */
static bool is_all_front(const double e[4], const gtx_slab *s)
{
    const float *rise[2] = {s->rise_x, s->rise_y};
    double above = e[2] - e[3] * s->height[1];
    for (int k = 0; k < 2; ++k) {
        const double more = 0.5 * ((double)rise[1 - k][1] - rise[1 - k][0]);
        const double low = rise[k][0] - more, high = rise[k][1] + more;
        const double from = e[k] - e[3] * s->high[k], to = e[k] - e[3] * s->low[k];
        above -= s->slope[k] * e[k] + greater(greater(low * from, low * to),
                                              greater(high * from, high * to));
    }
    return above >= 0;
}

/* How many corners of half a cell show: none where there is no cell. Outlines cross it in straight
 * lines. */
static int shown_corners(const gtx_refining *r, const place *at, const gtx_rtin_triangle *t)
{
    uint32_t x = GTX_RTIN_CELLS, y = GTX_RTIN_CELLS;
    int shown = 0;
    for (int c = 0; c < 3; ++c) {
        const uint32_t i = t->corner[c][0], j = t->corner[c][1];
        shown += (r->nodes[(at->y + j) * r->row + at->x + i].bits & GTX_RTIN_WITHIN) != 0;
        x = i < x ? i : x;
        y = j < y ? j : y;
    }
    return r->nodes[(at->y + y) * r->row + at->x + x].bits & GTX_RTIN_SOLID ? shown : 0;
}

/* What a triangle that is not halved is drawn by, or GTX_GRID_LOOKS where nothing shows of it.
 * Where it is larger than a cell outlines and rough normals are those of maps. */
static uint32_t looks_of(const gtx_refining *r, const place *at, const gtx_rtin_triangle *t,
                         uint32_t level)
{
    const uint32_t x = at->x + t->middle[0], y = at->y + t->middle[1];
    const bool whole = (at->shown.whole & t->parts) == t->parts;
    if (level == GTX_RTIN_LEVELS) {
        const int shown = whole ? 3 : shown_corners(r, at, t);
        return shown ? (r->mapped ? GTX_GRID_MAPPED : 0) + (shown < 3 ? GTX_GRID_TRIMMED : 0)
                     : GTX_GRID_LOOKS;
    }
    if (!whole)
        return GTX_GRID_MAPPED + GTX_GRID_TRIMMED;
    return r->mapped || r->nodes[y * r->row + x].bits & GTX_RTIN_ROUGH ? GTX_GRID_MAPPED : 0;
}

static void add_drawn(const gtx_refining *r, const place *at, const uint32_t index[3],
                      uint32_t from_front)
{
    const gtx_grid_vertex *vertices = r->grids->vertices.data;
    const gtx_grid_vertex *const corner[3] = {&vertices[index[0]], &vertices[index[1]],
                                              &vertices[index[2]]};
    const bool front = at->front || is_front(r, corner);
    const uint32_t looks = from_front + (front ? 0 : GTX_GRID_BEHIND);
    if (!front && !r->two_sided)
        return;
    uint32_t *to = (uint32_t *)r->grids->indices[looks].data + r->grids->index_count[looks];
    for (int c = 0; c < 3; ++c)
        to[(c + r->turn) % 3] = index[c];
    r->grids->index_count[looks] += 3;
}

/* Half a cell, divided as its surface and those beside it ask for. What is not whole is cut by
 * maps. */
static void add_half(const gtx_refining *r, const place *at, const gtx_rtin_triangle *t,
                     uint32_t from_front)
{
    uint32_t corner[3][2], divided[GTX_HALF_TRIANGLES][3][2];
    for (int c = 0; c < 3; ++c) {
        corner[c][0] = GTX_GRID_PARTS * (at->x + t->corner[c][0]);
        corner[c][1] = GTX_GRID_PARTS * (at->y + t->corner[c][1]);
    }
    const uint32_t count = gtx_divide_half(r, corner, divided);
    if (count > 1 && from_front & GTX_GRID_TRIMMED)
        from_front |= GTX_GRID_MAPPED;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t index[3];
        for (int c = 0; c < 3; ++c)
            index[c] = vertex_between(r, divided[i][c]);
        add_drawn(r, at, index, from_front);
    }
}

/* Adds what shows of a triangle, as a whole or its halves. */
static void add(const gtx_refining *r, const place *at, uint32_t triangle, uint32_t level)
{
    const gtx_rtin_triangle *t = &r->grids->triangles[triangle];
    if (!(at->shown.some & t->parts))
        return;
    if (is_halved(r, level, at->x + t->middle[0], at->y + t->middle[1])) {
        add(r, at, 2 * triangle, level + 1);
        add(r, at, 2 * triangle + 1, level + 1);
        return;
    }
    const uint32_t from_front = looks_of(r, at, t, level);
    if (from_front == GTX_GRID_LOOKS)
        return;
    if (level == GTX_RTIN_LEVELS && r->code > 0) {
        add_half(r, at, t, from_front);
        return;
    }
    uint32_t index[3];
    for (int c = 0; c < 3; ++c)
        index[c] = vertex_of(r, at->x + t->corner[c][0], at->y + t->corner[c][1]);
    add_drawn(r, at, index, from_front);
}

/* Room for all that a block may add. */
static bool reserve(const gtx_refining *r)
{
    gtx_grids *g = r->grids;
    const uint32_t triangles = GTX_RTIN_LEAF * (r->code > 0 ? GTX_HALF_TRIANGLES : 1);
    const uint32_t nodes = (GTX_RTIN_CELLS + 1) * (GTX_RTIN_CELLS + 1) +
                           (r->code > 0 ? 3 * triangles : 0);
    bool all = gtx_scratch_grow(r->hooks, &g->vertices, g->vertex_count + nodes,
                                sizeof(gtx_grid_vertex));
    for (uint32_t k = 0; k < (r->two_sided ? GTX_GRID_LOOKS : GTX_GRID_BEHIND); ++k)
        all = all && gtx_scratch_grow(r->hooks, &g->indices[k],
                                      g->index_count[k] + 3 * triangles, sizeof(uint32_t));
    return all;
}

bool gtx_refine_block(const gtx_refining *r, uint32_t column, uint32_t row)
{
    const uint32_t block = row * r->rtin->columns + column;
    place at = {r->blocks[block], column * GTX_RTIN_CELLS, row * GTX_RTIN_CELLS, false};
    if (!reserve(r))
        return false;
    at.front = at.shown.whole == UINT16_MAX && is_all_front(r->eye, &r->slabs[block]);
    add(r, &at, 2, 0);
    add(r, &at, 3, 0);
    return true;
}
