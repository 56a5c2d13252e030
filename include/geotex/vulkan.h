/* Drawing assets with Vulkan 1.0 or later, in the host's command buffers.
 *
 * The host owns instance, device, queues, command buffers and render passes. geotex creates images,
 * buffers, pipelines and descriptors, records into the host's command buffers, submits nothing and
 * waits for nothing. It does not link Vulkan; functions come from the host's vkGetInstanceProcAddr.
 * Links libgeotex-vulkan, beside libgeotex.
 *
 *     const gtx_model_desc desc = {.first_provokes = 1};
 *     gtx_model_prepare(asset, &desc, &model, &error);                     frame.h, any thread
 *     gtx_vk_upload(vk, commands, model, &uploaded, &error);               outside a render pass
 *     when the commands have been executed: gtx_vk_uploaded(vk, uploaded);
 *
 *     gtx_vk_next_frame(vk);                                               once a frame
 *     gtx_vk_draw(vk, commands, &target, &view, placed, count, &error);    inside a render pass
 *
 * The images are those of render.h.
 *
 * State. gtx_vk_draw binds a graphics pipeline, descriptor set 0, vertex buffers 0 and 1 and an
 * index buffer. Viewport and scissor are dynamic state, which the host sets; no other dynamic state
 * is used. The rules of geotex.h apply here too; a gtx_vk is used by one thread at a time. */
#ifndef GEOTEX_VULKAN_H
#define GEOTEX_VULKAN_H

#include <geotex/rays.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* geotex's pipelines and memory on one device. */
typedef struct gtx_vk gtx_vk;
/* A model on the device. */
typedef struct gtx_vk_model gtx_vk_model;

typedef struct gtx_vk_desc {
    PFN_vkGetInstanceProcAddr load;   /* required */
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;                  /* needs no features or extensions, except dynamic rendering
                                         (Vulkan 1.3 or VK_KHR_dynamic_rendering) for targets
                                         without a render pass */
    const VkAllocationCallbacks *callbacks; /* for Vulkan's objects; kept; may be NULL */
    const gtx_allocator *allocator;   /* for all else */
    gtx_costs costs;                  /* finite, none below 0 */
    uint32_t frames;                  /* frames in flight, up to 8; 0 = 2 */
    gtx_tiling tiles;
    uint32_t reserved[2];
} gtx_vk_desc;

/* Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL (here and below: a Vulkan function is missing or failed;
 * the message says which). */
GTX_API gtx_result gtx_vk_create(const gtx_vk_desc *desc, gtx_vk **out, gtx_error *error);
/* Destroy its models first; none of its commands may be pending. NULL is fine. */
GTX_API void gtx_vk_destroy(gtx_vk *vk);

/* Creates a model's images and buffers and records their upload. The data are copied to staging
 * memory during the call, and freed in `model` (as by gtx_model_uploaded), which is still needed to
 * plan frames: free it with gtx_model_free after the gtx_vk_model. Draws later in submission order
 * see the upload; with several queue families the host transfers ownership. Errors: ARGUMENT,
 * MEMORY, LIMIT (image size), UNSUPPORTED (a block compression that the device does not support),
 * GL. */
GTX_API gtx_result gtx_vk_upload(gtx_vk *vk, VkCommandBuffer commands, gtx_model *model,
                                 gtx_vk_model **out, gtx_error *error);
/* Frees the staging memory of an upload whose commands have been executed. */
GTX_API void gtx_vk_uploaded(gtx_vk *vk, gtx_vk_model *model);
/* Updates patches from an edited asset, as gtx_model_edit does, and records the copies to the
 * device, staged in the frame's memory. Call it outside a render pass; draws later in submission
 * order show the change, earlier ones do not. After MEMORY or GL a patch may be updated in part:
 * update the patches again. Errors: ARGUMENT, MEMORY, GL. */
GTX_API gtx_result gtx_vk_update(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_model *model,
                                 const gtx_asset *edited, const uint32_t *patches, uint32_t count,
                                 gtx_error *error);
/* No pending command may use the model. NULL is fine. */
GTX_API void gtx_vk_model_destroy(gtx_vk *vk, gtx_vk_model *model);
/* Destroys a model that pending commands, of this frame or earlier ones, may still use, once they
 * have been executed: when the frame's memory is used again. For tiles of a world, which a stream
 * releases while frames show them. The gtx_model may be freed at once. NULL is fine. */
GTX_API void gtx_vk_model_retire(gtx_vk *vk, gtx_vk_model *model);

/* Begins a frame. The commands that were recorded gtx_vk_desc.frames frames ago must have been
 * executed: their memory is used again. */
GTX_API void gtx_vk_next_frame(gtx_vk *vk);

/* A render target. Its pipelines are created by the first draw that needs them. */
typedef struct gtx_vk_target {
    VkRenderPass render_pass;         /* or a compatible one; VK_NULL_HANDLE: dynamic rendering,
                                         with the formats below */
    uint32_t subpass;
    uint32_t color_count;             /* 0..4: the outputs of gtx_pass, in their order */
    VkFormat color_formats[4];
    VkFormat depth_format, stencil_format; /* stencil may be VK_FORMAT_UNDEFINED */
    VkSampleCountFlagBits samples;    /* 0 = 1 */
    uint32_t y_up;                    /* 1: clip y is up as in OpenGL, and the viewport's height
                                         negative; 0: clip y is down, as is usual in Vulkan */
    uint32_t view_mask;               /* multiview mask of the subpass or of dynamic rendering: 3:
                                         gtx_view and its `other` into layers 0 and 1, with the
                                         device's feature multiview; 0: one view */
    uint32_t reserved[3];
} gtx_vk_target;

