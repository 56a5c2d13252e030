/* A patch's maps, written from its warped texels: heights and their frame, trim, normals at all
 * levels, and the other maps from where their texels were. */
#include "edit/edit.h"

#include "asset/fill.h"
#include "asset/section.h"
#include "base/alloc.h"
#include "base/error.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Least height of a patch to its sides (format/gtx.md, rule 301). */
static const float FLATTEST = 1.0f / 4096;

/* What writing one patch works with. */
typedef struct writer {
    const gtx_edit *edit;
    const gtx_patch *from;
    gtx_patch *to;
    gtx_asset *out;
    uint32_t width, height;
    gtx_texel *texels;
    float (*shift)[2];        /* from a texel to where it was */
    gtx_patch_texels bytes;
} writer;

uint8_t *gtx_edit_texel(const gtx_asset *asset, const gtx_patch *patch, int kind, uint32_t level,
                        uint32_t x, uint32_t y)
{
    const gtx_map_shape shape = gtx_section_shape(&asset->info, (gtx_section_kind)kind, level);
    const size_t row = (size_t)patch->page * shape.height + (patch->rect[1] >> level) + y;
    /* The asset is not changed here; where it may be, it was not const. */
    uint8_t *image =
        *gtx_asset_map((gtx_asset *)(uintptr_t)asset, (gtx_section_kind)kind, level);
    return image + (row * shape.width + (patch->rect[0] >> level) + x) * shape.texel;
}

void gtx_edit_copy_patch(const gtx_edit *edit, uint32_t patch, gtx_asset *out)
{
    const gtx_patch *from = &edit->source->patches[patch], *to = &out->patches[patch];
    for (int kind = GTX_SECTION_FIRST_IMAGE; kind <= GTX_SECTION_LAST_IMAGE; ++kind)
        for (uint32_t k = 0; k < gtx_map_levels(&out->info, (gtx_section_kind)kind); ++k) {
            const gtx_map_shape shape = gtx_section_shape(&out->info, (gtx_section_kind)kind, k);
            for (uint32_t y = 0; y < (uint32_t)(to->rect[3] >> k); ++y)
                memcpy(gtx_edit_texel(out, to, kind, k, 0, y),
                       gtx_edit_texel(edit->source, from, kind, k, 0, y),
                       (size_t)(to->rect[2] >> k) * shape.texel);
        }
}

/* Frame and size of the record: the window's corner, and heights from the lowest to the highest.
 * The old range is kept while it fits, for the codes of what did not move. */
static void fit_frame(writer *w, const gtx_window *window)
{
    float low = INFINITY, high = -INFINITY;
    for (size_t t = 0; t < (size_t)w->width * w->height; ++t)
        if (w->texels[t].coded) {
            low = fminf(low, w->texels[t].height);
            high = fmaxf(high, w->texels[t].height);
        }
    /* A patch may be so small that a texel's share would be rounded to nothing. */
    const float step_x = fmaxf(w->from->extent_x / w->from->rect[2], FLT_TRUE_MIN);
    const float step_y = fmaxf(w->from->extent_y / w->from->rect[3], FLT_TRUE_MIN);
    w->to->extent_x = step_x * (float)w->width;
    w->to->extent_y = step_y * (float)w->height;
    const float least = FLATTEST * fmaxf(w->to->extent_x, w->to->extent_y);
    float base = 0, range = fmaxf(w->from->extent_z, least);
    if (low <= high && (low < 0 || high > range || high - low < 0.75f * range)) {
        base = low;
        range = fmaxf(high - low, least);
    }
    w->to->extent_z = range;
    for (int k = 0; k < 3; ++k)
        w->to->origin[k] = (float)(w->from->origin[k] +
                                   (double)window->low[0] * step_x * w->from->axis_x[k] +
                                   (double)window->low[1] * step_y * w->from->axis_y[k] +
                                   (double)base * w->from->axis_z[k]);
    for (size_t t = 0; t < (size_t)w->width * w->height; ++t)
        w->texels[t].height = (w->texels[t].height - base) / range;
}

/* Codes, and what of the record follows from them. */
static void write_heights(writer *w)
{
    const uint32_t bits = w->out->info.height_bits;
    for (uint32_t t = 0; t < w->width * w->height; ++t) {
        const double steps = w->texels[t].height * gtx_height_steps(bits);
        const uint32_t code = w->texels[t].coded ? gtx_nearest_code(steps, bits) : 0;
        uint8_t *to =
            gtx_edit_texel(w->out, w->to, GTX_SECTION_HEIGHT, 0, t % w->width, t / w->width);
        to[GTX_BIG_ENDIAN && bits == 16] = (uint8_t)code;
        if (bits == 16)
            to[!GTX_BIG_ENDIAN] = (uint8_t)(code >> 8);
    }
    const gtx_code_map codes = gtx_codes_of(w->out, w->to);
    gtx_measure_patch(w->to, &codes);
}

