/* How an instance is drawn, as a whole or patch by patch, by what that is thought to cost. */
#include "frame/frustum.h"
#include "frame/planner.h"
#include "frame/techniques.h"

#include "base/error.h"

#include <float.h>
#include <math.h>

/* The host's costs, or nanoseconds measured with llvmpipe on two cores, in the forward pass of a
 * dragon of 810,080 triangles in 654 patches: cast in fragments, and by tiles. Other passes cost
 * less, but must choose the same to get the same depth. Those of casting by tiles, with the share
 * of pixels that mix.c takes to show, and of a grid's triangle, found and drawn, and pixel: fits of
 * 96 random views of that dragon and 60 of a bunny (gtx bench --random --methods cast,grid). On a
 * GPU (H200, whose graphics are those of four multiprocessors), by gtx bench of the dragon and the
 * bunny at two sizes: polygons are what it is made for. */
static const gtx_costs *costs_of(const gtx_draw_call *draw)
{
    static const gtx_costs measured[2] = {{100, 25, 15000, 160, 370}, {200, 25, 12000, 120, 370}};
    static const gtx_costs on_gpu = {2, 1, 4000, 17, 0};
    const gtx_costs *told = &draw->planner->costs;
    const bool none = told->lod_triangle == 0 && told->lod_pixel == 0 &&
                      told->cast_patch == 0 && told->cast_pixel == 0 &&
                      told->grid_triangle == 0;
    return !none                   ? told
           : draw->planner->on_gpu ? &on_gpu
                                   : &measured[gtx_tiles_suit(draw)];
}

/* Where the nearest corner of the bounds is closer than this fraction of the distance to their
 * middle, the spheres of the patches are looked at instead. */
static const double near_share = 0.9;

static bool is_by_error(const gtx_view *view)
{
    return view->level == 0 && view->viewport_height > 0;
}

/* The error that an instance is allowed, in object units: at its nearest and its farthest point. */
typedef struct extent {
    double nearest, farthest;
} extent;

/* The least w of what the patches reach, of w in clip space as a row over object space. */
static double nearest_patch(const gtx_model *model, const double w[4])
{
    const double slope = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    double least = DBL_MAX;
    for (uint32_t p = 0; p < model->patch_count; ++p) {
        const float *s = model->facts[p].sphere;
        least = fmin(least, w[0] * s[0] + w[1] * s[1] + w[2] * s[2] - slope * s[3]);
    }
    return least + w[3];
}

static extent measure_from(const gtx_draw_call *draw, const float clip[16],
                           const gtx_model *model, const gtx_instance_data *placed)
{
    const gtx_lod_meshes *lods = &model->lods;
    double w[4] = {0, 0, 0, clip[15]};             /* w in clip space, as a row over object space */
    for (int k = 0; k < 4; ++k)
        for (int r = 0; r < 3; ++r)
            w[k] += (double)clip[4 * r + 3] * placed->world[r][k];
    double nearest = w[3], farthest = w[3];
    for (int k = 0; k < 3; ++k) {
        const double low = lods->low[k], high = lods->high[k];
        nearest += fmin(w[k] * low, w[k] * high);
        farthest += fmax(w[k] * low, w[k] * high);
    }
    if (nearest < near_share * (nearest + farthest) / 2)
        nearest = fmax(nearest, nearest_patch(model, w));
    /* detail[0]: pixels a world unit at w = 1, over the error allowed in pixels. */
    const double scale = draw->sight.detail[0] * gtx_stretch_of(placed);
    return (extent){fmax(nearest, 0) / scale, fmax(farthest, 0) / scale};
}

/* Of two eyes, the nearer and the farther one. */
static extent measure(const gtx_draw_call *draw, const gtx_model *model,
                      const gtx_instance_data *placed)
{
    const gtx_sight *sight = &draw->sight;
    const extent e = measure_from(draw, sight->clip_from_world, model, placed);
    if (!sight->two)
        return e;
    const extent other = measure_from(draw, sight->other_clip, model, placed);
    return (extent){fmin(e.nearest, other.nearest), fmax(e.farthest, other.farthest)};
}

