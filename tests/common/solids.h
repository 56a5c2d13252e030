/* Closed assets for the tests of solids. Needs cmocka before it. */
#ifndef GTX_TESTS_SOLIDS_H
#define GTX_TESTS_SOLIDS_H

#include "asset/asset.h"
#include "common/fixture.h"

#include <math.h>

/* Flat, trimmed two texels inside the rectangle. */
static inline void box_face(const gtx_patch *patch, double x, double y, const void *user,
                            fixture_texel *out)
{
    const double u = fabs(x - (patch->rect[2] - 1) / 2.), v = fabs(y - (patch->rect[3] - 1) / 2.);
    (void)user;
    out->height = 0.5;
    out->trim = fmax(u - (patch->rect[2] - 5) / 2., v - (patch->rect[3] - 5) / 2.);
    for (int k = 0; k < 3; ++k)
        out->normal[k] = (double)patch->axis_z[k];
}

/* A cube of side 2 around the origin: six patches of texels x texels, a multiple of 8. */
static inline gtx_asset *solid_cube(uint32_t texels, uint32_t height_bits)
{
    fixture_patch patches[6] = {{.field = box_face}};
    const double pitch = 2. / (texels - 5);
    for (int face = 0; face < 6; ++face) {
        gtx_patch *p = &patches[face].frame;
        const int z = face / 2, x = (z + 1) % 3, y = (z + 2) % 3;
        const float side = face & 1 ? -1 : 1;
        patches[face].field = box_face;
        p->axis_x[x] = side;
        p->axis_y[y] = 1;
        p->axis_z[z] = side;
        p->extent_x = p->extent_y = (float)(pitch * texels);
        p->extent_z = 0.254f; /* 127 of 254 steps: the faces lie at 1 exactly */
        p->rect[2] = p->rect[3] = (uint16_t)texels;
        p->origin[x] = -side * p->extent_x / 2;
        p->origin[y] = -p->extent_y / 2;
        p->origin[z] = side * (1 - 0.127f);
    }
    return fixture_build(patches, 6, height_bits, 4);
}

/* Moves an asset in object space. */
static inline gtx_asset *moved(gtx_asset *asset, double x, double y, double z)
{
    asset->info.anchor[0] += x;
    asset->info.anchor[1] += y;
    asset->info.anchor[2] += z;
    return asset;
}

/* 0..1, from a seed (xorshift). */
static inline double next_random(uint64_t *seed)
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return (double)(*seed >> 11) / 9007199254740992.;
}

/* Runs jobs backwards: what they write may not depend on their order. */
static inline void run_backwards(uint32_t count, void (*job)(uint32_t index, void *data),
                                 void *data, void *user)
{
    (void)user;
    while (count-- > 0)
        job(count, data);
}

#endif
