/* The making of models: everything the GPU needs, derived from an asset without OpenGL. */
#include "frame/model.h"

#include "base/alloc.h"
#include "base/error.h"
#include "base/jobs.h"
#include "derive/crowd.h"

#include <string.h>

/* What one job derives: some patches, one after the other. */
typedef struct batch {
    uint32_t first, end;
    gtx_derived derived;
    gtx_result result;
    gtx_error error;
} batch;

/* A model in the making. */
typedef struct making {
    gtx_model *model;
    const gtx_asset *asset;
    gtx_record *records;
    uint8_t *pages;               /* of cells */
    batch *batches;
    uint32_t batch_count;
    bool borrow, first_provokes;
    const void *sources[GTX_MAX_LEVELS]; /* of levels that are copies, or NULL */
} making;

/* Batches of patches, and pieces of each map: enough for many threads to end together, and each to
 * have enough to do. */
enum { MAX_BATCHES = 64, PIECES = 4 };

/* Adds a level and its memory, not yet written, unless it borrows what is there already. NULL
 * without memory. */
static uint8_t *add_level(gtx_model *model, gtx_level level)
{
    gtx_level *l = &model->levels[model->level_count++];
    const size_t texels = (size_t)level.width * level.height * level.layers;
    const bool looks = level.unit == UNIT_COLORS || level.unit == UNIT_MATERIALS ||
                       level.unit == UNIT_EMISSIONS;
    *l = level;
    if (!l->borrowed)
        l->data = gtx_alloc_raw(&model->allocator, texels, l->texel_size);
    *(looks ? &model->size.color : &model->size.geometry) += (uint64_t)texels * l->texel_size;
    return l->data;
}

static size_t level_size(const gtx_level *l)
{
    return (size_t)l->width * l->height * l->layers * l->texel_size;
}

/* Levels that are a map's, or are to be copies of them. */
static bool add_maps(making *m, gtx_map map, uint32_t unit, uint32_t count, uint32_t texel_size)
{
    const gtx_info *info = &m->asset->info;
    for (uint32_t k = 0; k < count; ++k) {
        const void *texels = gtx_map_data(m->asset, map, k, NULL);
        if (!texels) /* an optional map */
            return true;
        m->sources[m->model->level_count] = m->borrow ? NULL : texels;
        if (!add_level(m->model, (gtx_level){.unit = unit, .level = k,
                                             .width = info->page_width >> k,
                                             .height = info->page_height >> k,
                                             .layers = info->page_count, .texel_size = texel_size,
                                             .data = m->borrow ? (uint8_t *)texels : NULL,
                                             .borrowed = m->borrow}))
            return false;
    }
    return true;
}

/* Joins the batches' proxies: one array of vertices and one of indices, ordered by kind. */
static gtx_result join_proxies(const making *m, gtx_error *error)
{
    gtx_model *model = m->model;
    gtx_proxies *all = &model->proxies;
    size_t most_vertices = 0, most_indices = 0;
    for (uint32_t kind = 0; kind < model->kind_count; ++kind)
        for (uint32_t b = 0; b < m->batch_count; ++b) {
            most_vertices += m->batches[b].derived.proxies[kind].vertex_count;
            most_indices += m->batches[b].derived.proxies[kind].index_count;
        }
    gtx_result result = gtx_proxies_reserve(all, most_vertices, most_indices, &model->allocator,
                                            error);
    if (result)
        return result;
    for (uint32_t kind = 0; kind < model->kind_count; ++kind) {
        for (uint32_t b = 0; b < m->batch_count; ++b) {
            const gtx_proxies *p = &m->batches[b].derived.proxies[kind];
            const uint32_t vertices = all->vertex_count, indices = all->index_count;
            if (p->vertex_count)
                memcpy(all->vertices + vertices, p->vertices,
                       p->vertex_count * sizeof *p->vertices);
            for (uint32_t i = 0; i < p->index_count; ++i)
                all->indices[indices + i] = p->indices[i] + vertices;
            for (uint32_t i = m->batches[b].first; i < m->batches[b].end; ++i) {
                model->first_vertex[kind * model->patch_count + i] += vertices;
                model->first_index[kind * model->patch_count + i] += indices;
            }
            all->vertex_count += p->vertex_count;
            all->index_count += p->index_count;
        }
    }
    model->first_vertex[model->kind_count * model->patch_count] = all->vertex_count;
    model->first_index[model->kind_count * model->patch_count] = all->index_count;
    return GTX_OK;
}

