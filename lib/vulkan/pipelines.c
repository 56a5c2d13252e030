/* Pipelines: made of SPIR-V when something is first drawn by them into a kind of target. */
#include "vulkan/device.h"

#include "base/alloc.h"
#include "base/error.h"
#include "vulkan/spirv.h"

#include <string.h>

enum { BINDINGS = GTX_SLOT_COUNT + 3, ATTRIBUTES = 10, OUTPUTS = 4 };

/* With those of rays, or without. */
static gtx_result make_set_layout(const gtx_vk *vk, bool rays, VkDescriptorSetLayout *out,
                                  gtx_error *error)
{
    VkDescriptorSetLayoutBinding bindings[BINDINGS + GTX_RAYS_TEXTURES];
    const VkShaderStageFlags both = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    uint32_t count = 0;
    for (uint32_t i = 0; i < GTX_SLOT_COUNT; ++i)
        bindings[count++] = (VkDescriptorSetLayoutBinding){
            .binding = i, .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
            .descriptorCount = 1, .stageFlags = both};
    for (uint32_t i = GTX_VK_CONSTANTS; i <= GTX_VK_TILE; ++i)
        bindings[count++] = (VkDescriptorSetLayoutBinding){
            .binding = i, .descriptorCount = 1,
            .descriptorType = i == GTX_VK_STREAM ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                                                 : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC,
            .stageFlags = i == GTX_VK_STREAM ? VK_SHADER_STAGE_FRAGMENT_BIT : both};
    for (uint32_t i = 0; rays && i < GTX_RAYS_TEXTURES; ++i)
        bindings[count++] = (VkDescriptorSetLayoutBinding){
            .binding = GTX_RAYS_BINDING + i, .descriptorCount = 1,
            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
            .stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT};
    const VkDescriptorSetLayoutCreateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = count, .pBindings = bindings};
    return gtx_vk_check(vk->api.CreateDescriptorSetLayout(vk->device, &set, vk->callbacks, out),
                        "vkCreateDescriptorSetLayout", error);
}

gtx_result gtx_vk_layout_create(gtx_vk *vk, gtx_error *error)
{
    gtx_result result = make_set_layout(vk, false, &vk->set_layout, error);
    if (!result)
        result = make_set_layout(vk, true, &vk->own_set_layout, error);
    if (result)
        return result;
    const VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1, .pSetLayouts = &vk->set_layout};
    return gtx_vk_check(
        vk->api.CreatePipelineLayout(vk->device, &layout, vk->callbacks, &vk->layout),
        "vkCreatePipelineLayout", error);
}

static gtx_result module_of(gtx_vk *vk, uint32_t pipeline, uint32_t which, VkShaderModule *out,
                            gtx_error *error)
{
    const bool by_samples = which == GTX_VK_FRAGMENT_SAMPLE;
    const uint32_t stage = by_samples ? GTX_VK_FRAGMENT : which;
    VkShaderModule *module = &vk->modules[GTX_VK_STAGES * pipeline + which];
    const gtx_spirv *code = gtx_spirvs;
    gtx_result result = GTX_OK;
    while (code->words && (code->pipeline != pipeline || code->stage != stage))
        ++code;
    if (!code->words)
        return gtx_fail(error, GTX_ERROR_INTERNAL, "pipeline %u has no shaders", pipeline);
    if (!*module) {
        size_t bytes = code->bytes;
        uint32_t *own = by_samples ? gtx_vk_by_samples(vk, code->words, &bytes) : NULL;
        if (by_samples && !own)
            return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a shader");
        const VkShaderModuleCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
            .codeSize = bytes, .pCode = own ? own : code->words};
        result = gtx_vk_check(
            vk->api.CreateShaderModule(vk->device, &info, vk->callbacks, module),
            "vkCreateShaderModule", error);
        gtx_free_array(&vk->allocator, own, bytes, 1);
    }
    *out = *module;
    return result;
}

/* Of vertices of a buffer at binding 0, and of instances at binding 1; tiles have a corner alone.
 * Blocks are instances themselves, all placed as the same one. Returns the number of attributes. */
