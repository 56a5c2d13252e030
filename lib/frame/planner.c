/* Planners: their memory, and where instances are. */
#include "frame/planner.h"

#include "base/alloc.h"
#include "base/error.h"

void gtx_planner_begin(gtx_planner *planner)
{
    gtx_rtin_triangles(planner->grids.triangles);
}

static void free_instances(gtx_planner *planner)
{
    const gtx_allocator *hooks = &planner->allocator;
    const size_t capacity = planner->instance_capacity;
    gtx_free_array(hooks, planner->instances, capacity, sizeof *planner->instances);
    gtx_free_array(hooks, planner->mirrored, capacity, sizeof *planner->mirrored);
    gtx_free_array(hooks, planner->ways, capacity, sizeof *planner->ways);
    planner->instances = NULL;
    planner->mirrored = NULL;
    planner->ways = NULL;
    planner->instance_capacity = 0;
}

void gtx_planner_end(gtx_planner *planner)
{
    free_instances(planner);
    gtx_plan_free(planner);
    gtx_tiles_free(&planner->tiles, &planner->allocator);
    gtx_grids_free(&planner->grids, &planner->allocator);
}

static gtx_result reserve(gtx_planner *planner, uint32_t count, gtx_error *error)
{
    if (count <= planner->instance_capacity)
        return GTX_OK;
    free_instances(planner);
    const gtx_allocator *hooks = &planner->allocator;
    planner->instance_capacity = count;
    planner->instances = gtx_alloc_array(hooks, count, sizeof *planner->instances);
    planner->mirrored = gtx_alloc_array(hooks, count, sizeof *planner->mirrored);
    planner->ways = gtx_alloc_array(hooks, count, sizeof *planner->ways);
    if (planner->instances && planner->mirrored && planner->ways)
        return GTX_OK;
    free_instances(planner);
    return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for %u instances", count);
}

gtx_result gtx_planner_place(const gtx_draw_call *draw, const gtx_instance *instances,
                             uint32_t count, gtx_error *error)
{
    gtx_planner *planner = draw->planner;
    gtx_result result = reserve(planner, count, error);
    for (uint32_t i = 0; !result && i < count; ++i) {
        gtx_instance_data *placed = &planner->instances[i];
        result = gtx_plan_reserve(planner, instances[i].model->patch_count, error);
        if (!result)
            result = gtx_place_instance(&draw->frame, &instances[i], placed,
                                        &planner->mirrored[i], error);
        if (!result)
            result = gtx_choose(draw, instances[i].model, placed, &planner->ways[i], error);
    }
    return result;
}
