/* Pictures that Vulkan draws, by a render pass or by dynamic rendering. */
#ifndef GTX_TESTS_VULKAN_PICTURE_H
#define GTX_TESTS_VULKAN_PICTURE_H

#include "host_device.h"

enum { COLORS = 4, DEPTH = COLORS, IMAGES = COLORS + 1, MOST_BYTES = 16 };

/* Up to four colours and a depth, and what they are read through. */
typedef struct picture {
    uint32_t color_count, sizes[IMAGES]; /* bytes of a pixel */
    VkFormat formats[IMAGES];
    VkImage images[IMAGES];
    VkImageView views[IMAGES];
    VkDeviceMemory memories[IMAGES], read_memory;
    VkBuffer read;
    uint8_t *bytes;
    VkRenderPass pass;
    VkFramebuffer framebuffer;
} picture;

/* Where an image's pixels begin in the buffer that is read. */
static inline size_t offset_of(int which)
{
    return (size_t)which * MOST_BYTES * STAGE_PIXELS;
}

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

static inline void make_image(const device *d, picture *p, int which)
{
    const bool depth = which == DEPTH;
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
        .format = p->formats[which], .extent = {STAGE_WIDTH, STAGE_HEIGHT, 1}, .mipLevels = 1,
        .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT,
        .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 (depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                        : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT)};
    VkMemoryRequirements needs;
    assert_int_equal(d->CreateImage(d->device, &info, NULL, &p->images[which]), VK_SUCCESS);
    d->GetImageMemoryRequirements(d->device, p->images[which], &needs);
    const VkMemoryAllocateInfo memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size,
        .memoryTypeIndex = memory_type(d, needs.memoryTypeBits, 0)};
    d->AllocateMemory(d->device, &memory, NULL, &p->memories[which]);
    d->BindImageMemory(d->device, p->images[which], p->memories[which], 0);
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = p->images[which],
        .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = p->formats[which],
        .subresourceRange = {depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, 0, 1,
                             0, 1}};
    assert_int_equal(d->CreateImageView(d->device, &view, NULL, &p->views[which]), VK_SUCCESS);
}

static inline void make_read_buffer(const device *d, picture *p)
{
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = IMAGES * MOST_BYTES * STAGE_PIXELS,
                                     .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    const VkMemoryPropertyFlags mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkMemoryRequirements needs;
    void *bytes;
    assert_int_equal(d->CreateBuffer(d->device, &info, NULL, &p->read), VK_SUCCESS);
    d->GetBufferMemoryRequirements(d->device, p->read, &needs);
    const VkMemoryAllocateInfo memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size,
        .memoryTypeIndex = memory_type(d, needs.memoryTypeBits, mapped)};
    d->AllocateMemory(d->device, &memory, NULL, &p->read_memory);
    d->BindBufferMemory(d->device, p->read, p->read_memory, 0);
    assert_int_equal(d->MapMemory(d->device, p->read_memory, 0, VK_WHOLE_SIZE, 0, &bytes),
                     VK_SUCCESS);
    p->bytes = bytes;
}

/* Of so many colours, with what a pass of them needs. */
static inline void make_picture(const device *d, picture *p, uint32_t colors,
                                const VkFormat *formats, uint32_t size)
{
    VkAttachmentDescription attachments[IMAGES];
    VkAttachmentReference references[IMAGES];
    VkImageView views[IMAGES];
    memset(p, 0, sizeof *p);
    p->color_count = colors;
    for (uint32_t i = 0; i <= colors; ++i) {
        const bool depth = i == colors;
        const int which = depth ? DEPTH : (int)i;
        const VkImageLayout layout = depth ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                                           : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        p->formats[which] = depth ? VK_FORMAT_D32_SFLOAT : formats[i];
        p->sizes[which] = depth ? 4 : size;
        make_image(d, p, which);
        views[i] = p->views[which];
        references[i] = (VkAttachmentReference){i, layout};
        attachments[i] = (VkAttachmentDescription){
            .format = p->formats[which], .samples = VK_SAMPLE_COUNT_1_BIT,
            .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
            .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED, .finalLayout = layout};
    }
    make_read_buffer(d, p);
    const VkSubpassDescription subpass = {.colorAttachmentCount = colors,
                                          .pColorAttachments = references,
                                          .pDepthStencilAttachment = &references[colors]};
    const VkRenderPassCreateInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                         .attachmentCount = colors + 1,
                                         .pAttachments = attachments, .subpassCount = 1,
                                         .pSubpasses = &subpass};
    assert_int_equal(d->CreateRenderPass(d->device, &pass, NULL, &p->pass), VK_SUCCESS);
    const VkFramebufferCreateInfo framebuffer = {
        .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO, .renderPass = p->pass,
        .attachmentCount = colors + 1, .pAttachments = views, .width = STAGE_WIDTH,
        .height = STAGE_HEIGHT, .layers = 1};
    assert_int_equal(d->CreateFramebuffer(d->device, &framebuffer, NULL, &p->framebuffer),
                     VK_SUCCESS);
}

