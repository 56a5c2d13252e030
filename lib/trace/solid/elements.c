/* The surface of an asset as triangles that count once where patches overlap. */
#include "trace/solid/solid.h"

#include "base/alloc.h"
#include "base/error.h"
#include "base/limits.h"
#include "derive/crowd.h"

#include <math.h>
#include <string.h>

/* Two patches show the same surface where they are no farther apart than this, in texels of the
 * patch that is looked from, and face the same way within 60 degrees. */
static const double APART = 1, ALIKE = 0.5;
/* Texels from the outline within which weights are sampled more finely, and the parts along a
 * side. */
static const float NARROW = 1;
enum { SPLIT = 4 };

/* A corner of what is clipped: a point, and how deep it is inside the outline, in texels. */
typedef struct clip_corner {
    double point[3], depth;
} clip_corner;

static void add_element(gtx_solid *solid, const clip_corner *a, const clip_corner *b,
                        const clip_corner *c)
{
    if (solid->elements) {
        gtx_element *e = &solid->elements[solid->element_count];
        for (int k = 0; k < 3; ++k) {
            e->corner[0][k] = (float)a->point[k];
            e->corner[1][k] = (float)b->point[k];
            e->corner[2][k] = (float)c->point[k];
        }
        e->depth[0] = (float)a->depth;
        e->depth[1] = (float)b->depth;
        e->depth[2] = (float)c->depth;
        e->weight = 0;
    }
    ++solid->element_count;
}

/* The part of a triangle that is inside the outline (Sutherland and Hodgman 1974). */
static void add_clipped(gtx_solid *solid, const clip_corner *const triangle[3])
{
    clip_corner kept[4];
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        const clip_corner *a = triangle[i], *b = triangle[(i + 1) % 3];
        if (a->depth >= 0)
            kept[count++] = *a;
        if ((a->depth >= 0) == (b->depth >= 0))
            continue;
        const double t = a->depth / (a->depth - b->depth);
        clip_corner *cut = &kept[count++];
        cut->depth = 0;
        for (int k = 0; k < 3; ++k)
            cut->point[k] = a->point[k] + t * (b->point[k] - a->point[k]);
    }
    for (int i = 2; i < count; ++i)
        add_element(solid, &kept[0], &kept[i - 1], &kept[i]);
}

/* Halved along either diagonal in turn, so that saddles do not add up. */
static void add_cell(gtx_solid *solid, const gtx_asset *asset, const gtx_patch *patch, uint32_t x,
                     uint32_t y)
{
    clip_corner at[4];
    double deepest = -1;
    for (uint32_t k = 0; k < 4; ++k) {
        const uint32_t i = x + (k & 1), j = y + (k >> 1);
        const uint32_t code = gtx_height_code(asset, patch, i, j);
        if (!code)
            return;
        gtx_texel_point(patch, i, j, gtx_code_height(code, asset->info.height_bits), at[k].point);
        at[k].depth = -gtx_trim_distance(gtx_trim_code(asset, patch, i, j));
        deepest = fmax(deepest, at[k].depth);
    }
    static const uint8_t halves[2][2][3] = {{{0, 1, 3}, {0, 3, 2}}, {{0, 1, 2}, {1, 3, 2}}};
    for (int h = 0; h < 2 && deepest >= 0; ++h) {
        const uint8_t *k = halves[(x + y) & 1][h];
        add_clipped(solid, (const clip_corner *[3]){&at[k[0]], &at[k[1]], &at[k[2]]});
    }
}

static void add_group(gtx_solid *solid, const gtx_asset *asset, uint32_t patch, uint32_t x,
                      uint32_t y)
{
    const gtx_patch *record = &asset->patches[patch];
    const uint32_t first = solid->element_count;
    for (uint32_t j = y; j < y + GTX_GROUP && j + 1 < record->rect[3]; ++j)
        for (uint32_t i = x; i < x + GTX_GROUP && i + 1 < record->rect[2]; ++i)
            add_cell(solid, asset, record, i, j);
    if (solid->element_count == first)
        return;
    if (solid->groups)
        solid->groups[solid->group_count] =
            (gtx_group){first, solid->element_count - first, patch};
    ++solid->group_count;
}

