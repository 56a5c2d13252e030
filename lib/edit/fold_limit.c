/* The fold limiter: holds back changes that would turn part of a height field away from its z,
 * where no height map can show it. */
#include "edit/edit.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>

/* Tuned on the gargoyle and the bunny, blurred by 30 texels (gtx filter --gaussian 30): 304 and 660
 * cells turn away in the end, and texels keep 0.50 and 0.80 of their change. */
/* A cell's triangles keep this share of a texel's area, seen along z. At rest they have half of
 * it. At half 283 and 599 turn, and 0.54 and 0.81 is kept; at double 33 and 559, and 0.44 and
 * 0.76. */
static const double MIN_AREA = 0.05;
/* Texels around one that is held on which this wears off. At half 2,279 and 2,117 cells turn; at
 * double 2 and 6, but of a high boost of 5 the gargoyle keeps 0.31 for 0.43. */
enum { REACH = 8 };
/* Every round takes half of what is left, the last ones all. Half as many rounds leave 1,617 and
 * 2,076 cells, double 65 of the gargoyle's, which then keeps 0.47. With 2 that halve 0.37 and 0.77
 * is kept, with 10 it is 0.60 and 0.85. */
enum { ROUNDS = 12, HALVING_ROUNDS = 5 };

/* Fields of a gtx_change here: how much is taken this round, and what is left. */
enum { HELD, LEFT };

/* Where a texel would be on its patch's texels. */
static void place(const gtx_edit *edit, const gtx_field_span *field, size_t at, double left,
                  double out[2])
{
    out[0] = (double)((at - field->first) % field->width);
    out[1] = (double)((at - field->first) / field->width);
    for (int k = 0; k < 3; ++k) {
        const double move = (double)edit->point[at][k] - edit->rest[at][k] +
                            left * edit->changes[at][GTX_CHANGE_MOVE + k];
        out[0] += field->to_grid[0][k] * move;
        out[1] += field->to_grid[1][k] * move;
    }
}

/* Whether a triangle at any corner of the cell would turn away. `left` may be NULL: all of it. */
static bool turns(const gtx_edit *edit, const gtx_field_span *field, const size_t corner[4],
                  gtx_change *left)
{
    double p[4][2];
    for (int k = 0; k < 4; ++k)
        place(edit, field, corner[k], left ? left[corner[k]][LEFT] : 1, p[k]);
    for (int k = 0; k < 4; ++k) {
        const double *a = p[k], *b = p[(k + 1) % 4], *c = p[(k + 2) % 4];
        if (!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 2 * MIN_AREA))
            return true;
    }
    return false;
}

/* The correspondence of a borrowed texel. */
static const gtx_correspondence *find_correspondence(const gtx_edit *edit,
                                                     const gtx_field_span *field, size_t at)
{
    const uint32_t texel = (uint32_t)(at - field->first);
    size_t first = field->first_correspondence, last = first + field->correspondence_count;
    while (first + 1 < last) {
        const size_t middle = first + (last - first) / 2;
        if (edit->correspondences[middle].texel <= texel)
            first = middle;
        else
            last = middle;
    }
    return &edit->correspondences[first];
}

/* Holds a texel, or those that it is borrowed from. */
static void hold(const gtx_edit *edit, const gtx_field_span *field, size_t at, gtx_change *held)
{
    held[at][HELD] = 1;
    if (edit->kind[at] != GTX_TEXEL_BORROWED)
        return;
    const gtx_correspondence *owner = find_correspondence(edit, field, at);
    const gtx_field_span *other = &edit->fields[owner->patch];
    gtx_change *a = held + other->first + owner->source, *b = a + other->width;
    a[0][HELD] = a[1][HELD] = b[0][HELD] = b[1][HELD] = 1;
}

/* Looks at the cells that a patch shows of its own; holds the corners of those that turn, if `held`
 * is given. Returns whether there are any. */
static bool find_turned(const gtx_edit *edit, gtx_change *held)
{
    bool any = false;
    for (uint32_t p = 0; p < edit->count; ++p) {
        const gtx_field_span *field = &edit->fields[p];
        for (uint32_t j = 0; field->touched && j + 1 < field->height; ++j)
            for (uint32_t i = 0; i + 1 < field->width; ++i) {
                const size_t a = field->first + (size_t)j * field->width + i, b = a + field->width;
                const size_t corner[4] = {a, a + 1, b + 1, b};
                bool whole = true, own = false;
                for (int k = 0; k < 4; ++k) {
                    whole &= edit->kind[corner[k]] != GTX_TEXEL_NONE;
                    own |= edit->kind[corner[k]] == GTX_TEXEL_OWN;
                }
                if (!whole || !own || !turns(edit, field, corner, held))
                    continue;
                any = true;
                for (int k = 0; held && k < 4; ++k)
                    hold(edit, field, corner[k], held);
            }
    }
    return any;
}

/* Own texels are held a little less than those beside them, and so on across the patches. */
static void spread_limit(const gtx_edit *edit, gtx_change *held)
{
    for (int pass = 0; pass < REACH; ++pass) {
        for (uint32_t p = 0; p < edit->count; ++p) {
            const gtx_field_span *field = &edit->fields[p];
            const size_t width = field->width, last = field->first + width * field->height;
            const ptrdiff_t next[4] = {1, -1, (ptrdiff_t)width, -(ptrdiff_t)width};
            for (size_t t = field->first; field->touched && t < last; ++t)
                for (int k = 0; k < 4 && edit->kind[t] == GTX_TEXEL_OWN; ++k)
                    held[t][HELD] = fmaxf(held[t][HELD],
                                          held[(ptrdiff_t)t + next[k]][HELD] - 1.0f / REACH);
        }
        gtx_edit_follow(edit, held);
    }
}

/* Ends a round. */
static void take(const gtx_edit *edit, gtx_change *held, float share)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        const gtx_field_span *field = &edit->fields[p];
        const size_t last = field->first + (size_t)field->width * field->height;
        for (size_t t = field->first; field->touched && t < last; ++t) {
            held[t][LEFT] *= 1 - share * held[t][HELD];
            held[t][HELD] = 0;
        }
    }
}

gtx_result gtx_edit_limit_folds(gtx_edit *edit, gtx_error *error)
{
    if (!find_turned(edit, NULL))
        return GTX_OK;
    gtx_change *held = gtx_alloc_array(&edit->allocator, edit->texels, sizeof *held);
    if (!held)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to limit folds");
    for (size_t t = 0; t < edit->texels; ++t)
        held[t][LEFT] = 1;
    for (int round = 0; round < ROUNDS && find_turned(edit, held); ++round) {
        const float share = round < HALVING_ROUNDS ? 0.5f : 1;
        spread_limit(edit, held);
        take(edit, held, share);
        gtx_edit_follow(edit, held);
    }
    for (uint32_t p = 0; p < edit->count; ++p) {
        const gtx_field_span *field = &edit->fields[p];
        const size_t last = field->first + (size_t)field->width * field->height;
        for (size_t t = field->first; field->touched && t < last; ++t)
            for (int c = 0; c < GTX_CHANGE_VALUE; ++c)
                edit->changes[t][c] *= held[t][LEFT];
    }
    gtx_free_array(&edit->allocator, held, edit->texels, sizeof *held);
    gtx_edit_follow(edit, edit->changes);
    return GTX_OK;
}
