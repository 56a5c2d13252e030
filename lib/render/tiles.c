/* Tiles: which slabs of an instance may cover which squares of pixels, nearest first. */
#include "render/renderer.h"

#include "base/alloc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TILE = 8, RECORD_TEXELS = 8, SLAB_TEXELS = 4 };

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
    double rays[4][3];        /* origin, direction, x, y: the camera's columns in grid space */
    float row[3][4];          /* grid space -> x, y, t */
    const gtx_slab *slabs;
    uint32_t count, patch, level;
    bool two_sided, perspective;
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
    gtx_scratch *all[] = {&t->seen, &t->heads, &t->records, &t->slabs, &t->lists, &t->corners};
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
                        const gtx_instance_data *placed, float place[PLACE_ROWS][4])
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
        place[PLACE_ORIGIN][k] = (float)c.origin[k];
        for (int r = 0; r < 3; ++r)
            place[PLACE_X + r][k] = (float)c.column[r][k];
        place[PLACE_CLIP_Z][1 + k] = (float)dot4(clip[2], c.column[k], 0);
        memcpy(place[PLACE_WORLD + k], placed->world[k], sizeof place[0]);
    }
    place[PLACE_CLIP_Z][0] = (float)dot4(clip[2], c.origin, 1);
    place[PLACE_CLIP_W][0] = c.perspective ? 0.0f : (float)w;
    place[PLACE_CLIP_W][1] = c.perspective ? 1.0f : 0.0f;
    place[PLACE_CLIP_W][2] = (float)c.width;
    place[PLACE_CLIP_W][3] = (float)c.height;
    return c;
}

static void put(uint32_t out[4], const double xyz[3], uint32_t w)
{
    const float f[3] = {(float)xyz[0], (float)xyz[1], (float)xyz[2]};
    memcpy(out, f, sizeof f);
    out[3] = w;
}

static uint32_t bits_of(double value)
{
    const float f = (float)value;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

static void normalize(double v[3])
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; ++k)
        v[k] /= length;
}

/* What takes the patch's normals to the world: columns of gtx_normal_frame times the transposed
 * inverse of object -> world, whose rows of columns are placed->object. */
static void put_normals(const gtx_instance_data *placed, const float (*record)[4],
                        const uint32_t rest[3], uint32_t out[3][4])
{
    double axes[3][3], along = 0;
    for (int k = 0; k < 3; ++k) {
        axes[0][k] = record[4][k];
        axes[2][k] = record[6][k];
    }
    normalize(axes[2]);
    for (int k = 0; k < 3; ++k)
        along += axes[0][k] * axes[2][k];
    for (int k = 0; k < 3; ++k)
        axes[0][k] -= along * axes[2][k];
    normalize(axes[0]);
    for (int k = 0; k < 3; ++k)
        axes[1][k] = axes[2][(k + 1) % 3] * axes[0][(k + 2) % 3] -
                     axes[2][(k + 2) % 3] * axes[0][(k + 1) % 3];
    for (int a = 0; a < 3; ++a) {
        double world[3] = {0};
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 3; ++i)
                world[k] += (double)placed->object[i][k] * axes[a][i];
        put(out[a], world, rest[a]);
    }
}

/* Looks at a patch at a level, and writes its record. */
static sight sight_of(const camera *c, const gtx_model *model, const gtx_instance_data *placed,
                      const gtx_plan_entry *entry, uint32_t out[RECORD_TEXELS][4])
{
    const float (*record)[4] = (const float (*)[4])model->records[entry->patch];
    const uint32_t slot = entry->level * model->patch_count + entry->patch;
    sight s = {.slabs = model->slabs + model->first_slab[slot],
               .count = model->first_slab[slot + 1] - model->first_slab[slot],
               .patch = entry->patch, .level = entry->level,
               .two_sided = record[6][3] > 0, .perspective = c->perspective};
    double volume = 0;
    for (int k = 0; k < 3; ++k) {
        const double row[4] = {record[k][0], record[k][1], record[k][2], record[k][3]};
        s.rays[0][k] = dot4(row, c->origin, 1);
        s.rays[1][k] = dot4(row, c->column[2], 0);
        s.rays[2][k] = dot4(row, c->column[0], 0);
        s.rays[3][k] = dot4(row, c->column[1], 0);
        for (int a = 0; a < 4; ++a) { /* record[3] is the origin, then the axes */
            const double p[3] = {record[3 + a][0], record[3 + a][1], record[3 + a][2]};
            s.row[k][(a + 3) % 4] = (float)dot4(c->row[k], p, a == 0);
        }
    }
    for (int k = 0; k < 3; ++k)
        volume += s.rays[1][k] * (s.rays[2][(k + 1) % 3] * s.rays[3][(k + 2) % 3] -
                                  s.rays[2][(k + 2) % 3] * s.rays[3][(k + 1) % 3]);
    const uint32_t rest[4] = {
        (uint32_t)record[7][0] | (uint32_t)record[7][1] << 16,
        (uint32_t)record[7][2] | (uint32_t)record[7][3] << 16,
        (uint32_t)record[5][3] | entry->level << 24 | (uint32_t)s.two_sided << 31, 0};
    for (int i = 0; i < 4; ++i)
        put(out[i], s.rays[i], rest[i]);
    put_normals(placed, record, rest, out + 4);
    out[7][0] = entry->patch;
    out[7][1] = bits_of(fabs(volume));
    return s;
}

