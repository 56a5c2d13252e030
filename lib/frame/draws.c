/* The draws of a frame: runs of alike instances by an LOD mesh, cast, or patch by patch, each in
 * its own way. */
#include "frame/frustum.h"
#include "frame/techniques.h"

#include <string.h>

/* Instances of one model, drawn alike, and of one winding. */
typedef struct run {
    const gtx_model *model;   /* NULL: nothing */
    uint32_t first, count;
    uint8_t way;              /* as gtx_choose has it */
    bool mirrored;
} run;

/* Constants of a model; the others are those of the frame, or of a draw. */
static void set_model(gtx_constants *c, const gtx_model *model)
{
    c->maps[0] = (float)(model->mip_count - 1);
    c->maps[1] = model->has_color ? 1.0f : 0.0f;
    c->maps[2] = model->emission_scale;
    c->maps[3] = model->has_material ? 1.0f : 0.0f;
    for (int k = 0; k < 4; ++k)
        c->constant_material[k] = (float)model->constant_material[k] / 255.0f;
}

/* A draw of `count` instances of a run, by polygons of a buffer. */
static gtx_frame_draw draw_of(const gtx_draw_call *call, const run *r, gtx_technique technique,
                              uint32_t first, uint32_t count)
{
    return (gtx_frame_draw){
        .pipeline = gtx_pipeline_of(technique, call->view->pass, gtx_material_of(r->model)),
        .clockwise = r->mirrored, .model = r->model, .first_instance = first,
        .instance_count = count, .constants = &call->planner->constants, .index_size = 4};
}

/* Casts in proxies. Boxes are drawn by their back faces, so that a camera inside still sees the
 * patch, hulls by their front faces, where rays begin. */
static void cast_ranges(const gtx_draw_call *call, const run *r, bool box, uint32_t instance,
                        uint32_t count, const gtx_range *ranges, uint32_t range_count)
{
    gtx_frame_draw draw = draw_of(call, r, gtx_cast_technique(call, box), instance, count);
    draw.cull = box ? GTX_CULL_FRONT : GTX_CULL_BACK;
    draw.vertices = GTX_BUFFER_PROXY_VERTICES;
    draw.indices = GTX_BUFFER_PROXY_INDICES;
    draw.index_size = r->model->proxy_index_size;
    draw.vertex_size = sizeof(gtx_proxy_vertex);
    draw.ranges = ranges;
    draw.range_count = range_count;
    if (range_count)
        call->submit(&draw, call->user);
}

/* All proxies of a kind, of `count` instances. */
static void cast_whole(const gtx_draw_call *call, const run *r, uint32_t kind, uint32_t instance,
                       uint32_t count)
{
    const uint32_t *first = &r->model->first_index[kind * r->model->patch_count];
    const gtx_range all = {.first = first[0], .count = first[r->model->patch_count] - first[0]};
    cast_ranges(call, r, kind == 0, instance, count, &all, all.count > 0);
}

/* Casts an instance by tiles; false when it has to be done otherwise. */
static bool cast_tiles(const gtx_draw_call *call, const run *r, uint32_t instance)
{
    gtx_tiles *tiles = &call->planner->tiles;
    const gtx_instance_data *placed = &call->planner->instances[instance];
    if (!gtx_tiles_suit(call) || !gtx_tiles_fill(call, r->model, placed))
        return false;
    if (!tiles->tile_count)
        return true;
    gtx_tile_constants constants = {.id = placed->id};
    memcpy(constants.place, tiles->place, sizeof constants.place);
    memcpy(constants.tint, placed->tint, sizeof constants.tint);
    const gtx_tile_draw stream = {
        &constants,
        {tiles->records.data, tiles->slabs.data, tiles->heads.data, tiles->lists.data},
        {16ull * tiles->record_texels, 16ull * tiles->slab_texels, 16ull * tiles->head_texels,
         16ull * tiles->list_texels}};
    const gtx_range corners = {.count = tiles->corner_count};
    const gtx_technique technique = gtx_is_own(call) ? TECHNIQUE_OWN_TILES : TECHNIQUE_TILES;
    gtx_frame_draw draw = draw_of(call, r, technique, instance, 1);
    draw.vertices = GTX_BUFFER_TILE_CORNERS;
    draw.index_size = 0;
    draw.vertex_size = 4;
    draw.vertex_data = tiles->corners.data;
    draw.vertex_bytes = (uint64_t)draw.vertex_size * tiles->corner_count;
    draw.ranges = &corners;
    draw.range_count = 1;
    draw.tiles = &stream;
    call->submit(&draw, call->user);
    ++tiles->draws;
    return true;
}

