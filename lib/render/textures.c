/* Textures of models: how they are stored, made, and sent in rows of texels or of blocks. */
#include "render/upload.h"

#include "base/error.h"

/* How OpenGL stores a format, and how it is told texels of it; blocks have no words for those. */
typedef struct words {
    gl_enum inner, format, type;
    uint32_t texel_size;
} words;

static const words words_of[] = {
    [GTX_FORMAT_R8] = {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1},
    [GTX_FORMAT_RG8] = {GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2},
    [GTX_FORMAT_RGBA8] = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    [GTX_FORMAT_RGB8_SRGB] = {GL_SRGB8, GL_RGB, GL_UNSIGNED_BYTE, 3},
    [GTX_FORMAT_RGBA8_SRGB] = {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    [GTX_FORMAT_R8_UINT] = {GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, 1},
    [GTX_FORMAT_R16_UINT] = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2},
    [GTX_FORMAT_RGBA32_FLOAT] = {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16},
    [GTX_FORMAT_RGBA8_UINT] = {GL_RGBA8UI, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE, 4},
    [GTX_FORMAT_RGBA16_UINT] = {GL_RGBA16UI, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT, 8},
    [GTX_FORMAT_BC5] = {GL_COMPRESSED_RG_RGTC2, 0, 0, 0},
    [GTX_FORMAT_BC7] = {GL_COMPRESSED_RGBA_BPTC_UNORM, 0, 0, 0},
    [GTX_FORMAT_BC7_SRGB] = {GL_COMPRESSED_SRGB_ALPHA_BPTC_UNORM, 0, 0, 0},
    [GTX_FORMAT_BC1_SRGB] = {GL_COMPRESSED_SRGB_S3TC_DXT1, 0, 0, 0},
    [GTX_FORMAT_EAC_RG11] = {GL_COMPRESSED_RG11_EAC, 0, 0, 0},
    [GTX_FORMAT_ETC2_RGBA8] = {GL_COMPRESSED_RGBA8_ETC2_EAC, 0, 0, 0},
    [GTX_FORMAT_ETC2_RGBA8_SRGB] = {GL_COMPRESSED_SRGB8_ALPHA8_ETC2_EAC, 0, 0, 0},
    [GTX_FORMAT_ETC2_RGB8_SRGB] = {GL_COMPRESSED_SRGB8_ETC2, 0, 0, 0}};

gtx_texture_kind gtx_texture_kind_of(const gtx_model *model, uint32_t unit)
{
    const words w = words_of[model->formats[unit]];
    const bool flat = unit == UNIT_PATCHES;
    const bool filtered = !flat && unit != UNIT_CELLS && unit != UNIT_TRIM;
    return (gtx_texture_kind){flat ? GL_TEXTURE_2D : GL_TEXTURE_2D_ARRAY, w.inner, w.format,
                              w.type, filtered ? GL_LINEAR_MIPMAP_NEAREST : GL_NEAREST,
                              filtered ? GL_LINEAR : GL_NEAREST, w.texel_size};
}

gtx_result gtx_check_textures(const gtx_gl *gl, const gtx_model *model, gtx_error *error)
{
    gl_int side = 0, layers = 0;
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
    gl->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    for (uint32_t i = 0; i < model->level_count; ++i) {
        const gtx_level *l = &model->levels[i];
        const bool bc = model->formats[l->unit] < GTX_FORMAT_EAC_RG11;
        if (l->block_size && !gl->reads[bc ? GTX_COMPRESS_BC : GTX_COMPRESS_ETC2])
            return gtx_fail(error, GTX_ERROR_UNSUPPORTED, "the context reads no %s blocks",
                            bc ? "BC" : "ETC2");
        if (l->width > (uint32_t)side || l->height > (uint32_t)side || l->layers > (uint32_t)layers)
            return gtx_fail(error, GTX_ERROR_LIMIT,
                            "a texture of %u x %u x %u is beyond this GPU's %d x %d x %d", l->width,
                            l->height, l->layers, side, side, layers);
    }
    return GTX_OK;
}

