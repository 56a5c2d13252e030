/* Tiles: which slabs of an instance may cover which squares of pixels, nearest first. */
#include "render/renderer.h"

#include "base/alloc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TILE = 8, RAY_TEXELS = 5 };

/* How far, in pixels, rounding may move a slab's outline. */
static const float slack = 0.03f;

/* The camera: rows of object space -> x, y and t, x and y times t when it is perspective; and what
 * geotex_tiles.glsl says of rays, in double. */
typedef struct camera {
    double row[3][4], origin[3], column[3][3]; /* column: what a pixel in x, in y, and t add */
    bool perspective;
    uint32_t width, height;
} camera;

/* A patch in the camera's sight. */
typedef struct sight {
    float row[3][4];          /* grid space -> x, y, t */
    float origin[3], direction[3]; /* the eye; or the direction of an orthographic camera */
    const gtx_slab *slabs;
    uint32_t first, count, patch;
    bool two_sided;
} sight;

/* Room of `count` x `size` bytes, or NULL. */
static void *reserve(gtx_renderer *renderer, gtx_scratch *scratch, size_t count, size_t size)
{
    const size_t wanted = count * size;
    if (wanted <= scratch->size && scratch->data)
        return scratch->data;
    gtx_free_array(&renderer->allocator, scratch->data, scratch->size, 1);
    scratch->size = wanted + wanted / 2 + 64;
    scratch->data = gtx_alloc_array(&renderer->allocator, scratch->size, 1);
    if (!scratch->data)
        scratch->size = 0;
    return scratch->data;
}

void gtx_tiles_free(gtx_renderer *renderer)
{
    gtx_tiles *t = &renderer->tiles;
    gtx_scratch *all[] = {&t->seen, &t->first, &t->lists, &t->rays, &t->corners};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        gtx_free_array(&renderer->allocator, all[i]->data, all[i]->size, 1);
        *all[i] = (gtx_scratch){0};
    }
}

static double dot4(const double row[4], const double p[3], double w)
{
    return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3] * w;
}

/* Inverts the rows: origin and columns. */
static void invert(camera *c)
{
    double cofactor[3][3], det = 0;
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k) {
            const double *a = c->row[(r + 1) % 3], *b = c->row[(r + 2) % 3];
            cofactor[r][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        }
    for (int k = 0; k < 3; ++k)
        det += c->row[0][k] * cofactor[0][k];
    for (int k = 0; k < 3; ++k) {
        c->origin[k] = 0;
        for (int r = 0; r < 3; ++r) {
            c->column[r][k] = cofactor[r][k] / det;
            c->origin[k] -= c->column[r][k] * c->row[r][3];
        }
    }
}

static camera camera_of(const gtx_view *view, const gtx_frame *frame,
                        const gtx_instance_data *placed, float place[12][4])
{
    camera c = {.perspective = frame->depth[3] > 0, .width = view->viewport_width,
                .height = view->viewport_height};
    const double half[2] = {c.width / 2.0, c.height / 2.0};
    double clip[4][4] = {{0}};
    for (int r = 0; r < 4; ++r) {
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 3; ++i)
                clip[r][k] += (double)frame->clip_from_world[4 * i + r] * placed->world[i][k];
        clip[r][3] += frame->clip_from_world[12 + r];
    }
    const double w = c.perspective ? 1 : clip[3][3], sign = frame->reversed ? -1 : 1;
    for (int k = 0; k < 4; ++k) {
        c.row[0][k] = (clip[0][k] + clip[3][k]) * half[0] / w;
        c.row[1][k] = (clip[1][k] + clip[3][k]) * half[1] / w;
        c.row[2][k] = c.perspective ? clip[3][k] : sign * clip[2][k] / w;
    }
    invert(&c);
    for (int k = 0; k < 3; ++k) {
        memcpy(place[k], placed->object[k], sizeof place[k]);
        memcpy(place[9 + k], placed->world[k], sizeof place[k]);
        place[3][k] = (float)c.origin[k];
        for (int r = 0; r < 3; ++r)
            place[4 + r][k] = (float)c.column[r][k];
        place[7][1 + k] = (float)dot4(clip[2], c.column[k], 0);
    }
    place[7][0] = (float)dot4(clip[2], c.origin, 1);
    place[8][0] = c.perspective ? 0.0f : (float)w;
    place[8][1] = c.perspective ? 1.0f : 0.0f;
    place[8][2] = (float)c.width;
    place[8][3] = (float)c.height;
    return c;
}