/* Casts what the plan holds, nearest first. Boxes are told their level by a constant. */
static void cast_plan(const gtx_draw_call *call, const run *r, uint32_t instance)
{
    gtx_plan *plan = &call->planner->plan;
    float *level = &call->planner->constants.detail[2];
    uint32_t first = 0;
    if (!plan->count || cast_tiles(call, r, instance))
        return;
    gtx_plan_proxies(plan, r->model);
    for (uint32_t k = 0; k < r->model->mip_count; ++k) {
        *level = (float)k;
        cast_ranges(call, r, true, instance, 1, plan->ranges + first, plan->box_count[k]);
        first += plan->box_count[k];
    }
    *level = 0;
    cast_ranges(call, r, false, instance, 1, plan->ranges + first, plan->hull_count);
}

/* Patches of a level that are seen from one side or from two, by the technique for front faces or
 * the one for all. */
static void draw_side(const gtx_draw_call *call, const run *r, uint32_t level,
                      const uint8_t *parts, bool two_sided, bool front, gtx_cull cull)
{
    gtx_planner *planner = call->planner;
    const gtx_lod_level *l = &r->model->lods.levels[level];
    const gtx_technique technique = gtx_lod_technique(
        call, r->model, level, front && (r->count == 1 || !gtx_is_own(call)));
    gtx_frame_draw draw = draw_of(call, r, technique, r->first, r->count);
    draw.cull = cull;
    draw.vertices = GTX_BUFFER_LOD_VERTICES;
    draw.indices = GTX_BUFFER_LOD_INDICES;
    draw.vertex_size = l->vertex_size;
    draw.vertex_offset = l->vertex_offset;
    draw.index_offset = l->index_offset;
    draw.index_size = l->index_size;
    draw.ranges = planner->plan.ranges;
    draw.range_count =
        gtx_lod_ranges(&r->model->lods, level, two_sided, parts, planner->plan.ranges);
    memcpy(planner->constants.lod_mesh, l->place, sizeof l->place);
    if (l->faces && cull == GTX_CULL_BACK && r->count == 1)
        gtx_pick_faces(call, l, &draw);
    if (draw.range_count)
        call->submit(&draw, call->user);
}

/* Whether no instance of a run shows a back: what a host's main leaves out of a surface may. */
static bool hides_backs(const gtx_draw_call *call, const run *r, uint32_t level)
{
    const gtx_lod_meshes *lods = &r->model->lods;
    const bool solid = !gtx_is_own(call) || call->planner->own_vertices ||
                       call->view->flags & GTX_VIEW_SHADING_SOLID;
    bool hidden = !lods->edited_count && solid;
    for (uint32_t i = 0; i < r->count && hidden; ++i) {
        const gtx_frustum f =
            gtx_frustum_of(call, r->model, &call->planner->instances[r->first + i]);
        hidden = gtx_lod_hides_backs(lods, level, &f);
    }
    return hidden;
}

/* An LOD mesh, or parts of it: patches with a back face culled, then those without, unless none of
 * their back faces shows. Of these the front faces first, by their own technique: most back faces
 * lie hidden behind them. A GPU takes longer for vertices than that spares. */