/* The last level is told before there are images: drivers allocate for levels that may come. */
static void begin_texture(const gtx_gl *gl, gtx_model *model, uint32_t unit, uint32_t last_level)
{
    static const char *const labels[UNIT_COUNT] = {
        [UNIT_CELLS] = "geotex cells",         [UNIT_TRIM] = "geotex trim",
        [UNIT_NORMALS] = "geotex normals",     [UNIT_COLORS] = "geotex colors",
        [UNIT_PATCHES] = "geotex patches",     [UNIT_MATERIALS] = "geotex materials",
        [UNIT_EMISSIONS] = "geotex emissions"};
    const gtx_texture_kind kind = gtx_texture_kind_of(model, unit);
    gl->GenTextures(1, &model->textures[unit]);
    gl->BindTexture(kind.target, model->textures[unit]);
    gtx_gl_label(gl, GL_TEXTURE, model->textures[unit], labels[unit]);
    gl->TexParameteri(kind.target, GL_TEXTURE_BASE_LEVEL, 0);
    gl->TexParameteri(kind.target, GL_TEXTURE_MAX_LEVEL, (gl_int)last_level);
    gl->TexParameteri(kind.target, GL_TEXTURE_MIN_FILTER, (gl_int)kind.min_filter);
    gl->TexParameteri(kind.target, GL_TEXTURE_MAG_FILTER, (gl_int)kind.mag_filter);
    gl->TexParameteri(kind.target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(kind.target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

/* The levels of a unit follow one another. */
void gtx_allocate_textures(const gtx_gl *gl, gtx_model *model)
{
    for (uint32_t i = 0; i < model->level_count; ++i) {
        const gtx_level *l = &model->levels[i];
        const gtx_texture_kind kind = gtx_texture_kind_of(model, l->unit);
        uint32_t last = i;
        while (last + 1 < model->level_count && model->levels[last + 1].unit == l->unit)
            ++last;
        if (l->level == 0)
            begin_texture(gl, model, l->unit, last - i);
        if (l->block_size) { /* all levels at once */
            if (l->level == 0)
                gl->TexStorage3D(kind.target, (gl_size)(last - i + 1), kind.inner,
                                 (gl_size)l->width, (gl_size)l->height, (gl_size)l->layers);
        } else if (kind.target == GL_TEXTURE_2D)
            gl->TexImage2D(kind.target, (gl_int)l->level, (gl_int)kind.inner, (gl_size)l->width,
                           (gl_size)l->height, 0, kind.format, kind.type, NULL);
        else
            gl->TexImage3D(kind.target, (gl_int)l->level, (gl_int)kind.inner, (gl_size)l->width,
                           (gl_size)l->height, (gl_size)l->layers, 0, kind.format, kind.type, NULL);
    }
}

bool gtx_is_complete(const gtx_level *l)
{
    return l->next_row == gtx_level_rows(l) * l->layers;
}

static void send_rows(const gtx_gl *gl, const gtx_texture_kind *kind, const gtx_level *l,
                      uint32_t layer, uint32_t y, uint32_t rows, const uint8_t *data)
{
    const gl_int level = (gl_int)l->level;
    const uint32_t high = 4 * (y + rows) < l->height ? 4 * rows : l->height - 4 * y;
    if (l->block_size)
        gl->CompressedTexSubImage3D(kind->target, level, 0, (gl_int)(4 * y), (gl_int)layer,
                                    (gl_size)l->width, (gl_size)high, 1, kind->inner,
                                    (gl_size)(rows * gtx_level_row_size(l)), data);
    else if (kind->target == GL_TEXTURE_2D)
        gl->TexSubImage2D(kind->target, level, 0, (gl_int)y, (gl_size)l->width, (gl_size)rows,
                          kind->format, kind->type, data);
    else
        gl->TexSubImage3D(kind->target, level, 0, (gl_int)y, (gl_int)layer, (gl_size)l->width,
                          (gl_size)rows, 1, kind->format, kind->type, data);
}

void gtx_upload_rows(const gtx_gl *gl, gtx_model *model, gtx_level *l, uint64_t *budget)
{
    const gtx_texture_kind kind = gtx_texture_kind_of(model, l->unit);
    const uint64_t row_size = gtx_level_row_size(l);
    const uint32_t height = gtx_level_rows(l);
    gl->BindTexture(kind.target, model->textures[l->unit]);
    do {
        const uint32_t layer = l->next_row / height, y = l->next_row % height;
        const uint64_t affordable = *budget / row_size;
        uint32_t rows = height - y;
        if (rows > affordable)
            rows = affordable ? (uint32_t)affordable : 1;
        send_rows(gl, &kind, l, layer, y, rows, l->data + l->next_row * row_size);
        l->next_row += rows;
        *budget -= rows * row_size < *budget ? rows * row_size : *budget;
    } while (!gtx_is_complete(l) && *budget > 0);
    gl->BindTexture(kind.target, 0);
}
