/* Rays in shaders: the patches of a set of assets in textures of their own, with a hierarchy over
 * blocks of their cells, and one over the instances above it. geotex_rays.glsl reads them. */
#include "render/renderer.h"

#include "base/alloc.h"
#include "base/error.h"
#include "derive/frame.h"
#include "derive/placement.h"

#include <math.h>
#include <string.h>

/* Texels of a row of any of the textures, rows of a layer, and texels that a sheet's first is a
 * multiple of: such numbers are exact as floats. */
enum { ROW = 1024, LAYER_ROWS = 1024, SHEET_ALIGN = 256 };
/* Texels of a node, of an instance's record and of a sheet's. */
enum { NODE = 2, INSTANCE = 4, SHEET = 4 };
/* What floats count to, and what ints of shaders do. */
static const size_t MOST_NODES = 1u << 24, MOST_TEXELS = 1u << 30;

enum { TEXTURE_NODES, TEXTURE_CELLS, TEXTURE_TRIM, TEXTURES };

typedef struct member {
    size_t nodes, end;        /* texels of its hierarchy; its sheets follow */
    gtx_box box;
    double offset;            /* gtx_ray_offset */
} member;

struct gtx_rays {
    gtx_allocator allocator;
    member *members;
    uint32_t asset_count, member_count, max_instances;
    size_t moving;            /* texels at the front of the nodes, of whole rows, for instances */
    gl_uint textures[TEXTURES];
    float (*front)[4];        /* scratch for them */
    gtx_box *boxes;
    gtx_placement *places;
};

/* What is built before it is uploaded. */
typedef struct staging {
    uint32_t bits;
    size_t texels, texel_capacity, node_count, node_capacity;
    uint8_t *cells, *trim;
    float (*nodes)[4];
    /* Of the asset at hand. */
    gtx_box *boxes;
    float (*blocks)[2];       /* what the leaves of their nodes say: block in the sheet, sheet */
    size_t box_count;
} staging;

static size_t align(size_t n, size_t to)
{
    return (n + to - 1) / to * to;
}

static size_t blocks_of(const gtx_patch *patch)
{
    return (size_t)gtx_blocks_of(patch->rect[2] - 1u) * gtx_blocks_of(patch->rect[3] - 1u);
}

/* Counts what all assets take, and takes the memory. A hierarchy has two nodes a block at most. */
static gtx_result reserve(gtx_rays *rays, const gtx_rays_desc *desc, staging *s, gtx_error *error)
{
    const gtx_allocator *hooks = &rays->allocator;
    rays->moving = align(1 + (2 * NODE + INSTANCE) * (size_t)rays->max_instances, ROW);
    s->node_capacity = rays->moving;
    s->bits = 8;
    for (uint32_t a = 0; a < desc->asset_count; ++a) {
        const gtx_asset *asset = desc->assets[a];
        size_t blocks = 0;
        s->bits = asset->info.height_bits > s->bits ? asset->info.height_bits : s->bits;
        for (uint32_t i = 0; i < asset->info.patch_count; ++i) {
            const gtx_patch *p = &asset->patches[i];
            s->texel_capacity += align((size_t)p->rect[2] * p->rect[3], SHEET_ALIGN);
            blocks += blocks_of(p);
        }
        s->box_count = blocks > s->box_count ? blocks : s->box_count;
        s->node_capacity += 2 * NODE * blocks + SHEET * (size_t)asset->info.patch_count;
        if (s->node_capacity > MOST_NODES || s->texel_capacity > MOST_TEXELS)
            return gtx_fail(error, GTX_ERROR_LIMIT, "the assets are too large to cast into");
    }
    s->texel_capacity = align(s->texel_capacity, ROW);
    s->node_capacity = align(s->node_capacity, ROW);
    if (s->texel_capacity > (size_t)ROW * LAYER_ROWS)
        s->texel_capacity = align(s->texel_capacity, (size_t)ROW * LAYER_ROWS);
    s->cells = gtx_alloc_array(hooks, s->texel_capacity, s->bits / 2);
    s->trim = gtx_alloc_array(hooks, s->texel_capacity, 1);
    s->nodes = gtx_alloc_array(hooks, s->node_capacity, sizeof *s->nodes);
    s->boxes = gtx_alloc_array(hooks, s->box_count, sizeof *s->boxes);
    s->blocks = gtx_alloc_array(hooks, s->box_count, sizeof *s->blocks);
    rays->members = gtx_alloc_array(hooks, desc->asset_count, sizeof *rays->members);
    rays->front = gtx_alloc_array(hooks, rays->moving, sizeof *rays->front);
    rays->boxes = gtx_alloc_array(hooks, rays->max_instances, sizeof *rays->boxes);
    rays->places = gtx_alloc_array(hooks, rays->max_instances, sizeof *rays->places);
    const bool instances = !rays->max_instances || (rays->boxes && rays->places);
    if (!s->cells || !s->trim || !s->nodes || !s->boxes || !s->blocks || !rays->members ||
        !rays->front || !instances)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to cast into %u assets",
                        desc->asset_count);
    return GTX_OK;
}

