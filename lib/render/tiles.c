/* Tiles: which slabs of an instance may cover which squares of pixels, nearest first. */
#include "render/tiles.h"

#include "render/order.h"
#include "render/patch_view.h"
#include "render/renderer.h"

#include <math.h>
#include <string.h>

/* Pixels along a tile, and tiles along the height of a rectangle of them. */
enum { TILE = 4, BAND = 16 };

enum { CORNERS = 8 }; /* of a slab */

/* A slab in view, and the tiles that it may cover. */
typedef struct visible_slab {
    float near;               /* the least t of its points */
    uint16_t x0, x1, y0, y1;
    int32_t sum[2], difference[2]; /* of x and y */
} visible_slab;

/* Lists have at most so many entries for each tile of the viewport and for each slab in view.
 * Needles, whose slabs all reach across the picture, are cast in less time and memory in fragments.
 * Of 12 models and terrains, in pictures of 640x480, none had an eighth of it. */
enum { LISTED_A_TILE = 64, LISTED_A_SLAB = 8 };

/* How far, in pixels, rounding may move a slab's outline. */
static const float slack = 0.03f;

/* The least and the greatest of the values at the corners. */
static inline void range_of(const float value[CORNERS], float range[2])
{
    float low[CORNERS / 2], high[CORNERS / 2];
    for (int n = 0; n < CORNERS / 2; ++n) {
        const float a = value[n], b = value[n + CORNERS / 2];
        low[n] = a < b ? a : b;
        high[n] = a < b ? b : a;
    }
    range[0] = low[0];
    range[1] = high[0];
    for (int n = 1; n < CORNERS / 2; ++n) {
        range[0] = low[n] < range[0] ? low[n] : range[0];
        range[1] = high[n] > range[1] ? high[n] : range[1];
    }
}

/* Within bounds of at most 2^20, rounded down or up; a bound when it is no number. The C library's
 * own are calls where processors need not have the instruction. */
static int32_t floor_within(float value, int32_t low, int32_t high)
{
    value = value > (float)low ? value : (float)low;
    value = value < (float)high ? value : (float)high;
    const int32_t whole = (int32_t)value;
    return whole - (value < (float)whole);
}

static int32_t ceil_within(float value, int32_t low, int32_t high)
{
    return -floor_within(-value, -high, -low);
}

/* The tiles along an axis of which some pixel's centre is within; false when there is none. */
static bool tiles_of(const float range[2], uint32_t pixels, uint16_t *first, uint16_t *last)
{
    const int32_t end = (int32_t)pixels;
    const int32_t low = ceil_within(range[0] - 0.5f - slack, 0, end);
    const int32_t high = floor_within(range[1] - 0.5f + slack, -1, end - 1);
    *first = (uint16_t)(low / TILE);
    *last = (uint16_t)(high / TILE);
    return low <= high;
}

/* Which tiles have a pixel in a range of x + y, or of x - y, by the sum or the difference of the
 * tiles' own x and y. `middle`: that of the middle of tile 0, in pixels. */
static void diagonals_of(const float range[2], float middle, int32_t out[2])
{
    const float reach = TILE - 1 + 2 * slack;
    const int32_t most = 1 << 20;
    out[0] = ceil_within((range[0] - middle - reach) / TILE, -most, most);
    out[1] = floor_within((range[1] - middle + reach) / TILE, -most, most);
}

/* Where a slab is in the picture; false when it is not. One that the eye's plane cuts may be
 * anywhere. */
