/* Fills the renderer's table of OpenGL functions. */
#include "render/gl.h"

#include "base/error.h"

#include <stdbool.h>
#include <string.h>

/* A loader may answer for functions that the context does not have: the context is asked. */
static bool has_debug(const gtx_gl *gl, gl_int major, gl_int minor)
{
    gl_int count = 0;
    if (major > 4 || (major == 4 && minor >= 3))
        return true;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (gl_int i = 0; i < count; ++i) {
        const char *name = (const char *)gl->GetStringi(GL_EXTENSIONS, (gl_uint)i);
        if (name && !strcmp(name, "GL_KHR_debug"))
            return true;
    }
    return false;
}

gtx_result gtx_gl_init(gtx_gl *gl, const gtx_renderer_desc *desc, gtx_error *error)
{
#define LOAD(result, name, parameters)                                                             \
    gl->name = (result(GTX_GL_CALL *) parameters)desc->load("gl" #name, desc->load_user);          \
    if (!gl->name)                                                                                 \
        return gtx_fail(error, GTX_ERROR_GL, "the OpenGL loader does not know gl" #name);
    GTX_GL(LOAD)
#undef LOAD
    gl_int major = 0, minor = 0;
    gl->GetIntegerv(GL_MAJOR_VERSION, &major);
    gl->GetIntegerv(GL_MINOR_VERSION, &minor);
    if (major < 3 || (major == 3 && minor < 3))
        return gtx_fail(error, GTX_ERROR_GL, "OpenGL 3.3 is needed and the context is %d.%d", major,
                        minor);
    if (has_debug(gl, major, minor)) {
#define LOAD_OPTIONAL(result, name, parameters)                                                    \
    gl->name = (result(GTX_GL_CALL *) parameters)desc->load("gl" #name, desc->load_user);
        GTX_GL_OPTIONAL(LOAD_OPTIONAL)
#undef LOAD_OPTIONAL
    }
    return GTX_OK;
}
