/* Filling a caller's gtx_error. */
#ifndef GTX_BASE_ERROR_H
#define GTX_BASE_ERROR_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__MINGW32__) && !defined(__clang__) /* C's own formats, not those of msvcrt */
#define GTX_PRINTF(fmt, args) __attribute__((format(gnu_printf, fmt, args)))
#elif defined(__GNUC__)
#define GTX_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define GTX_PRINTF(fmt, args)
#endif

/* Fills `error` (NULL is fine) with result and printable message, and zeros elsewhere; returns
 * `result`: a failing function ends with `return gtx_fail(error, GTX_ERROR_..., "...")`. */
gtx_result gtx_fail(gtx_error *error, gtx_result result, const char *format, ...) GTX_PRINTF(3, 4);

/* Puts a ? for every byte of what a line of text must not have: controls, line breaks, marks that
 * turn the direction of text, and bytes that are no UTF-8. Paths and names may hold all of them. */
void gtx_make_printable(char *text);

/* GTX_ERROR_NOT_ZEROED unless the `count` words of a descriptor's reserved field are zero. */
gtx_result gtx_check_reserved(const uint32_t *reserved, size_t count, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
