/* Memory: buffers, and what a frame writes. */
#include "vulkan/device.h"

#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

gtx_result gtx_vk_check(VkResult result, const char *what, gtx_error *error)
{
    return result == VK_SUCCESS
               ? GTX_OK
               : gtx_fail(error, GTX_ERROR_GL, "%s failed (VkResult %d)", what, (int)result);
}

uint32_t gtx_vk_memory_type(const gtx_vk *vk, uint32_t bits, bool mapped)
{
    const VkMemoryPropertyFlags host =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const VkMemoryPropertyFlags wanted = mapped ? host : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    uint32_t any = 0;
    for (uint32_t i = vk->memory.memoryTypeCount; i-- > 0;) {
        if (!(bits >> i & 1))
            continue;
        if ((vk->memory.memoryTypes[i].propertyFlags & wanted) == wanted)
            return i;
        any = i;
    }
    return any;
}

gtx_result gtx_vk_buffer_create(const gtx_vk *vk, VkDeviceSize size, VkBufferUsageFlags usage,
                                bool mapped, gtx_vk_buffer *out, gtx_error *error)
{
    const gtx_vk_api *api = &vk->api;
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = size ? size : 4,
                                     .usage = usage};
    VkMemoryRequirements needs;
    memset(out, 0, sizeof *out);
    out->size = info.size;
    gtx_result result = gtx_vk_check(
        api->CreateBuffer(vk->device, &info, vk->callbacks, &out->buffer), "vkCreateBuffer", error);
    if (result)
        return result;
    api->GetBufferMemoryRequirements(vk->device, out->buffer, &needs);
    const VkMemoryAllocateInfo memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size,
        .memoryTypeIndex = gtx_vk_memory_type(vk, needs.memoryTypeBits, mapped)};
    result = gtx_vk_check(api->AllocateMemory(vk->device, &memory, vk->callbacks, &out->memory),
                          "vkAllocateMemory", error);
    if (!result)
        result = gtx_vk_check(api->BindBufferMemory(vk->device, out->buffer, out->memory, 0),
                              "vkBindBufferMemory", error);
    void *at = NULL;
    if (!result && mapped)
        result = gtx_vk_check(
            api->MapMemory(vk->device, out->memory, 0, VK_WHOLE_SIZE, 0, &at), "vkMapMemory",
            error);
    out->mapped = at;
    if (result)
        gtx_vk_buffer_destroy(vk, out);
    return result;
}

void gtx_vk_buffer_destroy(const gtx_vk *vk, gtx_vk_buffer *buffer)
{
    vk->api.DestroyBuffer(vk->device, buffer->buffer, vk->callbacks);
    vk->api.FreeMemory(vk->device, buffer->memory, vk->callbacks);
    memset(buffer, 0, sizeof *buffer);
}

/* Room of the arrays of a frame: they grow by one, seldom. */
static bool add_one(const gtx_vk *vk, void **array, uint32_t count, size_t size)
{
    void *grown = gtx_alloc_array(&vk->allocator, count + 1u, size);
    if (!grown)
        return false;
    if (*array)
        memcpy(grown, *array, count * size);
    gtx_free_array(&vk->allocator, *array, count, size);
    *array = grown;
    return true;
}

static gtx_result add_block(gtx_vk *vk, gtx_vk_frame *frame, VkDeviceSize least, gtx_error *error)
{
    const VkDeviceSize usual = 1 << 20;
    const VkBufferUsageFlags usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                                     VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                     VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                                     VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                                     VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    gtx_vk_buffer block;
    void *blocks = frame->blocks;
    gtx_result result = gtx_vk_buffer_create(vk, least > usual ? least + least / 2 : usual, usage,
                                             true, &block, error);
    if (result)
        return result;
    if (!add_one(vk, &blocks, frame->block_count, sizeof block)) {
        gtx_vk_buffer_destroy(vk, &block);
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a frame");
    }
    frame->blocks = blocks;
    frame->blocks[frame->block_count++] = block;
    return GTX_OK;
}

static VkDeviceSize most_of(VkDeviceSize a, VkDeviceSize b)
{
    return a > b ? a : b;
}

gtx_result gtx_vk_take(gtx_vk *vk, VkDeviceSize size, gtx_vk_piece *out, uint8_t **to,
                       gtx_error *error)
{
    gtx_vk_frame *frame = &vk->frames[vk->frame];
    const VkDeviceSize unit = most_of(16, most_of(vk->limits.minUniformBufferOffsetAlignment,
                                                  vk->limits.minTexelBufferOffsetAlignment));
    VkDeviceSize at = (frame->used + unit - 1) / unit * unit;
    while (frame->block < frame->block_count && at + size > frame->blocks[frame->block].size) {
        ++frame->block;
        at = 0;
    }
    if (frame->block == frame->block_count) {
        gtx_result result = add_block(vk, frame, size, error);
        if (result)
            return result;
        at = 0;
    }
    const gtx_vk_buffer *block = &frame->blocks[frame->block];
    *out = (gtx_vk_piece){block->buffer, at, size};
    *to = block->mapped + at;
    frame->used = at + size;
    return GTX_OK;
}

