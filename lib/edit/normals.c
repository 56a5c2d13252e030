/* Normals of moved points: those of the grid, and what the normal map knew beyond it. */
#include "edit/edit.h"

#include <math.h>
#include <string.h>

/* The step from the texel before to the one after, of those that are there. */
static bool difference(const gtx_edit *edit, const gtx_spread *field, size_t texel, size_t step,
                       bool before, bool after, float out[3])
{
    const size_t at = field->first + texel;
    const size_t a = before && edit->kind[at - step] ? at - step : at;
    const size_t b = after && edit->kind[at + step] ? at + step : at;
    for (int k = 0; k < 3; ++k)
        out[k] = edit->point[b][k] - edit->point[a][k];
    return a != b;
}

/* The unit normal of the points alone; false where they make no surface. */
static bool facet(const gtx_edit *edit, const gtx_spread *field, uint32_t i, uint32_t j,
                  float out[3])
{
    const size_t texel = (size_t)j * field->width + i;
    float u[3], v[3], square = 0;
    if (!difference(edit, field, texel, 1, i > 0, i + 1 < field->width, u) ||
        !difference(edit, field, texel, field->width, j > 0, j + 1 < field->height, v))
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

static void find_box(const gtx_edit *edit, gtx_spread *field)
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
        gtx_spread *field = &edit->fields[p];
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

static void turn_normals(gtx_edit *edit, const gtx_spread *field)
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

/* Borrowed texels have the normals of their owners. */
static void borrow_normals(gtx_edit *edit, const gtx_spread *field)
{
    for (size_t i = 0; i < field->link_count; ++i) {
        const gtx_link *link = &edit->links[field->first_link + i];
        const gtx_spread *other = &edit->fields[link->patch];
        const size_t a = other->first + link->source, b = a + other->width;
        const float u = link->u, v = link->v;
        float n[3], square = 0;
        for (int k = 0; k < 3; ++k) {
            n[k] = (1 - v) * ((1 - u) * edit->normal[a][k] + u * edit->normal[a + 1][k]) +
                   v * ((1 - u) * edit->normal[b][k] + u * edit->normal[b + 1][k]);
            square += n[k] * n[k];
        }
        for (int k = 0; k < 3 && square > 1e-6f; ++k)
            edit->normal[field->first + link->texel][k] = n[k] / sqrtf(square);
    }
}

void gtx_edit_commit(gtx_edit *edit)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        gtx_spread *field = &edit->fields[p];
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
        turn_normals(edit, field);
        find_box(edit, field);
    }
    for (uint32_t p = 0; p < edit->count; ++p)
        if (edit->fields[p].touched && edit->fields[p].moved)
            borrow_normals(edit, &edit->fields[p]);
}