static bool project(const gtx_camera_rows *c, const gtx_patch_view *v, const gtx_slab *slab,
                    visible_slab *out)
{
    float p[3][CORNERS], sums[CORNERS], differences[CORNERS];
    float x[2], y[2], t[2], sum[2], difference[2];
    for (int k = 0; k < 3; ++k) {
        const float *row = v->row[k];
        const float along_x = row[0] + row[2] * slab->slope[0];
        const float along_y = row[1] + row[2] * slab->slope[1];
        const float from_x[2] = {along_x * slab->low[0], along_x * slab->high[0]};
        const float from_y[2] = {along_y * slab->low[1], along_y * slab->high[1]};
        for (int n = 0; n < CORNERS; ++n)
            p[k][n] = from_x[n & 1] + from_y[n >> 1 & 1] +
                      (row[2] * slab->height[n >> 2] + row[3]);
    }
    for (int n = 0; n < CORNERS; ++n) {
        const float inverse = c->perspective ? 1 / p[2][n] : 1;
        p[0][n] *= inverse;
        p[1][n] *= inverse;
        sums[n] = p[0][n] + p[1][n];
        differences[n] = p[0][n] - p[1][n];
    }
    range_of(p[0], x);
    range_of(p[1], y);
    range_of(p[2], t);
    range_of(sums, sum);
    range_of(differences, difference);
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
    if (!tiles_of(x, c->width, &out->x0, &out->x1) || !tiles_of(y, c->height, &out->y0, &out->y1))
        return false;
    diagonals_of(sum, TILE, out->sum);
    diagonals_of(difference, 0, out->difference);
    return true;
}

/* What lists may have, for the slabs in view so far. */
static uint64_t most_entries(const gtx_tiles *t, const gtx_camera_rows *c)
{
    const uint64_t tiles = (uint64_t)(c->width / TILE + 1) * (c->height / TILE + 1);
    return LISTED_A_TILE * tiles + LISTED_A_SLAB * (uint64_t)t->visible_count;
}

/* Finds the slabs in view, their order from the nearest on, the records of their patches, and the
 * rectangle of tiles that they may cover. */
static bool find_slabs(gtx_renderer *renderer, const gtx_camera_rows *c, const gtx_model *model,
                       const gtx_instance_data *placed)
{
    gtx_tiles *t = &renderer->tiles;
    const gtx_plan *plan = &renderer->plan;
    t->record_texels = GTX_TILE_PATCH_TEXELS * model->patch_count;
    t->visible_count = 0;
    uint16_t x0 = UINT16_MAX, x1 = 0, y0 = UINT16_MAX, y1 = 0;
    size_t most = 0;
    uint64_t listed = 0;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const gtx_plan_entry *e = &plan->entries[i];
        const uint32_t *first = &model->first_slab[e->level * model->patch_count + e->patch];
        most += first[1] - first[0];
    }
    visible_slab *visible =
        gtx_scratch_reserve(&renderer->allocator, &t->visible, most, sizeof *visible);
    gtx_tile_patch *records =
        gtx_scratch_reserve(&renderer->allocator, &t->records, model->patch_count, sizeof *records);
    gtx_tile_slab *slabs =
        gtx_scratch_reserve(&renderer->allocator, &t->slabs, most, sizeof *slabs);
    gtx_rank *order = gtx_scratch_reserve(&renderer->allocator, &t->order, 2 * most, sizeof *order);
    if (!visible || !records || !slabs || !order)
        return false;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const gtx_plan_entry *entry = &plan->entries[i];
        const gtx_patch_view v =
            gtx_patch_view_of(c, model, placed, entry, records[entry->patch]);
        for (uint32_t k = 0; k < v.count; ++k) {
            const gtx_slab *slab = &v.slabs[k];
            visible_slab *out = &visible[t->visible_count];
            if (slab->low[0] > slab->high[0] || gtx_patch_view_faces_away(&v, slab) ||
                !project(c, &v, slab, out))
                continue;
            gtx_patch_view_put_slab(&v, slab, GTX_TILE_PATCH_TEXELS * v.patch,
                                    slabs[t->visible_count]);
            x0 = out->x0 < x0 ? out->x0 : x0;
            x1 = out->x1 > x1 ? out->x1 : x1;
            y0 = out->y0 < y0 ? out->y0 : y0;
            y1 = out->y1 > y1 ? out->y1 : y1;
            order[t->visible_count] = gtx_rank_of(out->near, t->visible_count);
            ++t->visible_count;
            listed += out->y1 - out->y0 + 1u; /* or about that; more, if slabs are wide */
        }
        if (listed > most_entries(t, c))
            return false;
    }
    gtx_order(order, order + t->visible_count, t->visible_count);
    t->slab_texels = GTX_TILE_SLAB_TEXELS * t->visible_count;
    t->first_column = x0;
    t->first_row = y0;
    t->columns = t->visible_count ? x1 - x0 + 1u : 0;
    t->rows = t->visible_count ? y1 - y0 + 1u : 0;
    return true;
}

