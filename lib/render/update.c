/* Edits of a model on the GPU: one patch's maps, and what follows from them. */
#include "render/renderer.h"

#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

/* What is derived anew before anything on the GPU changes. */
typedef struct derived {
    gtx_proxies proxies;
    float record[GTX_RECORD_TEXELS][4];
    void *cells;              /* of all levels, one after another */
    void *level[GTX_MAX_MIPS];
    size_t cell_count, cell_size;
} derived;

static bool is_alike(const gtx_model *model, const gtx_asset *asset)
{
    const gtx_info *info = &asset->info;
    return info->page_count == model->page_count && info->page_width == model->page_width &&
           info->page_height == model->page_height && info->mip_count == model->mip_count &&
           info->height_bits == model->height_bits && info->patch_count == model->patch_count &&
           info->has_color == model->has_color && info->has_material == model->has_material &&
           info->has_emission == model->has_emission && gtx_model_layout(asset) == model->layout;
}

static void free_derived(derived *d, const gtx_allocator *hooks)
{
    gtx_proxies_free(&d->proxies, hooks);
    gtx_free_array(hooks, d->cells, d->cell_count, d->cell_size);
}

static gtx_result derive(const gtx_model *model, const gtx_asset *asset, uint32_t patch,
                         derived *d, gtx_error *error)
{
    const gtx_allocator *hooks = &model->allocator;
    const uint16_t *rect = asset->patches[patch].rect;
    size_t row_texels[GTX_MAX_MIPS];
    float errors[GTX_MAX_MIPS];
    *d = (derived){.cell_size = model->height_bits / 2};
    for (uint32_t k = 0; k < model->mip_count; ++k)
        d->cell_count += (size_t)(rect[2] >> k) * (rect[3] >> k);
    gtx_result result = gtx_model_derive_proxies(asset, hooks, &d->proxies, error);
    if (result)
        return result;
    /* Zeroed: at level 0 the last row and column of texels has no cells. */
    d->cells = gtx_alloc_array(hooks, d->cell_count, d->cell_size);
    if (!d->cells) {
        free_derived(d, hooks);
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for an update");
    }
    uint8_t *next = d->cells;
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        row_texels[k] = rect[2] >> k;
        d->level[k] = next;
        next += row_texels[k] * (rect[3] >> k) * d->cell_size;
    }
    result = gtx_model_derive_levels(asset, patch, hooks, d->level, row_texels, errors, error);
    if (result)
        free_derived(d, hooks);
    else
        gtx_model_fill_record(asset, &d->proxies, patch, errors, d->record);
    return result;
}

/* The patch's rectangle at a mip level, out of rows of `width` texels. */
static void upload_rect(const gtx_gl *gl, const gtx_model *model, uint32_t unit,
                        const gtx_patch *patch, uint32_t level, const void *data, uint32_t width)
{
    const gtx_texture_kind kind = gtx_texture_kind_of(model, unit);
    gl->BindTexture(kind.target, model->textures[unit]);
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, (gl_int)width);
    gl->TexSubImage3D(kind.target, (gl_int)level, patch->rect[0] >> level, patch->rect[1] >> level,
                      (gl_int)patch->page, patch->rect[2] >> level, patch->rect[3] >> level, 1,
                      kind.format, kind.type, data);
}

static void upload_maps(const gtx_gl *gl, const gtx_model *model, const gtx_asset *asset,
                        const gtx_patch *patch)
{
    static const struct {
        gtx_map map;
        uint32_t unit, texel_size;
    } maps[] = {{GTX_MAP_TRIM, UNIT_TRIM, 1},
                {GTX_MAP_NORMAL, UNIT_NORMALS, 2},
                {GTX_MAP_COLOR, UNIT_COLORS, 4},
                {GTX_MAP_MATERIAL, UNIT_MATERIALS, 4},
                {GTX_MAP_EMISSION, UNIT_EMISSIONS, 3}};
    for (size_t i = 0; i < sizeof maps / sizeof *maps; ++i) {
        for (uint32_t k = 0; k < model->mip_count; ++k) {
            const uint8_t *data = gtx_map_data(asset, maps[i].map, k, NULL);
            if (!data)
                break;
            const size_t width = model->page_width >> k, height = model->page_height >> k;
            const size_t row = patch->page * height + (patch->rect[1] >> k);
            const size_t texel = row * width + (patch->rect[0] >> k);
            upload_rect(gl, model, maps[i].unit, patch, k, data + texel * maps[i].texel_size,
                        (uint32_t)width);
        }
    }
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
    derived d;
    gtx_result result = derive(model, edited, patch, &d, error);
    if (result)
        return result;

    const gtx_gl *gl = &renderer->gl;
    const gtx_patch *p = &edited->patches[patch];
    gl->ActiveTexture(GL_TEXTURE0);
    gtx_default_unpacking(gl);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (uint32_t k = 0; k < model->mip_count; ++k)
        upload_rect(gl, model, UNIT_CELLS, p, k, d.level[k], p->rect[2] >> k);
    upload_maps(gl, model, edited, p);
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    const gtx_texture_kind records = gtx_texture_kind_of(model, UNIT_PATCHES);
    gl->BindTexture(records.target, model->textures[UNIT_PATCHES]);
    gl->TexSubImage2D(records.target, 0, (gl_int)(patch % GTX_RECORDS_A_ROW * GTX_RECORD_TEXELS),
                      (gl_int)(patch / GTX_RECORDS_A_ROW), GTX_RECORD_TEXELS, 1, records.format,
                      records.type, d.record);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    gtx_upload_proxies(gl, model, &d.proxies);
    model->index_count = d.proxies.index_count;
    if (model->shells.level_count) {
        memcpy(model->first_index, d.proxies.first_index,
               (model->patch_count + 1) * sizeof *model->first_index);
        gtx_shells_mark(&model->shells, patch);
    }
    model->emission_scale = edited->info.has_emission ? edited->info.emission_scale : 0;
    free_derived(&d, &model->allocator);
    return gtx_check_gl_memory(gl, error);
}