gtx_result gtx_vk_write_all(gtx_vk *vk, const void *const *data, const uint64_t *sizes,
                            uint32_t count, gtx_vk_piece *out, gtx_error *error)
{
    VkDeviceSize size = 0;
    uint8_t *to = NULL;
    for (uint32_t i = 0; i < count; ++i)
        size += sizes[i];
    gtx_result result = gtx_vk_take(vk, size, out, &to, error);
    for (uint32_t i = 0; i < count && !result; ++i) {
        if (sizes[i])
            memcpy(to, data[i], sizes[i]);
        to += sizes[i];
    }
    return result;
}

gtx_result gtx_vk_write(gtx_vk *vk, const void *data, VkDeviceSize size, gtx_vk_piece *out,
                        gtx_error *error)
{
    const uint64_t all = size;
    return gtx_vk_write_all(vk, &data, &all, 1, out, error);
}

static gtx_result add_pool(gtx_vk *vk, gtx_vk_frame *frame, gtx_error *error)
{
    const VkDescriptorPoolSize sizes[] = {
        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
         GTX_VK_SETS * (GTX_SLOT_COUNT + GTX_RAYS_TEXTURES)},
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 2 * GTX_VK_SETS},
        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, GTX_VK_SETS}};
    const VkDescriptorPoolCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = GTX_VK_SETS, .poolSizeCount = 3, .pPoolSizes = sizes};
    VkDescriptorPool pool;
    void *pools = frame->pools;
    gtx_result result =
        gtx_vk_check(vk->api.CreateDescriptorPool(vk->device, &info, vk->callbacks, &pool),
                     "vkCreateDescriptorPool", error);
    if (result)
        return result;
    if (!add_one(vk, &pools, frame->pool_count, sizeof pool)) {
        vk->api.DestroyDescriptorPool(vk->device, pool, vk->callbacks);
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a frame");
    }
    frame->pools = pools;
    frame->pools[frame->pool_count++] = pool;
    return GTX_OK;
}

gtx_result gtx_vk_take_set(gtx_vk *vk, VkDescriptorSetLayout layout, VkDescriptorSet *out,
                           gtx_error *error)
{
    gtx_vk_frame *frame = &vk->frames[vk->frame];
    if (frame->sets == GTX_VK_SETS) {
        ++frame->pool;
        frame->sets = 0;
    }
    if (frame->pool == frame->pool_count) {
        gtx_result result = add_pool(vk, frame, error);
        if (result)
            return result;
    }
    const VkDescriptorSetAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = frame->pools[frame->pool],
        .descriptorSetCount = 1, .pSetLayouts = &layout};
    ++frame->sets;
    return gtx_vk_check(vk->api.AllocateDescriptorSets(vk->device, &info, out),
                        "vkAllocateDescriptorSets", error);
}

gtx_result gtx_vk_view(gtx_vk *vk, const gtx_vk_piece *piece, VkBufferView *out, gtx_error *error)
{
    gtx_vk_frame *frame = &vk->frames[vk->frame];
    const VkBufferViewCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                         .buffer = piece->buffer,
                                         .format = VK_FORMAT_R32G32B32A32_UINT,
                                         .offset = piece->offset, .range = piece->size};
    void *views = frame->views;
    if (!gtx_vk_grow(vk, &views, &frame->view_room, frame->view_count + 1, sizeof *frame->views))
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a frame");
    frame->views = views;
    gtx_result result =
        gtx_vk_check(vk->api.CreateBufferView(vk->device, &info, vk->callbacks, out),
                     "vkCreateBufferView", error);
    if (!result)
        frame->views[frame->view_count++] = *out;
    return result;
}

void gtx_vk_views_free(gtx_vk *vk, gtx_vk_frame *frame)
{
    for (uint32_t i = 0; i < frame->view_count; ++i)
        vk->api.DestroyBufferView(vk->device, frame->views[i], vk->callbacks);
    frame->view_count = 0;
}

void gtx_vk_frame_free(gtx_vk *vk, gtx_vk_frame *frame)
{
    gtx_vk_views_free(vk, frame);
    gtx_vk_models_free(vk, frame);
    gtx_free_array(&vk->allocator, frame->views, frame->view_room, sizeof *frame->views);
    for (uint32_t i = 0; i < frame->block_count; ++i)
        gtx_vk_buffer_destroy(vk, &frame->blocks[i]);
    for (uint32_t i = 0; i < frame->pool_count; ++i)
        vk->api.DestroyDescriptorPool(vk->device, frame->pools[i], vk->callbacks);
    gtx_free_array(&vk->allocator, frame->blocks, frame->block_count, sizeof *frame->blocks);
    gtx_free_array(&vk->allocator, frame->pools, frame->pool_count, sizeof *frame->pools);
    memset(frame, 0, sizeof *frame);
}
