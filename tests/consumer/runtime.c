/* A stranger's program with the runtime alone, in C and in C++: opens an asset and casts rays at
 * it. DROPPED: with the headers that lie beside geotex.c. */
#ifdef DROPPED
#include "geotex_gl.h"
#else
#include <geotex/edit.h>
#include <geotex/geotex.h>
#include <geotex/render.h>
#include <geotex/solid.h>
#include <geotex/stream.h>
#endif

#include <stdio.h>
#include <string.h>

static int fail(const char *what, const gtx_error *error)
{
    fprintf(stderr, "%s: %s\n", what, error->message);
    return 1;
}

int main(int argc, char **argv)
{
    enum { SIDE = 16 };
    gtx_error error;
    gtx_asset *asset = NULL;
    gtx_caster *caster = NULL;
    gtx_info info;
    int i, k;
    if (argc != 2)
        return 2;
    if (gtx_version() != GTX_VERSION || !gtx_shader_source("geotex_cast.glsl"))
        return 3;
    if (gtx_open_file(argv[1], NULL, &asset, &error) != GTX_OK)
        return fail(argv[1], &error);
    gtx_get_info(asset, &info);
    if (gtx_caster_create(asset, NULL, &caster, &error) != GTX_OK)
        return fail("caster", &error);
    printf("%u patches\n", (unsigned)info.patch_count);
    for (i = 0; i < SIDE * SIDE; ++i) {
        gtx_ray ray;
        gtx_hit hit;
        memset(&ray, 0, sizeof ray);
        for (k = 0; k < 2; ++k) {
            float share = ((float)(k ? i / SIDE : i % SIDE) + 0.5f) / SIDE;
            ray.origin[k] = info.bounds_min[k] + share * (info.bounds_max[k] - info.bounds_min[k]);
        }
        ray.origin[2] = info.bounds_max[2] + 1;
        ray.direction[2] = -1;
        gtx_raycast(caster, &ray, &hit, 1, 0);
        printf("%.9g %.9g %.9g %.9g\n", (double)hit.t, (double)hit.normal[0],
               (double)hit.normal[1], (double)hit.normal[2]);
    }
    gtx_caster_destroy(caster);
    gtx_close(asset);
    return 0;
}
