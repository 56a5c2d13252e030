/* The filter of trim and normals, which knows where heights are (format/gtx.md, 1.2: filter 4). */
#include "asset/codec.h"

#include "asset/fill.h"
#include "asset/lanes.h"

#include <string.h>

/* Marks the texels of level 0 that have a height. */
static void mark_heights(const gtx_asset *asset, uint8_t *restrict out)
{
    const size_t texels = gtx_page_texels(asset, 0) * asset->info.page_count;
    const uint8_t *restrict height = asset->height;
    if (asset->info.height_bits == 8) {
        for (size_t at = 0; at < texels; ++at)
            out[at] = height[at] != 0;
    } else {
        for (size_t at = 0; at < texels; ++at)
            out[at] = (height[2 * at] | height[2 * at + 1]) != 0;
    }
}

/* From marks of a level to those of the next: `rows` of `width` in all. They may be the same. */
static void halve(const uint8_t *finer, size_t rows, size_t width, uint8_t *out)
{
    for (size_t row = 0; row < rows; ++row) {
        const uint8_t *upper = finer + 4 * row * width, *lower = upper + 2 * width;
        for (size_t x = 0; x < width; ++x)
            out[row * width + x] =
                upper[2 * x] | upper[2 * x + 1] | lower[2 * x] | lower[2 * x + 1];
    }
}

void gtx_mark_level(const gtx_asset *asset, uint32_t level, const uint8_t *finer, uint8_t *out)
{
    const size_t rows = (size_t)asset->info.page_count * (asset->info.page_height >> level);
    if (level)
        halve(finer, rows, asset->info.page_width >> level, out);
    else
        mark_heights(asset, out);
}

gtx_layer gtx_layer_of(const gtx_asset *asset, const gtx_section *section, uint8_t *ring,
                       const uint8_t *finer)
{
    gtx_layer s = {.asset = asset, .kind = section->kind, .level = section->level, .ring = ring,
                   .finer = finer};
    s.shape = gtx_section_shape(&asset->info, section->kind, section->level);
    s.rows = (size_t)s.shape.pages * s.shape.height;
    s.texels = s.rows * s.shape.width;
    return s;
}

/* The mean of the occupied texels of the level before. */
static void expected_mean(const gtx_layer *s, size_t row, size_t x, uint8_t out[2])
{
    const uint8_t *codes = s->asset->normal[s->level - 1];
    const size_t width = 2 * (size_t)s->shape.width, first = 2 * row * width + 2 * x;
    const size_t at[4] = {first, first + 1, first + width, first + width + 1};
    gtx_normal_sum sum = {0, 0, 0};
    for (int k = 0; k < 4; ++k)
        gtx_normal_add_if(&sum, codes + 2 * at[k], s->finer[at[k]]);
    gtx_normal_mean(&sum, out);
}

static inline int least(int a, int b)
{
    return a < b ? a : b;
}

static inline int most(int a, int b)
{
    return a < b ? b : a;
}

/* Of three neighbours the median of left, above and the plane through all of them (LOCO-I,
 * Weinberger et al. 2000). */
static inline uint8_t expected_near(int a, int b, int c)
{
    return (uint8_t)most(least(a, b), least(most(a, b), a + b - c));
}

/* What a texel without a height holds before it is filled. */
static inline void store_far(uint8_t *here, size_t texel)
{
    here[0] = texel == 1 ? GTX_FAR_TRIM : GTX_FAR_NORMAL;
    if (texel == 2)
        here[1] = GTX_FAR_NORMAL;
}

/* A row of occupied texels at level 0, in either direction: one of `plain` and `coded` grows, and
 * where it is `plain`, it has the far values elsewhere. `coded` is where their first one's byte is
 * in the first plane. Returns how many there are. */
