/* LOD meshes of the golden assets. */
#ifndef GTX_TESTS_GOLDEN_LOD_H
#define GTX_TESTS_GOLDEN_LOD_H

#include <geotex/geotex.h>

#include <stdlib.h>

static inline void *need(void *memory)
{
    if (!memory)
        abort();
    return memory;
}

/* A level in memory of its own: a square of 2^n x 2^n cells on every patch, whose first corners are
 * those of the patch before, so that patches share vertices. */
static inline gtx_lod_mesh golden_lod(uint32_t patches, uint32_t level, uint32_t levels)
{
    const uint32_t side = 1u << (levels - 1 - level), row = side + 1;
    const uint32_t triangles = 2 * side * side, own = row * row;
    uint32_t *first = need(calloc(patches + 1, sizeof *first));
    uint32_t *indices = need(calloc((size_t)patches * triangles, 3 * sizeof *indices));
    uint16_t *positions = need(calloc((size_t)patches * own, 3 * sizeof *positions));
    uint32_t name[81], met = 0, at = 0;
    for (uint32_t p = 0; p < patches; ++p) {
        first[p] = p * triangles;
        for (uint32_t i = p ? 1 : 0; i < own; ++i)
            name[i] = UINT32_MAX;
        for (uint32_t t = 0; t < triangles; ++t) {
            static const uint32_t corners[2][3][2] = {{{0, 0}, {1, 0}, {0, 1}},
                                                      {{0, 1}, {1, 0}, {1, 1}}};
            for (uint32_t k = 0; k < 3; ++k) {
                uint32_t x = t / 2 % side + corners[t % 2][k][0];
                uint32_t y = t / 2 / side + corners[t % 2][k][1], i = y * row + x;
                if (name[i] == UINT32_MAX) {
                    name[i] = met++;
                    positions[3 * name[i]] = (uint16_t)(x * 1000 / side);
                    positions[3 * name[i] + 1] = (uint16_t)(y * 1000 / side);
                    positions[3 * name[i] + 2] = (uint16_t)(x * y % 7 + 40 * p);
                }
                indices[at++] = name[i];
            }
        }
    }
    first[patches] = patches * triangles;
    return (gtx_lod_mesh){.step = 1.0f / 1024, .error = 0.25f * (float)level, .vertex_count = met,
                          .triangle_count = patches * triangles, .first = first, .indices = indices,
                          .positions = positions};
}

/* Of all directions, and all errors of a coding. */
static inline void golden_normals(gtx_lod_mesh *lod)
{
    uint8_t *normals = need(calloc(lod->vertex_count, 2));
    for (uint32_t i = 0; i < 2 * lod->vertex_count; ++i)
        normals[i] = (uint8_t)(i * i * 29 + 128 * (i % 2));
    lod->normals = normals;
    lod->normal_error = 0.125f;
    lod->flags |= GTX_LOD_NORMALS;
}

static inline void golden_free_lod(gtx_lod_mesh *lod)
{
    free((void *)lod->normals);
    free((void *)lod->first);
    free((void *)lod->indices);
    free((void *)lod->positions);
}

#endif
