/* The inside of gtx_vk. */
#ifndef GTX_VULKAN_DEVICE_H
#define GTX_VULKAN_DEVICE_H

#include <geotex/vulkan.h>
#include <stdbool.h>

#define GTX_VK_FUNCTIONS(X)                                                                        \
    X(AllocateDescriptorSets) X(AllocateMemory) X(BindBufferMemory) X(BindImageMemory)             \
    X(CmdBindDescriptorSets) X(CmdBindIndexBuffer) X(CmdBindPipeline) X(CmdBindVertexBuffers)      \
    X(CmdCopyBuffer) X(CmdCopyBufferToImage) X(CmdDraw) X(CmdDrawIndexed) X(CmdPipelineBarrier)    \
    X(CreateBuffer) X(CreateBufferView) X(CreateDescriptorPool) X(CreateDescriptorSetLayout)       \
    X(CreateGraphicsPipelines) X(CreateImage) X(CreateImageView) X(CreatePipelineLayout)           \
    X(CreateSampler) X(CreateShaderModule) X(DestroyBuffer) X(DestroyBufferView)                   \
    X(DestroyDescriptorPool)                                                                       \
    X(DestroyDescriptorSetLayout) X(DestroyImage) X(DestroyImageView) X(DestroyPipeline)           \
    X(DestroyPipelineLayout) X(DestroySampler) X(DestroyShaderModule) X(FreeMemory)                \
    X(GetBufferMemoryRequirements) X(GetImageMemoryRequirements) X(MapMemory)                      \
    X(ResetDescriptorPool) X(UpdateDescriptorSets)

typedef struct gtx_vk_api {
#define GTX_VK_FIELD(name) PFN_vk##name name;
    GTX_VK_FUNCTIONS(GTX_VK_FIELD)
#undef GTX_VK_FIELD
} gtx_vk_api;

/* A buffer with memory of its own, mapped where the host writes it. */
typedef struct gtx_vk_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    uint8_t *mapped;
    VkDeviceSize size;
} gtx_vk_buffer;

/* memory.c. Errors: GL. */
gtx_result gtx_vk_buffer_create(const gtx_vk *vk, VkDeviceSize size, VkBufferUsageFlags usage,
                                bool mapped, gtx_vk_buffer *out, gtx_error *error);
void gtx_vk_buffer_destroy(const gtx_vk *vk, gtx_vk_buffer *buffer);
/* Memory of the kind, or the next best; the index of a type that `bits` allow. */
uint32_t gtx_vk_memory_type(const gtx_vk *vk, uint32_t bits, bool mapped);
gtx_result gtx_vk_check(VkResult result, const char *what, gtx_error *error);

enum { GTX_VK_MAX_FRAMES = 8, GTX_VK_SETS = 64 };

/* Bindings of the only set, behind the textures by their slots. */
enum {
    GTX_VK_CONSTANTS = 8,     /* gtx_constants, at a dynamic offset */
    GTX_VK_STREAM = 9,        /* what tiles hold, in fragments */
    GTX_VK_TILE = 10          /* gtx_tile_constants, at a dynamic offset */
};

/* What one frame writes: blocks of memory and pools of descriptor sets, used again by a later
 * one; and views of streams, which are not. */
typedef struct gtx_vk_frame {
    gtx_vk_buffer *blocks;
    VkDescriptorPool *pools;
    VkBufferView *views;
    uint32_t block_count, pool_count, view_count, view_room;
    uint32_t block, pool, sets;   /* in use, and sets of that pool */
    VkDeviceSize used;            /* of the block */
    gtx_vk_model *retired;        /* the first of those that end with it */
} gtx_vk_frame;

/* A piece of a block. */
typedef struct gtx_vk_piece {
    VkBuffer buffer;
    VkDeviceSize offset, size;
} gtx_vk_piece;

/* memory.c: room in the frame, mapped at *to. Errors: MEMORY, GL. */
gtx_result gtx_vk_take(gtx_vk *vk, VkDeviceSize size, gtx_vk_piece *out, uint8_t **to,
                       gtx_error *error);
/* Copies bytes into the frame. Errors: MEMORY, GL. */
gtx_result gtx_vk_write(gtx_vk *vk, const void *data, VkDeviceSize size, gtx_vk_piece *out,
                        gtx_error *error);
/* The same of several arrays, one behind the other. */
gtx_result gtx_vk_write_all(gtx_vk *vk, const void *const *data, const uint64_t *sizes,
                            uint32_t count, gtx_vk_piece *out, gtx_error *error);
/* A descriptor set of the frame. Errors: MEMORY, GL. */
gtx_result gtx_vk_take_set(gtx_vk *vk, VkDescriptorSetLayout layout, VkDescriptorSet *out,
                           gtx_error *error);
/* A view of a piece as texels of 4 uint32_t, until the frame's memory is used again. Errors:
 * MEMORY, GL. */
gtx_result gtx_vk_view(gtx_vk *vk, const gtx_vk_piece *piece, VkBufferView *out, gtx_error *error);
void gtx_vk_views_free(gtx_vk *vk, gtx_vk_frame *frame);
void gtx_vk_frame_free(gtx_vk *vk, gtx_vk_frame *frame);