static void free_staging(staging *s, const gtx_allocator *hooks)
{
    gtx_free_array(hooks, s->cells, s->texel_capacity, s->bits / 2);
    gtx_free_array(hooks, s->trim, s->texel_capacity, 1);
    gtx_free_array(hooks, s->nodes, s->node_capacity, sizeof *s->nodes);
    gtx_free_array(hooks, s->boxes, s->box_count, sizeof *s->boxes);
    gtx_free_array(hooks, s->blocks, s->box_count, sizeof *s->blocks);
}

/* Nodes as texels from `first` on: low and what lies behind the subtree, high and -1; or in a leaf
 * low and `at[0]`, high and `at[1]`, of what `leaf` says of its box. */
static void put_nodes(const gtx_hierarchy *tree, size_t first, float (*out)[4],
                      void (*leaf)(uint32_t box, float at[2], const void *user), const void *user)
{
    for (uint32_t i = 0; i < tree->node_count; ++i) {
        const gtx_node *node = &tree->nodes[i];
        float(*texel)[4] = &out[NODE * (size_t)i];
        float at[2] = {(float)(first + NODE * (size_t)node->skip), -1};
        if (node->link & GTX_LEAF)
            leaf(node->link - GTX_LEAF, at, user);
        memcpy(texel[0], node->low, sizeof node->low);
        memcpy(texel[1], node->high, sizeof node->high);
        texel[0][3] = at[0];
        texel[1][3] = at[1];
    }
}

static void put_block(uint32_t box, float at[2], const void *user)
{
    memcpy(at, ((const float(*)[2])user)[box], 2 * sizeof *at);
}

/* The patch's cells, outline and record, and the boxes of its blocks. */
static gtx_result put_patch(const gtx_asset *asset, uint32_t index, const gtx_allocator *hooks,
                            staging *s, float (*record)[4], size_t first, gtx_error *error)
{
    const gtx_patch *p = &asset->patches[index];
    const gtx_patch_frame frame = gtx_patch_frame_of(p, asset->info.height_bits);
    gtx_grid grid;
    gtx_result result = gtx_grid_build(asset, index, 0, hooks, &grid, error);
    if (result)
        return result;
    gtx_grid_cells(&grid, s->bits, p->rect[2], s->cells + s->texels * (s->bits / 2));
    gtx_grid_boxes(asset, index, &grid, s->boxes + first);
    gtx_grid_free(&grid, hooks);
    const uint32_t wide = gtx_blocks_of(p->rect[2] - 1u);
    for (uint32_t b = 0; b < blocks_of(p); ++b) {
        s->blocks[first + b][0] = (float)(b % wide + (b / wide << 11));
        s->blocks[first + b][1] = (float)index;
    }
    for (uint32_t y = 0; y < p->rect[3]; ++y) {
        const size_t row = (size_t)p->page * asset->info.page_height + p->rect[1] + y;
        memcpy(s->trim + s->texels + (size_t)y * p->rect[2],
               asset->trim + row * asset->info.page_width + p->rect[0], p->rect[2]);
    }
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 4; ++k)
            record[r][k] = (float)frame.to_grid[r][k];
    record[3][0] = p->rect[2];
    record[3][1] = p->rect[3];
    record[3][2] = (float)(s->texels / SHEET_ALIGN);
    record[3][3] = p->flags & GTX_PATCH_TWO_SIDED ? 1 : 0;
    s->texels += align((size_t)p->rect[2] * p->rect[3], SHEET_ALIGN);
    return GTX_OK;
}

static gtx_result put_asset(gtx_rays *rays, const gtx_asset *asset, staging *s, gtx_error *error)
{
    const gtx_allocator *hooks = &rays->allocator;
    const uint32_t patches = asset->info.patch_count;
    float(*records)[4] = gtx_alloc_array(hooks, SHEET * (size_t)patches, sizeof *records);
    size_t boxes = 0;
    gtx_result result = GTX_OK;
    if (!records)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to cast into %u patches", patches);
    for (uint32_t i = 0; !result && i < patches; ++i) {
        result = put_patch(asset, i, hooks, s, records + SHEET * (size_t)i, boxes, error);
        boxes += blocks_of(&asset->patches[i]);
    }
    gtx_hierarchy tree = {0};
    if (!result)
        result = gtx_hierarchy_build(s->boxes, (uint32_t)boxes, hooks, &tree, error);
    if (!result) {
        member *m = &rays->members[rays->member_count++];
        m->nodes = s->node_count;
        m->end = s->node_count + NODE * (size_t)tree.node_count;
        m->offset = gtx_ray_offset(asset);
        m->box = gtx_box_empty;
        for (int k = 0; tree.node_count && k < 3; ++k) {
            m->box.low[k] = tree.nodes[0].low[k];
            m->box.high[k] = tree.nodes[0].high[k];
        }
        put_nodes(&tree, m->nodes, s->nodes + m->nodes, put_block, s->blocks);
        memcpy(s->nodes + m->end, records, SHEET * (size_t)patches * sizeof *records);
        s->node_count = m->end + SHEET * (size_t)patches;
    }
    gtx_hierarchy_free(&tree, hooks);
    gtx_free_array(hooks, records, SHEET * (size_t)patches, sizeof *records);
    return result;
}

