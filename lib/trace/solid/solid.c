/* Solids: made of an asset, measured, and queried. */
#include "trace/solid/solid.h"

#include "base/alloc.h"
#include "base/error.h"
#include "base/limits.h"

#include <math.h>
#include <string.h>

/* Bunny with its five holes at the bottom, and scans with more, are below it; half a sphere, or a
 * cup with walls of no thickness, far above. */
static const double MAX_OPENNESS = 0.01;
enum { SAMPLES = 1024 };

/* Flux of x / 3 through the surface, from the middle of the bounds, which rounds least. */
static void measure(gtx_solid *solid)
{
    gtx_solid_facts *facts = &solid->facts;
    const gtx_node *root = solid->tree.nodes;
    for (uint32_t i = 0; i < solid->element_count; ++i) {
        const gtx_element *e = &solid->elements[i];
        double v[3][3], normal[3], square = 0, flux = 0;
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < 3; ++k)
                v[c][k] = (double)e->corner[c][k] -
                          ((double)root->low[k] + (double)root->high[k]) / 2;
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            normal[k] = (v[1][a] - v[0][a]) * (v[2][b] - v[0][b]) -
                        (v[1][b] - v[0][b]) * (v[2][a] - v[0][a]);
            square += normal[k] * normal[k];
            flux += normal[k] * v[0][k];
        }
        facts->area += (double)e->weight * sqrt(square) / 2;
        facts->volume += (double)e->weight * flux / 6;
    }
}

/* The radical inverse: evenly spread over 0..1 (Halton 1960). */
static double spread(uint32_t index, uint32_t base)
{
    double share = 1, sum = 0;
    for (; index; index /= base) {
        share /= base;
        sum += share * (index % base);
    }
    return sum;
}

static double find_openness(const gtx_solid *solid, gtx_budget *budget)
{
    static const uint32_t bases[3] = {2, 3, 5};
    const gtx_node *root = solid->tree.nodes;
    uint32_t doubtful = 0;
    for (uint32_t i = 0; i < SAMPLES && budget->done <= budget->most; ++i) {
        double point[3];
        for (int k = 0; k < 3; ++k)
            point[k] = (double)root->low[k] +
                       spread(i + 1, bases[k]) * ((double)root->high[k] - (double)root->low[k]);
        const double number = gtx_winding_at(solid, point, &budget->done);
        doubtful += number < -0.25 || fabs(number - floor(number + 0.5)) > 0.25;
    }
    return (double)doubtful / SAMPLES;
}

uint64_t gtx_solid_texels(const gtx_asset *asset)
{
    uint64_t texels = 0;
    for (uint32_t p = 0; p < asset->info.patch_count; ++p)
        texels += (uint64_t)asset->patches[p].rect[2] * asset->patches[p].rect[3];
    return texels;
}

gtx_budget gtx_solid_budget(const gtx_limits *limits, uint64_t texels)
{
    return (gtx_budget){.most = gtx_limit_of(limits, GTX_LIMITED_WORK, texels)};
}

/* Points may lie where boxes around them end beyond all floats. */
static bool is_bounded(const gtx_node *root)
{
    for (int k = 0; k < 3; ++k)
        if (!isfinite(root->low[k]) || !isfinite(root->high[k]))
            return false;
    return true;
}

static gtx_result build(gtx_solid *solid, const gtx_asset *asset, const gtx_solid_desc *desc,
                        gtx_error *error)
{
    const gtx_caster_desc casting = {.allocator = &solid->allocator, .limits = desc->limits};
    const double most = desc->max_openness > 0 ? (double)desc->max_openness : MAX_OPENNESS;
    gtx_budget budget = gtx_solid_budget(&desc->limits, gtx_solid_texels(asset));
    gtx_result result = gtx_caster_create(asset, &casting, &solid->caster, error);
    if (!result)
        result = gtx_elements_build(solid, asset, desc->jobs, &desc->limits, &budget, error);
    if (!result && !is_bounded(&solid->tree.nodes[0]))
        return gtx_fail(error, GTX_ERROR_INPUT, "the asset is too large to be measured");
    if (!result)
        result = gtx_winding_build(solid, error);
    if (result)
        return result;
    measure(solid);
    solid->facts.openness = find_openness(solid, &budget);
    if (budget.done > budget.most)
        return gtx_fail_limit(error, GTX_LIMITED_WORK, "a solid", budget.done, budget.most);
    if (solid->facts.openness > most)
        return gtx_fail(error, GTX_ERROR_INPUT,
                        "the surface is open or faces inwards: what is inside is in doubt at "
                        "%.3g %% of the points in its bounds", 100 * solid->facts.openness);
    return GTX_OK;
}

gtx_result gtx_solid_create(const gtx_asset *asset, const gtx_solid_desc *desc, gtx_solid **out,
                            gtx_error *error)
{
    const gtx_solid_desc zero = {0};
    const gtx_solid_desc *d = desc ? desc : &zero;
    if (!asset || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a solid needs an asset");
    if (!(d->max_openness >= 0 && d->max_openness <= 1))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "max_openness is 0 to 1");
    gtx_result result = gtx_check_reserved(d->reserved, 5, error);
    if (!result)
        result = gtx_check_limits(&d->limits, error);
    if (result)
        return result;
    const gtx_allocator hooks = gtx_allocator_or_default(d->allocator);
    gtx_solid *solid = gtx_alloc_array(&hooks, 1, sizeof *solid);
    if (!solid)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a solid");
    solid->allocator = hooks;
    result = build(solid, asset, d, error);
    if (result) {
        gtx_solid_destroy(solid);
        return result;
    }
    *out = solid;
    return GTX_OK;
}

void gtx_solid_destroy(gtx_solid *solid)
{
    if (!solid)
        return;
    const gtx_allocator hooks = solid->allocator;
    gtx_caster_destroy(solid->caster);
    gtx_free_array(&hooks, solid->moments, solid->tree.node_count, sizeof *solid->moments);
    gtx_hierarchy_free(&solid->tree, &hooks);
    gtx_free_array(&hooks, solid->elements, solid->element_room, sizeof *solid->elements);
    gtx_free_array(&hooks, solid->groups, solid->group_count, sizeof *solid->groups);
    gtx_free_array(&hooks, solid, 1, sizeof *solid);
}

void gtx_solid_measure(const gtx_solid *solid, gtx_solid_facts *out)
{
    if (out)
        *out = solid ? solid->facts : (gtx_solid_facts){0};
}

static double number_at(const gtx_solid *solid, const float from[3])
{
    const double point[3] = {(double)from[0], (double)from[1], (double)from[2]};
    for (int k = 0; k < 3; ++k)
        if (!isfinite(point[k]))
            return NAN;
    uint64_t steps = 0;
    return gtx_winding_at(solid, point, &steps);
}

gtx_result gtx_solid_winding(const gtx_solid *solid, const float (*points)[3], float *numbers,
                             size_t count)
{
    if (!solid || (count && (!points || !numbers)))
        return GTX_ERROR_ARGUMENT;
    for (size_t i = 0; i < count; ++i)
        numbers[i] = (float)number_at(solid, points[i]);
    return GTX_OK;
}

gtx_result gtx_solid_inside(const gtx_solid *solid, const float (*points)[3], uint8_t *inside,
                            size_t count)
{
    if (!solid || (count && (!points || !inside)))
        return GTX_ERROR_ARGUMENT;
    for (size_t i = 0; i < count; ++i)
        inside[i] = number_at(solid, points[i]) > 0.5;
    return GTX_OK;
}
