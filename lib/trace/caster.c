/* The ray query: a caster is made of an asset, rays go in, hits come out. */
#include "trace/caster.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>

gtx_result gtx_caster_create(const gtx_asset *asset, const gtx_caster_desc *desc,
                             gtx_caster **out, gtx_error *error)
{
    const gtx_caster_desc zero = {0};
    const gtx_caster_desc *d = desc ? desc : &zero;
    if (!asset || !out || d->level >= GTX_MAX_MIPS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "casting needs an asset and a level below %d",
                        GTX_MAX_MIPS);
    if (!(d->max_error >= 0) || isinf(d->max_error) || (d->max_error > 0 && d->level))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "casting takes a level, or a finite error >= 0 that chooses levels");
    gtx_result result =
        gtx_check_reserved(d->reserved, sizeof d->reserved / sizeof *d->reserved, error);
    if (result)
        return result;
    const gtx_allocator hooks = gtx_allocator_or_default(d->allocator);
    gtx_caster *caster = gtx_alloc_array(&hooks, 1, sizeof *caster);
    if (!caster)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a caster");
    caster->allocator = hooks;
    caster->sheet_count = asset->info.patch_count;
    result = gtx_sheets_build(caster, asset, d->level, d->max_error, error);
    if (!result)
        result = gtx_bvh_build(&caster->bvh, caster->sheets, caster->sheet_count, &hooks, error);
    if (result) {
        gtx_caster_destroy(caster);
        return result;
    }
    *out = caster;
    return GTX_OK;
}

void gtx_caster_destroy(gtx_caster *caster)
{
    if (!caster)
        return;
    const gtx_allocator hooks = caster->allocator;
    gtx_sheets_free(caster);
    gtx_bvh_free(&caster->bvh, &hooks);
    gtx_free_array(&hooks, caster, 1, sizeof *caster);
}

/* False for rays that hit nothing by rule. */
static bool read_ray(const gtx_ray *ray, gtx_line *out)
{
    bool moves = false;
    for (int a = 0; a < 3; ++a) {
        if (!isfinite(ray->origin[a]) || !isfinite(ray->direction[a]))
            return false;
        out->origin[a] = ray->origin[a];
        out->direction[a] = ray->direction[a];
        moves |= ray->direction[a] != 0;
    }
    out->t_min = ray->t_min;
    out->t_max = ray->t_max <= 0 ? INFINITY : ray->t_max;
    return moves && out->t_min <= out->t_max; /* false with a NaN */
}

/* Where the ray enters the box, no later than `limit`; infinity when it misses. Boxes are rounded
 * outwards, so a ray that lies in a face may go either way. */
static double enter(const gtx_bvh_node *node, const gtx_line *ray, const double inverse[3],
                    double limit)
{
    double t0 = ray->t_min, t1 = limit;
    for (int a = 0; a < 3; ++a) {
        double near = (node->low[a] - ray->origin[a]) * inverse[a];
        double far = (node->high[a] - ray->origin[a]) * inverse[a];
        if (inverse[a] < 0) {
            double swap = near;
            near = far;
            far = swap;
        }
        t0 = near > t0 ? near : t0;
        t1 = far < t1 ? far : t1;
    }
    return t0 <= t1 ? t0 : INFINITY;
}

static gtx_crossing cast_tree(const gtx_caster *caster, const gtx_line *ray, uint32_t flags)
{
    const gtx_bvh_node *nodes = caster->bvh.nodes;
    const double inverse[3] = {1 / ray->direction[0], 1 / ray->direction[1],
                               1 / ray->direction[2]};
    const bool both = flags & GTX_RAY_TWO_SIDED;
    gtx_crossing best = {.t = ray->t_max, .sheet = UINT32_MAX};
    struct {
        uint32_t node;
        double t;
    } stack[GTX_BVH_DEPTH];
    int size = 0;
    if (caster->bvh.node_count) {
        stack[size].node = 0;
        stack[size++].t = enter(&nodes[0], ray, inverse, best.t);
    }
    while (size) {
        const gtx_bvh_node *node = &nodes[stack[--size].node];
        if (stack[size].t == INFINITY || stack[size].t > best.t)
            continue;
        for (uint32_t i = 0; i < node->count; ++i)
            gtx_walk_sheet(caster, caster->bvh.order[node->first + i], ray, both, &best);
        if (node->count) {
            if (best.sheet != UINT32_MAX && (flags & GTX_RAY_ANY))
                break;
            continue;
        }
        double t[2];
        for (uint32_t k = 0; k < 2; ++k)
            t[k] = enter(&nodes[node->first + k], ray, inverse, best.t);
        for (uint32_t k = 0; k < 2; ++k) { /* the nearer child on top */
            uint32_t which = t[0] <= t[1] ? 1 - k : k;
            stack[size].node = node->first + which;
            stack[size++].t = t[which];
        }
    }
    return best;
}

static gtx_crossing cast_exhaustively(const gtx_caster *caster, const gtx_line *ray,
                                      uint32_t flags)
{
    gtx_crossing best = {.t = ray->t_max, .sheet = UINT32_MAX};
    for (uint32_t i = 0; i < caster->sheet_count; ++i)
        gtx_search_sheet(caster, i, ray, flags & GTX_RAY_TWO_SIDED, &best);
    return best;
}

static gtx_hit describe(const gtx_caster *caster, const gtx_crossing *crossing)
{
    const gtx_sheet *sheet = &caster->sheets[crossing->sheet];
    /* The cell behind the coordinates; a crossing may lie a rounding error outside. */
    const double right = sheet->width - 1, top = sheet->height - 1;
    const double x = fmin(fmax(crossing->x, 0), right), y = fmin(fmax(crossing->y, 0), top);
    uint32_t i = (uint32_t)fmin(x, right - 1) >> sheet->level;
    uint32_t j = (uint32_t)fmin(y, top - 1) >> sheet->level;
    gtx_cell cell = gtx_sheet_cell(sheet, i, j);
    gtx_hit hit = {.t = (float)crossing->t, .patch = crossing->sheet, .x = (float)x,
                   .y = (float)y, .back = crossing->back};
    gtx_sheet_normal(sheet, x, y, hit.normal);
    gtx_sheet_facet(sheet, &cell, x, y, hit.facet);
    return hit;
}

gtx_result gtx_raycast(const gtx_caster *caster, const gtx_ray *rays, gtx_hit *hits, size_t count,
                       uint32_t flags)
{
    if (!caster || (count && (!rays || !hits)) ||
        (flags & ~(uint32_t)(GTX_RAY_ANY | GTX_RAY_TWO_SIDED | GTX_RAY_EXHAUSTIVE)))
        return GTX_ERROR_ARGUMENT;
    for (size_t i = 0; i < count; ++i) {
        gtx_line ray;
        gtx_crossing crossing = {.sheet = UINT32_MAX};
        if (read_ray(&rays[i], &ray))
            crossing = flags & GTX_RAY_EXHAUSTIVE ? cast_exhaustively(caster, &ray, flags)
                                                  : cast_tree(caster, &ray, flags);
        hits[i] = crossing.sheet == UINT32_MAX
                      ? (gtx_hit){.t = INFINITY, .patch = UINT32_MAX}
                      : describe(caster, &crossing);
    }
    return GTX_OK;
}
