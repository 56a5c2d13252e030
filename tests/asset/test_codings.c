/* How texels and LOD meshes are coded: filters there and back, what is filled in by rule, normals
 * in two bytes and their frame. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/boundary.h"
#include "asset/codec.h"
#include "asset/fill.h"
#include "asset/lanes.h"
#include "asset/lod.h"
#include "base/bytes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void test_filters(void **state)
{
    (void)state;
    uint8_t in[2 * 5 * 3 * 4], coded[sizeof in], out[sizeof in];
    for (uint32_t texel = 1; texel <= 4; ++texel) {
        gtx_map_shape image = {2, 5, 3, texel};
        size_t size = (size_t)gtx_shape_size(image);
        for (size_t i = 0; i < size; ++i)
            in[i] = (uint8_t)(i * i * 37 + i);
        for (uint32_t filter = 0; filter < 4; ++filter) {
            gtx_filter_apply(image, filter, in, coded);
            gtx_filter_undo(image, filter, coded, out);
            assert_memory_equal(in, out, size);
        }
    }
    /* Two pages of 2 x 2 texels by hand. */
    const uint8_t image[] = {10, 20, 30, 45, 1, 2, 3, 4};
    const uint8_t right[] = {10, 10, 20, 15, 1, 1, 2, 1};
    gtx_filter_apply((gtx_map_shape){2, 2, 2, 1}, GTX_FILTER_PAETH, image, coded);
    assert_memory_equal(coded, right, 8);
    const uint8_t planes[] = {10, 30, 1, 3, 20, 45, 2, 4};
    gtx_filter_apply((gtx_map_shape){1, 2, 2, 2}, GTX_FILTER_PLANES, image, coded);
    assert_memory_equal(coded, planes, 8);
}

static void test_heights(void **state)
{
    (void)state;
    /* A slope with a hole: all but the start is foretold, and a hole stays 0. */
    const uint8_t slope[] = {10, 10, 10, 20, 20, 20, 30, 0, 30};
    const uint8_t right[] = {1 + (10 + 255 - 128), 1, 1, 11, 1, 1, 11, 0, 11};
    uint8_t coded[32], out[32];
    gtx_heights_apply((gtx_map_shape){1, 3, 3, 1}, slope, coded);
    assert_memory_equal(coded, right, 9);
    /* Any codes come back, of both widths, over two pages. */
    uint8_t in[2 * 4 * 2 * 2];
    for (uint32_t texel = 1; texel <= 2; ++texel) {
        for (uint32_t seed = 0; seed < 400; ++seed) {
            gtx_map_shape shape = {2, 4, 2, texel};
            for (size_t i = 0; i < gtx_shape_size(shape); ++i)
                in[i] = (uint8_t)(i * i * seed * 37 + seed % 3 * 85 + (seed & 1 ? 0 : i));
            gtx_heights_apply(shape, in, coded);
            gtx_heights_undo(shape, coded, out);
            assert_memory_equal(in, out, (size_t)gtx_shape_size(shape));
        }
    }
}

static void test_mean(void **state)
{
    (void)state;
    for (uint32_t code = 0; code < 65536; ++code) { /* of one, and of one twice */
        const uint8_t in[2] = {(uint8_t)code, (uint8_t)(code >> 8)};
        uint8_t out[2];
        gtx_normal_sum sum = {0, 0, 0};
        for (int i = 0; i < 2; ++i) {
            gtx_normal_add(&sum, in);
            gtx_normal_mean(&sum, out);
            assert_memory_equal(in, out, 2);
        }
    }
    static const uint8_t codes[2][2] = {{0, 0}, {255, 255}}; /* level, away from each other */
    gtx_normal_sum sum = {0, 0, 0};
    gtx_normal_add(&sum, codes[0]);
    gtx_normal_add(&sum, codes[1]);
    uint8_t out[2];
    gtx_normal_mean(&sum, out);
    assert_int_equal(out[0], 128);
    assert_int_equal(out[1], 128);
}

