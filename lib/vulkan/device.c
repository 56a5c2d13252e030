/* Devices: functions, what all models share, and the frames in flight. */
#include "vulkan/device.h"

#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

/* Casting by tiles has been measured with llvmpipe alone. */
static uint32_t tile_texels(const gtx_vk_desc *desc, const VkPhysicalDeviceProperties *of)
{
    return desc->tiles == GTX_TILES_ALWAYS ||
                   (desc->tiles == GTX_TILES_AUTO && strstr(of->deviceName, "llvmpipe"))
               ? of->limits.maxTexelBufferElements
               : 0;
}

/* Whether the device samples these blocks, if its host has enabled them. */
static bool reads(const gtx_vk_desc *desc, VkFormat format)
{
    const PFN_vkGetPhysicalDeviceFormatProperties ask =
        (PFN_vkGetPhysicalDeviceFormatProperties)desc->load(desc->instance,
                                                            "vkGetPhysicalDeviceFormatProperties");
    VkFormatProperties of = {0};
    if (ask)
        ask(desc->physical_device, format, &of);
    return of.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
}

static gtx_result load(gtx_vk *vk, const gtx_vk_desc *desc, gtx_error *error)
{
    const PFN_vkGetDeviceProcAddr of_device =
        (PFN_vkGetDeviceProcAddr)desc->load(desc->instance, "vkGetDeviceProcAddr");
    const PFN_vkGetPhysicalDeviceMemoryProperties memory =
        (PFN_vkGetPhysicalDeviceMemoryProperties)desc->load(
            desc->instance, "vkGetPhysicalDeviceMemoryProperties");
    const PFN_vkGetPhysicalDeviceProperties properties =
        (PFN_vkGetPhysicalDeviceProperties)desc->load(desc->instance,
                                                      "vkGetPhysicalDeviceProperties");
    const char *missing = of_device && memory && properties ? NULL : "of the instance";
#define LOAD(name)                                                                                 \
    vk->api.name = missing ? NULL : (PFN_vk##name)of_device(vk->device, "vk" #name);               \
    if (!vk->api.name && !missing)                                                                 \
        missing = "vk" #name;
    GTX_VK_FUNCTIONS(LOAD)
    if (missing)
        return gtx_fail(error, GTX_ERROR_GL, "Vulkan lacks a function: %s", missing);
    VkPhysicalDeviceProperties of;
    memory(desc->physical_device, &vk->memory);
    properties(desc->physical_device, &of);
    vk->limits = of.limits;
    vk->reads[GTX_COMPRESS_BC] = reads(desc, VK_FORMAT_BC7_UNORM_BLOCK);
    vk->reads[GTX_COMPRESS_ETC2] = reads(desc, VK_FORMAT_ETC2_R8G8B8A8_UNORM_BLOCK);
    const gtx_planner_desc planner = {.allocator = &vk->allocator, .costs = desc->costs,
                                      .max_tile_texels = tile_texels(desc, &of),
                                      .on_gpu = of.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU};
    vk->own = planner;
    vk->own.own_main = 1;
    return gtx_planner_create(&planner, &vk->planner, error);
}

static gtx_result make_samplers(gtx_vk *vk, gtx_error *error)
{
    gtx_result result = GTX_OK;
    for (int filtered = 0; filtered < 2 && !result; ++filtered) {
        const VkFilter filter = filtered ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
        const VkSamplerCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
            .magFilter = filter,
            .minFilter = filter,
            .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
            .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
            .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
            .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
            .maxLod = VK_LOD_CLAMP_NONE};
        result = gtx_vk_check(vk->api.CreateSampler(vk->device, &info, vk->callbacks,
                                                    &vk->samplers[filtered]),
                              "vkCreateSampler", error);
    }
    return result;
}

