/* Makes an asset of the remaining pieces of patches: records, and maps copied into them. */
#include "edit/combine/combine.h"

#include "asset/section.h"
#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

/* What writing one piece works with. */
typedef struct writer {
    const gtx_operand *operand;
    const gtx_piece *piece;
    const gtx_patch *from, *to;
    gtx_asset *out;
    uint8_t emission[256];    /* codes of the source's emission in the result's scale */
} writer;

/* The texel of the source's rectangle at a level that becomes (x, y): mirrored where the patch is
 * turned round, so that its axes stay right-handed. */
static uint32_t source_x(const writer *w, uint32_t level, uint32_t x)
{
    const uint32_t at = w->operand->keep.turned ? ((uint32_t)w->to->rect[2] >> level) - 1 - x : x;
    return (w->piece->low[0] >> level) + at;
}

static uint32_t source_y(const writer *w, uint32_t level, uint32_t y)
{
    return (w->piece->low[1] >> level) + y;
}

static bool kept_at(const writer *w, uint32_t x, uint32_t y)
{
    return w->piece->kept ? w->piece->kept[(size_t)y * w->from->rect[2] + x]
                          : gtx_height_code(w->operand->asset, w->from, x, y) != 0;
}

/* Turned round, the lowest code is the highest. */
static uint32_t convert_code(const writer *w, uint32_t code)
{
    const uint32_t from = w->operand->asset->info.height_bits, to = w->out->info.height_bits;
    if (w->operand->keep.turned)
        code = (uint32_t)gtx_height_steps(from) + 2 - code;
    if (from == to)
        return code;
    return gtx_nearest_code(gtx_code_height(code, from) * gtx_height_steps(to), to);
}

/* Heights; and what is by rule where there is none. */
static void write_surface(const writer *w, const gtx_patch_texels *texels)
{
    const gtx_asset *source = w->operand->asset;
    for (uint32_t y = 0; y < w->to->rect[3]; ++y)
        for (uint32_t x = 0; x < w->to->rect[2]; ++x) {
            const uint32_t i = source_x(w, 0, x), j = source_y(w, 0, y);
            const size_t t = (size_t)y * w->to->rect[2] + x;
            uint8_t *height = gtx_edit_texel(w->out, w->to, GTX_SECTION_HEIGHT, 0, x, y);
            texels->occupied[t] = kept_at(w, i, j);
            if (!texels->occupied[t])
                continue;
            const uint32_t code = convert_code(w, gtx_height_code(source, w->from, i, j));
            height[GTX_BIG_ENDIAN && w->out->info.height_bits == 16] = (uint8_t)code;
            if (w->out->info.height_bits == 16)
                height[!GTX_BIG_ENDIAN] = (uint8_t)(code >> 8);
            texels->trims[t] = w->piece->trim ? w->piece->trim[(size_t)j * w->from->rect[2] + i]
                                              : (uint8_t)gtx_trim_code(source, w->from, i, j);
            const uint8_t *normal = gtx_edit_texel(source, w->from, GTX_SECTION_NORMAL, 0, i, j);
            /* Of (x, y, z) in the normal frame, (x, -y, z) is left: the two bytes, x + y and x - y,
             * change places. */
            const bool turned = w->operand->keep.turned;
            texels->normals[2 * t] = normal[turned];
            texels->normals[2 * t + 1] = normal[!turned];
        }
    gtx_edit_write_trim(texels, w->to, w->out);
    gtx_edit_write_normals(texels, w->to, w->out);
}

/* Colour, material or emission; the constant where the source has none (format/gtx.md, 4.4 to
 * 4.6). */
static void write_looks(const writer *w, gtx_section_kind kind)
{
    static const uint8_t none[3][4] = {{255, 255, 255, 255}, {255, 255, 0, 255}, {0, 0, 0, 0}};
    const gtx_asset *source = w->operand->asset;
    const bool known = gtx_map_levels(&source->info, kind) > 0;
    for (uint32_t k = 0; k < gtx_map_levels(&w->out->info, kind); ++k) {
        const uint32_t channels = gtx_section_shape(&w->out->info, kind, k).texel;
        for (uint32_t y = 0; y < (uint32_t)w->to->rect[3] >> k; ++y)
            for (uint32_t x = 0; x < (uint32_t)w->to->rect[2] >> k; ++x) {
                const uint8_t *from = none[kind - GTX_SECTION_COLOR];
                uint8_t *to = gtx_edit_texel(w->out, w->to, (int)kind, k, x, y);
                if (known)
                    from = gtx_edit_texel(source, w->from, (int)kind, k, source_x(w, k, x),
                                          source_y(w, k, y));
                for (uint32_t c = 0; c < channels; ++c)
                    to[c] = kind == GTX_SECTION_EMISSION ? w->emission[from[c]] : from[c];
            }
    }
}

