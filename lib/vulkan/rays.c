/* Rays in shaders: what is derived is copied into images. */
#include "vulkan/images.h"

#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

enum { NODES = 0, MAPS = GTX_RAYS_TEXTURES - 1 };

/* What a sink sends to. */
typedef struct destination {
    gtx_vk *vk;
    VkCommandBuffer commands;
    gtx_vk_rays *rays;
    gtx_result result;
    gtx_error *error;
} destination;

static void send(const gtx_texture_piece *piece, void *user)
{
    destination *d = user;
    const uint32_t which = piece->binding - GTX_RAYS_BINDING;
    const gtx_vk_images *images = which == NODES ? &d->rays->nodes : &d->rays->maps;
    if (!d->result)
        d->result = gtx_vk_copy_piece(d->vk, d->commands, images, which == NODES ? 0 : which - 1,
                                      piece, d->error);
}

static gtx_result arrange(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_rays *rays,
                          const gtx_ray_instance *instances, uint32_t count, gtx_vk_use before,
                          gtx_error *error)
{
    destination d = {vk, commands, rays, GTX_OK, error};
    const gtx_sink sink = {.texels = send, .user = &d};
    gtx_vk_images_turn(vk, commands, &rays->nodes, before, GTX_VK_WRITTEN);
    const gtx_result result = gtx_rays_arrange(rays->rays, instances, count, &sink, error);
    gtx_vk_images_turn(vk, commands, &rays->nodes, GTX_VK_WRITTEN, GTX_VK_READ);
    return result ? result : d.result;
}

/* Cells and outlines, by a buffer of their own. */
static gtx_result fill(gtx_vk *vk, VkCommandBuffer commands, const gtx_texture maps[MAPS],
                       gtx_vk_rays *out, gtx_error *error)
{
    const VkDeviceSize unit = 16, first = gtx_vk_level_bytes(&maps[0], 0);
    const VkDeviceSize second = (first + unit - 1) / unit * unit;
    gtx_result result =
        gtx_vk_buffer_create(vk, second + gtx_vk_level_bytes(&maps[1], 0),
                             VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true, &out->staging, error);
    if (result)
        return result;
    gtx_vk_images_turn(vk, commands, &out->maps, GTX_VK_NEW, GTX_VK_WRITTEN);
    for (uint32_t i = 0; i < MAPS; ++i) {
        const VkDeviceSize at[GTX_MAX_TEXTURE_LEVELS] = {i ? second : 0};
        gtx_vk_put_level(out->staging.mapped + at[0], &maps[i], 0);
        gtx_vk_copy_levels(vk, commands, &out->maps, i, out->staging.buffer, at);
    }
    gtx_vk_images_turn(vk, commands, &out->maps, GTX_VK_WRITTEN, GTX_VK_READ);
    return GTX_OK;
}

static gtx_result make(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_rays *out, gtx_error *error)
{
    gtx_texture textures[GTX_RAYS_TEXTURES];
    gtx_result result = GTX_OK;
    for (uint32_t i = 0; i < GTX_RAYS_TEXTURES && !result; ++i) {
        gtx_rays_texture(out->rays, i, &textures[i]);
        result = gtx_vk_check_texture(vk, &textures[i], error);
    }
    if (!result && !textures[NODES + 1].texels[0])
        result = gtx_fail(error, GTX_ERROR_ARGUMENT, "the rays' texels have been freed");
    if (!result)
        result = gtx_vk_images_create(vk, &textures[NODES], 1, &out->nodes, error);
    if (!result)
        result = gtx_vk_images_create(vk, &textures[NODES + 1], MAPS, &out->maps, error);
    return result ? result : fill(vk, commands, &textures[NODES + 1], out, error);
}

gtx_result gtx_vk_rays_upload(gtx_vk *vk, VkCommandBuffer commands, gtx_rays *rays,
                              gtx_vk_rays **out, gtx_error *error)
{
    if (!vk || !commands || !rays || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "an upload needs commands and rays");
    *out = NULL;
    gtx_vk_rays *made = gtx_alloc_array(&vk->allocator, 1, sizeof *made);
    if (!made)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for rays");
    made->rays = rays;
    gtx_result result = make(vk, commands, made, error);
    if (!result)
        result = arrange(vk, commands, made, NULL, 0, GTX_VK_NEW, error);
    if (result) {
        gtx_vk_rays_destroy(vk, made);
        return result;
    }
    gtx_rays_uploaded(rays);
    *out = made;
    return GTX_OK;
}

void gtx_vk_rays_uploaded(gtx_vk *vk, gtx_vk_rays *rays)
{
    if (vk && rays)
        gtx_vk_buffer_destroy(vk, &rays->staging);
}

void gtx_vk_rays_destroy(gtx_vk *vk, gtx_vk_rays *rays)
{
    if (!vk || !rays)
        return;
    gtx_vk_images_destroy(vk, &rays->nodes);
    gtx_vk_images_destroy(vk, &rays->maps);
    gtx_vk_buffer_destroy(vk, &rays->staging);
    gtx_free_array(&vk->allocator, rays, 1, sizeof *rays);
}

gtx_result gtx_vk_rays_place(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_rays *rays,
                             const gtx_ray_instance *instances, uint32_t count, gtx_error *error)
{
    if (!vk || !commands || !rays)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "placing needs commands and rays");
    return arrange(vk, commands, rays, instances, count, GTX_VK_READ, error);
}

gtx_result gtx_vk_rays_update(gtx_vk *vk, VkCommandBuffer commands, gtx_vk_rays *rays,
                              uint32_t asset, const gtx_asset *edited, const uint32_t *patches,
                              uint32_t count, gtx_error *error)
{
    destination d = {vk, commands, rays, GTX_OK, error};
    const gtx_sink sink = {.texels = send, .user = &d};
    if (!vk || !commands || !rays || (count && !patches))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an update needs commands, rays and the edited patches");
    gtx_vk_images_turn(vk, commands, &rays->maps, GTX_VK_READ, GTX_VK_WRITTEN);
    for (uint32_t i = 0; i < count && !d.result; ++i) {
        const gtx_result result = gtx_rays_edit(rays->rays, asset, edited, patches[i], &sink,
                                                error);
        d.result = d.result ? d.result : result;
    }
    gtx_vk_images_turn(vk, commands, &rays->maps, GTX_VK_WRITTEN, GTX_VK_READ);
    return d.result;
}

void gtx_vk_rays_images(const gtx_vk *vk, const gtx_vk_rays *rays,
                        VkDescriptorImageInfo out[GTX_RAYS_TEXTURES])
{
    if (!vk || !rays || !out)
        return;
    for (uint32_t i = 0; i < GTX_RAYS_TEXTURES; ++i)
        out[i] = i == NODES ? gtx_vk_image_info(vk, &rays->nodes, 0)
                            : gtx_vk_image_info(vk, &rays->maps, i - 1);
}