/* One pair of a slab's planes, which bound a linear function over grid space: its values along the
 * columns of rays, and the bounds. See gtx_meets in geotex_tiles.glsl. */
static void put_planes(const double value[4], double low, double high, bool perspective,
                       uint32_t out[4])
{
    const double a = low - value[0], b = high - value[0];
    if (perspective) {
        const double far = fabs(a) > fabs(b) ? a : b, near = fabs(a) > fabs(b) ? b : a;
        const double linear[3] = {value[2] / far, value[3] / far, value[1] / far};
        put(out, linear, bits_of(fmax(fmin(far / near, 1e30), -1e30)));
    } else {
        const double along = copysign(fmax(fabs(value[1]), 1e-20), value[1]);
        const double linear[3] = {-value[2] / along, -value[3] / along,
                                  (along > 0 ? a : b) / along};
        put(out, linear, bits_of((high - low) / fabs(along)));
    }
}

/* Writes a slab's record. */
static void put_slab(const sight *s, const gtx_slab *slab, uint32_t record_at,
                     uint32_t out[SLAB_TEXELS][4])
{
    double value[4];
    for (int k = 0; k < 2; ++k) {
        for (int i = 0; i < 4; ++i)
            value[i] = s->rays[i][k];
        put_planes(value, (double)slab->low[k], (double)slab->high[k], s->perspective, out[k]);
        out[3][0] |= (uint32_t)(slab->low[k] + 0.5f) >> s->level << 16 * k;
        out[3][1] |= ((uint32_t)(slab->high[k] + 0.5f) - 1) >> s->level << 16 * k;
    }
    for (int i = 0; i < 4; ++i)
        value[i] = s->rays[i][2] - (double)slab->slope[0] * s->rays[i][0] -
                   (double)slab->slope[1] * s->rays[i][1];
    put_planes(value, (double)slab->height[0], (double)slab->height[1], s->perspective, out[2]);
    out[3][2] = record_at;
}

static float greatest(const float a[2], const float b[2])
{
    return fmaxf(fmaxf(a[0] * b[0], a[0] * b[1]), fmaxf(a[1] * b[0], a[1] * b[1]));
}

