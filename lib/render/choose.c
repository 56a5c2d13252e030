/* The choice between casting and the LOD mesh, for an instance at a time. */
#include "render/renderer.h"

#include "base/error.h"

#include <float.h>
#include <math.h>

/* What the host has told, or nanoseconds with llvmpipe on two cores, of the forward pass of a
 * dragon of 810,080 triangles in 526 patches: cast in fragments, cast by tiles. Other passes
 * cost less, but have to choose the same for the same depth. */
static const gtx_costs *costs_of(const gtx_draw_call *draw)
{
    static const gtx_costs measured[2] = {{100, 25, 15000, 160}, {100, 25, 5500, 75}};
    const gtx_costs *told = &draw->renderer->costs;
    const bool none = told->lod_triangle == 0 && told->lod_pixel == 0 &&
                      told->cast_patch == 0 && told->cast_pixel == 0;
    return none ? &measured[gtx_stream_suits(draw->renderer, draw->view)] : told;
}

/* A box whose nearest corner is nearer than this share of the way to its middle is looked into. */
static const double near_share = 0.9;

/* How large an instance is in the picture. */
typedef struct extent {
    double error;             /* object units that are the error allowed, where it is nearest */
    double pixels;            /* that it covers, roughly */
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

static extent measure(const gtx_draw_call *draw, const gtx_model *model,
                      const gtx_instance_data *placed)
{
    const gtx_lod_meshes *lods = &model->lods;
    const float *clip = draw->frame.clip_from_world;
    double w[4] = {0, 0, 0, clip[15]}, radius = 0; /* w in clip space, as a row over object space */
    for (int k = 0; k < 4; ++k)
        for (int r = 0; r < 3; ++r)
            w[k] += (double)clip[4 * r + 3] * placed->world[r][k];
    double nearest = w[3], middle = w[3];
    for (int k = 0; k < 3; ++k) {
        const double low = lods->low[k], high = lods->high[k];
        nearest += fmin(w[k] * low, w[k] * high);
        middle += w[k] * (low + high) / 2;
        radius += (high - low) * (high - low) / 4;
    }
    /* Patches tell it more closely than the corner of a box, where that makes a difference. */
    if (nearest < near_share * middle)
        nearest = fmax(nearest, nearest_patch(model, w));
    /* detail[0]: pixels a world unit at w = 1, over the error allowed in pixels. */
    const double scale = draw->frame.detail[0] * gtx_stretch_of(placed);
    const double allowed = draw->view->max_error > 0 ? draw->view->max_error : 0.5;
    const double across = scale * allowed * sqrt(radius) / fmax(middle, DBL_MIN);
    return (extent){fmax(nearest, 0) / scale, across * across};
}

/* Whether casting is thought to take less. */
static bool is_casting_cheaper(const gtx_costs *costs, const gtx_model *model, uint32_t level,
                               double pixels)
{
    const double triangles = model->lods.levels[level].triangle_count;
    return costs->cast_patch * model->patch_count + costs->cast_pixel * pixels <
           costs->lod_triangle * triangles + costs->lod_pixel * pixels;
}

/* How many levels there are, of which far ones leave no room for patches that are edited. */
static uint32_t usable_levels(const gtx_lod_meshes *lods)
{
    uint32_t count = 0;
    while (count < lods->level_count && !(lods->edited_count && lods->levels[count].far))
        ++count;
    return count;
}

/* The finest level may be off by so many times the error allowed before an instance is cast, which
 * takes several times as long. */
static const double finest_excess = 1.5;

gtx_result gtx_choose_lod(const gtx_draw_call *draw, const gtx_model *model,
                          const gtx_instance_data *placed, uint8_t *lod, gtx_error *error)
{
    const gtx_view *view = draw->view;
    const gtx_lod_meshes *lods = &model->lods;
    const bool forced = view->method == GTX_METHOD_LOD;
    const bool by_error = view->level == 0 && view->viewport_height > 0;
    *lod = 0;
    if (forced && !lods->level_count)
        return gtx_fail(error, GTX_ERROR_UNSUPPORTED, "the asset has no LOD mesh to be drawn by");
    if (!lods->level_count || !(forced || (view->method == GTX_METHOD_AUTO && by_error)))
        return GTX_OK;
    const uint32_t usable = usable_levels(lods);
    uint32_t level = view->level < usable ? view->level : usable;
    if (by_error) {
        const extent e = measure(draw, model, placed);
        while (level < usable && lods->levels[level].error <= e.error)
            ++level;
        if (!level && usable && lods->levels[0].error <= finest_excess * e.error)
            level = 1;
        if (!forced && level &&
            is_casting_cheaper(costs_of(draw), model, level - 1, e.pixels))
            level = 0;
    }
    *lod = (uint8_t)(forced && !level && usable ? 1 : level);
    return GTX_OK;
}
