/* Drawing assets with Vulkan 1.0 or later, in the host's command buffers.
 *
 * The host owns instance, device, queues, command buffers and render passes. geotex creates objects
 * of the device (images, buffers, pipelines, descriptors), records commands where it is told to,
 * submits nothing, and waits for nothing. It links no Vulkan: its functions come from the host's
 * vkGetInstanceProcAddr. A library of its own, libgeotex-vulkan, beside libgeotex.
 *
 *     const gtx_model_desc desc = {.first_provokes = 1};
 *     gtx_model_prepare(asset, &desc, &model, &error);                     frame.h, any thread
 *     gtx_vk_upload(vk, commands, model, &uploaded, &error);               outside a render pass
 *     when the commands have been executed: gtx_vk_uploaded(vk, uploaded);
 *
 *     gtx_vk_next_frame(vk);                                               once a frame
 *     gtx_vk_draw(vk, commands, &target, &view, placed, count, &error);    inside a render pass
 *
 * The picture is that of render.h.
 *
 * State. gtx_vk_draw binds a graphics pipeline, descriptor set 0, vertex buffers 0 and 1 and an
 * index buffer. Viewport and scissor are dynamic, and the host's; other dynamic state is not used.
 * The rules of geotex.h hold here too; a gtx_vk is used by one thread at a time. */
#ifndef GEOTEX_VULKAN_H
#define GEOTEX_VULKAN_H

#include <geotex/rays.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Pipelines and memory of one device. */
typedef struct gtx_vk gtx_vk;
/* A model on the device. */
typedef struct gtx_vk_model gtx_vk_model;

typedef struct gtx_vk_desc {
    PFN_vkGetInstanceProcAddr load;   /* required */
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;                  /* without features or extensions; VK_KHR_dynamic_rendering or
                                         Vulkan 1.3 with its feature where a target names no pass */
    const VkAllocationCallbacks *callbacks; /* of Vulkan's objects; may be NULL; must stay */
    const gtx_allocator *allocator;   /* of all else */
    gtx_costs costs;                  /* finite, none below 0 */
    uint32_t frames;                  /* recorded or executed at once; 0 = 2, at most 8 */
    gtx_tiling tiles;
    uint32_t reserved[2];
} gtx_vk_desc;

/* Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL (a function is missing, or a call of Vulkan failed: the
 * message says which; so in all functions here). */
GTX_API gtx_result gtx_vk_create(const gtx_vk_desc *desc, gtx_vk **out, gtx_error *error);
/* Destroy its models first; none of its frames may be in execution. NULL is fine. */
GTX_API void gtx_vk_destroy(gtx_vk *vk);

/* Creates a model's images and buffers and records their upload. The bytes are copied at once, and
 * `model` keeps none (gtx_model_uploaded): it plans frames from then on, and is freed by
 * gtx_model_free after the gtx_vk_model. Draws behind it in submission order see it; with several
 * queue families the host hands it over. Errors: ARGUMENT, MEMORY, LIMIT (image size),
 * UNSUPPORTED (blocks that the device does not read), GL. */
GTX_API gtx_result gtx_vk_upload(gtx_vk *vk, VkCommandBuffer commands, gtx_model *model,
                                 gtx_vk_model **out, gtx_error *error);
/* Frees what the upload was copied through: its commands have been executed. */
GTX_API void gtx_vk_uploaded(gtx_vk *vk, gtx_vk_model *model);
/* Takes patches from an edited asset, as gtx_model_edit, and records what changes on the device,
 * through the frame's memory: outside a render pass; draws behind it in submission order show it,
 * those before it do not, and nothing waits. After MEMORY and GL a patch may be taken in part: take
 * them again. Errors: ARGUMENT, MEMORY, GL. */
GTX_API gtx_result gtx_vk_update(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_model *model,
                                 const gtx_asset *edited, const uint32_t *patches, uint32_t count,
                                 gtx_error *error);
/* No command that names it may be in execution. NULL is fine. */
GTX_API void gtx_vk_model_destroy(gtx_vk *vk, gtx_vk_model *model);
/* Destroys it once what may name it has been executed: its commands are of this frame (since
 * gtx_vk_next_frame) or of those before it, and the frame's memory is used again. For tiles of a
 * world, which a stream releases while frames show them. The gtx_model may be freed at once. NULL
 * is fine. */
GTX_API void gtx_vk_model_retire(gtx_vk *vk, gtx_vk_model *model);

/* Begins a frame: what was recorded gtx_vk_desc.frames of them ago has been executed, and its
 * memory is used again. */
GTX_API void gtx_vk_next_frame(gtx_vk *vk);

/* What is drawn into. Pipelines are made for it by the first draw that needs them. */
typedef struct gtx_vk_target {
    VkRenderPass render_pass;         /* compatible ones are equal; VK_NULL_HANDLE: dynamic
                                         rendering, and these formats */
    uint32_t subpass;
    uint32_t color_count;             /* 0 to 4; of the outputs of gtx_pass, in their order */
    VkFormat color_formats[4];
    VkFormat depth_format, stencil_format; /* stencil may be undefined */
    VkSampleCountFlagBits samples;    /* 0 = 1 */
    uint32_t y_up;                    /* 1: clip y is up as in OpenGL, and the viewport's height
                                         negative; 0: clip y is down, as is usual in Vulkan */
    uint32_t view_mask;               /* 3: two views at once, of gtx_view and its `other`, into
                                         layers 0 and 1: of the subpass, or of dynamic rendering;
                                         with the device's feature multiview. 0: one */
    uint32_t reserved[3];
} gtx_vk_target;

