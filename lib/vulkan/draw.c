/* Drawing: a frame's draws become commands. */
#include "vulkan/device.h"

#include "base/error.h"

#include <string.h>

/* One gtx_vk_draw, and what is bound so far. */
typedef struct recording {
    gtx_vk *vk;
    VkCommandBuffer commands;
    const gtx_vk_instance *placed;
    const gtx_vk_shading *shading; /* or NULL */
    gtx_vk_key key;
    VkPipeline pipeline;
    /* What the set names: a model's textures, blocks of constants, a stream. */
    VkDescriptorSet set;
    const gtx_vk_model *model;
    VkBuffer constants;
    gtx_vk_piece instances, grid[2]; /* grid: vertices, indices */
    gtx_result result;
    gtx_error *error;
} recording;

/* What one draw's constants are, and its stream; those of no tiles are of no matter. */
typedef struct pieces {
    gtx_vk_piece constants, tile;
    VkBufferView stream;
} pieces;

/* Images at bindings that follow one another. */
static uint32_t write_images(VkDescriptorSet set, uint32_t binding, uint32_t count,
                             const VkDescriptorImageInfo *images, VkWriteDescriptorSet *out)
{
    for (uint32_t i = 0; i < count; ++i)
        out[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstSet = set,
            .dstBinding = binding + i, .descriptorCount = 1,
            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, .pImageInfo = &images[i]};
    return count;
}

static gtx_result make_set(recording *r, const gtx_vk_model *model, const pieces *p)
{
    enum { BUFFERS = 3 };
    const gtx_vk *vk = r->vk;
    VkDescriptorImageInfo images[GTX_SLOT_COUNT], rays[GTX_RAYS_TEXTURES];
    VkWriteDescriptorSet writes[GTX_SLOT_COUNT + BUFFERS + GTX_RAYS_TEXTURES];
    uint32_t count = 0;
    const VkDescriptorBufferInfo buffers[] = {{p->constants.buffer, 0, sizeof(gtx_constants)},
                                              {0},
                                              {p->tile.buffer, 0, sizeof(gtx_tile_constants)}};
    gtx_result result =
        gtx_vk_take_set(r->vk, r->shading ? vk->own_set_layout : vk->set_layout, &r->set,
                        r->error);
    if (result)
        return result;
    for (uint32_t s = 0; s < GTX_SLOT_COUNT; ++s)
        images[s] = gtx_vk_model_image(vk, model, s);
    count += write_images(r->set, 0, GTX_SLOT_COUNT, images, writes);
    for (uint32_t b = 0; b < BUFFERS; ++b)
        writes[count++] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstSet = r->set,
            .dstBinding = GTX_VK_CONSTANTS + b, .descriptorCount = 1,
            .descriptorType = b == 1 ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                                     : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC,
            .pBufferInfo = &buffers[b], .pTexelBufferView = &p->stream};
    if (r->shading) {
        if (r->shading->rays)
            gtx_vk_rays_images(vk, r->shading->rays, rays);
        else
            gtx_vk_model_no_rays(vk, model, rays);
        count += write_images(r->set, GTX_RAYS_BINDING, GTX_RAYS_TEXTURES, rays, writes + count);
    }
    vk->api.UpdateDescriptorSets(vk->device, count, writes, 0, NULL);
    r->model = model;
    r->constants = p->constants.buffer;
    return GTX_OK;
}

static gtx_result write_pieces(recording *r, const gtx_frame_draw *d, pieces *p)
{
    const gtx_tile_draw *t = d->tiles;
    gtx_result result =
        gtx_vk_write(r->vk, d->constants, sizeof *d->constants, &p->constants, r->error);
    gtx_vk_piece stream = {0};
    p->tile = p->constants;
    p->stream = r->vk->no_stream;
    if (t && !result)
        result = gtx_vk_write_all(r->vk, t->parts, t->part_bytes, GTX_TILE_PARTS, &stream,
                                  r->error);
    if (t && !result)
        result = gtx_vk_view(r->vk, &stream, &p->stream, r->error);
    if (t && !result)
        result = gtx_vk_write(r->vk, t->constants, sizeof *t->constants, &p->tile, r->error);
    return result;
}

