/* A window of Vulkan's: surface, swapchain, depth, and two frames in flight. */
#include "host/vulkan_window.h"

#include "base/error.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <stdlib.h>
#include <string.h>

/* Those of GLFW that need Vulkan's header. */
VkResult glfwCreateWindowSurface(VkInstance instance, GLFWwindow *window,
                                 const VkAllocationCallbacks *allocator, VkSurfaceKHR *surface);

enum { IMAGES = 8 };

#define OF_DEVICE(X)                                                                               \
    X(AcquireNextImageKHR) X(CreateFence) X(CreateSemaphore) X(CreateSwapchainKHR)                 \
    X(DestroyFence) X(DestroySemaphore) X(DestroySwapchainKHR) X(DeviceWaitIdle)                   \
    X(GetSwapchainImagesKHR) X(QueuePresentKHR) X(ResetFences) X(WaitForFences)
#define OF_INSTANCE(X)                                                                             \
    X(DestroySurfaceKHR) X(GetDeviceProcAddr) X(GetPhysicalDeviceSurfaceCapabilitiesKHR)           \
    X(GetPhysicalDeviceSurfaceFormatsKHR) X(GetPhysicalDeviceSurfaceSupportKHR)

/* Recorded again once its fence says that it has been executed. */
typedef struct flight {
    VkCommandPool pool;
    VkCommandBuffer commands;
    VkFence executed;
    VkSemaphore acquired;
} flight;

struct gtx_vulkan_window {
    gtx_window *window;
    gtx_host_vulkan device;
    VkSurfaceKHR surface;
    VkSwapchainKHR swapchain;
    VkSurfaceFormatKHR format;
    uint32_t width, height, image_count, image;
    VkImage images[IMAGES], depth;
    VkImageView views[IMAGES], depth_view;
    VkSemaphore drawn[IMAGES];
    VkDeviceMemory depth_memory;
    flight flights[GTX_VULKAN_FRAMES];
    uint32_t frame;
#define FIELD(name) PFN_vk##name name;
    OF_DEVICE(FIELD) OF_INSTANCE(FIELD)
#undef FIELD
};

static gtx_result load(gtx_vulkan_window *w, bool validate, gtx_error *error)
{
    gtx_host_vulkan *v = &w->device;
    gtx_host_vulkan_desc desc = {.validate = validate, .shows = true};
    desc.extensions = glfwGetRequiredInstanceExtensions(&desc.extension_count);
    if (!desc.extensions)
        return gtx_fail(error, GTX_ERROR_GL, "Vulkan shows nothing on this display");
    gtx_result result = gtx_host_vulkan_open(&desc, v, error);
    if (result)
        return result;
    bool all = v->renders;
#define LOAD(name) all = (w->name = (PFN_vk##name)v->load(v->instance, "vk" #name)) && all;
    OF_INSTANCE(LOAD)
#undef LOAD
#define LOAD(name) all = all && (w->name = (PFN_vk##name)w->GetDeviceProcAddr(v->device,           \
                                                                              "vk" #name));
    OF_DEVICE(LOAD)
#undef LOAD
    return all ? GTX_OK
               : gtx_fail(error, GTX_ERROR_GL, "%s has no dynamic rendering into windows", v->name);
}

static gtx_result open_surface(gtx_vulkan_window *w, gtx_error *error)
{
    const gtx_host_vulkan *v = &w->device;
    VkSurfaceFormatKHR formats[64];
    uint32_t count = 64;
    VkBool32 shows = VK_FALSE;
    if (glfwCreateWindowSurface(v->instance, gtx_window_glfw(w->window), NULL, &w->surface) ||
        w->GetPhysicalDeviceSurfaceSupportKHR(v->physical, 0, w->surface, &shows) || !shows ||
        w->GetPhysicalDeviceSurfaceFormatsKHR(v->physical, w->surface, &count, formats) < 0 ||
        !count)
        return gtx_fail(error, GTX_ERROR_GL, "%s cannot show pictures on this display", v->name);
    w->format = formats[0];
    for (uint32_t i = 0; i < count; ++i) /* colours are written in sRGB: not to be encoded again */
        if (formats[i].format == VK_FORMAT_B8G8R8A8_UNORM ||
            formats[i].format == VK_FORMAT_R8G8B8A8_UNORM)
            w->format = formats[i];
    return GTX_OK;
}

static gtx_result open_flights(gtx_vulkan_window *w, gtx_error *error)
{
    const gtx_host_vulkan *v = &w->device;
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                     .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    const VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    bool all = true;
    for (flight *f = w->flights; f < w->flights + GTX_VULKAN_FRAMES && all; ++f) {
        all = !v->CreateCommandPool(v->device, &pool, NULL, &f->pool);
        const VkCommandBufferAllocateInfo commands = {
            .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = f->pool,
            .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY, .commandBufferCount = 1};
        all = all && !v->AllocateCommandBuffers(v->device, &commands, &f->commands) &&
              !w->CreateFence(v->device, &fence, NULL, &f->executed) &&
              !w->CreateSemaphore(v->device, &semaphore, NULL, &f->acquired);
    }
    for (uint32_t i = 0; i < IMAGES && all; ++i)
        all = !w->CreateSemaphore(v->device, &semaphore, NULL, &w->drawn[i]);
    return all ? GTX_OK : gtx_fail(error, GTX_ERROR_GL, "%s makes no frames", v->name);
}

