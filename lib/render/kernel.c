/* The kernel that casts by tiles: its objects, and its part in a draw. */
#include "render/renderer.h"

#include "base/error.h"

static void make_buffers(gtx_renderer *renderer)
{
    static const char *const names[2] = {"geotex tiles", "geotex rays"};
    const gtx_gl *gl = &renderer->gl;
    gtx_tiles *t = &renderer->tiles;
    gl->GenVertexArrays(1, &t->vertex_array);
    gl->BindVertexArray(t->vertex_array);
    gtx_gl_label(gl, GL_VERTEX_ARRAY, t->vertex_array, "geotex tile corners");
    gl->GenBuffers(1, &t->corner_buffer);
    gl->BindBuffer(GL_ARRAY_BUFFER, t->corner_buffer);
    gtx_gl_label(gl, GL_BUFFER, t->corner_buffer, "geotex tile corners");
    gl->VertexAttribPointer(0, 2, GL_UNSIGNED_SHORT, GL_FALSE, 0, NULL);
    gl->EnableVertexAttribArray(0);
    gl->BindVertexArray(0);
    gl->GenBuffers(2, t->buffers);
    gl->GenTextures(2, t->textures);
    for (int i = 0; i < 2; ++i) {
        gl->BindBuffer(GL_ARRAY_BUFFER, t->buffers[i]);
        gtx_gl_label(gl, GL_BUFFER, t->buffers[i], names[i]);
        gl->BindTexture(GL_TEXTURE_BUFFER, t->textures[i]);
        gtx_gl_label(gl, GL_TEXTURE, t->textures[i], names[i]);
        gl->TexBuffer(GL_TEXTURE_BUFFER, i ? GL_RGBA32F : GL_RGBA32UI, t->buffers[i]);
    }
    gl->BindTexture(GL_TEXTURE_BUFFER, 0);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
}

void gtx_kernel_create(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_tiles *t = &renderer->tiles;
    gtx_error error;
    if (!gl->DispatchCompute)
        return;
    if (gtx_program_of_kernel(renderer, &t->kernel, &error)) {
        renderer->gl.DispatchCompute = NULL;
        return;
    }
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &t->max_side);
    gl->GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &t->max_texels);
    make_buffers(renderer);
}

void gtx_kernel_destroy(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_tiles *t = &renderer->tiles;
    if (!t->kernel.object)
        return;
    gl->DeleteProgram(t->kernel.object);
    gl->DeleteVertexArrays(1, &t->vertex_array);
    gl->DeleteBuffers(1, &t->corner_buffer);
    gl->DeleteBuffers(2, t->buffers);
    gl->DeleteTextures(2, t->textures);
    gl->DeleteTextures(1, &t->image);
}

bool gtx_kernel_suits(const gtx_renderer *renderer, const gtx_view *view)
{
    /* Corners are counted in 16 bits. */
    const uint32_t most = renderer->tiles.max_side < 65528 ? (uint32_t)renderer->tiles.max_side
                                                           : 65528;
    return renderer->gl.DispatchCompute && !view->shading &&
           view->method != GTX_METHOD_PAPER && view->viewport_width > 0 &&
           view->viewport_width <= most - 7 && view->viewport_height > 0 &&
           view->viewport_height <= most - 7;
}

/* Makes the image as large as the viewport, in whole tiles. */
static void fit_image(const gtx_gl *gl, gtx_tiles *t)
{
    const uint32_t width = ((uint32_t)t->place[8][2] + 7) & ~7u;
    const uint32_t height = ((uint32_t)t->place[8][3] + 7) & ~7u;
    if (t->image && width <= t->image_width && height <= t->image_height)
        return;
    t->image_width = width > t->image_width ? width : t->image_width;
    t->image_height = height > t->image_height ? height : t->image_height;
    gl->DeleteTextures(1, &t->image);
    gl->GenTextures(1, &t->image);
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_SEEN);
    gl->BindTexture(GL_TEXTURE_2D, t->image);
    gtx_gl_label(gl, GL_TEXTURE, t->image, "geotex hits");
    gl->TexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA32UI, (gl_size)t->image_width,
                     (gl_size)t->image_height);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

static void stream(const gtx_gl *gl, gl_uint buffer, const void *data, size_t size)
{
    gl->BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl->BufferData(GL_ARRAY_BUFFER, (gl_pointer)size, data, GL_STREAM_DRAW);
}

void gtx_kernel_cast(gtx_renderer *renderer, const gtx_frame *frame, const gtx_model *model)
{
    const gtx_gl *gl = &renderer->gl;
    gtx_tiles *t = &renderer->tiles;
    const gl_uint buffers[3] = {t->textures[0], t->textures[1], model->slab_texture};
    fit_image(gl, t);
    stream(gl, t->buffers[0], t->lists.data, (size_t)t->list_texels * 16);
    stream(gl, t->buffers[1], t->rays.data, (size_t)t->ray_texels * 16);
    stream(gl, t->corner_buffer, t->corners.data, (size_t)t->corner_count * 4);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
    for (gl_uint i = 0; i < 3; ++i) {
        gl->ActiveTexture(GL_TEXTURE0 + UNIT_LISTS + i);
        gl->BindTexture(GL_TEXTURE_BUFFER, buffers[i]);
    }
    gl->UseProgram(t->kernel.object);
    gl->Uniform4fv(t->kernel.depth, 1, frame->depth);
    gl->Uniform4fv(t->kernel.place, 12, t->place[0]);
    gl->MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT); /* an instance before may still be drawn */
    gl->BindImageTexture(0, t->image, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32UI);
    gl->DispatchCompute(t->tile_count, 1, 1);
    gl->MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void gtx_kernel_resolve(gtx_renderer *renderer, const gtx_program *program,
                        const gtx_instance_data *placed)
{
    const gtx_gl *gl = &renderer->gl;
    const gtx_tiles *t = &renderer->tiles;
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_SEEN);
    gl->BindTexture(GL_TEXTURE_2D, t->image);
    gl->Uniform4fv(program->place, 12, t->place[0]);
    gl->Uniform4fv(program->tint, 1, placed->tint);
    gl->Uniform1ui(program->instance, placed->id);
    gl->BindVertexArray(t->vertex_array);
    gl->Disable(GL_CULL_FACE);
    gl->DrawArrays(GL_TRIANGLES, 0, (gl_size)t->corner_count);
    gl->Enable(GL_CULL_FACE);
}
