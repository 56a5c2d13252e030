/* Pictures that Vulkan draws, by a render pass or dynamic rendering, of one sample or several. */
#include "host/vulkan.h"

#include "base/error.h"

#include <string.h>

enum { MAX_BYTES = 16, SAMPLED = GTX_PICTURE_DEPTH + 1 };

static bool is_depth(int which)
{
    return which == GTX_PICTURE_DEPTH;
}

static VkImageLayout layout_of(int which)
{
    return is_depth(which) ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                           : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
}

static VkImageAspectFlags aspect_of(int which)
{
    return is_depth(which) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

static VkFormat format_of(const gtx_picture *p, int which)
{
    return is_depth(which) ? VK_FORMAT_D32_SFLOAT
                           : p->desc.colors[which >= SAMPLED ? which - SAMPLED : which];
}

static bool has_samples(const gtx_picture *p)
{
    return p->desc.samples > VK_SAMPLE_COUNT_1_BIT;
}

/* What a colour is drawn into. */
static int drawn(const gtx_picture *p, uint32_t color)
{
    return (int)color + (has_samples(p) ? SAMPLED : 0);
}

bool gtx_host_vulkan_memory(const gtx_host_vulkan *v, const VkMemoryRequirements *needs,
                            VkMemoryPropertyFlags wanted, VkDeviceMemory *out)
{
    VkPhysicalDeviceMemoryProperties p;
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                 .allocationSize = needs->size};
    ((PFN_vkGetPhysicalDeviceMemoryProperties)v->load(
        v->instance, "vkGetPhysicalDeviceMemoryProperties"))(v->physical, &p);
    uint32_t i = 0;
    while (i < p.memoryTypeCount && (!(needs->memoryTypeBits >> i & 1) ||
                                     (p.memoryTypes[i].propertyFlags & wanted) != wanted))
        ++i;
    info.memoryTypeIndex = i;
    return i < p.memoryTypeCount && !v->AllocateMemory(v->device, &info, NULL, out);
}

static bool make_image(const gtx_host_vulkan *v, gtx_picture *p, int which)
{
    const bool sampled = has_samples(p) && (which >= SAMPLED || is_depth(which));
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
        .format = format_of(p, which), .extent = {p->desc.width, p->desc.height, 1},
        .mipLevels = 1, .arrayLayers = p->desc.views,
        .samples = sampled ? p->desc.samples : VK_SAMPLE_COUNT_1_BIT,
        .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 (is_depth(which) ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                  : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT)};
    VkMemoryRequirements needs;
    if (v->CreateImage(v->device, &info, NULL, &p->images[which]))
        return false;
    v->GetImageMemoryRequirements(v->device, p->images[which], &needs);
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = p->images[which],
        .viewType = p->desc.views > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
        .format = format_of(p, which),
        .subresourceRange = {aspect_of(which), 0, 1, 0, p->desc.views}};
    return gtx_host_vulkan_memory(v, &needs, 0, &p->memories[which]) &&
           !v->BindImageMemory(v->device, p->images[which], p->memories[which], 0) &&
           !v->CreateImageView(v->device, &view, NULL, &p->views[which]);
}

static size_t offset_of(const gtx_picture *p, int which)
{
    return (size_t)which * MAX_BYTES * p->desc.width * p->desc.height * p->desc.views;
}

static bool make_read_buffer(const gtx_host_vulkan *v, gtx_picture *p)
{
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = offset_of(p, SAMPLED),
                                     .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    const VkMemoryPropertyFlags mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkMemoryRequirements needs;
    void *bytes;
    if (v->CreateBuffer(v->device, &info, NULL, &p->read))
        return false;
    v->GetBufferMemoryRequirements(v->device, p->read, &needs);
    if (!gtx_host_vulkan_memory(v, &needs, mapped, &p->read_memory) ||
        v->BindBufferMemory(v->device, p->read, p->read_memory, 0) ||
        v->MapMemory(v->device, p->read_memory, 0, VK_WHOLE_SIZE, 0, &bytes))
        return false;
    p->bytes = bytes;
    return true;
}