void gtx_edit_write_trim(const gtx_patch_texels *texels, const gtx_patch *to, gtx_asset *out)
{
    const uint32_t width = to->rect[2], height = to->rect[3];
    for (size_t t = 0; t < (size_t)width * height; ++t) {
        texels->codes[t] = texels->occupied[t] ? texels->trims[t] : GTX_FAR_TRIM;
        texels->ring[t] = texels->occupied[t];
    }
    const gtx_fill area = {texels->codes, texels->ring, width, width, height};
    gtx_fill_trim(&area);
    for (uint32_t y = 0; y < height; ++y)
        memcpy(gtx_edit_texel(out, to, GTX_SECTION_TRIM, 0, 0, y),
               texels->codes + (size_t)y * width, width);
}

/* The next level of `normals` and `occupied`, in place: what is read is never before what is
 * written. */
static void halve_normals(const gtx_patch_texels *texels, uint32_t width, uint32_t height)
{
    for (uint32_t j = 0; j < height / 2; ++j)
        for (uint32_t i = 0; i < width / 2; ++i) {
            const size_t to = (size_t)j * (width / 2) + i;
            gtx_normal_sum sum = {0, 0, 0};
            uint8_t any = 0;
            for (uint32_t k = 0; k < 4; ++k) {
                const size_t from = (size_t)(2 * j + k / 2) * width + 2 * i + k % 2;
                if (texels->occupied[from])
                    gtx_normal_add(&sum, texels->normals + 2 * from);
                any |= texels->occupied[from];
            }
            gtx_normal_mean(&sum, texels->normals + 2 * to);
            texels->occupied[to] = any;
        }
}

void gtx_edit_write_normals(const gtx_patch_texels *texels, const gtx_patch *to, gtx_asset *out)
{
    for (uint32_t k = 0; k < out->info.mip_count; ++k) {
        const uint32_t width = (uint32_t)to->rect[2] >> k, height = (uint32_t)to->rect[3] >> k;
        const size_t count = (size_t)width * height;
        memset(texels->codes, GTX_FAR_NORMAL, 2 * count);
        memcpy(texels->ring, texels->occupied, count);
        for (size_t t = 0; t < count; ++t)
            if (texels->occupied[t])
                memcpy(texels->codes + 2 * t, texels->normals + 2 * t, 2);
        const gtx_fill area = {texels->codes, texels->ring, width, width, height};
        gtx_fill_normals(&area, gtx_fill_rings(to, k));
        for (uint32_t y = 0; y < height; ++y)
            memcpy(gtx_edit_texel(out, to, GTX_SECTION_NORMAL, k, 0, y),
                   texels->codes + 2 * (size_t)y * width, 2 * (size_t)width);
        halve_normals(texels, width, height);
    }
}

/* Trims and normals of the warped texels, as bytes. */
static void write_bytes(writer *w)
{
    float rows[3][3];
    gtx_normal_frame(w->to, rows);
    for (size_t t = 0; t < (size_t)w->width * w->height; ++t) {
        const float *n = w->texels[t].normal;
        float m[3];
        for (int k = 0; k < 3; ++k)
            m[k] = rows[k][0] * n[0] + rows[k][1] * n[1] + rows[k][2] * n[2];
        gtx_encode_normal(m, w->bytes.normals + 2 * t);
        w->bytes.occupied[t] = w->texels[t].coded;
        w->bytes.trims[t] = gtx_nearest_trim(w->texels[t].trim);
    }
    gtx_edit_write_trim(&w->bytes, w->to, w->out);
    gtx_edit_write_normals(&w->bytes, w->to, w->out);
}

/* Takes the shift of a texel beside, if that is known and the own one is not. */
static void spread_shift(writer *w, uint8_t *known, size_t t, size_t other)
{
    if (known[t] || !known[other])
        return;
    memcpy(w->shift[t], w->shift[other], sizeof w->shift[t]);
    known[t] = 1;
}

/* Where texels were, also of those without a code: as the nearest to the left, right, above or
 * below. */
