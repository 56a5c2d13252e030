/* Assets whose levels and bounds are known. */
#ifndef GTX_TESTS_RAMPS_H
#define GTX_TESTS_RAMPS_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "common/counter.h"
#include "common/fixture.h"
#include "derive/derive.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A height field given by a string of digits a row: '0' is empty, n is code 1 + n. */
typedef struct picture {
    const char *rows[8];
} picture;

static inline void picture_field(const gtx_patch *patch, double x, double y, const void *user,
                                 fixture_texel *out)
{
    const picture *p = user;
    (void)patch;
    int digit = p->rows[(int)y][(int)x] - '0';
    out->height = digit ? digit / 254.0 : -1;
    out->trim = -1;
}

static inline gtx_asset *make(const picture *p, uint32_t width, uint32_t height)
{
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, width, height, 1, 8), picture_field, p};
    return fixture_build(&patch, 1, 8, 1);
}

static const picture RAGGED = {{"9900011", //
                                "9990011", //
                                "0990000", //
                                "0000300", //
                                "5500000"}};

#endif
