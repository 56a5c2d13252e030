/* Limits on what a call may use for untrusted files. */
#ifndef GTX_BASE_LIMITS_H
#define GTX_BASE_LIMITS_H

#include "base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The fields of gtx_limits. */
typedef enum gtx_limited {
    GTX_LIMITED_MEMORY,
    GTX_LIMITED_TRIANGLES,
    GTX_LIMITED_TEXELS,
    GTX_LIMITED_PIXELS,
    GTX_LIMITED_PATCHES,
    GTX_LIMITED_CELLS,
    GTX_LIMITED_WORK,
    GTX_LIMITED_COUNT
} gtx_limited;

/* NOT_ZEROED unless the reserved fields are zero. */
gtx_result gtx_check_limits(const gtx_limits *limits, gtx_error *error);

/* The number that a field allows a call that has read so many bytes. `limits` may be NULL. */
uint64_t gtx_limit_of(const gtx_limits *limits, gtx_limited which, uint64_t bytes_read);

/* Fills `error` for `what` that would take `wanted` where `allowed` is allowed: "the image 'a.png'
 * takes 1000 pixels, more than the 100 allowed". Returns LIMIT. */
gtx_result gtx_fail_limit(gtx_error *error, gtx_limited which, const char *what, uint64_t wanted,
                          uint64_t allowed);

#ifdef __cplusplus
}
#endif
#endif
