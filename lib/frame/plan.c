/* Plans: culls an instance's patches, picks level and proxy of each, and sorts them. */
#include "frame/plan.h"

#include "base/alloc.h"
#include "base/error.h"
#include "frame/frustum.h"
#include "frame/planner.h"

#include <math.h>
#include <string.h>

/* The coarsest level within the allowed error. */
static uint32_t level_of(const gtx_frustum *f, const gtx_model *model, const gtx_patch_facts *facts)
{
    if (f->level >= 0)
        return (uint32_t)f->level;
    const double allowed = gtx_allowed_error(f, facts->sphere);
    uint32_t level = 0;
    while (level + 1 < model->mip_count && facts->error[level + 1] <= allowed)
        ++level;
    return level;
}

gtx_result gtx_plan_reserve(gtx_planner *planner, uint32_t patches, gtx_error *error)
{
    gtx_plan *plan = &planner->plan;
    if (patches <= plan->capacity)
        return GTX_OK;
    gtx_plan_free(planner);
    const gtx_allocator *hooks = &planner->allocator;
    plan->capacity = patches;
    plan->ranges = gtx_alloc_array(hooks, 2 * (size_t)patches, sizeof *plan->ranges);
    plan->entries = gtx_alloc_array(hooks, patches, sizeof *plan->entries);
    plan->found = gtx_alloc_array(hooks, patches, sizeof *plan->found);
    plan->ranks = gtx_alloc_array(hooks, 2 * (size_t)patches, sizeof *plan->ranks);
    plan->ways = gtx_alloc_array(hooks, patches, sizeof *plan->ways);
    plan->parts = gtx_alloc_array(hooks, patches, sizeof *plan->parts);
    if (plan->ranges && plan->entries && plan->found && plan->ranks && plan->ways && plan->parts)
        return GTX_OK;
    gtx_plan_free(planner);
    return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to draw %u patches", patches);
}

void gtx_plan_free(gtx_planner *planner)
{
    gtx_plan *plan = &planner->plan;
    const gtx_allocator *hooks = &planner->allocator;
    gtx_free_array(hooks, plan->ranges, 2 * (size_t)plan->capacity, sizeof *plan->ranges);
    gtx_free_array(hooks, plan->entries, plan->capacity, sizeof *plan->entries);
    gtx_free_array(hooks, plan->found, plan->capacity, sizeof *plan->found);
    gtx_free_array(hooks, plan->ranks, 2 * (size_t)plan->capacity, sizeof *plan->ranks);
    gtx_free_array(hooks, plan->ways, plan->capacity, sizeof *plan->ways);
    gtx_free_array(hooks, plan->parts, plan->capacity, sizeof *plan->parts);
    *plan = (gtx_plan){0};
}

uint32_t gtx_plan_whole(const gtx_draw_call *draw, const gtx_model *model,
                        const gtx_instance_data *placed)
{
    const gtx_frustum f = gtx_frustum_of(draw, model, placed);
    if (model->boxed_count || gtx_is_before_near(&f, model->sphere))
        return 0;
    if (f.level >= 0)
        return 1 + (uint32_t)f.level;
    return model->coarsest_error <= gtx_allowed_error(&f, model->sphere) ? model->mip_count : 0;
}

/* By distance: boxes come first, in order of their levels. */
static void sort(gtx_plan *plan)
{
    for (uint32_t i = 0; i < plan->count; ++i)
        plan->ranks[i] = gtx_rank_of(plan->found[i].distance, i);
    gtx_order(plan->ranks, plan->ranks + plan->count, plan->count);
    for (uint32_t i = 0; i < plan->count; ++i)
        plan->entries[i] = plan->found[plan->ranks[i].place];
}

/* Of patches that are seen from two sides, LOD meshes of more triangles than that are not drawn
 * where rays are cast by tiles: both sides take their time, hidden or not, and along a surface each
 * has few pixels. Standing on the Andes (tests/bench/paths), of up to 2,000 a patch, views take
 * 0.17 of the mesh's time instead of 0.21; half and double are the same but for noise. At 64
 * random views of a dragon, of 150 a patch, take up to a fifth longer. Levels that are lit at
 * vertices are drawn in one pass, and with any number. */
static const uint32_t most_lod_triangles = 400;

static bool is_too_fine(const gtx_lod_level *level, uint32_t i)
{
    return !level->lit && level->first[i + 1] - level->first[i] > most_lod_triangles;
}

bool gtx_plan_suits_whole(const gtx_draw_call *draw, const gtx_model *model, uint32_t level)
{
    const gtx_lod_meshes *lods = &model->lods;
    bool suits = true;
    for (uint32_t i = lods->one_sided; i < lods->patch_count && gtx_tiles_suit(draw); ++i)
        suits = suits && !is_too_fine(&lods->levels[level], i);
    return suits;
}

