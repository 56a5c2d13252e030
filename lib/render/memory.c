/* What making a model takes, known before it is taken. */
#include "render/model.h"

/* A hull has a vertex above and one below each corner of its blocks, and seven quads a block at
 * most: lid, floor and walls. Arrays that grow and their copy take two and a half times as much. */
static uint64_t hull_bytes(uint64_t wide, uint64_t high)
{
    enum { QUADS = 7 };
    const uint64_t vertices = 2 * (wide + 1) * (high + 1) * sizeof(gtx_proxy_vertex);
    return (vertices + wide * high * QUADS * 6 * sizeof(uint32_t)) * 5 / 2;
}

/* Of one level of a patch: its slabs, its hull, and where they begin. */
static uint64_t level_bytes(const gtx_patch *patch, uint32_t level)
{
    const uint64_t wide = ((patch->rect[2] - 2u) >> level) + 1;
    const uint64_t high = ((patch->rect[3] - 2u) >> level) + 1;
    return gtx_slab_count(patch, level) * sizeof(gtx_slab) + 3 * sizeof(uint32_t) +
           hull_bytes((wide + GTX_HULL_BLOCK - 1) / GTX_HULL_BLOCK,
                      (high + GTX_HULL_BLOCK - 1) / GTX_HULL_BLOCK);
}

/* Record, facts and box of a patch. */
static uint64_t patch_bytes(void)
{
    const uint64_t box = GTX_BOX_VERTICES * sizeof(gtx_proxy_vertex) +
                         GTX_BOX_INDICES * sizeof(uint32_t);
    return 2 * sizeof(gtx_record) + sizeof(gtx_patch_facts) + 2 * sizeof(uint32_t) + box * 5 / 2;
}

uint64_t gtx_model_memory(const gtx_asset *asset, bool borrow)
{
    const gtx_info *info = &asset->info;
    const uint64_t texels = (uint64_t)info->page_count * info->page_width * info->page_height;
    const uint32_t maps = 3 + 4 * info->has_color + 4 * info->has_material + 3 * info->has_emission;
    const uint64_t cells = texels * (info->height_bits / 2);
    uint64_t bytes = cells + (info->mip_count > 1 ? cells / 2 : 0);
    bytes += borrow ? 0 : texels * maps + (info->mip_count > 1 ? texels * maps / 3 : 0);
    for (uint32_t i = 0; i < info->patch_count; ++i) {
        bytes += patch_bytes();
        for (uint32_t k = 0; k < info->mip_count; ++k)
            bytes += level_bytes(&asset->patches[i], k);
    }
    return bytes;
}