/* Whether no ray crosses the slab's sheet from above. */
static bool faces_away(const sight *s, const gtx_slab *slab)
{
    const float o[3] = {(float)s->rays[0][0], (float)s->rays[0][1], (float)s->rays[0][2]};
    const float d[3] = {(float)s->rays[1][0], (float)s->rays[1][1], (float)s->rays[1][2]};
    if (s->two_sided)
        return false;
    if (!s->perspective)
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

/* Finds the slabs in view, nearest first, and the records of their patches. */
static bool find_slabs(gtx_renderer *renderer, const camera *c, const gtx_model *model,
                       const gtx_instance_data *placed, uint32_t records_at)
{
    gtx_tiles *t = &renderer->tiles;
    const gtx_plan *plan = &renderer->plan;
    t->record_texels = RECORD_TEXELS * model->patch_count;
    t->seen_count = 0;
    size_t most = 0;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const gtx_plan_entry *e = &plan->entries[i];
        const uint32_t *first = &model->first_slab[e->level * model->patch_count + e->patch];
        most += first[1] - first[0];
    }
    gtx_seen_slab *seen = reserve(renderer, &t->seen, most, sizeof *seen);
    uint32_t (*records)[RECORD_TEXELS][4] =
        reserve(renderer, &t->records, model->patch_count, sizeof *records);
    uint32_t (*slabs)[SLAB_TEXELS][4] = reserve(renderer, &t->slabs, most, sizeof *slabs);
    if (!seen || !records || !slabs)
        return false;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const gtx_plan_entry *entry = &plan->entries[i];
        const sight s = sight_of(c, model, placed, entry, records[entry->patch]);
        for (uint32_t k = 0; k < s.count; ++k) {
            const gtx_slab *slab = &s.slabs[k];
            gtx_seen_slab *out = &seen[t->seen_count];
            if (slab->low[0] > slab->high[0] || faces_away(&s, slab) ||
                !project(c, &s, slab, out))
                continue;
            memset(slabs[t->seen_count], 0, sizeof *slabs);
            put_slab(&s, slab, records_at + RECORD_TEXELS * s.patch, slabs[t->seen_count]);
            out->slab = t->seen_count++;
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

/* Each tile that a slab may cover. */
#define FOR_EACH_TILE(s, x, y)                                                                     \
    for (uint32_t y = (s)->y0; y <= (s)->y1; ++y)                                                  \
        for (uint32_t x = (s)->x0; x <= (s)->x1; ++x)                                              \
            if (covers(s, x, y))

/* Heads of the lists: where each begins and ends in the stream, whose first texels they are. Returns
 * where the last one ends, and counts the tiles that have any. */
static uint64_t make_heads(gtx_tiles *t, uint32_t columns, uint32_t (*heads)[4], size_t count,
                           uint64_t begin)
{
    const gtx_seen_slab *seen = t->seen.data;
    memset(heads, 0, count * sizeof *heads);
    for (const gtx_seen_slab *s = seen; s < seen + t->seen_count; ++s)
        FOR_EACH_TILE(s, x, y)
            ++heads[y * columns + x][2];
    t->tile_count = 0;
    for (size_t i = 0; i < count; ++i) {
        heads[i][0] = heads[i][1] = (uint32_t)begin; /* the end moves on as the list fills up */
        begin += heads[i][2];
        t->tile_count += heads[i][2] > 0;
    }
    return begin;
}

/* Puts each slab into the lists of its tiles. */
static void list_slabs(const gtx_tiles *t, uint32_t columns, uint32_t (*heads)[4],
                       uint32_t (*lists)[4])
{
    const gtx_seen_slab *seen = t->seen.data;
    const uint32_t first = t->head_texels + t->record_texels, begin = first + t->slab_texels;
    for (const gtx_seen_slab *s = seen; s < seen + t->seen_count; ++s)
        FOR_EACH_TILE(s, x, y) {
            uint32_t *entry = lists[heads[y * columns + x][1]++ - begin];
            entry[0] = first + SLAB_TEXELS * s->slab;
            entry[1] = bits_of(s->near);
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

/* Outlines the tiles that have a slab. */
static void outline(gtx_tiles *t, uint32_t columns, uint32_t rows, const uint32_t (*heads)[4])
{
    t->corner_count = 0;
    for (uint32_t y = 0; y < rows; ++y)
        for (uint32_t x = 0, from = 0; x < columns; ++x) {
            const uint32_t (*head)[4] = &heads[y * columns + x];
            if (!head[0][2])
                from = x + 1;
            else if (x + 1 == columns || !head[1][2])
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
    if (tiles > (size_t)t->max_texels ||
        !find_slabs(renderer, &c, model, placed, (uint32_t)tiles))
        return false;
    uint32_t (*heads)[4] = reserve(renderer, &t->heads, tiles, sizeof *heads);
    if (!heads)
        return false;
    t->head_texels = (uint32_t)tiles;
    t->slab_texels = SLAB_TEXELS * t->seen_count;
    const uint64_t before = (uint64_t)tiles + t->record_texels + t->slab_texels;
    const uint64_t texels = make_heads(t, columns, heads, tiles, before);
    if (texels > (uint64_t)t->max_texels)
        return false;
    t->list_texels = (uint32_t)(texels - before);
    uint32_t (*lists)[4] = reserve(renderer, &t->lists, t->list_texels, sizeof *lists);
    if (!lists ||
        !reserve(renderer, &t->corners, 6 * (size_t)t->tile_count, 2 * sizeof(uint16_t)))
        return false;
    list_slabs(t, columns, heads, lists);
    outline(t, columns, rows, (const uint32_t (*)[4])heads);
    t->place[PLACE_STREAM][0] = (float)columns;
    return true;
}
