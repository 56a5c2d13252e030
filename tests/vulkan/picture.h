/* Pictures that Vulkan draws, by a render pass or by dynamic rendering. */
#ifndef GTX_TESTS_VULKAN_PICTURE_H
#define GTX_TESTS_VULKAN_PICTURE_H

#include "host_device.h"

enum { DEPTH = 4 }; /* the index of the depth image */

/* The type of memory: the first that allows it, of the host's for a mapped buffer. */
static inline uint32_t memory_type(const device *d, uint32_t bits, VkMemoryPropertyFlags wanted)
{
    VkPhysicalDeviceMemoryProperties p;
    ((PFN_vkGetPhysicalDeviceMemoryProperties)d->load(
        d->instance, "vkGetPhysicalDeviceMemoryProperties"))(d->physical, &p);
    for (uint32_t i = 0; i < p.memoryTypeCount; ++i)
        if (bits >> i & 1 && (p.memoryTypes[i].propertyFlags & wanted) == wanted)
            return i;
    fail();
    return 0;
}

static inline void make_image(device *d, int which, VkFormat format)
{
    const bool depth = which == DEPTH;
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
        .format = format, .extent = {STAGE_WIDTH, STAGE_HEIGHT, 1}, .mipLevels = 1,
        .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT,
        .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 (depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                        : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT)};
    VkMemoryRequirements needs;
    assert_int_equal(d->CreateImage(d->device, &info, NULL, &d->images[which]), VK_SUCCESS);
    d->GetImageMemoryRequirements(d->device, d->images[which], &needs);
    const VkMemoryAllocateInfo memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size,
        .memoryTypeIndex = memory_type(d, needs.memoryTypeBits, 0)};
    d->AllocateMemory(d->device, &memory, NULL, &d->memories[which]);
    d->BindImageMemory(d->device, d->images[which], d->memories[which], 0);
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = d->images[which],
        .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = format,
        .subresourceRange = {depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, 0, 1,
                             0, 1}};
    assert_int_equal(d->CreateImageView(d->device, &view, NULL, &d->views[which]), VK_SUCCESS);
}

/* Four bytes a pixel: one colour, or three, then depth. */
static inline void make_read_buffer(device *d)
{
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = 5 * 4 * STAGE_PIXELS,
                                     .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    const VkMemoryPropertyFlags mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkMemoryRequirements needs;
    void *bytes;
    assert_int_equal(d->CreateBuffer(d->device, &info, NULL, &d->read), VK_SUCCESS);
    d->GetBufferMemoryRequirements(d->device, d->read, &needs);
    const VkMemoryAllocateInfo memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size,
        .memoryTypeIndex = memory_type(d, needs.memoryTypeBits, mapped)};
    d->AllocateMemory(d->device, &memory, NULL, &d->memories[5]);
    d->BindBufferMemory(d->device, d->read, d->memories[5], 0);
    assert_int_equal(d->MapMemory(d->device, d->memories[5], 0, VK_WHOLE_SIZE, 0, &bytes),
                     VK_SUCCESS);
    d->bytes = bytes;
}

