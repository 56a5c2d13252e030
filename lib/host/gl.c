/* Fills the host's table of OpenGL functions. */
#include "host/gl.h"

#include "base/error.h"

gtx_result gtx_host_gl_init(gtx_host_gl *gl, gtx_host_load load, void *user, gtx_error *error)
{
#define LOAD(type, name)                                                                           \
    gl->name = (type)load("gl" #name, user);                                                       \
    if (!gl->name)                                                                                 \
        return gtx_fail(error, GTX_ERROR_GL, "the context has no gl" #name);
    GTX_HOST_GL(LOAD)
#undef LOAD
    return GTX_OK;
}