static void draw_lod(const gtx_draw_call *call, const run *r, uint32_t level, const uint8_t *parts)
{
    const gtx_lod_meshes *lods = &r->model->lods;
    const bool own = gtx_is_own(call);
    bool front =
        own || (call->view->pass == GTX_PASS_FORWARD && !gtx_is_lit(call, r->model, level));
    for (uint32_t i = 0; i < r->count && !own; ++i)
        front = front && gtx_keeps_angles(&call->planner->instances[r->first + i]);
    if (lods->one_sided)
        draw_side(call, r, level, parts, false, front, GTX_CULL_BACK);
    if (lods->one_sided == lods->patch_count)
        return;
    const bool hidden = hides_backs(call, r, level);
    const bool twice = front && !hidden && !call->planner->on_gpu;
    if (twice || hidden)
        draw_side(call, r, level, parts, true, front, GTX_CULL_BACK);
    if (!hidden)
        draw_side(call, r, level, parts, true, false, twice ? GTX_CULL_FRONT : GTX_CULL_NONE);
}

/* Displaced grids. */
static void draw_grids(const gtx_draw_call *call, const run *r, uint32_t instance)
{
    gtx_planner *planner = call->planner;
    gtx_grids *grids = &planner->grids;
    const bool keeps_angles = gtx_keeps_angles(&planner->instances[instance]);
    const void *vertices = grids->vertices.data;
    for (uint32_t looks = 0; looks < GTX_GRID_LOOKS; ++looks) {
        const gtx_range all = {
            .count = grids->index_count[looks], .vertex_count = grids->vertex_count};
        if (!all.count)
            continue;
        gtx_frame_draw draw =
            draw_of(call, r, gtx_grid_technique(call, r->model, looks, keeps_angles), instance, 1);
        draw.vertices = GTX_BUFFER_GRID_VERTICES;
        draw.indices = GTX_BUFFER_GRID_INDICES;
        draw.ranges = &all;
        draw.range_count = 1;
        draw.vertex_size = sizeof(gtx_grid_vertex);
        draw.vertex_data = vertices;
        draw.vertex_bytes = vertices ? (uint64_t)grids->vertex_count * draw.vertex_size : 0;
        draw.index_data = grids->indices[looks].data;
        draw.index_bytes = all.count * sizeof(uint32_t);
        const float behind[4] = {looks & GTX_GRID_BEHIND ? 1.0f : 0.0f, 0, 0, 0};
        memcpy(planner->constants.lod_mesh, behind, sizeof behind);
        call->submit(&draw, call->user);
        grids->drawn += all.count / 3;
        vertices = NULL;
    }
}

/* Blocks that the GPU displaces; those seen from two sides in one pass: vertices take most. */
static void draw_blocks(const gtx_draw_call *call, const run *r, uint32_t instance)
{
    static const gtx_range whole = {.count = 3 * GTX_BLOCK_TRIANGLES};
    gtx_grids *grids = &call->planner->grids;
    const bool angles = gtx_keeps_angles(&call->planner->instances[instance]);
    for (uint32_t look = 0; look < GTX_BLOCK_LOOKS; ++look) {
        const uint32_t count = grids->block_count[look];
        gtx_frame_draw draw =
            draw_of(call, r, gtx_block_technique(call, look, angles), instance, count);
        draw.cull = look & GTX_BLOCKS_TWO_SIDED ? GTX_CULL_NONE : GTX_CULL_BACK;
        draw.vertices = GTX_BUFFER_BLOCKS;
        draw.indices = GTX_BUFFER_GRID_INDICES;
        draw.index_size = sizeof *grids->block_indices;
        draw.ranges = &whole;
        draw.range_count = 1;
        draw.vertex_data = grids->blocks[look].data;
        draw.vertex_size = sizeof(gtx_displaced_block);
        draw.vertex_bytes = (uint64_t)count * draw.vertex_size;
        draw.index_data = grids->block_indices;
        draw.index_bytes = sizeof grids->block_indices;
        grids->drawn += (uint64_t)count * GTX_BLOCK_TRIANGLES;
        if (count)
            call->submit(&draw, call->user);
    }
}

