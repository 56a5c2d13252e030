/* Models on the CPU's side: everything the GPU needs, derived from an asset without OpenGL. */
#include "render/renderer.h"

#include "base/alloc.h"
#include "base/error.h"
#include "base/hash.h"

#include <math.h>
#include <string.h>

/* Adds a level of `unit` and its memory; NULL when there is none. */
static uint8_t *add_level(gtx_model *model, uint32_t unit, uint32_t level, uint32_t width,
                          uint32_t height, uint32_t layers, uint32_t texel_size)
{
    gtx_level *l = &model->levels[model->level_count++];
    *l = (gtx_level){unit, level, width, height, layers, texel_size, 0, NULL};
    l->data = gtx_alloc_array(&model->allocator, (size_t)width * height * layers, texel_size);
    const bool looks = unit == UNIT_COLORS || unit == UNIT_MATERIALS || unit == UNIT_EMISSIONS;
    uint64_t *size = looks ? &model->size.color : &model->size.geometry;
    *size += (uint64_t)width * height * layers * texel_size;
    return l->data;
}

static bool copy_levels(gtx_model *model, const gtx_asset *asset, gtx_map map, uint32_t unit,
                        uint32_t count, uint32_t texel_size)
{
    for (uint32_t k = 0; k < count; ++k) {
        size_t size;
        const void *texels = gtx_map_data(asset, map, k, &size);
        if (!texels) /* an optional map */
            return true;
        uint8_t *copy = add_level(model, unit, k, asset->info.page_width >> k,
                                  asset->info.page_height >> k, asset->info.page_count, texel_size);
        if (!copy)
            return false;
        memcpy(copy, texels, size);
    }
    return true;
}

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

/* One array of each, in order of the kinds. */
static gtx_result join_proxies(gtx_model *model, gtx_derived *derived, gtx_error *error)
{
    uint32_t vertices = 0, indices = 0;
    for (uint32_t kind = 0; kind < model->kind_count; ++kind) {
        const gtx_proxies *p = &derived->proxies[kind];
        gtx_result result = gtx_proxies_reserve(&model->proxies, p->vertex_count, p->index_count,
                                                &model->allocator, error);
        if (result)
            return result;
        if (p->vertex_count)
            memcpy(model->proxies.vertices + vertices, p->vertices,
                   p->vertex_count * sizeof *p->vertices);
        for (uint32_t i = 0; i < p->index_count; ++i)
            model->proxies.indices[indices + i] = p->indices[i] + vertices;
        for (uint32_t i = 0; i < model->patch_count; ++i) {
            model->first_vertex[kind * model->patch_count + i] += vertices;
            model->first_index[kind * model->patch_count + i] += indices;
        }
        model->proxies.vertex_count = vertices += p->vertex_count;
        model->proxies.index_count = indices += p->index_count;
    }
    model->first_vertex[model->kind_count * model->patch_count] = vertices;
    model->first_index[model->kind_count * model->patch_count] = indices;
    return GTX_OK;
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

/* Cells of all levels, records and proxies. `records` and `pages` are where they go. */
static gtx_result derive_patches(gtx_model *model, const gtx_asset *asset,
                                 float (*records)[GTX_RECORD_TEXELS][4], uint8_t *pages,
                                 gtx_derived *derived, gtx_error *error)
{
    const gtx_info *info = &asset->info;
    const size_t cell_size = info->height_bits / 2;
    gtx_result result = GTX_OK;
    for (uint32_t i = 0; !result && i < info->patch_count; ++i) {
        const gtx_patch *p = &asset->patches[i];
        for (uint32_t k = 0; k < info->mip_count; ++k) {
            uint32_t at[2];
            gtx_model_cells_at(model, p, k, at);
            const size_t row = (size_t)p->page * gtx_model_cell_rows(model) + at[1];
            derived->row_texels[k] = info->page_width;
            derived->cells[k] = pages + (row * info->page_width + at[0]) * cell_size;
            derived->slabs[k] = model->slabs + model->first_slab[k * info->patch_count + i];
        }
        for (uint32_t kind = 0; kind < model->kind_count; ++kind) {
            model->first_vertex[kind * info->patch_count + i] = derived->proxies[kind].vertex_count;
            model->first_index[kind * info->patch_count + i] = derived->proxies[kind].index_count;
        }
        result = gtx_patch_derive(asset, i, &model->allocator, derived, error);
        memcpy(records[i], derived->record, sizeof derived->record);
        memcpy(model->records[i], derived->record, sizeof derived->record);
        model->facts[i] = derived->facts;
    }
    if (!result)
        result = join_proxies(model, derived, error);
    for (uint32_t kind = 0; kind < model->kind_count; ++kind)
        gtx_proxies_free(&derived->proxies[kind], &model->allocator);
    return result;
}

/* Makes room for the slabs. */
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
        count += gtx_slab_count(&asset->patches[i % model->patch_count], i / model->patch_count);
    }
    if (!model->first_slab || !model->records || count > UINT32_MAX)
        return false;
    model->first_slab[slots] = (uint32_t)count;
    model->slabs = gtx_alloc_array(&model->allocator, (size_t)count, sizeof *model->slabs);
    return model->slabs;
}