/* What a draw may do with patches. */
typedef struct choice {
    uint32_t first, levels;   /* of the LOD mesh: levels first..levels - 1 */
    bool tiles;
    double least;             /* allowed everywhere: spheres reach beyond the bounds */
} choice;

/* The way of the patch lods.order[i] in view. */
static uint8_t way_of(const gtx_frustum *f, const gtx_model *model, uint32_t i, choice c)
{
    const gtx_lod_level *lod = model->lods.levels;
    const uint32_t patch = model->lods.level_count ? model->lods.order[i] : i;
    const bool thin = c.tiles && model->records[patch][GTX_RECORD_TWO_SIDED][3] > 0;
    uint8_t way = model->bare && c.levels ? GTX_BY_LOD : GTX_BY_HEIGHT_FIELD;
    if (!c.levels || model->lods.edited[patch])
        return way;
    const double allowed = fmax(c.least, gtx_allowed_error(f, model->facts[patch].sphere));
    for (uint32_t k = c.first; k < c.levels && lod[k].error <= allowed; ++k)
        if (!thin || !is_too_fine(&lod[k], i))
            way = (uint8_t)(GTX_BY_LOD + k);
    return way;
}

void gtx_plan_patches(const gtx_draw_call *draw, const gtx_model *model,
                      const gtx_instance_data *placed, uint32_t levels, bool edited_only)
{
    gtx_plan *plan = &draw->planner->plan;
    const gtx_frustum f = gtx_frustum_of(draw, model, placed);
    const choice c = {gtx_levels_cast(draw, model), levels, !model->bare && gtx_tiles_suit(draw),
                      levels ? gtx_allowed_anywhere(draw, model, placed) : 0};
    plan->count = 0;
    plan->any_lod = false;
    for (uint32_t n = 0; n < model->patch_count; ++n) {
        const uint32_t i = model->lods.level_count ? model->lods.order[n] : n;
        const gtx_patch_facts *facts = &model->facts[i];
        plan->ways[i] = GTX_OUT_OF_VIEW;
        if ((edited_only && !model->lods.edited[i]) || gtx_is_outside(&f, facts->hull))
            continue;
        plan->ways[i] = way_of(&f, model, n, c);
        if (plan->ways[i] != GTX_BY_HEIGHT_FIELD) {
            plan->any_lod = true;
            continue;
        }
        const bool box = facts->boxed || gtx_is_before_near(&f, facts->hull);
        const uint32_t level = level_of(&f, model, facts);
        const float distance = (float)gtx_plane_at(&f.side[0], facts->hull);
        plan->found[plan->count++] = (gtx_plan_entry){
            box ? (float)level - GTX_MAX_MIPS : distance > 0 ? distance : 0, i, level};
    }
    sort(plan);
}

void gtx_plan_proxies(gtx_plan *plan, const gtx_model *model)
{
    uint32_t boxes = 0, count = 0;
    memset(plan->box_count, 0, sizeof plan->box_count);
    for (uint32_t i = 0; i < plan->count; ++i) {
        const gtx_plan_entry *entry = &plan->entries[i];
        const bool box = entry->distance < 0;
        const uint32_t *first =
            &model->first_index[(box ? 0 : 1 + entry->level) * model->patch_count + entry->patch];
        if (first[0] == first[1])
            continue;
        plan->ranges[count++] = (gtx_range){.first = first[0], .count = first[1] - first[0]};
        plan->box_count[entry->level] += box;
        boxes += box;
    }
    plan->hull_count = count - boxes;
}

/* Whether a patch that is drawn meets one of the way. */
static bool meets(const gtx_plan *plan, const gtx_lod_meshes *lods, uint32_t patch, uint8_t way)
{
    for (uint32_t n = lods->first_neighbour[patch]; n < lods->first_neighbour[patch + 1]; ++n)
        if (plan->ways[lods->neighbours[n]] == way)
            return true;
    return false;
}

bool gtx_plan_parts(gtx_plan *plan, const gtx_lod_meshes *lods, uint32_t level)
{
    const uint8_t way = (uint8_t)(GTX_BY_LOD + level);
    bool any = false;
    for (uint32_t i = 0; i < lods->patch_count; ++i) {
        const bool finer = plan->ways[i] != GTX_OUT_OF_VIEW && plan->ways[i] < way;
        plan->parts[i] = GTX_LOD_NOTHING;
        if (plan->ways[i] == way)
            plan->parts[i] = GTX_LOD_ALL;
        else if (finer && !lods->edited[i] && meets(plan, lods, i, way))
            plan->parts[i] = GTX_LOD_BORDER;
        any = any || plan->parts[i];
    }
    return any;
}
