/* Images of models and rays: made, filled, and changed in pieces. */
#include "vulkan/images.h"

#include "base/error.h"

#include <string.h>

/* Three bytes a texel are no format of many devices. */
static uint32_t stored_size(const gtx_texture *t)
{
    return t->format == GTX_FORMAT_RGB8_SRGB ? 4 : t->texel_size;
}

VkDeviceSize gtx_vk_level_bytes(const gtx_texture *t, uint32_t level)
{
    const VkDeviceSize width = t->width >> level, height = t->height >> level;
    return t->block_size ? (width + 3) / 4 * ((height + 3) / 4) * t->layers * t->block_size
                         : width * height * t->layers * stored_size(t);
}

/* Texels, or bytes of blocks, one behind the other. */
static void put(uint8_t *to, const gtx_texture *t, const uint8_t *from, size_t bytes)
{
    if (t->format != GTX_FORMAT_RGB8_SRGB) {
        memcpy(to, from, bytes);
        return;
    }
    for (size_t i = 0; i < bytes; i += 3, to += 4, from += 3) {
        memcpy(to, from, 3);
        to[3] = 255;
    }
}

void gtx_vk_put_level(uint8_t *to, const gtx_texture *t, uint32_t level)
{
    const size_t bytes = (size_t)gtx_vk_level_bytes(t, level);
    put(to, t, t->texels[level],
        t->block_size ? bytes : bytes / stored_size(t) * t->texel_size);
}

gtx_result gtx_vk_check_texture(const gtx_vk *vk, const gtx_texture *t, gtx_error *error)
{
    const bool bc = t->format < GTX_FORMAT_EAC_RG11;
    if (t->width > vk->limits.maxImageDimension2D || t->height > vk->limits.maxImageDimension2D ||
        t->layers > vk->limits.maxImageArrayLayers)
        return gtx_fail(error, GTX_ERROR_LIMIT, "an image of %u x %u x %u is beyond this GPU",
                        t->width, t->height, t->layers);
    if (t->block_size && !vk->reads[bc ? GTX_COMPRESS_BC : GTX_COMPRESS_ETC2])
        return gtx_fail(error, GTX_ERROR_UNSUPPORTED, "the device reads no %s blocks",
                        bc ? "BC" : "ETC2");
    return GTX_OK;
}

static VkFormat format_of(const gtx_texture *t)
{
    static const VkFormat formats[] = {
        [GTX_FORMAT_R8] = VK_FORMAT_R8_UNORM,
        [GTX_FORMAT_RG8] = VK_FORMAT_R8G8_UNORM,
        [GTX_FORMAT_RGBA8] = VK_FORMAT_R8G8B8A8_UNORM,
        [GTX_FORMAT_RGB8_SRGB] = VK_FORMAT_R8G8B8A8_SRGB,
        [GTX_FORMAT_RGBA8_SRGB] = VK_FORMAT_R8G8B8A8_SRGB,
        [GTX_FORMAT_R8_UINT] = VK_FORMAT_R8_UINT,
        [GTX_FORMAT_R16_UINT] = VK_FORMAT_R16_UINT,
        [GTX_FORMAT_RGBA32_FLOAT] = VK_FORMAT_R32G32B32A32_SFLOAT,
        [GTX_FORMAT_RGBA8_UINT] = VK_FORMAT_R8G8B8A8_UINT,
        [GTX_FORMAT_RGBA16_UINT] = VK_FORMAT_R16G16B16A16_UINT,
        [GTX_FORMAT_BC5] = VK_FORMAT_BC5_UNORM_BLOCK,
        [GTX_FORMAT_BC7] = VK_FORMAT_BC7_UNORM_BLOCK,
        [GTX_FORMAT_BC7_SRGB] = VK_FORMAT_BC7_SRGB_BLOCK,
        [GTX_FORMAT_BC1_SRGB] = VK_FORMAT_BC1_RGB_SRGB_BLOCK,
        [GTX_FORMAT_EAC_RG11] = VK_FORMAT_EAC_R11G11_UNORM_BLOCK,
        [GTX_FORMAT_ETC2_RGBA8] = VK_FORMAT_ETC2_R8G8B8A8_UNORM_BLOCK,
        [GTX_FORMAT_ETC2_RGBA8_SRGB] = VK_FORMAT_ETC2_R8G8B8A8_SRGB_BLOCK,
        [GTX_FORMAT_ETC2_RGB8_SRGB] = VK_FORMAT_ETC2_R8G8B8_SRGB_BLOCK};
    return formats[t->format];
}

static gtx_result make_image(const gtx_vk *vk, const gtx_texture *t, VkImage *out,
                             gtx_error *error)
{
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
        .format = format_of(t), .extent = {t->width, t->height, 1}, .mipLevels = t->levels,
        .arrayLayers = t->layers, .samples = VK_SAMPLE_COUNT_1_BIT,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    return gtx_vk_check(vk->api.CreateImage(vk->device, &info, vk->callbacks, out),
                        "vkCreateImage", error);
}

static gtx_result make_view(const gtx_vk *vk, const gtx_texture *t, VkImage image,
                            VkImageView *out, gtx_error *error)
{
    const VkImageViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = image,
        .viewType = t->is_array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
        .format = format_of(t),
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, t->levels, 0, t->layers}};
    return gtx_vk_check(vk->api.CreateImageView(vk->device, &info, vk->callbacks, out),
                        "vkCreateImageView", error);
}