double gtx_allowed_anywhere(const gtx_draw_call *draw, const gtx_model *model,
                            const gtx_instance_data *placed)
{
    return measure(draw, model, placed).nearest;
}

/* Of a model from where the error allowed, squared, is that of object space. */
static double pixels_of(const gtx_draw_call *draw, const gtx_lod_meshes *lods, double error)
{
    const double allowed = draw->view->max_error > 0 ? draw->view->max_error : 0.5;
    double square = 0;
    for (int k = 0; k < 3; ++k)
        square += pow((double)lods->high[k] - lods->low[k], 2) / 4;
    return allowed * allowed * square / fmax(error, FLT_MIN);
}

uint32_t gtx_levels_cast(const gtx_draw_call *draw, const gtx_model *model)
{
    if (model->bare)
        return 0;
    const gtx_costs *costs = costs_of(draw);
    const gtx_lod_meshes *lods = &model->lods;
    for (uint32_t k = 0; k < lods->level_count; ++k) {
        const gtx_lod_level *level = &lods->levels[k], *next = level + (k + 1 < lods->level_count);
        const double pixels = pixels_of(draw, lods, (double)level->error * next->error);
        if (costs->cast_patch * model->patch_count + costs->cast_pixel * pixels >=
            costs->lod_triangle * level->triangle_count + costs->lod_pixel * pixels)
            return k;
    }
    return lods->level_count;
}

/* A pixel of a grid beside one of an LOD mesh, of the same fit: many are those of two triangles. */
static const double grid_pixel = 1.2;

double gtx_grid_cost(const gtx_draw_call *draw, uint32_t triangles, double pixels)
{
    const gtx_costs *costs = costs_of(draw);
    const double triangle =
        costs->grid_triangle > 0 ? costs->grid_triangle : 2 * costs->lod_triangle;
    return triangle * triangles + grid_pixel * costs->lod_pixel * pixels;
}

double gtx_displaced_cost(const gtx_draw_call *draw, uint32_t triangles, double pixels)
{
    const gtx_costs *costs = costs_of(draw);
    return costs->lod_triangle * triangles + costs->lod_pixel * pixels;
}

double gtx_cast_cost(const gtx_draw_call *draw, uint32_t patches, double pixels)
{
    const gtx_costs *costs = costs_of(draw);
    return costs->cast_patch * patches + costs->cast_pixel * pixels;
}

/* Far levels cannot be mixed with edited patches. */
static uint32_t usable_levels(const gtx_lod_meshes *lods, uint32_t worth)
{
    uint32_t count = 0;
    while (count < worth && !(lods->edited_count && lods->levels[count].far))
        ++count;
    return count;
}

/* How many levels, the finest first, are within an error. */
static uint32_t levels_within(const gtx_lod_meshes *lods, uint32_t usable, double error)
{
    uint32_t level = 0;
    while (level < usable && lods->levels[level].error <= error)
        ++level;
    return level;
}

/* Pixels in which looking maps up takes as long as a triangle. By SwiftShader, a bunny in a page of
 * 640x480: the level that is lit at its vertices takes 0.6 of what that takes which is just within
 * 2 pixels, 0.8 of that within 4, and a ninth more than that within 7. At half it is drawn there,
 * too; at double no more at 4. */
static const double pixels_a_triangle = 8;

/* Of a level's triangles those that are drawn: half, where what faces the eye is picked. */
static double triangles_of(const gtx_lod_level *level)
{
    return (level->faces ? 0.5 : 1) * level->triangle_count;
}

/* The coarsest of so many levels that is lit at its vertices and picked from, counted from 1. */
static uint32_t lit_level(const gtx_lod_meshes *lods, uint32_t level)
{
    while (level > 0 && !(lods->levels[level - 1].lit && lods->levels[level - 1].faces))
        --level;
    return level;
}

