/* Models on the CPU's side: everything the GPU needs, derived from an asset without OpenGL. */
#include "render/renderer.h"

#include "base/alloc.h"
#include "base/error.h"
#include "base/hash.h"

#include <string.h>

/* How far, in texels and codes, hulls stand off the sheet: rounding in the rasteriser must not cut
 * the sheet's rim, and a flat sheet must not lie in a face. */
static const float hull_margin = 0.25f;

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

gtx_result gtx_model_derive_levels(const gtx_asset *asset, uint32_t patch,
                                   const gtx_allocator *allocator, void *const *cells,
                                   const size_t *row_texels, float errors[GTX_MAX_MIPS],
                                   gtx_error *error)
{
    gtx_grid finest = {0}, grid;
    gtx_result result = gtx_grid_build(asset, patch, 0, allocator, &finest, error);
    if (result)
        return result;
    gtx_grid_cells(&finest, asset->info.height_bits, row_texels[0], cells[0]);
    errors[0] = 0;
    for (uint32_t k = 1; !result && k < asset->info.mip_count; ++k) {
        result = gtx_grid_build(asset, patch, k, allocator, &grid, error);
        if (result)
            break;
        gtx_grid_cells(&grid, asset->info.height_bits, row_texels[k], cells[k]);
        errors[k] = (float)gtx_grid_error(asset, patch, &finest, &grid);
        if (errors[k] < errors[k - 1])
            errors[k] = errors[k - 1];
        gtx_grid_free(&grid, allocator);
    }
    gtx_grid_free(&finest, allocator);
    return result;
}

/* Rows of the inverse of grid -> object, whose columns are `axis` and `origin`. */
static void invert(double axis[3][3], const double origin[3], double rows[3][4])
{
    double cross[3][3], det = 0;
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k) {
            const double *a = axis[(r + 1) % 3], *b = axis[(r + 2) % 3];
            cross[r][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        }
    for (int k = 0; k < 3; ++k)
        det += axis[0][k] * cross[0][k];
    for (int r = 0; r < 3; ++r) {
        rows[r][3] = 0;
        for (int k = 0; k < 3; ++k) {
            rows[r][k] = cross[r][k] / det;
            rows[r][3] -= rows[r][k] * origin[k];
        }
    }
}

