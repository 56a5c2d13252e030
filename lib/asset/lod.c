/* LOD mesh sections as bytes, and what the public accessor shows of them. */
#include "asset/lod.h"

#include "base/bytes.h"
#include "base/error.h"

bool gtx_lod_load(const uint8_t *bytes, uint64_t size, uint32_t patches, gtx_lod_mesh *out)
{
    if (size < GTX_LOD_HEADER)
        return false;
    *out = (gtx_lod_mesh){.step = gtx_load_f32(bytes + 12), .error = gtx_load_f32(bytes + 16),
                          .vertex_count = gtx_load_u32(bytes + 20),
                          .triangle_count = gtx_load_u32(bytes + 24),
                     .flags = gtx_load_u32(bytes + 28)};
    for (int k = 0; k < 3; ++k)
        out->origin[k] = gtx_load_f32(bytes + 4 * k);
    const uint64_t plain = gtx_lod_size(patches, out->vertex_count, out->triangle_count);
    if (size != plain + gtx_lod_normals_size(out->flags, out->vertex_count))
        return false;
    /* The bytes of an asset are aligned to 16. */
    const uint8_t *first = bytes + GTX_LOD_HEADER;
    const uint8_t *indices = first + 4 * ((size_t)patches + 1);
    out->first = (const uint32_t *)(const void *)first;
    out->indices = (const uint32_t *)(const void *)indices;
    out->positions = (const uint16_t *)(const void *)(indices + 12 * (size_t)out->triangle_count);
    if (out->flags & GTX_LOD_NORMALS) {
        out->normals = bytes + plain;
        out->normal_error = gtx_load_f32(out->normals + 2 * (size_t)out->vertex_count);
    }
    return true;
}

void gtx_lod_store(const gtx_lod_mesh *lod, uint32_t patches, uint8_t *out)
{
    for (int k = 0; k < 3; ++k)
        gtx_store_f32(out + 4 * k, lod->origin[k]);
    gtx_store_f32(out + 12, lod->step);
    gtx_store_f32(out + 16, lod->error);
    gtx_store_u32(out + 20, lod->vertex_count);
    gtx_store_u32(out + 24, lod->triangle_count);
    gtx_store_u32(out + 28, lod->flags);
    const size_t first = 4 * ((size_t)patches + 1), indices = 12 * (size_t)lod->triangle_count;
    memcpy(out + GTX_LOD_HEADER, lod->first, first);
    memcpy(out + GTX_LOD_HEADER + first, lod->indices, indices);
    const size_t vertices = lod->vertex_count;
    out += GTX_LOD_HEADER + first + indices;
    memcpy(out, lod->positions, 6 * vertices);
    if (lod->flags & GTX_LOD_NORMALS) {
        memcpy(out + 6 * vertices, lod->normals, 2 * vertices);
        gtx_store_f32(out + 8 * vertices, lod->normal_error);
    }
}

gtx_result gtx_get_lod_mesh(const gtx_asset *asset, uint32_t level, gtx_lod_mesh *out)
{
    if (!out || level >= asset->info.lod_levels)
        return GTX_ERROR_ARGUMENT;
    gtx_lod_load(asset->lod[level], asset->lod_size[level], asset->info.patch_count, out);
    return GTX_OK;
}