/* A level coarser than one that is lit at its vertices has fewer triangles, but maps are looked up
 * in each of its pixels. Looked for only where triangles are picked, by software. */
uint32_t gtx_levels_worth(const gtx_draw_call *draw, const gtx_model *model,
                          const gtx_instance_data *placed)
{
    const gtx_lod_meshes *lods = &model->lods;
    const uint32_t all = lods->level_count;
    uint32_t lit = lit_level(lods, all);
    if (!lit || gtx_material_of(model) != MATERIAL_NONE || !is_by_error(draw->view))
        return all;
    const extent e = measure(draw, model, placed);
    const uint32_t level = levels_within(lods, all, e.nearest);
    lit = lit_level(lods, level);
    if (lit <= gtx_levels_cast(draw, model))
        return all;
    const double pixels = pixels_of(draw, lods, pow((e.nearest + e.farthest) / 2, 2));
    const double more =
        triangles_of(&lods->levels[lit - 1]) - triangles_of(&lods->levels[level - 1]);
    return pixels_a_triangle * more <= pixels ? lit : all;
}

/* As a whole only where that draws each patch as it would be drawn by itself: a part must not be
 * drawn coarser again when the instance is nearer. `level` counts from 1. */
static uint8_t choose(const gtx_draw_call *draw, const gtx_model *model,
                      const gtx_instance_data *placed, uint32_t level, uint32_t usable, extent e)
{
    const gtx_lod_meshes *lods = &model->lods;
    const bool far = level && lods->levels[level - 1].far;
    uint32_t mixed = 0;
    while (mixed < usable && !lods->levels[mixed].far)
        ++mixed;
    if (far)
        return level <= gtx_levels_cast(draw, model) ? GTX_DRAW_CAST : (uint8_t)level;
    if (!level || levels_within(lods, mixed, e.farthest) > level)
        return GTX_DRAW_PATCHES;
    if (level <= gtx_levels_cast(draw, model))
        return GTX_DRAW_CAST;
    const gtx_frustum f = gtx_frustum_of(draw, model, placed);
    const bool whole =
        gtx_plan_suits_whole(draw, model, level - 1) && !gtx_is_cut(&f, model->sphere);
    return whole ? (uint8_t)level : GTX_DRAW_PATCHES;
}

gtx_result gtx_choose(const gtx_draw_call *draw, const gtx_model *model,
                      const gtx_instance_data *placed, uint8_t *out, gtx_error *error)
{
    const gtx_view *view = draw->view;
    const gtx_lod_meshes *lods = &model->lods;
    const bool only = view->method == GTX_METHOD_AUTO && model->bare && lods->level_count;
    const bool forced = view->method == GTX_METHOD_LOD || only;
    const bool by_error = is_by_error(view);
    if (forced && !lods->level_count)
        return gtx_fail(error, GTX_ERROR_UNSUPPORTED, "the asset has no LOD mesh to be drawn by");
    *out = view->method == GTX_METHOD_GRID ? GTX_DRAW_PATCHES : GTX_DRAW_CAST;
    if (!forced && (view->method != GTX_METHOD_AUTO || !by_error))
        return GTX_OK;
    const uint32_t usable = usable_levels(lods, gtx_levels_worth(draw, model, placed));
    uint32_t level = view->level < usable ? view->level : usable;
    extent e = {0, 0};
    if (by_error) {
        e = measure(draw, model, placed);
        level = levels_within(lods, usable, e.nearest);
    }
    /* Patch by patch, as the whole asset's. */
    const bool mixed = only && by_error && !lods->levels[0].far;
    if (forced && usable && !mixed)
        *out = (uint8_t)(level ? level : 1);
    else if (!forced || usable)
        *out = choose(draw, model, placed, level, usable, e);
    return GTX_OK;
}
