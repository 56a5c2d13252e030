/* A framebuffer object with RGBA8 colour and 32-bit float depth. */
#include "host/framebuffer.h"

#include "base/error.h"

gtx_result gtx_framebuffer_create(const gtx_host_gl *gl, int width, int height,
                                  gtx_framebuffer *out, gtx_error *error)
{
    gtx_framebuffer f = {.width = width, .height = height};
    GLint limit = 0;
    gl->GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
    if (width < 1 || height < 1 || width > limit || height > limit)
        return gtx_fail(error, GTX_ERROR_LIMIT, "a framebuffer of %d x %d is not within 1..%d",
                        width, height, limit);
    gl->GenFramebuffers(1, &f.object);
    gl->GenRenderbuffers(1, &f.color);
    gl->GenRenderbuffers(1, &f.depth);
    gl->BindFramebuffer(GL_FRAMEBUFFER, f.object);
    gl->BindRenderbuffer(GL_RENDERBUFFER, f.color);
    gl->RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, f.color);
    gl->BindRenderbuffer(GL_RENDERBUFFER, f.depth);
    gl->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, f.depth);
    gl->BindRenderbuffer(GL_RENDERBUFFER, 0);
    if (gl->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        gtx_framebuffer_destroy(gl, &f);
        return gtx_fail(error, GTX_ERROR_GL, "a framebuffer of %d x %d is incomplete", width,
                        height);
    }
    gl->Viewport(0, 0, width, height);
    *out = f;
    return GTX_OK;
}

void gtx_framebuffer_destroy(const gtx_host_gl *gl, gtx_framebuffer *framebuffer)
{
    gl->DeleteFramebuffers(1, &framebuffer->object);
    gl->DeleteRenderbuffers(1, &framebuffer->color);
    gl->DeleteRenderbuffers(1, &framebuffer->depth);
    *framebuffer = (gtx_framebuffer){0};
}

void gtx_framebuffer_bind(const gtx_host_gl *gl, const gtx_framebuffer *framebuffer)
{
    gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer->object);
    gl->Viewport(0, 0, framebuffer->width, framebuffer->height);
}

/* OpenGL's first row is the bottom one, so rows are asked for one by one. */
static void read_rows(const gtx_host_gl *gl, const gtx_framebuffer *framebuffer, GLenum format,
                      GLenum type, uint8_t *out)
{
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer->object);
    gl->PixelStorei(GL_PACK_ALIGNMENT, 4);
    for (int y = framebuffer->height - 1; y >= 0; --y, out += (size_t)4 * framebuffer->width)
        gl->ReadPixels(0, y, framebuffer->width, 1, format, type, out);
}

void gtx_framebuffer_read_color(const gtx_host_gl *gl, const gtx_framebuffer *framebuffer,
                                uint8_t *pixels)
{
    read_rows(gl, framebuffer, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
}

void gtx_framebuffer_read_depth(const gtx_host_gl *gl, const gtx_framebuffer *framebuffer,
                                float *depth)
{
    read_rows(gl, framebuffer, GL_DEPTH_COMPONENT, GL_FLOAT, (uint8_t *)depth);
}

/* By a texture, which is copied upside down: its first row is the top one. */
gtx_result gtx_framebuffer_write_color(const gtx_host_gl *gl, const gtx_framebuffer *framebuffer,
                                       const uint8_t *pixels, gtx_error *error)
{
    const int w = framebuffer->width, h = framebuffer->height;
    GLuint texture, object;
    gl->GenTextures(1, &texture);
    gl->GenFramebuffers(1, &object);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_2D, texture);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, w, h, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, object);
    gl->FramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    const int whole = gl->CheckFramebufferStatus(GL_READ_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer->object);
    if (whole)
        gl->BlitFramebuffer(0, 0, w, h, 0, h, w, 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gtx_framebuffer_bind(gl, framebuffer);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->DeleteFramebuffers(1, &object);
    gl->DeleteTextures(1, &texture);
    return whole ? GTX_OK : gtx_fail(error, GTX_ERROR_GL, "a picture of %d x %d cannot be shown", w,
                                     h);
}

void gtx_average_down(uint8_t *pixels, int width, int height, int n)
{
    const size_t row = (size_t)4 * n * width;
    for (int i = 0; i < width * height; ++i) /* what is written is never read again */
        for (int c = 0; c < 4; ++c) {
            const uint8_t *from = pixels + i / width * n * row + (size_t)4 * n * (i % width) + c;
            int sum = 0;
            for (int k = 0; k < n * n; ++k)
                sum += from[k / n * row + (size_t)4 * (k % n)];
            pixels[(size_t)4 * i + c] = (uint8_t)((sum + n * n / 2) / (n * n));
        }
}
