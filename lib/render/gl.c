/* Fills the renderer's table of OpenGL functions. */
#include "render/gl.h"

#include "base/error.h"

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
    return GTX_OK;
}
