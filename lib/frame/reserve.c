/* Room for what a model keeps of the blocks of its patches. */
#include "frame/model.h"

#include "base/alloc.h"

static uint32_t record_rows(const gtx_model *model)
{
    return (model->patch_count + GTX_RECORDS_A_ROW - 1) / GTX_RECORDS_A_ROW;
}

uint32_t gtx_model_patch_rows(const gtx_model *model)
{
    const uint32_t slabs = model->first_slab[model->mip_count * model->patch_count];
    return record_rows(model) + (slabs + GTX_PATCHES_ROW - 1) / GTX_PATCHES_ROW;
}

uint32_t gtx_model_slabs_at(const gtx_model *model, uint32_t patch, uint32_t level)
{
    return record_rows(model) * GTX_PATCHES_ROW +
           model->first_slab[level * model->patch_count + patch];
}

/* Shaders are told in floats where slabs are. */
enum { MAX_PATCH_ROWS = (1 << 24) / GTX_PATCHES_ROW };

static bool reserve_slabs(gtx_model *model, const gtx_asset *asset)
{
    const uint32_t slots = model->mip_count * model->patch_count;
    uint64_t count = 0;
    model->records = gtx_alloc_array(&model->allocator, model->patch_count,
                                     sizeof *model->records);
    model->first_slab = gtx_alloc_array(&model->allocator, (size_t)slots + 1,
                                        sizeof *model->first_slab);
    for (uint32_t i = 0; model->first_slab && i < slots; ++i) {
        model->first_slab[i] = (uint32_t)count;
        count += asset->bare ? 0
                             : gtx_slab_count(&asset->patches[i % model->patch_count],
                                              i / model->patch_count);
    }
    if (!model->first_slab || !model->records || count > UINT32_MAX)
        return false;
    model->first_slab[slots] = (uint32_t)count;
    if (gtx_model_patch_rows(model) > MAX_PATCH_ROWS)
        return false;
    model->slabs = gtx_alloc_raw(&model->allocator, (size_t)count, sizeof *model->slabs);
    return model->slabs || !count;
}

/* For displaced grids, after the slabs. */
static bool reserve_grids(gtx_model *model, const gtx_asset *asset)
{
    const gtx_allocator *hooks = &model->allocator;
    const uint32_t count = model->patch_count;
    model->blocks = gtx_alloc_raw(hooks, model->first_slab[count], sizeof *model->blocks);
    model->rtins = gtx_alloc_array(hooks, count, sizeof *model->rtins);
    model->first_node = gtx_alloc_array(hooks, (size_t)count + 1, sizeof *model->first_node);
    if (!model->first_node)
        return false;
    for (uint32_t i = 0; i < count; ++i)
        model->first_node[i + 1] =
            model->first_node[i] + (asset->bare ? 0 : gtx_rtin_nodes(&asset->patches[i]));
    model->nodes = gtx_alloc_raw(hooks, model->first_node[count], sizeof *model->nodes);
    return asset->bare || (model->blocks && model->rtins && model->nodes);
}

bool gtx_model_reserve_blocks(gtx_model *model, const gtx_asset *asset)
{
    return reserve_slabs(model, asset) && reserve_grids(model, asset);
}