/* Looks at a patch at a level, and writes its rays. */
static sight sight_of(const camera *c, const gtx_model *model, const gtx_plan_entry *entry,
                      float rays[RAY_TEXELS][4])
{
    const float (*record)[4] = (const float (*)[4])model->records[entry->patch];
    const uint32_t slot = entry->level * model->patch_count + entry->patch;
    sight s = {.first = model->first_slab[slot], .patch = entry->patch,
               .two_sided = record[6][3] > 0};
    s.slabs = model->slabs + s.first;
    s.count = model->first_slab[slot + 1] - s.first;
    for (int k = 0; k < 3; ++k) {
        const double row[4] = {record[k][0], record[k][1], record[k][2], record[k][3]};
        rays[0][k] = s.origin[k] = (float)dot4(row, c->origin, 1);
        rays[1][k] = s.direction[k] = (float)dot4(row, c->column[2], 0);
        rays[2][k] = (float)dot4(row, c->column[0], 0);
        rays[3][k] = (float)dot4(row, c->column[1], 0);
        for (int a = 0; a < 4; ++a) { /* record[3] is the origin, then the axes */
            const double p[3] = {record[3 + a][0], record[3 + a][1], record[3 + a][2]};
            s.row[k][(a + 3) % 4] = (float)dot4(c->row[k], p, a == 0);
        }
    }
    rays[0][3] = (float)entry->level;
    rays[1][3] = record[5][3];
    rays[2][3] = record[6][3];
    memcpy(rays[4], record[7], sizeof rays[4]);
    return s;
}

static float greatest(const float a[2], const float b[2])
{
    return fmaxf(fmaxf(a[0] * b[0], a[0] * b[1]), fmaxf(a[1] * b[0], a[1] * b[1]));
}

/* Whether no ray crosses the slab's sheet from above. */
static bool faces_away(const sight *s, const gtx_slab *slab, bool perspective)
{
    const float *o = s->origin, *d = s->direction;
    if (s->two_sided)
        return false;
    if (!perspective)
        return d[2] - slab->slope[0] * d[0] - slab->slope[1] * d[1] >
               greatest(slab->rise_x, (float[2]){d[0], d[0]}) +
                   greatest(slab->rise_y, (float[2]){d[1], d[1]});
    const float x[2] = {slab->low[0] - o[0], slab->high[0] - o[0]};
    const float y[2] = {slab->low[1] - o[1], slab->high[1] - o[1]};
    const float z = slab->height[0] - (o[2] - slab->slope[0] * o[0] - slab->slope[1] * o[1]);
    return z > greatest(slab->rise_x, x) + greatest(slab->rise_y, y);
}

static void extend(float range[2], float value)
{
    range[0] = fminf(range[0], value);
    range[1] = fmaxf(range[1], value);
}

/* The tiles along an axis of which some pixel's centre is within; false when there is none. */
static bool tiles_of(const float range[2], uint32_t pixels, uint16_t *first, uint16_t *last)
{
    const float low = fmaxf(ceilf(range[0] - 0.5f - slack), 0);
    const float high = fminf(floorf(range[1] - 0.5f + slack), (float)pixels - 1);
    if (!(low <= high))
        return false;
    *first = (uint16_t)((uint32_t)low / TILE);
    *last = (uint16_t)((uint32_t)high / TILE);
    return true;
}

/* Where a slab is in the picture; false when it is not. One that the eye's plane cuts may be
 * anywhere. */
