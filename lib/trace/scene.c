/* Scenes: instances of casters, rays among them, and the light that reaches points. */
#include "trace/slabs.h"

#include "base/alloc.h"
#include "base/error.h"
#include "derive/placement.h"

typedef struct member {
    const gtx_caster *caster;
    gtx_placement place;
} member;

struct gtx_scene {
    gtx_allocator allocator;
    member *members;
    uint32_t count;
    float offset;
    gtx_hierarchy tree;
};

static gtx_box box_of(const member *m)
{
    const gtx_hierarchy *tree = &m->caster->tree;
    gtx_box box = gtx_box_empty;
    for (int k = 0; tree->node_count && k < 3; ++k) {
        box.low[k] = tree->nodes[0].low[k];
        box.high[k] = tree->nodes[0].high[k];
    }
    return gtx_placement_box(&m->place, &box);
}

static gtx_result fill_scene(gtx_scene *scene, const gtx_scene_instance *instances,
                             gtx_error *error)
{
    const gtx_allocator *hooks = &scene->allocator;
    gtx_box *boxes = gtx_alloc_array(hooks, scene->count, sizeof *boxes);
    scene->members = gtx_alloc_array(hooks, scene->count, sizeof *scene->members);
    gtx_result result = GTX_OK;
    if (scene->count && (!boxes || !scene->members))
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory for %u instances", scene->count);
    for (uint32_t i = 0; !result && i < scene->count; ++i) {
        member *m = &scene->members[i];
        m->caster = instances[i].caster;
        if (!m->caster || !gtx_placement_of(instances[i].transform, &m->place)) {
            result = gtx_fail(error, GTX_ERROR_ARGUMENT,
                              "instance %u has no caster, or a transform that is not affine or "
                              "has no inverse", i);
            break;
        }
        boxes[i] = box_of(m);
        scene->offset =
            fmaxf(scene->offset, (float)(m->caster->ray_offset * m->place.stretch));
    }
    if (!result)
        result = gtx_hierarchy_build(boxes, scene->count, hooks, &scene->tree, error);
    gtx_free_array(hooks, boxes, scene->count, sizeof *boxes);
    return result;
}

gtx_result gtx_scene_create(const gtx_scene_instance *instances, uint32_t count,
                            const gtx_allocator *allocator, gtx_scene **out, gtx_error *error)
{
    if (!out || (count && !instances))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a scene needs instances");
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    gtx_scene *scene = gtx_alloc_array(&hooks, 1, sizeof *scene);
    if (!scene)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a scene");
    scene->allocator = hooks;
    scene->count = count;
    gtx_result result = fill_scene(scene, instances, error);
    if (result)
        gtx_scene_destroy(scene);
    else
        *out = scene;
    return result;
}

void gtx_scene_destroy(gtx_scene *scene)
{
    if (!scene)
        return;
    const gtx_allocator hooks = scene->allocator;
    gtx_free_array(&hooks, scene->members, scene->count, sizeof *scene->members);
    gtx_hierarchy_free(&scene->tree, &hooks);
    gtx_free_array(&hooks, scene, 1, sizeof *scene);
}

float gtx_scene_offset(const gtx_scene *scene)
{
    return scene ? scene->offset : 0;
}

static gtx_line to_object(const gtx_placement *place, const gtx_line *ray, double t_max)
{
    gtx_line line = {.t_min = ray->t_min, .t_max = t_max};
    for (int r = 0; r < 3; ++r) {
        const double *row = place->object[r], *o = ray->origin, *d = ray->direction;
        line.origin[r] = row[0] * o[0] + row[1] * o[1] + row[2] * o[2] + row[3];
        line.direction[r] = row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
    }
    return line;
}

/* The nearest crossing, or any; `*which` gets its instance, or UINT32_MAX. Of instances that are
 * crossed at the same time the first counts. */
static gtx_crossing cast(const gtx_scene *scene, const gtx_line *ray, uint32_t flags,
                         uint32_t *which)
{
    const gtx_node *nodes = scene->tree.nodes, *leaf;
    const gtx_slabs s = gtx_slabs_of(ray);
    gtx_crossing best = {.t = ray->t_max, .field = UINT32_MAX};
    float limit = gtx_slabs_limit(&s, best.t);
    gtx_subtree stack[GTX_HIERARCHY_DEPTH];
    gtx_subtree at = {0, scene->tree.node_count ? gtx_enter(nodes, &s, limit) : INFINITY};
    int size = 0;
    *which = UINT32_MAX;
    while ((leaf = gtx_next_leaf(nodes, &s, limit, &at, stack, &size))) {
        const uint32_t index = leaf->link - GTX_LEAF;
        const member *m = &scene->members[index];
        const gtx_line line = to_object(&m->place, ray, best.t);
        const gtx_crossing found = gtx_cast_line(m->caster, &line, flags);
        if (found.field == UINT32_MAX || !(found.t < best.t || index < *which))
            continue;
        best = found;
        *which = index;
        if (flags & GTX_RAY_ANY)
            break;
        limit = gtx_slabs_limit(&s, best.t);
    }
    return best;
}

