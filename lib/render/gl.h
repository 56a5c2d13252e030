/* The part of OpenGL 3.3 core and OpenGL ES 3.0 that the renderer uses: types, values and a table
 * of functions that the host's loader fills. No GL header is needed and no GL symbol is linked. */
#ifndef GTX_RENDER_GL_H
#define GTX_RENDER_GL_H

#include <geotex/render.h>
#include <stdbool.h>

#if defined(_WIN32) && !defined(_WIN64)
#define GTX_GL_CALL __stdcall
#else
#define GTX_GL_CALL
#endif

typedef unsigned int gl_enum, gl_uint, gl_bits;
typedef int gl_int, gl_size;
typedef unsigned char gl_bool;
typedef float gl_float;
typedef ptrdiff_t gl_pointer;

enum {
    GL_FALSE = 0,
    GL_TRUE = 1,
    GL_TRIANGLES = 0x0004,
    GL_LESS = 0x0201,
    GL_GREATER = 0x0204,
    GL_OUT_OF_MEMORY = 0x0505,
    GL_CW = 0x0900,
    GL_CCW = 0x0901,
    GL_CULL_FACE = 0x0B44,
    GL_CULL_FACE_MODE = 0x0B45,
    GL_FRONT = 0x0404,
    GL_BACK = 0x0405,
    GL_FRONT_FACE = 0x0B46,
    GL_DEPTH_TEST = 0x0B71,
    GL_SAMPLE_SHADING = 0x8C36,
    GL_DEPTH_WRITEMASK = 0x0B72,
    GL_DEPTH_FUNC = 0x0B74,
    GL_BLEND = 0x0BE2,
    GL_COLOR_WRITEMASK = 0x0C23,
    GL_UNPACK_SWAP_BYTES = 0x0CF0,
    GL_UNPACK_LSB_FIRST = 0x0CF1,
    GL_UNPACK_ROW_LENGTH = 0x0CF2,
    GL_UNPACK_SKIP_ROWS = 0x0CF3,
    GL_UNPACK_SKIP_PIXELS = 0x0CF4,
    GL_UNPACK_ALIGNMENT = 0x0CF5,
    GL_MAX_TEXTURE_SIZE = 0x0D33,
    GL_TEXTURE_2D = 0x0DE1,
    GL_UNSIGNED_BYTE = 0x1401,
    GL_UNSIGNED_SHORT = 0x1403,
    GL_UNSIGNED_INT = 0x1405,
    GL_FLOAT = 0x1406,
    GL_RED = 0x1903,
    GL_RGB = 0x1907,
    GL_RGBA = 0x1908,
    GL_NEAREST = 0x2600,
    GL_LINEAR = 0x2601,
    GL_NEAREST_MIPMAP_NEAREST = 0x2700,
    GL_LINEAR_MIPMAP_NEAREST = 0x2701,
    GL_TEXTURE_MAG_FILTER = 0x2800,
    GL_TEXTURE_MIN_FILTER = 0x2801,
    GL_TEXTURE_WRAP_S = 0x2802,
    GL_TEXTURE_WRAP_T = 0x2803,
    GL_TEXTURE_BINDING_2D = 0x8069,
    GL_UNPACK_SKIP_IMAGES = 0x806D,
    GL_UNPACK_IMAGE_HEIGHT = 0x806E,
    GL_RGBA8 = 0x8058,
    GL_CLAMP_TO_EDGE = 0x812F,
    GL_TEXTURE_BASE_LEVEL = 0x813C,
    GL_TEXTURE_MAX_LEVEL = 0x813D,
    GL_MAJOR_VERSION = 0x821B,
    GL_MINOR_VERSION = 0x821C,
    GL_NUM_EXTENSIONS = 0x821D,
    GL_DEBUG_SOURCE_THIRD_PARTY = 0x8249,
    GL_VENDOR = 0x1F00,
    GL_RENDERER = 0x1F01,
    GL_VERSION = 0x1F02,
    GL_EXTENSIONS = 0x1F03,
    GL_BUFFER = 0x82E0,
    GL_SHADER = 0x82E1,
    GL_PROGRAM = 0x82E2,
    GL_TEXTURE = 0x1702,
    GL_RG = 0x8227,
    GL_R8 = 0x8229,
    GL_RG8 = 0x822B,
    GL_TEXTURE0 = 0x84C0,
    GL_ACTIVE_TEXTURE = 0x84E0,
    GL_VERTEX_ARRAY = 0x8074,
    GL_VERTEX_ARRAY_BINDING = 0x85B5,
    GL_RGBA32F = 0x8814,
    GL_MAX_TEXTURE_BUFFER_SIZE = 0x8C2B,
    GL_TEXTURE_BUFFER = 0x8C2A,
    GL_TEXTURE_BINDING_BUFFER = 0x8C2C,
    GL_RGBA32UI = 0x8D70,
    GL_MAX_DRAW_BUFFERS = 0x8824,
    GL_ARRAY_BUFFER = 0x8892,
    GL_ELEMENT_ARRAY_BUFFER = 0x8893,
    GL_ARRAY_BUFFER_BINDING = 0x8894,
    GL_STREAM_DRAW = 0x88E0,
    GL_STATIC_DRAW = 0x88E4,
    GL_DYNAMIC_DRAW = 0x88E8,
    GL_PIXEL_UNPACK_BUFFER = 0x88EC,
    GL_MAX_ARRAY_TEXTURE_LAYERS = 0x88FF,
    GL_SAMPLER_BINDING = 0x8919,
    GL_FRAGMENT_SHADER = 0x8B30,
    GL_VERTEX_SHADER = 0x8B31,
    GL_COMPILE_STATUS = 0x8B81,
    GL_LINK_STATUS = 0x8B82,
    GL_CURRENT_PROGRAM = 0x8B8D,
    GL_TEXTURE_2D_ARRAY = 0x8C1A,
    GL_TEXTURE_BINDING_2D_ARRAY = 0x8C1D,
    GL_SRGB8 = 0x8C41,
    GL_SRGB8_ALPHA8 = 0x8C43,
    GL_COMPRESSED_SRGB_S3TC_DXT1 = 0x8C4C,
    GL_R8UI = 0x8232,
    GL_R16UI = 0x8234,
    GL_RGBA16UI = 0x8D76,
    GL_COMPRESSED_RG_RGTC2 = 0x8DBD,
    GL_COMPRESSED_RGBA_BPTC_UNORM = 0x8E8C,
    GL_COMPRESSED_SRGB_ALPHA_BPTC_UNORM = 0x8E8D,
    GL_COMPRESSED_RG11_EAC = 0x9272,
    GL_COMPRESSED_SRGB8_ETC2 = 0x9275,
    GL_COMPRESSED_RGBA8_ETC2_EAC = 0x9278,
    GL_COMPRESSED_SRGB8_ALPHA8_ETC2_EAC = 0x9279,
    GL_RED_INTEGER = 0x8D94,
    GL_RGBA8UI = 0x8D7C,
    GL_RGBA_INTEGER = 0x8D99
};

