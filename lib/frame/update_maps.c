/* A patch's edited maps: texels, blocks that are encoded anew, and materials that were all one. */
#include "frame/update.h"

#include "frame/compress.h"

enum { SIDE = 4 };

static bool has_blocks(const gtx_model *model, uint32_t unit)
{
    return model->formats[unit] >= GTX_FORMAT_BC5;
}

size_t gtx_update_scratch(const gtx_model *model, const gtx_patch *patch)
{
    enum { MAX_BLOCK = 16 };  /* bytes of a block */
    bool any = false;
    for (uint32_t unit = 0; unit < UNIT_COUNT; ++unit)
        any = any || has_blocks(model, unit);
    return any ? ((size_t)patch->rect[2] / SIDE + 2) * (patch->rect[3] / SIDE + 2u) * MAX_BLOCK : 0;
}

/* A map of an asset, as a unit has it. */
typedef struct map_of_unit {
    gtx_map map;
    uint32_t unit, texel_size;
} map_of_unit;

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* A level of a map of the asset: all pages. */
typedef struct level_of_map {
    uint32_t level, width, height;
    const uint8_t *texels;
} level_of_map;

/* The blocks that a patch's rectangle touches at a level: of the neighbours' texels, too. */
static void send_blocks(const gtx_model *model, const gtx_asset *asset, const gtx_patch *patch,
                        const map_of_unit *m, const level_of_map *l, uint8_t *scratch,
                        const gtx_sink *sink)
{
    const uint32_t x = patch->rect[0] >> l->level, y = patch->rect[1] >> l->level;
    const gtx_block_rows r = {.format = model->formats[m->unit], .level = l->level,
                              .width = l->width, .height = l->height, .texels = l->texels,
                              .channels = m->texel_size, .page = patch->page,
                              .first = y / SIDE,
                              .end = (y + (patch->rect[3] >> l->level) + SIDE - 1) / SIDE,
                              .left = x / SIDE,
                              .right = (x + (patch->rect[2] >> l->level) + SIDE - 1) / SIDE,
                              .out = scratch};
    gtx_compress_rows(asset, &r);
    const gtx_texture_piece piece = {
        .binding = m->unit, .level = l->level, .layer = patch->page, .x = SIDE * r.left,
        .y = SIDE * r.first, .width = least(SIDE * r.right, l->width) - SIDE * r.left,
        .height = least(SIDE * r.end, l->height) - SIDE * r.first, .data = scratch,
        .row_bytes = (r.right - r.left) * gtx_block_size(r.format)};
    sink->texels(&piece, sink->user);
}

static void send_texels(const gtx_patch *patch, const map_of_unit *m, const level_of_map *l,
                        const gtx_sink *sink)
{
    const uint32_t x = patch->rect[0] >> l->level, y = patch->rect[1] >> l->level;
    const size_t texel = ((size_t)patch->page * l->height + y) * l->width + x;
    const gtx_texture_piece piece = {
        .binding = m->unit, .level = l->level, .layer = patch->page, .x = x, .y = y,
        .width = (uint32_t)patch->rect[2] >> l->level,
        .height = (uint32_t)patch->rect[3] >> l->level,
        .data = l->texels + texel * m->texel_size, .row_bytes = l->width * m->texel_size};
    sink->texels(&piece, sink->user);
}

/* Whether the edited patch still has the material that all have. */
static bool keeps_material(const gtx_model *model, const gtx_asset *asset, const gtx_patch *patch)
{
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        const uint8_t *texels = gtx_map_data(asset, GTX_MAP_MATERIAL, k, NULL);
        const size_t width = model->page_width >> k, height = model->page_height >> k;
        for (uint32_t y = 0; y < (uint32_t)patch->rect[3] >> k; ++y) {
            const size_t row = patch->page * height + (patch->rect[1] >> k) + y;
            if (!gtx_is_material(texels + 4 * (row * width + (patch->rect[0] >> k)),
                                 (size_t)patch->rect[2] >> k, model->constant_material))
                return false;
        }
    }
    return true;
}

/* A texture of all texels in the place of one of a single texel. */
static void spread_material(gtx_model *model, const gtx_asset *asset, const gtx_sink *sink)
{
    gtx_texture t = {.format = GTX_FORMAT_RGBA8, .texel_size = 4, .width = model->page_width,
                     .height = model->page_height, .layers = model->page_count,
                     .levels = model->mip_count, .is_array = 1, .is_filtered = 1};
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        size_t size;
        t.texels[k] = gtx_map_data(asset, GTX_MAP_MATERIAL, k, &size);
        model->size.color += size - (k ? 0 : 4);
    }
    sink->renew(GTX_SLOT_MATERIALS, &t, sink->user);
    model->flat_material = false;
}

void gtx_update_maps(gtx_model *model, const gtx_asset *asset, const gtx_patch *patch,
                     uint8_t *scratch, const gtx_sink *sink)
{
    static const map_of_unit maps[] = {{GTX_MAP_TRIM, UNIT_TRIM, 1},
                                       {GTX_MAP_NORMAL, UNIT_NORMALS, 2},
                                       {GTX_MAP_COLOR, UNIT_COLORS, 4},
                                       {GTX_MAP_MATERIAL, UNIT_MATERIALS, 4},
                                       {GTX_MAP_EMISSION, UNIT_EMISSIONS, 3}};
    if (model->flat_material && !keeps_material(model, asset, patch))
        spread_material(model, asset, sink);
    for (size_t i = 0; i < sizeof maps / sizeof *maps; ++i) {
        const map_of_unit *m = &maps[i];
        if (m->unit == UNIT_MATERIALS && model->flat_material)
            continue;
        for (uint32_t k = 0; k < model->mip_count; ++k) {
            const level_of_map l = {k, model->page_width >> k, model->page_height >> k,
                                    gtx_map_data(asset, m->map, k, NULL)};
            if (!l.texels)
                break;
            if (has_blocks(model, m->unit))
                send_blocks(model, asset, patch, m, &l, scratch, sink);
            else
                send_texels(patch, m, &l, sink);
        }
    }
}
