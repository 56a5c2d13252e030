/* Which blocks of displaced grids are drawn: culled against the view, and those that face away. */
#include "frame/grid.h"
#include "frame/planner.h"
#include "frame/project.h"

#include <float.h>
#include <math.h>

/* The view as a patch's grid space has it. */
typedef struct patch_view {
    double side[GTX_FRUSTUM_SIDES][4];
    uint32_t side_count;      /* that cut the patch */
    double eye[4], w[4];      /* w: of clip space */
    bool two_sided;
    double scale;             /* pixels square an object unit cubed, for pixels_of */
} patch_view;

/* A linear function over object space, over grid space. */
static void take_to_grid(const double row[4], gtx_record record, double out[4])
{
    static const int rows[4] = {GTX_RECORD_AXIS_X, GTX_RECORD_AXIS_Y, GTX_RECORD_AXIS_Z,
                                GTX_RECORD_ORIGIN};
    for (int k = 0; k < 4; ++k)
        out[k] = row[0] * record[rows[k]][0] + row[1] * record[rows[k]][1] +
                 row[2] * record[rows[k]][2];
    out[3] += row[3];
}

/* Of a cell of the grid, one code high. */
static double volume_of(gtx_record record)
{
    const float *x = record[GTX_RECORD_AXIS_X], *y = record[GTX_RECORD_AXIS_Y];
    const float *z = record[GTX_RECORD_AXIS_Z];
    double volume = 0;
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        volume += ((double)x[a] * y[b] - (double)x[b] * y[a]) * z[k];
    }
    return fabs(volume);
}

static patch_view view_of(const gtx_frustum *f, const gtx_model *model, uint32_t patch)
{
    float (*record)[4] = model->records[patch];
    const float *sphere = model->facts[patch].hull;
    patch_view v = {.two_sided = record[GTX_RECORD_TWO_SIDED][3] > 0};
    for (int k = 0; k < GTX_FRUSTUM_SIDES; ++k)
        if (gtx_plane_at(&f->side[k], sphere) < f->side[k].slope * sphere[3])
            take_to_grid(f->side[k].row, record, v.side[v.side_count++]);
    take_to_grid(f->w.row, record, v.w);
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 4; ++k)
            v.eye[r] += (double)record[GTX_RECORD_TO_GRID + r][k] * f->eye[k];
    v.eye[3] = f->eye[3];
    v.scale = f->pixels * f->pixels * volume_of(record);
    return v;
}

/* The greatest that the linear function a x + b y has in the rectangle. */
static double greatest(const gtx_slab *s, double a, double b)
{
    return a * (a > 0 ? s->high[0] : s->low[0]) + b * (b > 0 ? s->high[1] : s->low[1]);
}

static bool is_in_view(const patch_view *v, const gtx_slab *s)
{
    for (uint32_t k = 0; k < v->side_count; ++k) {
        const double *p = v->side[k];
        if (greatest(s, p[0] + p[2] * s->slope[0], p[1] + p[2] * s->slope[1]) +
                p[2] * s->height[p[2] > 0] + p[3] < 0)
            return false;
    }
    return true;
}

/* The least of rise * away, of both in their ranges. */
static double least_product(const float rise[2], double low, double high)
{
    return fmin(fmin(rise[0] * low, rise[0] * high), fmin(rise[1] * low, rise[1] * high));
}

/* Pixels that a block covers, roughly: `above` is how far the eye is above its slope. */
static double pixels_of(const patch_view *v, const gtx_frustum *f, const gtx_slab *s,
                        gtx_record record)
{
    double grid[3], away = 0, w = f->w.row[3], above = v->eye[2];
    for (int k = 0; k < 2; ++k) {
        grid[k] = (s->low[k] + s->high[k]) / 2;
        above -= s->slope[k] * v->eye[k];
    }
    const double middle = (s->height[0] + s->height[1]) / 2;
    grid[2] = middle + s->slope[0] * grid[0] + s->slope[1] * grid[1];
    above -= v->eye[3] * middle;
    for (int r = 0; r < 3; ++r) {
        const double p = record[GTX_RECORD_ORIGIN][r] + record[GTX_RECORD_AXIS_X][r] * grid[0] +
                         record[GTX_RECORD_AXIS_Y][r] * grid[1] +
                         record[GTX_RECORD_AXIS_Z][r] * grid[2];
        away += pow(f->eye[r] - f->eye[3] * p, 2);
        w += f->w.row[r] * p;
    }
    const double area = v->scale * (s->high[0] - s->low[0]) * (s->high[1] - s->low[1]);
    return area * fabs(above) / fmax(sqrt(away) * w * w, 1e-300);
}

/* Whether the eye e may be above the plane of any of its triangles. Above that through p, which is
 * h above the slab's slope, it is e.z - slope e.xy - w h - rise (e.xy - w p.xy). */
