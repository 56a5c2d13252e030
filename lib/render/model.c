/* Models on the CPU's side: what they are asked for, and their end. */
#include "render/model.h"

#include "base/alloc.h"
#include "base/hash.h"

#include <math.h>

uint64_t gtx_model_layout(const gtx_asset *asset)
{
    gtx_hash hash;
    gtx_hash_begin(&hash);
    for (uint32_t i = 0; i < asset->info.patch_count; ++i) {
        const gtx_patch *p = &asset->patches[i];
        gtx_hash_add(&hash, &p->page, sizeof p->page);
        gtx_hash_add(&hash, p->rect, sizeof p->rect);
    }
    return gtx_hash_end(&hash);
}

void gtx_model_sum_up(gtx_model *model)
{
    double radius = 0;
    model->coarsest_error = 0;
    model->boxed_count = 0;
    for (uint32_t i = 0; i < model->patch_count; ++i) {
        const gtx_patch_facts *facts = &model->facts[i];
        const float error = facts->error[model->mip_count - 1];
        double square = 0;
        for (int k = 0; k < 3; ++k)
            square += ((double)facts->hull[k] - model->sphere[k]) *
                      ((double)facts->hull[k] - model->sphere[k]);
        radius = fmax(radius, sqrt(square) + facts->hull[3]);
        model->coarsest_error = error > model->coarsest_error ? error : model->coarsest_error;
        model->boxed_count += facts->boxed;
    }
    model->sphere[3] = (float)(radius * 1.0001);
}

uint32_t gtx_model_cell_rows(const gtx_model *model)
{
    return model->page_height + (model->mip_count > 1 ? model->page_height / 2 : 0);
}

void gtx_model_cells_at(const gtx_model *model, const gtx_patch *patch, uint32_t level,
                        uint32_t at[2])
{
    at[0] = (patch->rect[0] >> level) +
            (level ? model->page_width - (model->page_width >> (level - 1)) : 0);
    at[1] = (patch->rect[1] >> level) + (level ? model->page_height : 0);
}

void gtx_model_free_staging(gtx_model *model)
{
    for (uint32_t i = 0; i < model->level_count; ++i) {
        gtx_level *l = &model->levels[i];
        if (!l->borrowed)
            gtx_free_array(&model->allocator, l->data, (size_t)l->width * l->height * l->layers,
                           l->texel_size);
        l->data = NULL;
    }
    gtx_proxies_free(&model->proxies, &model->allocator);
    gtx_lod_free_staging(&model->lods, &model->allocator);
}

void gtx_model_free(gtx_model *model)
{
    gtx_model_free_staging(model);
    const gtx_allocator hooks = model->allocator;
    gtx_lod_free(&model->lods, &hooks);
    const size_t slots = (size_t)model->kind_count * model->patch_count + 1;
    gtx_free_array(&hooks, model->first_vertex, slots, sizeof *model->first_vertex);
    gtx_free_array(&hooks, model->first_index, slots, sizeof *model->first_index);
    gtx_free_array(&hooks, model->facts, model->patch_count, sizeof *model->facts);
    gtx_free_array(&hooks, model->records, model->patch_count, sizeof *model->records);
    if (model->first_slab) {
        const size_t count = model->first_slab[model->mip_count * model->patch_count];
        gtx_free_array(&hooks, model->slabs, count, sizeof *model->slabs);
        gtx_free_array(&hooks, model->blocks, model->first_slab[model->patch_count],
                       sizeof *model->blocks);
    }
    gtx_free_array(&hooks, model->first_slab, (size_t)model->mip_count * model->patch_count + 1,
                   sizeof *model->first_slab);
    gtx_free_array(&hooks, model, 1, sizeof *model);
}

gtx_model_size gtx_model_gpu_size(const gtx_model *model)
{
    return model ? model->size : (gtx_model_size){0, 0};
}

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

bool gtx_model_reserve_slabs(gtx_model *model, const gtx_asset *asset)
{
    const uint32_t slots = model->mip_count * model->patch_count;
    uint64_t count = 0;
    model->records = gtx_alloc_array(&model->allocator, model->patch_count,
                                     sizeof *model->records);
    model->first_slab = gtx_alloc_array(&model->allocator, (size_t)slots + 1,
                                        sizeof *model->first_slab);
    for (uint32_t i = 0; model->first_slab && i < slots; ++i) {
        model->first_slab[i] = (uint32_t)count;
        count += gtx_slab_count(&asset->patches[i % model->patch_count], i / model->patch_count);
    }
    if (!model->first_slab || !model->records || count > UINT32_MAX)
        return false;
    model->first_slab[slots] = (uint32_t)count;
    if (gtx_model_patch_rows(model) > MAX_PATCH_ROWS)
        return false;
    model->slabs = gtx_alloc_raw(&model->allocator, (size_t)count, sizeof *model->slabs);
    model->blocks = gtx_alloc_raw(&model->allocator, model->first_slab[model->patch_count],
                                  sizeof *model->blocks);
    return model->slabs && model->blocks;
}
