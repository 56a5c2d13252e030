/* Result sentences, the filling of gtx_error, and text fit for a line of a terminal. */
#include "base/error.h"

#include <stdarg.h>
#include <stdbool.h>
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

/* Bytes of the UTF-8 character at `text`, which ends in a 0; 0 for what is none. */
static size_t character_size(const unsigned char *text, uint32_t *code)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const size_t size = *text < 0x80 ? 1 : *text >> 5 == 6 ? 2 : *text >> 4 == 14 ? 3
                        : *text >> 3 == 30 ? 4 : 0;
    *code = size > 1 ? *text & (0x7fu >> size) : *text;
    for (size_t i = 1; i < size; ++i) {
        if (text[i] >> 6 != 2)
            return 0;
        *code = *code << 6 | (text[i] & 0x3fu);
    }
    const bool is_half = *code >= 0xd800 && *code < 0xe000;
    return size && *code >= least[size] && *code <= 0x10ffff && !is_half ? size : 0;
}

/* Controls, and what breaks or turns a line. */
static bool is_printable(uint32_t code)
{
    return code >= 0x20 && (code < 0x7f || code >= 0xa0) && !(code >= 0x2028 && code <= 0x202e) &&
           !(code >= 0x2066 && code <= 0x2069);
}

void gtx_make_printable(char *text)
{
    uint32_t code;
    for (unsigned char *at = (unsigned char *)text; *at;) {
        const size_t size = character_size(at, &code);
        const bool keeps = size && is_printable(code);
        for (size_t i = 0; i < size && !keeps; ++i)
            at[i] = '?';
        if (!size)
            *at = '?';
        at += size ? size : 1;
    }
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
    gtx_make_printable(error->message);
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