static int32_t greatest(int32_t a, int32_t b, int32_t c)
{
    const int32_t ab = a > b ? a : b;
    return ab > c ? ab : c;
}

/* In row y of the tiles that a slab may cover. */
static int32_t first_tile(const visible_slab *s, int32_t y)
{
    return greatest(s->x0, s->sum[0] - y, s->difference[0] + y);
}

static int32_t last_tile(const visible_slab *s, int32_t y)
{
    return -greatest(-s->x1, y - s->sum[1], -s->difference[1] - y);
}

/* The index of the head of column 0 in a row, both of the viewport's. */
static size_t head_of(const gtx_tiles *t, int32_t row)
{
    return ((uint32_t)row - t->first_row) * (size_t)t->columns - t->first_column;
}

/* Heads of the lists: where each begins and ends in the stream, in half texels. Returns where the
 * last one ends, and counts the tiles that have any. */
static uint64_t make_heads(gtx_tiles *t, uint32_t (*heads)[2], size_t count, uint64_t begin)
{
    const visible_slab *visible = t->visible.data;
    /* Counts from tile to tile first: how many slabs more each has, and how many less. */
    memset(heads, 0, count * sizeof *heads);
    for (const visible_slab *s = visible; s < visible + t->visible_count; ++s)
        for (int32_t y = s->y0; y <= s->y1; ++y) {
            const int32_t first = first_tile(s, y), last = last_tile(s, y);
            if (first <= last) {
                ++heads[head_of(t, y) + (uint32_t)first][0];
                ++heads[head_of(t, y) + (uint32_t)last][1];
            }
        }
    t->tile_count = 0;
    uint32_t slabs = 0;
    for (size_t i = 0; i < count; ++i) {
        slabs += heads[i][0];
        const uint32_t less = heads[i][1];
        heads[i][0] = heads[i][1] = (uint32_t)begin; /* the end moves on as the list fills up */
        begin += slabs;
        t->tile_count += slabs > 0;
        slabs -= less;
    }
    return begin;
}

/* Puts each slab into the lists of its tiles, nearest first. */
static void list_slabs(const gtx_tiles *t, uint32_t (*heads)[2], uint32_t (*lists)[2])
{
    const visible_slab *visible = t->visible.data;
    const gtx_rank *order = t->order.data;
    const uint32_t begin = 2 * (t->record_texels + t->slab_texels + t->head_texels);
    for (uint32_t i = 0; i < t->visible_count; ++i) {
        const visible_slab *s = &visible[order[i].place];
        const uint32_t entry[2] = {
            t->record_texels + GTX_TILE_SLAB_TEXELS * order[i].place, gtx_bits_of(s->near)};
        for (int32_t y = s->y0; y <= s->y1; ++y) {
            const int32_t last = last_tile(s, y);
            const size_t head = head_of(t, y);
            for (int32_t x = first_tile(s, y); x <= last; ++x)
                memcpy(lists[heads[head + (uint32_t)x][1]++ - begin], entry, sizeof entry);
        }
    }
}