/* result, name, parameters */
#define GTX_GL(X)                                                                                  \
    X(void, ActiveTexture, (gl_enum unit))                                                         \
    X(void, AttachShader, (gl_uint program, gl_uint shader))                                       \
    X(void, BindBuffer, (gl_enum target, gl_uint buffer))                                          \
    X(void, BindSampler, (gl_uint unit, gl_uint sampler))                                          \
    X(void, BindTexture, (gl_enum target, gl_uint texture))                                        \
    X(void, BindVertexArray, (gl_uint array))                                                      \
    X(void, BufferData, (gl_enum target, gl_pointer size, const void *data, gl_enum usage))        \
    X(void, BufferSubData,                                                                         \
      (gl_enum target, gl_pointer offset, gl_pointer size, const void *data))                      \
    X(void, ColorMask, (gl_bool r, gl_bool g, gl_bool b, gl_bool a))                               \
    X(void, CompileShader, (gl_uint shader))                                                       \
    X(gl_uint, CreateProgram, (void))                                                              \
    X(gl_uint, CreateShader, (gl_enum stage))                                                      \
    X(void, CullFace, (gl_enum mode))                                                              \
    X(void, DeleteBuffers, (gl_size count, const gl_uint *buffers))                                \
    X(void, DeleteProgram, (gl_uint program))                                                      \
    X(void, DeleteShader, (gl_uint shader))                                                        \
    X(void, DeleteTextures, (gl_size count, const gl_uint *textures))                              \
    X(void, DeleteVertexArrays, (gl_size count, const gl_uint *arrays))                            \
    X(void, DepthFunc, (gl_enum func))                                                             \
    X(void, DepthMask, (gl_bool mask))                                                             \
    X(void, Disable, (gl_enum cap))                                                                \
    X(void, DrawElementsInstanced,                                                                 \
      (gl_enum mode, gl_size count, gl_enum type, const void *indices, gl_size instances))         \
    X(void, DrawRangeElements,                                                                     \
      (gl_enum mode, gl_uint first, gl_uint last, gl_size count, gl_enum type,                     \
       const void *indices))                                                                       \
    X(void, Enable, (gl_enum cap))                                                                 \
    X(void, EnableVertexAttribArray, (gl_uint index))                                              \
    X(void, FrontFace, (gl_enum mode))                                                             \
    X(void, GenBuffers, (gl_size count, gl_uint *buffers))                                         \
    X(void, GenTextures, (gl_size count, gl_uint *textures))                                       \
    X(void, GenVertexArrays, (gl_size count, gl_uint *arrays))                                     \
    X(void, GetBooleanv, (gl_enum name, gl_bool *values))                                          \
    X(gl_enum, GetError, (void))                                                                   \
    X(void, GetIntegerv, (gl_enum name, gl_int *values))                                           \
    X(void, GetProgramInfoLog, (gl_uint program, gl_size size, gl_size *length, char *log))        \
    X(void, GetProgramiv, (gl_uint program, gl_enum name, gl_int *value))                          \
    X(void, GetShaderInfoLog, (gl_uint shader, gl_size size, gl_size *length, char *log))          \
    X(const gl_bool *, GetString, (gl_enum name))                                                  \
    X(const gl_bool *, GetStringi, (gl_enum name, gl_uint index))                                  \
    X(void, GetShaderiv, (gl_uint shader, gl_enum name, gl_int *value))                            \
    X(gl_int, GetUniformLocation, (gl_uint program, const char *name))                             \
    X(gl_bool, IsEnabled, (gl_enum cap))                                                           \
    X(void, LinkProgram, (gl_uint program))                                                        \
    X(void, PixelStorei, (gl_enum name, gl_int value))                                             \
    X(void, ShaderSource,                                                                          \
      (gl_uint shader, gl_size count, const char *const *texts, const gl_int *lengths))            \
    X(void, TexImage2D,                                                                            \
      (gl_enum target, gl_int level, gl_int inner, gl_size width, gl_size height, gl_int border,   \
       gl_enum format, gl_enum type, const void *pixels))                                          \
    X(void, TexImage3D,                                                                            \
      (gl_enum target, gl_int level, gl_int inner, gl_size width, gl_size height, gl_size depth,   \
       gl_int border, gl_enum format, gl_enum type, const void *pixels))                           \
    X(void, TexParameteri, (gl_enum target, gl_enum name, gl_int value))                           \
    X(void, TexSubImage2D,                                                                         \
      (gl_enum target, gl_int level, gl_int x, gl_int y, gl_size width, gl_size height,            \
       gl_enum format, gl_enum type, const void *pixels))                                          \
    X(void, TexSubImage3D,                                                                         \
      (gl_enum target, gl_int level, gl_int x, gl_int y, gl_int z, gl_size width, gl_size height,  \
       gl_size depth, gl_enum format, gl_enum type, const void *pixels))                           \
    X(void, Uniform1i, (gl_int location, gl_int value))                                            \
    X(void, Uniform4fv, (gl_int location, gl_size count, const gl_float *values))                  \
    X(void, UniformMatrix4fv,                                                                      \
      (gl_int location, gl_size count, gl_bool transpose, const gl_float *values))                 \
    X(void, UseProgram, (gl_uint program))                                                         \
    X(void, VertexAttribDivisor, (gl_uint index, gl_uint divisor))                                 \
    X(void, VertexAttribIPointer,                                                                  \
      (gl_uint index, gl_int size, gl_enum type, gl_size stride, const void *offset))              \
    X(void, VertexAttribPointer,                                                                   \
      (gl_uint index, gl_int size, gl_enum type, gl_bool normalized, gl_size stride,               \
       const void *offset))

