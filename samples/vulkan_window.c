/* Vulkan in a window: an engine's swapchain, two frames in flight, dynamic rendering; or a PNG.
 *
 *   vulkan_window ASSET.gtx [--headless OUT.png] [--size WxH] [--frames N]
 *
 * geotex records into the engine's commands, submits nothing and waits for nothing. --frames ends
 * after so many, and fails where the validation layer has complained. */
#include "host/vulkan_window.h"
#include "image/image.h"

#include <geotex/vulkan.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct engine {
    const char *path, *still;
    int width, height, frames;
    gtx_camera camera;
    gtx_host_vulkan *device;
    gtx_vk *vk;
    gtx_model *model;
    gtx_vk_model *uploaded;
} engine;

/* Prepares the asset on the CPU, and uploads it by commands of the engine's. */
static gtx_result load(engine *e, gtx_error *error)
{
    const gtx_vk_desc desc = {.load = e->device->load, .instance = e->device->instance,
                              .physical_device = e->device->physical, .device = e->device->device,
                              .frames = GTX_VULKAN_FRAMES};
    const gtx_model_desc model = {.first_provokes = 1};
    gtx_asset *asset = NULL;
    gtx_info info;
    gtx_result result = gtx_vk_create(&desc, &e->vk, error);
    if (result || (result = gtx_open_file(e->path, NULL, &asset, error)))
        return result;
    gtx_get_info(asset, &info);
    gtx_camera_frame(&e->camera, info.bounds_min, info.bounds_max);
    result = gtx_model_prepare(asset, &model, &e->model, error);
    gtx_close(asset);
    if (!result)
        result = gtx_host_vulkan_begin(e->device, error);
    if (!result)
        result = gtx_vk_upload(e->vk, e->device->commands, e->model, &e->uploaded, error);
    if (!result)
        result = gtx_host_vulkan_run(e->device, error); /* an engine would go on meanwhile */
    gtx_vk_uploaded(e->vk, e->uploaded);
    return result;
}

static void turn(const engine *e, const gtx_vulkan_frame *f, VkImage image, VkImageLayout from,
                 VkImageLayout to)
{
    const VkImageAspectFlags aspect =
        image == f->depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = from, .newLayout = to, .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = image,
        .subresourceRange = {aspect, 0, 1, 0, 1}};
    const VkPipelineStageFlags stages = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                        VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                        VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
    e->device->CmdPipelineBarrier(f->commands, stages, stages, 0, 0, NULL, 0, NULL, 1, &barrier);
}

