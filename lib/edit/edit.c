/* An edit: its memory, and the operations that blur, boost or are somebody's own. */
#include "edit/edit.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float MAX_BOOST = 16;

static gtx_result allocate(gtx_edit *edit, gtx_error *error)
{
    const gtx_allocator *hooks = &edit->allocator;
    const gtx_asset *asset = edit->source;
    edit->fields = gtx_alloc_array(hooks, edit->count, sizeof *edit->fields);
    edit->changed = gtx_alloc_array(hooks, edit->count, sizeof *edit->changed);
    if (!edit->fields || !edit->changed)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to edit %u patches", edit->count);
    for (uint32_t p = 0; p < edit->count; ++p) {
        edit->fields[p] = (gtx_spread){.width = asset->patches[p].rect[2] + 2u * GTX_EDIT_MARGIN,
                                       .height = asset->patches[p].rect[3] + 2u * GTX_EDIT_MARGIN,
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
        result = gtx_edit_spread(edit, error);
    if (!result)
        result = gtx_edit_link(edit, error);
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
    gtx_free_array(&hooks, edit->links, edit->link_count, sizeof *edit->links);
    gtx_free_array(&hooks, edit->loose, edit->loose_count, sizeof *edit->loose);
    gtx_free_array(&hooks, edit, 1, sizeof *edit);
}

float gtx_edit_texel_size(const gtx_edit *edit)
{
    return edit ? edit->texel_size : 0;
}

void gtx_edit_touch_all(gtx_edit *edit)
{
    for (uint32_t p = 0; p < edit->count; ++p)
        edit->fields[p].touched = true;
}

void gtx_edit_touch(gtx_edit *edit, const float low[3], const float high[3], float slack)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        gtx_spread *field = &edit->fields[p];
        bool meets = true;
        for (int k = 0; k < 3; ++k)
            meets &= field->low[k] - slack <= high[k] && field->high[k] + slack >= low[k];
        field->touched |= meets;
    }
}

static void forget_changes(gtx_edit *edit)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        gtx_spread *field = &edit->fields[p];
        if (field->touched)
            memset(edit->changes + field->first, 0,
                   (size_t)field->width * field->height * sizeof *edit->changes);
        field->touched = false;
    }
}

gtx_result gtx_edit_done(gtx_edit *edit, gtx_error *error)
{
    /* Twice: a borrowed texel may be next to one that its owner borrows itself. */
    gtx_edit_follow(edit, edit->changes);
    gtx_edit_follow(edit, edit->changes);
    gtx_result result = gtx_edit_hold(edit, error);
    if (!result)
        gtx_edit_commit(edit);
    forget_changes(edit);
    return result;
}

/* The radius in object units. */
static gtx_result read_blur(const gtx_edit *edit, const gtx_edit_blur *blur, double *radius,
                            gtx_error *error)
{
    if (!edit || !blur)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a blur needs an edit and a radius");
    gtx_result result = gtx_check_reserved(blur->reserved, 6, error);
    if (result)
        return result;
    if (blur->flags & ~(uint32_t)(GTX_EDIT_WORLD | GTX_EDIT_ALONE))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a blur has no such flags");
    if (!(blur->radius > 0) || isinf(blur->radius))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the radius of a blur is finite and above 0");
    *radius = (double)blur->radius * (blur->flags & GTX_EDIT_WORLD ? 1 : edit->texel_size);
    double largest = 0;
    for (uint32_t p = 0; p < edit->count; ++p) {
        const gtx_patch *patch = &edit->source->patches[p];
        largest = fmax(largest, fmax(patch->extent_x, patch->extent_y));
    }
    if (*radius > largest)
        return gtx_fail(error, GTX_ERROR_LIMIT,
                        "a blur of %g texels is larger than the largest patch, of %g",
                        *radius / edit->texel_size, largest / edit->texel_size);
    return GTX_OK;
}

/* Ends with the surface + amount * (its blur - the surface). */
static gtx_result filter(gtx_edit *edit, const gtx_edit_blur *blur, float amount, gtx_error *error)
{
    double radius = 0;
    gtx_result result = read_blur(edit, blur, &radius, error);
    if (result)
        return result;
    const bool alone = blur->flags & GTX_EDIT_ALONE;
    result = alone ? gtx_edit_diffuse_alone(edit, radius, error)
                   : gtx_edit_diffuse(edit, radius, error);
    if (result)
        return result;
    for (size_t t = 0; t < edit->texels; ++t)
        for (int c = 0; c < GTX_CHANGE_VALUE; ++c)
            edit->changes[t][c] *= amount;
    if (!alone)
        return gtx_edit_done(edit, error);
    gtx_edit_commit(edit);
    forget_changes(edit);
    return GTX_OK;
}

gtx_result gtx_edit_gaussian(gtx_edit *edit, const gtx_edit_blur *blur, gtx_error *error)
{
    return filter(edit, blur, 1, error);
}

gtx_result gtx_edit_high_boost(gtx_edit *edit, const gtx_edit_blur *blur, float amount,
                               gtx_error *error)
{
    if (!(amount > 0 && amount <= MAX_BOOST))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "high-boost takes an amount above 0, up to %g",
                        (double)MAX_BOOST);
    return filter(edit, blur, -amount, error);
}

/* Calls the operation, and takes what it did to own texels. False where that is not finite. */
static bool call(gtx_edit *edit, uint32_t patch, gtx_edit_fn fn, void *user)
{
    const gtx_spread *s = &edit->fields[patch];
    const size_t count = (size_t)s->width * s->height;
    float (*point)[3] = edit->point + s->first;
    const gtx_edit_field field = {.patch = patch, .width = s->width, .height = s->height,
                                  .kind = edit->kind + s->first, .point = point,
                                  .normal = (const float (*)[3])edit->normal + s->first,
                                  .value = edit->value + s->first, .next = edit->next + s->first};
    for (size_t t = 0; t < count; ++t)
        memcpy(edit->changes[s->first + t], point[t], sizeof *point);
    fn(&field, user);
    bool finite = true;
    for (size_t t = 0; t < count; ++t) {
        float *c = edit->changes[s->first + t];
        for (int k = 0; k < 3; ++k) {
            const float before = c[k], after = point[t][k];
            const bool own = field.kind[t] == GTX_TEXEL_OWN;
            c[k] = own ? after - before : 0;
            point[t][k] = before;
            finite &= !own || isfinite(after);
        }
        c[GTX_CHANGE_VALUE] = field.next[t];
        finite &= isfinite(field.next[t]) != 0;
    }
    return finite;
}

gtx_result gtx_edit_apply(gtx_edit *edit, gtx_edit_fn fn, void *user, gtx_error *error)
{
    if (!edit || !fn)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "an operation needs an edit and a function");
    bool finite = true;
    gtx_edit_touch_all(edit);
    for (uint32_t p = 0; p < edit->count; ++p)
        finite &= call(edit, p, fn, user);
    if (!finite) {
        memcpy(edit->next, edit->value, edit->texels * sizeof *edit->next);
        forget_changes(edit);
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the operation gave a point or a value that is not finite");
    }
    gtx_edit_follow(edit, edit->changes);
    for (size_t t = 0; t < edit->texels; ++t)
        edit->next[t] = edit->changes[t][GTX_CHANGE_VALUE];
    gtx_result result = gtx_edit_done(edit, error);
    if (result)
        memcpy(edit->next, edit->value, edit->texels * sizeof *edit->next);
    else
        memcpy(edit->value, edit->next, edit->texels * sizeof *edit->next);
    return result;
}