/* State of one draw buffer: NULL on OpenGL ES before 3.2, where all draw buffers share it. */
#define GTX_GL_INDEXED(X)                                                                          \
    X(void, ColorMaski, (gl_uint index, gl_bool r, gl_bool g, gl_bool b, gl_bool a))               \
    X(void, Disablei, (gl_enum cap, gl_uint index))                                                \
    X(void, Enablei, (gl_enum cap, gl_uint index))                                                 \
    X(void, GetBooleani_v, (gl_enum name, gl_uint index, gl_bool *values))                         \
    X(gl_bool, IsEnabledi, (gl_enum cap, gl_uint index))

/* Names for debuggers (KHR_debug, OpenGL 4.3, OpenGL ES 3.2): NULL where the context has none. */
#define GTX_GL_DEBUG(X)                                                                         \
    X(void, ObjectLabel, (gl_enum kind, gl_uint object, gl_size length, const char *label))        \
    X(void, PopDebugGroup, (void))                                                                 \
    X(void, PushDebugGroup, (gl_enum source, gl_uint id, gl_size length, const char *message))

/* Several draws in one call: of OpenGL, of OpenGL ES with EXT_multi_draw_arrays, of WebGL 2 with
 * WEBGL_multi_draw. */
#define GTX_GL_MULTI(X)                                                                            \
    X(void, MultiDrawElements,                                                                     \
      (gl_enum mode, const gl_size *counts, gl_enum type, const void *const *offsets,              \
       gl_size draws))

