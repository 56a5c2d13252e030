/* How texels are coded: image filters there and back, normals in two bytes and their frame. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/codec.h"

#include <math.h>

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_filters),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_normal_frame),
    };
    return cmocka_run_group_tests_name("codings", tests, NULL, NULL);
}
