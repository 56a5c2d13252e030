/* Operations that raise the surface or press into it: patterns, stamps, rectangles of heights. */
#include "edit/edit.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

enum { MIN_SIDE = 2, MAX_SIDE = 16384 };

static gtx_result check_image(const gtx_edit_image *image, gtx_error *error)
{
    if (!image->values || image->width < MIN_SIDE || image->height < MIN_SIDE ||
        image->width > MAX_SIDE || image->height > MAX_SIDE)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an image of heights is %d to %d texels wide and high, not %u x %u",
                        MIN_SIDE, MAX_SIDE, image->width, image->height);
    for (size_t i = 0; i < (size_t)image->width * image->height; ++i)
        if (!isfinite(image->values[i]))
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "height %zu of the image is not finite", i);
    return GTX_OK;
}

/* What lies beyond a whole number; 0 of what is no number. */
static double part_of(double at)
{
    const double part = at - floor(at);
    return part >= 0 ? part : 0;
}

/* The image at (u, v), each 0..1 from one side to the other, v downwards; it is repeated. */
static double look_up(const gtx_edit_image *image, double u, double v)
{
    const double x = part_of(u) * image->width - 0.5, y = part_of(v) * image->height - 0.5;
    const double i = floor(x), j = floor(y);
    double row[2];
    for (int k = 0; k < 2; ++k) {
        const uint32_t at = (uint32_t)((int64_t)j + k + image->height) % image->height;
        const float *line = image->values + (size_t)at * image->width;
        const uint32_t a = (uint32_t)((int64_t)i + image->width) % image->width;
        row[k] = line[a] + (x - i) * (line[(a + 1) % image->width] - line[a]);
    }
    return row[0] + (y - j) * (row[1] - row[0]);
}

/* Weights of the three axes: a surface that faces one is laid on from that one alone. */
static double look_from_axes(const gtx_edit_image *image, const float point[3],
                             const float normal[3], double size)
{
    static const uint8_t across[3] = {2, 0, 0}, down[3] = {1, 2, 1};
    double sum = 0, weights = 0;
    for (int k = 0; k < 3; ++k) {
        const double slant = fmax(fabs(normal[k]) - 0.3, 0), weight = slant * slant * slant;
        if (weight > 0)
            sum += weight * look_up(image, point[across[k]] / size,
                                    -point[down[k]] / size * image->width / image->height);
        weights += weight;
    }
    return sum / weights;
}

gtx_result gtx_edit_pattern(gtx_edit *edit, const gtx_edit_image *image, float height, float size,
                            gtx_error *error)
{
    if (!edit || !image)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a pattern needs an edit and an image");
    if (!isfinite(height) || !(size > 0) || isinf(size))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a pattern's height is finite, its size finite and above 0");
    gtx_result result = check_image(image, error);
    if (result)
        return result;
    gtx_edit_touch_all(edit);
    for (size_t t = 0; t < edit->texels; ++t) {
        if (edit->kind[t] != GTX_TEXEL_OWN)
            continue;
        const double by = height * look_from_axes(image, edit->point[t], edit->normal[t], size);
        for (int k = 0; k < 3; ++k)
            edit->changes[t][GTX_CHANGE_MOVE + k] = (float)(by * edit->normal[t][k]);
    }
    return gtx_edit_done(edit, error);
}

/* A stamp's axes, of length 1: right, up, and where it presses. */
typedef struct press {
    float axis[3][3];
    const gtx_edit_stamp_desc *stamp;
} press;

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool normalise(float v[3])
{
    const float size = sqrtf(dot(v, v));
    for (int k = 0; k < 3; ++k)
        v[k] /= size;
    return size > 0 && isfinite(size);
}

static bool find_axes(const gtx_edit_stamp_desc *stamp, press *out)
{
    float *right = out->axis[0], *up = out->axis[1], *down = out->axis[2];
    memcpy(down, stamp->direction, sizeof out->axis[2]);
    if (!normalise(down))
        return false;
    memcpy(up, stamp->up, sizeof out->axis[1]);
    if (dot(up, up) == 0)
        up[fabsf(down[1]) < 0.9f ? 1 : 0] = 1;
    const float along = dot(up, down);
    for (int k = 0; k < 3; ++k)
        up[k] -= along * down[k];
    if (!normalise(up))
        return false;
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        right[k] = down[a] * up[b] - down[b] * up[a];
    }
    return true;
}

