/* Edits of a model: one patch's maps, and what follows from them, for whoever has it on a GPU. */
#include "frame/update.h"

#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

static bool is_alike(const gtx_model *model, const gtx_asset *asset)
{
    const gtx_info *info = &asset->info;
    return info->page_count == model->page_count && info->page_width == model->page_width &&
           info->page_height == model->page_height && info->mip_count == model->mip_count &&
           info->height_bits == model->height_bits && info->patch_count == model->patch_count &&
           info->has_color == model->has_color && info->has_material == model->has_material &&
           info->has_emission == model->has_emission && !asset->bare &&
           gtx_model_layout(asset) == model->layout;
}

/* Cells of all levels, one after another, and how many bytes. NULL without memory. Zeroed: at level
 * 0 the last row and column of texels has no cells. */
static uint8_t *make_cells(const gtx_model *model, const gtx_patch *patch, gtx_derived *d,
                           size_t *size)
{
    size_t offset[GTX_MAX_MIPS];
    *size = 0;
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        const uint32_t up = k ? k - 1 : 0;
        d->row_texels[k] = patch->rect[2] >> up;
        offset[k] = *size;
        *size += d->row_texels[k] * (patch->rect[3] >> up) * (model->height_bits / 8);
    }
    uint8_t *cells = gtx_alloc_array(&model->allocator, *size, 1);
    for (uint32_t k = 0; cells && k < model->mip_count; ++k)
        d->cells[k] = cells + offset[k];
    return cells;
}

/* Slabs of all levels, one after another, and how many; room for a displaced grid. False without
 * memory. */
static bool make_slabs(const gtx_model *model, const gtx_patch *patch, gtx_derived *d,
                       size_t *count)
{
    size_t first[GTX_MAX_MIPS];
    *count = 0;
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        first[k] = *count;
        *count += gtx_slab_count(patch, k);
    }
    d->slabs[0] = gtx_alloc_array(&model->allocator, *count, sizeof *d->slabs[0]);
    d->slab_texels[0] = gtx_alloc_array(&model->allocator, *count, sizeof *d->slab_texels[0]);
    d->blocks = gtx_alloc_array(&model->allocator, gtx_slab_count(patch, 0), sizeof *d->blocks);
    d->nodes = gtx_alloc_array(&model->allocator, gtx_rtin_nodes(patch), sizeof *d->nodes);
    if (!d->slabs[0] || !d->slab_texels[0])
        return false;
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        d->slabs[k] = d->slabs[0] + first[k];
        d->slab_texels[k] = d->slab_texels[0] + first[k];
    }
    return d->blocks && d->nodes;
}

static void replace_slabs(gtx_model *model, const gtx_derived *d, uint32_t patch)
{
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        const uint32_t *first = &model->first_slab[k * model->patch_count + patch];
        const size_t count = first[1] - first[0];
        memcpy(model->slabs + first[0], d->slabs[k], count * sizeof *model->slabs);
    }
    const uint32_t *first = &model->first_slab[patch];
    memcpy(model->blocks + first[0], d->blocks, (first[1] - first[0]) * sizeof *model->blocks);
    const size_t *node = &model->first_node[patch];
    memcpy(model->nodes + node[0], d->nodes, (node[1] - node[0]) * sizeof *model->nodes);
    model->rtins[patch] = d->rtin;
    memcpy(model->records[patch], d->record, sizeof d->record);
}

/* Derives a patch anew, before anything on the GPU changes. Room for hulls that became smaller. */
static gtx_result derive(const gtx_model *model, const gtx_asset *asset, uint32_t patch,
                         gtx_derived *d, gtx_error *error)
{
    gtx_result result = GTX_OK;
    for (uint32_t k = 0; k < model->mip_count; ++k)
        d->slabs_at[k] = gtx_model_slabs_at(model, patch, k);
    for (uint32_t kind = 0; !result && kind < model->kind_count; ++kind) {
        const uint32_t *first = &model->first_index[kind * model->patch_count + patch];
        result = gtx_proxies_reserve(&d->proxies[kind], 0, first[1] - first[0], &model->allocator,
                                     error);
    }
    return result ? result : gtx_patch_derive(asset, patch, &model->allocator, d, error);
}

static void send_cells(const gtx_sink *sink, const gtx_model *model, const gtx_patch *patch,
                       const gtx_derived *d)
{
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        const uint32_t up = k ? k - 1 : 0, width = (uint32_t)patch->rect[2] >> up;
        uint32_t at[2];
        gtx_model_cells_at(model, patch, k, at);
        const gtx_texture_piece piece = {
            .binding = GTX_SLOT_CELLS, .layer = patch->page, .x = at[0], .y = at[1],
            .width = width, .height = (uint32_t)patch->rect[3] >> up, .data = d->cells[k],
            .row_bytes = width * (model->height_bits / 8)};
        sink->texels(&piece, sink->user);
    }
}

/* A piece of a row of the texture of records and slabs. */
static void send_row(const gtx_sink *sink, uint32_t at, uint32_t count, const float *texels)
{
    const gtx_texture_piece piece = {.binding = GTX_SLOT_PATCHES, .x = at % GTX_PATCHES_ROW,
                                     .y = at / GTX_PATCHES_ROW, .width = count, .height = 1,
                                     .data = texels, .row_bytes = count * sizeof(gtx_slab_texel)};
    sink->texels(&piece, sink->user);
}

