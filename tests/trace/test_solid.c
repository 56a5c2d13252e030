/* Solids: volumes and insides against spheres and cubes; what is open is refused. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/counter.h"
#include "common/solids.h"

#include <geotex/solid.h>

#include <string.h>

static const double PI = 3.14159265358979;

static gtx_solid *solid_of(const gtx_asset *asset, float max_openness)
{
    const gtx_solid_desc desc = {.max_openness = max_openness};
    gtx_solid *solid = NULL;
    gtx_error error = {0};
    if (gtx_solid_create(asset, &desc, &solid, &error))
        fail_msg("%s", error.message);
    return solid;
}

static void near_to(double value, double wanted, double share)
{
    if (!(fabs(value - wanted) <= share * fabs(wanted)))
        fail_msg("%.9g is not within %g of %.9g", value, share, wanted);
}

static void volumes_are_exact(void **state)
{
    (void)state;
    for (uint32_t bits = 8; bits <= 16; bits += 8) {
        gtx_asset *ball = fixture_sphere(1.5, 96, bits), *cube = solid_cube(64, bits);
        gtx_solid *solids[2] = {solid_of(ball, 0), solid_of(cube, 0)};
        gtx_solid_facts facts;
        gtx_solid_measure(solids[0], &facts);
        near_to(facts.volume, 4 * PI / 3 * pow(1.5, 3), 2e-3);
        near_to(facts.area, 4 * PI * 1.5 * 1.5, bits == 8 ? 6e-3 : 2e-3); /* steps are rough */
        assert_true(facts.openness == 0);
        gtx_solid_measure(solids[1], &facts);
        near_to(facts.volume, 8, 1e-5);
        near_to(facts.area, 24, 1e-5);
        assert_true(facts.openness == 0);
        for (int i = 0; i < 2; ++i)
            gtx_solid_destroy(solids[i]);
        gtx_close(ball);
        gtx_close(cube);
    }
    gtx_solid_facts none = {1, 1, 1};
    gtx_solid_measure(NULL, &none);
    assert_true(none.volume == 0 && none.openness == 0);
}

/* In all directions, seams included, just inside the surface and just outside. */
static void insides_are_exact(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(1, 96, 16);
    gtx_solid *solid = solid_of(asset, 0);
    uint64_t seed = 5;
    for (int i = 0; i < 30000; ++i) {
        float point[1][3], number;
        uint8_t inside;
        double length = 0, v[3];
        for (int k = 0; k < 3; ++k) {
            v[k] = 2 * next_random(&seed) - 1;
            length += v[k] * v[k];
        }
        const double away = pow(10, -3 * next_random(&seed)); /* of the surface: 1 to 0.001 */
        const double r = i & 1 ? 1 + away : 1 - away;
        for (int k = 0; k < 3; ++k)
            point[0][k] = (float)(r * v[k] / sqrt(length));
        assert_int_equal(gtx_solid_inside(solid, (const float (*)[3])point, &inside, 1), GTX_OK);
        assert_int_equal(gtx_solid_winding(solid, (const float (*)[3])point, &number, 1), GTX_OK);
        assert_int_equal(inside, r < 1);
        if (away > 0.1 && fabs((double)number - inside) > 0.1)
            fail_msg("winding number %g at radius %g", (double)number, r);
    }
    gtx_solid_destroy(solid);
    gtx_close(asset);
}

static void odd_points_have_an_answer(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(1, 48, 8);
    gtx_solid *solid = solid_of(asset, 0);
    const float odd[5][3] = {{NAN, 0, 0}, {0, INFINITY, 0}, {3e38f, -3e38f, 3e38f},
                             {0, 0, 0}, {1, 0, 0}};
    float number[5];
    uint8_t inside[5];
    assert_int_equal(gtx_solid_winding(solid, odd, number, 5), GTX_OK);
    assert_int_equal(gtx_solid_inside(solid, odd, inside, 5), GTX_OK);
    assert_true(isnan(number[0]) && isnan(number[1]));
    if (!(fabsf(number[2]) < 1e-3f && fabsf(number[3] - 1) < 0.1f))
        fail_msg("%g %g", (double)number[2], (double)number[3]);
    assert_true(number[4] > -0.1f && number[4] < 1.1f);
    assert_true(!inside[0] && !inside[1] && !inside[2] && inside[3]);
    assert_int_equal(gtx_solid_winding(NULL, odd, number, 1), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_solid_inside(solid, NULL, inside, 1), GTX_ERROR_ARGUMENT);
    gtx_solid_destroy(solid);
    gtx_solid_destroy(NULL);
    gtx_close(asset);
}

