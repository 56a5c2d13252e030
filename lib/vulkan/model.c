/* Models on the device: images and buffers, and the commands that fill them. */
#include "vulkan/device.h"

#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

enum { ALIGN = 16 };

/* What is uploaded of a model. */
typedef struct plan {
    gtx_texture textures[GTX_SLOT_COUNT];
    VkDeviceSize at[GTX_SLOT_COUNT][GTX_MAX_TEXTURE_LEVELS]; /* in the staging buffer */
    const void *buffers[GTX_BUFFER_GRID_VERTICES];
    uint64_t sizes[GTX_BUFFER_GRID_VERTICES];
    VkDeviceSize bytes;         /* of the buffers; textures follow */
    VkDeviceSize all;
} plan;

/* Three bytes a texel are no format of many devices. */
static uint32_t stored_size(const gtx_texture *t)
{
    return t->format == GTX_FORMAT_RGB8_SRGB ? 4 : t->texel_size;
}

/* Bytes of a level as the device has it. */
static VkDeviceSize bytes_of(const gtx_texture *t, uint32_t level)
{
    const VkDeviceSize width = t->width >> level, height = t->height >> level;
    return t->block_size ? (width + 3) / 4 * ((height + 3) / 4) * t->layers * t->block_size
                         : width * height * t->layers * stored_size(t);
}

static VkDeviceSize texels_of(const gtx_texture *t, uint32_t level)
{
    return (VkDeviceSize)(t->width >> level) * (t->height >> level) * t->layers;
}

static VkDeviceSize take(VkDeviceSize *end, VkDeviceSize size)
{
    const VkDeviceSize at = *end;
    *end += (size + ALIGN - 1) / ALIGN * ALIGN;
    return at;
}

/* Where the model has no texture shaders still name one: of a texel. */
static gtx_texture stand_in(void)
{
    static const uint8_t texel[4] = {0, 0, 0, 0};
    return (gtx_texture){.format = GTX_FORMAT_RGBA8, .texel_size = 4, .width = 1, .height = 1,
                         .layers = 1, .levels = 1, .is_array = 1, .texels = {texel}};
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
    for (int s = 0; s < GTX_SLOT_COUNT; ++s) {
        gtx_texture *t = &p->textures[s];
        if (!gtx_model_texture(out->model, (gtx_slot)s, t))
            *t = stand_in();
        if (!t->texels[0])
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "the model's texels have been freed");
        if (t->width > vk->limits.maxImageDimension2D ||
            t->height > vk->limits.maxImageDimension2D ||
            t->layers > vk->limits.maxImageArrayLayers)
            return gtx_fail(error, GTX_ERROR_LIMIT, "an image of %u x %u x %u is beyond this GPU",
                            t->width, t->height, t->layers);
        const bool bc = t->format < GTX_FORMAT_EAC_RG11;
        if (t->block_size && !vk->reads[bc ? GTX_COMPRESS_BC : GTX_COMPRESS_ETC2])
            return gtx_fail(error, GTX_ERROR_UNSUPPORTED, "the device reads no %s blocks",
                            bc ? "BC5 and BC7" : "ETC2");
        for (uint32_t k = 0; k < t->levels; ++k)
            p->at[s][k] = take(&p->all, bytes_of(t, k));
        out->is_filtered[s] = t->is_filtered;
    }
    return GTX_OK;
}

static void copy_texels(uint8_t *to, const gtx_texture *t, uint32_t level)
{
    const uint8_t *from = t->texels[level];
    if (t->format != GTX_FORMAT_RGB8_SRGB) {
        memcpy(to, from, (size_t)bytes_of(t, level));
        return;
    }
    const size_t count = (size_t)texels_of(t, level);
    for (size_t i = 0; i < count; ++i, to += 4, from += 3) {
        memcpy(to, from, 3);
        to[3] = 255;
    }
}

static void fill(const plan *p, const gtx_vk_model *out)
{
    for (int b = 0; b < GTX_BUFFER_GRID_VERTICES; ++b)
        if (p->sizes[b])
            memcpy(out->staging.mapped + out->offsets[b], p->buffers[b], (size_t)p->sizes[b]);
    for (int s = 0; s < GTX_SLOT_COUNT; ++s)
        for (uint32_t k = 0; k < p->textures[s].levels; ++k)
            copy_texels(out->staging.mapped + p->at[s][k], &p->textures[s], k);
}

static VkFormat format_of(const gtx_texture *t)
{
    static const VkFormat formats[] = {
        [GTX_FORMAT_R8] = VK_FORMAT_R8_UNORM,
        [GTX_FORMAT_RG8] = VK_FORMAT_R8G8_UNORM,
        [GTX_FORMAT_RGBA8] = VK_FORMAT_R8G8B8A8_UNORM,
        [GTX_FORMAT_RGB8_SRGB] = VK_FORMAT_R8G8B8A8_SRGB,
        [GTX_FORMAT_RGBA8_SRGB] = VK_FORMAT_R8G8B8A8_SRGB,
        [GTX_FORMAT_RGBA8_UINT] = VK_FORMAT_R8G8B8A8_UINT,
        [GTX_FORMAT_RGBA16_UINT] = VK_FORMAT_R16G16B16A16_UINT,
        [GTX_FORMAT_RGBA32_FLOAT] = VK_FORMAT_R32G32B32A32_SFLOAT,
        [GTX_FORMAT_BC5] = VK_FORMAT_BC5_UNORM_BLOCK,
        [GTX_FORMAT_BC7] = VK_FORMAT_BC7_UNORM_BLOCK,
        [GTX_FORMAT_BC7_SRGB] = VK_FORMAT_BC7_SRGB_BLOCK,
        [GTX_FORMAT_EAC_RG11] = VK_FORMAT_EAC_R11G11_UNORM_BLOCK,
        [GTX_FORMAT_ETC2_RGBA8] = VK_FORMAT_ETC2_R8G8B8A8_UNORM_BLOCK,
        [GTX_FORMAT_ETC2_RGBA8_SRGB] = VK_FORMAT_ETC2_R8G8B8A8_SRGB_BLOCK,
        [GTX_FORMAT_ETC2_RGB8_SRGB] = VK_FORMAT_ETC2_R8G8B8_SRGB_BLOCK};
    return formats[t->format];
}