gtx_result gtx_vk_create(const gtx_vk_desc *desc, gtx_vk **out, gtx_error *error)
{
    if (!desc || !out || !desc->load || !desc->instance || !desc->physical_device ||
        !desc->device || desc->frames > GTX_VK_MAX_FRAMES ||
        (unsigned)desc->tiles > GTX_TILES_ALWAYS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a device, what loads its functions, at most %d frames and a known tiling "
                        "are needed", GTX_VK_MAX_FRAMES);
    *out = NULL;
    gtx_result result = gtx_check_reserved(desc->reserved, 2, error);
    if (result)
        return result;
    const gtx_allocator hooks = gtx_allocator_or_default(desc->allocator);
    gtx_vk *vk = gtx_alloc_array(&hooks, 1, sizeof *vk);
    if (!vk)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a device");
    vk->allocator = hooks;
    vk->callbacks = desc->callbacks;
    vk->device = desc->device;
    vk->frame_count = desc->frames ? desc->frames : 2;
    result = load(vk, desc, error);
    if (result) { /* there is nothing yet */
        gtx_free_array(&hooks, vk, 1, sizeof *vk);
        return result;
    }
    result = make_samplers(vk, error);
    if (!result)
        result = gtx_vk_layout_create(vk, error);
    if (!result)
        result = gtx_vk_buffer_create(vk, 16, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, false,
                                      &vk->nothing, error);
    if (!result) {
        const VkBufferViewCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                             .buffer = vk->nothing.buffer, .range = 16,
                                             .format = VK_FORMAT_R32G32B32A32_UINT};
        result = gtx_vk_check(
            vk->api.CreateBufferView(vk->device, &info, vk->callbacks, &vk->no_stream),
            "vkCreateBufferView", error);
    }
    if (result)
        gtx_vk_destroy(vk);
    else
        *out = vk;
    return result;
}

void gtx_vk_destroy(gtx_vk *vk)
{
    if (!vk)
        return;
    const gtx_vk_api *api = &vk->api;
    for (uint32_t i = 0; i < vk->pipeline_count; ++i)
        api->DestroyPipeline(vk->device, vk->pipelines[i].pipeline, vk->callbacks);
    for (size_t i = 0; i < sizeof vk->modules / sizeof *vk->modules; ++i)
        api->DestroyShaderModule(vk->device, vk->modules[i], vk->callbacks);
    for (uint32_t i = 0; i < vk->frame_count; ++i)
        gtx_vk_frame_free(vk, &vk->frames[i]);
    for (int i = 0; i < 2; ++i)
        api->DestroySampler(vk->device, vk->samplers[i], vk->callbacks);
    api->DestroyBufferView(vk->device, vk->no_stream, vk->callbacks);
    gtx_vk_buffer_destroy(vk, &vk->nothing);
    api->DestroyPipelineLayout(vk->device, vk->layout, vk->callbacks);
    api->DestroyDescriptorSetLayout(vk->device, vk->set_layout, vk->callbacks);
    api->DestroyDescriptorSetLayout(vk->device, vk->own_set_layout, vk->callbacks);
    gtx_planner_destroy(vk->planner);
    gtx_planner_destroy(vk->own_planner);
    const gtx_allocator hooks = vk->allocator;
    gtx_free_array(&hooks, vk->pipelines, vk->pipeline_room, sizeof *vk->pipelines);
    gtx_free_array(&hooks, vk->instances, vk->instance_room, sizeof *vk->instances);
    gtx_free_array(&hooks, vk, 1, sizeof *vk);
}

void gtx_vk_next_frame(gtx_vk *vk)
{
    if (!vk)
        return;
    vk->frame = (vk->frame + 1) % vk->frame_count;
    gtx_vk_frame *frame = &vk->frames[vk->frame];
    for (uint32_t i = 0; i < frame->pool_count; ++i)
        vk->api.ResetDescriptorPool(vk->device, frame->pools[i], 0);
    gtx_vk_views_free(vk, frame);
    gtx_vk_models_free(vk, frame);
    frame->block = frame->pool = frame->sets = 0;
    frame->used = 0;
}

bool gtx_vk_grow(const gtx_vk *vk, void **array, uint32_t *room, uint32_t count, size_t size)
{
    if (count <= *room)
        return true;
    const uint32_t wanted = count + count / 2 + 4;
    void *grown = gtx_alloc_array(&vk->allocator, wanted, size);
    if (!grown)
        return false;
    if (*array)
        memcpy(grown, *array, *room * size);
    gtx_free_array(&vk->allocator, *array, *room, size);
    *array = grown;
    *room = wanted;
    return true;
}