/* Cells of all levels, record and proxies of a patch. */
static gtx_result derive_patch(const making *m, uint32_t i, gtx_derived *derived, gtx_error *error)
{
    gtx_model *model = m->model;
    const gtx_info *info = &m->asset->info;
    const gtx_patch *p = &m->asset->patches[i];
    for (uint32_t k = 0; k < info->mip_count; ++k) {
        uint32_t at[2];
        gtx_model_cells_at(model, p, k, at);
        const size_t row = (size_t)p->page * gtx_model_cell_rows(model) + at[1];
        derived->row_texels[k] = info->page_width;
        derived->cells[k] = m->pages + (row * info->page_width + at[0]) * (info->height_bits / 2);
        derived->slabs[k] = model->slabs + model->first_slab[k * info->patch_count + i];
        derived->slabs_at[k] = gtx_model_slabs_at(model, i, k);
        derived->slab_texels[k] = (gtx_slab_texel *)m->records + derived->slabs_at[k];
    }
    derived->blocks = model->blocks + model->first_slab[i];
    derived->nodes = model->nodes + model->first_node[i];
    for (uint32_t kind = 0; kind < model->kind_count; ++kind) {
        model->first_vertex[kind * info->patch_count + i] = derived->proxies[kind].vertex_count;
        model->first_index[kind * info->patch_count + i] = derived->proxies[kind].index_count;
    }
    gtx_result result = gtx_patch_derive(m->asset, i, &model->allocator, derived, error);
    memcpy(m->records[i], derived->record, sizeof derived->record);
    memcpy(model->records[i], derived->record, sizeof derived->record);
    model->facts[i] = derived->facts;
    model->rtins[i] = derived->rtin;
    return result;
}

/* A piece of a level of a map: a copy of the asset's, or empty, for what lies between patches. */
static void begin_level(const making *m, uint32_t index, uint32_t piece)
{
    const gtx_level *l = &m->model->levels[index];
    const uint8_t *source = m->sources[index];
    const size_t size = level_size(l), first = size * piece / PIECES;
    const size_t count = size * (piece + 1) / PIECES - first;
    if (source)
        memcpy(l->data + first, source + first, count);
    else if (!l->borrowed)
        memset(l->data + first, 0, count);
}

/* What comes before all else: sizes of the LOD meshes, and maps. */
static void begin_part(uint32_t index, void *data)
{
    making *m = data;
    gtx_model *model = m->model;
    const uint32_t lods = model->lods.level_count;
    if (index < lods)
        gtx_lod_measure(m->asset, index, &model->allocator, &model->lods);
    else
        begin_level(m, (index - lods) / PIECES, (index - lods) % PIECES);
}

/* The LOD meshes, then patches. */
static void make_part(uint32_t index, void *data)
{
    making *m = data;
    gtx_model *model = m->model;
    const uint32_t lods = model->lods.level_count;
    if (index < lods) {
        gtx_lod_fill(m->asset, index, &model->allocator, &model->lods);
        return;
    }
    batch *b = &m->batches[index - lods];
    for (uint32_t i = b->first; i < b->end && !b->result; ++i)
        b->result = derive_patch(m, i, &b->derived, &b->error);
}

/* What went wrong first, in the order that serial work would have. */
static gtx_result first_failure(const making *m, gtx_error *error)
{
    for (uint32_t b = 0; b < m->batch_count; ++b)
        if (m->batches[b].result) {
            if (error)
                *error = m->batches[b].error;
            return m->batches[b].result;
        }
    return GTX_OK;
}

static gtx_result make_parts(making *m, const gtx_jobs *jobs, gtx_error *error)
{
    const gtx_allocator *hooks = &m->model->allocator;
    const uint32_t patches = m->model->patch_count;
    m->batch_count = patches < MAX_BATCHES ? patches : MAX_BATCHES;
    m->batches = gtx_alloc_array(hooks, m->batch_count, sizeof *m->batches);
    if (!m->batches)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the model's patches");
    for (uint32_t b = 0; b < m->batch_count; ++b) {
        m->batches[b].first = (uint32_t)((uint64_t)patches * b / m->batch_count);
        m->batches[b].end = (uint32_t)((uint64_t)patches * (b + 1) / m->batch_count);
    }
    gtx_run_jobs(jobs, m->model->lods.level_count + m->batch_count, make_part, m);
    gtx_result result = first_failure(m, error);
    if (!result)
        result = join_proxies(m, error);
    for (uint32_t b = 0; b < m->batch_count; ++b)
        for (uint32_t kind = 0; kind < m->model->kind_count; ++kind)
            gtx_proxies_free(&m->batches[b].derived.proxies[kind], hooks);
    gtx_free_array(hooks, m->batches, m->batch_count, sizeof *m->batches);
    return result;
}

static gtx_result begin_parts(making *m, const gtx_jobs *jobs, gtx_error *error)
{
    gtx_model *model = m->model;
    if (!gtx_lod_begin(m->asset, &model->allocator, &model->lods))
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the model's LOD mesh");
    model->lods.first_provokes = m->first_provokes;
    gtx_run_jobs(jobs, model->lods.level_count + PIECES * model->level_count, begin_part, m);
    return gtx_lod_place(&model->allocator, &model->lods, error);
}