static bool may_face(const patch_view *v, const gtx_slab *s)
{
    const double *e = v->eye;
    double above = e[2] - s->slope[0] * e[0] - s->slope[1] * e[1] - e[3] * s->height[0];
    above -= least_product(s->rise_x, e[0] - e[3] * s->high[0], e[0] - e[3] * s->low[0]);
    above -= least_product(s->rise_y, e[1] - e[3] * s->high[1], e[1] - e[3] * s->low[1]);
    return above >= 0;
}

/* How much the grids hold. */
typedef struct fill {
    uint32_t vertices, indices[GTX_GRID_LOOKS];
} fill;

static fill fill_of(const gtx_grids *g)
{
    fill f = {.vertices = g->vertex_count};
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        f.indices[k] = g->index_count[k];
    return f;
}

static void empty_to(gtx_grids *g, const fill *f)
{
    g->vertex_count = f->vertices;
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        g->index_count[k] = f->indices[k];
}

static uint32_t triangles_since(const gtx_grids *g, const fill *f)
{
    uint32_t count = 0;
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        count += (g->index_count[k] - f->indices[k]) / 3;
    return count;
}

static bool is_seen(const patch_view *v, const gtx_slab *s)
{
    return s->low[0] <= s->high[0] && is_in_view(v, s) && (v->two_sided || may_face(v, s));
}

/* What a patch takes in the picture. */
typedef struct cover {
    double pixels;            /* of its blocks in view that may face the eye */
    double cast;              /* the same, or of the tiles that rays look them up in */
    bool grid;                /* it is drawn by a grid */
} cover;

static cover cover_of(const gtx_frustum *f, const gtx_model *model, uint32_t patch, bool tiles)
{
    const patch_view v = view_of(f, model, patch);
    const gtx_slab *slabs = model->slabs + model->first_slab[patch];
    const uint32_t count = model->first_slab[patch + 1] - model->first_slab[patch];
    cover c = {0, 0, false};
    for (uint32_t i = 0; i < count; ++i) {
        if (!is_seen(&v, &slabs[i]))
            continue;
        const double pixels = pixels_of(&v, f, &slabs[i], model->records[patch]);
        const double side = sqrt(pixels) + (tiles ? GTX_TILE : 0);
        c.pixels += pixels;
        c.cast += side * side;
    }
    return c;
}

/* Whether the eye is in a sphere. */
static bool is_inside(const gtx_frustum *f, const float sphere[4])
{
    double square = 0;
    for (int k = 0; k < 3; ++k)
        square += pow(f->eye[k] - f->eye[3] * sphere[k], 2);
    return square <= f->eye[3] * f->eye[3] * sphere[3] * sphere[3];
}

/* Blocks are counted on both sides and behind each other. Of what they cover rays look at so much
 * where all is cast, for they end at what is nearest: in 48 random views of a bunny and 36 of a
 * dragon. At half all takes as long, at double two in thirty views up to a fourth longer. */
static const double nearest_share = 0.4;

/* The same where others are grids, which hide nothing from rays. At half 24 of these views take a
 * fifteenth longer in all, at double views of a terrain a seventh. */
static const double beside_share = 0.7;

/* How many patches may be cast, nearest first, without a grid between them, until the rest is, too:
 * entries come nearest first, what is farther has fewer pixels a triangle, and finding triangles
 * that are not drawn takes time. Of 12 views of a bunny those from outside take up to a tenth less
 * than without it; at half, two others take a quarter and two fifths longer. */
static const uint32_t most_given_up = 6;

/* By fragments a patch's box may cover the picture, whatever the patch does; by tiles rays in it
 * start at the eye. Near planes often touch what they show. */
static bool is_beside(const gtx_draw_call *draw, const gtx_frustum *f, const float hull[4])
{
    return gtx_is_before_near(f, hull) && (!gtx_tiles_suit(draw) || is_inside(f, hull));
}

/* The share is less where much lies behind each other: if rays looked at all of it, an engine of
 * 1,150 patches would take twice as long (1280x1024). */
static double cast_cost(const gtx_draw_call *draw, const gtx_model *model, uint32_t patches,
                        double pixels)
{
    return gtx_cast_cost(draw, patches, pixels / (double)model->depth_complexity);
}

/* Looks at what each patch covers. Returns what casting all would take: more than anything else
 * where that must not be. */
static double cost_of_all(const gtx_draw_call *draw, const gtx_frustum *f, const gtx_model *model,
                          cover *covers)
{
    const gtx_plan *plan = &draw->planner->plan;
    const bool tiles = gtx_tiles_suit(draw);
    double pixels = 0;
    bool beside = false;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const uint32_t patch = plan->entries[i].patch;
        covers[i] = cover_of(f, model, patch, tiles);
        pixels += covers[i].cast;
        beside = beside || is_beside(draw, f, model->facts[patch].hull);
    }
    return beside ? DBL_MAX : cast_cost(draw, model, plan->count, nearest_share * pixels);
}

