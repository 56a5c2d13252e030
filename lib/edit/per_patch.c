/* The paper's blur (section 6.3), for comparison: heights and normals patch by patch, from coded
 * texels only. Patches know nothing of their neighbours, and so flatten and come apart. */
#include "edit/edit.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

enum { HEIGHT, DETAIL, WEIGHT = DETAIL + 3, CHANNELS };
typedef float sample[CHANNELS];

/* One axis of a height field: lines of `count` texels, `step` apart. */
static void blur_line(const sample *in, sample *out, uint32_t count, size_t step, double sigma)
{
    const int reach = (int)fmin(ceil(3 * sigma), count);
    for (int i = 0; i < (int)count; ++i) {
        double sum[CHANNELS] = {0};
        const int low = i > reach ? i - reach : 0;
        const int high = i + reach < (int)count ? i + reach : (int)count - 1;
        for (int k = low; k <= high; ++k) {
            const double weight = exp(-0.5 * (k - i) * (k - i) / (sigma * sigma));
            for (int c = 0; c < CHANNELS; ++c)
                sum[c] += weight * in[(size_t)k * step][c];
        }
        for (int c = 0; c < CHANNELS; ++c)
            out[(size_t)i * step][c] = (float)sum[c];
    }
}

static bool is_coded(const gtx_edit *edit, const gtx_field_span *field, const gtx_patch *patch,
                     uint32_t texel)
{
    const uint32_t x = texel % field->width - GTX_EDIT_MARGIN; /* wraps before the first */
    const uint32_t y = texel / field->width - GTX_EDIT_MARGIN;
    return x < patch->rect[2] && y < patch->rect[3] && gtx_height_code(edit->source, patch, x, y);
}

static void blur_patch(const gtx_edit *edit, uint32_t index, double radius, sample *a, sample *b)
{
    const gtx_field_span *field = &edit->fields[index];
    const gtx_patch *patch = &edit->source->patches[index];
    const uint32_t w = field->width, h = field->height;
    memset(a, 0, (size_t)w * h * sizeof *a);
    for (uint32_t t = 0; t < w * h; ++t) {
        const size_t at = field->first + t;
        if (!is_coded(edit, field, patch, t))
            continue;
        a[t][HEIGHT] = (float)gtx_edit_height(edit, field, at);
        for (int k = 0; k < 3; ++k)
            a[t][DETAIL + k] = edit->detail[at][k];
        a[t][WEIGHT] = 1;
    }
    for (uint32_t j = 0; j < h; ++j)
        blur_line((const sample *)a + (size_t)j * w, b + (size_t)j * w, w, 1,
                  radius * patch->rect[2] / patch->extent_x);
    for (uint32_t i = 0; i < w; ++i)
        blur_line((const sample *)b + i, a + i, h, w, radius * patch->rect[3] / patch->extent_y);
    for (uint32_t t = 0; t < w * h; ++t) {
        const size_t at = field->first + t;
        const float weight = a[t][WEIGHT];
        if (!edit->kind[at] || !(weight > 1e-6f))
            continue;
        const float before = is_coded(edit, field, patch, t)
                                 ? (float)gtx_edit_height(edit, field, at) : edit->height[at];
        float *change = edit->changes[at];
        for (int k = 0; k < 3; ++k) {
            change[GTX_CHANGE_MOVE + k] = (a[t][HEIGHT] / weight - before) * patch->axis_z[k];
            change[GTX_CHANGE_DETAIL + k] = a[t][DETAIL + k] / weight - edit->detail[at][k];
        }
    }
}

gtx_result gtx_edit_blur_per_patch(gtx_edit *edit, double radius, gtx_error *error)
{
    size_t most = 0;
    for (uint32_t p = 0; p < edit->count; ++p) {
        const size_t count = (size_t)edit->fields[p].width * edit->fields[p].height;
        most = count > most ? count : most;
    }
    sample *a = gtx_alloc_array(&edit->allocator, most, sizeof *a);
    sample *b = gtx_alloc_array(&edit->allocator, most, sizeof *b);
    for (uint32_t p = 0; a && b && p < edit->count; ++p)
        blur_patch(edit, p, radius, a, b);
    const bool failed = !a || !b;
    gtx_free_array(&edit->allocator, a, most, sizeof *a);
    gtx_free_array(&edit->allocator, b, most, sizeof *b);
    return failed ? gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a blur") : GTX_OK;
}