/* Counts elements and groups; fills them in, where there is memory. */
static void add_all(gtx_solid *solid, const gtx_asset *asset)
{
    solid->element_count = solid->group_count = 0;
    for (uint32_t p = 0; p < asset->info.patch_count; ++p)
        for (uint32_t y = 0; y + 1u < asset->patches[p].rect[3]; y += GTX_GROUP)
            for (uint32_t x = 0; x + 1u < asset->patches[p].rect[2]; x += GTX_GROUP)
                add_group(solid, asset, p, x, y);
}

/* ---- weights ---- */

/* An element, and the depths of what other patches show there. */
typedef struct overlap {
    const gtx_solid *solid;
    uint32_t own;
    double normal[3];
    uint32_t fields[8];
    double depths[8];
    uint32_t count;
    uint64_t steps;
} overlap;

static void meet(const gtx_crossing *crossing, void *user)
{
    overlap *o = user;
    const uint32_t field = crossing->field;
    const double depth = -gtx_trim_distance(
        gtx_field_trim(&o->solid->caster->fields[field], crossing->x, crossing->y));
    if (field == o->own || !(depth > 0))
        return;
    const gtx_hit hit = gtx_describe(o->solid->caster, crossing);
    double cosine = 0;
    for (int k = 0; k < 3; ++k)
        cosine += o->normal[k] * (double)hit.facet[k];
    if (!(cosine >= ALIKE)) /* also where numbers end */
        return;
    uint32_t i = 0;
    while (i < o->count && o->fields[i] != field)
        ++i;
    if (i < o->count) {
        o->depths[i] = fmax(o->depths[i], depth);
    } else if (i < sizeof o->fields / sizeof *o->fields) {
        o->fields[i] = field;
        o->depths[o->count++] = depth;
    }
}

/* A unit vector, or 0. */
static void find_normal(const gtx_element *e, double normal[3])
{
    double u[3], v[3], square = 0;
    for (int k = 0; k < 3; ++k) {
        u[k] = (double)e->corner[1][k] - (double)e->corner[0][k];
        v[k] = (double)e->corner[2][k] - (double)e->corner[0][k];
    }
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        normal[k] = u[a] * v[b] - u[b] * v[a];
        square += normal[k] * normal[k];
    }
    for (int k = 0; k < 3; ++k)
        normal[k] = square > 0 ? normal[k] / sqrt(square) : 0;
}

/* A partition of unity: at the point with these shares of the corners, each patch counts by its
 * depth there. */
static double weight_at(overlap *o, const gtx_element *e, const double share[3], double reach)
{
    gtx_line line = {.t_min = -1, .t_max = 1};
    double own = 0, sum = 0;
    for (int c = 0; c < 3; ++c) {
        own += share[c] * (double)e->depth[c];
        for (int k = 0; k < 3; ++k)
            line.origin[k] += share[c] * (double)e->corner[c][k];
    }
    for (int k = 0; k < 3; ++k)
        line.direction[k] = reach * o->normal[k];
    o->count = 0;
    o->steps += 1 + gtx_cast_each(o->solid->caster, &line, meet, o);
    for (uint32_t i = 0; i < o->count; ++i)
        sum += o->depths[i];
    return sum > 0 ? own / (own + sum) : 1;
}

/* The mean over the middles of SPLIT x SPLIT parts, near the outline, where weights change within a
 * cell; elsewhere one. */
static uint64_t weigh(const gtx_solid *solid, uint32_t patch, double reach, gtx_element *e)
{
    overlap o = {.solid = solid, .own = patch};
    const float least = fminf(e->depth[0], fminf(e->depth[1], e->depth[2]));
    const int n = least < NARROW ? SPLIT : 1;
    double sum = 0;
    find_normal(e, o.normal);
    if (o.normal[0] == 0 && o.normal[1] == 0 && o.normal[2] == 0)
        return 1;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * (n - i) - 1; ++j) { /* up and down in turn */
            const double third = j & 1 ? 2 / 3. : 1 / 3.;
            double share[3] = {(i + third) / n, (j / 2 + third) / n, 0};
            share[2] = 1 - share[0] - share[1];
            sum += weight_at(&o, e, share, reach);
        }
    e->weight = (float)(sum / (n * n));
    return o.steps;
}

/* One patch's elements are a job. */
typedef struct weighing {
    gtx_solid *solid;
    const gtx_asset *asset;
    const uint32_t *first;        /* group of each patch, and the end */
    const gtx_budget *budget;
    uint64_t *steps;              /* of each patch */
} weighing;

