/* A GLFW window that Vulkan shows pictures in: its device, swapchain, depth and frames in flight.
 * Built where Vulkan's headers are. */
#ifndef GTX_HOST_VULKAN_WINDOW_H
#define GTX_HOST_VULKAN_WINDOW_H

#include "host/vulkan.h"
#include "host/window.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { GTX_VULKAN_FRAMES = 2 };   /* recorded or executed at once */

typedef struct gtx_vulkan_window gtx_vulkan_window;

/* Opens a window as gtx_window_create does, and a device that shows pictures in it, with dynamic
 * rendering. `validate` is as in gtx_host_vulkan_create. Errors: MEMORY, GL. */
gtx_result gtx_vulkan_window_create(const char *title, int width, int height, gtx_camera *camera,
                                    bool validate, gtx_vulkan_window **out, gtx_error *error);
/* Waits for all that is in execution first, as gtx_vulkan_window_wait does. */
void gtx_vulkan_window_destroy(gtx_vulkan_window *window);
void gtx_vulkan_window_wait(gtx_vulkan_window *window);
gtx_host_vulkan *gtx_vulkan_window_device(gtx_vulkan_window *window);

/* What is drawn into: colour and depth without a known content or layout, and commands that are
 * being recorded. Width and height are 0 while there is nothing to draw. */
typedef struct gtx_vulkan_frame {
    VkCommandBuffer commands;
    VkImage color, depth;
    VkImageView color_view, depth_view;
    VkFormat color_format, depth_format;
    uint32_t width, height;
} gtx_vulkan_frame;

/* Takes input, waits until the frame before the last one has been executed, and begins another.
 * *open becomes 0 once the window wants to close. Errors: GL. */
gtx_result gtx_vulkan_window_begin(gtx_vulkan_window *window, gtx_vulkan_frame *out, int *open,
                                   gtx_error *error);
/* Executes the frame's commands, which leave its colour in the layout PRESENT_SRC_KHR, and shows
 * it. Errors: GL. */
gtx_result gtx_vulkan_window_end(gtx_vulkan_window *window, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
