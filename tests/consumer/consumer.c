/* A stranger's program: cooks a model, opens the asset, casts a ray at it. C and C++ alike. */
#include <geotex/cook.h>
#include <geotex/geotex.h>
#include <geotex/render.h>

#include <stdio.h>
#include <string.h>

static int fail(const char *what, const gtx_error *error)
{
    fprintf(stderr, "%s: %s\n", what, error->message);
    return 1;
}

int main(int argc, char **argv)
{
    gtx_error error;
    gtx_asset *asset = NULL;
    gtx_caster *caster = NULL;
    gtx_info info;
    gtx_ray ray;
    gtx_hit hit;
    if (argc != 3)
        return 2;
    if (gtx_version() != GTX_VERSION || !gtx_shader_source("geotex_cast.glsl"))
        return 3;
    if (gtx_cook_file(argv[1], argv[2], NULL, NULL, &error) != GTX_OK)
        return fail(argv[1], &error);
    if (gtx_open_file(argv[2], NULL, &asset, &error) != GTX_OK)
        return fail(argv[2], &error);
    gtx_get_info(asset, &info);
    if (gtx_caster_create(asset, NULL, &caster, &error) != GTX_OK)
        return fail("caster", &error);
    memset(&ray, 0, sizeof ray);
    ray.origin[0] = (info.bounds_min[0] + info.bounds_max[0]) / 2;
    ray.origin[1] = (info.bounds_min[1] + info.bounds_max[1]) / 2;
    ray.origin[2] = info.bounds_max[2] + 1;
    ray.direction[2] = -1;
    gtx_raycast(caster, &ray, &hit, 1, 0);
    printf("%u patches, hit at %.2f\n", (unsigned)info.patch_count, (double)hit.t);
    gtx_caster_destroy(caster);
    gtx_close(asset);
    return 0;
}