/* Shaders of a pipeline. */
enum { GTX_VK_VERTEX, GTX_VK_FRAGMENT, GTX_VK_VERTEX_TWO, GTX_VK_FRAGMENT_SAMPLE, GTX_VK_STAGES };

/* What a pipeline is made for: all of it is compared, byte by byte. */
typedef struct gtx_vk_key {
    gtx_vk_target target;
    uint32_t pipeline, cull, clockwise, nearer_is_greater;
    uint16_t by_samples, vertex_size; /* no padding: keys are compared by their bytes */
    uint32_t shading;         /* its number, or 0 */
} gtx_vk_key;

typedef struct gtx_vk_pipeline {
    gtx_vk_key key;
    VkPipeline pipeline;
} gtx_vk_pipeline;

/* pipelines.c. The shading is that of the key's number, or NULL. Errors: MEMORY, GL. */
gtx_result gtx_vk_pipeline_of(gtx_vk *vk, const gtx_vk_key *key, const gtx_vk_shading *shading,
                              VkPipeline *out, gtx_error *error);
/* Forgets the pipelines of a shading. */
void gtx_vk_pipelines_drop(gtx_vk *vk, uint32_t shading);
gtx_result gtx_vk_layout_create(gtx_vk *vk, gtx_error *error);
/* samples.c: a copy of a fragment shader of ours, for once a sample, from the allocator, and its
 * size in place of the shader's; NULL without memory. */
uint32_t *gtx_vk_by_samples(const gtx_vk *vk, const uint32_t *words, size_t *bytes);

struct gtx_vk {
    gtx_allocator allocator;
    const VkAllocationCallbacks *callbacks;
    VkDevice device;
    gtx_vk_api api;
    VkPhysicalDeviceMemoryProperties memory;
    bool reads[GTX_COMPRESS_ETC2 + 1]; /* kinds of blocks, where the host enables them */
    VkPhysicalDeviceLimits limits;
    VkSampler samplers[2];        /* by texel; filtered */
    gtx_vk_buffer nothing;        /* what draws without tiles have as a stream: a texel */
    VkBufferView no_stream;
    VkDescriptorSetLayout set_layout, own_set_layout; /* the latter of shadings, with rays */
    VkPipelineLayout layout;
    VkShaderModule modules[GTX_VK_STAGES * GTX_PIPELINE_COUNT]; /* by pipeline; once needed */
    gtx_vk_pipeline *pipelines;
    uint32_t pipeline_count, pipeline_room;
    gtx_planner *planner, *own_planner; /* the latter once there is a shading */
    gtx_planner_desc own;         /* that it is made of */
    uint32_t last_shading;
    gtx_vk_frame frames[GTX_VK_MAX_FRAMES];
    uint32_t frame_count, frame;
    gtx_instance *instances;      /* scratch of a draw */
    uint32_t instance_room;
};

/* A model's textures, and one of a texel that is 0, for shaders that cast no rays. */
enum { GTX_VK_IMAGES = GTX_SLOT_COUNT + 1 };

/* images.h: textures, without their texels. */
typedef struct gtx_vk_images {
    uint32_t count;
    gtx_texture of[GTX_VK_IMAGES];
    VkImage images[GTX_VK_IMAGES];
    VkImageView views[GTX_VK_IMAGES];
    VkDeviceMemory memory;
} gtx_vk_images;

struct gtx_vk_rays {
    gtx_rays *rays;
    gtx_vk_images nodes, maps;    /* maps: cells and outlines */
    gtx_vk_buffer staging;        /* until they are uploaded */
};

struct gtx_vk_shading {
    uint32_t number;
    const gtx_vk_rays *rays;      /* or NULL */
    VkPipelineLayout layout;
    VkShaderModule modules[GTX_PIPELINE_COUNT]; /* by pipeline */
    bool by_tiles;                /* there is one for them */
};

struct gtx_vk_model {
    gtx_model *model;
    gtx_vk_model *next;           /* of those that are retired */
    gtx_vk_images maps;           /* by their slots */
    gtx_vk_images spread;         /* materials, once an edit has made them more than a texel */
    gtx_vk_buffer buffer;         /* all of the model's, ... */
    VkDeviceSize offsets[GTX_BUFFER_GRID_VERTICES]; /* ... where each begins */
    gtx_vk_buffer staging;        /* until it is uploaded */
};

/* model.c: destroys what is retired. */
void gtx_vk_models_free(gtx_vk *vk, gtx_vk_frame *frame);
/* What a slot's binding reads. */
VkDescriptorImageInfo gtx_vk_model_image(const gtx_vk *vk, const gtx_vk_model *model,
                                         uint32_t slot);
/* What rays read, where there are none: nothing occludes. */
void gtx_vk_model_no_rays(const gtx_vk *vk, const gtx_vk_model *model,
                          VkDescriptorImageInfo out[GTX_RAYS_TEXTURES]);
/* Makes room for `count` things of `size`, keeping what is there. False without memory. */
bool gtx_vk_grow(const gtx_vk *vk, void **array, uint32_t *room, uint32_t count, size_t size);

#endif
