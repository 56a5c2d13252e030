/* Rays in shaders: what is derived is sent to textures of OpenGL. */
#include "render/rays.h"

#include "base/error.h"
#include "frame/units.h"
#include "render/renderer.h"
#include "render/upload.h"

/* How OpenGL has one of the textures. */
typedef struct texture_kind {
    gl_enum target, inner, format, type;
    const char *sampler, *label;
} texture_kind;

static texture_kind kind_of(uint32_t which, uint32_t bits)
{
    static const texture_kind nodes = {GL_TEXTURE_2D, GL_RGBA32F, GL_RGBA, GL_FLOAT,
                                       "gtx_ray_nodes", "geotex ray nodes"};
    static const texture_kind cells = {GL_TEXTURE_2D_ARRAY, GL_RGBA8UI, GL_RGBA_INTEGER,
                                       GL_UNSIGNED_BYTE, "gtx_ray_cells", "geotex ray cells"};
    static const texture_kind fine = {GL_TEXTURE_2D_ARRAY, GL_RGBA16UI, GL_RGBA_INTEGER,
                                      GL_UNSIGNED_SHORT, "gtx_ray_cells", "geotex ray cells"};
    static const texture_kind trim = {GL_TEXTURE_2D_ARRAY, GL_R8, GL_RED, GL_UNSIGNED_BYTE,
                                      "gtx_ray_trim", "geotex ray trim"};
    if (which == GTX_RAY_NODES)
        return nodes;
    return which == GTX_RAY_TRIM ? trim : bits == 16 ? fine : cells;
}

static void make_texture(const gtx_gl *gl, gtx_rays *rays, uint32_t which)
{
    const texture_kind kind = kind_of(which, rays->bits);
    gtx_texture t;
    gtx_rays_texture(rays, which, &t);
    gl->GenTextures(1, &rays->textures[which]);
    gl->BindTexture(kind.target, rays->textures[which]);
    gtx_gl_label(gl, GL_TEXTURE, rays->textures[which], kind.label);
    if (kind.target == GL_TEXTURE_2D)
        gl->TexImage2D(kind.target, 0, (gl_int)kind.inner, (gl_size)t.width, (gl_size)t.height, 0,
                       kind.format, kind.type, t.texels[0]);
    else
        gl->TexImage3D(kind.target, 0, (gl_int)kind.inner, (gl_size)t.width, (gl_size)t.height,
                       (gl_size)t.layers, 0, kind.format, kind.type, t.texels[0]);
    gl->TexParameteri(kind.target, GL_TEXTURE_BASE_LEVEL, 0);
    gl->TexParameteri(kind.target, GL_TEXTURE_MAX_LEVEL, 0);
    gl->TexParameteri(kind.target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(kind.target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

/* Leaves units and unpacking as gtx_model_upload does. */
static void leave(const gtx_gl *gl)
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

static gtx_result upload(const gtx_gl *gl, gtx_rays *rays, gtx_error *error)
{
    gl_int side = 0, layers = 0;
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
    gl->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    for (uint32_t i = 0; i < GTX_RAYS_TEXTURES; ++i) {
        gtx_texture t;
        gtx_rays_texture(rays, i, &t);
        if (t.height > (uint32_t)side || t.layers > (uint32_t)layers)
            return gtx_fail(error, GTX_ERROR_LIMIT,
                            "the assets are too large for this GPU's textures");
    }
    begin(gl);
    for (uint32_t i = 0; i < GTX_RAYS_TEXTURES; ++i)
        make_texture(gl, rays, i);
    leave(gl);
    return gtx_check_gl_memory(gl, error);
}

/* What a sink sends to. */
typedef struct destination {
    const gtx_gl *gl;
    const gtx_rays *rays;
} destination;

static void send(const gtx_texture_piece *t, void *user)
{
    const destination *d = user;
    const gtx_gl *gl = d->gl;
    const uint32_t which = t->binding - GTX_RAYS_BINDING;
    const texture_kind kind = kind_of(which, d->rays->bits);
    gl->BindTexture(kind.target, d->rays->textures[which]);
    if (kind.target == GL_TEXTURE_2D)
        gl->TexSubImage2D(kind.target, 0, (gl_int)t->x, (gl_int)t->y, (gl_size)t->width,
                          (gl_size)t->height, kind.format, kind.type, t->data);
    else
        gl->TexSubImage3D(kind.target, 0, (gl_int)t->x, (gl_int)t->y, (gl_int)t->layer,
                          (gl_size)t->width, (gl_size)t->height, 1, kind.format, kind.type,
                          t->data);
}

gtx_result gtx_rays_create(gtx_renderer *renderer, const gtx_rays_desc *desc, gtx_rays **out,
                           gtx_error *error)
{
    if (!renderer || !desc || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "rays need a renderer and assets");
    *out = NULL;
    gtx_rays *rays = NULL;
    gtx_rays_desc own = *desc;
    if (!own.allocator)
        own.allocator = &renderer->allocator;
    gtx_result result = gtx_rays_prepare(&own, &rays, error);
    if (result)
        return result;
    result = upload(&renderer->gl, rays, error);
    gtx_rays_uploaded(rays);
    if (!result)
        result = gtx_rays_place(renderer, rays, NULL, 0, error);
    if (result)
        gtx_rays_destroy(renderer, rays);
    else
        *out = rays;
    return result;
}

void gtx_rays_destroy(gtx_renderer *renderer, gtx_rays *rays)
{
    if (!rays)
        return;
    renderer->gl.DeleteTextures(GTX_RAY_TEXTURES, rays->textures);
    gtx_rays_free(rays);
}

gtx_result gtx_rays_place(gtx_renderer *renderer, gtx_rays *rays,
                          const gtx_ray_instance *instances, uint32_t count, gtx_error *error)
{
    if (!renderer || !rays)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "placing needs a renderer and rays");
    destination to = {&renderer->gl, rays};
    const gtx_sink sink = {.texels = send, .user = &to};
    begin(&renderer->gl);
    const gtx_result result = gtx_rays_arrange(rays, instances, count, &sink, error);
    leave(&renderer->gl);
    return result;
}

gtx_result gtx_rays_update(gtx_renderer *renderer, gtx_rays *rays, uint32_t asset,
                           const gtx_asset *edited, uint32_t patch, gtx_error *error)
{
    if (!renderer || !rays)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "an update needs a renderer and rays");
    destination to = {&renderer->gl, rays};
    const gtx_sink sink = {.texels = send, .user = &to};
    begin(&renderer->gl);
    const gtx_result result = gtx_rays_edit(rays, asset, edited, patch, &sink, error);
    leave(&renderer->gl);
    return result;
}

void gtx_rays_locate(const gtx_gl *gl, gl_uint program)
{
    for (gl_int i = 0; i < GTX_RAY_TEXTURES; ++i) {
        const char *sampler = kind_of((uint32_t)i, 8).sampler;
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