static uint32_t set_attributes(gtx_buffer vertices, uint32_t size,
                               VkVertexInputBindingDescription bindings[2],
                               VkVertexInputAttributeDescription attributes[ATTRIBUTES])
{
    const bool proxy = vertices == GTX_BUFFER_PROXY_VERTICES;
    const bool blocks = vertices == GTX_BUFFER_BLOCKS, narrow = size == 8;
    uint32_t count = 0;
    enum { ROWS = 7, ID = 9 };
    bindings[0] = (VkVertexInputBindingDescription){0, size, VK_VERTEX_INPUT_RATE_VERTEX};
    bindings[1] = (VkVertexInputBindingDescription){1, sizeof(gtx_instance_data),
                                                    VK_VERTEX_INPUT_RATE_INSTANCE};
    if (vertices == GTX_BUFFER_TILE_CORNERS) {
        attributes[0] = (VkVertexInputAttributeDescription){0, 0, VK_FORMAT_R16G16_UINT, 0};
        return 1;
    }
    if (blocks) {
        bindings[0].inputRate = VK_VERTEX_INPUT_RATE_INSTANCE;
        bindings[1].stride = 0;
        attributes[count++] =
            (VkVertexInputAttributeDescription){0, 0, VK_FORMAT_R32G32_UINT, 0};
    } else {
        attributes[count++] = (VkVertexInputAttributeDescription){
            0, 0, proxy ? VK_FORMAT_R32G32B32_SFLOAT : VK_FORMAT_R16G16B16A16_UINT, 0};
        attributes[count++] = (VkVertexInputAttributeDescription){
            1, 0, narrow ? VK_FORMAT_R16_UINT : VK_FORMAT_R32_UINT, narrow ? 6 : size - 4};
    }
    for (uint32_t i = 0; i < ROWS; ++i)
        attributes[count++] =
            (VkVertexInputAttributeDescription){2 + i, 1, VK_FORMAT_R32G32B32A32_SFLOAT, 16 * i};
    attributes[count++] = (VkVertexInputAttributeDescription){ID, 1, VK_FORMAT_R32_UINT,
                                                              offsetof(gtx_instance_data, id)};
    return count;
}

/* What writes depth has to be shaded once a sample, where the target wants that. */
static bool is_by_samples(const gtx_vk_key *key, const gtx_pipeline *of)
{
    return key->by_samples && of->writes_depth;
}

/* The vertex shader, for one view or two, and the fragment shader, a pixel or a sample each. */
static gtx_result set_stages(gtx_vk *vk, const gtx_vk_key *key, const gtx_vk_shading *shading,
                             const gtx_pipeline *of, VkPipelineShaderStageCreateInfo stages[2],
                             gtx_error *error)
{
    for (uint32_t i = 0; i < 2; ++i)
        stages[i] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT,
            .pName = "main"};
    gtx_result result = module_of(vk, key->pipeline,
                                  key->target.view_mask ? GTX_VK_VERTEX_TWO : GTX_VK_VERTEX,
                                  &stages[0].module, error);
    if (result)
        return result;
    if (shading) {
        stages[1].module = shading->modules[key->pipeline];
        return GTX_OK;
    }
    return module_of(vk, key->pipeline,
                     is_by_samples(key, of) ? GTX_VK_FRAGMENT_SAMPLE : GTX_VK_FRAGMENT,
                     &stages[1].module, error);
}

/* Culling, samples and depth, as the key and its target have them. */
typedef struct fixed_state {
    VkPipelineRasterizationStateCreateInfo raster;
    VkPipelineMultisampleStateCreateInfo multisample;
    VkPipelineDepthStencilStateCreateInfo depth;
} fixed_state;

static fixed_state fixed_state_of(const gtx_vk_key *key, const gtx_pipeline *of)
{
    static const VkCullModeFlags culls[] = {[GTX_CULL_NONE] = VK_CULL_MODE_NONE,
                                            [GTX_CULL_BACK] = VK_CULL_MODE_BACK_BIT,
                                            [GTX_CULL_FRONT] = VK_CULL_MODE_FRONT_BIT};
    return (fixed_state){
        .raster = {.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
                   .cullMode = culls[key->cull],
                   .frontFace = key->clockwise ? VK_FRONT_FACE_CLOCKWISE
                                               : VK_FRONT_FACE_COUNTER_CLOCKWISE,
                   .lineWidth = 1},
        .multisample = {.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                        .rasterizationSamples = key->target.samples,
                        .sampleShadingEnable = is_by_samples(key, of),
                        .minSampleShading = 1},
        .depth = {.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                  .depthTestEnable = VK_TRUE, .depthWriteEnable = VK_TRUE,
                  .depthCompareOp = key->nearer_is_greater ? VK_COMPARE_OP_GREATER
                                                           : VK_COMPARE_OP_LESS}};
}