/* Side by side they are the same, whatever up to 9 normals sum up to. */
static void test_mean_of_lanes(void **state)
{
    (void)state;
    const uint8_t ring[GTX_LANES] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2};
    for (int32_t size = 0; size <= 9 * 255; ++size) {
        for (int32_t a = -size; a <= size; a += GTX_LANES - 1) {
            gtx_lane_sums sums = {{0}, {0}, {0}};
            uint16_t code[GTX_LANES] = {0};
            for (int32_t l = 0; l < GTX_LANES; ++l) {
                const int32_t part = a + l <= size ? a + l : size;
                sums.a[l + 1] = (int16_t)part;
                sums.b[l + 1] = (int16_t)-part;
                sums.z[l + 1] = (int16_t)(size - (part < 0 ? -part : part));
            }
            gtx_lanes_mean(&sums, ring, 1, code);
            for (int l = 0; l + 1 < GTX_LANES; ++l) {
                const gtx_normal_sum sum = {sums.a[l + 1], sums.b[l + 1], sums.z[l + 1]};
                uint8_t out[2];
                gtx_normal_mean(&sum, out);
                if (code[l] != (out[0] | out[1] << 8))
                    fail_msg("of %d and %d: %04x", sum.a, size, code[l]);
            }
            assert_int_equal(code[GTX_LANES - 1], 0);
        }
    }
}

/* A 4 x 5 rectangle in rows of 6 texels: what lies outside is neither read nor written. */
static void test_fill(void **state)
{
    (void)state;
    uint8_t trim[30], ring[30] = {0};
    memset(trim, GTX_FAR_TRIM, sizeof trim);
    trim[7] = 130;
    ring[7] = 1;
    trim[5] = 0; /* another rectangle's */
    ring[5] = 1;
    gtx_fill_trim(&(gtx_fill){trim, ring, 6, 4, 5});
    static const uint8_t right[30] = {153, 146, 153, 169, 255, 0,   146, 130, 146, 162,
                                      255, 255, 153, 146, 153, 169, 255, 255, 169, 162,
                                      169, 176, 255, 255, 185, 178, 185, 192, 255, 255};
    assert_memory_equal(trim, right, 30);
    assert_int_equal(ring[0], 0);

    uint8_t normal[2 * 4] = {200, 60, 128, 128, 128, 128, 128, 128}, line[4] = {1, 0, 0, 0};
    gtx_fill_normals(&(gtx_fill){normal, line, 4, 4, 1}, 2);
    const uint8_t filled[] = {200, 60, 200, 60, 200, 60, 128, 128};
    assert_memory_equal(normal, filled, 8);
    static const uint8_t rings[] = {1, 2, 3, 4};
    assert_memory_equal(line, rings, 4);
    assert_int_equal(gtx_fill_rings(&(gtx_patch){.dilation = 8}, 3), 1);
    assert_int_equal(gtx_fill_rings(&(gtx_patch){.dilation = 8}, 4), 1);
    assert_int_equal(gtx_fill_rings(&(gtx_patch){.dilation = 65535}, 0), 128);
}

enum { WIDE = 41, HIGH = 12 };

/* By the letter: the ring of a texel, and the mean of its neighbours of lesser ones. */
static void fill_plainly(uint8_t codes[HIGH][WIDE][2], uint8_t marks[HIGH][WIDE], int rings)
{
    uint8_t ring[HIGH][WIDE];
    memcpy(ring, marks, sizeof ring);
    for (int r = 1; r <= rings; ++r)
        for (int y = 0; y < HIGH; ++y)
            for (int x = 0; x < WIDE; ++x) {
                gtx_normal_sum sum = {0, 0, 0};
                int near = 0;
                for (int v = y ? y - 1 : 0; v <= y + 1 && v < HIGH; ++v)
                    for (int u = x ? x - 1 : 0; u <= x + 1 && u < WIDE; ++u)
                        if (ring[v][u] && ring[v][u] <= r && !ring[y][x]) {
                            gtx_normal_add(&sum, codes[v][u]);
                            ++near;
                        }
                if (!near)
                    continue;
                gtx_normal_mean(&sum, codes[y][x]);
                ring[y][x] = (uint8_t)(r + 1);
            }
}

