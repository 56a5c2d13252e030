/* Which blocks of displaced grids are drawn: culled against the view, and those that face away. */
#include "render/frustum.h"
#include "render/grid.h"
#include "render/renderer.h"

#include <math.h>

/* The view as a patch's grid space has it. */
typedef struct patch_view {
    double side[GTX_FRUSTUM_SIDES][4];
    uint32_t side_count;      /* that cut the patch */
    double eye[4];
    bool two_sided;
    double scale;             /* pixels square an object unit cubed, for pixels_of */
} patch_view;

/* A block that is in view, and its kind. */
typedef struct found_block {
    gtx_block block;
    uint32_t kind;
} found_block;

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

/* Whether the eye may be above the plane of any of its triangles. With h the height above the slab's
 * slope, and the eye e: it is e.z - slope e.xy - w h - rise (e.xy - w p.xy) above that through p. */
static bool may_face(const patch_view *v, const gtx_slab *s)
{
    const double *e = v->eye;
    double above = e[2] - s->slope[0] * e[0] - s->slope[1] * e[1] - e[3] * s->height[0];
    above -= least_product(s->rise_x, e[0] - e[3] * s->high[0], e[0] - e[3] * s->low[0]);
    above -= least_product(s->rise_y, e[1] - e[3] * s->high[1], e[1] - e[3] * s->low[1]);
    return above >= 0;
}

/* The blocks of a patch's level in view, and the pixels that they cover. Returns how many. */
static uint32_t find(const gtx_frustum *f, const gtx_model *model, const gtx_plan_entry *entry,
                     found_block *out, double *pixels)
{
    const patch_view v = view_of(f, model, entry->patch);
    const uint32_t slot = entry->level * model->patch_count + entry->patch;
    const uint32_t *first = &model->first_slab[slot];
    const float width = model->records[entry->patch][GTX_RECORD_RECT][2];
    const uint32_t columns = (((uint32_t)width - 2) >> entry->level) / GTX_SLAB_CELLS + 1;
    uint32_t count = 0;
    *pixels = 0;
    for (uint32_t i = first[0]; i < first[1]; ++i) {
        const gtx_slab *s = &model->slabs[i];
        const uint32_t at = i - first[0];
        if (s->low[0] > s->high[0] || !is_in_view(&v, s) || !(v.two_sided || may_face(&v, s)))
            continue;
        *pixels += pixels_of(&v, f, s, model->records[entry->patch]);
        out[count++] = (found_block){
            {entry->patch | entry->level << GTX_PROXY_KIND_SHIFT,
             at % columns * GTX_SLAB_CELLS | at / columns * GTX_SLAB_CELLS << 16},
            (model->whole[i] ? 0 : GTX_BLOCK_TRIMMED) + (v.two_sided ? GTX_BLOCK_TWO_SIDED : 0)};
    }
    return count;
}

/* Those of a kind follow one another, in the order in which they were found. */
static void put_in_order(const found_block *found, uint32_t count, gtx_grids *grids)
{
    gtx_block *out = grids->blocks.data, *next[GTX_BLOCK_KINDS];
    for (uint32_t k = 0; k < GTX_BLOCK_KINDS; ++k)
        grids->counts[k] = 0;
    for (uint32_t i = 0; i < count; ++i)
        ++grids->counts[found[i].kind];
    for (uint32_t k = 0; k < GTX_BLOCK_KINDS; ++k) {
        next[k] = out;
        out += grids->counts[k];
    }
    for (uint32_t i = 0; i < count; ++i)
        *next[found[i].kind]++ = found[i].block;
}

/* Room for the blocks of all entries. */
static found_block *reserve(gtx_renderer *renderer, const gtx_model *model)
{
    const gtx_plan *plan = &renderer->plan;
    gtx_grids *grids = &renderer->grids;
    size_t room = 0;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const uint32_t slot = plan->entries[i].level * model->patch_count + plan->entries[i].patch;
        room += model->first_slab[slot + 1] - model->first_slab[slot];
    }
    if (!gtx_scratch_reserve(&renderer->allocator, &grids->blocks, room, sizeof(gtx_block)))
        return NULL;
    return gtx_scratch_reserve(&renderer->allocator, &grids->found, room, sizeof(found_block));
}

bool gtx_blocks_fill(const gtx_draw_call *draw, const gtx_model *model,
                     const gtx_instance_data *placed)
{
    gtx_renderer *renderer = draw->renderer;
    gtx_plan *plan = &renderer->plan;
    gtx_grids *grids = &renderer->grids;
    const gtx_frustum f = gtx_frustum_of(draw, model, placed);
    found_block *found = reserve(renderer, model);
    uint32_t count = 0, left = 0;
    if (!found)
        return false;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const gtx_plan_entry entry = plan->entries[i];
        double pixels;
        const uint32_t more = find(&f, model, &entry, found + count, &pixels);
        if (draw->view->method == GTX_METHOD_GRID || gtx_is_grid_cheaper(draw, more, pixels))
            count += more;
        else
            plan->entries[left++] = entry;
    }
    plan->count = left;
    put_in_order(found, count, grids);
    return true;
}