/* Leaves units and unpacking as gtx_model_upload does. */
static void leave(const gtx_gl *gl)
{
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
}

static gl_uint texture_of(const gtx_gl *gl, gl_enum target, gl_enum inner, size_t texels,
                          gl_enum format, gl_enum type, const void *data, const char *label)
{
    const size_t layer = (size_t)ROW * LAYER_ROWS, layers = texels > layer ? texels / layer : 1;
    const gl_size rows = (gl_size)(texels / layers / ROW);
    gl_uint name;
    gl->GenTextures(1, &name);
    gl->BindTexture(target, name);
    gtx_gl_label(gl, GL_TEXTURE, name, label);
    if (target == GL_TEXTURE_2D)
        gl->TexImage2D(target, 0, (gl_int)inner, ROW, (gl_size)(texels / ROW), 0, format, type,
                       data);
    else
        gl->TexImage3D(target, 0, (gl_int)inner, ROW, rows, (gl_size)layers, 0, format, type, data);
    gl->TexParameteri(target, GL_TEXTURE_BASE_LEVEL, 0);
    gl->TexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
    gl->TexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return name;
}

static gtx_result upload(const gtx_gl *gl, gtx_rays *rays, const staging *s, gtx_error *error)
{
    gl_int side = 0, layers = 0;
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
    gl->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    if (s->node_capacity / ROW > (size_t)side ||
        s->texel_capacity / ROW / LAYER_ROWS > (size_t)layers)
        return gtx_fail(error, GTX_ERROR_LIMIT, "the assets are too large for this GPU's textures");
    const bool fine = s->bits == 16;
    gl->ActiveTexture(GL_TEXTURE0);
    gtx_default_unpacking(gl);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    rays->textures[TEXTURE_NODES] =
        texture_of(gl, GL_TEXTURE_2D, GL_RGBA32F, s->node_capacity, GL_RGBA, GL_FLOAT, s->nodes,
                   "geotex ray nodes");
    rays->textures[TEXTURE_CELLS] =
        texture_of(gl, GL_TEXTURE_2D_ARRAY, fine ? GL_RGBA16UI : GL_RGBA8UI, s->texel_capacity,
                   GL_RGBA_INTEGER, fine ? GL_UNSIGNED_SHORT : GL_UNSIGNED_BYTE, s->cells,
                   "geotex ray cells");
    rays->textures[TEXTURE_TRIM] =
        texture_of(gl, GL_TEXTURE_2D_ARRAY, GL_R8, s->texel_capacity, GL_RED, GL_UNSIGNED_BYTE,
                   s->trim, "geotex ray trim");
    leave(gl);
    return gtx_check_gl_memory(gl, error);
}

gtx_result gtx_rays_create(gtx_renderer *renderer, const gtx_rays_desc *desc, gtx_rays **out,
                           gtx_error *error)
{
    if (!renderer || !desc || !out || !desc->asset_count || !desc->assets ||
        desc->max_instances > GTX_MAX_PATCHES)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "rays need a renderer, assets, and at most %u instances", GTX_MAX_PATCHES);
    *out = NULL;
    gtx_result result =
        gtx_check_reserved(desc->reserved, sizeof desc->reserved / sizeof *desc->reserved, error);
    for (uint32_t i = 0; !result && i < desc->asset_count; ++i)
        if (!desc->assets[i])
            result = gtx_fail(error, GTX_ERROR_ARGUMENT, "asset %u is missing", i);
    if (result)
        return result;
    const gtx_allocator *hooks = &renderer->allocator;
    gtx_rays *rays = gtx_alloc_array(hooks, 1, sizeof *rays);
    if (!rays)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for rays");
    rays->allocator = *hooks;
    rays->asset_count = desc->asset_count;
    rays->max_instances = desc->max_instances;
    staging s = {0};
    result = reserve(rays, desc, &s, error);
    s.node_count = rays->moving;
    for (uint32_t i = 0; !result && i < desc->asset_count; ++i)
        result = put_asset(rays, desc->assets[i], &s, error);
    if (!result)
        result = upload(&renderer->gl, rays, &s, error);
    free_staging(&s, hooks);
    if (!result)
        result = gtx_rays_place(renderer, rays, NULL, 0, error);
    if (result)
        gtx_rays_destroy(renderer, rays);
    else
        *out = rays;
    return result;
}