static bool project(const camera *c, const sight *s, const gtx_slab *slab, gtx_seen_slab *out)
{
    float x[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY}, t[2] = {INFINITY, -INFINITY};
    float sum[2] = {INFINITY, -INFINITY}, difference[2] = {INFINITY, -INFINITY};
    for (int n = 0; n < 8; ++n) {
        const float gx = n & 1 ? slab->high[0] : slab->low[0];
        const float gy = n & 2 ? slab->high[1] : slab->low[1];
        const float gz = slab->slope[0] * gx + slab->slope[1] * gy + slab->height[n >> 2];
        float p[3];
        for (int k = 0; k < 3; ++k)
            p[k] = s->row[k][0] * gx + s->row[k][1] * gy + s->row[k][2] * gz + s->row[k][3];
        const float inverse = c->perspective ? 1 / p[2] : 1;
        p[0] *= inverse;
        p[1] *= inverse;
        extend(x, p[0]);
        extend(y, p[1]);
        extend(t, p[2]);
        extend(sum, p[0] + p[1]);
        extend(difference, p[0] - p[1]);
    }
    if (c->perspective && !(t[1] > 0))
        return false;
    out->near = t[0];
    if (c->perspective && !(t[0] > 1e-4f * t[1])) {
        const float all[2] = {-INFINITY, INFINITY};
        out->near = -INFINITY;
        memcpy(x, all, sizeof all);
        memcpy(y, all, sizeof all);
        memcpy(sum, all, sizeof all);
        memcpy(difference, all, sizeof all);
    }
    memcpy(out->sum, sum, sizeof sum);
    memcpy(out->difference, difference, sizeof difference);
    return tiles_of(x, c->width, &out->x0, &out->x1) && tiles_of(y, c->height, &out->y0, &out->y1);
}

static int compare(const void *a, const void *b)
{
    const gtx_seen_slab *x = a, *y = b;
    if (x->near != y->near)
        return x->near < y->near ? -1 : 1;
    return x->slab < y->slab ? -1 : x->slab > y->slab;
}

/* Finds the slabs in view, nearest first, and the rays of their patches. */
static bool find_slabs(gtx_renderer *renderer, const camera *c, const gtx_model *model)
{
    gtx_tiles *t = &renderer->tiles;
    const gtx_plan *plan = &renderer->plan;
    t->ray_texels = RAY_TEXELS * model->patch_count;
    t->seen_count = 0;
    size_t most = 0;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const gtx_plan_entry *e = &plan->entries[i];
        const uint32_t *first = &model->first_slab[e->level * model->patch_count + e->patch];
        most += first[1] - first[0];
    }
    gtx_seen_slab *seen = reserve(renderer, &t->seen, most, sizeof *seen);
    float (*rays)[RAY_TEXELS][4] =
        reserve(renderer, &t->rays, model->patch_count, sizeof *rays);
    if (!seen || !rays)
        return false;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const sight s = sight_of(c, model, &plan->entries[i], rays[plan->entries[i].patch]);
        for (uint32_t k = 0; k < s.count; ++k) {
            const gtx_slab *slab = &s.slabs[k];
            gtx_seen_slab *out = &seen[t->seen_count];
            if (slab->low[0] > slab->high[0] || faces_away(&s, slab, c->perspective) ||
                !project(c, &s, slab, out))
                continue;
            out->slab = s.first + k;
            out->patch = s.patch;
            ++t->seen_count;
        }
    }
    qsort(seen, t->seen_count, sizeof *seen, compare);
    return true;
}

static bool covers(const gtx_seen_slab *s, uint32_t x, uint32_t y)
{
    const float half = TILE / 2.0f, reach = TILE - 1 + 2 * slack;
    const float sum = (float)(TILE * (x + y)) + 2 * half;
    const float difference = (float)TILE * ((float)x - (float)y);
    return sum + reach >= s->sum[0] && sum - reach <= s->sum[1] &&
           difference + reach >= s->difference[0] && difference - reach <= s->difference[1];
}

/* How many slabs each of `columns` x `rows` tiles has, from first[2] on. */
static void count_slabs(const gtx_tiles *t, uint32_t columns, uint32_t *first)
{
    const gtx_seen_slab *seen = t->seen.data;
    for (const gtx_seen_slab *s = seen; s < seen + t->seen_count; ++s)
        for (uint32_t y = s->y0; y <= s->y1; ++y)
            for (uint32_t x = s->x0; x <= s->x1; ++x)
                first[y * columns + x + 2] += covers(s, x, y);
}