/* Adds the blocks of a patch in view that may face the eye, as long as that takes less than
 * `most` triangles. False if it gave up, or without memory. */
static bool add(const gtx_draw_call *draw, const gtx_frustum *f, const gtx_model *model,
                uint32_t patch, uint32_t most)
{
    gtx_planner *planner = draw->planner;
    gtx_grids *grids = &planner->grids;
    const patch_view v = view_of(f, model, patch);
    const gtx_refining r =
        gtx_refine(f, model, patch, v.w, v.eye, grids, &planner->allocator);
    const gtx_slab *slabs = model->slabs + model->first_slab[patch];
    const uint32_t count = r.rtin->columns * r.rtin->rows;
    const fill before = fill_of(grids);
    uint32_t triangles = 0;
    for (uint32_t i = 0; i < count && triangles <= most; ++i) {
        if (!is_seen(&v, &slabs[i]))
            continue;
        if (!gtx_refine_block(&r, i % r.rtin->columns, i / r.rtin->columns))
            return false;
        triangles = triangles_since(grids, &before);
    }
    return triangles <= most;
}

/* Room for the slots of any one patch. */
static bool reserve_slots(gtx_planner *planner, const gtx_model *model)
{
    const gtx_plan *plan = &planner->plan;
    size_t most = 0;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const size_t *first = &model->first_node[plan->entries[i].patch];
        most = first[1] - first[0] > most ? first[1] - first[0] : most;
    }
    return gtx_scratch_reserve(&planner->allocator, &planner->grids.slots, most,
                               sizeof(uint32_t));
}

static uint32_t triangles_in(double room)
{
    return (uint32_t)fmax(0, fmin(room, 1e9));
}

/* Grids instead of casting, patch by patch. False where casting all of them takes no more than
 * what was found. */
static bool mix(const gtx_draw_call *draw, const gtx_frustum *f, const gtx_model *model,
                double most, cover *covers)
{
    const gtx_plan *plan = &draw->planner->plan;
    gtx_grids *grids = &draw->planner->grids;
    double cost = 0;
    uint32_t given_up = 0;
    for (uint32_t i = 0; i < plan->count && cost < most; ++i) {
        const uint32_t patch = plan->entries[i].patch;
        const bool must = is_beside(draw, f, model->facts[patch].hull);
        const double cast = cast_cost(draw, model, 1, beside_share * covers[i].cast);
        const double empty = gtx_grid_cost(draw, 0, covers[i].pixels);
        const double room = (fmin(cast, most - cost) - empty) / gtx_grid_cost(draw, 1, 0);
        const fill before = fill_of(grids);
        covers[i].grid = (must || given_up < most_given_up) &&
                         add(draw, f, model, patch, must ? UINT32_MAX : triangles_in(room));
        if (!covers[i].grid)
            empty_to(grids, &before);
        given_up = covers[i].grid ? 0 : given_up + 1;
        cost += covers[i].grid ? empty + gtx_grid_cost(draw, triangles_since(grids, &before), 0)
                               : cast;
    }
    return cost < most;
}

static void all_grids(const gtx_draw_call *draw, const gtx_frustum *f, const gtx_model *model,
                      cover *covers)
{
    const gtx_plan *plan = &draw->planner->plan;
    gtx_grids *grids = &draw->planner->grids;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const fill before = fill_of(grids);
        covers[i].grid = add(draw, f, model, plan->entries[i].patch, UINT32_MAX);
        if (!covers[i].grid)
            empty_to(grids, &before);
    }
}

bool gtx_blocks_fill(const gtx_draw_call *draw, const gtx_model *model,
                     const gtx_instance_data *placed)
{
    gtx_planner *planner = draw->planner;
    gtx_plan *plan = &planner->plan;
    gtx_grids *grids = &planner->grids;
    const gtx_frustum f = gtx_frustum_of(draw, model, placed);
    const fill nothing = {.vertices = 0};
    uint32_t left = 0;
    cover *covers = gtx_scratch_reserve(&planner->allocator, &grids->covers, plan->count,
                                        sizeof *covers);
    empty_to(grids, &nothing);
    if (f.two || !covers || !reserve_slots(planner, model)) /* blocks are culled for one eye */
        return false;
    if (draw->view->method == GTX_METHOD_GRID) {
        all_grids(draw, &f, model, covers);
    } else if (!mix(draw, &f, model, cost_of_all(draw, &f, model, covers), covers)) {
        empty_to(grids, &nothing);
        return false;
    }
    for (uint32_t i = 0; i < plan->count; ++i)
        if (!covers[i].grid)
            plan->entries[left++] = plan->entries[i];
    plan->count = left;
    return true;
}

void gtx_grids_free(gtx_grids *grids, const gtx_allocator *allocator)
{
    gtx_scratch_free(allocator, &grids->vertices);
    gtx_scratch_free(allocator, &grids->slots);
    gtx_scratch_free(allocator, &grids->covers);
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        gtx_scratch_free(allocator, &grids->indices[k]);
}