typedef struct gtx_vk_instance {
    const gtx_vk_model *model;
    gtx_instance instance;            /* its own `model` is ignored */
} gtx_vk_instance;

/* Records the draws of the instances. The view must have GTX_VIEW_DEPTH_ZERO_TO_ONE, and the depth
 * range of the viewport. Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL, UNSUPPORTED (GTX_METHOD_LOD with
 * an asset that has no LOD mesh). After an error some draws may have been recorded. */
GTX_API gtx_result gtx_vk_draw(gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_target *target,
                               const gtx_view *view, const gtx_vk_instance *instances,
                               uint32_t count, gtx_error *error);

/* ---- an engine's own fragment main ------------------------------------------------------- */

/* Pipelines with an engine's own fragment main: like gtx_shading, but compiled by the engine. */
typedef struct gtx_vk_shading gtx_vk_shading;

typedef struct gtx_vk_shading_desc {
    /* Returns SPIR-V with the entry point `main`, and its size in bytes: compiled from `#version
     * 450` and the strings of gtx_pipeline_source(pipeline, GTX_STAGE_FRAGMENT, own_main). Called
     * for each pipeline whose gtx_pipeline.own_main is 1; the SPIR-V must stay valid until the next
     * call. Returning NULL is an error, except for pipelines of GTX_BUFFER_TILE_CORNERS, where it
     * means that nothing is cast by tiles. */
    const uint32_t *(*fragment)(uint32_t pipeline, size_t *bytes, void *user);
    void *user;
    /* The main's own descriptor sets, numbered from 1, and push constants of the fragment stage. */
    const VkDescriptorSetLayout *set_layouts;
    const VkPushConstantRange *push_constants;
    uint32_t set_layout_count, push_constant_count;
    uint32_t reserved[4];
} gtx_vk_shading_desc;

/* Errors: ARGUMENT, NOT_ZEROED, MEMORY, GL. */
GTX_API gtx_result gtx_vk_shading_create(gtx_vk *vk, const gtx_vk_shading_desc *desc,
                                         gtx_vk_shading **out, gtx_error *error);
/* No pending command may use the shading. NULL is fine. */
GTX_API void gtx_vk_shading_destroy(gtx_vk *vk, gtx_vk_shading *shading);
/* Its pipeline layout, for binding the engine's own sets and pushing constants before
 * gtx_vk_draw_shaded, which binds only set 0. VK_NULL_HANDLE for NULL. */
GTX_API VkPipelineLayout gtx_vk_shading_layout(const gtx_vk_shading *shading);

/* ---- rays in shaders ----------------------------------------------------------------------- */

/* gtx_rays of rays.h on the device. */
typedef struct gtx_vk_rays gtx_vk_rays;

/* Creates their images and records their upload; there are no instances yet. The texels are freed
 * in `rays` (as by gtx_rays_uploaded), which is still needed: free it with gtx_rays_free after the
 * gtx_vk_rays. Errors: ARGUMENT, MEMORY, LIMIT (image size), GL. */
GTX_API gtx_result gtx_vk_rays_upload(gtx_vk *vk, VkCommandBuffer commands, gtx_rays *rays,
                                      gtx_vk_rays **out, gtx_error *error);
/* Frees the staging memory of an upload whose commands have been executed. */
GTX_API void gtx_vk_rays_uploaded(gtx_vk *vk, gtx_vk_rays *rays);
/* No pending command may use the rays. NULL is fine. */
GTX_API void gtx_vk_rays_destroy(gtx_vk *vk, gtx_vk_rays *rays);

/* gtx_rays_arrange and gtx_rays_edit, recorded as by gtx_vk_update. Errors: ARGUMENT, MEMORY,
 * GL. */
GTX_API gtx_result gtx_vk_rays_place(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_rays *rays,
                                     const gtx_ray_instance *instances, uint32_t count,
                                     gtx_error *error);
GTX_API gtx_result gtx_vk_rays_update(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_rays *rays,
                                      uint32_t asset, const gtx_asset *edited,
                                      const uint32_t *patches, uint32_t count, gtx_error *error);

/* Sets the rays that the shading's draws cast into from now on. NULL, the initial value: nothing
 * occludes. */
GTX_API void gtx_vk_shading_cast(gtx_vk_shading *shading, const gtx_vk_rays *rays);
/* The images for bindings 13, 14 and 15 of the engine's own shaders, of any stage, that include
 * geotex_rays.glsl. */
GTX_API void gtx_vk_rays_images(const gtx_vk *vk, const gtx_vk_rays *rays,
                                VkDescriptorImageInfo out[GTX_RAYS_TEXTURES]);

/* gtx_vk_draw with an engine's own main, in the forward pass. Errors: as gtx_vk_draw; UNSUPPORTED
 * with GTX_VIEW_BY_SAMPLES. */
GTX_API gtx_result gtx_vk_draw_shaded(gtx_vk *vk, VkCommandBuffer commands,
                                      const gtx_vk_target *target, const gtx_view *view,
                                      const gtx_vk_shading *shading,
                                      const gtx_vk_instance *instances, uint32_t count,
                                      gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
