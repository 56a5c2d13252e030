/* Which blocks of height fields the GPU displaces: every node fetches its height, so that nothing
 * is built or sent but which blocks are seen. */
#include "frame/mix.h"

#include <math.h>

/* Counterclockwise from above the height field. */
void gtx_block_triangles(uint16_t out[3 * GTX_BLOCK_TRIANGLES])
{
    enum { SIDE = GTX_SLAB_CELLS + 1 };
    for (uint32_t c = 0; c < GTX_SLAB_CELLS * GTX_SLAB_CELLS; ++c) {
        const uint32_t a = c / GTX_SLAB_CELLS * SIDE + c % GTX_SLAB_CELLS;
        const uint32_t corners[6] = {a, a + 1, a + SIDE, a + SIDE, a + 1, a + SIDE + 1};
        for (int k = 0; k < 6; ++k)
            out[6 * c + k] = (uint16_t)corners[k];
    }
}

/* Pixels that a patch covers, roughly: half of the disc that its sphere is in the picture. */
static double pixels_of(const gtx_frustum *f, const float sphere[4])
{
    const double w = gtx_plane_at(&f->w, sphere), radius = f->pixels * sphere[3];
    return w > 0 ? 1.57 * radius * radius / (w * w) : INFINITY;
}

/* The coarsest level within the allowed error as triangles; a level that is asked for stays. */
static uint32_t level_of(const gtx_frustum *f, const gtx_patch_facts *facts, uint32_t level)
{
    const double allowed = gtx_allowed_error(f, facts->sphere);
    while (f->level < 0 && level && facts->error[level] + facts->twist[level] > allowed)
        --level;
    return level;
}

/* Room for all blocks of the plan, of whatever look, and for those of any one patch. */
static bool reserve(gtx_planner *planner, const gtx_model *model)
{
    const gtx_plan *plan = &planner->plan;
    gtx_grids *g = &planner->grids;
    size_t all = 0, most = 0;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const uint32_t *slab = &model->first_slab[plan->entries[i].patch];
        const size_t blocks = slab[1] - slab[0];
        all += blocks;
        most = blocks > most ? blocks : most;
    }
    bool room = gtx_scratch_reserve(&planner->allocator, &g->shown, most, sizeof(uint32_t));
    for (uint32_t k = 0; k < GTX_BLOCK_LOOKS && room; ++k)
        room = gtx_scratch_reserve(&planner->allocator, &g->blocks[k], all,
                                   sizeof(gtx_displaced_block));
    return room;
}

/* What shows of a block of a level, from those of level 0 that it lies over. A coarser level shows
 * a little more. */
static gtx_rtin_block merged(const gtx_model *model, uint32_t patch, uint32_t level, uint32_t x,
                             uint32_t y)
{
    const gtx_rtin *rtin = &model->rtins[patch];
    const gtx_rtin_block *blocks = model->blocks + model->first_slab[patch];
    gtx_rtin_block all = {level ? UINT16_MAX : 0, UINT16_MAX};
    for (uint32_t j = y << level; j < (y + 1) << level && j < rtin->rows; ++j)
        for (uint32_t i = x << level; i < (x + 1) << level && i < rtin->columns; ++i) {
            all.some |= blocks[j * rtin->columns + i].some;
            all.whole &= blocks[j * rtin->columns + i].whole;
        }
    return all;
}

static void add(gtx_grids *grids, const gtx_model *model, const gtx_plan_entry *entry,
                uint32_t count)
{
    const uint32_t *shown = grids->shown.data, patch = entry->patch;
    float (*record)[4] = model->records[patch];
    const uint32_t cells = (((uint32_t)record[GTX_RECORD_RECT][2] - 2) >> entry->level) + 1;
    const uint32_t columns = (cells - 1) / GTX_SLAB_CELLS + 1;
    const uint32_t sides = record[GTX_RECORD_TWO_SIDED][3] > 0 ? GTX_BLOCKS_TWO_SIDED : 0;
    for (uint32_t i = 0, y = 0; i < count; ++i) {
        while (shown[i] >= (y + 1) * columns)
            ++y;
        const uint32_t x = shown[i] - y * columns;
        const gtx_rtin_block b = merged(model, patch, entry->level, x, y);
        const uint32_t look = sides | (b.whole == UINT16_MAX ? 0 : GTX_BLOCKS_TRIMMED);
        gtx_displaced_block *blocks = grids->blocks[look].data;
        if (b.some)
            blocks[grids->block_count[look]++] = (gtx_displaced_block){
                patch | entry->level << GTX_PROXY_KIND_SHIFT, (uint16_t)(x * GTX_SLAB_CELLS),
                (uint16_t)(y * GTX_SLAB_CELLS)};
    }
}

bool gtx_displace_fill(const gtx_draw_call *draw, const gtx_model *model,
                       const gtx_instance_data *placed)
{
    gtx_planner *planner = draw->planner;
    gtx_plan *plan = &planner->plan;
    gtx_grids *grids = &planner->grids;
    const gtx_frustum f = gtx_frustum_of(draw, model, placed);
    const bool forced = draw->view->method == GTX_METHOD_GRID;
    uint32_t left = 0;
    bool any = false;
    for (uint32_t k = 0; k < GTX_BLOCK_LOOKS; ++k)
        grids->block_count[k] = 0;
    if (!reserve(planner, model))
        return false;
    for (uint32_t i = 0; i < plan->count; ++i) {
        gtx_plan_entry entry = plan->entries[i];
        entry.level = level_of(&f, &model->facts[entry.patch], entry.level);
        const uint32_t seen =
            gtx_blocks_seen(&f, model, entry.patch, entry.level, grids->shown.data);
        const double pixels = pixels_of(&f, model->facts[entry.patch].sphere);
        if (forced || gtx_displaced_cost(draw, seen * GTX_BLOCK_TRIANGLES, pixels) <=
                          gtx_cast_cost(draw, 1, pixels)) {
            add(grids, model, &entry, seen);
            any = true;
        } else {
            plan->entries[left++] = plan->entries[i];
        }
    }
    plan->count = left;
    return any;
}