static inline size_t code_near(const gtx_layer *s, size_t row, size_t texel,
                               uint8_t *restrict plain, uint8_t *restrict coded, bool apply)
{
    const size_t width = s->shape.width, plane = s->texels, line = width * texel;
    const bool up = row % s->shape.height != 0;
    const uint8_t *restrict ring = s->ring + row * width;
    const uint8_t *restrict over = up ? ring - width : ring;
    uint8_t *here = plain + row * line;
    int value[2] = {0, 0};        /* of the texel on the left */
    unsigned left = 0, corner = 0;
    size_t count = 0;
    for (size_t x = 0; x < width; ++x, here += texel) {
        const unsigned above = up ? over[x] : 0, there = left | above << 1 | corner << 2;
        left = ring[x];
        corner = above;
        if (!left) {
            if (!apply)
                store_far(here, texel);
            continue;
        }
        /* Where one is missing, the first that is there. */
        const size_t back = there & 1 ? texel : there & 2 ? line : line + texel;
        for (size_t k = 0; k < texel; ++k) {
            int guess = 128;
            if (there == 7)
                guess = expected_near(value[k], *(here + k - line), *(here + k - line - texel));
            else if (there)
                guess = *(here + k - back);
            value[k] = apply ? here[k] : (uint8_t)(coded[k * plane + count] + guess);
            if (apply)
                coded[k * plane + count] = (uint8_t)(value[k] - guess);
            else
                here[k] = (uint8_t)value[k];
        }
        ++count;
    }
    return count;
}

/* What is expected of up to GTX_LANES texels of a row, of which at least one is occupied. */
static void expected_means(const gtx_layer *s, size_t row, size_t x, size_t count, uint8_t *out)
{
    const uint8_t *codes = s->asset->normal[s->level - 1];
    const size_t width = 2 * (size_t)s->shape.width;
    uint16_t code[2][GTX_LANES];
    uint8_t mark[2][GTX_LANES];
    gtx_lane_sums sums = {{0}, {0}, {0}};
    if (count < GTX_LANES) {
        for (size_t i = 0; i < count; ++i)
            expected_mean(s, row, x + i, out + 2 * i);
        return;
    }
    for (size_t y = 0; y < 2; ++y) {
        const size_t first = (2 * row + y) * width + 2 * x;
        uint32_t pair[GTX_LANES];
        memcpy(pair, codes + 2 * first, sizeof pair);
        for (size_t l = 0; l < GTX_LANES; ++l) {
            const uint32_t both = gtx_first_low_u32(pair[l]);
            code[0][l] = (uint16_t)both;
            code[1][l] = (uint16_t)(both >> 16);
            mark[0][l] = s->finer[first + 2 * l];
            mark[1][l] = s->finer[first + 2 * l + 1];
        }
        gtx_lanes_add(&sums, code[0], mark[0], 1);
        gtx_lanes_add(&sums, code[1], mark[1], 1);
    }
    gtx_lanes_mean(&sums, s->ring + row * s->shape.width + x, 1, code[0]);
    gtx_lanes_order(code[0]);
    memcpy(out, code[0], sizeof code[0]);
}

/* The same of another level, whose texels are of two bytes. */
static inline size_t code_means(const gtx_layer *s, size_t row, uint8_t *plain, uint8_t *coded,
                                bool apply)
{
    const size_t width = s->shape.width;
    const uint8_t *ring = s->ring + row * width;
    uint8_t *here = plain + 2 * row * width, guess[2 * GTX_LANES];
    size_t count = 0;
    for (size_t x = 0; x < width; ++x) {
        const size_t lane = x % GTX_LANES, left = width - x;
        const size_t lanes = left < GTX_LANES ? left : GTX_LANES;
        if (lane == 0 && memchr(ring + x, 1, lanes))
            expected_means(s, row, x, lanes, guess);
        if (!ring[x]) {
            if (!apply)
                store_far(here + 2 * x, 2);
            continue;
        }
        for (size_t k = 0; k < 2; ++k)
            if (apply)
                coded[k * s->texels + count] = (uint8_t)(here[2 * x + k] - guess[2 * lane + k]);
            else
                here[2 * x + k] = (uint8_t)(coded[k * s->texels + count] + guess[2 * lane + k]);
        ++count;
    }
    return count;
}