static gtx_result make_images(gtx_vk *vk, const plan *p, gtx_vk_model *out, gtx_error *error)
{
    const gtx_vk_api *api = &vk->api;
    VkDeviceSize at[GTX_SLOT_COUNT], end = 0;
    uint32_t bits = ~0u;
    gtx_result result = GTX_OK;
    for (int s = 0; s < GTX_SLOT_COUNT && !result; ++s) {
        const gtx_texture *t = &p->textures[s];
        VkMemoryRequirements needs;
        const VkImageCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
            .format = format_of(t), .extent = {t->width, t->height, 1}, .mipLevels = t->levels,
            .arrayLayers = t->layers, .samples = VK_SAMPLE_COUNT_1_BIT,
            .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
        result = gtx_vk_check(
            api->CreateImage(vk->device, &info, vk->callbacks, &out->images[s]), "vkCreateImage",
            error);
        if (result)
            return result;
        api->GetImageMemoryRequirements(vk->device, out->images[s], &needs);
        at[s] = (end + needs.alignment - 1) / needs.alignment * needs.alignment;
        end = at[s] + needs.size;
        bits &= needs.memoryTypeBits;
    }
    const VkMemoryAllocateInfo memory = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                         .allocationSize = end,
                                         .memoryTypeIndex = gtx_vk_memory_type(vk, bits, false)};
    result = gtx_vk_check(api->AllocateMemory(vk->device, &memory, vk->callbacks, &out->memory),
                          "vkAllocateMemory", error);
    for (int s = 0; s < GTX_SLOT_COUNT && !result; ++s) {
        const gtx_texture *t = &p->textures[s];
        result = gtx_vk_check(
            api->BindImageMemory(vk->device, out->images[s], out->memory, at[s]),
            "vkBindImageMemory", error);
        const VkImageViewCreateInfo view = {
            .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = out->images[s],
            .viewType = t->is_array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
            .format = format_of(t),
            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, t->levels, 0, t->layers}};
        if (!result)
            result = gtx_vk_check(
                api->CreateImageView(vk->device, &view, vk->callbacks, &out->views[s]),
                "vkCreateImageView", error);
    }
    return result;
}

/* All images at once, from what they are to what they shall be. */
static void turn(const gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_model *m, bool filled)
{
    VkImageMemoryBarrier images[GTX_SLOT_COUNT];
    for (int s = 0; s < GTX_SLOT_COUNT; ++s)
        images[s] = (VkImageMemoryBarrier){
            .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
            .srcAccessMask = filled ? VK_ACCESS_TRANSFER_WRITE_BIT : 0,
            .dstAccessMask = filled ? VK_ACCESS_SHADER_READ_BIT : VK_ACCESS_TRANSFER_WRITE_BIT,
            .oldLayout = filled ? VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
            .newLayout = filled ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL
                                : VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = m->images[s],
            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0,
                                 VK_REMAINING_ARRAY_LAYERS}};
    const VkBufferMemoryBarrier buffer = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_INDEX_READ_BIT,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .buffer = m->buffer.buffer,
        .size = VK_WHOLE_SIZE};
    const VkPipelineStageFlags readers = VK_PIPELINE_STAGE_VERTEX_INPUT_BIT |
                                         VK_PIPELINE_STAGE_VERTEX_SHADER_BIT |
                                         VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT;
    vk->api.CmdPipelineBarrier(
        commands, filled ? VK_PIPELINE_STAGE_TRANSFER_BIT : VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
        filled ? readers : VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, filled, &buffer,
        GTX_SLOT_COUNT, images);
}

static void record(const gtx_vk *vk, VkCommandBuffer commands, const plan *p,
                   const gtx_vk_model *m)
{
    turn(vk, commands, m, false);
    if (p->bytes) {
        const VkBufferCopy all = {0, 0, p->bytes};
        vk->api.CmdCopyBuffer(commands, m->staging.buffer, m->buffer.buffer, 1, &all);
    }
    for (int s = 0; s < GTX_SLOT_COUNT; ++s) {
        const gtx_texture *t = &p->textures[s];
        VkBufferImageCopy copies[GTX_MAX_TEXTURE_LEVELS];
        for (uint32_t k = 0; k < t->levels; ++k)
            copies[k] = (VkBufferImageCopy){
                .bufferOffset = p->at[s][k],
                .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, k, 0, t->layers},
                .imageExtent = {t->width >> k, t->height >> k, 1}};
        vk->api.CmdCopyBufferToImage(commands, m->staging.buffer, m->images[s],
                                     VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, t->levels, copies);
    }
    turn(vk, commands, m, true);
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
        result = make_images(vk, &p, m, error);
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
    for (int s = 0; s < GTX_SLOT_COUNT; ++s) {
        vk->api.DestroyImageView(vk->device, model->views[s], vk->callbacks);
        vk->api.DestroyImage(vk->device, model->images[s], vk->callbacks);
    }
    vk->api.FreeMemory(vk->device, model->memory, vk->callbacks);
    gtx_vk_buffer_destroy(vk, &model->buffer);
    gtx_vk_buffer_destroy(vk, &model->staging);
    gtx_free_array(&vk->allocator, model, 1, sizeof *model);
}