/* Memory for everything that has a size before it is derived. */
static bool reserve(making *m)
{
    gtx_model *model = m->model;
    const gtx_info *info = &m->asset->info;
    const size_t slots = (size_t)model->kind_count * model->patch_count + 1;
    if (!gtx_model_reserve_blocks(model, m->asset))
        return false;
    m->records = (void *)add_level(
        model, (gtx_level){.unit = UNIT_PATCHES, .width = GTX_PATCHES_ROW,
                           .height = gtx_model_patch_rows(model), .layers = 1,
                           .texel_size = sizeof(gtx_slab_texel)});
    model->first_vertex = gtx_alloc_array(&model->allocator, slots, sizeof *model->first_vertex);
    model->first_index = gtx_alloc_array(&model->allocator, slots, sizeof *model->first_index);
    model->facts = gtx_alloc_array(&model->allocator, model->patch_count, sizeof *model->facts);
    m->pages = add_level(
        model, (gtx_level){.unit = UNIT_CELLS, .width = info->page_width,
                           .height = gtx_model_cell_rows(model), .layers = info->page_count,
                           .texel_size = info->height_bits / 2});
    if (!m->records || !m->pages || !model->first_vertex || !model->first_index || !model->facts)
        return false;
    return add_maps(m, GTX_MAP_TRIM, UNIT_TRIM, 1, 1) &&
           add_maps(m, GTX_MAP_NORMAL, UNIT_NORMALS, info->mip_count, 2) &&
           add_maps(m, GTX_MAP_COLOR, UNIT_COLORS, info->mip_count, 4) &&
           add_maps(m, GTX_MAP_MATERIAL, UNIT_MATERIALS, info->mip_count, 4) &&
           add_maps(m, GTX_MAP_EMISSION, UNIT_EMISSIONS, info->mip_count, 3);
}

static gtx_model *new_model(const gtx_asset *asset, const gtx_allocator *hooks)
{
    gtx_model *model = gtx_alloc_array(hooks, 1, sizeof *model);
    if (!model)
        return NULL;
    const gtx_info *info = &asset->info;
    model->allocator = *hooks;
    model->height_bits = info->height_bits;
    model->mip_count = info->mip_count;
    model->kind_count = 1 + info->mip_count;
    model->patch_count = info->patch_count;
    model->has_color = info->has_color;
    model->has_material = info->has_material;
    model->has_emission = info->has_emission;
    model->emission_scale = info->has_emission ? info->emission_scale : 0;
    model->has_constant_material = info->has_material && info->lod_levels &&
                               gtx_find_constant_material(asset, model->constant_material);
    model->page_count = info->page_count;
    model->page_width = info->page_width;
    model->page_height = info->page_height;
    model->layout = gtx_model_layout(asset);
    for (int k = 0; k < 3; ++k)
        model->sphere[k] = (info->bounds_min[k] + info->bounds_max[k]) / 2;
    return model;
}

static gtx_result check(const gtx_asset *asset, const gtx_model_desc *desc, gtx_error *error)
{
    gtx_result result = gtx_check_reserved(desc->reserved, 3, error);
    if (!result)
        result = gtx_check_limits(&desc->limits, error);
    const gtx_info *info = &asset->info;
    const uint64_t texels = (uint64_t)info->page_count * info->page_width * info->page_height;
    if (!result)
        result = gtx_check_derived(texels, &desc->limits, "a model",
                                   gtx_model_memory(asset, desc->borrow), error);
    return result ? result : gtx_check_crowd(asset, &desc->limits, error);
}

gtx_result gtx_model_prepare(const gtx_asset *asset, const gtx_model_desc *desc, gtx_model **out,
                             gtx_error *error)
{
    if (!asset || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a model needs an asset");
    *out = NULL;
    const gtx_model_desc defaults = {0}, *d = desc ? desc : &defaults;
    gtx_result result = check(asset, d, error);
    if (result)
        return result;
    const gtx_allocator hooks = gtx_allocator_or_default(d->allocator);
    making m = {.asset = asset, .model = new_model(asset, &hooks), .borrow = d->borrow,
                .first_provokes = d->first_provokes};
    if (!m.model)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a model");
    if (reserve(&m))
        result = begin_parts(&m, d->jobs, error);
    else
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the model's maps");
    if (!result)
        result = make_parts(&m, d->jobs, error);
    gtx_model *model = m.model;
    if (result) {
        gtx_model_free(model);
        return result;
    }
    gtx_model_sum_up(model);
    const gtx_proxies *proxies = &model->proxies;
    model->size.geometry += (uint64_t)proxies->index_count * sizeof *proxies->indices +
                            (uint64_t)proxies->vertex_count * sizeof *proxies->vertices +
                            model->lods.vertex_bytes + model->lods.index_bytes;
    *out = model;
    return GTX_OK;
}
