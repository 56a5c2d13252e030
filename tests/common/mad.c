/* Mad assets, made texel by texel. */
#include "common/mad.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_SIDE = 1024 };      /* of a page, unless a patch is larger */

typedef struct maps {
    uint32_t side, columns, page; /* of patches; patches in a row of a page; texels of its side */
    uint8_t *height, *trim, *normal;
} maps;

/* Height code and trim of a texel. Rounding lets a code of 132 show in one point. */
static uint8_t code_of(mad_field field, uint32_t x, uint32_t y)
{
    if (field == MAD_NEEDLES)
        return (x + y) % 2 ? 255 : 1;
    if (field == MAD_RIDGES)
        return x == 48 && y == 48 ? 255 : (uint8_t)(80 + 60 * sin(x * 6.2831853 / 64));
    return (uint8_t)(128 + 20 * sin((x + y) * 0.2));
}

static uint8_t trim_of(mad_field field, uint32_t x, uint32_t y)
{
    return field == MAD_NEEDLES ? 0 : x % 2 && y % 2 ? 132 : 255;
}

static void fill(const maps *m, const gtx_patch *p, mad_field field)
{
    for (uint32_t y = 0; y < m->side; ++y)
        for (uint32_t x = 0; x < m->side; ++x) {
            const size_t row = (size_t)p->page * m->page + p->rect[1] + y;
            const size_t texel = row * m->page + p->rect[0] + x;
            m->height[texel] = code_of(field, x, y);
            m->trim[texel] = trim_of(field, x, y);
        }
}

/* The sphere is around the whole box. */
static void frame(gtx_patch *p, uint32_t index, const maps *m, float share, mad_place place,
                  float depth)
{
    const uint32_t a_page = m->columns * m->columns, at = index % a_page;
    const uint32_t a_row = (uint32_t)lroundf(1 / share);
    *p = (gtx_patch){.axis_x = {1, 0, 0}, .axis_y = {0, 1, 0}, .axis_z = {0, 0, 1},
                     .extent_x = share, .extent_y = share, .extent_z = depth * share,
                     .page = index / a_page, .coverage = 1, .dilation = 1,
                     .flags = GTX_PATCH_TWO_SIDED};
    p->rect[0] = (uint16_t)(at % m->columns * m->side);
    p->rect[1] = (uint16_t)(at / m->columns * m->side);
    p->rect[2] = p->rect[3] = (uint16_t)m->side;
    p->origin[0] = place == MAD_SHEET ? share * (float)(index % a_row) : 0;
    p->origin[1] = place == MAD_SHEET ? share * (float)(index / a_row) : 0;
    p->origin[2] = place == MAD_STACK ? 1e-6f * (float)index : 0;
    const float half[3] = {p->extent_x / 2, p->extent_y / 2, p->extent_z / 2};
    for (int k = 0; k < 3; ++k)
        p->sphere[k] = p->origin[k] + half[k];
    p->sphere[3] = 1.001f * sqrtf(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
}

static void *must(void *memory)
{
    if (!memory)
        abort();
    return memory;
}

gtx_asset *mad_asset(uint32_t count, uint32_t side, mad_place place, mad_field field)
{
    const uint32_t page = side > MAX_SIDE ? side : side * (MAX_SIDE / side);
    maps m = {.side = side, .columns = page / side, .page = page < 8 ? 8 : page};
    const uint32_t pages = (count + m.columns * m.columns - 1) / (m.columns * m.columns);
    const size_t texels = (size_t)pages * m.page * m.page;
    gtx_patch *patches = must(calloc(count, sizeof *patches));
    m.height = must(calloc(texels, 1));
    m.trim = must(calloc(texels, 1));
    m.normal = must(malloc(2 * texels));
    memset(m.normal, 128, 2 * texels);
    const float share = place == MAD_SHEET ? 1 / ceilf(sqrtf((float)count)) : 1;
    for (uint32_t i = 0; i < count; ++i) {
        frame(&patches[i], i, &m, share, place, field == MAD_NEEDLES ? 1 : 0.1f);
        fill(&m, &patches[i], field);
    }
    const uint8_t *normals[] = {m.normal};
    const gtx_asset_desc desc = {
        .patches = patches, .patch_count = count, .page_count = pages, .page_width = m.page,
        .page_height = m.page, .mip_count = 1, .height_bits = 8, .height = m.height,
        .trim = m.trim, .normal = normals,
        .bounds_max = {1, 1, patches[count - 1].origin[2] + patches[0].extent_z}};
    gtx_asset *asset = NULL;
    gtx_error error = {0};
    if (gtx_create(&desc, &asset, &error)) {
        fprintf(stderr, "a mad asset: %s\n", error.message);
        abort();
    }
    free(patches);
    free(m.height);
    free(m.trim);
    free(m.normal);
    return asset;
}