static void send_record(const gtx_sink *sink, const gtx_model *model, const gtx_derived *d,
                        uint32_t patch)
{
    send_row(sink, patch * GTX_RECORD_TEXELS, GTX_RECORD_TEXELS, d->record[0]);
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        const uint32_t *first = &model->first_slab[k * model->patch_count + patch];
        const uint32_t count = first[1] - first[0];
        for (uint32_t i = 0, piece; i < count; i += piece) {
            const uint32_t at = d->slabs_at[k] + i, room = GTX_PATCHES_ROW - at % GTX_PATCHES_ROW;
            piece = count - i < room ? count - i : room;
            send_row(sink, at, piece, d->slab_texels[k][i]);
        }
    }
}

/* Puts a patch's edited proxies in the place of its old ones; false when a hull does not fit.
 * Indices that are left over make triangles without area. */
static bool send_proxies(const gtx_sink *sink, const gtx_model *model, gtx_proxies *proxies,
                         uint32_t patch)
{
    bool fits = true;
    for (uint32_t kind = 0; kind < model->kind_count; ++kind) {
        gtx_proxies *p = &proxies[kind];
        const uint32_t slot = kind * model->patch_count + patch;
        const uint32_t first = model->first_vertex[slot], start = model->first_index[slot];
        const uint32_t room = model->first_index[slot + 1] - start;
        if (p->vertex_count > model->first_vertex[slot + 1] - first || p->index_count > room ||
            p->index_room < room) {
            fits = false;
            continue;
        }
        for (uint32_t i = 0; i < room; ++i)
            p->indices[i] = i < p->index_count ? p->indices[i] + first : first;
        if (p->vertex_count)
            sink->bytes(GTX_BUFFER_PROXY_VERTICES, first * sizeof *p->vertices, p->vertices,
                        p->vertex_count * sizeof *p->vertices, sink->user);
        gtx_model_pack_indices(model, p->indices, room, p->indices);
        if (room)
            sink->bytes(GTX_BUFFER_PROXY_INDICES, (uint64_t)start * model->proxy_index_size,
                        p->indices, (uint64_t)room * model->proxy_index_size, sink->user);
    }
    return fits;
}

static void send(gtx_model *model, const gtx_asset *edited, uint32_t patch, gtx_derived *d,
                 uint8_t *blocks, const gtx_sink *sink)
{
    const gtx_patch *p = &edited->patches[patch];
    send_cells(sink, model, p, d);
    gtx_update_maps(model, edited, p, blocks, sink);
    send_record(sink, model, d, patch);
    replace_slabs(model, d, patch);
    model->facts[patch] = d->facts;
    model->facts[patch].boxed |= !send_proxies(sink, model, d->proxies, patch);
    gtx_model_sum_up(model);
    if (model->lods.level_count)
        gtx_lod_mark(&model->lods, patch);
    model->emission_scale = edited->info.has_emission ? edited->info.emission_scale : 0;
}

gtx_result gtx_model_edit(gtx_model *model, const gtx_asset *edited, uint32_t patch,
                          const gtx_sink *sink, gtx_error *error)
{
    if (!model || !edited || !sink || !sink->texels || !sink->bytes || !sink->renew ||
        (model->level_count && model->levels[0].data))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an edit needs an uploaded model, an asset and a sink");
    if (!is_alike(model, edited) || patch >= model->patch_count)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "patch %u is not one of an asset with the model's maps and rectangles",
                        patch);
    const gtx_patch *p = &edited->patches[patch];
    gtx_derived d = {0};
    size_t size, slab_count;
    uint8_t *cells = make_cells(model, p, &d, &size);
    const size_t block_bytes = gtx_update_scratch(model, p);
    uint8_t *blocks = block_bytes ? gtx_alloc_raw(&model->allocator, block_bytes, 1) : NULL;
    const bool slabs = make_slabs(model, p, &d, &slab_count);
    const bool whole = cells && slabs && (blocks || !block_bytes);
    gtx_result result = whole ? derive(model, edited, patch, &d, error)
                              : gtx_fail(error, GTX_ERROR_MEMORY, "no memory for an update");
    if (!result)
        send(model, edited, patch, &d, blocks, sink);
    for (uint32_t kind = 0; kind < model->kind_count; ++kind)
        gtx_proxies_free(&d.proxies[kind], &model->allocator);
    gtx_free_array(&model->allocator, cells, size, 1);
    gtx_free_array(&model->allocator, blocks, block_bytes, 1);
    gtx_free_array(&model->allocator, d.slabs[0], slab_count, sizeof *d.slabs[0]);
    gtx_free_array(&model->allocator, d.slab_texels[0], slab_count, sizeof *d.slab_texels[0]);
    gtx_free_array(&model->allocator, d.blocks, gtx_slab_count(p, 0), sizeof *d.blocks);
    gtx_free_array(&model->allocator, d.nodes, gtx_rtin_nodes(p), sizeof *d.nodes);
    return result;
}
