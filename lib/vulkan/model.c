/* Models on the device: images and buffers, and the commands that fill and change them. */
#include "vulkan/images.h"

#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

enum { ALIGN = 16 };

/* What is uploaded of a model. */
typedef struct plan {
    gtx_texture textures[GTX_VK_IMAGES];
    VkDeviceSize at[GTX_VK_IMAGES][GTX_MAX_TEXTURE_LEVELS]; /* in the staging buffer */
    const void *buffers[GTX_BUFFER_GRID_VERTICES];
    uint64_t sizes[GTX_BUFFER_GRID_VERTICES];
    VkDeviceSize bytes;         /* of the buffers; textures follow */
    VkDeviceSize all;
} plan;

static VkDeviceSize take(VkDeviceSize *end, VkDeviceSize size)
{
    const VkDeviceSize at = *end;
    *end += (size + ALIGN - 1) / ALIGN * ALIGN;
    return at;
}

/* Where the model has no texture shaders still name one: of a texel. */
static gtx_texture stand_in(uint32_t is_array)
{
    static const uint8_t texel[4] = {0, 0, 0, 0};
    return (gtx_texture){.format = GTX_FORMAT_RGBA8, .texel_size = 4, .width = 1, .height = 1,
                         .layers = 1, .levels = 1, .is_array = is_array, .texels = {texel}};
}

static gtx_result plan_of(const gtx_vk *vk, gtx_vk_model *out, plan *p, gtx_error *error)
{
    memset(p, 0, sizeof *p);
    for (int b = 0; b < GTX_BUFFER_GRID_VERTICES; ++b) {
        p->buffers[b] = gtx_model_buffer(out->model, (gtx_buffer)b, &p->sizes[b]);
        if (p->sizes[b] && !p->buffers[b])
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "the model's bytes have been freed");
        out->offsets[b] = take(&p->bytes, p->sizes[b]);
    }
    p->all = p->bytes;
    for (int s = 0; s < GTX_VK_IMAGES; ++s) {
        gtx_texture *t = &p->textures[s];
        if (!gtx_model_texture(out->model, (gtx_slot)s, t))
            *t = stand_in(s < GTX_SLOT_COUNT);
        if (!t->texels[0])
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "the model's texels have been freed");
        gtx_result result = gtx_vk_check_texture(vk, t, error);
        if (result)
            return result;
        for (uint32_t k = 0; k < t->levels; ++k)
            p->at[s][k] = take(&p->all, gtx_vk_level_bytes(t, k));
    }
    return GTX_OK;
}

static void fill(const plan *p, const gtx_vk_model *out)
{
    for (int b = 0; b < GTX_BUFFER_GRID_VERTICES; ++b)
        if (p->sizes[b])
            memcpy(out->staging.mapped + out->offsets[b], p->buffers[b], (size_t)p->sizes[b]);
    for (int s = 0; s < GTX_VK_IMAGES; ++s)
        for (uint32_t k = 0; k < p->textures[s].levels; ++k)
            gtx_vk_put_level(out->staging.mapped + p->at[s][k], &p->textures[s], k);
}

/* From drawing to copying, or back. */
static void turn_buffer(const gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_model *m,
                        bool filled)
{
    const VkAccessFlags reads = VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_INDEX_READ_BIT;
    const VkBufferMemoryBarrier buffer = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER,
        .srcAccessMask = filled ? VK_ACCESS_TRANSFER_WRITE_BIT : 0,
        .dstAccessMask = filled ? reads : VK_ACCESS_TRANSFER_WRITE_BIT,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .buffer = m->buffer.buffer,
        .size = VK_WHOLE_SIZE};
    vk->api.CmdPipelineBarrier(
        commands, filled ? VK_PIPELINE_STAGE_TRANSFER_BIT : VK_PIPELINE_STAGE_VERTEX_INPUT_BIT,
        filled ? VK_PIPELINE_STAGE_VERTEX_INPUT_BIT : VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL,
        1, &buffer, 0, NULL);
}