/* Of one colour, with what a pass of it needs. */
static inline void make_picture(device *d, VkFormat color)
{
    make_image(d, 0, color);
    make_image(d, DEPTH, VK_FORMAT_D32_SFLOAT);
    make_read_buffer(d);
    const VkAttachmentDescription attachments[2] = {
        {.format = color, .samples = VK_SAMPLE_COUNT_1_BIT, .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_STORE, .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
         .finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
        {.format = VK_FORMAT_D32_SFLOAT, .samples = VK_SAMPLE_COUNT_1_BIT,
         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
         .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
         .finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL}};
    const VkAttachmentReference of_color = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference of_depth = {1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass = {.colorAttachmentCount = 1,
                                          .pColorAttachments = &of_color,
                                          .pDepthStencilAttachment = &of_depth};
    const VkRenderPassCreateInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                         .attachmentCount = 2, .pAttachments = attachments,
                                         .subpassCount = 1, .pSubpasses = &subpass};
    assert_int_equal(d->CreateRenderPass(d->device, &pass, NULL, &d->pass), VK_SUCCESS);
    const VkImageView views[2] = {d->views[0], d->views[DEPTH]};
    const VkFramebufferCreateInfo framebuffer = {
        .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO, .renderPass = d->pass,
        .attachmentCount = 2, .pAttachments = views, .width = STAGE_WIDTH,
        .height = STAGE_HEIGHT, .layers = 1};
    assert_int_equal(d->CreateFramebuffer(d->device, &framebuffer, NULL, &d->framebuffer),
                     VK_SUCCESS);
}

static inline void free_picture(device *d)
{
    d->DestroyFramebuffer(d->device, d->framebuffer, NULL);
    d->DestroyRenderPass(d->device, d->pass, NULL);
    d->DestroyBuffer(d->device, d->read, NULL);
    for (int i = 0; i < 5; ++i) {
        d->DestroyImageView(d->device, d->views[i], NULL);
        d->DestroyImage(d->device, d->images[i], NULL);
    }
    for (int i = 0; i < 6; ++i)
        d->FreeMemory(d->device, d->memories[i], NULL);
}

static inline void turn(const device *d, int which, VkImageLayout from, VkImageLayout to)
{
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = from, .newLayout = to, .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = d->images[which],
        .subresourceRange = {which == DEPTH ? VK_IMAGE_ASPECT_DEPTH_BIT
                                            : VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    d->CmdPipelineBarrier(d->commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                          VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

/* `by_pass`: by the render pass, or without one. */
static inline void begin_picture(device *d, bool by_pass, float far, bool y_up)
{
    const VkRect2D all = {{0, 0}, {STAGE_WIDTH, STAGE_HEIGHT}};
    const VkClearValue clear[2] = {{.color = {.float32 = {0, 0, 0, 0}}},
                                   {.depthStencil = {far, 0}}};
    const VkViewport viewport = {0, y_up ? STAGE_HEIGHT : 0, STAGE_WIDTH,
                                 y_up ? -(float)STAGE_HEIGHT : STAGE_HEIGHT, 0, 1};
    if (by_pass) {
        const VkRenderPassBeginInfo info = {
            .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO, .renderPass = d->pass,
            .framebuffer = d->framebuffer, .renderArea = all, .clearValueCount = 2,
            .pClearValues = clear};
        d->CmdBeginRenderPass(d->commands, &info, VK_SUBPASS_CONTENTS_INLINE);
    } else {
        const VkRenderingAttachmentInfo attachments[2] = {
            {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO, .imageView = d->views[0],
             .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
             .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
             .clearValue = clear[0]},
            {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO, .imageView = d->views[DEPTH],
             .imageLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
             .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
             .clearValue = clear[1]}};
        const VkRenderingInfo info = {.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                      .renderArea = all, .layerCount = 1,
                                      .colorAttachmentCount = 1,
                                      .pColorAttachments = &attachments[0],
                                      .pDepthAttachment = &attachments[1]};
        turn(d, 0, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        turn(d, DEPTH, VK_IMAGE_LAYOUT_UNDEFINED,
             VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
        d->CmdBeginRendering(d->commands, &info);
    }
    d->CmdSetViewport(d->commands, 0, 1, &viewport);
    d->CmdSetScissor(d->commands, 0, 1, &all);
}

/* Reads back, the uppermost row first. */
static inline void end_picture(device *d, bool by_pass, uint8_t *color, float *depth)
{
    if (by_pass)
        d->CmdEndRenderPass(d->commands);
    else
        d->CmdEndRendering(d->commands);
    for (int i = 0; i <= DEPTH; i += DEPTH) {
        const VkBufferImageCopy copy = {
            .bufferOffset = i ? 16 * STAGE_PIXELS : 0,
            .imageSubresource = {i ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, 0, 0,
                                 1},
            .imageExtent = {STAGE_WIDTH, STAGE_HEIGHT, 1}};
        turn(d, i, i ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                     : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
             VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        d->CmdCopyImageToBuffer(d->commands, d->images[i], VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                d->read, 1, &copy);
    }
    run_commands(d);
    for (int y = 0; y < STAGE_HEIGHT; ++y) {
        const size_t row = 4 * STAGE_WIDTH, from = (size_t)y * row;
        memcpy(color + (size_t)y * row, d->bytes + from, row);
        memcpy(depth + y * STAGE_WIDTH, d->bytes + 16 * STAGE_PIXELS + from, row);
    }
}

#endif