/* Each stream has a set of its own. */
static gtx_result bind_set(recording *r, const gtx_frame_draw *d)
{
    const gtx_vk_model *model = r->placed[d->first_instance].model;
    pieces p;
    gtx_result result = write_pieces(r, d, &p);
    const bool same = !d->tiles && model == r->model && p.constants.buffer == r->constants;
    if (!result && !same)
        result = make_set(r, model, &p);
    /* Of no tiles the block's first bytes will do. */
    const uint32_t offsets[2] = {(uint32_t)p.constants.offset,
                                 d->tiles ? (uint32_t)p.tile.offset : 0};
    if (!result)
        r->vk->api.CmdBindDescriptorSets(r->commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                         r->shading ? r->shading->layout : r->vk->layout, 0, 1,
                                         &r->set, 2, offsets);
    return result;
}

static gtx_result bind_pipeline(recording *r, const gtx_frame_draw *d)
{
    VkPipeline pipeline = VK_NULL_HANDLE;
    r->key.pipeline = d->pipeline;
    r->key.cull = d->cull;
    r->key.vertex_size = (uint16_t)d->vertex_size;
    r->key.clockwise = d->clockwise == r->key.target.y_up; /* seen in a picture with y down */
    gtx_result result = gtx_vk_pipeline_of(r->vk, &r->key, r->shading, &pipeline, r->error);
    if (!result && pipeline != r->pipeline)
        r->vk->api.CmdBindPipeline(r->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    r->pipeline = pipeline;
    return result;
}

/* The model's buffers, or of grids and tiles what the draw brings along. */
static gtx_result bind_buffers(recording *r, const gtx_frame_draw *d)
{
    const gtx_vk_model *model = r->placed[d->first_instance].model;
    gtx_vk_piece from[2];
    gtx_result result = GTX_OK;
    if (d->vertices >= GTX_BUFFER_GRID_VERTICES) {
        if (d->vertex_data)
            result = gtx_vk_write(r->vk, d->vertex_data, d->vertex_bytes, &r->grid[0], r->error);
        if (!result && d->index_size)
            result = gtx_vk_write(r->vk, d->index_data, d->index_bytes, &r->grid[1], r->error);
        memcpy(from, r->grid, sizeof from);
    } else {
        from[0] = (gtx_vk_piece){model->buffer.buffer, model->offsets[d->vertices], 0};
        from[1] = (gtx_vk_piece){model->buffer.buffer, model->offsets[d->indices], 0};
    }
    if (result)
        return result;
    const VkBuffer buffers[2] = {from[0].buffer, r->instances.buffer};
    const bool blocks = d->vertices == GTX_BUFFER_BLOCKS; /* all of one instance */
    const VkDeviceSize placed = blocks ? d->first_instance * sizeof(gtx_instance_data) : 0;
    const VkDeviceSize offsets[2] = {from[0].offset + d->vertex_offset,
                                     r->instances.offset + placed};
    r->vk->api.CmdBindVertexBuffers(r->commands, 0, 2, buffers, offsets);
    if (d->index_size)
        r->vk->api.CmdBindIndexBuffer(
            r->commands, from[1].buffer, from[1].offset + d->index_offset,
            d->index_size == 2 ? VK_INDEX_TYPE_UINT16 : VK_INDEX_TYPE_UINT32);
    return GTX_OK;
}

static void draw_range(const recording *r, const gtx_frame_draw *d, const gtx_range *range)
{
    if (d->index_size)
        r->vk->api.CmdDrawIndexed(r->commands, range->count, d->instance_count, range->first,
                                  (int32_t)range->base_vertex,
                                  d->vertices == GTX_BUFFER_BLOCKS ? 0 : d->first_instance);
    else
        r->vk->api.CmdDraw(r->commands, range->count, 1, range->first, 0);
}

static void submit(const gtx_frame_draw *d, void *user)
{
    recording *r = user;
    if (!r->result)
        r->result = bind_pipeline(r, d);
    if (!r->result)
        r->result = bind_set(r, d);
    if (!r->result)
        r->result = bind_buffers(r, d);
    for (uint32_t i = 0; i < d->range_count && !r->result; ++i)
        draw_range(r, d, &d->ranges[i]);
}

static gtx_result check(const gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_target *target,
                        const gtx_view *view, const gtx_vk_instance *instances, uint32_t count,
                        gtx_error *error)
{
    if (!vk || !commands || !target || !view || (count && !instances) || target->color_count > 4)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a draw needs commands, a target of at most 4 colours, a view and "
                        "instances");
    if (!(view->flags & GTX_VIEW_DEPTH_ZERO_TO_ONE) || view->shading)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a view for Vulkan has clip z in 0..1, and no shading");
    for (uint32_t i = 0; i < count; ++i)
        if (!instances[i].model)
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "instance %u has no model", i);
    if (target->view_mask != (view->other ? 3u : 0u))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a target has two views where the view has another eye, and else none");
    return gtx_check_reserved(target->reserved, 3, error);
}