static void record(const gtx_vk *vk, VkCommandBuffer commands, const plan *p,
                   const gtx_vk_model *m)
{
    gtx_vk_images_turn(vk, commands, &m->maps, GTX_VK_NEW, GTX_VK_WRITTEN);
    if (p->bytes) {
        const VkBufferCopy all = {0, 0, p->bytes};
        vk->api.CmdCopyBuffer(commands, m->staging.buffer, m->buffer.buffer, 1, &all);
    }
    for (uint32_t s = 0; s < GTX_VK_IMAGES; ++s)
        gtx_vk_copy_levels(vk, commands, &m->maps, s, m->staging.buffer, p->at[s]);
    gtx_vk_images_turn(vk, commands, &m->maps, GTX_VK_WRITTEN, GTX_VK_READ);
    turn_buffer(vk, commands, m, true);
}

gtx_result gtx_vk_upload(gtx_vk *vk, VkCommandBuffer commands, gtx_model *model,
                         gtx_vk_model **out, gtx_error *error)
{
    const VkBufferUsageFlags usage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                                     VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                                     VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    plan p;
    if (!vk || !commands || !model || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "an upload needs commands and a model");
    *out = NULL;
    gtx_vk_model *m = gtx_alloc_array(&vk->allocator, 1, sizeof *m);
    if (!m)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a model");
    m->model = model;
    gtx_result result = plan_of(vk, m, &p, error);
    if (!result)
        result = gtx_vk_images_create(vk, p.textures, GTX_VK_IMAGES, &m->maps, error);
    if (!result)
        result = gtx_vk_buffer_create(vk, p.bytes, usage, false, &m->buffer, error);
    if (!result)
        result = gtx_vk_buffer_create(vk, p.all, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true,
                                      &m->staging, error);
    if (result) {
        gtx_vk_model_destroy(vk, m);
        return result;
    }
    fill(&p, m);
    record(vk, commands, &p, m);
    gtx_model_uploaded(model);
    *out = m;
    return GTX_OK;
}

void gtx_vk_uploaded(gtx_vk *vk, gtx_vk_model *model)
{
    if (vk && model)
        gtx_vk_buffer_destroy(vk, &model->staging);
}

void gtx_vk_model_destroy(gtx_vk *vk, gtx_vk_model *model)
{
    if (!vk || !model)
        return;
    gtx_vk_images_destroy(vk, &model->maps);
    gtx_vk_images_destroy(vk, &model->spread);
    gtx_vk_buffer_destroy(vk, &model->buffer);
    gtx_vk_buffer_destroy(vk, &model->staging);
    gtx_free_array(&vk->allocator, model, 1, sizeof *model);
}

void gtx_vk_model_retire(gtx_vk *vk, gtx_vk_model *model)
{
    if (!vk || !model)
        return;
    gtx_vk_frame *frame = &vk->frames[vk->frame];
    model->next = frame->retired;
    frame->retired = model;
}

void gtx_vk_models_free(gtx_vk *vk, gtx_vk_frame *frame)
{
    while (frame->retired) {
        gtx_vk_model *model = frame->retired;
        frame->retired = model->next;
        gtx_vk_model_destroy(vk, model);
    }
}

VkDescriptorImageInfo gtx_vk_model_image(const gtx_vk *vk, const gtx_vk_model *model,
                                         uint32_t slot)
{
    return slot == GTX_SLOT_MATERIALS && model->spread.count
               ? gtx_vk_image_info(vk, &model->spread, 0)
               : gtx_vk_image_info(vk, &model->maps, slot);
}

/* Nodes end at texel 0; the others are not read. */
void gtx_vk_model_no_rays(const gtx_vk *vk, const gtx_vk_model *model,
                          VkDescriptorImageInfo out[GTX_RAYS_TEXTURES])
{
    static const uint32_t images[GTX_RAYS_TEXTURES] = {GTX_SLOT_COUNT, GTX_SLOT_CELLS,
                                                       GTX_SLOT_TRIM};
    for (uint32_t i = 0; i < GTX_RAYS_TEXTURES; ++i)
        out[i] = gtx_vk_image_info(vk, &model->maps, images[i]);
}

