/* Tiles: which slabs of an instance may cover which squares of pixels, nearest first. */
#include "frame/tiles.h"

#include "frame/order.h"
#include "frame/project.h"
#include "frame/techniques.h"

#include <string.h>

/* Tiles along the height of a rectangle of them. */
enum { BAND = 16 };

/* Lists have at most so many entries for each tile of the viewport and for each slab in view.
 * Needles, whose slabs all reach across the picture, are cast in less time and memory in fragments.
 * Of 12 models and terrains, in pictures of 640x480, none had an eighth of it. */
enum { LISTED_A_TILE = 64, LISTED_A_SLAB = 8 };

/* What lists may have, for the slabs in view so far. */
static uint64_t most_entries(const gtx_tiles *t, const gtx_camera_rows *c)
{
    const uint64_t tiles = (uint64_t)(c->width / GTX_TILE + 1) * (c->height / GTX_TILE + 1);
    return LISTED_A_TILE * tiles + LISTED_A_SLAB * (uint64_t)t->visible_count;
}

/* Finds the slabs in view, their order from the nearest on, the records of their patches, and the
 * rectangle of tiles that they may cover. */
static bool find_slabs(gtx_planner *planner, const gtx_camera_rows *c, const gtx_model *model,
                       const gtx_instance_data *placed)
{
    gtx_tiles *t = &planner->tiles;
    const gtx_plan *plan = &planner->plan;
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
    gtx_visible_slab *visible =
        gtx_scratch_reserve(&planner->allocator, &t->visible, most, sizeof *visible);
    gtx_tile_patch *records =
        gtx_scratch_reserve(&planner->allocator, &t->records, model->patch_count, sizeof *records);
    gtx_tile_slab *slabs =
        gtx_scratch_reserve(&planner->allocator, &t->slabs, most, sizeof *slabs);
    gtx_rank *order = gtx_scratch_reserve(&planner->allocator, &t->order, 2 * most, sizeof *order);
    if (!visible || !records || !slabs || !order)
        return false;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const gtx_plan_entry *entry = &plan->entries[i];
        const gtx_patch_view v =
            gtx_patch_view_of(c, model, placed, entry, records[entry->patch]);
        const gtx_patch_view over =
            gtx_occlusion_view(&planner->occlusion, model->records[entry->patch]);
        for (uint32_t k = 0; k < v.count; ++k) {
            const gtx_slab *slab = &v.slabs[k];
            gtx_visible_slab *out = &visible[t->visible_count];
            if (slab->low[0] > slab->high[0] || gtx_patch_view_faces_away(&v, slab) ||
                !gtx_project_slab(c, &v, slab, out) ||
                gtx_is_slab_hidden(&planner->occlusion, &over, slab))
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
static int32_t first_tile(const gtx_visible_slab *s, int32_t y)
{
    return greatest(s->x0, s->sum[0] - y, s->difference[0] + y);
}

static int32_t last_tile(const gtx_visible_slab *s, int32_t y)
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
    const gtx_visible_slab *visible = t->visible.data;
    /* Counts from tile to tile first: how many slabs more each has, and how many less. */
    memset(heads, 0, count * sizeof *heads);
    for (const gtx_visible_slab *s = visible; s < visible + t->visible_count; ++s)
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
    const gtx_visible_slab *visible = t->visible.data;
    const gtx_rank *order = t->order.data;
    const uint32_t begin = 2 * (t->record_texels + t->slab_texels + t->head_texels);
    for (uint32_t i = 0; i < t->visible_count; ++i) {
        const gtx_visible_slab *s = &visible[order[i].place];
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
        corner[k][0] = (uint16_t)(GTX_TILE * (t->first_column + (order[k][0] ? x1 + 1 : x0)));
        corner[k][1] = (uint16_t)(GTX_TILE * (t->first_row + (order[k][1] ? y1 + 1 : y0)));
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
    gtx_planner *planner = draw->planner;
    gtx_tiles *t = &planner->tiles;
    const gtx_camera_rows c = gtx_camera_rows_of(draw, placed, t->place);
    if (!find_slabs(planner, &c, model, placed))
        return false;
    const size_t head_texels = ((size_t)t->columns * t->rows + 1) / 2, tiles = 2 * head_texels;
    const uint64_t before = (uint64_t)t->record_texels + t->slab_texels;
    if (before + head_texels > t->max_texels || before > 1 << 24)
        return false;
    uint32_t (*heads)[2] =
        gtx_scratch_reserve(&planner->allocator, &t->heads, tiles, sizeof *heads);
    if (!heads)
        return false;
    t->head_texels = (uint32_t)head_texels;
    const uint64_t lists_at = before + head_texels;
    const uint64_t texels = (make_heads(t, heads, tiles, 2 * lists_at) + 1) / 2;
    if (texels > t->max_texels || 2 * (texels - lists_at) > most_entries(t, &c))
        return false;
    t->list_texels = (uint32_t)(texels - lists_at);
    uint32_t (*lists)[2] =
        gtx_scratch_reserve(&planner->allocator, &t->lists, 2 * t->list_texels, sizeof *lists);
    if (!lists || !gtx_scratch_reserve(&planner->allocator, &t->corners, 6 * (size_t)t->tile_count,
                                     2 * sizeof(uint16_t)))
        return false;
    list_slabs(t, heads, lists);
    outline(t);
    place_heads(t);
    return true;
}

/* Halves of texels are counted, in ints. */
uint32_t gtx_tiles_most(uint32_t texels)
{
    return texels < 1u << 29 ? texels : 1u << 29;
}

bool gtx_tiles_suit(const gtx_draw_call *draw)
{
    const uint32_t most = 65528; /* corners are counted in 16 bits */
    const gtx_view *view = draw->view;
    if ((gtx_is_own(draw) && !(view->flags & GTX_VIEW_SHADING_BY_TILES)) ||
        view->flags & GTX_VIEW_BY_SAMPLES || view->other)
        return false;
    return draw->planner->tiles.max_texels &&
           view->method != GTX_METHOD_PAPER && view->viewport_width > 0 &&
           view->viewport_width <= most && view->viewport_height > 0 &&
           view->viewport_height <= most;
}

void gtx_tiles_free(gtx_tiles *tiles, const gtx_allocator *allocator)
{
    gtx_scratch *all[] = {&tiles->visible, &tiles->order, &tiles->heads,  &tiles->records,
                          &tiles->slabs,   &tiles->lists, &tiles->corners};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        gtx_scratch_free(allocator, all[i]);
}
