/* Default limits, and the error of an exceeded one. */
#include "base/limits.h"

#include <inttypes.h>

/* A default: a number, and more for each byte read. Of the models measured, terrain in Draco takes
 * most for a byte: 1.72 triangles and 390 bytes of memory (2.88 million triangles in 1.67 MB). With
 * half the triangles it would be refused; with double, a megabyte could take 12 s of processor. Of
 * work an engine of 82 nodes takes most, 165 million steps in 0.24 MB: with half it would be
 * refused. A step is some 40 ns, so a megabyte of noise is refused after 10 s; with double, 20. */
static const struct {
    const char *name, *unit;
    uint64_t least;
    double per_byte;
} fields[GTX_LIMITED_COUNT] = {
    {"memory", "bytes of memory", (uint64_t)256 << 20, 2000},
    {"triangles", "triangles", (uint64_t)1 << 19, 1.5},
    {"texels", "texels", (uint64_t)1 << 26, 256},
    {"pixels", "pixels", (uint64_t)1 << 26, 16},
    {"patches", "patches", (uint64_t)1 << 20, 0},
    {"cells", "cells", (uint64_t)1 << 19, 0},
    {"work", "steps of work", (uint64_t)3 << 26, 32},
};

gtx_result gtx_check_limits(const gtx_limits *limits, gtx_error *error)
{
    return gtx_check_reserved(limits->reserved, sizeof limits->reserved / sizeof(uint32_t), error);
}

uint64_t gtx_limit_of(const gtx_limits *limits, gtx_limited which, uint64_t bytes_read)
{
    static const gtx_limits none = {0};
    const gtx_limits *l = limits ? limits : &none;
    const uint64_t given[GTX_LIMITED_COUNT] = {l->memory, l->triangles, l->texels, l->pixels,
                                               l->patches, l->cells, l->work};
    if (given[which])
        return given[which];
    const double sum = (double)fields[which].least + fields[which].per_byte * (double)bytes_read;
    return sum < 1e18 ? (uint64_t)sum : UINT64_MAX;
}

gtx_result gtx_fail_limit(gtx_error *error, gtx_limited which, const char *what, uint64_t wanted,
                          uint64_t allowed)
{
    gtx_fail(error, GTX_ERROR_LIMIT, "%.100s takes %" PRIu64 " %s, more than the %" PRIu64
             " allowed", what, wanted, fields[which].unit, allowed);
    if (error)
        error->limit = fields[which].name;
    return GTX_ERROR_LIMIT;
}