static gtx_result derive_sheets(gtx_model *model, const gtx_asset *asset, gtx_error *error)
{
    const gtx_info *info = &asset->info;
    const size_t slots = (size_t)model->kind_count * model->patch_count + 1;
    float (*records)[GTX_RECORD_TEXELS][4] =
        (void *)add_level(model, UNIT_PATCHES, 0, GTX_RECORD_TEXELS * GTX_RECORDS_A_ROW,
                          gtx_model_record_rows(model->patch_count), 1, 4 * sizeof(float));
    gtx_derived derived = {0};
    model->first_vertex = gtx_alloc_array(&model->allocator, slots, sizeof *model->first_vertex);
    model->first_index = gtx_alloc_array(&model->allocator, slots, sizeof *model->first_index);
    model->facts = gtx_alloc_array(&model->allocator, model->patch_count, sizeof *model->facts);
    uint8_t *pages = add_level(model, UNIT_CELLS, 0, info->page_width, gtx_model_cell_rows(model),
                               info->page_count, info->height_bits / 2);
    if (!reserve_slabs(model, asset) || !records || !pages || !model->first_vertex ||
        !model->first_index || !model->facts)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the model's maps");
    gtx_result result = derive_patches(model, asset, records, pages, &derived, error);
    for (int k = 0; k < 3; ++k)
        model->sphere[k] = (info->bounds_min[k] + info->bounds_max[k]) / 2;
    gtx_model_sum_up(model);
    return result;
}

gtx_result gtx_model_prepare(const gtx_asset *asset, const gtx_allocator *allocator,
                             gtx_model **out, gtx_error *error)
{
    if (!asset || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a model needs an asset");
    *out = NULL;
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    gtx_model *model = gtx_alloc_array(&hooks, 1, sizeof *model);
    if (!model)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a model");
    model->allocator = hooks;
    model->height_bits = asset->info.height_bits;
    model->mip_count = asset->info.mip_count;
    model->patch_count = asset->info.patch_count;
    model->has_color = asset->info.has_color;
    model->has_material = asset->info.has_material;
    model->has_emission = asset->info.has_emission;
    model->emission_scale = asset->info.has_emission ? asset->info.emission_scale : 0;
    model->page_count = asset->info.page_count;
    model->page_width = asset->info.page_width;
    model->page_height = asset->info.page_height;
    model->layout = gtx_model_layout(asset);
    const uint32_t mips = model->mip_count;
    model->kind_count = 1 + mips;
    gtx_result result = derive_sheets(model, asset, error);
    if (!result)
        result = gtx_shells_prepare(asset, &hooks, &model->shells, error);
    if (!result && !(copy_levels(model, asset, GTX_MAP_TRIM, UNIT_TRIM, 1, 1) &&
                     copy_levels(model, asset, GTX_MAP_NORMAL, UNIT_NORMALS, mips, 2) &&
                     copy_levels(model, asset, GTX_MAP_COLOR, UNIT_COLORS, mips, 4) &&
                     copy_levels(model, asset, GTX_MAP_MATERIAL, UNIT_MATERIALS, mips, 4) &&
                     copy_levels(model, asset, GTX_MAP_EMISSION, UNIT_EMISSIONS, mips, 3)))
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the model's maps");
    if (result) {
        gtx_model_destroy(NULL, model);
        return result;
    }
    model->size.geometry += (uint64_t)model->proxies.index_count * sizeof *model->proxies.indices +
                            (uint64_t)model->proxies.vertex_count * sizeof *model->proxies.vertices +
                            model->shells.vertex_bytes + model->shells.index_bytes;
    *out = model;
    return GTX_OK;
}

void gtx_model_free_staging(gtx_model *model)
{
    for (uint32_t i = 0; i < model->level_count; ++i) {
        gtx_level *l = &model->levels[i];
        gtx_free_array(&model->allocator, l->data, (size_t)l->width * l->height * l->layers,
                       l->texel_size);
        l->data = NULL;
    }
    gtx_proxies_free(&model->proxies, &model->allocator);
    gtx_shells_free_staging(&model->shells, &model->allocator);
}

gtx_model_size gtx_model_gpu_size(const gtx_model *model)
{
    return model ? model->size : (gtx_model_size){0, 0};
}