static void find_shifts(writer *w, const gtx_window *window)
{
    uint8_t *known = w->bytes.ring;
    const uint32_t width = w->width, height = w->height;
    for (size_t t = 0; t < (size_t)width * height; ++t) {
        known[t] = w->texels[t].coded;
        w->shift[t][0] = (float)window->low[0];
        w->shift[t][1] = (float)window->low[1];
        if (!known[t])
            continue;
        w->shift[t][0] = w->texels[t].from[0] - (float)(t % width);
        w->shift[t][1] = w->texels[t].from[1] - (float)(t / width);
    }
    for (uint32_t j = 0; j < height; ++j) {
        const size_t row = (size_t)j * width;
        for (uint32_t i = 1; i < width; ++i)
            spread_shift(w, known, row + i, row + i - 1);
        for (uint32_t i = width - 1; i-- > 0;)
            spread_shift(w, known, row + i, row + i + 1);
    }
    for (size_t t = width; t < (size_t)width * height; ++t)
        spread_shift(w, known, t, t - width);
    for (size_t t = (size_t)width * (height - 1); t-- > 0;)
        spread_shift(w, known, t, t + width);
}

/* Bilinear, within the source's rectangle at the level. */
static void look_up(const writer *w, gtx_section_kind kind, uint32_t level, const double at[2],
                    uint8_t *out)
{
    const uint32_t channels = gtx_section_shape(&w->out->info, kind, level).texel;
    const uint32_t right = (w->from->rect[2] >> level) - 1u, top = (w->from->rect[3] >> level) - 1u;
    const double x = fmin(fmax(at[0], 0), right), y = fmin(fmax(at[1], 0), top);
    const uint32_t i = (uint32_t)x, j = (uint32_t)y;
    const double u = x - i, v = y - j;
    const uint32_t next_i = i < right ? i + 1 : i, next_j = j < top ? j + 1 : j;
    const gtx_asset *source = w->edit->source;
    const uint8_t *corner[4] = {gtx_edit_texel(source, w->from, kind, level, i, j),
                                gtx_edit_texel(source, w->from, kind, level, next_i, j),
                                gtx_edit_texel(source, w->from, kind, level, i, next_j),
                                gtx_edit_texel(source, w->from, kind, level, next_i, next_j)};
    for (uint32_t c = 0; c < channels; ++c)
        out[c] = (uint8_t)((1 - v) * ((1 - u) * corner[0][c] + u * corner[1][c]) +
                           v * ((1 - u) * corner[2][c] + u * corner[3][c]) + 0.5);
}

/* Maps of looks move with the surface, each level by itself. */
static void write_looks(writer *w, gtx_section_kind kind)
{
    for (uint32_t k = 0; k < gtx_map_levels(&w->out->info, kind); ++k) {
        const uint32_t size = 1u << k;
        for (uint32_t y = 0; y < w->height >> k; ++y)
            for (uint32_t x = 0; x < w->width >> k; ++x) {
                double shift[2] = {0, 0};
                for (uint32_t t = 0; t < size * size; ++t) {
                    const uint32_t at = (y * size + t / size) * w->width + x * size + t % size;
                    shift[0] += w->shift[at][0] / (double)(size * size);
                    shift[1] += w->shift[at][1] / (double)(size * size);
                }
                const double from[2] = {x + shift[0] / size, y + shift[1] / size};
                look_up(w, kind, k, from, gtx_edit_texel(w->out, w->to, kind, k, x, y));
            }
    }
}

gtx_result gtx_edit_write_patch(const gtx_edit *edit, uint32_t patch, const gtx_window *window,
                                gtx_asset *out, gtx_error *error)
{
    const gtx_allocator *hooks = &edit->allocator;
    writer w = {.edit = edit, .from = &edit->source->patches[patch], .to = &out->patches[patch],
                .out = out, .width = window->size[0], .height = window->size[1]};
    const size_t count = (size_t)w.width * w.height;
    w.texels = gtx_alloc_array(hooks, count, sizeof *w.texels);
    w.shift = gtx_alloc_array(hooks, count, sizeof *w.shift);
    uint8_t *bytes = gtx_alloc_array(hooks, count, 7);
    const bool failed = !w.texels || !w.shift || !bytes;
    if (!failed) {
        w.bytes = (gtx_patch_texels){bytes, bytes + count, bytes + 3 * count, bytes + 4 * count,
                                     bytes + 5 * count};
        gtx_edit_warp(edit, &edit->fields[patch], window, w.texels);
        find_shifts(&w, window);
        fit_frame(&w, window);
        write_heights(&w);
        write_bytes(&w);
        for (int kind = GTX_SECTION_COLOR; kind <= GTX_SECTION_EMISSION; ++kind)
            write_looks(&w, (gtx_section_kind)kind);
    }
    gtx_free_array(hooks, w.texels, count, sizeof *w.texels);
    gtx_free_array(hooks, w.shift, count, sizeof *w.shift);
    gtx_free_array(hooks, bytes, count, 7);
    return failed ? gtx_fail(error, GTX_ERROR_MEMORY, "no memory for patch %u", patch) : GTX_OK;
}
