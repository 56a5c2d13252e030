/* Filters that know the surface: heights among their neighbours, and maps against the heights. */
#include "asset/codec.h"

#include "asset/fill.h"
#include "base/bytes.h"

#include <string.h>

/* ---- filter 5, heights ---- */

/* Codes of all pages, in a row each; code 0 is no neighbour. */
static uint32_t load_code(const uint8_t *image, uint32_t bytes, size_t at)
{
    return bytes == 1 ? image[at] : gtx_load_u16(image + 2 * at);
}

/* The plane through three neighbours, or the nearest of what is there. */
static uint32_t predict_height(const uint8_t *image, gtx_map_shape shape, size_t row, uint32_t x)
{
    int32_t most = shape.texel == 1 ? 255 : 65535;
    size_t at = row * shape.width + x;
    bool up = row % shape.height != 0;
    int32_t a = x ? (int32_t)load_code(image, shape.texel, at - 1) : 0;
    int32_t b = up ? (int32_t)load_code(image, shape.texel, at - shape.width) : 0;
    int32_t c = x && up ? (int32_t)load_code(image, shape.texel, at - shape.width - 1) : 0;
    if (a && b && c) {
        int32_t plane = a + b - c;
        return (uint32_t)(plane < 1 ? 1 : plane > most ? most : plane);
    }
    int32_t near = a ? a : b ? b : c;
    return near ? (uint32_t)near : (uint32_t)(most + 1) / 2;
}

void gtx_heights_apply(gtx_map_shape shape, const uint8_t *in, uint8_t *coded)
{
    uint32_t most = shape.texel == 1 ? 255 : 65535;
    size_t at = 0, texels = (size_t)gtx_shape_size(shape) / shape.texel;
    for (size_t row = 0; row < (size_t)shape.pages * shape.height; ++row) {
        for (uint32_t x = 0; x < shape.width; ++x, ++at) {
            uint32_t code = load_code(in, shape.texel, at);
            if (code)
                code = 1 + (code + most - predict_height(in, shape, row, x)) % most;
            coded[at] = (uint8_t)code;
            if (shape.texel == 2)
                coded[texels + at] = (uint8_t)(code >> 8);
        }
    }
}

void gtx_heights_undo(gtx_map_shape shape, const uint8_t *coded, uint8_t *out)
{
    uint32_t most = shape.texel == 1 ? 255 : 65535;
    size_t at = 0, texels = (size_t)gtx_shape_size(shape) / shape.texel;
    for (size_t row = 0; row < (size_t)shape.pages * shape.height; ++row) {
        for (uint32_t x = 0; x < shape.width; ++x, ++at) {
            uint32_t code = coded[at];
            if (shape.texel == 2)
                code |= (uint32_t)coded[texels + at] << 8;
            if (code) {
                code += predict_height(out, shape, row, x) - 1;
                code = code > most ? code - most : code;
            }
            if (shape.texel == 1)
                out[at] = (uint8_t)code;
            else
                gtx_store_u16(out + 2 * at, (uint16_t)code);
        }
    }
}

/* ---- filter 4, surface ---- */

/* An image that is coded, and which of its texels have a height. */
typedef struct layer {
    const gtx_asset *asset;
    gtx_section_kind kind;
    uint32_t level;
    gtx_map_shape shape;
    size_t rows, texels, occupied;
    uint8_t *ring;                /* of gtx_fill, for all pages */
} layer;

static layer layer_of(const gtx_asset *asset, const gtx_section *section, uint8_t *ring)
{
    layer s = {.asset = asset, .kind = section->kind, .level = section->level, .ring = ring};
    s.shape = gtx_section_shape(&asset->info, section->kind, section->level);
    s.rows = (size_t)s.shape.pages * s.shape.height;
    s.texels = s.rows * s.shape.width;
    uint32_t width = asset->info.page_width, wide = asset->info.height_bits == 16;
    memset(ring, 0, s.texels);
    for (size_t row = 0; row < s.rows << s.level; ++row) {
        uint8_t *to = ring + (row >> s.level) * s.shape.width;
        const uint8_t *code = asset->height + (row * width << wide);
        for (uint32_t x = 0; x < width; ++x)
            to[x >> s.level] |= (code[(size_t)x << wide] | code[((size_t)x << wide) + wide]) != 0;
    }
    for (size_t at = 0; at < s.texels; ++at)
        s.occupied += ring[at];
    return s;
}

/* Whether a texel of a finer level than this layer's has a height. */
static bool has_height(const layer *s, uint32_t level, size_t row, uint32_t x)
{
    uint32_t bytes = s->asset->info.height_bits / 8, side = 1u << level;
    size_t at = (row << level) * s->asset->info.page_width + ((size_t)x << level);
    for (uint32_t j = 0; j < side; ++j, at += s->asset->info.page_width)
        for (uint32_t i = 0; i < side; ++i)
            if (load_code(s->asset->height, bytes, at + i))
                return true;
    return false;
}

