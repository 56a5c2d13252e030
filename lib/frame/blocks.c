/* Which blocks of displaced grids are drawn: culled against the view and what hides them, and those
 * that face away. */
#include "frame/mix.h"

#include <math.h>

/* The view as a patch's grid space has it. */
typedef struct patch_view {
    double side[GTX_FRUSTUM_SIDES][4];
    uint32_t side_count;      /* that cut the patch */
    double eye[4], w[4];      /* w: of clip space */
    bool two_sided;
} patch_view;

/* What pixels_of needs besides. */
typedef struct patch_scale {
    double toward[3][4];      /* the way to the eye in object space, as eye[3] scales it */
    double scale;             /* pixels square an object unit cubed */
} patch_scale;

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
    return v;
}

static patch_scale scale_of(const gtx_frustum *f, const gtx_model *model, uint32_t patch)
{
    float (*record)[4] = model->records[patch];
    patch_scale s = {.scale = f->pixels * f->pixels * volume_of(record)};
    for (int r = 0; r < 3; ++r) {
        double row[4] = {0, 0, 0, f->eye[r]};
        row[r] = -f->eye[3];
        take_to_grid(row, record, s.toward[r]);
    }
    return s;
}

/* The greatest that the linear function a x + b y has in the rectangle. */
static inline double greatest(const gtx_slab *s, double a, double b)
{
    return a * (a > 0 ? s->high[0] : s->low[0]) + b * (b > 0 ? s->high[1] : s->low[1]);
}

static inline bool is_in_view(const patch_view *v, const gtx_slab *s)
{
    for (uint32_t k = 0; k < v->side_count; ++k) {
        const double *p = v->side[k];
        if (greatest(s, p[0] + p[2] * s->slope[0], p[1] + p[2] * s->slope[1]) +
                p[2] * s->height[p[2] > 0] + p[3] < 0)
            return false;
    }
    return true;
}

/* fmin is a call. */
static inline double lesser(double a, double b)
{
    return a < b ? a : b;
}

/* The least of rise * away, of both in their ranges. */
static inline double least_product(const float rise[2], double low, double high)
{
    return lesser(lesser(rise[0] * low, rise[0] * high), lesser(rise[1] * low, rise[1] * high));
}

static inline double at(const double row[4], const double x[3])
{
    return row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3];
}

/* Pixels that a block covers, roughly: `above` is how far the eye is above its slope. */
static inline double pixels_of(const patch_view *v, const patch_scale *to, const gtx_slab *s)
{
    double grid[3], above = v->eye[2], away = 0;
    const double middle = ((double)s->height[0] + s->height[1]) / 2;
    grid[2] = middle;
    for (int k = 0; k < 2; ++k) {
        const double slope = s->slope[k];
        grid[k] = ((double)s->low[k] + s->high[k]) / 2;
        grid[2] += slope * grid[k];
        above -= slope * v->eye[k];
    }
    above -= v->eye[3] * middle;
    for (int r = 0; r < 3; ++r) {
        const double d = at(to->toward[r], grid);
        away += d * d;
    }
    const double w = at(v->w, grid);
    const double area = to->scale * (s->high[0] - s->low[0]) * (s->high[1] - s->low[1]);
    const double square = sqrt(away) * w * w;
    return area * fabs(above) / (square > 1e-300 ? square : 1e-300);
}

/* Whether the eye e may be above the plane of any of its triangles. Above that through p, which is
 * h above the slab's slope, it is e.z - slope e.xy - w h - rise (e.xy - w p.xy). */
static inline bool may_face(const patch_view *v, const gtx_slab *s)
{
    const double *e = v->eye;
    double above = e[2] - s->slope[0] * e[0] - s->slope[1] * e[1] - e[3] * s->height[0];
    above -= least_product(s->rise_x, e[0] - e[3] * s->high[0], e[0] - e[3] * s->low[0]);
    above -= least_product(s->rise_y, e[1] - e[3] * s->high[1], e[1] - e[3] * s->low[1]);
    return above >= 0;
}

static inline bool is_seen(const patch_view *v, const gtx_slab *s)
{
    return s->low[0] <= s->high[0] && is_in_view(v, s) && (v->two_sided || may_face(v, s));
}

uint32_t gtx_blocks_seen(const gtx_frustum *f, const gtx_model *model, uint32_t patch,
                         uint32_t level, uint32_t *shown)
{
    const patch_view v = view_of(f, model, patch);
    const uint32_t *first = &model->first_slab[level * model->patch_count + patch];
    const gtx_slab *slabs = model->slabs + first[0];
    const uint32_t count = first[1] - first[0];
    uint32_t seen = 0;
    for (uint32_t i = 0; i < count; ++i)
        if (f->two ? slabs[i].low[0] <= slabs[i].high[0] : is_seen(&v, &slabs[i]))
            shown[seen++] = i;
    return seen;
}

gtx_cover gtx_cover_of(const gtx_frustum *f, const gtx_model *model, uint32_t patch, double most,
                       const gtx_occlusion *occlusion, uint32_t *shown)
{
    const patch_view v = view_of(f, model, patch);
    const gtx_slab *slabs = model->slabs + model->first_slab[patch];
    const uint32_t count = model->first_slab[patch + 1] - model->first_slab[patch];
    const patch_scale to = scale_of(f, model, patch);
    gtx_patch_view over = {0};
    gtx_cover c = {0, 0, false};
    if (occlusion)
        over = gtx_occlusion_view(occlusion, model->records[patch]);
    for (uint32_t i = 0; i < count; ++i) {
        if (!is_seen(&v, &slabs[i]) ||
            (occlusion && gtx_is_slab_hidden(occlusion, &over, &slabs[i])))
            continue;
        c.pixels += lesser(pixels_of(&v, &to, &slabs[i]), most);
        shown[c.blocks++] = i;
    }
    return c;
}

bool gtx_blocks_add(gtx_planner *planner, const gtx_frustum *f, const gtx_model *model,
                    uint32_t patch, const uint32_t *shown, uint32_t count, uint32_t most)
{
    gtx_grids *grids = &planner->grids;
    const patch_view v = view_of(f, model, patch);
    const gtx_refining r =
        gtx_refine(f, model, patch, v.w, v.eye, grids, &planner->allocator);
    const gtx_grids_state before = gtx_grids_state_of(grids);
    uint32_t triangles = 0;
    for (uint32_t i = 0; i < count && triangles <= most; ++i) {
        if (!gtx_refine_block(&r, shown[i] % r.rtin->columns, shown[i] / r.rtin->columns))
            return false;
        triangles = gtx_triangles_since(grids, &before);
    }
    return triangles <= most;
}
