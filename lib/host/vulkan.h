/* A Vulkan device without a window, found at run time, and pictures that are drawn with it. Built
 * where Vulkan's headers are. */
#ifndef GTX_HOST_VULKAN_H
#define GTX_HOST_VULKAN_H

#include <geotex/geotex.h>
#include <stdbool.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GTX_HOST_VULKAN(X)                                                                         \
    X(AllocateCommandBuffers) X(AllocateMemory) X(BeginCommandBuffer) X(BindBufferMemory)          \
    X(BindImageMemory) X(CmdBeginRenderPass) X(CmdCopyImageToBuffer) X(CmdEndRenderPass)           \
    X(CmdPipelineBarrier) X(CmdSetScissor) X(CmdSetViewport) X(CreateBuffer) X(CreateCommandPool)  \
    X(CreateFramebuffer) X(CreateImage) X(CreateImageView) X(CreateRenderPass) X(DestroyBuffer)    \
    X(DestroyCommandPool) X(DestroyDevice) X(DestroyFramebuffer) X(DestroyImage)                   \
    X(DestroyImageView) X(DestroyRenderPass) X(EndCommandBuffer) X(FreeMemory)                     \
    X(GetBufferMemoryRequirements) X(GetDeviceQueue) X(GetImageMemoryRequirements) X(MapMemory)    \
    X(QueueSubmit) X(QueueWaitIdle) X(ResetCommandPool)

/* One queue, and one command buffer that is recorded, executed and waited for in turn. */
typedef struct gtx_host_vulkan {
    void *library;
    PFN_vkGetInstanceProcAddr load;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer commands;
#define GTX_HOST_VULKAN_FIELD(name) PFN_vk##name name;
    GTX_HOST_VULKAN(GTX_HOST_VULKAN_FIELD)
#undef GTX_HOST_VULKAN_FIELD
    PFN_vkCmdBeginRenderingKHR CmdBeginRendering;
    PFN_vkCmdEndRenderingKHR CmdEndRendering;
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    bool validated;           /* by the layer, whose complaints are counted and go to stderr */
    bool renders;             /* without passes: Vulkan 1.3 */
    bool by_samples;          /* has sampleRateShading */
    bool multiview;
    int complaints;
} gtx_host_vulkan;

/* The first device, which the environment may choose (VK_ICD_FILENAMES). `validate`: with the
 * validation layer, where it is installed. `out` must stay where it is. Errors: GL. */
gtx_result gtx_host_vulkan_create(bool validate, gtx_host_vulkan *out, gtx_error *error);
typedef struct gtx_host_vulkan_desc {
    bool validate;
    bool shows;               /* in windows: VK_KHR_swapchain */
    const char *const *extensions; /* of the instance, at most 8 */
    uint32_t extension_count;
} gtx_host_vulkan_desc;
gtx_result gtx_host_vulkan_open(const gtx_host_vulkan_desc *desc, gtx_host_vulkan *out,
                                gtx_error *error);
void gtx_host_vulkan_destroy(gtx_host_vulkan *vulkan);
/* Begins to record; and executes what was recorded, and waits for it. Errors: GL. */
gtx_result gtx_host_vulkan_begin(gtx_host_vulkan *vulkan, gtx_error *error);
gtx_result gtx_host_vulkan_run(gtx_host_vulkan *vulkan, gtx_error *error);

/* vulkan_picture.c: memory of the kind. */
bool gtx_host_vulkan_memory(const gtx_host_vulkan *vulkan, const VkMemoryRequirements *needs,
                            VkMemoryPropertyFlags wanted, VkDeviceMemory *out);

enum { GTX_PICTURE_COLORS = 4, GTX_PICTURE_DEPTH = 4, GTX_PICTURE_IMAGES = 9 };

typedef struct gtx_picture_desc {
    uint32_t width, height;
    uint32_t color_count;     /* at most GTX_PICTURE_COLORS */
    VkFormat colors[GTX_PICTURE_COLORS];
    uint32_t pixel_size;      /* bytes of a pixel of each colour, at most 16 */
    VkSampleCountFlagBits samples; /* 0 = 1 */
    uint32_t views;           /* drawn at once, into a layer each; 0 = 1 */
} gtx_picture_desc;

/* Colours and a depth of D32_SFLOAT, and a mapped buffer that they are read into. Of several
 * samples, colours are averaged, and depth is not read. */
typedef struct gtx_picture {
    gtx_picture_desc desc;
    uint32_t attachments;     /* of the pass */
    /* Colours; depth; colours of several samples. */
    VkImage images[GTX_PICTURE_IMAGES];
    VkImageView views[GTX_PICTURE_IMAGES];
    VkDeviceMemory memories[GTX_PICTURE_IMAGES], read_memory;
    VkBuffer read;
    VkRenderPass pass;
    VkFramebuffer framebuffer;
    uint8_t *bytes;
} gtx_picture;

/* Errors: GL. What was made is there to be destroyed after one, too. */
gtx_result gtx_picture_create(const gtx_host_vulkan *vulkan, const gtx_picture_desc *desc,
                              gtx_picture *out, gtx_error *error);
void gtx_picture_destroy(const gtx_host_vulkan *vulkan, gtx_picture *picture);

typedef struct gtx_picture_clear {
    float color[4], depth;
} gtx_picture_clear;

/* Begins to draw, by the picture's render pass or by dynamic rendering; `y_up`: clip y is up, as in
 * OpenGL. */
void gtx_picture_begin(const gtx_host_vulkan *vulkan, const gtx_picture *picture, bool by_pass,
                       bool y_up, const gtx_picture_clear *clear);
void gtx_picture_end(const gtx_host_vulkan *vulkan, const gtx_picture *picture, bool by_pass);
/* Records that the images are read, once drawing has ended: rows from the top, in
 * gtx_picture_bytes once that is executed. */
void gtx_picture_read(const gtx_host_vulkan *vulkan, const gtx_picture *picture);
/* Of a colour, or of GTX_PICTURE_DEPTH: floats. Views follow one another. */
const void *gtx_picture_bytes(const gtx_picture *picture, int which);

#ifdef __cplusplus
}
#endif
#endif