static inline void free_picture(const device *d, picture *p)
{
    d->DestroyFramebuffer(d->device, p->framebuffer, NULL);
    d->DestroyRenderPass(d->device, p->pass, NULL);
    d->DestroyBuffer(d->device, p->read, NULL);
    d->FreeMemory(d->device, p->read_memory, NULL);
    for (int i = 0; i < IMAGES; ++i) {
        d->DestroyImageView(d->device, p->views[i], NULL);
        d->DestroyImage(d->device, p->images[i], NULL);
        d->FreeMemory(d->device, p->memories[i], NULL);
    }
}

static inline void turn(const device *d, const picture *p, int which, VkImageLayout from,
                        VkImageLayout to)
{
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = from, .newLayout = to, .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = p->images[which],
        .subresourceRange = {which == DEPTH ? VK_IMAGE_ASPECT_DEPTH_BIT
                                            : VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    d->CmdPipelineBarrier(d->commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                          VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

/* `by_pass`: by the render pass, or without one. */
static inline void begin_picture(const device *d, const picture *p, bool by_pass, float far,
                                 bool y_up)
{
    const VkRect2D all = {{0, 0}, {STAGE_WIDTH, STAGE_HEIGHT}};
    const VkViewport viewport = {0, y_up ? STAGE_HEIGHT : 0, STAGE_WIDTH,
                                 y_up ? -(float)STAGE_HEIGHT : STAGE_HEIGHT, 0, 1};
    VkClearValue clears[IMAGES];
    VkRenderingAttachmentInfo attachments[IMAGES];
    memset(clears, 0, sizeof clears);
    clears[p->color_count].depthStencil.depth = far;
    for (uint32_t i = 0; i <= p->color_count; ++i)
        attachments[i] = (VkRenderingAttachmentInfo){
            .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
            .imageView = p->views[i == p->color_count ? DEPTH : i],
            .imageLayout = i == p->color_count ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                                               : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
            .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
            .clearValue = clears[i]};
    const VkRenderPassBeginInfo pass = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO, .renderPass = p->pass,
        .framebuffer = p->framebuffer, .renderArea = all, .clearValueCount = p->color_count + 1,
        .pClearValues = clears};
    const VkRenderingInfo rendering = {.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                       .renderArea = all, .layerCount = 1,
                                       .colorAttachmentCount = p->color_count,
                                       .pColorAttachments = attachments,
                                       .pDepthAttachment = &attachments[p->color_count]};
    if (by_pass) {
        d->CmdBeginRenderPass(d->commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    } else {
        for (uint32_t i = 0; i < p->color_count; ++i)
            turn(d, p, (int)i, VK_IMAGE_LAYOUT_UNDEFINED,
                 VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        turn(d, p, DEPTH, VK_IMAGE_LAYOUT_UNDEFINED,
             VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
        d->CmdBeginRendering(d->commands, &rendering);
    }
    d->CmdSetViewport(d->commands, 0, 1, &viewport);
    d->CmdSetScissor(d->commands, 0, 1, &all);
}

static inline void read_image(const device *d, const picture *p, int which)
{
    const bool depth = which == DEPTH;
    const VkBufferImageCopy copy = {
        .bufferOffset = offset_of(which),
        .imageSubresource = {depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, 0, 0,
                             1},
        .imageExtent = {STAGE_WIDTH, STAGE_HEIGHT, 1}};
    turn(d, p, which, depth ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                            : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
         VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    d->CmdCopyImageToBuffer(d->commands, p->images[which], VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                            p->read, 1, &copy);
}

/* All images, the uppermost row first, in p->bytes from offset_of on. */
static inline void end_picture(device *d, const picture *p, bool by_pass)
{
    if (by_pass)
        d->CmdEndRenderPass(d->commands);
    else
        d->CmdEndRendering(d->commands);
    for (uint32_t i = 0; i < p->color_count; ++i)
        read_image(d, p, (int)i);
    read_image(d, p, DEPTH);
    run_commands(d);
}

#endif
