/* Models as textures and buffers, for whoever submits them. */
#include "frame/model.h"

#include <string.h>

_Static_assert(GTX_MAX_TEXTURE_LEVELS == GTX_MAX_MIPS, "frame.h has room for all levels");

uint32_t gtx_model_texture(const gtx_model *model, gtx_slot slot, gtx_texture *out)
{
    if (!out)
        return 0;
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; model && i < model->level_count; ++i) {
        const gtx_level *l = &model->levels[i];
        if (l->unit != (uint32_t)slot)
            continue;
        if (!l->level)
            *out = (gtx_texture){
                .format = model->formats[l->unit], .texel_size = l->texel_size,
                .block_size = l->block_size,
                .width = l->width, .height = l->height, .layers = l->layers,
                .is_array = l->unit != UNIT_PATCHES,
                .is_filtered = l->unit == UNIT_NORMALS || l->unit == UNIT_COLORS ||
                               l->unit == UNIT_MATERIALS || l->unit == UNIT_EMISSIONS};
        out->texels[l->level] = l->data;
        ++out->levels;
    }
    return out->levels > 0;
}

const void *gtx_model_buffer(const gtx_model *model, gtx_buffer buffer, uint64_t *size)
{
    const void *data = NULL;
    uint64_t bytes = 0;
    if (model && buffer == GTX_BUFFER_PROXY_VERTICES) {
        data = model->proxies.vertices;
        bytes = model->proxies.vertex_count * (uint64_t)sizeof *model->proxies.vertices;
    } else if (model && buffer == GTX_BUFFER_PROXY_INDICES) {
        data = model->proxies.indices;
        bytes = model->proxies.index_count * (uint64_t)model->proxy_index_size;
    } else if (model && buffer == GTX_BUFFER_LOD_VERTICES) {
        data = model->lods.vertices;
        bytes = model->lods.vertex_bytes;
    } else if (model && buffer == GTX_BUFFER_LOD_INDICES) {
        data = model->lods.indices;
        bytes = model->lods.index_bytes;
    }
    if (size)
        *size = bytes;
    return data;
}

void gtx_model_uploaded(gtx_model *model)
{
    if (model)
        gtx_model_free_staging(model);
}
