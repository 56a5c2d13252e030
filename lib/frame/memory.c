/* An upper bound on the memory that making a model takes, from the sizes of its asset. */
#include "frame/model.h"

/* A hull has a vertex above and one below each corner of its blocks, and seven quads a block at
 * most: lid, floor and walls. Arrays that grow by halves, and one of all, take three times as
 * much. */
enum { GROWTH = 3 };

static uint64_t hull_bytes(uint64_t wide, uint64_t high)
{
    enum { QUADS = 7 };
    const uint64_t vertices = 2 * (wide + 1) * (high + 1) * sizeof(gtx_proxy_vertex);
    return (vertices + wide * high * QUADS * 6 * sizeof(uint32_t)) * GROWTH;
}

/* Of one level of a patch: its slabs, its hull, and where they begin. */
static uint64_t level_bytes(const gtx_patch *patch, uint32_t level)
{
    const uint64_t wide = ((patch->rect[2] - 2u) >> level) + 1;
    const uint64_t high = ((patch->rect[3] - 2u) >> level) + 1;
    const uint64_t slab = sizeof(gtx_slab) + sizeof(gtx_slab_texel) +
                          (level ? 0 : sizeof(gtx_rtin_block));
    return gtx_slab_count(patch, level) * slab + 3 * sizeof(uint32_t) +
           hull_bytes((wide + GTX_HULL_BLOCK - 1) / GTX_HULL_BLOCK,
                      (high + GTX_HULL_BLOCK - 1) / GTX_HULL_BLOCK);
}

/* Record, facts and box of a patch. */
static uint64_t patch_bytes(void)
{
    const uint64_t box = GTX_BOX_VERTICES * sizeof(gtx_proxy_vertex) +
                         GTX_BOX_INDICES * sizeof(uint32_t);
    return 2 * sizeof(gtx_record) + sizeof(gtx_patch_facts) + sizeof(gtx_rtin) +
           sizeof(size_t) + 2 * sizeof(uint32_t) + box * GROWTH;
}

/* A vertex may be there once for each triangle that has it. */
static uint64_t lod_bytes(const gtx_asset *asset)
{
    enum { COPIES = 32 };     /* bytes of a vertex while a level is made */
    enum { OPENINGS = 24, EDGES = 12 }; /* of a vertex and a triangle, to find openings */
    enum { PATCH = 5 };       /* of gtx_lod_meshes: order and edited */
    const uint64_t triangle = 3 * (sizeof(gtx_lod_vertex) + sizeof(uint32_t));
    const uint64_t patch = sizeof(uint32_t) + sizeof(gtx_lod_run);
    uint64_t bytes = asset->info.lod_levels ? PATCH * (uint64_t)asset->info.patch_count : 0;
    for (uint32_t k = 0; k < asset->info.lod_levels; ++k) {
        gtx_lod_mesh level;
        gtx_get_lod_mesh(asset, k, &level);
        bytes += triangle * level.triangle_count + COPIES * (uint64_t)level.vertex_count +
                 patch * (asset->info.patch_count + 1u);
        if (k == 0)
            bytes += OPENINGS * (uint64_t)level.vertex_count + EDGES * level.triangle_count;
    }
    return bytes;
}

/* Heights of a patch while its levels are derived, of as many patches as there may be jobs. */
static uint64_t work_bytes(const gtx_asset *asset)
{
    enum { TEXEL = 32, JOBS = 64 };
    const uint32_t count = asset->info.patch_count;
    uint64_t most = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint64_t texels = (uint64_t)asset->patches[i].rect[2] * asset->patches[i].rect[3];
        most = texels > most ? texels : most;
    }
    return TEXEL * most * (count < JOBS ? count : JOBS) + sizeof(gtx_derived) * JOBS;
}

uint64_t gtx_model_memory(const gtx_asset *asset, const gtx_model_desc *desc)
{
    const gtx_info *info = &asset->info;
    const uint64_t texels = (uint64_t)info->page_count * info->page_width * info->page_height;
    const uint32_t maps = 3 + 4 * info->has_color + 4 * info->has_material + 3 * info->has_emission;
    const uint64_t cells = texels * (info->height_bits / 8) * (info->mip_count > 1 ? 3 : 1);
    uint64_t bytes = sizeof(gtx_model) + lod_bytes(asset) + work_bytes(asset) + cells;
    if (!desc->borrow || desc->compress)
        bytes += texels * maps + (info->mip_count > 1 ? texels * maps / 3 : 0);
    bytes += 2 * GTX_PATCHES_ROW * sizeof(gtx_slab_texel); /* rows that are not full */
    for (uint32_t i = 0; i < info->patch_count; ++i) {
        bytes += patch_bytes() + gtx_rtin_nodes(&asset->patches[i]) * sizeof(gtx_rtin_node);
        for (uint32_t k = 0; k < info->mip_count; ++k)
            bytes += level_bytes(&asset->patches[i], k);
    }
    return bytes;
}