/* One frame, into images of any content; what it draws with is used again two frames later. */
static gtx_result record(const engine *e, const gtx_vulkan_frame *f, VkImageLayout leave,
                         gtx_error *error)
{
    const gtx_host_vulkan *v = e->device;
    const VkRect2D all = {{0, 0}, {f->width, f->height}};
    const VkViewport viewport = {0, (float)f->height, (float)f->width, -(float)f->height, 0, 1};
    const VkRenderingAttachmentInfo color = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO, .imageView = f->color_view,
        .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
        .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
        .clearValue.color.float32 = {0.16f, 0.18f, 0.21f, 1}};
    const VkRenderingAttachmentInfo depth = { /* 0 is far: the camera reverses it */
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO, .imageView = f->depth_view,
        .imageLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE};
    const VkRenderingInfo rendering = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_INFO, .renderArea = all, .layerCount = 1,
        .colorAttachmentCount = 1, .pColorAttachments = &color, .pDepthAttachment = &depth};
    const gtx_vk_target target = {.color_count = 1, .color_formats = {f->color_format},
                                  .depth_format = f->depth_format, .y_up = 1};
    gtx_view view = {.light_direction = {0.4f, 0.8f, 0.45f}, .viewport_width = f->width,
                     .viewport_height = f->height,
                     .flags = GTX_VIEW_DEPTH_ZERO_TO_ONE | GTX_VIEW_REVERSED_Z};
    gtx_vk_instance placed = {.model = e->uploaded};
    for (int k = 0; k < 16; k += 5)
        placed.instance.transform[k] = 1;
    gtx_camera_matrices(&e->camera, (float)f->width / (float)f->height, view.view,
                        view.projection);
    turn(e, f, f->color, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    turn(e, f, f->depth, VK_IMAGE_LAYOUT_UNDEFINED,
         VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
    v->CmdBeginRendering(f->commands, &rendering);
    v->CmdSetViewport(f->commands, 0, 1, &viewport);
    v->CmdSetScissor(f->commands, 0, 1, &all);
    gtx_vk_next_frame(e->vk);
    gtx_result result = gtx_vk_draw(e->vk, f->commands, &target, &view, &placed, 1, error);
    v->CmdEndRendering(f->commands);
    if (leave != VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL)
        turn(e, f, f->color, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, leave);
    return result;
}

static void unload(engine *e)
{
    gtx_vk_model_destroy(e->vk, e->uploaded);
    gtx_model_free(e->model);
    gtx_vk_destroy(e->vk);
}

static gtx_result show(engine *e, gtx_error *error)
{
    gtx_vulkan_window *window = NULL;
    gtx_vulkan_frame frame;
    int open = 1, drawn = 0;
    gtx_result result = gtx_vulkan_window_create("vulkan_window", e->width, e->height, &e->camera,
                                                 e->frames > 0, &window, error);
    if (result)
        return result;
    e->device = gtx_vulkan_window_device(window);
    result = load(e, error);
    while (!result && open && (!e->frames || drawn < e->frames)) {
        result = gtx_vulkan_window_begin(window, &frame, &open, error);
        if (result || !frame.width)
            continue;
        result = record(e, &frame, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, error);
        if (!result)
            result = gtx_vulkan_window_end(window, error);
        ++drawn;
    }
    gtx_vulkan_window_wait(window);
    unload(e);
    if (e->device->complaints && !result) {
        result = GTX_ERROR_GL;
        snprintf(error->message, sizeof error->message, "the validation layer has complained");
    }
    gtx_vulkan_window_destroy(window);
    return result;
}

static gtx_result draw_still(engine *e, gtx_error *error)
{
    static gtx_host_vulkan device;
    const gtx_picture_desc desc = {.width = (uint32_t)e->width, .height = (uint32_t)e->height,
                                   .color_count = 1, .colors = {VK_FORMAT_R8G8B8A8_UNORM},
                                   .pixel_size = 4};
    gtx_picture p = {.pass = VK_NULL_HANDLE};
    gtx_result result = gtx_host_vulkan_create(false, &device, error);
    if (result)
        return result;
    e->device = &device;
    result = load(e, error);
    if (!result)
        result = gtx_picture_create(&device, &desc, &p, error);
    if (!result)
        result = gtx_host_vulkan_begin(&device, error);
    const gtx_vulkan_frame frame = {device.commands, p.images[0], p.images[GTX_PICTURE_DEPTH],
                                    p.views[0], p.views[GTX_PICTURE_DEPTH], desc.colors[0],
                                    VK_FORMAT_D32_SFLOAT, desc.width, desc.height};
    if (!result)
        result = record(e, &frame, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, error);
    if (!result) {
        gtx_picture_read(&device, &p);
        result = gtx_host_vulkan_run(&device, error);
    }
    if (!result)
        result = gtx_image_write_png(e->still, desc.width, desc.height, 4,
                                     gtx_picture_bytes(&p, 0), error);
    return result; /* the process ends with it all */
}

int main(int argc, char **argv)
{
    engine e = {.width = 1280, .height = 720,
                .camera = {.azimuth = 30, .elevation = 20, .distance = 2.8f, .reversed_z = 1,
                           .zero_to_one = 1}};
    gtx_error error = {0};
    int bad = 0;
    for (int i = 1; i < argc; ++i)
        if (!strcmp(argv[i], "--headless") && i + 1 < argc)
            e.still = argv[++i];
        else if (!strcmp(argv[i], "--size") && i + 1 < argc)
            bad |= sscanf(argv[++i], "%dx%d", &e.width, &e.height) != 2;
        else if (!strcmp(argv[i], "--frames") && i + 1 < argc)
            bad |= (e.frames = atoi(argv[++i])) < 1;
        else if (argv[i][0] == '-' || e.path)
            bad = 1;
        else
            e.path = argv[i];
    if (bad || !e.path || e.width < 1 || e.height < 1 || e.width > 8192 || e.height > 8192) {
        fprintf(stderr, "usage: vulkan_window ASSET.gtx [--headless OUT.png] [--size WxH] "
                        "[--frames N]\n");
        return 1;
    }
    if (e.still ? draw_still(&e, &error) : show(&e, &error)) {
        fprintf(stderr, "vulkan_window: %s\n", error.message);
        return 1;
    }
    return 0;
}
