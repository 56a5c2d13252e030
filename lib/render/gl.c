/* Fills the renderer's table of OpenGL functions. */
#include "render/gl.h"

#include "base/error.h"

#include <stdio.h>
#include <string.h>

static bool has_extension(const gtx_gl *gl, const char *wanted)
{
    gl_int count = 0;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (gl_int i = 0; i < count; ++i) {
        const char *name = (const char *)gl->GetStringi(GL_EXTENSIONS, (gl_uint)i);
        if (name && !strcmp(name, wanted))
            return true;
    }
    return false;
}

static gtx_result load_required(gtx_gl *gl, const gtx_renderer_desc *desc, gtx_error *error)
{
#define LOAD(result, name, parameters)                                                             \
    gl->name = (result(GTX_GL_CALL *) parameters)desc->load("gl" #name, desc->load_user);          \
    if (!gl->name)                                                                                 \
        return gtx_fail(error, GTX_ERROR_GL, "the OpenGL loader does not know gl" #name);
    GTX_GL(LOAD)
    return GTX_OK;
}

static gtx_result load_indexed(gtx_gl *gl, const gtx_renderer_desc *desc, gtx_error *error)
{
    GTX_GL_INDEXED(LOAD)
#undef LOAD
    return GTX_OK;
}

/* OpenGL ES names the functions of an extension after it. */
static void load_debug(gtx_gl *gl, const gtx_renderer_desc *desc, const char *suffix)
{
    char text[64];
#define LOAD(result, name, parameters)                                                             \
    snprintf(text, sizeof text, "gl" #name "%s", suffix);                                          \
    gl->name = (result(GTX_GL_CALL *) parameters)desc->load(text, desc->load_user);
    GTX_GL_DEBUG(LOAD)
}

static void load_multi(gtx_gl *gl, const gtx_renderer_desc *desc, const char *suffix)
{
    char text[64];
    GTX_GL_MULTI(LOAD)
}

static void load_samples(gtx_gl *gl, const gtx_renderer_desc *desc, const char *suffix)
{
    char text[64];
    GTX_GL_SAMPLES(LOAD)
#undef LOAD
}

bool gtx_gl_is_software(const gtx_gl *gl)
{
    static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "SwiftShader"};
    const char *name = (const char *)gl->GetString(GL_RENDERER);
    for (size_t i = 0; name && i < sizeof names / sizeof *names; ++i)
        if (strstr(name, names[i]))
            return true;
    return false;
}

/* Casting by tiles has been measured with llvmpipe alone, where it takes half the time of
 * fragments; other drivers get it when the host asks. */
static bool wants_tiles(const gtx_gl *gl, const gtx_renderer_desc *desc)
{
    const char *name = (const char *)gl->GetString(GL_RENDERER);
    return desc->tiles == GTX_TILES_ALWAYS ||
           (desc->tiles == GTX_TILES_AUTO && name && strstr(name, "llvmpipe"));
}

/* All or none. */
static void load_tiles(gtx_gl *gl, const gtx_renderer_desc *desc)
{
    bool whole = true;
#define LOAD(result, name, parameters)                                                             \
    gl->name = (result(GTX_GL_CALL *) parameters)desc->load("gl" #name, desc->load_user);          \
    whole = whole && gl->name;
    GTX_GL_TILES(LOAD)
#undef LOAD
#define CLEAR(result, name, parameters) gl->name = NULL;
    if (!whole) {
        GTX_GL_TILES(CLEAR)
    }
#undef CLEAR
}

/* Which blocks are read, and the functions for them. WebGL says so by extensions of its own. */
static void load_blocks(gtx_gl *gl, const gtx_renderer_desc *desc, gl_int have)
{
    const char *version = (const char *)gl->GetString(GL_VERSION);
    const bool web = gl->es && strstr(version, "WebGL") != NULL;
    const bool bc7 = gl->es ? has_extension(gl, "GL_EXT_texture_compression_bptc")
                            : have >= 42 || has_extension(gl, "GL_ARB_texture_compression_bptc");
    const bool bc1 = web      ? has_extension(gl, "GL_WEBGL_compressed_texture_s3tc_srgb")
                     : gl->es ? has_extension(gl, "GL_EXT_texture_compression_s3tc_srgb")
                              : has_extension(gl, "GL_EXT_texture_compression_s3tc") &&
                                    has_extension(gl, "GL_EXT_texture_sRGB");
    const bool bc5 = !gl->es || has_extension(gl, "GL_EXT_texture_compression_rgtc");
    const bool etc2 = web ? has_extension(gl, "GL_WEBGL_compressed_texture_etc")
                          : gl->es || have >= 43 || has_extension(gl, "GL_ARB_ES3_compatibility");
    bool whole = true;
#define LOAD(result, name, parameters)                                                             \
    gl->name = (result(GTX_GL_CALL *) parameters)desc->load("gl" #name, desc->load_user);          \
    whole = whole && gl->name;
    if (gl->es || have >= 42 || has_extension(gl, "GL_ARB_texture_storage")) {
        GTX_GL_BLOCKS(LOAD)
    } else {
        whole = false;
    }
#undef LOAD
    gl->reads[GTX_COMPRESS_BC] = whole && bc7 && bc5 && bc1;
    gl->reads[GTX_COMPRESS_ETC2] = whole && etc2;
}

/* A loader may answer for functions that the context does not have: the context is asked. */
gtx_result gtx_gl_init(gtx_gl *gl, const gtx_renderer_desc *desc, gtx_error *error)
{
    gtx_result result = load_required(gl, desc, error);
    if (result)
        return result;
    const char *version = (const char *)gl->GetString(GL_VERSION);
    gl_int major = 0, minor = 0;
    gl->es = version && !strncmp(version, "OpenGL ES", 9);
    gl->GetIntegerv(GL_MAJOR_VERSION, &major);
    gl->GetIntegerv(GL_MINOR_VERSION, &minor);
    const gl_int have = 10 * major + minor;
    if (have < (gl->es ? 30 : 33))
        return gtx_fail(error, GTX_ERROR_GL, "OpenGL 3.3 or OpenGL ES 3.0 is needed and the context"
                                             " is %s %d.%d", gl->es ? "OpenGL ES" : "OpenGL", major,
                        minor);
    gl->glsl = !gl->es      ? "#version 330 core\n"
               : have >= 31 ? "#version 310 es\n" /* which gathers */
                            : "#version 300 es\n";
    if (!gl->es || have >= 32)
        result = load_indexed(gl, desc, error);
    if (have >= (gl->es ? 32 : 43))
        load_debug(gl, desc, "");
    else if (has_extension(gl, "GL_KHR_debug"))
        load_debug(gl, desc, gl->es ? "KHR" : "");
    if (!gl->es || has_extension(gl, "GL_EXT_multi_draw_arrays"))
        load_multi(gl, desc, gl->es ? "EXT" : "");
    else if (has_extension(gl, "GL_WEBGL_multi_draw"))
        load_multi(gl, desc, "WEBGL");
    if (have >= (gl->es ? 32 : 40))
        load_samples(gl, desc, "");
    else if (has_extension(gl, gl->es ? "GL_OES_sample_shading" : "GL_ARB_sample_shading"))
        load_samples(gl, desc, gl->es ? "OES" : "ARB");
    if (!gl->es && wants_tiles(gl, desc))
        load_tiles(gl, desc);
    load_blocks(gl, desc, have);
    return result;
}