/* The part of a record that casting reads. */
static void fill_frame(float record[GTX_RECORD_TEXELS][4], const gtx_patch *patch,
                       uint32_t height_bits, float low, float high)
{
    const float *unit[3] = {patch->axis_x, patch->axis_y, patch->axis_z};
    const double step[3] = {(double)patch->extent_x / patch->rect[2],
                            (double)patch->extent_y / patch->rect[3],
                            patch->extent_z / (height_bits == 8 ? 254.0 : 65534.0)};
    double axis[3][3], origin[3], rows[3][4];
    for (int k = 0; k < 3; ++k) {
        for (int a = 0; a < 3; ++a)
            axis[a][k] = step[a] * unit[a][k];
        /* Texel 0 lies half a texel inside the rectangle, and height 0 has code 1. */
        origin[k] = patch->origin[k] + 0.5 * axis[0][k] + 0.5 * axis[1][k] - axis[2][k];
    }
    invert(axis, origin, rows);
    for (int k = 0; k < 4; ++k)
        for (int r = 0; r < 3; ++r)
            record[r][k] = (float)rows[r][k];
    for (int k = 0; k < 3; ++k) {
        record[3][k] = (float)origin[k];
        for (int a = 0; a < 3; ++a)
            record[4 + a][k] = (float)axis[a][k];
    }
    record[3][3] = low;
    record[4][3] = high;
    record[5][3] = (float)patch->page;
    record[6][3] = patch->flags & GTX_PATCH_TWO_SIDED ? 1.0f : 0.0f;
    for (int k = 0; k < 4; ++k)
        record[7][k] = patch->rect[k];
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

gtx_result gtx_model_derive_proxies(const gtx_asset *asset, const gtx_allocator *allocator,
                                    gtx_proxies *out, gtx_error *error)
{
    return gtx_derive_boxes(asset, hull_margin, allocator, out, error);
}

void gtx_model_fill_record(const gtx_asset *asset, const gtx_proxies *proxies, uint32_t patch,
                           const float errors[GTX_MAX_MIPS], float record[GTX_RECORD_TEXELS][4])
{
    const uint32_t first = proxies->first_index[patch], last = proxies->first_index[patch + 1];
    const gtx_patch *p = &asset->patches[patch];
    float low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    for (uint32_t k = first; k < last; ++k) {
        const gtx_proxy_vertex *v = &proxies->vertices[proxies->indices[k]];
        const float at[3] = {v->x, v->y, v->z};
        for (int a = 0; a < 3; ++a) {
            low[a] = k == first || at[a] < low[a] ? at[a] : low[a];
            high[a] = k == first || at[a] > high[a] ? at[a] : high[a];
        }
    }
    fill_frame(record, p, asset->info.height_bits, low[2], high[2]);
    for (int a = 0; a < 2; ++a) { /* the solid cells, without the margin */
        record[11][a] = low[a] + hull_margin;
        record[11][2 + a] = high[a] - hull_margin;
    }
    memcpy(record[8], p->sphere, sizeof record[8]);
    for (uint32_t k = 1; k < asset->info.mip_count; ++k)
        record[9 + (k - 1) / 4][(k - 1) % 4] = errors[k];
}

/* Cells of all levels, and the records. */
static gtx_result derive_sheets(gtx_model *model, const gtx_asset *asset, gtx_error *error)
{
    const gtx_info *info = &asset->info;
    const size_t cell_size = info->height_bits / 2;
    uint8_t *pages[GTX_MAX_MIPS];
    size_t row_texels[GTX_MAX_MIPS];
    float (*records)[GTX_RECORD_TEXELS][4] =
        (void *)add_level(model, UNIT_PATCHES, 0, GTX_RECORD_TEXELS * GTX_RECORDS_A_ROW,
                          gtx_model_record_rows(model->patch_count), 1, 4 * sizeof(float));
    bool failed = !records;
    for (uint32_t k = 0; !failed && k < info->mip_count; ++k) {
        row_texels[k] = info->page_width >> k;
        pages[k] = add_level(model, UNIT_CELLS, k, info->page_width >> k, info->page_height >> k,
                             info->page_count, (uint32_t)cell_size);
        failed = !pages[k];
    }
    if (failed)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the model's maps");
    gtx_result result = GTX_OK;
    for (uint32_t i = 0; !result && i < info->patch_count; ++i) {
        const gtx_patch *p = &asset->patches[i];
        void *cells[GTX_MAX_MIPS];
        float errors[GTX_MAX_MIPS];
        for (uint32_t k = 0; k < info->mip_count; ++k) {
            const size_t row = (size_t)p->page * (info->page_height >> k) + (p->rect[1] >> k);
            cells[k] = pages[k] + (row * row_texels[k] + (p->rect[0] >> k)) * cell_size;
        }
        result = gtx_model_derive_levels(asset, i, &model->allocator, cells, row_texels, errors,
                                         error);
        if (!result)
            gtx_model_fill_record(asset, &model->proxies, i, errors, records[i]);
    }
    return result;
}

/* Where single patches are cast, the proxies' ranges are needed for as long as the model lives. */
static gtx_result prepare_shells(gtx_model *model, const gtx_asset *asset, gtx_error *error)
{
    gtx_result result = gtx_shells_prepare(asset, &model->allocator, &model->shells, error);
    if (result || !model->shells.level_count)
        return result;
    model->first_index =
        gtx_alloc_array(&model->allocator, model->patch_count + 1, sizeof *model->first_index);
    if (!model->first_index)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the model's shell");
    memcpy(model->first_index, model->proxies.first_index,
           (model->patch_count + 1) * sizeof *model->first_index);
    return GTX_OK;
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
    gtx_result result = gtx_model_derive_proxies(asset, &hooks, &model->proxies, error);
    if (!result)
        result = derive_sheets(model, asset, error);
    if (!result)
        result = prepare_shells(model, asset, error);
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
    model->index_count = model->proxies.index_count;
    model->size.geometry += (uint64_t)model->index_count * sizeof *model->proxies.indices +
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
