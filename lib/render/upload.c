/* Models on the GPU's side: textures and buffers, uploaded in slices of rows. */
#include "render/upload.h"

#include "base/error.h"
#include "render/renderer.h"

#include <string.h>

gl_uint gtx_take_vertex_array(const gtx_renderer *renderer)
{
    gl_int hosts = 0;
    renderer->gl.GetIntegerv(GL_VERTEX_ARRAY_BINDING, &hosts);
    renderer->gl.BindVertexArray(renderer->vertex_array);
    return (gl_uint)hosts;
}

static gl_uint allocate_buffer(const gtx_gl *gl, gl_enum target, size_t size, gl_enum usage,
                               const char *label)
{
    gl_uint buffer = 0;
    gl->GenBuffers(1, &buffer);
    gl->BindBuffer(target, buffer);
    gl->BufferData(target, (gl_pointer)size, NULL, usage);
    gtx_gl_label(gl, GL_BUFFER, buffer, label);
    gl->BindBuffer(target, 0);
    return buffer;
}

void gtx_fill_buffer(const gtx_gl *gl, gl_enum target, gl_uint buffer, uint64_t at, uint64_t size,
                     const void *data)
{
    gl->BindBuffer(target, buffer);
    if (size)
        gl->BufferSubData(target, (gl_pointer)at, (gl_pointer)size, data);
    gl->BindBuffer(target, 0);
}

static void allocate_proxies(const gtx_gl *gl, gtx_model *model)
{
    const gtx_proxies *p = &model->proxies;
    model->vertices = allocate_buffer(gl, GL_ARRAY_BUFFER, p->vertex_count * sizeof *p->vertices,
                                      GL_DYNAMIC_DRAW, "geotex proxy vertices");
    model->indices = allocate_buffer(gl, GL_ELEMENT_ARRAY_BUFFER,
                                     (size_t)p->index_count * model->proxy_index_size,
                                     GL_DYNAMIC_DRAW,
                                     "geotex proxy indices");
}