static gtx_result make(gtx_vk *vk, const gtx_vk_key *key, const gtx_vk_shading *shading,
                       VkPipeline *out, gtx_error *error)
{
    const gtx_vk_target *target = &key->target;
    VkVertexInputBindingDescription bindings[2];
    VkVertexInputAttributeDescription attributes[ATTRIBUTES];
    VkPipelineShaderStageCreateInfo stages[2];
    VkPipelineColorBlendAttachmentState outputs[OUTPUTS];
    gtx_pipeline of;
    gtx_pipeline_get(key->pipeline, &of);
    const gtx_result result = set_stages(vk, key, shading, &of, stages, error);
    if (result)
        return result;
    const uint32_t attribute_count = set_attributes(of.vertices, key->vertex_size, bindings,
                                                    attributes);
    for (uint32_t i = 0; i < OUTPUTS; ++i)
        outputs[i] = (VkPipelineColorBlendAttachmentState){
            .colorWriteMask = of.pass == GTX_PASS_DEPTH ? 0 : 15};
    const fixed_state fixed = fixed_state_of(key, &of);
    const VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = 2, .pVertexBindingDescriptions = bindings,
        .vertexAttributeDescriptionCount = attribute_count,
        .pVertexAttributeDescriptions = attributes};
    static const VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    static const VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1, .scissorCount = 1};
    static const VkDynamicState dynamics[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    static const VkPipelineDynamicStateCreateInfo dynamic = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2, .pDynamicStates = dynamics};
    const VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = target->color_count, .pAttachments = outputs};
    const VkPipelineRenderingCreateInfoKHR rendering = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO_KHR,
        .viewMask = target->view_mask, .colorAttachmentCount = target->color_count,
        .pColorAttachmentFormats = target->color_formats,
        .depthAttachmentFormat = target->depth_format,
        .stencilAttachmentFormat = target->stencil_format};
    const VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .pNext = target->render_pass ? NULL : &rendering,
        .stageCount = 2, .pStages = stages,
        .pVertexInputState = &input, .pInputAssemblyState = &assembly,
        .pViewportState = &viewport, .pRasterizationState = &fixed.raster,
        .pMultisampleState = &fixed.multisample, .pDepthStencilState = &fixed.depth,
        .pColorBlendState = &blend, .pDynamicState = &dynamic,
        .layout = shading ? shading->layout : vk->layout,
        .renderPass = target->render_pass, .subpass = target->subpass};
    return gtx_vk_check(vk->api.CreateGraphicsPipelines(vk->device, VK_NULL_HANDLE, 1, &info,
                                                        vk->callbacks, out),
                        "vkCreateGraphicsPipelines", error);
}

gtx_result gtx_vk_pipeline_of(gtx_vk *vk, const gtx_vk_key *key, const gtx_vk_shading *shading,
                              VkPipeline *out, gtx_error *error)
{
    for (uint32_t i = 0; i < vk->pipeline_count; ++i)
        if (!memcmp(&vk->pipelines[i].key, key, sizeof *key)) {
            *out = vk->pipelines[i].pipeline;
            return GTX_OK;
        }
    void *pipelines = vk->pipelines;
    if (!gtx_vk_grow(vk, &pipelines, &vk->pipeline_room, vk->pipeline_count + 1,
                     sizeof *vk->pipelines))
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a pipeline");
    vk->pipelines = pipelines;
    gtx_vk_pipeline *made = &vk->pipelines[vk->pipeline_count];
    gtx_result result = make(vk, key, shading, &made->pipeline, error);
    if (result)
        return result;
    memcpy(&made->key, key, sizeof *key);
    ++vk->pipeline_count;
    *out = made->pipeline;
    return GTX_OK;
}

void gtx_vk_pipelines_drop(gtx_vk *vk, uint32_t shading)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < vk->pipeline_count; ++i)
        if (vk->pipelines[i].key.shading == shading)
            vk->api.DestroyPipeline(vk->device, vk->pipelines[i].pipeline, vk->callbacks);
        else
            vk->pipelines[kept++] = vk->pipelines[i];
    vk->pipeline_count = kept;
}
