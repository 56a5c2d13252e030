/* Blur and high-boost. */
#include "edit/edit.h"

#include "base/error.h"

#include <math.h>

static const float MAX_BOOST = 16;
/* Patches of other densities count as at most this often their texels: a blur takes time for each
 * texel of its radius. */
static const double MAX_SPREAD = 8;

/* The radius in object units. */
static gtx_result read_blur(const gtx_edit *edit, const gtx_edit_blur *blur, double *radius,
                            gtx_error *error)
{
    if (!edit || !blur)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a blur needs an edit and a radius");
    gtx_result result = gtx_check_reserved(blur->reserved, 6, error);
    if (result)
        return result;
    if (blur->flags & ~(uint32_t)(GTX_EDIT_WORLD | GTX_EDIT_PER_PATCH))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "unknown flags of a blur");
    if (!(blur->radius > 0) || isinf(blur->radius))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the radius of a blur is not finite and above 0");
    *radius = (double)blur->radius * (blur->flags & GTX_EDIT_WORLD ? 1 : edit->texel_size);
    double largest = 0, texels = 0;
    for (uint32_t p = 0; p < edit->count; ++p) {
        const gtx_patch *patch = &edit->source->patches[p];
        largest = fmax(largest, fmax(patch->extent_x, patch->extent_y));
        texels = fmax(texels, fmax(patch->rect[2], patch->rect[3]));
    }
    largest = fmin(largest, MAX_SPREAD * texels * edit->texel_size);
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
    const bool per_patch = blur->flags & GTX_EDIT_PER_PATCH;
    gtx_edit_touch_all(edit);
    result = (per_patch ? gtx_edit_blur_per_patch : gtx_edit_heat_flow)(edit, radius, error);
    for (size_t t = 0; !result && t < edit->texels; ++t)
        for (int c = 0; c < GTX_CHANGE_VALUE; ++c)
            edit->changes[t][c] *= amount;
    if (!result && !per_patch)
        return gtx_edit_done(edit, error);
    if (!result)
        gtx_edit_commit(edit);
    gtx_edit_forget(edit);
    return result;
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
