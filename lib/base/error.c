/* Result sentences and the filling of gtx_error. */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>

uint32_t gtx_version(void)
{
    return GTX_VERSION;
}

const char *gtx_result_string(gtx_result result)
{
    switch (result) {
    case GTX_OK: return "no error";
    case GTX_CANCELLED: return "cancelled";
    case GTX_ERROR_ARGUMENT: return "an argument is NULL or out of range";
    case GTX_ERROR_NOT_ZEROED: return "a reserved field of a descriptor is not zero";
    case GTX_ERROR_MEMORY: return "out of memory";
    case GTX_ERROR_LIMIT: return "a limit is exceeded";
    case GTX_ERROR_READ: return "a file cannot be read";
    case GTX_ERROR_WRITE: return "a file cannot be written";
    case GTX_ERROR_NOT_GTX: return "not a .gtx file";
    case GTX_ERROR_VERSION: return "a .gtx file of an unknown version";
    case GTX_ERROR_TRUNCATED: return "the file ends too early";
    case GTX_ERROR_CORRUPT: return "a rule of the format is broken";
    case GTX_ERROR_UNSUPPORTED: return "not supported by this build";
    case GTX_ERROR_INPUT: return "the source model is malformed";
    case GTX_ERROR_EMPTY: return "the source model has no usable triangle";
    case GTX_ERROR_GL: return "OpenGL failed";
    case GTX_ERROR_SHADER: return "a shader did not compile";
    case GTX_ERROR_INTERNAL: return "internal error";
    }
    return "unknown result";
}

gtx_result gtx_fail(gtx_error *error, gtx_result result, const char *format, ...)
{
    if (!error)
        return result;
    *error = (gtx_error){.result = result};
    va_list args;
    va_start(args, format);
    vsnprintf(error->message, sizeof error->message, format, args);
    va_end(args);
    return result;
}

gtx_result gtx_check_reserved(const uint32_t *reserved, size_t count, gtx_error *error)
{
    for (size_t i = 0; i < count; ++i)
        if (reserved[i])
            return gtx_fail(error, GTX_ERROR_NOT_ZEROED,
                            "reserved field %zu of a descriptor is not zero", i);
    return GTX_OK;
}