/* Puts each slab into the lists of its tiles, whose ends are in first[1] on. */
static void list_slabs(const gtx_tiles *t, uint32_t columns, uint32_t *first,
                       uint32_t (*lists)[4])
{
    const gtx_seen_slab *seen = t->seen.data;
    for (const gtx_seen_slab *s = seen; s < seen + t->seen_count; ++s)
        for (uint32_t y = s->y0; y <= s->y1; ++y)
            for (uint32_t x = s->x0; x <= s->x1; ++x) {
                if (!covers(s, x, y))
                    continue;
                uint32_t *entry = lists[first[y * columns + x + 1]++];
                entry[0] = s->slab;
                entry[1] = s->patch;
                memcpy(&entry[2], &s->near, sizeof s->near);
            }
}

/* Two triangles over tiles x0..x1 of a row. */
static void add_corners(gtx_tiles *t, uint32_t x0, uint32_t x1, uint32_t y)
{
    static const uint8_t order[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0, 1}, {1, 0}, {1, 1}};
    uint16_t (*corner)[2] = (uint16_t (*)[2])t->corners.data + t->corner_count;
    for (int k = 0; k < 6; ++k) {
        corner[k][0] = (uint16_t)(TILE * (order[k][0] ? x1 + 1 : x0));
        corner[k][1] = (uint16_t)(TILE * (y + order[k][1]));
    }
    t->corner_count += 6;
}

/* Heads the lists with the tiles that have a slab, and outlines those. */
static void head_lists(gtx_tiles *t, uint32_t columns, uint32_t rows, const uint32_t *first,
                       uint32_t (*lists)[4])
{
    t->tile_count = t->corner_count = 0;
    for (uint32_t y = 0; y < rows; ++y)
        for (uint32_t x = 0, from = 0; x < columns; ++x) {
            const uint32_t *f = &first[y * columns + x];
            if (f[0] == f[1]) {
                from = x + 1;
                continue;
            }
            uint32_t *head = lists[t->tile_count++];
            head[0] = x, head[1] = y, head[2] = f[0], head[3] = f[1];
            if (x + 1 == columns || f[1] == f[2])
                add_corners(t, from, x, y);
        }
}

bool gtx_tiles_fill(gtx_renderer *renderer, const gtx_view *view, const gtx_frame *frame,
                    const gtx_model *model, const gtx_instance_data *placed)
{
    gtx_tiles *t = &renderer->tiles;
    const camera c = camera_of(view, frame, placed, t->place);
    const uint32_t columns = (c.width + TILE - 1) / TILE, rows = (c.height + TILE - 1) / TILE;
    const size_t tiles = (size_t)columns * rows;
    if (!find_slabs(renderer, &c, model))
        return false;
    /* Counted two places on, the sums become first the begins, and as the lists fill up, the ends. */
    uint32_t *first = reserve(renderer, &t->first, tiles + 2, sizeof *first);
    if (!first)
        return false;
    memset(first, 0, (tiles + 2) * sizeof *first);
    count_slabs(t, columns, first);
    uint64_t active = 0;
    for (size_t i = 2; i < tiles + 2; ++i)
        active += first[i] > 0;
    uint64_t sum = active; /* the tiles' heads come before */
    first[0] = first[1] = (uint32_t)sum;
    for (size_t i = 2; i < tiles + 2; ++i) {
        sum += first[i];
        first[i] = (uint32_t)sum;
    }
    if (sum > (uint64_t)t->max_texels)
        return false;
    t->list_texels = (uint32_t)sum;
    uint32_t (*lists)[4] = reserve(renderer, &t->lists, (size_t)sum, sizeof *lists);
    if (!lists || !reserve(renderer, &t->corners, (size_t)(6 * active), 2 * sizeof(uint16_t)))
        return false;
    list_slabs(t, columns, first, lists);
    head_lists(t, columns, rows, first, lists);
    return true;
}
