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
    double reach = gtx_grid_greater(fabs(w[0]), fabs(w[1]));
    r.reach_of_cell = (fabs(w[0]) + fabs(w[1])) / 2;
    const double rise = rtin->rise[GTX_RTIN_LEVELS - 1];
    if (rtin->twist > 0)
        reach = gtx_grid_greater(reach, 2 * (r.reach_of_cell + fabs(w[2]) * rise));
    /* Where a patch is so far away that no cell is to be divided, none is looked at. */
    const double code = f->scale * (double)rtin->code;
    const double least = gtx_plane_at(&f->w, sphere) - f->w.slope * (double)sphere[3];
    if (r.by_error && code * (double)rtin->twist > least - reach)
        r.code = code;
    r.per_unit = r.scale > 0 ? 1 / r.scale : 0;
    r.per_twist = r.code > 0 ? 4 / r.code : 0;
    for (uint32_t level = GTX_RTIN_LEVELS; level-- > 0;) {
        const double away = GTX_RTIN_CELLS >> (level / 2 + 1);
        const double x = fabs(w[0]) * away, y = fabs(w[1]) * away;
        if (level + 1 < GTX_RTIN_LEVELS)
            reach += (level & 1 ? (x + y) / 2 : gtx_grid_greater(x, y)) +
                     fabs(w[2]) * rtin->rise[level];
        r.reach[level] = reach;
    }
    memset(grids->slots.data, NO_VERTEX, r.row * ((size_t)rtin->rows * GTX_RTIN_CELLS + 1) *
                                             sizeof(uint32_t));
    return r;
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
        above -= s->slope[k] * e[k] + gtx_grid_greater(gtx_grid_greater(low * from, low * to),
                                                       gtx_grid_greater(high * from, high * to));
    }
    return above >= 0;
}

static const gtx_rtin_node *node_at(const gtx_refined *b, const uint8_t at[2])
{
    return &b->nodes[gtx_block_node(at[0], at[1])];
}

/* How many corners of half a cell show: none where there is no cell. Outlines cross it in straight
 * lines. */
static int shown_corners(const gtx_refined *b, const gtx_rtin_triangle *t)
{
    int shown = 0;
    for (int c = 0; c < 3; ++c)
        shown += (node_at(b, t->corner[c])->bits & GTX_RTIN_WITHIN) != 0;
    return node_at(b, t->middle)->bits & GTX_RTIN_SOLID ? shown : 0;
}

/* What a triangle that is not halved is drawn by, or GTX_GRID_LOOKS where nothing shows of it.
 * Where it is larger than a cell outlines and rough normals are those of maps. */
static uint32_t looks_of(const gtx_refining *r, const gtx_refined *b, const gtx_rtin_triangle *t,
                         uint32_t level)
{
    const bool whole = (b->shown.whole & t->parts) == t->parts;
    if (level == GTX_RTIN_LEVELS) {
        const int shown = whole ? 3 : shown_corners(b, t);
        return shown ? (r->mapped ? GTX_GRID_MAPPED : 0) + (shown < 3 ? GTX_GRID_TRIMMED : 0)
                     : GTX_GRID_LOOKS;
    }
    if (!whole)
        return GTX_GRID_MAPPED + GTX_GRID_TRIMMED;
    return r->mapped || node_at(b, t->middle)->bits & GTX_RTIN_ROUGH ? GTX_GRID_MAPPED : 0;
}

/* Whether the eye is above the plane through corners, counterclockwise seen from above. */
static bool is_front(const gtx_refining *r, const gtx_refined *b,
                     const gtx_grid_point *const corner[3])
{
    const gtx_grid_point *p = corner[0], *q = corner[1], *o = corner[2];
    const int32_t u[3] = {(int32_t)(q->x - p->x), (int32_t)(q->y - p->y), (int32_t)(q->z - p->z)};
    const int32_t v[3] = {(int32_t)(o->x - p->x), (int32_t)(o->y - p->y), (int32_t)(o->z - p->z)};
    /* In grid space; z is in smaller parts than x and y. */
    const double parts = GTX_GRID_PARTS;
    const double x = (int32_t)(GTX_GRID_PARTS * b->x + p->x) / parts;
    const double y = (int32_t)(GTX_GRID_PARTS * b->y + p->y) / parts;
    const double z = (int32_t)p->z / (parts * parts);
    return (u[1] * v[2] - u[2] * v[1]) * (r->eye[0] - r->eye[3] * x) +
               (u[2] * v[0] - u[0] * v[2]) * (r->eye[1] - r->eye[3] * y) +
               GTX_GRID_PARTS * (u[0] * v[1] - u[1] * v[0]) * (r->eye[2] - r->eye[3] * z) >= 0;
}

