/* Textures as attachments of a framebuffer. */
#include "host/target.h"

#include "base/error.h"

static GLuint create_texture(const gtx_host_gl *gl, GLenum inner, int width, int height)
{
    static const struct {
        GLenum inner, format, type;
    } kinds[] = {{GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
                 {GL_RGB10_A2, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV},
                 {GL_RGBA16F, GL_RGBA, GL_FLOAT},
                 {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT},
                 {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT}};
    GLuint texture;
    gl->GenTextures(1, &texture);
    gl->BindTexture(GL_TEXTURE_2D, texture);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i)
        if (kinds[i].inner == inner)
            gl->TexImage2D(GL_TEXTURE_2D, 0, (GLint)inner, width, height, 0, kinds[i].format,
                           kinds[i].type, NULL);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    return texture;
}

gtx_result gtx_target_create(const gtx_host_gl *gl, int width, int height, const GLenum *formats,
                             gtx_target *out, gtx_error *error)
{
    gtx_target t = {.width = width, .height = height};
    GLenum buffers[GTX_TARGET_COLORS];
    GLsizei count = 0;
    gl->GenFramebuffers(1, &t.object);
    gl->BindFramebuffer(GL_FRAMEBUFFER, t.object);
    for (; count < GTX_TARGET_COLORS && formats && formats[count]; ++count) {
        buffers[count] = GL_COLOR_ATTACHMENT0 + (GLenum)count;
        t.colors[count] = create_texture(gl, formats[count], width, height);
        gl->FramebufferTexture2D(GL_FRAMEBUFFER, buffers[count], GL_TEXTURE_2D, t.colors[count], 0);
    }
    t.depth = create_texture(gl, GL_DEPTH_COMPONENT32F, width, height);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, t.depth, 0);
    gl->DrawBuffers(count, buffers);
    if (count == 0)
        gl->ReadBuffer(GL_NONE); /* OpenGL 3.3 calls it incomplete otherwise */
    if (gl->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        gtx_target_destroy(gl, &t);
        return gtx_fail(error, GTX_ERROR_GL, "a framebuffer of %d x %d textures is incomplete",
                        width, height);
    }
    gl->Viewport(0, 0, width, height);
    *out = t;
    return GTX_OK;
}

void gtx_target_destroy(const gtx_host_gl *gl, gtx_target *target)
{
    gl->DeleteFramebuffers(1, &target->object);
    gl->DeleteTextures(GTX_TARGET_COLORS, target->colors);
    gl->DeleteTextures(1, &target->depth);
    *target = (gtx_target){0};
}

gtx_result gtx_target_fit(const gtx_host_gl *gl, const GLenum *formats, gtx_target *target,
                          GLuint *bound, gtx_error *error)
{
    GLint name, frame[4];
    gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &name);
    gl->GetIntegerv(GL_VIEWPORT, frame);
    *bound = (GLuint)name;
    if (target->object && target->width == frame[2] && target->height == frame[3])
        return GTX_OK;
    gtx_target_destroy(gl, target);
    gtx_result result = gtx_target_create(gl, frame[2], frame[3], formats, target, error);
    gl->BindFramebuffer(GL_FRAMEBUFFER, *bound);
    return result;
}

void gtx_target_begin(const gtx_host_gl *gl, const gtx_target *target)
{
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->object);
    gl->Viewport(0, 0, target->width, target->height);
    gl->DepthMask(GL_TRUE);
    gl->ClearColor(0, 0, 0, 0);
    gl->ClearDepthf(1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_LESS);
}
