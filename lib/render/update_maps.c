/* A patch's edited maps: texels, blocks that are encoded anew, and materials that were all one. */
#include "render/update.h"

#include "frame/compress.h"
#include "render/upload.h"

void gtx_update_texels(const gtx_gl *gl, const gtx_model *model, const gtx_patch *patch,
                       const gtx_update_rect *r)
{
    const gtx_texture_kind kind = gtx_texture_kind_of(model, r->unit);
    gl->BindTexture(kind.target, model->textures[r->unit]);
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, (gl_int)r->row_texels);
    gl->TexSubImage3D(kind.target, (gl_int)r->mip, (gl_int)r->at[0], (gl_int)r->at[1],
                      (gl_int)patch->page, patch->rect[2] >> r->level, patch->rect[3] >> r->level,
                      1, kind.format, kind.type, r->texels);
}

enum { SIDE = 4 };

static bool has_blocks(const gtx_model *model, uint32_t unit)
{
    return model->formats[unit] >= GTX_FORMAT_BC5;
}

size_t gtx_update_scratch(const gtx_model *model, const gtx_patch *patch)
{
    enum { MOST = 16 };       /* bytes of a block */
    bool any = false;
    for (uint32_t unit = 0; unit < UNIT_COUNT; ++unit)
        any = any || has_blocks(model, unit);
    return any ? ((size_t)patch->rect[2] / SIDE + 2) * (patch->rect[3] / SIDE + 2u) * MOST : 0;
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

/* The blocks that a patch's rectangle touches at a level: of the neighbours' texels, too. */
static void update_blocks(const gtx_gl *gl, const gtx_model *model, const gtx_asset *asset,
                          const gtx_patch *patch, const map_of_unit *m, uint32_t level,
                          const uint8_t *texels, uint8_t *scratch)
{
    const gtx_texture_kind kind = gtx_texture_kind_of(model, m->unit);
    const uint32_t width = model->page_width >> level, height = model->page_height >> level;
    const uint32_t x = patch->rect[0] >> level, y = patch->rect[1] >> level;
    const gtx_block_rows r = {.format = model->formats[m->unit], .level = level,
                              .width = width, .height = height, .texels = texels,
                              .channels = m->texel_size, .page = patch->page,
                              .first = y / SIDE,
                              .end = (y + (patch->rect[3] >> level) + SIDE - 1) / SIDE,
                              .left = x / SIDE,
                              .right = (x + (patch->rect[2] >> level) + SIDE - 1) / SIDE,
                              .out = scratch};
    const uint32_t block = r.format == GTX_FORMAT_ETC2_RGB8_SRGB ? 8 : 16;
    const uint32_t blocks = (r.right - r.left) * (r.end - r.first);
    gtx_compress_rows(asset, &r);
    gl->BindTexture(kind.target, model->textures[m->unit]);
    gl->CompressedTexSubImage3D(kind.target, (gl_int)level, (gl_int)(SIDE * r.left),
                                (gl_int)(SIDE * r.first), (gl_int)patch->page,
                                (gl_size)(least(SIDE * r.right, width) - SIDE * r.left),
                                (gl_size)(least(SIDE * r.end, height) - SIDE * r.first), 1,
                                kind.inner, (gl_size)(blocks * block), scratch);
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
static void spread_material(const gtx_gl *gl, gtx_model *model, const gtx_asset *asset)
{
    const gtx_texture_kind kind = gtx_texture_kind_of(model, UNIT_MATERIALS);
    gl->BindTexture(kind.target, model->textures[UNIT_MATERIALS]);
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    gl->TexParameteri(kind.target, GL_TEXTURE_MAX_LEVEL, (gl_int)model->mip_count - 1);
    for (uint32_t k = 0; k < model->mip_count; ++k) {
        size_t size;
        const uint8_t *texels = gtx_map_data(asset, GTX_MAP_MATERIAL, k, &size);
        gl->TexImage3D(kind.target, (gl_int)k, (gl_int)kind.inner,
                       (gl_size)(model->page_width >> k), (gl_size)(model->page_height >> k),
                       (gl_size)model->page_count, 0, kind.format, kind.type, texels);
        model->size.color += size - (k ? 0 : 4);
    }
    model->flat_material = false;
}

void gtx_update_maps(const gtx_gl *gl, gtx_model *model, const gtx_asset *asset,
                     const gtx_patch *patch, uint8_t *scratch)
{
    static const map_of_unit maps[] = {{GTX_MAP_TRIM, UNIT_TRIM, 1},
                                       {GTX_MAP_NORMAL, UNIT_NORMALS, 2},
                                       {GTX_MAP_COLOR, UNIT_COLORS, 4},
                                       {GTX_MAP_MATERIAL, UNIT_MATERIALS, 4},
                                       {GTX_MAP_EMISSION, UNIT_EMISSIONS, 3}};
    if (model->flat_material && !keeps_material(model, asset, patch))
        spread_material(gl, model, asset);
    for (size_t i = 0; i < sizeof maps / sizeof *maps; ++i) {
        const map_of_unit *m = &maps[i];
        if (m->unit == UNIT_MATERIALS && model->flat_material)
            continue;
        for (uint32_t k = 0; k < model->mip_count; ++k) {
            const uint8_t *data = gtx_map_data(asset, m->map, k, NULL);
            if (!data)
                break;
            const size_t width = model->page_width >> k, height = model->page_height >> k;
            gtx_update_rect r = {.unit = m->unit, .level = k, .mip = k,
                                 .at = {patch->rect[0] >> k, patch->rect[1] >> k},
                                 .row_texels = (uint32_t)width};
            const size_t texel = (patch->page * height + r.at[1]) * width + r.at[0];
            r.texels = data + texel * m->texel_size;
            if (has_blocks(model, m->unit))
                update_blocks(gl, model, asset, patch, m, k, data, scratch);
            else
                gtx_update_texels(gl, model, patch, &r);
        }
    }
}