/* Without what has no name between the members. */
static void set_key(const gtx_vk_target *target, const gtx_frame *frame, uint32_t flags,
                    gtx_vk_key *key)
{
    memset(key, 0, sizeof *key);
    key->target.render_pass = target->render_pass;
    key->target.subpass = target->subpass;
    key->target.color_count = target->color_count;
    for (uint32_t i = 0; i < target->color_count; ++i)
        key->target.color_formats[i] = target->color_formats[i];
    key->target.depth_format = target->depth_format;
    key->target.stencil_format = target->stencil_format;
    key->target.samples = target->samples ? target->samples : VK_SAMPLE_COUNT_1_BIT;
    key->target.y_up = target->y_up != 0;
    key->target.view_mask = target->view_mask;
    key->nearer_is_greater = frame->nearer_is_greater;
    key->by_samples = flags & GTX_VIEW_BY_SAMPLES ? 1 : 0;
}

/* The view of a shading, without tiles where it has no main for them. */
static gtx_result shade(const gtx_vk_shading *shading, gtx_view *view, gtx_error *error)
{
    if (view->pass != GTX_PASS_FORWARD)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a shading takes the forward pass's place");
    if (view->flags & GTX_VIEW_BY_SAMPLES)
        return gtx_fail(error, GTX_ERROR_UNSUPPORTED, "a shading is not drawn by samples");
    if (!shading->by_tiles)
        view->flags &= ~(uint32_t)GTX_VIEW_SHADING_BY_TILES;
    return GTX_OK;
}

static gtx_result draw(gtx_vk *vk, recording *r, const gtx_vk_target *target,
                       const gtx_view *wanted, uint32_t count)
{
    gtx_frame frame;
    gtx_result result = check(vk, r->commands, target, wanted, r->placed, count, r->error);
    if (result)
        return result;
    gtx_view view = *wanted;
    gtx_planner *planner = r->shading ? vk->own_planner : vk->planner;
    if (r->shading && (result = shade(r->shading, &view, r->error)))
        return result;
    void *scratch = vk->instances;
    if (!gtx_vk_grow(vk, &scratch, &vk->instance_room, count, sizeof *vk->instances))
        return gtx_fail(r->error, GTX_ERROR_MEMORY, "no memory for %u instances", count);
    vk->instances = scratch;
    for (uint32_t i = 0; i < count; ++i) {
        vk->instances[i] = r->placed[i].instance;
        vk->instances[i].model = r->placed[i].model->model;
    }
    result = gtx_frame_begin(planner, &view, vk->instances, count, &frame, r->error);
    if (!result)
        result = gtx_vk_write(vk, frame.instances, count * sizeof *frame.instances,
                              &r->instances, r->error);
    if (result)
        return result;
    set_key(target, &frame, view.flags, &r->key);
    r->key.shading = r->shading ? r->shading->number : 0;
    gtx_frame_draws(planner, submit, r);
    return r->result;
}

gtx_result gtx_vk_draw(gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_target *target,
                       const gtx_view *view, const gtx_vk_instance *instances, uint32_t count,
                       gtx_error *error)
{
    recording r = {.vk = vk, .commands = commands, .placed = instances, .error = error};
    return draw(vk, &r, target, view, count);
}

gtx_result gtx_vk_draw_shaded(gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_target *target,
                              const gtx_view *view, const gtx_vk_shading *shading,
                              const gtx_vk_instance *instances, uint32_t count, gtx_error *error)
{
    recording r = {.vk = vk, .commands = commands, .placed = instances, .shading = shading,
                   .error = error};
    if (!shading)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "there is no shading to draw by");
    return draw(vk, &r, target, view, count);
}