/* One gtx_vk_update. */
typedef struct update {
    gtx_vk *vk;
    VkCommandBuffer commands;
    gtx_vk_model *model;
    gtx_result result;
    gtx_error *error;
} update;

static void send_piece(const gtx_texture_piece *piece, void *user)
{
    update *u = user;
    const bool spread = piece->binding == GTX_SLOT_MATERIALS && u->model->spread.count;
    if (!u->result)
        u->result = gtx_vk_copy_piece(u->vk, u->commands,
                                      spread ? &u->model->spread : &u->model->maps,
                                      spread ? 0 : piece->binding, piece, u->error);
}

static void send_bytes(gtx_buffer buffer, uint64_t at, const void *data, uint64_t size, void *user)
{
    update *u = user;
    gtx_vk_piece staged;
    if (!u->result)
        u->result = gtx_vk_write(u->vk, data, size, &staged, u->error);
    if (u->result)
        return;
    const VkBufferCopy copy = {staged.offset, u->model->offsets[buffer] + at, size};
    u->vk->api.CmdCopyBuffer(u->commands, staged.buffer, u->model->buffer.buffer, 1, &copy);
}

/* The image of a single texel stays: frames may be reading it. */
static void renew(gtx_slot slot, const gtx_texture *t, void *user)
{
    update *u = user;
    VkDeviceSize at[GTX_MAX_TEXTURE_LEVELS];
    uint64_t sizes[GTX_MAX_TEXTURE_LEVELS];
    gtx_vk_piece staged = {0};
    gtx_vk_images *spread = &u->model->spread;
    (void)slot;
    for (uint32_t k = 0; k < t->levels; ++k)
        sizes[k] = gtx_vk_level_bytes(t, k);
    if (!u->result)
        u->result = gtx_vk_write_all(u->vk, t->texels, sizes, t->levels, &staged, u->error);
    if (u->result)
        return;
    u->result = gtx_vk_images_create(u->vk, t, 1, spread, u->error);
    if (u->result) {
        gtx_vk_images_destroy(u->vk, spread);
        return;
    }
    gtx_vk_images_turn(u->vk, u->commands, spread, GTX_VK_NEW, GTX_VK_WRITTEN);
    for (uint32_t k = 0; k < t->levels; ++k) {
        at[k] = staged.offset;
        staged.offset += sizes[k];
    }
    gtx_vk_copy_levels(u->vk, u->commands, spread, 0, staged.buffer, at);
}

gtx_result gtx_vk_update(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_model *model,
                         const gtx_asset *edited, const uint32_t *patches, uint32_t count,
                         gtx_error *error)
{
    update u = {vk, commands, model, GTX_OK, error};
    const gtx_sink sink = {send_piece, send_bytes, renew, &u};
    if (!vk || !commands || !model || !edited || (count && !patches))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an update needs commands, a model, an edited asset and its patches");
    gtx_vk_images_turn(vk, commands, &model->maps, GTX_VK_READ, GTX_VK_WRITTEN);
    gtx_vk_images_turn(vk, commands, &model->spread, GTX_VK_READ, GTX_VK_WRITTEN);
    turn_buffer(vk, commands, model, false);
    for (uint32_t i = 0; i < count && !u.result; ++i) {
        const gtx_result result = gtx_model_edit(model->model, edited, patches[i], &sink, error);
        u.result = u.result ? u.result : result;
    }
    gtx_vk_images_turn(vk, commands, &model->maps, GTX_VK_WRITTEN, GTX_VK_READ);
    gtx_vk_images_turn(vk, commands, &model->spread, GTX_VK_WRITTEN, GTX_VK_READ);
    turn_buffer(vk, commands, model, true);
    return u.result;
}
