/* Planners: their memory, and how a frame begins. */
#include "frame/planner.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

gtx_result gtx_planner_init(gtx_planner *planner, const gtx_allocator *allocator,
                            const gtx_costs *costs, gtx_error *error)
{
    const float all[] = {costs->lod_triangle, costs->lod_pixel, costs->cast_patch,
                         costs->cast_pixel, costs->grid_triangle};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        if (!(all[i] >= 0 && all[i] < INFINITY))
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "a cost is not finite, or below 0");
    planner->allocator = *allocator;
    planner->costs = *costs;
    gtx_rtin_triangles(planner->grids.triangles);
    gtx_block_triangles(planner->grids.block_indices);
    return GTX_OK;
}

gtx_result gtx_planner_create(const gtx_planner_desc *desc, gtx_planner **out, gtx_error *error)
{
    const gtx_planner_desc defaults = {0}, *d = desc ? desc : &defaults;
    if (!out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "no pointer for the planner");
    *out = NULL;
    gtx_result result = gtx_check_reserved(d->reserved, 1, error);
    if (result)
        return result;
    const gtx_allocator hooks = gtx_allocator_or_default(d->allocator);
    gtx_planner *planner = gtx_alloc_array(&hooks, 1, sizeof *planner);
    if (!planner)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a planner");
    planner->own_main = d->own_main;
    planner->on_gpu = d->on_gpu;
    planner->tiles.max_texels = gtx_tiles_most(d->max_tile_texels);
    result = gtx_planner_init(planner, &hooks, &d->costs, error);
    if (result)
        gtx_free_array(&hooks, planner, 1, sizeof *planner);
    else
        *out = planner;
    return result;
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

void gtx_planner_free(gtx_planner *planner)
{
    free_instances(planner);
    gtx_plan_free(planner);
    gtx_tiles_free(&planner->tiles, &planner->allocator);
    gtx_grids_free(&planner->grids, &planner->allocator);
    gtx_occlusion_free(&planner->occlusion, &planner->allocator);
    gtx_scratch_free(&planner->allocator, &planner->picked);
}

void gtx_planner_destroy(gtx_planner *planner)
{
    if (!planner)
        return;
    const gtx_allocator hooks = planner->allocator;
    gtx_planner_free(planner);
    gtx_free_array(&hooks, planner, 1, sizeof *planner);
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

static gtx_result check(const gtx_planner *planner, const gtx_view *view,
                        const gtx_instance *instances, uint32_t count, gtx_error *error)
{
    const uint32_t flags = GTX_VIEW_REVERSED_Z | GTX_VIEW_DEPTH_ZERO_TO_ONE |
                           GTX_VIEW_RESTORE_STATE | GTX_VIEW_SHADING_BY_TILES | GTX_VIEW_LINEAR |
                           GTX_VIEW_BY_SAMPLES | GTX_VIEW_SHADING_SOLID;
    if (!planner || !view || (count && !instances))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a draw needs a renderer or planner, a view and instances");
    if (view->flags & ~flags || (unsigned)view->method > GTX_METHOD_GRID ||
        (unsigned)view->pass > GTX_PASS_GBUFFER)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the view asks for an unknown flag, method or pass");
    if ((view->shading && view->pass != GTX_PASS_FORWARD) ||
        ((view->shading || (planner->own_main && view->pass == GTX_PASS_FORWARD)) &&
         view->method == GTX_METHOD_PAPER))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a shading takes the forward pass's place, and not by the paper's search");
    if (view->other && view->method == GTX_METHOD_GRID)
        return gtx_fail(error, GTX_ERROR_UNSUPPORTED, "displaced grids are drawn for one eye");
    gtx_result result = gtx_check_reserved(view->reserved, 1, error);
    for (uint32_t i = 0; !result && i < count; ++i) {
        result = gtx_check_reserved(instances[i].reserved, 3, error);
        if (!result && !instances[i].model)
            result = gtx_fail(error, GTX_ERROR_ARGUMENT, "instance %u has no model", i);
    }
    return result;
}

/* What is the same in all draws of a frame. */
static void set_constants(const gtx_sight *sight, gtx_constants *c)
{
    memset(c, 0, sizeof *c);
    memcpy(c->clip_from_world, sight->clip_from_world, sizeof c->clip_from_world);
    memcpy(c->depth, sight->depth, sizeof c->depth);
    memcpy(c->light, sight->light, sizeof c->light);
    memcpy(c->detail, sight->detail, sizeof c->detail);
    memcpy(c->search, sight->search, sizeof c->search);
    memcpy(c->other_clip_from_world, sight->other_clip, sizeof c->other_clip_from_world);
    memcpy(c->other_eye, sight->other_eye, sizeof c->other_eye);
}

gtx_result gtx_frame_begin(gtx_planner *planner, const gtx_view *view,
                           const gtx_instance *instances, uint32_t count, gtx_frame *out,
                           gtx_error *error)
{
    gtx_draw_call call = {
        .planner = planner, .view = view, .instances = instances, .count = count};
    gtx_result result = out ? check(planner, view, instances, count, error)
                            : gtx_fail(error, GTX_ERROR_ARGUMENT, "no pointer for the frame");
    if (!result)
        result = gtx_sight_of_view(view, &call.sight, error);
    if (!result)
        result = reserve(planner, count, error);
    for (uint32_t i = 0; !result && i < count; ++i) {
        gtx_instance_data *placed = &planner->instances[i];
        result = gtx_plan_reserve(planner, instances[i].model->patch_count, error);
        if (!result)
            result = gtx_place_instance(&call.sight, &instances[i], placed, &planner->mirrored[i],
                                        error);
        if (!result)
            result = gtx_choose(&call, instances[i].model, placed, &planner->ways[i], error);
    }
    if (planner && result)
        planner->call = (gtx_draw_call){.planner = planner};
    if (result)
        return result;
    set_constants(&call.sight, &planner->constants);
    planner->call = call;
    *out = (gtx_frame){planner->instances, count, call.sight.reversed};
    return GTX_OK;
}
