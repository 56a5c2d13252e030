/* The textures of rays in shaders: texels are addressed through rows and layers, as in an array. */
#include "render/rays.h"

#include "base/error.h"
#include "frame/units.h"
#include "render/renderer.h"
#include "render/upload.h"

typedef struct texture_kind {
    gl_enum target, inner, format, type;
    size_t texel_size;
    const char *sampler, *label;
} texture_kind;

static texture_kind kind_of(gtx_ray_texture texture, uint32_t bits)
{
    static const texture_kind nodes = {GL_TEXTURE_2D, GL_RGBA32F, GL_RGBA, GL_FLOAT, 16,
                                       "gtx_ray_nodes", "geotex ray nodes"};
    static const texture_kind cells = {GL_TEXTURE_2D_ARRAY, GL_RGBA8UI, GL_RGBA_INTEGER,
                                       GL_UNSIGNED_BYTE, 4, "gtx_ray_cells", "geotex ray cells"};
    static const texture_kind fine = {GL_TEXTURE_2D_ARRAY, GL_RGBA16UI, GL_RGBA_INTEGER,
                                      GL_UNSIGNED_SHORT, 8, "gtx_ray_cells", "geotex ray cells"};
    static const texture_kind trim = {GL_TEXTURE_2D_ARRAY, GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1,
                                      "gtx_ray_trim", "geotex ray trim"};
    if (texture == GTX_RAY_NODES)
        return nodes;
    return texture == GTX_RAY_TRIM ? trim : bits == 16 ? fine : cells;
}

static void make_texture(const gtx_gl *gl, gtx_rays *rays, gtx_ray_texture texture, size_t texels,
                         const void *data)
{
    const texture_kind kind = kind_of(texture, rays->bits);
    const size_t layer = (size_t)GTX_RAY_ROW * GTX_RAY_LAYER_ROWS;
    const size_t layers = texels > layer ? texels / layer : 1;
    gl->GenTextures(1, &rays->textures[texture]);
    gl->BindTexture(kind.target, rays->textures[texture]);
    gtx_gl_label(gl, GL_TEXTURE, rays->textures[texture], kind.label);
    if (kind.target == GL_TEXTURE_2D)
        gl->TexImage2D(kind.target, 0, (gl_int)kind.inner, GTX_RAY_ROW,
                       (gl_size)(texels / GTX_RAY_ROW), 0, kind.format, kind.type, data);
    else
        gl->TexImage3D(kind.target, 0, (gl_int)kind.inner, GTX_RAY_ROW,
                       (gl_size)(texels / layers / GTX_RAY_ROW), (gl_size)layers, 0, kind.format,
                       kind.type, data);
    gl->TexParameteri(kind.target, GL_TEXTURE_BASE_LEVEL, 0);
    gl->TexParameteri(kind.target, GL_TEXTURE_MAX_LEVEL, 0);
    gl->TexParameteri(kind.target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(kind.target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void gtx_rays_leave(const gtx_gl *gl)
{
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
}

static void begin(const gtx_gl *gl)
{
    gl->ActiveTexture(GL_TEXTURE0);
    gtx_default_unpacking(gl);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
}

gtx_result gtx_rays_upload(const gtx_gl *gl, gtx_rays *rays, const gtx_ray_maps *maps,
                           gtx_error *error)
{
    gl_int side = 0, layers = 0;
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
    gl->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    if (rays->nodes / GTX_RAY_ROW > (size_t)side ||
        rays->cells / GTX_RAY_ROW / GTX_RAY_LAYER_ROWS > (size_t)layers)
        return gtx_fail(error, GTX_ERROR_LIMIT, "the assets are too large for this GPU's textures");
    begin(gl);
    make_texture(gl, rays, GTX_RAY_NODES, rays->nodes, NULL);
    make_texture(gl, rays, GTX_RAY_CELLS, rays->cells, maps->cells);
    make_texture(gl, rays, GTX_RAY_TRIM, rays->cells, maps->trim);
    gtx_rays_leave(gl);
    return gtx_check_gl_memory(gl, error);
}

void gtx_rays_send(const gtx_gl *gl, const gtx_rays *rays, gtx_ray_texture texture, size_t first,
                   size_t count, const void *data)
{
    const texture_kind kind = kind_of(texture, rays->bits);
    const uint8_t *next = data;
    begin(gl);
    gl->BindTexture(kind.target, rays->textures[texture]);
    while (count) {
        const size_t x = first % GTX_RAY_ROW, y = first / GTX_RAY_ROW;
        const size_t left = GTX_RAY_LAYER_ROWS - y % GTX_RAY_LAYER_ROWS, room = GTX_RAY_ROW - x;
        size_t width = count < room ? count : room, rows = 1;
        if (width == GTX_RAY_ROW)
            rows = count / GTX_RAY_ROW < left ? count / GTX_RAY_ROW : left;
        if (kind.target == GL_TEXTURE_2D)
            gl->TexSubImage2D(kind.target, 0, (gl_int)x, (gl_int)y, (gl_size)width, (gl_size)rows,
                              kind.format, kind.type, next);
        else
            gl->TexSubImage3D(kind.target, 0, (gl_int)x, (gl_int)(y % GTX_RAY_LAYER_ROWS),
                              (gl_int)(y / GTX_RAY_LAYER_ROWS), (gl_size)width, (gl_size)rows, 1,
                              kind.format, kind.type, next);
        first += width * rows;
        count -= width * rows;
        next += width * rows * kind.texel_size;
    }
    gtx_rays_leave(gl);
}

void gtx_rays_locate(const gtx_gl *gl, gl_uint program)
{
    for (gl_int i = 0; i < GTX_RAY_TEXTURES; ++i) {
        const char *sampler = kind_of((gtx_ray_texture)i, 8).sampler;
        gl->Uniform1i(gl->GetUniformLocation(program, sampler), UNIT_RAYS + i);
    }
}

void gtx_rays_bind(gtx_renderer *renderer, const gtx_rays *rays, uint32_t program)
{
    const gtx_gl *gl = &renderer->gl;
    for (gl_uint i = 0; i < GTX_RAY_TEXTURES; ++i) {
        gl->ActiveTexture(GL_TEXTURE0 + UNIT_RAYS + i);
        gl->BindSampler(UNIT_RAYS + i, 0);
        gl->BindTexture(i == GTX_RAY_NODES ? GL_TEXTURE_2D : GL_TEXTURE_2D_ARRAY,
                        rays ? rays->textures[i] : 0);
    }
    gl->ActiveTexture(GL_TEXTURE0);
    if (program) {
        gl->UseProgram(program);
        gtx_rays_locate(gl, program);
        gl->UseProgram(0);
    }
}
