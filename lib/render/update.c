/* Edits of a model, sent to OpenGL. */
#include "render/upload.h"

#include "base/error.h"
#include "render/renderer.h"

typedef struct destination {
    const gtx_gl *gl;
    const gtx_model *model;
} destination;

static void send_texels(const gtx_texture_piece *t, void *user)
{
    const destination *d = user;
    const gtx_gl *gl = d->gl;
    const gtx_texture_kind kind = gtx_texture_kind_of(d->model, t->binding);
    const gl_int level = (gl_int)t->level, x = (gl_int)t->x, y = (gl_int)t->y;
    const gl_size width = (gl_size)t->width, height = (gl_size)t->height;
    gl->BindTexture(kind.target, d->model->textures[t->binding]);
    if (!kind.format) { /* blocks */
        gl->CompressedTexSubImage3D(kind.target, level, x, y, (gl_int)t->layer, width, height, 1,
                                    kind.inner, (gl_size)(t->row_bytes * ((t->height + 3) / 4)),
                                    t->data);
        return;
    }
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, (gl_int)(t->row_bytes / kind.texel_size));
    if (kind.target == GL_TEXTURE_2D)
        gl->TexSubImage2D(kind.target, level, x, y, width, height, kind.format, kind.type,
                          t->data);
    else
        gl->TexSubImage3D(kind.target, level, x, y, (gl_int)t->layer, width, height, 1,
                          kind.format, kind.type, t->data);
}

static void send_bytes(gtx_buffer buffer, uint64_t at, const void *data, uint64_t size, void *user)
{
    const destination *d = user;
    const bool indices = buffer == GTX_BUFFER_PROXY_INDICES;
    gtx_fill_buffer(d->gl, indices ? GL_ELEMENT_ARRAY_BUFFER : GL_ARRAY_BUFFER,
                    indices ? d->model->indices : d->model->vertices, at, size, data);
}

/* The same texture, of other sizes. */
static void renew(gtx_slot slot, const gtx_texture *t, void *user)
{
    const destination *d = user;
    const gtx_gl *gl = d->gl;
    const gtx_texture_kind kind = gtx_texture_kind_of(d->model, slot);
    gl->BindTexture(kind.target, d->model->textures[slot]);
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    gl->TexParameteri(kind.target, GL_TEXTURE_MAX_LEVEL, (gl_int)t->levels - 1);
    for (uint32_t k = 0; k < t->levels; ++k)
        gl->TexImage3D(kind.target, (gl_int)k, (gl_int)kind.inner, (gl_size)(t->width >> k),
                       (gl_size)(t->height >> k), (gl_size)t->layers, 0, kind.format, kind.type,
                       t->texels[k]);
}

gtx_result gtx_model_update(gtx_renderer *renderer, gtx_model *model, const gtx_asset *edited,
                            uint32_t patch, gtx_error *error)
{
    if (!renderer || !model || !edited || !model->ready)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an update needs a renderer, an uploaded model and an asset");
    const gtx_gl *gl = &renderer->gl;
    destination to = {gl, model};
    const gtx_sink sink = {send_texels, send_bytes, renew, &to};
    gl->ActiveTexture(GL_TEXTURE0);
    gtx_default_unpacking(gl);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    const gl_uint hosts = gtx_take_vertex_array(renderer);
    gtx_result result = gtx_model_edit(model, edited, patch, &sink, error);
    gl->BindVertexArray(hosts);
    gl->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    return result ? result : gtx_check_gl_memory(gl, error);
}