void gtx_rays_destroy(gtx_renderer *renderer, gtx_rays *rays)
{
    if (!rays)
        return;
    const gtx_allocator hooks = rays->allocator;
    renderer->gl.DeleteTextures(TEXTURES, rays->textures);
    gtx_free_array(&hooks, rays->members, rays->asset_count, sizeof *rays->members);
    gtx_free_array(&hooks, rays->front, rays->moving, sizeof *rays->front);
    gtx_free_array(&hooks, rays->boxes, rays->max_instances, sizeof *rays->boxes);
    gtx_free_array(&hooks, rays->places, rays->max_instances, sizeof *rays->places);
    gtx_free_array(&hooks, rays, 1, sizeof *rays);
}

/* A leaf of the hierarchy over instances: where the instance's record lies. */
static void put_instance(uint32_t box, float at[2], const void *user)
{
    at[0] = 0;
    at[1] = (float)(*(const size_t *)user + INSTANCE * (size_t)box);
}

gtx_result gtx_rays_place(gtx_renderer *renderer, gtx_rays *rays,
                          const gtx_ray_instance *instances, uint32_t count, gtx_error *error)
{
    if (!renderer || !rays || (count && !instances) || count > rays->max_instances)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "placing needs a renderer, rays and as many instances as they allow");
    double offset = 0;
    for (uint32_t i = 0; i < count; ++i) {
        gtx_placement *place = &rays->places[i];
        if (instances[i].asset >= rays->member_count ||
            !gtx_placement_of(instances[i].transform, place))
            return gtx_fail(error, GTX_ERROR_ARGUMENT,
                            "instance %u has no asset, or a transform that is not affine or has "
                            "no inverse", i);
        const member *m = &rays->members[instances[i].asset];
        rays->boxes[i] = gtx_placement_box(place, &m->box);
        offset = fmax(offset, m->offset * place->stretch);
    }
    gtx_hierarchy tree;
    gtx_result result = gtx_hierarchy_build(rays->boxes, count, &rays->allocator, &tree, error);
    if (result)
        return result;
    const size_t end = 1 + NODE * (size_t)tree.node_count;
    put_nodes(&tree, 1, rays->front + 1, put_instance, &end);
    gtx_hierarchy_free(&tree, &rays->allocator);
    rays->front[0][0] = (float)end;
    rays->front[0][1] = (float)offset;
    for (uint32_t i = 0; i < count; ++i) {
        float(*record)[4] = rays->front + end + INSTANCE * (size_t)i;
        const member *m = &rays->members[instances[i].asset];
        for (int r = 0; r < 3; ++r)
            for (int k = 0; k < 4; ++k)
                record[r][k] = (float)rays->places[i].object[r][k];
        record[3][0] = (float)m->nodes;
        record[3][1] = (float)m->end;
    }
    const gtx_gl *gl = &renderer->gl;
    gl->ActiveTexture(GL_TEXTURE0);
    gtx_default_unpacking(gl);
    gl->BindTexture(GL_TEXTURE_2D, rays->textures[TEXTURE_NODES]);
    gl->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, ROW, (gl_size)(rays->moving / ROW), GL_RGBA,
                      GL_FLOAT, rays->front);
    leave(gl);
    return GTX_OK;
}

void gtx_rays_locate(const gtx_gl *gl, gl_uint program)
{
    static const char *const samplers[TEXTURES] = {"gtx_ray_nodes", "gtx_ray_cells",
                                                   "gtx_ray_trim"};
    for (gl_int i = 0; i < TEXTURES; ++i)
        gl->Uniform1i(gl->GetUniformLocation(program, samplers[i]), UNIT_RAYS + i);
}

void gtx_rays_bind(gtx_renderer *renderer, const gtx_rays *rays, uint32_t program)
{
    const gtx_gl *gl = &renderer->gl;
    for (gl_uint i = 0; i < TEXTURES; ++i) {
        gl->ActiveTexture(GL_TEXTURE0 + UNIT_RAYS + i);
        gl->BindSampler(UNIT_RAYS + i, 0);
        gl->BindTexture(i == TEXTURE_NODES ? GL_TEXTURE_2D : GL_TEXTURE_2D_ARRAY,
                        rays ? rays->textures[i] : 0);
    }
    gl->ActiveTexture(GL_TEXTURE0);
    if (program) {
        gl->UseProgram(program);
        gtx_rays_locate(gl, program);
        gl->UseProgram(0);
    }
}