/* sRGB codes of light that is `share` of what it was. */
static void scale_emission(double share, uint8_t out[256])
{
    for (int code = 0; code < 256; ++code) {
        double c = code / 255.0;
        c = share * (c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
        c = c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
        out[code] = share == 1 ? (uint8_t)code : (uint8_t)(255 * fmin(c, 1) + 0.5);
    }
}

/* The record of a piece, but for its place, coverage and sphere. */
static gtx_patch record_of(const gtx_operand *operand, const gtx_patch *from,
                           const gtx_piece *piece, const double shift[3])
{
    gtx_patch to = *from;
    const float *axis[2] = {from->axis_x, from->axis_y};
    const double extent[2] = {(double)from->extent_x, (double)from->extent_y};
    double origin[3], sides[2];
    for (int a = 0; a < 2; ++a) {
        sides[a] = extent[a] * piece->size[a] / from->rect[2 + a];
        to.rect[2 + a] = (uint16_t)piece->size[a];
    }
    for (int k = 0; k < 3; ++k) {
        origin[k] = (double)from->origin[k] + shift[k];
        for (int a = 0; a < 2; ++a)
            origin[k] += extent[a] * piece->low[a] / from->rect[2 + a] * (double)axis[a][k];
        if (operand->keep.turned) {
            origin[k] += sides[0] * (double)from->axis_x[k] +
                         (double)from->extent_z * (double)from->axis_z[k];
            to.axis_x[k] = -from->axis_x[k];
            to.axis_z[k] = -from->axis_z[k];
        }
        to.origin[k] = (float)origin[k];
    }
    to.extent_x = (float)sides[0];
    to.extent_y = (float)sides[1];
    return to;
}

static gtx_result write_piece(writer *w, const gtx_allocator *hooks, gtx_error *error)
{
    const size_t count = (size_t)w->to->rect[2] * w->to->rect[3];
    uint8_t *bytes = gtx_alloc_array(hooks, count, 7);
    if (!bytes)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a patch of %zu texels", count);
    const gtx_patch_texels texels = {bytes, bytes + count, bytes + 3 * count, bytes + 4 * count,
                                     bytes + 5 * count};
    write_surface(w, &texels);
    for (int kind = GTX_SECTION_COLOR; kind <= GTX_SECTION_EMISSION; ++kind)
        write_looks(w, (gtx_section_kind)kind);
    gtx_free_array(hooks, bytes, count, 7);
    return GTX_OK;
}

/* Every piece with something left, in turn: of A, then of B. */
static gtx_result write_pieces(const gtx_operand operands[2], gtx_piece *const pieces[2],
                               gtx_asset *out, gtx_error *error)
{
    gtx_result result = GTX_OK;
    uint32_t n = 0;
    gtx_edit_fill_far(out);
    for (int side = 0; side < 2; ++side) {
        const gtx_asset *source = operands[side].asset;
        writer w = {.operand = &operands[side], .out = out};
        if (source->info.has_emission)
            scale_emission((double)source->info.emission_scale / (double)out->info.emission_scale,
                           w.emission);
        for (uint32_t p = 0; !result && p < source->info.patch_count; ++p) {
            if (!pieces[side][p].size[0])
                continue;
            w.piece = &pieces[side][p];
            w.from = &source->patches[p];
            w.to = &out->patches[n];
            result = write_piece(&w, &out->allocator, error);
            const gtx_code_map codes = gtx_codes_of(out, w.to);
            gtx_measure_patch(&out->patches[n++], &codes);
        }
    }
    gtx_edit_write_bounds(out);
    return result;
}

gtx_result gtx_join_pieces(const gtx_operand operands[2], gtx_piece *const pieces[2],
                           const gtx_info *info, const char *meta, size_t meta_size,
                           const gtx_allocator *hooks, gtx_asset **out, gtx_error *error)
{
    static const double none[3] = {0, 0, 0};
    gtx_info placed = *info;
    gtx_patch *patches = gtx_alloc_array(hooks, info->patch_count, sizeof *patches);
    gtx_asset *asset = NULL;
    gtx_result result = GTX_OK;
    uint32_t n = 0;
    for (int side = 0; side < 2 && patches; ++side)
        for (uint32_t p = 0; p < operands[side].asset->info.patch_count; ++p)
            if (pieces[side][p].size[0]) /* B's shift is from its coordinates to A's */
                patches[n++] = record_of(&operands[side], &operands[side].asset->patches[p],
                                         &pieces[side][p], side ? operands[side].shift : none);
    if (!patches)
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory for %u patches", info->patch_count);
    if (!result)
        result = gtx_edit_place(patches, hooks, &placed, error);
    if (!result) {
        const gtx_sizes sizes = {.meta = meta_size};
        asset = gtx_asset_new(hooks, &placed, &sizes, true);
        if (!asset)
            result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the combined maps");
    }
    if (!result) {
        memcpy(asset->patches, patches, n * sizeof *patches);
        memcpy(asset->meta, meta, meta_size);
        result = write_pieces(operands, pieces, asset, error);
    }
    if (!result)
        result = gtx_edit_copy_checked(asset, out, error);
    gtx_close(asset);
    gtx_free_array(hooks, patches, info->patch_count, sizeof *patches);
    return result;
}