/* Two triangles over columns x0..x1 and rows y0..y1 of the rectangle of tiles. */
static void add_corners(gtx_tiles *t, uint32_t x0, uint32_t x1, uint32_t y0, uint32_t y1)
{
    static const uint8_t order[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0, 1}, {1, 0}, {1, 1}};
    uint16_t (*corner)[2] = (uint16_t (*)[2])t->corners.data + t->corner_count;
    for (int k = 0; k < 6; ++k) {
        corner[k][0] = (uint16_t)(TILE * (t->first_column + (order[k][0] ? x1 + 1 : x0)));
        corner[k][1] = (uint16_t)(TILE * (t->first_row + (order[k][1] ? y1 + 1 : y0)));
    }
    t->corner_count += 6;
}

/* Whether any of rows y0..y1 of a column has a slab. */
static bool has_slabs(const gtx_tiles *t, uint32_t x, uint32_t y0, uint32_t y1)
{
    const uint32_t (*heads)[2] = t->heads.data;
    for (uint32_t y = y0; y <= y1; ++y)
        if (heads[y * t->columns + x][0] < heads[y * t->columns + x][1])
            return true;
    return false;
}

/* Covers the tiles that have a slab with rectangles. Rasterisers on the CPU shade pixels along the
 * diagonal of a rectangle twice, so rectangles are as high as a band of rows: the empty tiles in
 * them cost less. */
static void outline(gtx_tiles *t)
{
    t->corner_count = 0;
    for (uint32_t y0 = 0; y0 < t->rows; y0 += BAND) {
        const uint32_t y1 = (y0 + BAND < t->rows ? y0 + BAND : t->rows) - 1;
        for (uint32_t x = 0, from = 0; x < t->columns; ++x)
            if (!has_slabs(t, x, y0, y1))
                from = x + 1;
            else if (x + 1 == t->columns || !has_slabs(t, x + 1, y0, y1))
                add_corners(t, from, x, y0, y1);
    }
}

/* Tells shaders where the heads are, in floats: gtx_tiles_fill keeps the numbers below 2^24. */
static void place_heads(gtx_tiles *t)
{
    t->place[GTX_PLACE_COLUMNS][3] = (float)t->columns;
    t->place[GTX_PLACE_HEADS][3] = (float)(t->record_texels + t->slab_texels);
    t->place[GTX_PLACE_FIRST_COLUMN][3] = (float)t->first_column;
    t->place[GTX_PLACE_FIRST_ROW][3] = (float)t->first_row;
}

bool gtx_tiles_fill(const gtx_draw_call *draw, const gtx_model *model,
                    const gtx_instance_data *placed)
{
    gtx_renderer *renderer = draw->renderer;
    gtx_tiles *t = &renderer->tiles;
    const gtx_camera_rows c = gtx_camera_rows_of(draw, placed, t->place);
    if (!find_slabs(renderer, &c, model, placed))
        return false;
    const size_t head_texels = ((size_t)t->columns * t->rows + 1) / 2, tiles = 2 * head_texels;
    const uint64_t before = (uint64_t)t->record_texels + t->slab_texels;
    if (before + head_texels > (uint64_t)t->max_texels || before > 1 << 24)
        return false;
    uint32_t (*heads)[2] =
        gtx_scratch_reserve(&renderer->allocator, &t->heads, tiles, sizeof *heads);
    if (!heads)
        return false;
    t->head_texels = (uint32_t)head_texels;
    const uint64_t lists_at = before + head_texels;
    const uint64_t texels = (make_heads(t, heads, tiles, 2 * lists_at) + 1) / 2;
    if (texels > (uint64_t)t->max_texels || 2 * (texels - lists_at) > most_entries(t, &c))
        return false;
    t->list_texels = (uint32_t)(texels - lists_at);
    uint32_t (*lists)[2] =
        gtx_scratch_reserve(&renderer->allocator, &t->lists, 2 * t->list_texels, sizeof *lists);
    if (!lists || !gtx_scratch_reserve(&renderer->allocator, &t->corners, 6 * (size_t)t->tile_count,
                                     2 * sizeof(uint16_t)))
        return false;
    list_slabs(t, heads, lists);
    outline(t);
    place_heads(t);
    return true;
}