/* Attachments: what colours are drawn into, depth, and what samples are averaged into. */
static int attachment(const gtx_picture *p, uint32_t i)
{
    const uint32_t colors = p->desc.color_count;
    return i < colors ? drawn(p, i) : i == colors ? GTX_PICTURE_DEPTH : (int)(i - colors - 1);
}

static bool make_pass(const gtx_host_vulkan *v, gtx_picture *p)
{
    VkAttachmentDescription attachments[GTX_PICTURE_IMAGES];
    VkAttachmentReference references[GTX_PICTURE_IMAGES];
    VkImageView views[GTX_PICTURE_IMAGES];
    const uint32_t colors = p->desc.color_count;
    for (uint32_t i = 0; i < p->attachments; ++i) {
        const int which = attachment(p, i);
        const bool averaged = i > colors;
        views[i] = p->views[which];
        references[i] = (VkAttachmentReference){i, layout_of(which)};
        attachments[i] = (VkAttachmentDescription){
            .format = format_of(p, which),
            .samples = has_samples(p) && !averaged ? p->desc.samples : VK_SAMPLE_COUNT_1_BIT,
            .loadOp = averaged ? VK_ATTACHMENT_LOAD_OP_DONT_CARE : VK_ATTACHMENT_LOAD_OP_CLEAR,
            .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
            .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
            .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
            .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED, .finalLayout = layout_of(which)};
    }
    const VkSubpassDescription subpass = {
        .colorAttachmentCount = colors, .pColorAttachments = references,
        .pResolveAttachments = has_samples(p) ? references + colors + 1 : NULL,
        .pDepthStencilAttachment = &references[colors]};
    const uint32_t mask = (1u << p->desc.views) - 1;
    const VkRenderPassMultiviewCreateInfo views_of = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_MULTIVIEW_CREATE_INFO, .subpassCount = 1,
        .pViewMasks = &mask};
    const VkRenderPassCreateInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                         .pNext = p->desc.views > 1 ? &views_of : NULL,
                                         .attachmentCount = p->attachments,
                                         .pAttachments = attachments, .subpassCount = 1,
                                         .pSubpasses = &subpass};
    VkFramebufferCreateInfo framebuffer = {
        .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
        .attachmentCount = p->attachments, .pAttachments = views, .width = p->desc.width,
        .height = p->desc.height, .layers = 1};
    if (v->CreateRenderPass(v->device, &pass, NULL, &p->pass))
        return false;
    framebuffer.renderPass = p->pass;
    return !v->CreateFramebuffer(v->device, &framebuffer, NULL, &p->framebuffer);
}

gtx_result gtx_picture_create(const gtx_host_vulkan *v, const gtx_picture_desc *desc,
                              gtx_picture *out, gtx_error *error)
{
    memset(out, 0, sizeof *out);
    out->desc = *desc;
    if (!out->desc.samples)
        out->desc.samples = VK_SAMPLE_COUNT_1_BIT;
    if (!out->desc.views)
        out->desc.views = 1;
    out->attachments = desc->color_count + 1 + (has_samples(out) ? desc->color_count : 0);
    bool made = make_image(v, out, GTX_PICTURE_DEPTH);
    for (uint32_t i = 0; i < desc->color_count; ++i) {
        made = made && make_image(v, out, (int)i);
        if (has_samples(out))
            made = made && make_image(v, out, drawn(out, i));
    }
    return made && make_read_buffer(v, out) && make_pass(v, out)
               ? GTX_OK
               : gtx_fail(error, GTX_ERROR_GL, "a picture of %u x %u cannot be made", desc->width,
                          desc->height);
}

void gtx_picture_destroy(const gtx_host_vulkan *v, gtx_picture *p)
{
    v->DestroyFramebuffer(v->device, p->framebuffer, NULL);
    v->DestroyRenderPass(v->device, p->pass, NULL);
    v->DestroyBuffer(v->device, p->read, NULL);
    v->FreeMemory(v->device, p->read_memory, NULL);
    for (int i = 0; i < GTX_PICTURE_IMAGES; ++i) {
        v->DestroyImageView(v->device, p->views[i], NULL);
        v->DestroyImage(v->device, p->images[i], NULL);
        v->FreeMemory(v->device, p->memories[i], NULL);
    }
    memset(p, 0, sizeof *p);
}

