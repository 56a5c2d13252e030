/* Normals of moved points: those of the grid, with the finer detail of the normal map on top. */
#include "edit/edit.h"

#include <math.h>
#include <string.h>

/* The step along an axis from the texel before (i, j) to the one after, of those that are there. */
static bool difference(const gtx_edit *edit, const gtx_field_span *field, const uint32_t texel[2],
                       int axis, float out[3])
{
    const size_t at = field->first + (size_t)texel[1] * field->width + texel[0];
    const size_t step = axis ? field->width : 1, side = axis ? field->height : field->width;
    const size_t a = texel[axis] > 0 && edit->kind[at - step] ? at - step : at;
    const size_t b = texel[axis] + 1 < side && edit->kind[at + step] ? at + step : at;
    for (int k = 0; k < 3; ++k)
        out[k] = edit->point[b][k] - edit->point[a][k];
    return a != b;
}

/* The unit normal of the points alone; false where they make no surface. */
static bool facet(const gtx_edit *edit, const gtx_field_span *field, uint32_t i, uint32_t j,
                  float out[3])
{
    const uint32_t texel[2] = {i, j};
    float u[3], v[3], square = 0;
    if (!difference(edit, field, texel, 0, u) || !difference(edit, field, texel, 1, v))
        return false;
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        out[k] = u[a] * v[b] - u[b] * v[a];
        square += out[k] * out[k];
    }
    if (!(square > 0))
        return false;
    for (int k = 0; k < 3; ++k)
        out[k] /= sqrtf(square);
    return true;
}

static void find_box(const gtx_edit *edit, gtx_field_span *field)
{
    const size_t last = field->first + (size_t)field->width * field->height;
    for (int k = 0; k < 3; ++k) {
        field->low[k] = INFINITY;
        field->high[k] = -INFINITY;
    }
    for (size_t t = field->first; t < last; ++t)
        for (int k = 0; k < 3 && edit->kind[t]; ++k) {
            field->low[k] = fminf(field->low[k], edit->point[t][k]);
            field->high[k] = fmaxf(field->high[k], edit->point[t][k]);
        }
}

void gtx_edit_begin_details(gtx_edit *edit)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        gtx_field_span *field = &edit->fields[p];
        find_box(edit, field);
        for (uint32_t j = 0; j < field->height; ++j)
            for (uint32_t i = 0; i < field->width; ++i) {
                const size_t at = field->first + (size_t)j * field->width + i;
                float n[3];
                if (edit->kind[at] && facet(edit, field, i, j, n))
                    for (int k = 0; k < 3; ++k)
                        edit->detail[at][k] = edit->normal[at][k] - n[k];
            }
    }
}

static void turn_normals(gtx_edit *edit, const gtx_field_span *field)
{
    for (uint32_t j = 0; j < field->height; ++j)
        for (uint32_t i = 0; i < field->width; ++i) {
            const size_t at = field->first + (size_t)j * field->width + i;
            float n[3], square = 0;
            if (!edit->kind[at] || !facet(edit, field, i, j, n))
                continue;
            for (int k = 0; k < 3; ++k) {
                n[k] += edit->detail[at][k];
                square += n[k] * n[k];
            }
            if (!(square > 1e-6f)) /* the two cancel: there is no telling */
                continue;
            for (int k = 0; k < 3; ++k)
                edit->normal[at][k] = n[k] / sqrtf(square);
        }
}

void gtx_edit_renew_normals(gtx_edit *edit, gtx_field_span *field)
{
    turn_normals(edit, field);
    find_box(edit, field);
}

void gtx_edit_borrow_normals(gtx_edit *edit, const gtx_field_span *field)
{
    for (size_t i = 0; i < field->correspondence_count; ++i) {
        const gtx_correspondence *owner =
            &edit->correspondences[field->first_correspondence + i];
        const gtx_field_span *other = &edit->fields[owner->patch];
        const size_t a = other->first + owner->source, b = a + other->width;
        const float u = owner->u, v = owner->v;
        float n[3], square = 0;
        for (int k = 0; k < 3; ++k) {
            n[k] = (1 - v) * ((1 - u) * edit->normal[a][k] + u * edit->normal[a + 1][k]) +
                   v * ((1 - u) * edit->normal[b][k] + u * edit->normal[b + 1][k]);
            square += n[k] * n[k];
        }
        for (int k = 0; k < 3 && square > 1e-6f; ++k)
            edit->normal[field->first + owner->texel][k] = n[k] / sqrtf(square);
    }
}
