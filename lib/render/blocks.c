/* Which blocks of displaced grids are drawn: culled against the view, and those that face away. */
#include "render/frustum.h"
#include "render/grid.h"
#include "render/renderer.h"

#include <math.h>

/* The view as a patch's grid space has it. */
typedef struct patch_view {
    double side[GTX_FRUSTUM_SIDES][4];
    uint32_t side_count;      /* that cut the patch */
    double eye[4], w[4];      /* w: of clip space */
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

/* The coarsest stride within the error that the view allows where the block is nearest. */
static uint8_t stride_of(const gtx_frustum *f, const patch_view *v, const gtx_slab *s,
                         const gtx_block_facts *facts)
{
    if (f->level >= 0)
        return (uint8_t)(f->level < GTX_BLOCK_STRIDES ? f->level : GTX_BLOCK_STRIDES - 1);
    if (s->low[0] > s->high[0]) /* there is nothing, and its neighbours keep their nodes */
        return 0;
    const double *w = v->w;
    const double farther = greatest(s, -w[0] - w[2] * s->slope[0], -w[1] - w[2] * s->slope[1]);
    const double nearest = w[3] - farther + w[2] * s->height[w[2] < 0];
    const double allowed = fmax(nearest, 0) / f->scale;
    uint8_t stride = 0;
    while (stride + 1 < GTX_BLOCK_STRIDES && facts->error[stride + 1] <= allowed)
        ++stride;
    return stride;
}

/* A patch's blocks, in rows. */
typedef struct blocks {
    uint32_t patch, columns, rows;
    const gtx_slab *slabs;
    const gtx_block_facts *facts;
    const uint8_t *strides;
} blocks;

static blocks blocks_of(const gtx_model *model, uint32_t patch)
{
    const float *rect = model->records[patch][GTX_RECORD_RECT];
    const uint32_t first = model->first_slab[patch];
    const uint32_t columns = ((uint32_t)rect[2] - 2) / GTX_BLOCK_CELLS + 1;
    return (blocks){patch, columns, (model->first_slab[patch + 1] - first) / columns,
                    model->slabs + first, model->blocks + first, NULL};
}

/* The stride of a block's edge towards a neighbour: the coarser of both. */
static uint32_t edge_of(const blocks *b, uint32_t own, uint32_t column, uint32_t row)
{
    if (column >= b->columns || row >= b->rows) /* -1, too */
        return own;
    const uint32_t other = b->strides[row * b->columns + column];
    return own > other ? own : other;
}

static gtx_block block_at(const blocks *b, uint32_t column, uint32_t row)
{
    const uint32_t own = b->strides[row * b->columns + column];
    const uint32_t edges = edge_of(b, own, column - 1, row) |
                           edge_of(b, own, column + 1, row) << 2 |
                           edge_of(b, own, column, row - 1) << 4 |
                           edge_of(b, own, column, row + 1) << 6;
    return (gtx_block){b->patch | own << GTX_PROXY_KIND_SHIFT, column | row << 11 | edges << 22};
}

/* What a patch's blocks in view come to. */
typedef struct sum {
    uint32_t blocks, triangles;
    double pixels;
} sum;

/* A square of 2x2, 4x4 or all of a block's parts, as gtx_block_facts has them; x and y in parts. */
typedef struct square {
    gtx_block block;
    uint32_t stride, side, x, y, looks;
} square;

/* Adds what shows of a square: as a whole, or that of its quarters, down to a stride. */
static void add(const gtx_block_facts *facts, square s, found_block *out, sum *all)
{
    static const uint16_t rows[5] = {0, 0x1, 0x33, 0, 0xffff};
    const uint32_t mask = (uint32_t)rows[s.side] << (4 * s.y + s.x);
    const uint32_t strides = 2 * s.side >> s.stride;
    if (!(facts->some & mask))
        return;
    const bool whole = (facts->whole & mask) == mask;
    if (!whole && s.side > 1 && strides > 1) {
        const uint32_t half = s.side / 2;
        for (uint32_t q = 0; q < 4; ++q)
            add(facts, (square){s.block, s.stride, half, s.x + half * (q & 1),
                                s.y + half * (q >> 1), s.looks}, out, all);
        return;
    }
    const uint32_t pattern = strides == 8 ? 0 : strides == 4 ? 1 : strides == 2 ? 2 : 3;
    const uint32_t looks = s.looks + (whole ? 0 : GTX_BLOCK_TRIMMED);
    all->triangles += gtx_pattern_triangles(pattern);
    out[all->blocks++] = (found_block){{s.block.patch | s.x << 30, s.block.place | s.y << 30},
                                       looks * GTX_GRID_PATTERNS + pattern};
}

/* The blocks of a patch in view that may face the eye. */
static sum find(const gtx_frustum *f, const gtx_model *model, uint32_t patch, uint8_t *strides,
                found_block *out)
{
    const patch_view v = view_of(f, model, patch);
    blocks b = blocks_of(model, patch);
    sum all = {0, 0, 0};
    b.strides = strides;
    for (uint32_t i = 0; i < b.columns * b.rows; ++i)
        strides[i] = stride_of(f, &v, &b.slabs[i], &b.facts[i]);
    for (uint32_t i = 0; i < b.columns * b.rows; ++i) {
        const gtx_slab *s = &b.slabs[i];
        if (s->low[0] > s->high[0] || !is_in_view(&v, s) || !(v.two_sided || may_face(&v, s)))
            continue;
        all.pixels += pixels_of(&v, f, s, model->records[patch]);
        add(&b.facts[i], (square){block_at(&b, i % b.columns, i / b.columns), strides[i], 4, 0, 0,
                                  v.two_sided ? GTX_BLOCK_TWO_SIDED : 0}, out, &all);
    }
    return all;
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

/* Room for the blocks of all entries, and the strides of one. */
static bool reserve(gtx_renderer *renderer, const gtx_model *model)
{
    const gtx_plan *plan = &renderer->plan;
    const gtx_allocator *hooks = &renderer->allocator;
    gtx_grids *grids = &renderer->grids;
    size_t room = 0;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const uint32_t *first = &model->first_slab[plan->entries[i].patch];
        room += first[1] - first[0];
    }
    const size_t parts = 16 * room;
    return gtx_scratch_reserve(hooks, &grids->found, parts, sizeof(found_block)) &&
           gtx_scratch_reserve(hooks, &grids->blocks, parts, sizeof(gtx_block)) &&
           gtx_scratch_reserve(hooks, &grids->strides, room, 1);
}

bool gtx_blocks_fill(const gtx_draw_call *draw, const gtx_model *model,
                     const gtx_instance_data *placed)
{
    gtx_renderer *renderer = draw->renderer;
    gtx_plan *plan = &renderer->plan;
    gtx_grids *grids = &renderer->grids;
    const gtx_frustum f = gtx_frustum_of(draw, model, placed);
    const bool all = draw->view->method == GTX_METHOD_GRID;
    uint32_t count = 0, left = 0;
    if (!reserve(renderer, model))
        return false;
    found_block *found = grids->found.data;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const gtx_plan_entry entry = plan->entries[i];
        const sum s = find(&f, model, entry.patch, grids->strides.data, found + count);
        const bool box = entry.distance < 0; /* may cover the picture, whatever the patch does */
        if (all || box || gtx_is_grid_cheaper(draw, s.triangles, s.pixels))
            count += s.blocks;
        else
            plan->entries[left++] = entry;
    }
    plan->count = left;
    put_in_order(found, count, grids);
    return true;
}
