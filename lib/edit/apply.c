/* Calls an operation of the caller's for each patch, and takes over what it did to own texels. */
#include "edit/edit.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

/* Calls the operation, and takes what it did to own texels. False where that is not finite. */
static bool call(gtx_edit *edit, uint32_t patch, gtx_edit_fn fn, void *user)
{
    const gtx_field_span *s = &edit->fields[patch];
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
        gtx_edit_forget(edit);
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