/* Normals go by the transposed inverse. */
static void to_world(const gtx_placement *place, float n[3])
{
    double out[3], length = 0;
    for (int k = 0; k < 3; ++k) {
        out[k] = place->object[0][k] * n[0] + place->object[1][k] * n[1] +
                 place->object[2][k] * n[2];
        length += out[k] * out[k];
    }
    for (int k = 0; k < 3; ++k)
        n[k] = (float)(out[k] / sqrt(length));
}

gtx_result gtx_scene_raycast(const gtx_scene *scene, const gtx_ray *rays, gtx_hit *hits,
                             uint32_t *which, size_t count, uint32_t flags)
{
    if (!scene || (count && (!rays || !hits)) || flags & ~(uint32_t)GTX_RAY_FLAGS)
        return GTX_ERROR_ARGUMENT;
    for (size_t i = 0; i < count; ++i) {
        gtx_line ray;
        uint32_t index = UINT32_MAX;
        hits[i] = (gtx_hit){.t = INFINITY, .patch = UINT32_MAX};
        if (gtx_read_ray(&rays[i], &ray)) {
            const gtx_crossing crossing = cast(scene, &ray, flags, &index);
            if (index != UINT32_MAX) {
                const member *m = &scene->members[index];
                hits[i] = gtx_describe(m->caster, &crossing);
                to_world(&m->place, hits[i].normal);
                to_world(&m->place, hits[i].facet);
            }
        }
        if (which)
            which[i] = index;
    }
    return GTX_OK;
}

/* Two directions square to a unit vector and to each other (Duff et al., "Building an Orthonormal
 * Basis, Revisited", JCGT 2017). */
static void basis(const double n[3], double x[3], double y[3])
{
    const double sign = n[2] < 0 ? -1 : 1, a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    x[0] = 1 + sign * n[0] * n[0] * a;
    x[1] = sign * b;
    x[2] = -sign * n[0];
    y[0] = b;
    y[1] = sign + n[1] * n[1] * a;
    y[2] = -n[1];
}

/* Point `i` of a spiral that covers the unit disc evenly (Vogel 1979). */
static void disc(uint32_t i, uint32_t rays, double turn, double out[2])
{
    const double r = sqrt((i + 0.5) / rays), angle = 6.283185307179586 * turn + 2.399963 * i;
    out[0] = r * cos(angle);
    out[1] = r * sin(angle);
}

/* A light made ready: the direction to the middle of its disc, or none for the sky. */
typedef struct light {
    bool sky;
    double direction[3], spread, reach, offset;
    uint32_t rays;
} light;

static float share(const gtx_scene *scene, const light *l, const gtx_lit_point *point)
{
    double n[3], axis[3], x[3], y[3];
    gtx_line ray = {.t_max = l->reach};
    for (int k = 0; k < 3; ++k) {
        n[k] = point->normal[k];
        axis[k] = l->sky ? n[k] : l->direction[k];
        ray.origin[k] = point->position[k] + l->offset * n[k];
    }
    basis(axis, x, y);
    uint32_t lit = 0, which;
    for (uint32_t i = 0; i < l->rays; ++i) {
        double at[2], up = 1, above = 0;
        disc(i, l->rays, point->turn, at);
        if (l->sky)
            up = sqrt(fmax(1 - at[0] * at[0] - at[1] * at[1], 0));
        for (int k = 0; k < 3; ++k) {
            ray.direction[k] = l->spread * (at[0] * x[k] + at[1] * y[k]) + up * axis[k];
            above += ray.direction[k] * n[k];
        }
        if (above > 0) {
            cast(scene, &ray, GTX_RAY_ANY, &which);
            lit += which == UINT32_MAX;
        }
    }
    return (float)lit / (float)l->rays;
}

static bool all_finite(const gtx_lit_point *point)
{
    bool finite = isfinite(point->turn);
    for (int k = 0; k < 3; ++k)
        finite = finite && isfinite(point->position[k]) && isfinite(point->normal[k]);
    return finite;
}

gtx_result gtx_scene_light(const gtx_scene *scene, const gtx_light_desc *desc,
                           const gtx_lit_point *points, float *shares, size_t count)
{
    if (!scene || !desc || (count && (!points || !shares)) || !(desc->spread >= 0) ||
        !(desc->reach >= 0) || !(desc->offset >= 0) || isinf(desc->spread) || isinf(desc->offset))
        return GTX_ERROR_ARGUMENT;
    for (size_t i = 0; i < sizeof desc->reserved / sizeof *desc->reserved; ++i)
        if (desc->reserved[i])
            return GTX_ERROR_NOT_ZEROED;
    light l = {.spread = desc->spread, .reach = desc->reach > 0 ? desc->reach : INFINITY,
               .offset = desc->offset > 0 ? desc->offset : scene->offset,
               .rays = desc->rays ? desc->rays : 1};
    double length = 0;
    for (int k = 0; k < 3; ++k)
        length += (double)desc->direction[k] * desc->direction[k];
    l.sky = length == 0;
    if (!isfinite(length))
        return GTX_ERROR_ARGUMENT;
    if (l.sky)
        l.spread = 1;
    for (int k = 0; !l.sky && k < 3; ++k)
        l.direction[k] = desc->direction[k] / sqrt(length);
    if (l.rays == 1 && !l.sky) /* the middle of the disc */
        l.spread = 0;
    for (size_t i = 0; i < count; ++i)
        shares[i] = all_finite(&points[i]) ? share(scene, &l, &points[i]) : 0;
    return GTX_OK;
}