/* The vertex of a point, which is there already where its slot tells of it. */
static uint32_t vertex_of(const gtx_refining *r, gtx_refined *b, const gtx_grid_point *p)
{
    enum { PARTS = GTX_GRID_PARTS };
    gtx_grids *g = r->grids;
    uint32_t *slot = (p->x | p->y) % PARTS
                         ? &b->places[p->y * GTX_BLOCK_PLACES + p->x]
                         : b->slots + p->y / PARTS * r->row + p->x / PARTS;
    if (*slot == UINT32_MAX) {
        *slot = g->vertex_count++;
        ((gtx_grid_vertex *)g->vertices.data)[*slot] = (gtx_grid_vertex){
            .x = (uint16_t)(PARTS * b->x + p->x), .y = (uint16_t)(PARTS * b->y + p->y),
            .code = (uint16_t)(p->z / (PARTS * PARTS)), .rest = (uint16_t)(p->z % (PARTS * PARTS)),
            .patch = r->patch};
    }
    return *slot;
}

/* Adds a triangle if it is seen. */
static void add_drawn(const gtx_refining *r, gtx_refined *b, const gtx_grid_point *const corner[3],
                      uint32_t from_front)
{
    static const uint8_t turned[2][3] = {{0, 1, 2}, {1, 2, 0}};
    const bool front = b->front || is_front(r, b, corner);
    const uint32_t looks = from_front + (front ? 0 : GTX_GRID_BEHIND);
    if (!front && !r->two_sided)
        return;
    uint32_t *to = (uint32_t *)r->grids->indices[looks].data + r->grids->index_count[looks];
    r->grids->index_count[looks] += 3;
    for (int c = 0; c < 3; ++c)
        to[turned[r->turn][c]] = vertex_of(r, b, corner[c]);
}

/* A triangle that is not halved. Halves of cells are divided as their surface and those beside it
 * ask for. */
static void add_whole(const gtx_refining *r, gtx_refined *b, const gtx_rtin_triangle *t,
                      uint32_t level)
{
    gtx_grid_point points[GTX_HALF_POINTS];
    const uint32_t looks = looks_of(r, b, t, level);
    const char *corner = "012";
    if (looks == GTX_GRID_LOOKS)
        return;
    for (int c = 0; c < 3; ++c)
        points[c] = (gtx_grid_point){
            GTX_GRID_PARTS * t->corner[c][0], GTX_GRID_PARTS * t->corner[c][1],
            GTX_GRID_PARTS * GTX_GRID_PARTS * node_at(b, t->corner[c])->code};
    if (level == GTX_RTIN_LEVELS && r->code > 0 && gtx_is_divided(r, b, t->middle))
        corner = gtx_divide_half(b, t->middle, points);
    for (; *corner; corner += 3) {
        const gtx_grid_point *const of[3] = {&points[corner[0] - '0'], &points[corner[1] - '0'],
                                             &points[corner[2] - '0']};
        add_drawn(r, b, of, looks);
    }
}

/* Whether triangles are to end at a middle. */
static bool is_halved(const gtx_refining *r, const gtx_refined *b, const uint8_t middle[2],
                      uint32_t level)
{
    const gtx_halved *h = &b->halved[level];
    const gtx_rtin_node *n = node_at(b, middle);
    const uint32_t error = n->bits & GTX_RTIN_MAX_ERROR;
    if (error >= h->all || n->bits & h->all_rough)
        return true;
    if (error < h->none && !(n->bits & h->any_rough))
        return false;
    const double w = r->w[0] * (b->x + middle[0]) + r->w[1] * (b->y + middle[1]) +
                     r->w[2] * n->code + r->w[3] - r->reach[level];
    return error * r->scale > w || (n->bits & GTX_RTIN_ROUGH && w < r->near);
}

/* Adds what shows of a triangle, as a whole or its halves. */
static void add(const gtx_refining *r, gtx_refined *b, uint32_t triangle, uint32_t level)
{
    const gtx_rtin_triangle *t = &r->grids->triangles[triangle];
    if (!(b->shown.some & t->parts))
        return;
    if (level == GTX_RTIN_LEVELS || !is_halved(r, b, t->middle, level)) {
        add_whole(r, b, t, level);
        return;
    }
    add(r, b, 2 * triangle, level + 1);
    add(r, b, 2 * triangle + 1, level + 1);
}

/* The greatest whole number up to `most` that is no more than a value; 0 below that. */
static uint32_t whole_of(double value, uint32_t most)
{
    return value < most ? value > 0 ? (uint32_t)value : 0 : most;
}

