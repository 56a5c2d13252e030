/* A shadow map of patches: no texel of its inside is left open where patches meet, and with a bias
 * by slope and texel a lit surface does not shade itself. */
#include "host/target.h"
#include "look.h"

enum { SIZE = 256, TAPS = 4 };

/* A sphere of radius 2 around the origin, in parallel light. */
typedef struct scene {
    gtx_view light;
    double texel, depth;      /* width of a texel and depth of the map's box, in the world */
    double to_light[3];
    float map[SIZE * SIZE];   /* rows from below */
} scene;

static scene the_scene;

static const scene *draw_map(stage *s, const subject *shown, float elevation, float max_error)
{
    scene *c = &the_scene;
    gtx_error error = {0};
    gtx_target target;
    gtx_camera sun = {.radius = 3, .azimuth = 31, .elevation = elevation, .distance = 2,
                      .orthographic = 1};
    float right[3], up[3], back[3];
    c->light = (gtx_view){.pass = GTX_PASS_DEPTH, .viewport_height = SIZE, .max_error = max_error};
    gtx_camera_matrices(&sun, 1, c->light.view, c->light.projection);
    gtx_camera_axes(&sun, right, up, back);
    for (int k = 0; k < 3; ++k)
        c->to_light[k] = back[k];
    c->texel = 2 / (double)c->light.projection[0] / SIZE;
    c->depth = -2 / (double)c->light.projection[10];
    must(gtx_target_create(&s->gl, SIZE, SIZE, NULL, &target, &error), &error);
    gtx_target_begin(&s->gl, &target);
    must(gtx_draw(s->renderer, &c->light, &shown->instance, 1, &error), &error);
    s->gl.ReadPixels(0, 0, SIZE, SIZE, GL_DEPTH_COMPONENT, GL_FLOAT, c->map);
    assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
    gtx_target_destroy(&s->gl, &target);
    return c;
}

/* Share of the light that a point gets, by samples/shadows.c. */
static double lit(const scene *c, const double point[3], const double n[3])
{
    const matrix clip = matrix_mul(matrix_of(c->light.projection), matrix_of(c->light.view));
    double q[3], facing = 0;
    matrix_point(clip, point, q);
    for (int k = 0; k < 3; ++k)
        facing += n[k] * c->to_light[k];
    facing = fmax(facing, 0);
    const double slope = sqrt(1 - fmin(facing * facing, 1)) / fmax(facing, 0.1);
    const double bias = c->texel / c->depth * (2.83 * slope + 1);
    const int x = (int)floor((q[0] / 2 + 0.5) * SIZE - 1.5);
    const int y = (int)floor((q[1] / 2 + 0.5) * SIZE - 1.5);
    assert_true(x >= 0 && y >= 0 && x + TAPS <= SIZE && y + TAPS <= SIZE);
    int sum = 0;
    for (int i = 0; i < TAPS * TAPS; ++i)
        sum += c->map[(y + i / TAPS) * SIZE + x + i % TAPS] >= q[2] / 2 + 0.5 - bias;
    return sum / (double)(TAPS * TAPS);
}

/* On a sphere what faces the light is lit. Points as evenly spread as Fibonacci's. */
static void no_acne(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    for (int i = 0; i < 8; ++i) {
        const scene *c = draw_map(s, &shown, 20.f + 8 * (float)i, i & 1 ? 0.5f : 1e-3f);
        long facing = 0, shaded = 0;
        for (int k = 0; k < 20000; ++k) {
            const double z = 1 - (k + 0.5) / 10000, turn = 2.399963 * k, r = sqrt(1 - z * z);
            const double n[3] = {r * cos(turn), r * sin(turn), z};
            const double point[3] = {2 * n[0], 2 * n[1], 2 * n[2]};
            double dot = 0;
            for (int a = 0; a < 3; ++a)
                dot += n[a] * c->to_light[a];
            if (dot < 0.1)
                continue;
            ++facing;
            shaded += lit(c, point, n) < 1;
        }
        assert_true(facing > 8000);
        assert_int_equal(shaded, 0);
    }
    subject_close(s, &shown);
}

/* Behind the sphere there is no light, across all its seams; nor on its dark side. */
static void no_leak(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    const double up[3] = {0, 1, 0};
    for (int i = 0; i < 8; ++i) {
        const scene *c = draw_map(s, &shown, 30.f + 7 * (float)i, i & 1 ? 0.5f : 1e-3f);
        long dark = 0;
        for (int k = 0; k < 40000; ++k) {
            const double x = (k % 200 - 99.5) / 25, z = (k / 200 - 99.5) / 25;
            const double along = (x * c->to_light[0] + z * c->to_light[2]);
            const double away = x * x + z * z - along * along; /* of the ray from the centre */
            const double shift = -2.3 / c->to_light[1];        /* to the plane y = -2.3 */
            const double point[3] = {x + shift * c->to_light[0], -2.3, z + shift * c->to_light[2]};
            const double reach = 2 - 4 * c->texel;
            if (away >= reach * reach)
                continue;
            ++dark;
            if (lit(c, point, up) > 0)
                fail_msg("light at (%g, %g, %g)", point[0], point[1], point[2]);
        }
        assert_true(dark > 5000);
    }
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_acne),
        cmocka_unit_test(no_leak),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
