/* An engine's own fragment mains: their modules, and a layout with the engine's sets. */
#include "vulkan/device.h"

#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

static gtx_result make_layout(gtx_vk *vk, const gtx_vk_shading_desc *desc, gtx_vk_shading *out,
                              gtx_error *error)
{
    const uint32_t count = desc->set_layout_count + 1;
    VkDescriptorSetLayout *sets = gtx_alloc_array(&vk->allocator, count, sizeof *sets);
    if (!sets)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a shading");
    sets[0] = vk->own_set_layout;
    if (count > 1)
        memcpy(sets + 1, desc->set_layouts, (count - 1) * sizeof *sets);
    const VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .setLayoutCount = count,
        .pSetLayouts = sets, .pushConstantRangeCount = desc->push_constant_count,
        .pPushConstantRanges = desc->push_constants};
    const gtx_result result = gtx_vk_check(
        vk->api.CreatePipelineLayout(vk->device, &info, vk->callbacks, &out->layout),
        "vkCreatePipelineLayout", error);
    gtx_free_array(&vk->allocator, sets, count, sizeof *sets);
    return result;
}

static gtx_result make_modules(gtx_vk *vk, const gtx_vk_shading_desc *desc, gtx_vk_shading *out,
                               gtx_error *error)
{
    gtx_result result = GTX_OK;
    for (uint32_t i = 0; i < GTX_PIPELINE_COUNT && !result; ++i) {
        gtx_pipeline of;
        size_t bytes = 0;
        if (!gtx_pipeline_get(i, &of) || !of.own_main)
            continue;
        const uint32_t *words = desc->fragment(i, &bytes, desc->user);
        if (!words && of.vertices == GTX_BUFFER_TILE_CORNERS)
            continue;
        if (!words || !bytes || bytes % sizeof *words)
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "pipeline %u has no SPIR-V", i);
        out->by_tiles |= of.vertices == GTX_BUFFER_TILE_CORNERS;
        const VkShaderModuleCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes,
            .pCode = words};
        result = gtx_vk_check(vk->api.CreateShaderModule(vk->device, &info, vk->callbacks,
                                                         &out->modules[i]),
                              "vkCreateShaderModule", error);
    }
    return result;
}

gtx_result gtx_vk_shading_create(gtx_vk *vk, const gtx_vk_shading_desc *desc,
                                 gtx_vk_shading **out, gtx_error *error)
{
    if (!vk || !desc || !out || !desc->fragment || (desc->set_layout_count && !desc->set_layouts) ||
        (desc->push_constant_count && !desc->push_constants))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a shading needs a device, SPIR-V, and the layouts that it counts");
    *out = NULL;
    gtx_result result = gtx_check_reserved(desc->reserved, 4, error);
    if (!result && !vk->own_planner)
        result = gtx_planner_create(&vk->own, &vk->own_planner, error);
    if (result)
        return result;
    gtx_vk_shading *shading = gtx_alloc_array(&vk->allocator, 1, sizeof *shading);
    if (!shading)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a shading");
    shading->number = ++vk->last_shading;
    result = make_layout(vk, desc, shading, error);
    if (!result)
        result = make_modules(vk, desc, shading, error);
    if (result)
        gtx_vk_shading_destroy(vk, shading);
    else
        *out = shading;
    return result;
}

void gtx_vk_shading_destroy(gtx_vk *vk, gtx_vk_shading *shading)
{
    if (!vk || !shading)
        return;
    gtx_vk_pipelines_drop(vk, shading->number);
    for (size_t i = 0; i < sizeof shading->modules / sizeof *shading->modules; ++i)
        vk->api.DestroyShaderModule(vk->device, shading->modules[i], vk->callbacks);
    vk->api.DestroyPipelineLayout(vk->device, shading->layout, vk->callbacks);
    gtx_free_array(&vk->allocator, shading, 1, sizeof *shading);
}

VkPipelineLayout gtx_vk_shading_layout(const gtx_vk_shading *shading)
{
    return shading ? shading->layout : VK_NULL_HANDLE;
}

void gtx_vk_shading_cast(gtx_vk_shading *shading, const gtx_vk_rays *rays)
{
    if (shading)
        shading->rays = rays;
}
