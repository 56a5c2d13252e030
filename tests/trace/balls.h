/* Balls, ramps and rays that the tests of casting share. */
#ifndef GTX_TESTS_BALLS_H
#define GTX_TESTS_BALLS_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "common/counter.h"
#include "common/fixture.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static inline double uniform(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static inline void direction(uint64_t *seed, float out[3])
{
    double z = 2 * uniform(seed) - 1, a = 6.283185307179586 * uniform(seed), r = sqrt(1 - z * z);
    out[0] = (float)(r * cos(a));
    out[1] = (float)(r * sin(a));
    out[2] = (float)z;
}

static inline gtx_caster *caster_of(const gtx_asset *asset, uint32_t level)
{
    gtx_caster *caster = NULL;
    assert_int_equal(
        gtx_caster_create(asset, &(gtx_caster_desc){.level = level}, &caster, NULL), GTX_OK);
    return caster;
}

static inline gtx_hit cast(const gtx_caster *caster, gtx_ray ray, uint32_t flags)
{
    gtx_hit hit;
    assert_int_equal(gtx_raycast(caster, &ray, &hit, 1, flags), GTX_OK);
    return hit;
}

/* A ray from near the asset's bounds towards a point in them. */
static inline gtx_ray random_ray(const gtx_info *info, uint64_t *seed)
{
    gtx_ray ray = {.t_max = 0};
    float size = 0;
    for (int k = 0; k < 3; ++k)
        size = fmaxf(size, info->bounds_max[k] - info->bounds_min[k]);
    float away[3];
    direction(seed, away);
    double distance = 2 * uniform(seed) * size;
    for (int k = 0; k < 3; ++k) {
        float at = info->bounds_min[k] +
                   (float)uniform(seed) * (info->bounds_max[k] - info->bounds_min[k]);
        ray.origin[k] = at + away[k] * (float)distance;
        ray.direction[k] = -away[k];
    }
    return ray;
}

#endif
