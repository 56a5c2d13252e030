/* The polygon shapes: closed, outward, with normals that match; the picture averaging. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/vec.h"
#include "host/framebuffer.h"
#include "host/shapes.h"

#include <stdlib.h>

/* Triangles face away from `inside` and their vertices' normals agree with them. */
static void expect_outward(const gtx_shapes *s, gtx_vec3 inside)
{
    assert_false(s->failed);
    for (uint32_t i = 0; i < s->index_count; i += 3) {
        const gtx_polygon_vertex *v[3];
        for (uint32_t k = 0; k < 3; ++k) {
            assert_in_range(s->indices[i + k], 0, s->vertex_count - 1);
            v[k] = &s->vertices[s->indices[i + k]];
        }
        const gtx_vec3 a = gtx_v3_load(v[0]->position);
        const gtx_vec3 n = gtx_v3_cross(gtx_v3_sub(gtx_v3_load(v[1]->position), a),
                                        gtx_v3_sub(gtx_v3_load(v[2]->position), a));
        assert_true(gtx_v3_dot(n, gtx_v3_sub(a, inside)) > 0);
        for (int k = 0; k < 3; ++k) {
            const gtx_vec3 normal = gtx_v3_load(v[k]->normal);
            assert_true(gtx_v3_dot(n, normal) > 0.9f * gtx_v3_length(n));
            assert_true(fabsf(gtx_v3_length(normal) - 1) < 1e-5f);
        }
    }
}

static void release(gtx_shapes *s)
{
    free(s->vertices);
    free(s->indices);
}

static void boxes_and_cylinders_face_outward(void **state)
{
    (void)state;
    const gtx_rgb red = {255, 0, 0};
    gtx_shapes box = {0}, cylinder = {0};
    gtx_shapes_box(&box, (float[3]){1, 2, 3}, (float[3]){1, 2, 3}, 33, red);
    assert_int_equal(box.index_count, 36);
    expect_outward(&box, gtx_v3(1, 2, 3));
    gtx_shapes_cylinder(&cylinder, (float[3]){1, 2, 3}, 1, 0.8f, 2, red);
    expect_outward(&cylinder, gtx_v3(1, 3, 3));
    release(&box);
    release(&cylinder);
    gtx_shapes tube = {0};
    gtx_shapes_tube(&tube, (const float[][3]){{1, 0, 3}, {1, 2, 3}, {1, 5, 3}}, 3, 0.5f, red);
    expect_outward(&tube, gtx_v3(1, 2.5f, 3));
    release(&tube);
}

static gtx_rgb by_place(float x, float z, void *user)
{
    const uint8_t sides = (uint8_t)(*(int *)user + (x > 0) + 2 * (z > 0));
    return (gtx_rgb){sides, sides, sides};
}

static void grids_look_up(void **state)
{
    (void)state;
    int base = 100;
    gtx_shapes grid = {0};
    gtx_shapes_grid(&grid, 0.5f, 8, 4, by_place, &base);
    assert_int_equal(grid.vertex_count, 25);
    assert_int_equal(grid.index_count, 96);
    expect_outward(&grid, gtx_v3(0, -1, 0));
    assert_int_equal(grid.vertices[24].color[0], 103);
    assert_int_equal(grid.vertices[24].color[3], 0);
    release(&grid);
}

static void averaging(void **state)
{
    (void)state;
    enum { W = 3, H = 2, N = 2 };
    uint8_t pixels[4 * N * N * W * H];
    for (int i = 0; i < N * N * W * H; ++i)
        for (int c = 0; c < 4; ++c) {
            const int x = i % (N * W), y = i / (N * W);
            pixels[4 * i + c] = (uint8_t)(40 * (x / N) + 10 * (y / N) + 2 * (x % N) + c);
        }
    gtx_average_down(pixels, W, H, N);
    for (int i = 0; i < W * H; ++i)
        for (int c = 0; c < 4; ++c)
            assert_int_equal(pixels[4 * i + c], 40 * (i % W) + 10 * (i / W) + 1 + c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_and_cylinders_face_outward),
        cmocka_unit_test(grids_look_up),
        cmocka_unit_test(averaging),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
