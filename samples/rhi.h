/* A toy render hardware interface, as an engine has one, over OpenGL 4.2: buffers, textures,
 * pipelines, and a draw. It knows nothing of geotex. */
#ifndef RHI_H
#define RHI_H

#include <GL/glcorearb.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define RHI_GL(X)                                                                                 \
    X(PFNGLACTIVETEXTUREPROC, ActiveTexture) X(PFNGLATTACHSHADERPROC, AttachShader)               \
    X(PFNGLBINDBUFFERBASEPROC, BindBufferBase) X(PFNGLBINDBUFFERPROC, BindBuffer)                 \
    X(PFNGLBINDTEXTUREPROC, BindTexture) X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)             \
    X(PFNGLBUFFERDATAPROC, BufferData) X(PFNGLCOMPILESHADERPROC, CompileShader)                   \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram) X(PFNGLCREATESHADERPROC, CreateShader)               \
    X(PFNGLCULLFACEPROC, CullFace) X(PFNGLDISABLEPROC, Disable) X(PFNGLENABLEPROC, Enable)        \
    X(PFNGLDRAWELEMENTSINSTANCEDBASEVERTEXPROC, DrawElementsInstancedBaseVertex)                  \
    X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray)                                  \
    X(PFNGLFRONTFACEPROC, FrontFace) X(PFNGLGENBUFFERSPROC, GenBuffers)                           \
    X(PFNGLGENTEXTURESPROC, GenTextures) X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)             \
    X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog) X(PFNGLGETPROGRAMIVPROC, GetProgramiv)       \
    X(PFNGLLINKPROGRAMPROC, LinkProgram) X(PFNGLPIXELSTOREIPROC, PixelStorei)                     \
    X(PFNGLSHADERSOURCEPROC, ShaderSource) X(PFNGLTEXIMAGE2DPROC, TexImage2D)                     \
    X(PFNGLTEXIMAGE3DPROC, TexImage3D) X(PFNGLTEXPARAMETERIPROC, TexParameteri)                   \
    X(PFNGLUSEPROGRAMPROC, UseProgram) X(PFNGLVERTEXATTRIBDIVISORPROC, VertexAttribDivisor)       \
    X(PFNGLVERTEXATTRIBIPOINTERPROC, VertexAttribIPointer)                                        \
    X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)

typedef struct rhi {
#define RHI_FIELD(type, name) type name;
    RHI_GL(RHI_FIELD)
    GLuint vertex_array;
} rhi;

typedef void (*rhi_proc)(void);

static inline void rhi_create(rhi *r, rhi_proc (*load)(const char *name, void *user), void *user)
{
#define RHI_LOAD(type, name) r->name = (type)load("gl" #name, user);
    RHI_GL(RHI_LOAD)
    r->GenVertexArrays(1, &r->vertex_array);
}

/* Formats that this engine knows: how OpenGL stores a texel, and how it is told. */
typedef enum rhi_format {
    RHI_R8, RHI_RG8, RHI_RGBA8, RHI_RGB8_SRGB, RHI_RGBA8_SRGB, RHI_R8_UINT, RHI_R16_UINT,
    RHI_RGBA32_FLOAT
} rhi_format;

typedef struct rhi_texture_desc {
    rhi_format format;
    uint32_t width, height, layers, levels, is_array, is_filtered;
    const void *const *texels; /* a level each */
} rhi_texture_desc;

static inline GLuint rhi_texture(const rhi *r, const rhi_texture_desc *d)
{
    static const GLenum as[][3] = {{GL_R8, GL_RED, GL_UNSIGNED_BYTE},
                                   {GL_RG8, GL_RG, GL_UNSIGNED_BYTE},
                                   {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
                                   {GL_SRGB8, GL_RGB, GL_UNSIGNED_BYTE},
                                   {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE},
                                   {GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE},
                                   {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT},
                                   {GL_RGBA32F, GL_RGBA, GL_FLOAT}};
    const GLenum *f = as[d->format], target = d->is_array ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
    GLuint texture;
    r->GenTextures(1, &texture);
    r->BindTexture(target, texture);
    r->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (uint32_t k = 0; k < d->levels; ++k) {
        const GLsizei width = (GLsizei)(d->width >> k), height = (GLsizei)(d->height >> k);
        if (d->is_array)
            r->TexImage3D(target, (GLint)k, (GLint)f[0], width, height, (GLsizei)d->layers, 0,
                          f[1], f[2], d->texels[k]);
        else
            r->TexImage2D(target, (GLint)k, (GLint)f[0], width, height, 0, f[1], f[2],
                          d->texels[k]);
    }
    const GLint least = d->is_filtered ? GL_LINEAR_MIPMAP_NEAREST : GL_NEAREST;
    r->TexParameteri(target, GL_TEXTURE_MIN_FILTER, least);
    r->TexParameteri(target, GL_TEXTURE_MAG_FILTER, d->is_filtered ? GL_LINEAR : GL_NEAREST);
    r->TexParameteri(target, GL_TEXTURE_MAX_LEVEL, (GLint)d->levels - 1);
    r->TexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    r->TexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

/* Fills a buffer, which is made where it is 0. */
static inline void rhi_fill(const rhi *r, GLuint *buffer, const void *data, uint64_t size)
{
    if (!*buffer)
        r->GenBuffers(1, buffer);
    r->BindVertexArray(0);
    r->BindBuffer(GL_ARRAY_BUFFER, *buffer);
    r->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)size, data, GL_DYNAMIC_DRAW);
}

/* A program of texts that follow one another, or 0. */
static inline GLuint rhi_program(const rhi *r, const char *const *vertex, uint32_t vertex_count,
                                 const char *const *fragment, uint32_t fragment_count)
{
    const GLuint program = r->CreateProgram();
    const char *const *texts[2] = {vertex, fragment};
    const uint32_t counts[2] = {vertex_count, fragment_count};
    GLint linked = GL_FALSE;
    for (int i = 0; i < 2; ++i) {
        const GLuint shader = r->CreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        r->ShaderSource(shader, (GLsizei)counts[i], texts[i], NULL);
        r->CompileShader(shader);
        r->AttachShader(program, shader);
    }
    r->LinkProgram(program);
    r->GetProgramiv(program, GL_LINK_STATUS, &linked);
    char log[2048] = "";
    if (!linked)
        r->GetProgramInfoLog(program, sizeof log, NULL, log);
    if (!linked)
        fprintf(stderr, "%s\n", log);
    return linked ? program : 0;
}

/* An attribute: `type` is GL_FLOAT, or of whole numbers; a step an instance, or a vertex. */
static inline void rhi_attribute(const rhi *r, GLuint index, GLuint buffer, GLint size,
                                 GLenum type, GLsizei stride, uint64_t offset, GLuint divisor)
{
    const void *at = (const void *)(uintptr_t)offset;
    r->BindBuffer(GL_ARRAY_BUFFER, buffer);
    if (type == GL_FLOAT)
        r->VertexAttribPointer(index, size, type, GL_FALSE, stride, at);
    else
        r->VertexAttribIPointer(index, size, type, stride, at);
    r->VertexAttribDivisor(index, divisor);
    r->EnableVertexAttribArray(index);
}

#endif
