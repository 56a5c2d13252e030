/* Edits of a model on the GPU: one patch's maps, and what follows from them. */
#include "render/upload.h"

#include "base/alloc.h"
#include "base/error.h"
#include "render/renderer.h"
#include "render/update.h"

#include <string.h>

static bool is_alike(const gtx_model *model, const gtx_asset *asset)
{
    const gtx_info *info = &asset->info;
    return info->page_count == model->page_count && info->page_width == model->page_width &&
           info->page_height == model->page_height && info->mip_count == model->mip_count &&
           info->height_bits == model->height_bits && info->patch_count == model->patch_count &&
           info->has_color == model->has_color && info->has_material == model->has_material &&
           info->has_emission == model->has_emission && gtx_model_layout(asset) == model->layout;
}

/* Cells of all levels, one after another, and how many bytes. NULL without memory. Zeroed: at level
 * 0 the last row and column of texels has no cells. */
static uint8_t *make_cells(const gtx_model *model, const gtx_patch *patch, gtx_derived *d,
                           size_t *size)
{
    size_t offset[GTX_MAX_MIPS];
    *size = 0;
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        d->row_texels[k] = patch->rect[2] >> k;
        offset[k] = *size;
        *size += d->row_texels[k] * (patch->rect[3] >> k) * (model->height_bits / 2);
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

static void upload_cells(const gtx_gl *gl, const gtx_model *model, const gtx_patch *patch,
                         const gtx_derived *d)
{
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        gtx_update_rect r = {.unit = UNIT_CELLS, .level = k, .texels = d->cells[k],
                             .row_texels = patch->rect[2] >> k};
        gtx_model_cells_at(model, patch, k, r.at);
        gtx_update_texels(gl, model, patch, &r);
    }
}

/* A piece of a row of the texture of records and slabs. */
static void upload_texels(const gtx_gl *gl, const gtx_texture_kind *kind, uint32_t at,
                          uint32_t count, const float *texels)
{
    gl->TexSubImage2D(kind->target, 0, (gl_int)(at % GTX_PATCHES_ROW),
                      (gl_int)(at / GTX_PATCHES_ROW), (gl_size)count, 1, kind->format, kind->type,
                      texels);
}

static void upload_record(const gtx_gl *gl, const gtx_model *model, const gtx_derived *d,
                          uint32_t patch)
{
    const gtx_texture_kind kind = gtx_texture_kind_of(model, UNIT_PATCHES);
    gl->BindTexture(kind.target, model->textures[UNIT_PATCHES]);
    upload_texels(gl, &kind, patch * GTX_RECORD_TEXELS, GTX_RECORD_TEXELS, d->record[0]);
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        const uint32_t *first = &model->first_slab[k * model->patch_count + patch];
        const uint32_t count = first[1] - first[0];
        for (uint32_t i = 0, piece; i < count; i += piece) {
            const uint32_t at = d->slabs_at[k] + i, room = GTX_PATCHES_ROW - at % GTX_PATCHES_ROW;
            piece = count - i < room ? count - i : room;
            upload_texels(gl, &kind, at, piece, d->slab_texels[k][i]);
        }
    }
}

static gtx_result upload(const gtx_renderer *renderer, gtx_model *model, const gtx_asset *edited,
                         uint32_t patch, gtx_derived *d, uint8_t *blocks, gtx_error *error)
{
    const gtx_gl *gl = &renderer->gl;
    const gtx_patch *p = &edited->patches[patch];
    gl->ActiveTexture(GL_TEXTURE0);
    gtx_default_unpacking(gl);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    upload_cells(gl, model, p, d);
    gtx_update_maps(gl, model, edited, p, blocks);
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    upload_record(gl, model, d, patch);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    replace_slabs(model, d, patch);
    model->facts[patch] = d->facts;
    model->facts[patch].boxed |= !gtx_replace_proxies(renderer, model, d->proxies,
                                                        patch);
    gtx_model_sum_up(model);
    if (model->lods.level_count)
        gtx_lod_mark(&model->lods, patch);
    model->emission_scale = edited->info.has_emission ? edited->info.emission_scale : 0;
    return gtx_check_gl_memory(gl, error);
}

gtx_result gtx_model_update(gtx_renderer *renderer, gtx_model *model, const gtx_asset *edited,
                            uint32_t patch, gtx_error *error)
{
    if (!renderer || !model || !edited || !model->ready)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an update needs a renderer, an uploaded model and an asset");
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
        result = upload(renderer, model, edited, patch, &d, blocks, error);
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