static void close_images(gtx_vulkan_window *w)
{
    const gtx_host_vulkan *v = &w->device;
    for (uint32_t i = 0; i < w->image_count; ++i)
        v->DestroyImageView(v->device, w->views[i], NULL);
    v->DestroyImageView(v->device, w->depth_view, NULL);
    v->DestroyImage(v->device, w->depth, NULL);
    v->FreeMemory(v->device, w->depth_memory, NULL);
    memset(w->views, 0, sizeof w->views);
    w->depth_view = VK_NULL_HANDLE;
    w->depth = VK_NULL_HANDLE;
    w->depth_memory = VK_NULL_HANDLE;
    w->image_count = 0;
}

static bool make_view(const gtx_host_vulkan *v, VkImage image, VkFormat format,
                      VkImageAspectFlags aspect, VkImageView *out)
{
    const VkImageViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = format,
        .subresourceRange = {aspect, 0, 1, 0, 1}};
    return !v->CreateImageView(v->device, &info, NULL, out);
}

static bool make_depth(gtx_vulkan_window *w)
{
    const gtx_host_vulkan *v = &w->device;
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
        .format = VK_FORMAT_D32_SFLOAT, .extent = {w->width, w->height, 1}, .mipLevels = 1,
        .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT,
        .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT};
    VkMemoryRequirements needs;
    if (v->CreateImage(v->device, &info, NULL, &w->depth))
        return false;
    v->GetImageMemoryRequirements(v->device, w->depth, &needs);
    return gtx_host_vulkan_memory(v, &needs, 0, &w->depth_memory) &&
           !v->BindImageMemory(v->device, w->depth, w->depth_memory, 0) &&
           make_view(v, w->depth, VK_FORMAT_D32_SFLOAT, VK_IMAGE_ASPECT_DEPTH_BIT, &w->depth_view);
}

/* Images of the window's size, in place of those of another. */
static gtx_result open_images(gtx_vulkan_window *w, gtx_error *error)
{
    const gtx_host_vulkan *v = &w->device;
    const VkSwapchainKHR old = w->swapchain;
    VkSurfaceCapabilitiesKHR can;
    w->DeviceWaitIdle(v->device);
    close_images(w);
    if (w->GetPhysicalDeviceSurfaceCapabilitiesKHR(v->physical, w->surface, &can))
        return gtx_fail(error, GTX_ERROR_GL, "the window's surface is lost");
    if (can.currentExtent.width != UINT32_MAX) {
        w->width = can.currentExtent.width;
        w->height = can.currentExtent.height;
    }
    uint32_t least = can.minImageCount + 1;
    if (can.maxImageCount && least > can.maxImageCount)
        least = can.maxImageCount;
    const VkSwapchainCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR, .surface = w->surface,
        .minImageCount = least, .imageFormat = w->format.format,
        .imageColorSpace = w->format.colorSpace, .imageExtent = {w->width, w->height},
        .imageArrayLayers = 1, .imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
        .preTransform = can.currentTransform, .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        .presentMode = VK_PRESENT_MODE_FIFO_KHR, .clipped = VK_TRUE, .oldSwapchain = old};
    const VkResult made = w->CreateSwapchainKHR(v->device, &info, NULL, &w->swapchain);
    w->DestroySwapchainKHR(v->device, old, NULL);
    if (made) {
        w->swapchain = VK_NULL_HANDLE;
        return gtx_fail(error, GTX_ERROR_GL, "vkCreateSwapchainKHR failed (VkResult %d)", made);
    }
    w->image_count = IMAGES;
    bool all = !w->GetSwapchainImagesKHR(v->device, w->swapchain, &w->image_count, w->images);
    for (uint32_t i = 0; i < w->image_count; ++i)
        all = all && make_view(v, w->images[i], w->format.format, VK_IMAGE_ASPECT_COLOR_BIT,
                               &w->views[i]);
    return all && make_depth(w)
               ? GTX_OK
               : gtx_fail(error, GTX_ERROR_GL, "there are no images for the window");
}

gtx_result gtx_vulkan_window_create(const char *title, int width, int height, gtx_camera *camera,
                                    bool validate, gtx_vulkan_window **out, gtx_error *error)
{
    *out = NULL;
    gtx_vulkan_window *w = calloc(1, sizeof *w);
    if (!w)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory");
    gtx_result result = gtx_window_create_bare(title, width, height, camera, &w->window, error);
    if (!result)
        result = load(w, validate, error);
    if (!result)
        result = open_surface(w, error);
    if (!result)
        result = open_flights(w, error);
    if (result)
        gtx_vulkan_window_destroy(w);
    else
        *out = w;
    return result;
}