/* The mean of the occupied texels of the level before. */
static void predict_mean(const layer *s, size_t row, uint32_t x, uint8_t out[2])
{
    const uint8_t *finer = s->asset->normal[s->level - 1];
    gtx_normal_sum sum = {0, 0, 0};
    for (uint32_t k = 0; k < 4; ++k) {
        size_t y = 2 * row + k / 2;
        uint32_t i = 2 * x + k % 2;
        if (has_height(s, s->level - 1, y, i))
            gtx_normal_add(&sum, finer + 2 * (y * 2 * s->shape.width + i));
    }
    gtx_normal_mean(&sum, out);
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int most(int a, int b)
{
    return a < b ? b : a;
}

/* The median of left, above and the plane through three neighbours (LOCO-I, Weinberger et al.
 * 2000), of those that have a height. */
static void predict_near(const layer *s, const uint8_t *image, size_t row, uint32_t x, uint8_t *out)
{
    size_t width = s->shape.width, at = row * width + x, texel = s->shape.texel;
    bool up = row % s->shape.height != 0;
    bool a = x && s->ring[at - 1] == 1, b = up && s->ring[at - width] == 1;
    bool c = x && up && s->ring[at - width - 1] == 1;
    const uint8_t *here = image + at * texel;
    for (size_t k = 0; k < texel; ++k, ++here) {
        if (a && b && c) {
            int p = *(here - texel), q = *(here - width * texel);
            int plane = p + q - *(here - (width + 1) * texel);
            out[k] = (uint8_t)most(least(p, q), least(most(p, q), plane));
        } else {
            size_t back = a ? 1 : b ? width : c ? width + 1 : 0;
            out[k] = back ? *(here - back * texel) : 128;
        }
    }
}

static void predict(const layer *s, const uint8_t *image, size_t row, uint32_t x, uint8_t *out)
{
    if (s->level)
        predict_mean(s, row, x, out);
    else
        predict_near(s, image, row, x, out);
}

/* Gives the texels without a height what the rules say; the ring map holds rings afterwards. */
static void fill(const layer *s, uint8_t *image)
{
    bool normal = s->kind == GTX_SECTION_NORMAL;
    for (size_t at = 0; at < s->texels; ++at)
        if (!s->ring[at])
            memset(image + at * s->shape.texel, normal ? GTX_FAR_NORMAL : GTX_FAR_TRIM,
                   s->shape.texel);
    for (uint32_t i = 0; i < s->asset->info.patch_count; ++i) {
        const gtx_patch *patch = &s->asset->patches[i];
        size_t row = (size_t)patch->page * s->shape.height + (patch->rect[1] >> s->level);
        size_t at = row * s->shape.width + (patch->rect[0] >> s->level);
        const gtx_fill area = {image + at * s->shape.texel, s->ring + at, s->shape.width,
                               (uint32_t)patch->rect[2] >> s->level,
                               (uint32_t)patch->rect[3] >> s->level};
        if (normal)
            gtx_fill_normals(&area, gtx_fill_rings(patch, s->level));
        else
            gtx_fill_trim(&area);
    }
}

void gtx_surface_apply(const gtx_asset *asset, const gtx_section *section, const uint8_t *in,
                       uint8_t *coded, uint8_t *scratch)
{
    layer s = layer_of(asset, section, scratch + section->size);
    size_t texel = s.shape.texel, cursor = 0, at = 0;
    for (size_t row = 0; row < s.rows; ++row) {
        for (uint32_t x = 0; x < s.shape.width; ++x, ++at) {
            if (!s.ring[at])
                continue;
            uint8_t guess[2];
            predict(&s, in, row, x, guess);
            for (size_t k = 0; k < texel; ++k)
                coded[k * s.texels + cursor] = (uint8_t)(in[at * texel + k] - guess[k]);
            ++cursor;
        }
    }
    memcpy(scratch, in, (size_t)section->size);
    fill(&s, scratch);
    for (at = 0; at < s.texels; ++at) {
        if (s.ring[at] == 1)
            continue;
        for (size_t k = 0; k < texel; ++k)
            coded[k * s.texels + cursor] = (uint8_t)(in[at * texel + k] - scratch[at * texel + k]);
        ++cursor;
    }
}

void gtx_surface_undo(const gtx_asset *asset, const gtx_section *section, const uint8_t *coded,
                      uint8_t *out, uint8_t *scratch)
{
    layer s = layer_of(asset, section, scratch);
    size_t texel = s.shape.texel, cursor = 0, at = 0;
    for (size_t row = 0; row < s.rows; ++row) {
        for (uint32_t x = 0; x < s.shape.width; ++x, ++at) {
            if (!s.ring[at])
                continue;
            uint8_t guess[2];
            predict(&s, out, row, x, guess);
            for (size_t k = 0; k < texel; ++k)
                out[at * texel + k] = (uint8_t)(coded[k * s.texels + cursor] + guess[k]);
            ++cursor;
        }
    }
    fill(&s, out);
    for (at = 0; at < s.texels; ++at) {
        if (s.ring[at] == 1)
            continue;
        for (size_t k = 0; k < texel; ++k)
            out[at * texel + k] = (uint8_t)(out[at * texel + k] + coded[k * s.texels + cursor]);
        ++cursor;
    }
}