static void turn(const gtx_host_vulkan *v, const gtx_picture *p, int which, VkImageLayout from,
                 VkImageLayout to)
{
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = from, .newLayout = to, .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = p->images[which],
        .subresourceRange = {aspect_of(which), 0, 1, 0, p->desc.views}};
    v->CmdPipelineBarrier(v->commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                          VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

static void begin_rendering(const gtx_host_vulkan *v, const gtx_picture *p, VkRect2D all,
                            const VkClearValue *clears)
{
    VkRenderingAttachmentInfo attachments[GTX_PICTURE_IMAGES];
    const uint32_t colors = p->desc.color_count;
    for (uint32_t i = 0; i < p->attachments; ++i)
        turn(v, p, attachment(p, i), VK_IMAGE_LAYOUT_UNDEFINED, layout_of(attachment(p, i)));
    for (uint32_t i = 0; i <= colors; ++i) {
        const bool averages = has_samples(p) && i < colors;
        attachments[i] = (VkRenderingAttachmentInfo){
            .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
            .imageView = p->views[attachment(p, i)], .imageLayout = layout_of(attachment(p, i)),
            .resolveMode = averages ? VK_RESOLVE_MODE_AVERAGE_BIT : VK_RESOLVE_MODE_NONE,
            .resolveImageView = averages ? p->views[i] : VK_NULL_HANDLE,
            .resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
            .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
            .clearValue = clears[i]};
    }
    const VkRenderingInfo rendering = {.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                       .renderArea = all, .layerCount = 1,
                                       .viewMask = p->desc.views > 1 ? (1u << p->desc.views) - 1
                                                                     : 0,
                                       .colorAttachmentCount = colors,
                                       .pColorAttachments = attachments,
                                       .pDepthAttachment = &attachments[colors]};
    v->CmdBeginRendering(v->commands, &rendering);
}

void gtx_picture_begin(const gtx_host_vulkan *v, const gtx_picture *p, bool by_pass, bool y_up,
                       const gtx_picture_clear *clear)
{
    const VkRect2D all = {{0, 0}, {p->desc.width, p->desc.height}};
    const float height = (float)p->desc.height;
    const VkViewport viewport = {0, y_up ? height : 0, (float)p->desc.width,
                                 y_up ? -height : height, 0, 1};
    VkClearValue clears[GTX_PICTURE_IMAGES];
    memset(clears, 0, sizeof clears);
    for (uint32_t i = 0; i < p->desc.color_count; ++i)
        memcpy(clears[i].color.float32, clear->color, sizeof clear->color);
    clears[p->desc.color_count].depthStencil.depth = clear->depth;
    const VkRenderPassBeginInfo pass = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO, .renderPass = p->pass,
        .framebuffer = p->framebuffer, .renderArea = all, .clearValueCount = p->attachments,
        .pClearValues = clears};
    if (by_pass)
        v->CmdBeginRenderPass(v->commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    else
        begin_rendering(v, p, all, clears);
    v->CmdSetViewport(v->commands, 0, 1, &viewport);
    v->CmdSetScissor(v->commands, 0, 1, &all);
}

void gtx_picture_end(const gtx_host_vulkan *v, const gtx_picture *p, bool by_pass)
{
    (void)p;
    if (by_pass)
        v->CmdEndRenderPass(v->commands);
    else
        v->CmdEndRendering(v->commands);
}

static void read_image(const gtx_host_vulkan *v, const gtx_picture *p, int which)
{
    const VkBufferImageCopy copy = {.bufferOffset = offset_of(p, which),
                                    .imageSubresource = {aspect_of(which), 0, 0, p->desc.views},
                                    .imageExtent = {p->desc.width, p->desc.height, 1}};
    turn(v, p, which, layout_of(which), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    v->CmdCopyImageToBuffer(v->commands, p->images[which], VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                            p->read, 1, &copy);
}

void gtx_picture_read(const gtx_host_vulkan *v, const gtx_picture *p)
{
    for (uint32_t i = 0; i < p->desc.color_count; ++i)
        read_image(v, p, (int)i);
    if (!has_samples(p))
        read_image(v, p, GTX_PICTURE_DEPTH);
}

const void *gtx_picture_bytes(const gtx_picture *p, int which)
{
    return p->bytes + offset_of(p, which);
}
