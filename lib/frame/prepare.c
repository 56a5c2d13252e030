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
    uint8_t *pages;               /* of codes of cells */
    batch *batches;
    uint32_t batch_count;
    const gtx_model_desc *desc;
    const void *sources[GTX_MAX_LEVELS]; /* of levels that are copies, or blocks; or NULL */
} making;

/* Batches of patches, and pieces of each map: enough for many threads to end together, and each to
 * have enough to do. */
enum { MAX_BATCHES = 64, PIECES = 4 };

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
    model->proxy_index_size = all->vertex_count < UINT16_MAX ? 2 : 4;
    gtx_model_pack_indices(model, all->indices, all->index_count, all->indices);
    return GTX_OK;
}

/* Cells of all levels, record and proxies of a patch. */
static gtx_result derive_patch(const making *m, uint32_t i, gtx_derived *derived, gtx_error *error)
{
    gtx_model *model = m->model;
    const gtx_info *info = &m->asset->info;
    const gtx_patch *p = &m->asset->patches[i];
    for (uint32_t k = 0; k < info->mip_count && !m->asset->bare; ++k) {
        uint32_t at[2];
        gtx_model_cells_at(model, p, k, at);
        const size_t row = (size_t)p->page * gtx_model_cell_rows(model) + at[1];
        derived->row_texels[k] = gtx_model_cell_columns(model);
        derived->cells[k] =
            m->pages + (row * derived->row_texels[k] + at[0]) * (info->height_bits / 8);
        derived->slabs[k] = model->slabs + model->first_slab[k * info->patch_count + i];
        derived->slabs_at[k] = gtx_model_slabs_at(model, i, k);
        derived->slab_texels[k] = (gtx_slab_texel *)m->records + derived->slabs_at[k];
    }
    if (!m->asset->bare) {
        derived->blocks = model->blocks + model->first_slab[i];
        derived->nodes = model->nodes + model->first_node[i];
    }
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

/* What comes before all else: sizes of the LOD meshes, and maps. */
static void begin_part(uint32_t index, void *data)
{
    making *m = data;
    gtx_model *model = m->model;
    const uint32_t lods = model->lods.level_count;
    if (index < lods)
        gtx_lod_measure(m->asset, index, &model->allocator, &model->lods);
    else
        gtx_model_begin_level(model, m->asset, (index - lods) / PIECES,
                              m->sources[(index - lods) / PIECES], (index - lods) % PIECES, PIECES);
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
    model->lods.first_provokes = m->desc->first_provokes;
    model->lods.light_vertices = m->desc->light_vertices;
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
    m->records = (void *)gtx_model_add_level(
        model, (gtx_level){.unit = UNIT_PATCHES, .width = GTX_PATCHES_ROW,
                           .height = gtx_model_patch_rows(model), .layers = 1,
                           .texel_size = sizeof(gtx_slab_texel)});
    model->first_vertex = gtx_alloc_array(&model->allocator, slots, sizeof *model->first_vertex);
    model->first_index = gtx_alloc_array(&model->allocator, slots, sizeof *model->first_index);
    model->facts = gtx_alloc_array(&model->allocator, model->patch_count, sizeof *model->facts);
    const bool bare = m->asset->bare;
    m->pages = gtx_model_add_level(
        model, (gtx_level){.unit = UNIT_CELLS,
                           .width = bare ? 1 : gtx_model_cell_columns(model),
                           .height = bare ? 1 : gtx_model_cell_rows(model),
                           .layers = bare ? 1 : info->page_count,
                           .texel_size = info->height_bits / 8});
    if (!m->records || !m->pages || !model->first_vertex || !model->first_index || !model->facts)
        return false;
    model->formats[UNIT_PATCHES] = GTX_FORMAT_RGBA32_FLOAT;
    model->formats[UNIT_CELLS] =
        info->height_bits == 16 ? GTX_FORMAT_R16_UINT : GTX_FORMAT_R8_UINT;
    return gtx_model_add_maps(model, m->asset, m->desc, m->sources);
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
    model->flat_material = info->has_material &&
                           gtx_find_constant_material(asset, model->constant_material);
    model->has_constant_material = model->flat_material && info->lod_levels;
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
    gtx_result result = gtx_check_reserved(desc->reserved, 1, error);
    if (!result && (uint32_t)desc->compress > GTX_COMPRESS_BC_SMALL)
        result = gtx_fail(error, GTX_ERROR_ARGUMENT, "a model is compressed by no kind of blocks");
    if (!result)
        result = gtx_check_limits(&desc->limits, error);
    const gtx_info *info = &asset->info;
    const uint64_t texels = (uint64_t)info->page_count * info->page_width * info->page_height;
    if (!result)
        result = gtx_check_derived(texels, &desc->limits, "a model",
                                   gtx_model_memory(asset, desc), error);
    /* No ray is cast into what has no heights. */
    return result || asset->bare ? result : gtx_check_crowd(asset, &desc->limits, error);
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
    making m = {.asset = asset, .model = new_model(asset, &hooks), .desc = d};
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
    model->size.geometry += (uint64_t)proxies->index_count * model->proxy_index_size +
                            (uint64_t)proxies->vertex_count * sizeof *proxies->vertices +
                            model->lods.vertex_bytes + model->lods.index_bytes;
    *out = model;
    return GTX_OK;
}
