/* Models on the CPU's side: what they are asked for, and their end. */
#include "frame/model.h"

#include "base/alloc.h"
#include "base/hash.h"

#include <math.h>
#include <string.h>

uint64_t gtx_model_layout(const gtx_asset *asset)
{
    gtx_hash hash;
    gtx_hash_begin(&hash);
    gtx_hash_add(&hash, &asset->bare, sizeof asset->bare);
    for (uint32_t i = 0; i < asset->info.patch_count; ++i) {
        const gtx_patch *p = &asset->patches[i];
        gtx_hash_add(&hash, &p->page, sizeof p->page);
        gtx_hash_add(&hash, p->rect, sizeof p->rect);
    }
    return gtx_hash_end(&hash);
}

/* Of what shows, as blocks have it. */
static double area_of(const gtx_model *model, uint32_t patch)
{
    const float *x = model->records[patch][GTX_RECORD_AXIS_X];
    const float *y = model->records[patch][GTX_RECORD_AXIS_Y];
    double square = 0, cells = 0;
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        square += pow((double)x[a] * y[b] - (double)x[b] * y[a], 2);
    }
    const uint32_t *first = &model->first_slab[patch];
    for (uint32_t i = first[0]; i < first[1]; ++i) { /* none of a beginning without maps */
        const gtx_slab *s = &model->slabs[i];
        if (s->low[0] <= s->high[0])
            cells += ((double)s->high[0] - s->low[0]) * ((double)s->high[1] - s->low[1]);
    }
    return sqrt(square) * cells;
}

/* Seen from all sides, a surface covers a fourth of its area in the mean (Cauchy 1832), and so does
 * the box around it. */
static double depth_complexity_of(const gtx_model *model, double area)
{
    double side[3];
    for (int k = 0; k < 3; ++k)
        side[k] = (double)model->lods.high[k] - model->lods.low[k];
    const double box = 2 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0]);
    return box > 0 ? fmax(1, area / box) : 1;
}

void gtx_model_sum_up(gtx_model *model)
{
    double radius = 0, area = 0;
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
        area += area_of(model, i);
    }
    model->sphere[3] = (float)(radius * 1.0001);
    model->bare = !(area > 0);
    model->depth_complexity = (float)fmin(depth_complexity_of(model, area), 1e6);
}

static bool is_high(const gtx_model *model)
{
    return model->page_height > GTX_HIGH_PAGE;
}

uint32_t gtx_model_cell_rows(const gtx_model *model)
{
    const uint32_t height = model->page_height, mips = model->mip_count;
    return (mips > 1 && !is_high(model) ? 2 * height : height) + (mips > 2 ? height / 2 : 0);
}

uint32_t gtx_model_cell_columns(const gtx_model *model)
{
    return model->mip_count > 1 && is_high(model) ? 2 * model->page_width : model->page_width;
}

void gtx_model_cells_at(const gtx_model *model, const gtx_patch *patch, uint32_t level,
                        uint32_t at[2])
{
    const uint32_t up = level ? level - 1 : 0, width = model->page_width;
    const bool high = is_high(model);
    at[0] = (patch->rect[0] >> up) + (up ? width - (width >> (up - 1)) : 0) +
            (high && level == 1 ? width : 0);
    at[1] = (patch->rect[1] >> up) +
            model->page_height * (high ? level > 1 : level < 2 ? level : 2);
}

void gtx_model_pack_indices(const gtx_model *model, const uint32_t *indices, uint32_t count,
                            void *out)
{
    uint8_t *to = out;
    for (uint32_t i = 0; i < count; ++i, to += model->proxy_index_size) {
        const uint32_t wide = indices[i];
        const uint16_t narrow = (uint16_t)wide;
        memcpy(to, model->proxy_index_size == 2 ? (const void *)&narrow : &wide,
               model->proxy_index_size);
    }
}

void gtx_model_free_staging(gtx_model *model)
{
    for (uint32_t i = 0; i < model->level_count; ++i) {
        gtx_level *l = &model->levels[i];
        if (!l->borrowed)
            gtx_free_array(&model->allocator, l->data, gtx_level_size(l), 1);
        l->data = NULL;
    }
    gtx_proxies_free(&model->proxies, &model->allocator);
    gtx_lod_free_staging(&model->lods, &model->allocator);
}

void gtx_model_free(gtx_model *model)
{
    if (!model)
        return;
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
    if (model->first_node)
        gtx_free_array(&hooks, model->nodes, model->first_node[model->patch_count],
                       sizeof *model->nodes);
    gtx_free_array(&hooks, model->first_node, (size_t)model->patch_count + 1,
                   sizeof *model->first_node);
    gtx_free_array(&hooks, model->rtins, model->patch_count, sizeof *model->rtins);
    gtx_free_array(&hooks, model->first_slab, (size_t)model->mip_count * model->patch_count + 1,
                   sizeof *model->first_slab);
    gtx_free_array(&hooks, model, 1, sizeof *model);
}

gtx_model_size gtx_model_gpu_size(const gtx_model *model)
{
    return model ? model->size : (gtx_model_size){0, 0};
}