void gtx_default_unpacking(const gtx_gl *gl)
{
    static const gl_enum zero[] = {GL_UNPACK_ROW_LENGTH,   GL_UNPACK_SKIP_ROWS,
                                   GL_UNPACK_SKIP_PIXELS,  GL_UNPACK_SKIP_IMAGES,
                                   GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SWAP_BYTES,
                                   GL_UNPACK_LSB_FIRST};
    const size_t count = sizeof zero / sizeof *zero;
    for (size_t i = 0; i < (gl->es ? count - 2 : count); ++i) /* OpenGL ES never swaps */
        gl->PixelStorei(zero[i], 0);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

/* Uploads what `*budget` allows of a buffer, from byte *sent on. */
static void upload_bytes(const gtx_gl *gl, gl_enum target, gl_uint buffer, const void *data,
                         uint64_t size, uint64_t *sent, uint64_t *budget)
{
    const uint64_t left = size - *sent, count = left < *budget ? left : *budget;
    if (count == 0)
        return;
    gtx_fill_buffer(gl, target, buffer, *sent, count, (const char *)data + *sent);
    *sent += count;
    *budget -= count;
}

gtx_result gtx_check_gl_memory(const gtx_gl *gl, gtx_error *error)
{
    for (int i = 0; i < 16; ++i) { /* a lost context reports errors for ever */
        const gl_enum code = gl->GetError();
        if (code == GL_OUT_OF_MEMORY)
            return gtx_fail(error, GTX_ERROR_GL, "out of GPU memory");
        if (!code)
            break;
    }
    return GTX_OK;
}

static void allocate_lods(const gtx_gl *gl, gtx_lod_meshes *s)
{
    if (!s->level_count)
        return;
    s->vertex_buffer = allocate_buffer(gl, GL_ARRAY_BUFFER, s->vertex_bytes, GL_STATIC_DRAW,
                                       "geotex LOD mesh vertices");
    s->index_buffer = allocate_buffer(gl, GL_ELEMENT_ARRAY_BUFFER, s->index_bytes, GL_STATIC_DRAW,
                                      "geotex LOD mesh indices");
}

/* Names, sizes and labels of all objects, still empty. */
static void allocate(const gtx_gl *gl, gtx_model *model)
{
    gtx_allocate_textures(gl, model);
    allocate_proxies(gl, model);
    allocate_lods(gl, &model->lods);
}

/* Gives the objects back, so that an upload begins anew. */
static void release(const gtx_gl *gl, gtx_model *model)
{
    gl->DeleteTextures(UNIT_COUNT, model->textures);
    gl->DeleteBuffers(1, &model->vertices);
    gl->DeleteBuffers(1, &model->indices);
    gl->DeleteBuffers(1, &model->lods.vertex_buffer);
    gl->DeleteBuffers(1, &model->lods.index_buffer);
    memset(model->textures, 0, sizeof model->textures);
    model->vertices = model->indices = 0;
    model->vertex_bytes_sent = model->index_bytes_sent = 0;
    model->lods.vertex_buffer = model->lods.index_buffer = 0;
    model->lods.vertex_bytes_sent = model->lods.index_bytes_sent = 0;
    for (uint32_t i = 0; i < model->level_count; ++i)
        model->levels[i].next_row = 0;
}

/* Uploads up to `budget` bytes. Returns whether that was all. */
static bool upload_slice(const gtx_gl *gl, gtx_model *model, uint64_t budget)
{
    const gtx_proxies *p = &model->proxies;
    gtx_lod_meshes *s = &model->lods;
    upload_bytes(gl, GL_ARRAY_BUFFER, s->vertex_buffer, s->vertices, s->vertex_bytes,
                 &s->vertex_bytes_sent, &budget);
    upload_bytes(gl, GL_ELEMENT_ARRAY_BUFFER, s->index_buffer, s->indices, s->index_bytes,
                 &s->index_bytes_sent, &budget);
    upload_bytes(gl, GL_ARRAY_BUFFER, model->vertices, p->vertices,
                 p->vertex_count * sizeof *p->vertices, &model->vertex_bytes_sent, &budget);
    upload_bytes(gl, GL_ELEMENT_ARRAY_BUFFER, model->indices, p->indices,
                 (uint64_t)p->index_count * model->proxy_index_size, &model->index_bytes_sent,
                 &budget);
    for (uint32_t i = 0; i < model->level_count; ++i) {
        if (!gtx_is_complete(&model->levels[i]) && budget > 0)
            gtx_upload_rows(gl, model, &model->levels[i], &budget);
        if (!gtx_is_complete(&model->levels[i]))
            return false;
    }
    return true; /* the buffers came first */
}

gtx_result gtx_model_upload(gtx_renderer *renderer, gtx_model *model, uint64_t max_bytes,
                            uint32_t *done, gtx_error *error)
{
    if (!renderer || !model)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "an upload needs a renderer and a model");
    const gtx_gl *gl = &renderer->gl;
    if (done)
        *done = model->ready;
    if (model->ready)
        return GTX_OK;
    gl->ActiveTexture(GL_TEXTURE0);
    gtx_default_unpacking(gl);
    if (!model->vertices) {
        gtx_result result = gtx_check_textures(gl, model, error);
        if (result)
            return result;
    }
    const gl_uint hosts = gtx_take_vertex_array(renderer);
    if (!model->vertices)
        allocate(gl, model);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    const bool whole = upload_slice(gl, model, max_bytes ? max_bytes : UINT64_MAX);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    gl->BindVertexArray(hosts);
    gtx_result result = gtx_check_gl_memory(gl, error);
    if (result) {
        release(gl, model);
        return result;
    }
    model->ready = whole;
    if (model->ready)
        gtx_model_free_staging(model);
    if (done)
        *done = model->ready;
    return GTX_OK;
}

gtx_result gtx_model_create(gtx_renderer *renderer, const gtx_asset *asset, gtx_model **out,
                            gtx_error *error)
{
    if (!renderer)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a model needs a renderer");
    const gtx_model_desc desc = {
        .allocator = &renderer->allocator, .jobs = &renderer->jobs, .borrow = 1,
        .compress = renderer->compress ? gtx_renderer_compression(renderer) : GTX_COMPRESS_NONE};
    gtx_result result = gtx_model_prepare(asset, &desc, out, error);
    if (result)
        return result;
    result = gtx_model_upload(renderer, *out, 0, NULL, error);
    if (result) {
        gtx_model_destroy(renderer, *out);
        *out = NULL;
    }
    return result;
}

void gtx_model_destroy(gtx_renderer *renderer, gtx_model *model)
{
    if (!model)
        return;
    if (renderer && model->vertices)
        release(&renderer->gl, model);
    gtx_model_free(model);
}
