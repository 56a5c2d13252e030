/* Textures as images, in one piece of memory. */
#ifndef GTX_VULKAN_IMAGES_H
#define GTX_VULKAN_IMAGES_H

#include "vulkan/device.h"

/* What images are to be used for. */
typedef enum gtx_vk_use { GTX_VK_NEW, GTX_VK_WRITTEN, GTX_VK_READ } gtx_vk_use;

/* Errors: LIMIT, UNSUPPORTED (blocks that the device does not read). */
gtx_result gtx_vk_check_texture(const gtx_vk *vk, const gtx_texture *t, gtx_error *error);
/* Makes images of `count` textures, whose texels are not looked at. What was made is to be
 * destroyed after an error, too. Errors: GL. */
gtx_result gtx_vk_images_create(const gtx_vk *vk, const gtx_texture *textures, uint32_t count,
                                gtx_vk_images *out, gtx_error *error);
void gtx_vk_images_destroy(const gtx_vk *vk, gtx_vk_images *images);
/* Records that all of them are used otherwise from then on. */
void gtx_vk_images_turn(const gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_images *images,
                        gtx_vk_use from, gtx_vk_use to);
/* Bytes of a level as the device has it, and those, of the texture's texels. */
VkDeviceSize gtx_vk_level_bytes(const gtx_texture *t, uint32_t level);
void gtx_vk_put_level(uint8_t *to, const gtx_texture *t, uint32_t level);
/* Records that all levels of an image are copied from where they are in a buffer. */
void gtx_vk_copy_levels(const gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_images *images,
                        uint32_t which, VkBuffer from,
                        const VkDeviceSize at[GTX_MAX_TEXTURE_LEVELS]);
/* Copies a piece through the frame's memory. Errors: MEMORY, GL. */
gtx_result gtx_vk_copy_piece(gtx_vk *vk, VkCommandBuffer commands, const gtx_vk_images *images,
                             uint32_t which, const gtx_texture_piece *piece, gtx_error *error);
/* What a shader is bound to. */
VkDescriptorImageInfo gtx_vk_image_info(const gtx_vk *vk, const gtx_vk_images *images,
                                        uint32_t which);

#endif
