/* The ray query: making a caster of an asset, and casting rays. */
#include "trace/caster.h"

#include "base/alloc.h"
#include "base/error.h"
#include "derive/crowd.h"
#include "derive/placement.h"
#include "trace/slabs.h"

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
    if (!result)
        result = gtx_check_limits(&d->limits, error);
    if (!result)
        result = gtx_check_crowd(asset, &d->limits, error);
    if (result)
        return result;
    const gtx_allocator hooks = gtx_allocator_or_default(d->allocator);
    gtx_caster *caster = gtx_alloc_array(&hooks, 1, sizeof *caster);
    if (!caster)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a caster");
    caster->allocator = hooks;
    caster->field_count = asset->info.patch_count;
    caster->ray_offset = gtx_ray_offset(asset);
    result = gtx_fields_build(caster, asset, d, error);
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
    gtx_fields_free(caster);
    gtx_free_array(&hooks, caster, 1, sizeof *caster);
}

bool gtx_read_ray(const gtx_ray *ray, gtx_line *out)
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

static gtx_crossing cast_tree(const gtx_caster *caster, const gtx_line *ray, uint32_t flags)
{
    const gtx_node *nodes = caster->tree.nodes, *leaf;
    const gtx_slabs s = gtx_slabs_of(ray);
    gtx_crossing best = {.t = ray->t_max, .field = UINT32_MAX};
    float limit = gtx_slabs_limit(&s, best.t);
    gtx_line line; /* in the grid space of the height field met last */
    uint32_t field = UINT32_MAX;
    gtx_subtree stack[GTX_HIERARCHY_DEPTH];
    gtx_subtree at = {0, caster->tree.node_count ? gtx_enter(nodes, &s, limit) : INFINITY};
    int size = 0;
    while ((leaf = gtx_next_leaf(nodes, &s, limit, &at, stack, &size))) {
        const gtx_block *block = &caster->blocks[leaf->link - GTX_LEAF];
        if (block->field != field) {
            field = block->field;
            line = gtx_field_line(&caster->fields[field], ray);
        }
        gtx_walk_block(caster, block, &line, flags & GTX_RAY_TWO_SIDED, &best);
        if (best.field != UINT32_MAX && (flags & GTX_RAY_ANY))
            break;
        limit = gtx_slabs_limit(&s, best.t);
    }
    return best;
}

uint32_t gtx_cast_each(const gtx_caster *caster, const gtx_line *ray, gtx_crossing_fn fn,
                       void *user)
{
    const gtx_node *leaf;
    const gtx_slabs s = gtx_slabs_of(ray);
    const float limit = gtx_slabs_limit(&s, ray->t_max);
    gtx_subtree stack[GTX_HIERARCHY_DEPTH];
    gtx_subtree at = {0, caster->tree.node_count ? gtx_enter(caster->tree.nodes, &s, limit)
                                                 : INFINITY};
    uint32_t blocks = 0;
    int size = 0;
    while ((leaf = gtx_next_leaf(caster->tree.nodes, &s, limit, &at, stack, &size))) {
        const gtx_block *block = &caster->blocks[leaf->link - GTX_LEAF];
        const gtx_line line = gtx_field_line(&caster->fields[block->field], ray);
        gtx_crossing crossing = {.t = ray->t_max, .field = UINT32_MAX};
        gtx_walk_block(caster, block, &line, true, &crossing);
        if (crossing.field != UINT32_MAX)
            fn(&crossing, user);
        ++blocks;
    }
    return blocks;
}

static gtx_crossing cast_exhaustively(const gtx_caster *caster, const gtx_line *ray,
                                      uint32_t flags)
{
    gtx_crossing best = {.t = ray->t_max, .field = UINT32_MAX};
    for (uint32_t i = 0; i < caster->field_count; ++i)
        gtx_search_field(caster, i, ray, flags & GTX_RAY_TWO_SIDED, &best);
    return best;
}

gtx_crossing gtx_cast_line(const gtx_caster *caster, const gtx_line *line, uint32_t flags)
{
    return flags & GTX_RAY_EXHAUSTIVE ? cast_exhaustively(caster, line, flags)
                                      : cast_tree(caster, line, flags);
}

gtx_hit gtx_describe(const gtx_caster *caster, const gtx_crossing *crossing)
{
    const gtx_height_field *field = &caster->fields[crossing->field];
    /* The cell behind the coordinates; a crossing may lie a rounding error outside. */
    const double right = field->width - 1, top = field->height - 1;
    const double x = fmin(fmax(crossing->x, 0), right), y = fmin(fmax(crossing->y, 0), top);
    uint32_t i = (uint32_t)fmin(x, right - 1) >> field->level;
    uint32_t j = (uint32_t)fmin(y, top - 1) >> field->level;
    gtx_cell cell = gtx_field_cell(field, i, j);
    gtx_hit hit = {.t = (float)crossing->t, .patch = crossing->field, .x = (float)x,
                   .y = (float)y, .back = crossing->back};
    gtx_field_normal(field, x, y, hit.normal);
    gtx_field_facet(field, &cell, x, y, hit.facet);
    return hit;
}

gtx_result gtx_raycast(const gtx_caster *caster, const gtx_ray *rays, gtx_hit *hits, size_t count,
                       uint32_t flags)
{
    if (!caster || (count && (!rays || !hits)) ||
        flags & ~(uint32_t)GTX_RAY_FLAGS)
        return GTX_ERROR_ARGUMENT;
    for (size_t i = 0; i < count; ++i) {
        gtx_line ray;
        gtx_crossing crossing = {.field = UINT32_MAX};
        if (gtx_read_ray(&rays[i], &ray))
            crossing = gtx_cast_line(caster, &ray, flags);
        hits[i] = crossing.field == UINT32_MAX
                      ? (gtx_hit){.t = INFINITY, .patch = UINT32_MAX}
                      : gtx_describe(caster, &crossing);
    }
    return GTX_OK;
}
