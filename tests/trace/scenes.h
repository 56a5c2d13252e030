/* Scenes of spheres and planes. */
#ifndef GTX_TESTS_SCENES_H
#define GTX_TESTS_SCENES_H

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

static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static inline double uniform(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static inline gtx_caster *caster_of(const gtx_asset *asset)
{
    gtx_caster *caster = NULL;
    assert_int_equal(gtx_caster_create(asset, NULL, &caster, NULL), GTX_OK);
    return caster;
}

static inline gtx_scene *scene_of(const gtx_scene_instance *instances, uint32_t count)
{
    gtx_scene *scene = NULL;
    gtx_error error = {0};
    if (gtx_scene_create(instances, count, NULL, &scene, &error))
        fail_msg("%s", error.message);
    return scene;
}

static inline gtx_scene_instance placed(const gtx_caster *caster, const float transform[16])
{
    gtx_scene_instance out = {.caster = caster};
    memcpy(out.transform, transform, sizeof out.transform);
    return out;
}

#endif