/* Finds what is halved by the range that w has in the block and beside it. */
static void limit(const gtx_refining *r, gtx_refined *b, const uint32_t codes[2])
{
    const double rounding = 1e-12; /* much more than that of what is found at a node */
    const double from[3] = {(double)b->x - 1, (double)b->y - 1, codes[0]};
    const double to[3] = {b->x + GTX_RTIN_CELLS + 1, b->y + GTX_RTIN_CELLS + 1, codes[1]};
    double low = r->w[3], high = r->w[3], off = fabs(r->w[3]) + r->reach[0];
    for (int k = 0; k < 3; ++k) {
        const double p = r->w[k] * from[k], q = r->w[k] * to[k];
        low += p < q ? p : q;
        high += p < q ? q : p;
        off += fabs(p) + fabs(q);
    }
    low -= rounding * off;
    high += rounding * off;
    for (uint32_t level = 0; level < GTX_RTIN_LEVELS; ++level) {
        const double least = low - r->reach[level], most = high - r->reach[level];
        gtx_halved *h = &b->halved[level];
        *h = (gtx_halved){1 + whole_of(most * r->per_unit, GTX_RTIN_MAX_ERROR),
                          1 + whole_of(least * r->per_unit, GTX_RTIN_MAX_ERROR),
                          most < r->near ? GTX_RTIN_ROUGH : 0,
                          least < r->near ? GTX_RTIN_ROUGH : 0};
        const uint32_t all = level < r->depth ? 0 : UINT32_MAX;
        if (!r->by_error)
            *h = (gtx_halved){all, all, 0, 0};
    }
    /* Corners are no farther from a cell's middle. */
    const double spread = fabs(r->w[2]) * (codes[1] - codes[0]) / 2;
    b->twist = whole_of((low - spread) * r->per_twist, 4 * UINT16_MAX);
}

/* Copies the nodes, and finds the range of their codes. */
static void load(const gtx_refining *r, gtx_refined *b, uint32_t codes[2])
{
    enum { CELLS = GTX_RTIN_CELLS, SIDE = CELLS + 3 };
    const uint32_t last = r->rtin->rows * CELLS;
    const bool right = b->x + CELLS + 1 < r->row;
    for (uint32_t j = 0; j < SIDE; ++j) {
        const uint32_t y = b->y + j > 1 ? b->y + j - 1 : 0;
        const gtx_rtin_node *from = &r->nodes[(y < last ? y : last) * r->row + b->x];
        gtx_rtin_node *to = &b->nodes[GTX_BLOCK_ROW * j];
        memcpy(to + 1, from, (CELLS + 1) * sizeof *to);
        to[0] = b->x ? from[-1] : (gtx_rtin_node){from[0].code, 0};
        to[SIDE - 1] = from[right ? CELLS + 1 : CELLS];
        for (uint32_t i = 0; !b->y && !j && i < SIDE; ++i)
            to[i].bits = 0;
    }
    codes[0] = codes[1] = b->nodes[0].code;
    for (uint32_t j = 0; j < SIDE; ++j)
        for (uint32_t i = 0; i < SIDE; ++i) {
            const uint32_t code = b->nodes[GTX_BLOCK_ROW * j + i].code;
            codes[0] = code < codes[0] ? code : codes[0];
            codes[1] = code > codes[1] ? code : codes[1];
        }
}

/* Room for all that a block may add. */
static bool reserve(const gtx_refining *r)
{
    gtx_grids *g = r->grids;
    const uint32_t triangles = GTX_RTIN_LEAF * (r->code > 0 ? GTX_HALF_TRIANGLES : 1);
    const uint32_t places = GTX_BLOCK_PLACES * GTX_BLOCK_PLACES;
    bool all = gtx_scratch_grow(r->hooks, &g->vertices, g->vertex_count + places,
                                sizeof(gtx_grid_vertex));
    for (uint32_t k = 0; k < (r->two_sided ? GTX_GRID_LOOKS : GTX_GRID_BEHIND); ++k)
        all = all && gtx_scratch_grow(r->hooks, &g->indices[k],
                                      g->index_count[k] + 3 * triangles, sizeof(uint32_t));
    return all;
}

bool gtx_refine_block(const gtx_refining *r, uint32_t column, uint32_t row)
{
    const uint32_t block = row * r->rtin->columns + column;
    uint32_t codes[2];
    gtx_refined b;
    if (!reserve(r))
        return false;
    b.found = false;
    b.shown = r->blocks[block];
    b.front = b.shown.whole == UINT16_MAX && is_all_front(r->eye, &r->slabs[block]);
    b.x = column * GTX_RTIN_CELLS;
    b.y = row * GTX_RTIN_CELLS;
    b.slots = (uint32_t *)r->grids->slots.data + b.y * r->row + b.x;
    load(r, &b, codes);
    limit(r, &b, codes);
    add(r, &b, 2, 0);
    add(r, &b, 3, 0);
    return true;
}