gtx_result gtx_vk_images_create(const gtx_vk *vk, const gtx_texture *textures, uint32_t count,
                                gtx_vk_images *out, gtx_error *error)
{
    const gtx_vk_api *api = &vk->api;
    VkDeviceSize at[GTX_VK_IMAGES], end = 0;
    uint32_t bits = ~0u;
    gtx_result result = GTX_OK;
    memset(out, 0, sizeof *out);
    out->count = count;
    for (uint32_t s = 0; s < count; ++s) {
        VkMemoryRequirements needs;
        out->of[s] = textures[s];
        memset(out->of[s].texels, 0, sizeof out->of[s].texels);
        result = make_image(vk, &textures[s], &out->images[s], error);
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
    for (uint32_t s = 0; s < count && !result; ++s) {
        result = gtx_vk_check(
            api->BindImageMemory(vk->device, out->images[s], out->memory, at[s]),
            "vkBindImageMemory", error);
        if (!result)
            result = make_view(vk, &textures[s], out->images[s], &out->views[s], error);
    }
    return result;
}

void gtx_vk_images_destroy(const gtx_vk *vk, gtx_vk_images *images)
{
    for (uint32_t s = 0; s < images->count; ++s) {
        vk->api.DestroyImageView(vk->device, images->views[s], vk->callbacks);
        vk->api.DestroyImage(vk->device, images->images[s], vk->callbacks);
    }
    vk->api.FreeMemory(vk->device, images->memory, vk->callbacks);
    memset(images, 0, sizeof *images);
}

/* Who reads them are shaders of any stage, the engine's own too. */
void gtx_vk_images_turn(const gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_images *images,
                        gtx_vk_use from, gtx_vk_use to)
{
    static const struct {
        VkImageLayout layout;
        VkAccessFlags access;
        VkPipelineStageFlags stage;
    } uses[] = {
        [GTX_VK_NEW] = {VK_IMAGE_LAYOUT_UNDEFINED, 0, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT},
        [GTX_VK_WRITTEN] = {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_ACCESS_TRANSFER_WRITE_BIT,
                            VK_PIPELINE_STAGE_TRANSFER_BIT},
        [GTX_VK_READ] = {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_ACCESS_SHADER_READ_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT}};
    VkImageMemoryBarrier barriers[GTX_VK_IMAGES];
    for (uint32_t s = 0; s < images->count; ++s)
        barriers[s] = (VkImageMemoryBarrier){
            .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
            .srcAccessMask = from == GTX_VK_WRITTEN ? uses[from].access : 0,
            .dstAccessMask = uses[to].access,
            .oldLayout = uses[from].layout, .newLayout = uses[to].layout,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = images->images[s],
            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0,
                                 VK_REMAINING_ARRAY_LAYERS}};
    if (images->count)
        vk->api.CmdPipelineBarrier(commands, uses[from].stage, uses[to].stage, 0, 0, NULL, 0,
                                   NULL, images->count, barriers);
}

void gtx_vk_copy_levels(const gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_images *images,
                        uint32_t which, VkBuffer from,
                        const VkDeviceSize at[GTX_MAX_TEXTURE_LEVELS])
{
    const gtx_texture *t = &images->of[which];
    VkBufferImageCopy copies[GTX_MAX_TEXTURE_LEVELS];
    for (uint32_t k = 0; k < t->levels; ++k)
        copies[k] = (VkBufferImageCopy){
            .bufferOffset = at[k],
            .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, k, 0, t->layers},
            .imageExtent = {t->width >> k, t->height >> k, 1}};
    vk->api.CmdCopyBufferToImage(commands, from, images->images[which],
                                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, t->levels, copies);
}

gtx_result gtx_vk_copy_piece(gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_images *images,
                             uint32_t which, const gtx_texture_piece *piece, gtx_error *error)
{
    const gtx_texture *t = &images->of[which];
    const uint32_t rows = t->block_size ? (piece->height + 3) / 4 : piece->height;
    const size_t row = t->block_size ? ((size_t)piece->width + 3) / 4 * t->block_size
                                     : (size_t)piece->width * t->texel_size;
    const size_t stored = t->block_size ? row : (size_t)piece->width * stored_size(t);
    gtx_vk_piece staged;
    uint8_t *to = NULL;
    gtx_result result = gtx_vk_take(vk, stored * rows, &staged, &to, error);
    if (result)
        return result;
    for (uint32_t y = 0; y < rows; ++y)
        put(to + y * stored, t, (const uint8_t *)piece->data + y * piece->row_bytes, row);
    const VkBufferImageCopy copy = {
        .bufferOffset = staged.offset,
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, piece->level, piece->layer, 1},
        .imageOffset = {(int32_t)piece->x, (int32_t)piece->y, 0},
        .imageExtent = {piece->width, piece->height, 1}};
    vk->api.CmdCopyBufferToImage(commands, staged.buffer, images->images[which],
                                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    return GTX_OK;
}

VkDescriptorImageInfo gtx_vk_image_info(const gtx_vk *vk, const gtx_vk_images *images,
                                        uint32_t which)
{
    return (VkDescriptorImageInfo){vk->samplers[images->of[which].is_filtered],
                                   images->views[which],
                                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
}