static void test_fill_of_many(void **state)
{
    (void)state;
    uint32_t seed = 1;
    for (int sparse = 1; sparse < 200; sparse += 9) {
        uint8_t codes[HIGH][WIDE][2], right[HIGH][WIDE][2], ring[HIGH][WIDE];
        for (int i = 0; i < HIGH * WIDE; ++i) {
            const int y = i / WIDE, x = i % WIDE;
            seed = seed * 1664525 + 1013904223;
            ring[y][x] = (seed >> 16) % (uint32_t)sparse == 0;
            codes[y][x][0] = ring[y][x] ? (uint8_t)(seed >> 24) : GTX_FAR_NORMAL;
            codes[y][x][1] = ring[y][x] ? (uint8_t)(seed >> 8) : GTX_FAR_NORMAL;
        }
        memcpy(right, codes, sizeof right);
        fill_plainly(right, ring, 5);
        gtx_fill_normals(&(gtx_fill){codes[0][0], ring[0], WIDE, WIDE, HIGH}, 5);
        assert_memory_equal(codes, right, sizeof codes);
    }
}

static void test_normals(void **state)
{
    (void)state;
    double worst = 0;
    for (int i = 0; i < 200; ++i) {
        for (int j = 0; j < 400; ++j) {
            double z = (i + 0.5) / 200, a = j * 2 * 3.14159265358979 / 400, r = sqrt(1 - z * z);
            float n[3] = {(float)(r * cos(a)), (float)(r * sin(a)), (float)z}, back[3];
            uint8_t code[2];
            gtx_encode_normal(n, code);
            gtx_decode_normal(code, back);
            double cosine = 0;
            for (int k = 0; k < 3; ++k)
                cosine += (double)n[k] * back[k];
            worst = fmax(worst, acos(fmin(1, cosine)));
        }
    }
    assert_true(worst * 57.2957795 < 0.6);

    for (uint32_t code = 0; code < 65536; ++code) { /* codes survive decoding */
        uint8_t in[2] = {(uint8_t)code, (uint8_t)(code >> 8)}, out[2];
        float n[3];
        gtx_decode_normal(in, n);
        assert_true(n[2] > -1e-6f && fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f);
        gtx_encode_normal(n, out);
        assert_memory_equal(in, out, 2);
    }

    static const float odd[][3] = {
        {0, 0, -1}, {NAN, 0, 1}, {INFINITY, 0, 0}, {0, 0, 0}, {0, 1, -9}};
    for (int i = 0; i < 5; ++i) {
        uint8_t code[2];
        gtx_encode_normal(odd[i], code);
    }
}

static void test_normal_frame(void **state)
{
    (void)state;
    /* x leans towards z: the frame is upright all the same. */
    gtx_patch patch = {.axis_x = {0.8f, 0, 0.6f}, .axis_y = {0, 1, 0}, .axis_z = {0, 0, 1}};
    float rows[3][3];
    gtx_normal_frame(&patch, rows);
    const float right[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 9; ++i)
        assert_true(fabsf(rows[i / 3][i % 3] - right[i / 3][i % 3]) < 1e-6f);
}