typedef struct gtx_vk_instance {
    const gtx_vk_model *model;
    gtx_instance instance;            /* its model is not looked at */
} gtx_vk_instance;

/* Records the instances' draws. The view's flags have GTX_VIEW_DEPTH_ZERO_TO_ONE, and its depth
 * range is the viewport's. Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL, UNSUPPORTED (GTX_METHOD_LOD
 * with an asset that has no LOD mesh). After an error some draws may be recorded. */
GTX_API gtx_result gtx_vk_draw(gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_target *target,
                               const gtx_view *view, const gtx_vk_instance *instances,
                               uint32_t count, gtx_error *error);

/* ---- an engine's own fragment main ------------------------------------------------------- */

/* Pipelines whose fragments are an engine's: as gtx_shading, but compiled by the engine. */
typedef struct gtx_vk_shading gtx_vk_shading;

typedef struct gtx_vk_shading_desc {
    /* The SPIR-V of the texts of gtx_pipeline_source(pipeline, GTX_STAGE_FRAGMENT, its own main)
     * behind `#version 450`, whose entry point is `main`, and its bytes. Asked for each pipeline
     * whose gtx_pipeline.own_main is 1; only needed until the next call. NULL is an error, but for
     * GTX_BUFFER_TILE_CORNERS, where it means that nothing is cast by tiles. */
    const uint32_t *(*fragment)(uint32_t pipeline, size_t *bytes, void *user);
    void *user;
    /* What the main has besides: descriptor sets 1 and on, and constants of the fragment stage. */
    const VkDescriptorSetLayout *set_layouts;
    const VkPushConstantRange *push_constants;
    uint32_t set_layout_count, push_constant_count;
    uint32_t reserved[4];
} gtx_vk_shading_desc;

/* Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL. */
GTX_API gtx_result gtx_vk_shading_create(gtx_vk *vk, const gtx_vk_shading_desc *desc,
                                         gtx_vk_shading **out, gtx_error *error);
/* No command that names it may be in execution. NULL is fine. */
GTX_API void gtx_vk_shading_destroy(gtx_vk *vk, gtx_vk_shading *shading);
/* Its layout, for binding sets 1 and on and pushing constants before gtx_vk_draw_shaded, which
 * binds set 0 alone. VK_NULL_HANDLE for NULL. */
GTX_API VkPipelineLayout gtx_vk_shading_layout(const gtx_vk_shading *shading);

/* ---- rays in shaders ----------------------------------------------------------------------- */

/* gtx_rays of rays.h on the device. */
typedef struct gtx_vk_rays gtx_vk_rays;

/* Creates their images and records their upload; no instance is placed yet. `rays` keeps no texels
 * (gtx_rays_uploaded), and is freed by gtx_rays_free after the gtx_vk_rays. Errors: ARGUMENT,
 * MEMORY, LIMIT (image size), GL. */
GTX_API gtx_result gtx_vk_rays_upload(gtx_vk *vk, VkCommandBuffer commands, gtx_rays *rays,
                                      gtx_vk_rays **out, gtx_error *error);
/* Frees what the upload was copied through: its commands have been executed. */
GTX_API void gtx_vk_rays_uploaded(gtx_vk *vk, gtx_vk_rays *rays);
/* No command that names it may be in execution. NULL is fine. */
GTX_API void gtx_vk_rays_destroy(gtx_vk *vk, gtx_vk_rays *rays);

/* gtx_rays_arrange and gtx_rays_edit, recorded as by gtx_vk_update. Errors: ARGUMENT, MEMORY,
 * GL. */
GTX_API gtx_result gtx_vk_rays_place(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_rays *rays,
                                     const gtx_ray_instance *instances, uint32_t count,
                                     gtx_error *error);
GTX_API gtx_result gtx_vk_rays_update(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_rays *rays,
                                      uint32_t asset, const gtx_asset *edited,
                                      const uint32_t *patches, uint32_t count, gtx_error *error);

/* What the shading's draws cast into from now on; NULL, as at first: nothing, and nothing
 * occludes. */
GTX_API void gtx_vk_shading_cast(gtx_vk_shading *shading, const gtx_vk_rays *rays);
/* What bindings 13, 14 and 15 are, for shaders of the engine's own that include geotex_rays.glsl,
 * of any stage. */
GTX_API void gtx_vk_rays_images(const gtx_vk *vk, const gtx_vk_rays *rays,
                                VkDescriptorImageInfo out[GTX_RAYS_TEXTURES]);

/* gtx_vk_draw by an engine's own main, in the forward pass; with GTX_VIEW_SHADING_BY_TILES by
 * tiles, where rays are cast so. Errors: as gtx_vk_draw; UNSUPPORTED with GTX_VIEW_BY_SAMPLES. */
GTX_API gtx_result gtx_vk_draw_shaded(gtx_vk *vk, VkCommandBuffer commands,
                                      const gtx_vk_target *target, const gtx_view *view,
                                      const gtx_vk_shading *shading,
                                      const gtx_vk_instance *instances, uint32_t count,
                                      gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