/* Casting by tiles: of OpenGL. All are NULL where it is not to be used. */
#define GTX_GL_TILES(X)                                                                            \
    X(void, DrawArrays, (gl_enum mode, gl_int first, gl_size count))                               \
    X(void, TexBuffer, (gl_enum target, gl_enum inner, gl_uint buffer))                            \
    X(void, Uniform1ui, (gl_int location, gl_uint value))

/* Fragments once a sample: OpenGL 4.0, OpenGL ES 3.2, or extensions. NULL where there is none. */
#define GTX_GL_SAMPLES(X) X(void, MinSampleShading, (float share))

/* Blocks of texels: where the context reads BC7 or ETC2. NULL where it does not. */
#define GTX_GL_BLOCKS(X)                                                                           \
    X(void, CompressedTexSubImage3D,                                                               \
      (gl_enum target, gl_int level, gl_int x, gl_int y, gl_int z, gl_size width, gl_size height,  \
       gl_size depth, gl_enum format, gl_size bytes, const void *blocks))                          \
    X(void, TexStorage3D,                                                                          \
      (gl_enum target, gl_size levels, gl_enum inner, gl_size width, gl_size height,               \
       gl_size depth))

typedef struct gtx_gl {
#define GTX_GL_FIELD(result, name, parameters) result(GTX_GL_CALL *name) parameters;
    GTX_GL(GTX_GL_FIELD)
    GTX_GL_INDEXED(GTX_GL_FIELD)
    GTX_GL_DEBUG(GTX_GL_FIELD)
    GTX_GL_MULTI(GTX_GL_FIELD)
    GTX_GL_TILES(GTX_GL_FIELD)
    GTX_GL_SAMPLES(GTX_GL_FIELD)
    GTX_GL_BLOCKS(GTX_GL_FIELD)
#undef GTX_GL_FIELD
    bool es;                  /* OpenGL ES */
    const char *glsl;         /* the first line of shaders */
    bool reads[GTX_COMPRESS_ETC2 + 1]; /* kinds of blocks */
} gtx_gl;

/* Labels an object, where the context takes labels. */
static inline void gtx_gl_label(const gtx_gl *gl, gl_enum kind, gl_uint object, const char *label)
{
    if (gl->ObjectLabel)
        gl->ObjectLabel(kind, object, -1, label);
}

/* Whether the driver draws on the CPU. */
bool gtx_gl_is_software(const gtx_gl *gl);
/* Errors: GL, which names the first missing function, or the version below 3.3 (OpenGL ES: 3.0). */
gtx_result gtx_gl_init(gtx_gl *gl, const gtx_renderer_desc *desc, gtx_error *error);

/* A place in the bound buffer, as OpenGL takes it. */
static inline const void *gtx_gl_offset(uint64_t offset)
{
    return (const void *)(uintptr_t)offset;
}

#endif