static void refused(const gtx_asset *asset, const gtx_solid_desc *desc, gtx_result result,
                    const char *text)
{
    gtx_solid *solid = NULL;
    gtx_error error = {0};
    assert_int_equal(gtx_solid_create(asset, desc, &solid, &error), result);
    assert_null(solid);
    if (!strstr(error.message, text))
        fail_msg("'%s' is not in: %s", text, error.message);
}

static void open_surfaces_are_refused(void **state)
{
    (void)state;
    gtx_asset *plane = fixture_flat(0.5, 8), *ball = fixture_sphere(1, 48, 8);
    refused(plane, NULL, GTX_ERROR_INPUT, "open or faces inwards");
    for (uint32_t faces = 1; faces < 4; faces += 2) { /* one of the six is missing, then two */
        gtx_asset *asset = fixture_sphere_without(1, 48, 8, faces);
        gtx_solid_facts facts;
        refused(asset, NULL, GTX_ERROR_INPUT, "open or faces inwards");
        gtx_solid *solid = solid_of(asset, 1);
        gtx_solid_measure(solid, &facts);
        if (!(facts.openness > 0.03))
            fail_msg("openness %g", facts.openness);
        gtx_solid_destroy(solid);
        gtx_close(asset);
    }
    for (uint32_t p = 0; p < 6; ++p) /* inside out: heights and all, mirrored in x */
        for (int k = 0; k < 3; ++k) {
            gtx_patch *patch = &ball->patches[p];
            patch->origin[k] += patch->extent_z * patch->axis_z[k];
            patch->axis_z[k] = -patch->axis_z[k];
        }
    refused(ball, NULL, GTX_ERROR_INPUT, "open or faces inwards");
    gtx_close(plane);
    gtx_close(ball);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(1, 48, 8);
    const gtx_solid_desc wide = {.max_openness = 2}, nan = {.max_openness = NAN};
    const gtx_solid_desc dirty = {.reserved = {0, 0, 0, 0, 1}};
    const gtx_solid_desc small = {.limits = {.memory = 10000}}, few = {.limits = {.cells = 3}};
    refused(NULL, NULL, GTX_ERROR_ARGUMENT, "needs an asset");
    refused(asset, &wide, GTX_ERROR_ARGUMENT, "max_openness");
    refused(asset, &nan, GTX_ERROR_ARGUMENT, "max_openness");
    refused(asset, &dirty, GTX_ERROR_NOT_ZEROED, "");
    refused(asset, &small, GTX_ERROR_LIMIT, "");
    refused(asset, &few, GTX_ERROR_LIMIT, "");
    const gtx_solid_desc lazy = {.limits = {.work = 10000}};
    refused(asset, &lazy, GTX_ERROR_LIMIT, "steps of work");
    gtx_close(asset);
}

static void memory_may_run_out(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(1, 48, 8);
    gtx_result result = GTX_ERROR_MEMORY;
    for (long i = 0; result; ++i) {
        counter c = {i, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        const gtx_solid_desc desc = {.allocator = &hooks};
        gtx_solid *solid = NULL;
        result = gtx_solid_create(asset, &desc, &solid, NULL);
        assert_true(result == GTX_OK || result == GTX_ERROR_MEMORY);
        assert_true((solid != NULL) == (result == GTX_OK));
        gtx_solid_destroy(solid);
        assert_int_equal(c.bytes, 0);
        assert_true(i < 1000);
    }
    gtx_close(asset);
}

static void jobs_change_nothing(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(1, 64, 8);
    const gtx_jobs jobs = {run_backwards, NULL};
    const gtx_solid_desc desc = {.jobs = &jobs};
    gtx_solid *one = solid_of(asset, 0), *other = NULL;
    gtx_solid_facts facts[2];
    assert_int_equal(gtx_solid_create(asset, &desc, &other, NULL), GTX_OK);
    gtx_solid_measure(one, &facts[0]);
    gtx_solid_measure(other, &facts[1]);
    assert_memory_equal(&facts[0], &facts[1], sizeof *facts);
    gtx_solid_destroy(one);
    gtx_solid_destroy(other);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_are_exact),
        cmocka_unit_test(insides_are_exact),
        cmocka_unit_test(odd_points_have_an_answer),
        cmocka_unit_test(open_surfaces_are_refused),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(memory_may_run_out),
        cmocka_unit_test(jobs_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