/* All occupied texels. Returns how many there are. */
static inline size_t code_occupied(const gtx_layer *s, uint8_t *plain, uint8_t *coded, bool apply)
{
    size_t count = 0;
    for (size_t row = 0; row < s->rows; ++row)
        if (s->level)
            count += code_means(s, row, plain, coded + count, apply);
        else if (s->shape.texel == 1)
            count += code_near(s, row, 1, plain, coded + count, apply);
        else
            count += code_near(s, row, 2, plain, coded + count, apply);
    return count;
}

/* Gives the texels without a height the far values. */
static void clear_empty(const uint8_t *restrict ring, size_t texels, bool normal,
                        uint8_t *restrict image)
{
    for (size_t at = 0; !normal && at < texels; ++at)
        image[at] = ring[at] ? image[at] : GTX_FAR_TRIM;
    for (size_t at = 0; normal && at < texels; ++at) {
        uint16_t code;
        memcpy(&code, image + 2 * at, 2);
        code = ring[at] ? code : GTX_FAR_NORMAL * 0x101;
        memcpy(image + 2 * at, &code, 2);
    }
}

void gtx_surface_undo_occupied(gtx_layer *s, const uint8_t *coded, uint8_t *out)
{
    s->occupied = code_occupied(s, out, (uint8_t *)coded, false);
}

void gtx_surface_undo_patch(const gtx_layer *s, uint32_t index, uint8_t *out)
{
    const gtx_patch *patch = &s->asset->patches[index];
    size_t row = (size_t)patch->page * s->shape.height + (patch->rect[1] >> s->level);
    size_t at = row * s->shape.width + (patch->rect[0] >> s->level);
    const gtx_fill area = {out + at * s->shape.texel, s->ring + at, s->shape.width,
                           (uint32_t)patch->rect[2] >> s->level,
                           (uint32_t)patch->rect[3] >> s->level};
    if (s->kind == GTX_SECTION_NORMAL)
        gtx_fill_normals(&area, gtx_fill_rings(patch, s->level));
    else
        gtx_fill_trim(&area);
}

void gtx_surface_apply(const gtx_asset *asset, const gtx_section *section, const uint8_t *in,
                       uint8_t *coded, uint8_t *scratch)
{
    uint8_t *ring = scratch + section->size;
    gtx_layer s = gtx_layer_of(asset, section, ring, NULL);
    uint8_t *finer = ring + s.texels;
    for (uint32_t k = 0; k < s.level; ++k)
        gtx_mark_level(asset, k, finer, finer);
    gtx_mark_level(asset, s.level, finer, ring);
    s.finer = finer;
    const size_t texel = s.shape.texel;
    size_t cursor = code_occupied(&s, (uint8_t *)in, coded, true);
    memcpy(scratch, in, (size_t)section->size);
    clear_empty(ring, s.texels, s.kind == GTX_SECTION_NORMAL, scratch);
    for (uint32_t i = 0; i < asset->info.patch_count; ++i)
        gtx_surface_undo_patch(&s, i, scratch);
    for (size_t at = 0; at < s.texels; ++at) {
        if (ring[at] == 1)
            continue;
        for (size_t k = 0; k < texel; ++k)
            coded[k * s.texels + cursor] = (uint8_t)(in[at * texel + k] - scratch[at * texel + k]);
        ++cursor;
    }
}

static bool all_zero(const uint8_t *bytes, size_t count)
{
    unsigned any = 0;
    for (size_t i = 0; i < count; ++i)
        any |= bytes[i];
    return !any;
}

void gtx_surface_undo_rest(const gtx_layer *s, const uint8_t *coded, uint8_t *out)
{
    const size_t texel = s->shape.texel;
    for (size_t k = 0; k < texel; ++k) {
        const uint8_t *rest = coded + k * s->texels + s->occupied;
        if (all_zero(rest, s->texels - s->occupied)) /* as the rules would have it */
            continue;
        for (size_t at = 0; at < s->texels; ++at)
            if (s->ring[at] != 1)
                out[at * texel + k] = (uint8_t)(out[at * texel + k] + *rest++);
    }
}
