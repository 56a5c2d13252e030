/* Spheres with an LOD mesh, for the tests of drawing it: grids on the faces of a cube, blown up,
 * whose vertices are shared across the faces. */
#ifndef GTX_TESTS_LODS_H
#define GTX_TESTS_LODS_H

#include "stage.h"

enum {
    LOD_LEVELS = 4,
    LOD_FINEST = 32,
    LOD_MAX_VERTICES = 6 * (LOD_FINEST + 1) * (LOD_FINEST + 1)
};

typedef struct lod_level {
    uint32_t first[7], indices[36 * LOD_FINEST * LOD_FINEST];
    uint16_t positions[3 * LOD_MAX_VERTICES];
    gtx_lod_mesh lod;
} lod_level;

/* The vertex at a place, in the order of first use. */
static inline uint32_t lod_vertex(lod_level *l, const double at[3])
{
    uint16_t q[3];
    for (int k = 0; k < 3; ++k)
        q[k] = (uint16_t)lround((at[k] - l->lod.origin[k]) / l->lod.step);
    for (uint32_t v = 0; v < l->lod.vertex_count; ++v) {
        const uint16_t *p = l->positions + 3 * v;
        if (abs(p[0] - q[0]) + abs(p[1] - q[1]) + abs(p[2] - q[2]) < 4)
            return v;
    }
    memcpy(l->positions + 3 * l->lod.vertex_count, q, sizeof q);
    return l->lod.vertex_count++;
}

/* The point (i, j) of n x n cells on the face of a patch. */
static inline void lod_point(const gtx_patch *p, double radius, int n, int i, int j, double at[3])
{
    const double u = tan((2.0 * i / n - 1) * atan(1)), v = tan((2.0 * j / n - 1) * atan(1));
    const double length = sqrt(1 + u * u + v * v);
    for (int k = 0; k < 3; ++k)
        at[k] = (p->axis_z[k] + u * p->axis_x[k] + v * p->axis_y[k]) * radius / length;
}

static inline void make_lod_level(const gtx_patch *patches, uint32_t count, double radius, int n,
                                  lod_level *l)
{
    memset(l, 0, sizeof *l);
    const float low = (float)(-1.001 * radius);
    l->lod = (gtx_lod_mesh){.origin = {low, low, low}, .step = (float)(2.002 * radius / 65535),
                            .first = l->first, .indices = l->indices, .positions = l->positions};
    for (uint32_t p = 0; p < count; ++p) {
        for (int cell = 0; cell < n * n; ++cell) {
            static const int corners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
            for (int c = 0; c < 6; ++c) {
                double at[3];
                lod_point(&patches[p], radius, n, cell % n + corners[c][0],
                          cell / n + corners[c][1], at);
                l->indices[3 * l->lod.triangle_count + (uint32_t)c] = lod_vertex(l, at);
            }
            l->lod.triangle_count += 2;
        }
        l->first[p + 1] = l->lod.triangle_count;
    }
    /* Cells are largest in the middle of a face: there a diagonal has its middle deepest. */
    double a[3], b[3], middle = 0;
    lod_point(patches, radius, n, n / 2, n / 2, a);
    lod_point(patches, radius, n, n / 2 + 1, n / 2 + 1, b);
    for (int k = 0; k < 3; ++k)
        middle += (a[k] + b[k]) * (a[k] + b[k]) / 4;
    l->lod.error = (float)(radius - sqrt(middle)) + 2 * l->lod.step;
}

/* What a sphere with an LOD mesh has of appearance: EVEN is of one material without emission,
 * UNEVEN of two; the DARK ones have a map of emission, but nothing in it. */
typedef enum lod_looks {
    LOD_COLORED, LOD_PLAIN, LOD_SHINY, LOD_EVEN, LOD_UNEVEN, LOD_EVEN_DARK,
    LOD_UNEVEN_DARK
} lod_looks;

/* A copy of an asset with this LOD mesh, and the flags in all patches. Closes the asset. */
static inline gtx_asset *with_lod_meshes(gtx_asset *plain, const gtx_lod_mesh *lods,
                                         uint32_t levels, uint16_t flags, lod_looks looks)
{
    gtx_info info;
    gtx_get_info(plain, &info);
    gtx_patch patches[6];
    assert_true(info.patch_count <= 6);
    memcpy(patches, gtx_patches(plain), info.patch_count * sizeof *patches);
    for (uint32_t p = 0; p < info.patch_count; ++p)
        patches[p].flags |= flags;
    const uint8_t *normal[8], *color[8], *material[8], *dark[8];
    const size_t texels = (size_t)info.page_width * info.page_height * info.page_count;
    uint8_t *halves = malloc(8 * texels), *next = halves, *nothing = calloc(3, texels);
    memset(halves, 128, 8 * texels);
    for (uint32_t k = 0; k < info.mip_count; ++k) {
        const size_t count = texels >> 2 * k;
        material[k] = next;
        dark[k] = nothing;
        next += 4 * count;
        if (looks == LOD_UNEVEN || looks == LOD_UNEVEN_DARK) /* the lower half of the page */
            memset(next - 2 * count, 30, 2 * count);
        normal[k] = gtx_map_data(plain, GTX_MAP_NORMAL, k, NULL);
        color[k] = gtx_map_data(plain, GTX_MAP_COLOR, k, NULL);
    }
    gtx_asset_desc desc = {.patches = patches, .patch_count = info.patch_count,
                           .page_count = info.page_count, .page_width = info.page_width,
                           .page_height = info.page_height, .mip_count = info.mip_count,
                           .height_bits = info.height_bits,
                           .height = gtx_map_data(plain, GTX_MAP_HEIGHT, 0, NULL),
                           .trim = gtx_map_data(plain, GTX_MAP_TRIM, 0, NULL),
                           .normal = normal, .color = looks == LOD_PLAIN ? NULL : color,
                           .material = looks >= LOD_SHINY ? material : NULL,
                           .emission = looks == LOD_SHINY       ? material
                                       : looks >= LOD_EVEN_DARK ? dark
                                                                  : NULL,
                           .lod = lods, .lod_levels = levels};
    memcpy(desc.bounds_min, info.bounds_min, sizeof desc.bounds_min);
    memcpy(desc.bounds_max, info.bounds_max, sizeof desc.bounds_max);
    gtx_asset *out = NULL;
    gtx_error error = {0};
    must(gtx_create(&desc, &out, &error), &error);
    gtx_close(plain);
    free(halves);
    free(nothing);
    return out;
}

/* The same of a fixture's sphere, with `levels` levels. */
static inline gtx_asset *with_lod_as(gtx_asset *sphere, double radius, uint32_t levels,
                                     uint16_t flags, lod_looks looks)
{
    static lod_level made[LOD_LEVELS];
    gtx_lod_mesh lods[LOD_LEVELS];
    gtx_info info;
    gtx_get_info(sphere, &info);
    for (uint32_t k = 0; k < levels; ++k) {
        make_lod_level(gtx_patches(sphere), info.patch_count, radius, LOD_FINEST >> k,
                       &made[k]);
        lods[k] = made[k].lod;
    }
    return with_lod_meshes(sphere, lods, levels, flags, looks);
}

static inline gtx_asset *with_lod(gtx_asset *sphere, double radius, uint32_t levels, uint16_t flags)
{
    return with_lod_as(sphere, radius, levels, flags, LOD_COLORED);
}

#endif
