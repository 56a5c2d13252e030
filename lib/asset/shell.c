/* Shell sections as bytes, and what the public accessor shows of them. */
#include "asset/shell.h"

#include "base/bytes.h"
#include "base/error.h"

bool gtx_shell_load(const uint8_t *bytes, uint64_t size, uint32_t patches, gtx_shell *out)
{
    if (size < GTX_SHELL_HEADER)
        return false;
    *out = (gtx_shell){.step = gtx_load_f32(bytes + 12), .error = gtx_load_f32(bytes + 16),
                       .vertex_count = gtx_load_u32(bytes + 20),
                       .triangle_count = gtx_load_u32(bytes + 24),
                     .flags = gtx_load_u32(bytes + 28)};
    for (int k = 0; k < 3; ++k)
        out->origin[k] = gtx_load_f32(bytes + 4 * k);
    if (size != gtx_shell_size(patches, out->vertex_count, out->triangle_count))
        return false;
    /* The bytes of an asset are aligned to 16. */
    const uint8_t *first = bytes + GTX_SHELL_HEADER;
    const uint8_t *indices = first + 4 * ((size_t)patches + 1);
    out->first = (const uint32_t *)(const void *)first;
    out->indices = (const uint32_t *)(const void *)indices;
    out->positions = (const uint16_t *)(const void *)(indices + 12 * (size_t)out->triangle_count);
    return true;
}

void gtx_shell_store(const gtx_shell *shell, uint32_t patches, uint8_t *out)
{
    for (int k = 0; k < 3; ++k)
        gtx_store_f32(out + 4 * k, shell->origin[k]);
    gtx_store_f32(out + 12, shell->step);
    gtx_store_f32(out + 16, shell->error);
    gtx_store_u32(out + 20, shell->vertex_count);
    gtx_store_u32(out + 24, shell->triangle_count);
    gtx_store_u32(out + 28, shell->flags);
    const size_t first = 4 * ((size_t)patches + 1), indices = 12 * (size_t)shell->triangle_count;
    memcpy(out + GTX_SHELL_HEADER, shell->first, first);
    memcpy(out + GTX_SHELL_HEADER + first, shell->indices, indices);
    memcpy(out + GTX_SHELL_HEADER + first + indices, shell->positions,
           6 * (size_t)shell->vertex_count);
}

gtx_result gtx_get_shell(const gtx_asset *asset, uint32_t level, gtx_shell *out)
{
    if (!out || level >= asset->info.shell_levels)
        return GTX_ERROR_ARGUMENT;
    gtx_shell_load(asset->shell[level], asset->shell_size[level], asset->info.patch_count, out);
    return GTX_OK;
}
