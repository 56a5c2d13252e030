/* Opens a Vulkan device: library, instance, device, queue and a command buffer. */
#include "host/vulkan.h"

#include "base/error.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

static VkBool32 VKAPI_PTR complain(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                   VkDebugUtilsMessageTypeFlagsEXT type,
                                   const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)severity, (void)type;
    /* Any output of a pass may be left out. */
    if (data->pMessageIdName && strstr(data->pMessageIdName, "OutputNotConsumed"))
        return VK_FALSE;
    ++((gtx_host_vulkan *)user)->complaints;
    fprintf(stderr, "validation: %s\n", data->pMessage);
    return VK_FALSE;
}

static bool has_layer(const gtx_host_vulkan *v, const char *name)
{
    VkLayerProperties layers[64];
    uint32_t count = 64;
    const PFN_vkEnumerateInstanceLayerProperties list =
        (PFN_vkEnumerateInstanceLayerProperties)v->load(NULL,
                                                        "vkEnumerateInstanceLayerProperties");
    list(&count, layers);
    for (uint32_t i = 0; i < count; ++i)
        if (!strcmp(layers[i].layerName, name))
            return true;
    return false;
}

static gtx_result open_instance(const gtx_host_vulkan_desc *desc, gtx_host_vulkan *v,
                                gtx_error *error)
{
    enum { MAX_EXTENSIONS = 8 };
    static const char *const layers[] = {"VK_LAYER_KHRONOS_validation"};
    const char *extensions[MAX_EXTENSIONS + 1];
    uint32_t count = 0;
    v->library = dlopen("libvulkan.so.1", RTLD_NOW);
    if (v->library)
        *(void **)&v->load = dlsym(v->library, "vkGetInstanceProcAddr");
    if (!v->load)
        return gtx_fail(error, GTX_ERROR_GL, "libvulkan.so.1 cannot be opened");
    v->validated = desc->validate && has_layer(v, layers[0]);
    for (uint32_t i = 0; i < desc->extension_count && i < MAX_EXTENSIONS; ++i)
        extensions[count++] = desc->extensions[i];
    if (v->validated)
        extensions[count++] = "VK_EXT_debug_utils";
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .apiVersion = VK_API_VERSION_1_3};
    const VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = complain, .pUserData = v};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pApplicationInfo = &application,
                                       .enabledLayerCount = v->validated,
                                       .ppEnabledLayerNames = layers,
                                       .enabledExtensionCount = count,
                                       .ppEnabledExtensionNames = extensions};
    const PFN_vkCreateInstance create = (PFN_vkCreateInstance)v->load(NULL, "vkCreateInstance");
    if (create(&info, NULL, &v->instance))
        return gtx_fail(error, GTX_ERROR_GL, "there is no Vulkan driver");
    if (v->validated)
        ((PFN_vkCreateDebugUtilsMessengerEXT)v->load(
            v->instance, "vkCreateDebugUtilsMessengerEXT"))(v->instance, &messenger, NULL,
                                                            &v->messenger);
    return GTX_OK;
}

/* The first one, and what it can do. */
static gtx_result find_device(gtx_host_vulkan *v, VkPhysicalDeviceFeatures *able, gtx_error *error)
{
    const PFN_vkEnumeratePhysicalDevices list = (PFN_vkEnumeratePhysicalDevices)v->load(
        v->instance, "vkEnumeratePhysicalDevices");
    const PFN_vkGetPhysicalDeviceProperties properties =
        (PFN_vkGetPhysicalDeviceProperties)v->load(v->instance, "vkGetPhysicalDeviceProperties");
    VkPhysicalDeviceVulkan11Features eyes = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    VkPhysicalDeviceFeatures2 all = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                     .pNext = &eyes};
    const PFN_vkGetPhysicalDeviceFeatures2 ask = (PFN_vkGetPhysicalDeviceFeatures2)v->load(
        v->instance, "vkGetPhysicalDeviceFeatures2");
    VkPhysicalDeviceProperties p;
    uint32_t count = 1;
    const VkResult listed = list(v->instance, &count, &v->physical);
    if ((listed && listed != VK_INCOMPLETE) || !count)
        return gtx_fail(error, GTX_ERROR_GL, "there is no Vulkan device");
    properties(v->physical, &p);
    ((PFN_vkGetPhysicalDeviceFeatures)v->load(v->instance, "vkGetPhysicalDeviceFeatures"))(
        v->physical, able);
    memcpy(v->name, p.deviceName, sizeof v->name);
    v->by_samples = able->sampleRateShading;
    v->renders = p.apiVersion >= VK_API_VERSION_1_3;
    if (v->renders && ask)
        ask(v->physical, &all);
    v->multiview = eyes.multiview;
    return GTX_OK;
}