/* Of a fan, open and closed. */
static void test_boundary(void **state)
{
    (void)state;
    uint8_t links[GTX_LINK_BYTES(6)];
    gtx_boundary b;
    gtx_boundary_begin(&b, links, 6);
    for (uint32_t v = 0; v < 7; ++v)
        assert_int_equal(gtx_boundary_after(&b, v), GTX_NO_NEIGHBOUR);
    /* A fan around 0: the boundary runs 1 -> 0 -> 4 -> 3 -> 2 -> 1 once it has three triangles. */
    gtx_boundary_add(&b, (uint32_t[]){0, 1, 2}, false);
    gtx_boundary_add(&b, (uint32_t[]){0, 2, 3}, true);
    gtx_boundary_add(&b, (uint32_t[]){0, 3, 4}, true);
    const uint32_t after[] = {4, 0, 1, 2, 3};
    for (uint32_t v = 0; v < 5; ++v) {
        assert_int_equal(gtx_boundary_after(&b, v), after[v]);
        assert_int_equal(gtx_boundary_before(&b, after[v]), v);
    }
    assert_int_equal(b.count, 5);
    assert_int_equal(gtx_boundary_latest(&b, 0)->from, 0);
    assert_int_equal(gtx_boundary_latest(&b, 0)->to, 4);
    assert_int_equal(gtx_boundary_latest(&b, 0)->across, 3);
    /* The last of the fan closes it: 0 is inside. */
    gtx_boundary_add(&b, (uint32_t[]){0, 4, 1}, true);
    assert_int_equal(gtx_boundary_after(&b, 0), GTX_NO_NEIGHBOUR);
    assert_int_equal(gtx_boundary_before(&b, 0), GTX_NO_NEIGHBOUR);
    assert_int_equal(gtx_boundary_after(&b, 1), 4);
    assert_int_equal(b.count, 4);
    /* Corners that are no vertices change nothing. */
    gtx_boundary_add(&b, (uint32_t[]){0, 6, 1}, false);
    gtx_boundary_add(&b, (uint32_t[]){0, 1, UINT32_MAX}, true);
    assert_int_equal(b.count, 4);
}

/* Triangles that touch in any way, at most `reach` vertices back, come back as they were. */
static void test_any_triangles(void **state)
{
    (void)state;
    uint32_t seed = 1;
    for (uint32_t round = 0; round < 400; ++round) {
        const uint32_t triangles = 1 + round % 60, reach = 3 + round % 9;
        uint32_t index[180], met = 0;
        for (uint32_t i = 0; i < 3 * triangles; ++i) {
            const uint32_t first = i - i % 3;
            do {
                seed = seed * 1664525u + 1013904223u;
                const uint32_t back = (seed >> 16) % reach;
                index[i] = back > met ? met : met - back;
            } while ((i > first && index[i] == index[first]) ||
                     (i > first + 1 && index[i] == index[first + 1]));
            met += index[i] == met;
        }
        const size_t size = (size_t)gtx_lod_size(1, met, triangles);
        uint8_t *in = calloc(4, size), *coded = in + size, *out = coded + size;
        assert_non_null(in);
        gtx_store_u32(in + 20, met);
        gtx_store_u32(in + 24, triangles);
        gtx_store_u32(in + GTX_LOD_HEADER + 4, triangles);
        for (uint32_t i = 0; i < 3 * triangles; ++i)
            gtx_store_u32(in + GTX_LOD_HEADER + 8 + 4 * (size_t)i, index[i]);
        for (size_t i = GTX_LOD_HEADER + 8 + 12 * (size_t)triangles; i < size; ++i)
            in[i] = (uint8_t)(i * i * 29 >> 3);
        gtx_lod_filter_apply(in, size, coded, out + size);
        assert_true(gtx_lod_filter_undo(coded, size, out));
        assert_memory_equal(in, out, size);
        free(in);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_filters),
        cmocka_unit_test(test_heights),
        cmocka_unit_test(test_mean),
        cmocka_unit_test(test_mean_of_lanes),
        cmocka_unit_test(test_fill),
        cmocka_unit_test(test_fill_of_many),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_normal_frame),
        cmocka_unit_test(test_boundary),
        cmocka_unit_test(test_any_triangles),
    };
    return cmocka_run_group_tests_name("codings", tests, NULL, NULL);
}
