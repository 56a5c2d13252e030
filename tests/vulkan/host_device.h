/* A Vulkan device for tests, found at run time, with the validation layer where it is installed. */
#ifndef GTX_TESTS_VULKAN_HOST_DEVICE_H
#define GTX_TESTS_VULKAN_HOST_DEVICE_H

#include "render/lods.h"

#include <dlfcn.h>
#include <geotex/vulkan.h>
#include <stdbool.h>

#define DEVICE_FUNCTIONS(X)                                                                        \
    X(AllocateCommandBuffers) X(AllocateMemory) X(BeginCommandBuffer) X(BindBufferMemory)          \
    X(BindImageMemory) X(CmdBeginRenderPass) X(CmdCopyImageToBuffer) X(CmdEndRenderPass)           \
    X(CmdPipelineBarrier) X(CmdSetScissor) X(CmdSetViewport) X(CreateBuffer) X(CreateCommandPool)  \
    X(CreateFramebuffer) X(CreateImage) X(CreateImageView) X(CreateRenderPass) X(DestroyBuffer)    \
    X(DestroyCommandPool) X(DestroyDevice) X(DestroyFramebuffer) X(DestroyImage)                   \
    X(DestroyImageView) X(DestroyRenderPass) X(EndCommandBuffer) X(FreeMemory)                     \
    X(GetBufferMemoryRequirements) X(GetDeviceQueue) X(GetImageMemoryRequirements) X(MapMemory)    \
    X(QueueSubmit) X(QueueWaitIdle) X(ResetCommandPool)

typedef struct device {
    void *library;
    PFN_vkGetInstanceProcAddr load;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer commands;
#define DEVICE_FIELD(name) PFN_vk##name name;
    DEVICE_FUNCTIONS(DEVICE_FIELD)
    bool validated, renders;      /* by the layer; without passes */
    int complaints;
    PFN_vkCmdBeginRenderingKHR CmdBeginRendering;
    PFN_vkCmdEndRenderingKHR CmdEndRendering;
} device;

static inline VkBool32 VKAPI_PTR complain(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                          VkDebugUtilsMessageTypeFlagsEXT type,
                                          const VkDebugUtilsMessengerCallbackDataEXT *data,
                                          void *user)
{
    (void)severity, (void)type;
    /* Any output of a pass may be left out. */
    if (data->pMessageIdName && strstr(data->pMessageIdName, "OutputNotConsumed"))
        return VK_FALSE;
    ++((device *)user)->complaints;
    fprintf(stderr, "validation: %s\n", data->pMessage);
    return VK_FALSE;
}

static inline bool has_layer(const device *d, const char *name)
{
    VkLayerProperties layers[64];
    uint32_t count = 64;
    const PFN_vkEnumerateInstanceLayerProperties list =
        (PFN_vkEnumerateInstanceLayerProperties)d->load(NULL,
                                                        "vkEnumerateInstanceLayerProperties");
    list(&count, layers);
    for (uint32_t i = 0; i < count; ++i)
        if (!strcmp(layers[i].layerName, name))
            return true;
    return false;
}

/* False where there is no Vulkan. */
static inline bool open_instance(device *d)
{
    static const char *const layers[] = {"VK_LAYER_KHRONOS_validation"};
    static const char *const extensions[] = {"VK_EXT_debug_utils"};
    d->library = dlopen("libvulkan.so.1", RTLD_NOW);
    if (!d->library)
        return false;
    *(void **)&d->load = dlsym(d->library, "vkGetInstanceProcAddr");
    d->validated = has_layer(d, layers[0]);
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .apiVersion = VK_API_VERSION_1_3};
    const VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = complain, .pUserData = d};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pApplicationInfo = &application,
                                       .enabledLayerCount = d->validated,
                                       .ppEnabledLayerNames = layers,
                                       .enabledExtensionCount = d->validated,
                                       .ppEnabledExtensionNames = extensions};
    const PFN_vkCreateInstance create = (PFN_vkCreateInstance)d->load(NULL, "vkCreateInstance");
    if (create(&info, NULL, &d->instance))
        return false;
    if (d->validated)
        ((PFN_vkCreateDebugUtilsMessengerEXT)d->load(
            d->instance, "vkCreateDebugUtilsMessengerEXT"))(d->instance, &messenger, NULL,
                                                            &d->messenger);
    return true;
}

/* The first device and family of queues that draw. */
static inline bool open_device(device *d)
{
    const PFN_vkEnumeratePhysicalDevices list = (PFN_vkEnumeratePhysicalDevices)d->load(
        d->instance, "vkEnumeratePhysicalDevices");
    const PFN_vkCreateDevice create =
        (PFN_vkCreateDevice)d->load(d->instance, "vkCreateDevice");
    const PFN_vkGetPhysicalDeviceProperties properties =
        (PFN_vkGetPhysicalDeviceProperties)d->load(d->instance, "vkGetPhysicalDeviceProperties");
    const PFN_vkGetDeviceProcAddr of =
        (PFN_vkGetDeviceProcAddr)d->load(d->instance, "vkGetDeviceProcAddr");
    VkPhysicalDeviceProperties p;
    uint32_t count = 1;
    const VkResult listed = list(d->instance, &count, &d->physical);
    if ((listed && listed != VK_INCOMPLETE) || !count)
        return false;
    properties(d->physical, &p);
    d->renders = p.apiVersion >= VK_API_VERSION_1_3;
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueCount = 1, .pQueuePriorities = &priority};
    const VkPhysicalDeviceVulkan13Features features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES, .dynamicRendering = 1};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = d->renders ? &features : NULL,
                                     .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue};
    if (create(d->physical, &info, NULL, &d->device))
        return false;
#define DEVICE_LOAD(name) d->name = (PFN_vk##name)of(d->device, "vk" #name);
    DEVICE_FUNCTIONS(DEVICE_LOAD)
    d->CmdBeginRendering = (PFN_vkCmdBeginRenderingKHR)of(d->device, "vkCmdBeginRendering");
    d->CmdEndRendering = (PFN_vkCmdEndRenderingKHR)of(d->device, "vkCmdEndRendering");
    d->GetDeviceQueue(d->device, 0, 0, &d->queue);
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    d->CreateCommandPool(d->device, &pool, NULL, &d->pool);
    const VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = d->pool,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY, .commandBufferCount = 1};
    return !d->AllocateCommandBuffers(d->device, &commands, &d->commands);
}

static inline void begin_commands(device *d)
{
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    d->ResetCommandPool(d->device, d->pool, 0);
    assert_int_equal(d->BeginCommandBuffer(d->commands, &info), VK_SUCCESS);
}

static inline void run_commands(device *d)
{
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
                                 .pCommandBuffers = &d->commands};
    assert_int_equal(d->EndCommandBuffer(d->commands), VK_SUCCESS);
    assert_int_equal(d->QueueSubmit(d->queue, 1, &submit, VK_NULL_HANDLE), VK_SUCCESS);
    assert_int_equal(d->QueueWaitIdle(d->queue), VK_SUCCESS);
}

static inline void close_device(device *d)
{
    if (d->device) {
        d->DestroyCommandPool(d->device, d->pool, NULL);
        d->DestroyDevice(d->device, NULL);
    }
    if (d->messenger)
        ((PFN_vkDestroyDebugUtilsMessengerEXT)d->load(
            d->instance, "vkDestroyDebugUtilsMessengerEXT"))(d->instance, d->messenger, NULL);
    if (d->instance)
        ((PFN_vkDestroyInstance)d->load(d->instance, "vkDestroyInstance"))(d->instance, NULL);
}

#endif
