/* Triangles that are picked by where they face: all are there, among those of their patch, and in
 * an order in which a vertex cache of few places, as SwiftShader's, shades little. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/alloc.h"
#include "frame/lod.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A square of patches, each of so many squares a side, every one of them two triangles. */
enum { PATCHES = 8, SIDE = 8, POINTS = SIDE + 1, PATCH_TRIANGLES = 2 * SIDE * SIDE,
       PATCH_VERTICES = POINTS * POINTS, TRIANGLES = PATCHES * PATCHES * PATCH_TRIANGLES,
       VERTICES = PATCHES * PATCHES * PATCH_VERTICES, INTERIOR = PATCH_TRIANGLES / 2 };

typedef struct square {
    gtx_lod_meshes lods;
    uint32_t first[PATCHES * PATCHES + 1], border[PATCHES * PATCHES];
    gtx_lod_run runs[PATCHES * PATCHES];
    gtx_lod_vertex vertices[VERTICES];
    uint16_t indices[3 * TRIANGLES];
} square;

/* Column by column, each a run of its own patch: as far apart as a patch's vertices can be. */
static square *make_square(bool lit)
{
    square *s = calloc(1, sizeof *s);
    assert_non_null(s);
    gtx_lod_level *level = s->lods.levels;
    s->lods.level_count = 1;
    s->lods.patch_count = PATCHES * PATCHES;
    s->lods.vertices = (uint8_t *)s->vertices;
    s->lods.indices = (uint8_t *)s->indices;
    *level = (gtx_lod_level){.lit = lit, .triangle_count = TRIANGLES, .first = s->first,
                             .border = s->border, .runs = s->runs,
                             .run_count = PATCHES * PATCHES, .index_size = sizeof(uint16_t),
                             .vertex_size = sizeof(gtx_lod_vertex),
                             .vertex_bytes = sizeof s->vertices};
    uint32_t index = 0;
    for (uint32_t p = 0; p < PATCHES * PATCHES; ++p) {
        s->border[p] = p * PATCH_TRIANGLES + INTERIOR;
        s->first[p + 1] = (p + 1) * PATCH_TRIANGLES;
        s->runs[p] = (gtx_lod_run){s->first[p + 1], p * PATCH_VERTICES, PATCH_VERTICES};
        for (uint32_t v = 0; v < PATCH_VERTICES; ++v) {
            const uint32_t x = p % PATCHES * SIDE + v / POINTS, y = p / PATCHES * SIDE + v % POINTS;
            s->vertices[p * PATCH_VERTICES + v] =
                (gtx_lod_vertex){{(uint16_t)(900 * x), (uint16_t)(900 * y),
                                  (uint16_t)(100 * (x * y % 7))}, 0, p};
        }
        for (uint32_t q = 0; q < SIDE * SIDE; ++q) {
            const uint16_t at = (uint16_t)(q / SIDE * POINTS + q % SIDE);
            const uint16_t corners[6] = {at, (uint16_t)(at + POINTS), (uint16_t)(at + 1),
                                         (uint16_t)(at + 1), (uint16_t)(at + POINTS),
                                         (uint16_t)(at + POINTS + 1)};
            memcpy(s->indices + index, corners, sizeof corners);
            index += 6;
        }
    }
    return s;
}

/* A triangle's corners as one number, whichever comes first if that does not matter. */
static uint64_t name_of(const uint32_t corner[3], bool any_first)
{
    uint32_t first = 0;
    for (uint32_t c = 1; c < 3 && any_first; ++c)
        first = corner[c] < corner[first] ? c : first;
    return (uint64_t)corner[first] << 42 | (uint64_t)corner[(first + 1) % 3] << 21 |
           corner[(first + 2) % 3];
}

static int by_name(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* How often four corners are shaded for one that the cache lacks: last, first and second corner of
 * one triangle after the other. */
static uint32_t shaded(const uint32_t (*corner)[3])
{
    enum { PLACES = 64, AT_ONCE = 4 };
    uint32_t cache[PLACES], count = 0;
    memset(cache, 0xff, sizeof cache);
    for (uint32_t i = 0; i < 3 * TRIANGLES; ++i) {
        const uint32_t now = corner[i / 3][(i + 2) % 3];
        if (cache[now % PLACES] == now)
            continue;
        ++count;
        for (uint32_t k = AT_ONCE; k-- > 0;)
            if (i + k < 3 * TRIANGLES) {
                const uint32_t next = corner[(i + k) / 3][(i + k + 2) % 3];
                cache[next % PLACES] = next;
            }
    }
    return count;
}

static void check(bool lit, double most)
{
    square *s = make_square(lit);
    gtx_lod_level *level = s->lods.levels;
    const gtx_allocator hooks = gtx_allocator_or_default(NULL);
    gtx_lod_find_faces(&hooks, &s->lods);
    assert_non_null(level->faces);
    uint32_t(*before)[3] = calloc(TRIANGLES, sizeof *before);
    uint32_t(*after)[3] = calloc(TRIANGLES, sizeof *after);
    assert_true(before && after);
    for (uint32_t t = 0; t < TRIANGLES; ++t)
        for (uint32_t c = 0; c < 3; ++c) {
            before[t][c] = s->runs[t / PATCH_TRIANGLES].first_vertex + s->indices[3 * t + c];
            after[t][c] = level->faces[t].corner[c]; /* one group has all vertices */
        }
    for (uint32_t t = 0; t < TRIANGLES; t += INTERIOR) {
        uint64_t names[2][INTERIOR];
        for (uint32_t i = 0; i < INTERIOR; ++i) {
            names[0][i] = name_of(before[t + i], lit);
            names[1][i] = name_of(after[t + i], lit);
        }
        qsort(names[0], INTERIOR, sizeof names[0][0], by_name);
        qsort(names[1], INTERIOR, sizeof names[1][0], by_name);
        assert_memory_equal(names[0], names[1], sizeof names[0]);
    }
    const uint32_t was = shaded((const uint32_t(*)[3])before);
    const uint32_t is = shaded((const uint32_t(*)[3])after);
    print_message("%u of four corners, %u in order\n", was, is);
    assert_true(is < most * was);
    free(before);
    free(after);
    gtx_free_array(&hooks, level->faces, TRIANGLES, sizeof *level->faces);
    free(s);
}

static void lit_at_vertices(void **state)
{
    (void)state;
    check(true, 0.5);
}

/* Whose first corner gives what is the same all over a triangle. */
static void lit_by_maps(void **state)
{
    (void)state;
    check(false, 0.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lit_at_vertices),
                                       cmocka_unit_test(lit_by_maps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