static gtx_result make_commands(gtx_host_vulkan *v, gtx_error *error)
{
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY, .commandBufferCount = 1};
    if (v->CreateCommandPool(v->device, &pool, NULL, &v->pool))
        return gtx_fail(error, GTX_ERROR_GL, "vkCreateCommandPool failed");
    commands.commandPool = v->pool;
    return v->AllocateCommandBuffers(v->device, &commands, &v->commands)
               ? gtx_fail(error, GTX_ERROR_GL, "vkAllocateCommandBuffers failed")
               : GTX_OK;
}

/* Of the first family of queues. */
static gtx_result open_device(const gtx_host_vulkan_desc *desc, gtx_host_vulkan *v,
                              gtx_error *error)
{
    static const char *const extensions[] = {"VK_KHR_swapchain"};
    const PFN_vkCreateDevice create =
        (PFN_vkCreateDevice)v->load(v->instance, "vkCreateDevice");
    const PFN_vkGetDeviceProcAddr of =
        (PFN_vkGetDeviceProcAddr)v->load(v->instance, "vkGetDeviceProcAddr");
    VkPhysicalDeviceFeatures able;
    const gtx_result result = find_device(v, &able, error);
    if (result)
        return result;
    const VkPhysicalDeviceFeatures wanted = {
        .sampleRateShading = able.sampleRateShading,
        .textureCompressionBC = able.textureCompressionBC,
        .textureCompressionETC2 = able.textureCompressionETC2};
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueCount = 1, .pQueuePriorities = &priority};
    VkPhysicalDeviceVulkan11Features eyes = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES,
        .multiview = v->multiview};
    const VkPhysicalDeviceVulkan13Features features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES, .pNext = &eyes,
        .dynamicRendering = 1};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = v->renders ? &features : NULL,
                                     .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue,
                                     .enabledExtensionCount = desc->shows,
                                     .ppEnabledExtensionNames = extensions,
                                     .pEnabledFeatures = &wanted};
    if (create(v->physical, &info, NULL, &v->device))
        return gtx_fail(error, GTX_ERROR_GL, "%s cannot be used", v->name);
#define LOAD(name) v->name = (PFN_vk##name)of(v->device, "vk" #name);
    GTX_HOST_VULKAN(LOAD)
    v->CmdBeginRendering = (PFN_vkCmdBeginRenderingKHR)of(v->device, "vkCmdBeginRendering");
    v->CmdEndRendering = (PFN_vkCmdEndRenderingKHR)of(v->device, "vkCmdEndRendering");
    v->GetDeviceQueue(v->device, 0, 0, &v->queue);
    return make_commands(v, error);
}

gtx_result gtx_host_vulkan_create(bool validate, gtx_host_vulkan *out, gtx_error *error)
{
    return gtx_host_vulkan_open(&(gtx_host_vulkan_desc){.validate = validate}, out, error);
}

gtx_result gtx_host_vulkan_open(const gtx_host_vulkan_desc *desc, gtx_host_vulkan *out,
                                gtx_error *error)
{
    memset(out, 0, sizeof *out);
    gtx_result result = open_instance(desc, out, error);
    if (!result)
        result = open_device(desc, out, error);
    if (result)
        gtx_host_vulkan_destroy(out);
    return result;
}

/* The library stays open: drivers do not all survive being closed. */
void gtx_host_vulkan_destroy(gtx_host_vulkan *v)
{
    if (v->device) {
        v->DestroyCommandPool(v->device, v->pool, NULL);
        v->DestroyDevice(v->device, NULL);
    }
    if (v->messenger)
        ((PFN_vkDestroyDebugUtilsMessengerEXT)v->load(
            v->instance, "vkDestroyDebugUtilsMessengerEXT"))(v->instance, v->messenger, NULL);
    if (v->instance)
        ((PFN_vkDestroyInstance)v->load(v->instance, "vkDestroyInstance"))(v->instance, NULL);
    v->device = VK_NULL_HANDLE;
    v->messenger = VK_NULL_HANDLE;
    v->instance = VK_NULL_HANDLE;
}

gtx_result gtx_host_vulkan_begin(gtx_host_vulkan *v, gtx_error *error)
{
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    return v->ResetCommandPool(v->device, v->pool, 0) || v->BeginCommandBuffer(v->commands, &info)
               ? gtx_fail(error, GTX_ERROR_GL, "vkBeginCommandBuffer failed")
               : GTX_OK;
}

gtx_result gtx_host_vulkan_run(gtx_host_vulkan *v, gtx_error *error)
{
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
                                 .pCommandBuffers = &v->commands};
    return v->EndCommandBuffer(v->commands) ||
                   v->QueueSubmit(v->queue, 1, &submit, VK_NULL_HANDLE) ||
                   v->QueueWaitIdle(v->queue)
               ? gtx_fail(error, GTX_ERROR_GL, "the commands cannot be executed")
               : GTX_OK;
}