/* How many levels of the LOD mesh may be mixed with height fields, the finest first. */
static uint32_t levels_to_mix(const gtx_draw_call *call, const run *r,
                              const gtx_instance_data *placed)
{
    const gtx_lod_meshes *lods = &r->model->lods;
    uint32_t count = 0;
    if (call->view->method != GTX_METHOD_AUTO || r->way != GTX_DRAW_PATCHES)
        return 0;
    const uint32_t worth = gtx_levels_worth(call, r->model, placed);
    while (count < worth && !lods->levels[count].far)
        ++count;
    return count;
}

/* An instance patch by patch, each in its own way. */
static void draw_patches(const gtx_draw_call *call, const run *r, uint32_t instance,
                         bool edited_only)
{
    gtx_plan *plan = &call->planner->plan;
    const gtx_lod_meshes *lods = &r->model->lods;
    const gtx_instance_data *placed = &call->planner->instances[instance];
    gtx_occlusion_end(&call->planner->occlusion);
    gtx_plan_patches(call, r->model, placed, levels_to_mix(call, r, placed), edited_only);
    const bool only_cast = r->way == GTX_DRAW_CAST, by_gpu = call->planner->on_gpu;
    if (!only_cast && by_gpu && gtx_displace_fill(call, r->model, placed))
        draw_blocks(call, r, instance);
    else if (!only_cast && !by_gpu && gtx_blocks_fill(call, r->model, placed))
        draw_grids(call, r, instance);
    cast_plan(call, r, instance);
    const run one = {r->model, instance, 1, 0, r->mirrored};
    for (uint32_t k = 0; plan->any_lod && k < lods->level_count; ++k)
        if (gtx_plan_parts(plan, lods, k))
            draw_lod(call, &one, k, plan->parts);
}

/* The patches of a run, or only those that are edited. Instances that stand alone are sorted, those
 * that need it are looked at patch by patch, and others cast together. */
static void draw_height_fields(const gtx_draw_call *call, const run *r, bool edited_only)
{
    const gtx_model *model = r->model;
    const gtx_instance_data *placed = call->planner->instances;
    if (call->view->method == GTX_METHOD_PAPER) {
        cast_whole(call, r, 0, r->first, r->count);
        return;
    }
    for (uint32_t i = r->first, end = r->first + r->count; i < end;) {
        uint32_t last = i, kind = 0;
        if (r->count > 1 && !edited_only && call->view->method != GTX_METHOD_GRID &&
            (r->way == GTX_DRAW_CAST || !model->lods.level_count))
            kind = gtx_plan_whole(call, model, &placed[i]);
        for (++last; kind && last < end; ++last)
            if (gtx_plan_whole(call, model, &placed[last]) != kind)
                break;
        if (kind)
            cast_whole(call, r, kind, i, last - i);
        else
            draw_patches(call, r, i, edited_only);
        i = last;
    }
}

static void draw_run(const gtx_draw_call *call, const run *r)
{
    if (!r->model) /* before the first run */
        return;
    const bool lod = r->way != GTX_DRAW_PATCHES && r->way != GTX_DRAW_CAST;
    set_model(&call->planner->constants, r->model);
    if (lod)
        draw_lod(call, r, r->way - 1u, NULL);
    if (!lod || r->model->lods.edited_count)
        draw_height_fields(call, r, lod);
}

void gtx_frame_draws(gtx_planner *planner, gtx_submit *submit, void *user)
{
    gtx_draw_call *call = planner ? &planner->call : NULL;
    run r = {NULL, 0, 0, 0, false};
    if (!call || !submit)
        return;
    call->submit = submit;
    call->user = user;
    for (uint32_t i = 0; i < call->count; ++i) {
        const gtx_model *model = call->instances[i].model;
        if (model != r.model || planner->ways[i] != r.way || planner->mirrored[i] != r.mirrored) {
            draw_run(call, &r);
            r = (run){model, i, 0, planner->ways[i], planner->mirrored[i]};
        }
        ++r.count;
    }
    draw_run(call, &r);
}
