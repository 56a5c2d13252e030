/* The memory of an edit, from beginning to end. */
#include "edit/edit.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static gtx_result allocate(gtx_edit *edit, gtx_error *error)
{
    const gtx_allocator *hooks = &edit->allocator;
    const gtx_asset *asset = edit->source;
    edit->fields = gtx_alloc_array(hooks, edit->count, sizeof *edit->fields);
    edit->changed = gtx_alloc_array(hooks, edit->count, sizeof *edit->changed);
    if (!edit->fields || !edit->changed)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to edit %u patches", edit->count);
    for (uint32_t p = 0; p < edit->count; ++p) {
        const uint16_t *rect = asset->patches[p].rect;
        edit->fields[p] = (gtx_field_span){.width = rect[2] + 2u * GTX_EDIT_MARGIN,
                                           .height = rect[3] + 2u * GTX_EDIT_MARGIN,
                                           .first = edit->texels,
                                           .shown = true};
        edit->texels += (size_t)edit->fields[p].width * edit->fields[p].height;
    }
    const size_t n = edit->texels;
    edit->kind = gtx_alloc_array(hooks, n, 1);
    edit->ring = gtx_alloc_array(hooks, n, 1);
    edit->rest = gtx_alloc_array(hooks, n, sizeof *edit->rest);
    edit->point = gtx_alloc_array(hooks, n, sizeof *edit->point);
    edit->normal = gtx_alloc_array(hooks, n, sizeof *edit->normal);
    edit->detail = gtx_alloc_array(hooks, n, sizeof *edit->detail);
    edit->height = gtx_alloc_array(hooks, n, sizeof *edit->height);
    edit->trim = gtx_alloc_array(hooks, n, sizeof *edit->trim);
    edit->value = gtx_alloc_array(hooks, n, sizeof *edit->value);
    edit->next = gtx_alloc_array(hooks, n, sizeof *edit->next);
    edit->changes = gtx_alloc_array(hooks, n, sizeof *edit->changes);
    if (!edit->kind || !edit->ring || !edit->rest || !edit->point || !edit->normal ||
        !edit->detail || !edit->height || !edit->trim || !edit->value || !edit->next ||
        !edit->changes)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to edit %zu texels", n);
    return GTX_OK;
}

static int by_size(const void *a, const void *b)
{
    const float p = *(const float *)a, q = *(const float *)b;
    return (p > q) - (p < q);
}

/* The median, for patches too small for the model's density have one of their own. */
static gtx_result find_texel_size(gtx_edit *edit, gtx_error *error)
{
    float *sizes = gtx_alloc_array(&edit->allocator, edit->count, sizeof *sizes);
    if (!sizes)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to edit %u patches", edit->count);
    for (uint32_t p = 0; p < edit->count; ++p) {
        const gtx_patch *patch = &edit->source->patches[p];
        sizes[p] = sqrtf(patch->extent_x / patch->rect[2] * patch->extent_y / patch->rect[3]);
    }
    qsort(sizes, edit->count, sizeof *sizes, by_size);
    edit->texel_size = sizes[edit->count / 2];
    gtx_free_array(&edit->allocator, sizes, edit->count, sizeof *sizes);
    return GTX_OK;
}

gtx_result gtx_edit_begin(const gtx_asset *asset, const gtx_edit_desc *desc, gtx_edit **out,
                          gtx_error *error)
{
    const gtx_edit_desc zero = {0};
    const gtx_edit_desc *d = desc ? desc : &zero;
    if (!asset || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "editing needs an asset");
    gtx_result result = gtx_check_reserved(d->reserved, 6, error);
    if (result)
        return result;
    const gtx_allocator hooks = gtx_allocator_or_default(d->allocator);
    gtx_edit *edit = gtx_alloc_array(&hooks, 1, sizeof *edit);
    if (!edit)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for an edit");
    edit->allocator = hooks;
    edit->source = asset;
    edit->count = asset->info.patch_count;
    result = allocate(edit, error);
    if (!result)
        result = find_texel_size(edit, error);
    if (!result)
        result = gtx_edit_read_fields(edit, error);
    if (!result)
        result = gtx_edit_find_correspondences(edit, error);
    if (result) {
        gtx_edit_end(edit);
        return result;
    }
    memcpy(edit->point, edit->rest, edit->texels * sizeof *edit->point);
    gtx_edit_begin_details(edit);
    *out = edit;
    return GTX_OK;
}

void gtx_edit_end(gtx_edit *edit)
{
    if (!edit)
        return;
    const gtx_allocator hooks = edit->allocator;
    const size_t n = edit->texels;
    gtx_close(edit->live);
    gtx_free_array(&hooks, edit->fields, edit->count, sizeof *edit->fields);
    gtx_free_array(&hooks, edit->changed, edit->count, sizeof *edit->changed);
    gtx_free_array(&hooks, edit->kind, n, 1);
    gtx_free_array(&hooks, edit->ring, n, 1);
    gtx_free_array(&hooks, edit->rest, n, sizeof *edit->rest);
    gtx_free_array(&hooks, edit->point, n, sizeof *edit->point);
    gtx_free_array(&hooks, edit->normal, n, sizeof *edit->normal);
    gtx_free_array(&hooks, edit->detail, n, sizeof *edit->detail);
    gtx_free_array(&hooks, edit->height, n, sizeof *edit->height);
    gtx_free_array(&hooks, edit->trim, n, sizeof *edit->trim);
    gtx_free_array(&hooks, edit->value, n, sizeof *edit->value);
    gtx_free_array(&hooks, edit->next, n, sizeof *edit->next);
    gtx_free_array(&hooks, edit->changes, n, sizeof *edit->changes);
    gtx_free_array(&hooks, edit->correspondences, edit->correspondence_count,
                   sizeof *edit->correspondences);
    gtx_free_array(&hooks, edit->loose, edit->loose_count, sizeof *edit->loose);
    gtx_free_array(&hooks, edit, 1, sizeof *edit);
}

float gtx_edit_texel_size(const gtx_edit *edit)
{
    return edit ? edit->texel_size : 0;
}
