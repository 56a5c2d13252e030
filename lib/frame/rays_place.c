/* The hierarchies of rays in shaders: one over the blocks of each asset, one over the instances
 * above them. geotex_rays.glsl walks both. */
#include "frame/rays.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

/* Nodes as texels, those before them counted by `first`: low and what lies behind the subtree, high
 * and -1; or in a leaf low and `at[0]`, high and `at[1]`, of what `leaf` says of its box. */
static void put_nodes(const gtx_hierarchy *tree, size_t first, float (*out)[4],
                      void (*leaf)(uint32_t box, float at[2], const void *user), const void *user)
{
    for (uint32_t i = 0; i < tree->node_count; ++i) {
        const gtx_node *node = &tree->nodes[i];
        float(*texel)[4] = &out[GTX_RAY_NODE_TEXELS * (size_t)i];
        float at[2] = {(float)(first + GTX_RAY_NODE_TEXELS * (size_t)node->skip), -1};
        if (node->link & GTX_LEAF)
            leaf(node->link - GTX_LEAF, at, user);
        memcpy(texel[GTX_RAY_NODE_LOW], node->low, sizeof node->low);
        memcpy(texel[GTX_RAY_NODE_HIGH], node->high, sizeof node->high);
        texel[GTX_RAY_NODE_LOW][3] = at[0];
        texel[GTX_RAY_NODE_HIGH][3] = at[1];
    }
}

static void put_block(uint32_t box, float at[2], const void *user)
{
    memcpy(at, ((const float(*)[2])user)[box], 2 * sizeof *at);
}

size_t gtx_ray_fresh_texels(const gtx_ray_member *m)
{
    return m->end - m->nodes + GTX_RAY_FIELD_TEXELS * (size_t)m->patch_count;
}

static void free_fresh(gtx_ray_member *m, const gtx_allocator *hooks)
{
    gtx_free_array(hooks, m->fresh, gtx_ray_fresh_texels(m), sizeof *m->fresh);
    m->fresh = NULL;
}

/* The nodes and height fields of an asset whose boxes are not those of its nodes any more. */
static gtx_result derive_nodes(gtx_ray_member *m, const gtx_allocator *hooks, gtx_error *error)
{
    gtx_hierarchy tree;
    gtx_result result = gtx_hierarchy_build(m->boxes, m->block_count, hooks, &tree, error);
    if (result)
        return result;
    m->end = m->nodes + GTX_RAY_NODE_TEXELS * (size_t)tree.node_count;
    m->fresh = gtx_alloc_array(hooks, gtx_ray_fresh_texels(m), sizeof *m->fresh);
    m->box = gtx_box_empty;
    for (int k = 0; tree.node_count && k < 3; ++k) {
        m->box.low[k] = tree.nodes[0].low[k];
        m->box.high[k] = tree.nodes[0].high[k];
    }
    if (m->fresh) {
        put_nodes(&tree, m->nodes, m->fresh, put_block, m->blocks);
        memcpy(m->fresh + (m->end - m->nodes), m->fields, m->patch_count * sizeof *m->fields);
    }
    gtx_hierarchy_free(&tree, hooks);
    return m->fresh ? GTX_OK
                    : gtx_fail(error, GTX_ERROR_MEMORY, "no memory to cast into %u patches",
                               m->patch_count);
}

/* Boxes of the instances, and how far off the surfaces of all rays begin. */
static gtx_result find_places(gtx_rays *rays, const gtx_ray_instance *instances, uint32_t count,
                              double *offset, gtx_error *error)
{
    *offset = 0;
    for (uint32_t i = 0; i < count; ++i) {
        gtx_placement *place = &rays->places[i];
        if (instances[i].asset >= rays->member_count ||
            !gtx_placement_of(instances[i].transform, place))
            return gtx_fail(error, GTX_ERROR_ARGUMENT,
                            "instance %u has no asset, or a transform that is not affine or has "
                            "no inverse", i);
        const gtx_ray_member *m = &rays->members[instances[i].asset];
        rays->boxes[i] = gtx_placement_box(place, &m->box);
        *offset = fmax(*offset, m->offset * place->stretch);
    }
    return GTX_OK;
}

/* A leaf of the hierarchy over instances: where the instance's record lies. */
static void put_instance(uint32_t box, float at[2], const void *user)
{
    at[0] = 0;
    at[1] = (float)(*(const size_t *)user + GTX_RAY_INSTANCE_TEXELS * (size_t)box);
}

/* Fills the front of the nodes' texture; *texels becomes how many texels that takes. */
static gtx_result derive_front(gtx_rays *rays, const gtx_ray_instance *instances, uint32_t count,
                               size_t *texels, gtx_error *error)
{
    double offset;
    gtx_hierarchy tree;
    gtx_result result = find_places(rays, instances, count, &offset, error);
    if (!result)
        result = gtx_hierarchy_build(rays->boxes, count, &rays->allocator, &tree, error);
    if (result)
        return result;
    const size_t end = GTX_RAY_HEAD_TEXELS + GTX_RAY_NODE_TEXELS * (size_t)tree.node_count;
    put_nodes(&tree, GTX_RAY_HEAD_TEXELS, rays->front + GTX_RAY_HEAD_TEXELS, put_instance, &end);
    gtx_hierarchy_free(&tree, &rays->allocator);
    rays->front[0][0] = (float)end;
    rays->front[0][1] = (float)offset;
    for (uint32_t i = 0; i < count; ++i) {
        float(*record)[4] = rays->front + end + GTX_RAY_INSTANCE_TEXELS * (size_t)i;
        const gtx_ray_member *m = &rays->members[instances[i].asset];
        for (int r = 0; r < 3; ++r)
            for (int k = 0; k < 4; ++k)
                record[GTX_RAY_INSTANCE_TO_OBJECT + r][k] = (float)rays->places[i].object[r][k];
        record[GTX_RAY_INSTANCE_NODES][0] = (float)m->nodes;
        record[GTX_RAY_INSTANCE_NODES][1] = (float)m->end;
    }
    *texels = end + GTX_RAY_INSTANCE_TEXELS * (size_t)count;
    return GTX_OK;
}

gtx_result gtx_rays_plan(gtx_rays *rays, const gtx_ray_instance *instances, uint32_t count,
                         size_t *texels, gtx_error *error)
{
    gtx_result result = GTX_OK;
    for (uint32_t i = 0; !result && i < rays->member_count; ++i)
        if (rays->members[i].edited)
            result = derive_nodes(&rays->members[i], &rays->allocator, error);
    return result ? result : derive_front(rays, instances, count, texels, error);
}

void gtx_rays_planned(gtx_rays *rays, bool sent)
{
    for (uint32_t i = 0; i < rays->member_count; ++i) {
        gtx_ray_member *m = &rays->members[i];
        m->edited = m->edited && !sent;
        free_fresh(m, &rays->allocator);
    }
}