static void weigh_patch(uint32_t patch, void *data)
{
    const weighing *w = data;
    const gtx_patch *p = &w->asset->patches[patch];
    const double texel = fmax((double)p->extent_x / p->rect[2], (double)p->extent_y / p->rect[3]);
    const uint64_t left = w->budget->most - w->budget->done;
    uint64_t steps = 0;
    for (uint32_t g = w->first[patch]; g < w->first[patch + 1] && steps <= left; ++g) {
        const gtx_group *group = &w->solid->groups[g];
        for (uint32_t i = 0; i < group->count; ++i)
            steps += weigh(w->solid, patch, APART * texel,
                           &w->solid->elements[group->first + i]);
    }
    w->steps[patch] = steps;
}

static gtx_result weigh_all(gtx_solid *solid, const gtx_asset *asset, const gtx_jobs *jobs,
                            gtx_budget *budget, gtx_error *error)
{
    const uint32_t patches = asset->info.patch_count;
    uint32_t *first = gtx_alloc_array(&solid->allocator, (size_t)patches + 1, sizeof *first);
    uint64_t *steps = gtx_alloc_array(&solid->allocator, patches, sizeof *steps);
    gtx_result result = GTX_OK;
    if (!first || !steps)
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory for %u patches", patches);
    for (uint32_t g = 0; !result && g < solid->group_count; ++g)
        ++first[solid->groups[g].patch + 1];
    for (uint32_t p = 0; !result && p < patches; ++p)
        first[p + 1] += first[p];
    weighing w = {solid, asset, first, budget, steps};
    if (!result && !gtx_run_within(budget, jobs, patches, weigh_patch, &w, steps))
        result = gtx_fail_limit(error, GTX_LIMITED_WORK, "a solid", budget->done, budget->most);
    gtx_free_array(&solid->allocator, first, (size_t)patches + 1, sizeof *first);
    gtx_free_array(&solid->allocator, steps, patches, sizeof *steps);
    return result;
}

static void enclose(const gtx_solid *solid, const gtx_group *group, gtx_box *box)
{
    *box = gtx_box_empty;
    for (uint32_t i = 0; i < 3 * group->count; ++i) {
        const float *p = solid->elements[group->first + i / 3].corner[i % 3];
        for (int k = 0; k < 3; ++k) {
            box->low[k] = fminf(box->low[k], p[k]);
            box->high[k] = fmaxf(box->high[k], p[k]);
        }
    }
    gtx_box_widen(box);
}

gtx_result gtx_elements_build(gtx_solid *solid, const gtx_asset *asset, const gtx_jobs *jobs,
                              const gtx_limits *limits, gtx_budget *budget, gtx_error *error)
{
    const gtx_allocator *hooks = &solid->allocator;
    const uint64_t texels = gtx_solid_texels(asset);
    /* A cell has at most four triangles. */
    if (texels > UINT32_MAX / 8)
        return gtx_fail(error, GTX_ERROR_LIMIT, "a solid has too many texels");
    add_all(solid, asset);
    if (!solid->element_count)
        return gtx_fail(error, GTX_ERROR_EMPTY, "no cell of the asset shows");
    const uint32_t groups = solid->group_count;
    const uint64_t group_bytes = sizeof(gtx_group) + 2 * sizeof(gtx_node) + sizeof(gtx_box) +
                                 sizeof(uint32_t) + 2 * sizeof(gtx_solid_moments);
    gtx_result result = gtx_check_derived(texels, limits, "a solid",
                                          (uint64_t)solid->element_count * sizeof(gtx_element) +
                                              groups * group_bytes, error);
    if (result)
        return result;
    solid->element_room = solid->element_count;
    solid->elements = gtx_alloc_raw(hooks, solid->element_room, sizeof *solid->elements);
    solid->groups = gtx_alloc_raw(hooks, groups, sizeof *solid->groups);
    gtx_box *boxes = gtx_alloc_raw(hooks, groups, sizeof *boxes);
    if (!solid->elements || !solid->groups || !boxes)
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the triangles of a solid");
    if (!result) {
        add_all(solid, asset);
        for (uint32_t g = 0; g < groups; ++g)
            enclose(solid, &solid->groups[g], &boxes[g]);
        result = weigh_all(solid, asset, jobs, budget, error);
    }
    if (!result)
        result = gtx_hierarchy_build(boxes, groups, hooks, &solid->tree, error);
    gtx_free_array(hooks, boxes, groups, sizeof *boxes);
    return result;
}
