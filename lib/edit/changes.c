/* Pending changes of an operation: which height fields it touches; committing and discarding them.
 * */
#include "edit/edit.h"

#include <string.h>

void gtx_edit_touch_all(gtx_edit *edit)
{
    for (uint32_t p = 0; p < edit->count; ++p)
        edit->fields[p].touched = true;
}

void gtx_edit_touch(gtx_edit *edit, const float low[3], const float high[3], float slack)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        gtx_field_span *field = &edit->fields[p];
        bool meets = true;
        for (int k = 0; k < 3; ++k)
            meets &= field->low[k] - slack <= high[k] && field->high[k] + slack >= low[k];
        field->touched |= meets;
    }
}

void gtx_edit_forget(gtx_edit *edit)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        gtx_field_span *field = &edit->fields[p];
        if (field->touched)
            memset(edit->changes + field->first, 0,
                   (size_t)field->width * field->height * sizeof *edit->changes);
        field->touched = false;
    }
}

void gtx_edit_commit(gtx_edit *edit)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        gtx_field_span *field = &edit->fields[p];
        const size_t last = field->first + (size_t)field->width * field->height;
        bool moves = false;
        for (size_t t = field->first; field->touched && t < last; ++t) {
            const float *c = edit->changes[t];
            /* Farther out nothing of it is ever shown. */
            const bool counts = edit->trim[t] < GTX_TRIM_SHOWN + GTX_EDIT_MARGIN;
            for (int k = 0; k < 3 && edit->kind[t]; ++k) {
                moves |= counts && (c[GTX_CHANGE_MOVE + k] != 0 || c[GTX_CHANGE_DETAIL + k] != 0);
                edit->point[t][k] += c[GTX_CHANGE_MOVE + k];
                edit->detail[t][k] += c[GTX_CHANGE_DETAIL + k];
            }
        }
        if (!moves)
            continue;
        field->moved = true;
        field->shown = false;
        gtx_edit_renew_normals(edit, field);
    }
    for (uint32_t p = 0; p < edit->count; ++p)
        if (edit->fields[p].touched && edit->fields[p].moved)
            gtx_edit_borrow_normals(edit, &edit->fields[p]);
}

gtx_result gtx_edit_done(gtx_edit *edit, gtx_error *error)
{
    /* Twice: a borrowed texel may be next to one that its owner borrows itself. */
    gtx_edit_follow(edit, edit->changes);
    gtx_edit_follow(edit, edit->changes);
    gtx_result result = gtx_edit_limit_folds(edit, error);
    if (!result)
        gtx_edit_commit(edit);
    gtx_edit_forget(edit);
    return result;
}