void gtx_vulkan_window_wait(gtx_vulkan_window *w)
{
    w->DeviceWaitIdle(w->device.device);
}

void gtx_vulkan_window_destroy(gtx_vulkan_window *w)
{
    if (!w)
        return;
    gtx_host_vulkan *v = &w->device;
    if (v->device && w->DeviceWaitIdle) {
        w->DeviceWaitIdle(v->device);
        close_images(w);
        w->DestroySwapchainKHR(v->device, w->swapchain, NULL);
        for (flight *f = w->flights; f < w->flights + GTX_VULKAN_FRAMES; ++f) {
            v->DestroyCommandPool(v->device, f->pool, NULL);
            w->DestroyFence(v->device, f->executed, NULL);
            w->DestroySemaphore(v->device, f->acquired, NULL);
        }
        for (uint32_t i = 0; i < IMAGES; ++i)
            w->DestroySemaphore(v->device, w->drawn[i], NULL);
        w->DestroySurfaceKHR(v->instance, w->surface, NULL);
    }
    gtx_host_vulkan_destroy(v);
    gtx_window_destroy(w->window);
    free(w);
}

gtx_host_vulkan *gtx_vulkan_window_device(gtx_vulkan_window *w)
{
    return &w->device;
}

/* An image to draw into, of the window's size; makes images anew where that has changed. */
static gtx_result acquire(gtx_vulkan_window *w, uint32_t width, uint32_t height, gtx_error *error)
{
    const gtx_host_vulkan *v = &w->device;
    VkResult result = VK_ERROR_OUT_OF_DATE_KHR;
    for (int tries = 0; tries < 3 && result == VK_ERROR_OUT_OF_DATE_KHR; ++tries) {
        if (tries || !w->swapchain || width != w->width || height != w->height) {
            w->width = width;
            w->height = height;
            gtx_result failed = open_images(w, error);
            if (failed)
                return failed;
        }
        result = w->AcquireNextImageKHR(v->device, w->swapchain, UINT64_MAX,
                                        w->flights[w->frame].acquired, VK_NULL_HANDLE, &w->image);
    }
    return result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR
               ? GTX_OK
               : gtx_fail(error, GTX_ERROR_GL, "vkAcquireNextImageKHR failed (VkResult %d)",
                          result);
}

gtx_result gtx_vulkan_window_begin(gtx_vulkan_window *w, gtx_vulkan_frame *out, int *open,
                                   gtx_error *error)
{
    const gtx_host_vulkan *v = &w->device;
    const VkCommandBufferBeginInfo begin = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    int width, height;
    memset(out, 0, sizeof *out);
    *open = gtx_window_next(w->window, &width, &height);
    if (!*open || width <= 0 || height <= 0)
        return GTX_OK;
    w->frame = (w->frame + 1) % GTX_VULKAN_FRAMES;
    const flight *f = &w->flights[w->frame];
    if (w->WaitForFences(v->device, 1, &f->executed, VK_TRUE, UINT64_MAX))
        return gtx_fail(error, GTX_ERROR_GL, "vkWaitForFences failed");
    gtx_result result = acquire(w, (uint32_t)width, (uint32_t)height, error);
    if (result)
        return result;
    if (w->ResetFences(v->device, 1, &f->executed) ||
        v->ResetCommandPool(v->device, f->pool, 0) || v->BeginCommandBuffer(f->commands, &begin))
        return gtx_fail(error, GTX_ERROR_GL, "vkBeginCommandBuffer failed");
    *out = (gtx_vulkan_frame){f->commands, w->images[w->image], w->depth, w->views[w->image],
                              w->depth_view, w->format.format, VK_FORMAT_D32_SFLOAT, w->width,
                              w->height};
    return GTX_OK;
}

gtx_result gtx_vulkan_window_end(gtx_vulkan_window *w, gtx_error *error)
{
    static const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    const gtx_host_vulkan *v = &w->device;
    const flight *f = &w->flights[w->frame];
    const VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .waitSemaphoreCount = 1,
        .pWaitSemaphores = &f->acquired, .pWaitDstStageMask = &stage, .commandBufferCount = 1,
        .pCommandBuffers = &f->commands, .signalSemaphoreCount = 1,
        .pSignalSemaphores = &w->drawn[w->image]};
    const VkPresentInfoKHR present = {
        .sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR, .waitSemaphoreCount = 1,
        .pWaitSemaphores = &w->drawn[w->image], .swapchainCount = 1,
        .pSwapchains = &w->swapchain, .pImageIndices = &w->image};
    if (v->EndCommandBuffer(f->commands) || v->QueueSubmit(v->queue, 1, &submit, f->executed))
        return gtx_fail(error, GTX_ERROR_GL, "the commands cannot be executed");
    const VkResult result = w->QueuePresentKHR(v->queue, &present);
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR)
        w->width = 0; /* made anew by the next frame */
    return result >= 0 || result == VK_ERROR_OUT_OF_DATE_KHR
               ? GTX_OK
               : gtx_fail(error, GTX_ERROR_GL, "vkQueuePresentKHR failed (VkResult %d)", result);
}