/* How deep the stamp presses at a point, as a share of its depth. */
static float depth_at(const press *p, const float point[3])
{
    const gtx_edit_stamp_desc *stamp = p->stamp;
    float from[3], at[3];
    for (int k = 0; k < 3; ++k)
        from[k] = (point[k] - stamp->centre[k]) / stamp->radius;
    for (int k = 0; k < 3; ++k)
        at[k] = dot(from, p->axis[k]);
    if (!stamp->image.values) {
        const float rest = 1 - dot(from, from);
        return rest > 0 ? rest * rest : 0;
    }
    if (!(fabsf(at[0]) < 1 && fabsf(at[1]) < 1 && fabsf(at[2]) < 1))
        return 0;
    /* Between the outermost texels' centres, so that opposite sides do not mix. */
    const double w = stamp->image.width, h = stamp->image.height;
    return (float)look_up(&stamp->image, (0.5 + (at[0] + 1) / 2 * (w - 1)) / w,
                          (0.5 + (1 - at[1]) / 2 * (h - 1)) / h);
}

gtx_result gtx_edit_stamp(gtx_edit *edit, const gtx_edit_stamp_desc *stamp, gtx_error *error)
{
    press p = {.stamp = stamp};
    if (!edit || !stamp)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a stamp needs an edit and a description");
    gtx_result result = gtx_check_reserved(stamp->reserved, 4, error);
    if (result)
        return result;
    float sum = stamp->depth;
    for (int k = 0; k < 3; ++k)
        sum += stamp->centre[k] + stamp->direction[k] + stamp->up[k];
    if (!isfinite(sum) || !(stamp->radius > 0) || isinf(stamp->radius) || !find_axes(stamp, &p))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a stamp has finite numbers, a radius above 0 and a direction across `up`");
    if (stamp->image.values || stamp->image.width || stamp->image.height)
        result = check_image(&stamp->image, error);
    if (result)
        return result;
    /* An image reaches into the corners of its cube. */
    const float reach = stamp->radius * (stamp->image.values ? 1.7320508f : 1);
    float low[3], high[3];
    for (int k = 0; k < 3; ++k) {
        low[k] = stamp->centre[k] - reach;
        high[k] = stamp->centre[k] + reach;
    }
    gtx_edit_touch(edit, low, high, 2 * edit->texel_size);
    for (uint32_t i = 0; i < edit->count; ++i) {
        const gtx_field_span *field = &edit->fields[i];
        const size_t last = field->first + (size_t)field->width * field->height;
        for (size_t t = field->first; field->touched && t < last; ++t) {
            if (edit->kind[t] != GTX_TEXEL_OWN || !(dot(edit->normal[t], p.axis[2]) < 0))
                continue;
            const float by = stamp->depth * depth_at(&p, edit->point[t]);
            for (int k = 0; k < 3; ++k)
                edit->changes[t][GTX_CHANGE_MOVE + k] = by * p.axis[2][k];
        }
    }
    return gtx_edit_done(edit, error);
}

gtx_result gtx_edit_set_heights(gtx_edit *edit, uint32_t patch, const uint32_t rectangle[4],
                                const float *heights, gtx_error *error)
{
    if (!edit || !rectangle || !heights || patch >= edit->count)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "setting heights needs an edit, one of its patches, and heights");
    const gtx_patch *record = &edit->source->patches[patch];
    const uint32_t *r = rectangle, w = record->rect[2], h = record->rect[3];
    if (!r[2] || !r[3] || r[0] >= w || r[1] >= h || r[2] > w - r[0] || r[3] > h - r[1])
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the rectangle %u, %u, %u x %u is not within patch %u, of %u x %u texels",
                        r[0], r[1], r[2], r[3], patch, w, h);
    for (size_t i = 0; i < (size_t)r[2] * r[3]; ++i)
        if (!isfinite(heights[i]) || !isfinite(heights[i] * record->extent_z))
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "height %zu is not finite", i);
    gtx_field_span *field = &edit->fields[patch];
    gtx_edit_touch(edit, field->low, field->high, 2 * edit->texel_size);
    field->touched = true;
    for (uint32_t j = 0; j < r[3]; ++j)
        for (uint32_t i = 0; i < r[2]; ++i) {
            const size_t at = field->first + i + r[0] + GTX_EDIT_MARGIN +
                              (size_t)(j + r[1] + GTX_EDIT_MARGIN) * field->width;
            if (edit->kind[at] != GTX_TEXEL_OWN)
                continue;
            const float by = heights[(size_t)j * r[2] + i] * record->extent_z -
                             (float)gtx_edit_height(edit, field, at);
            for (int k = 0; k < 3; ++k)
                edit->changes[at][GTX_CHANGE_MOVE + k] = by * record->axis_z[k];
        }
    return gtx_edit_done(edit, error);
}
