/* Placed models: rotated, scaled, sheared, mirrored, many at once, and among polygons. */
#include "oracle.h"

/* Column-major, linear part given by rows. */
static void place(float out[16], const float rows[9], float x, float y, float z)
{
    const float m[16] = {rows[0], rows[3], rows[6], 0, rows[1], rows[4], rows[7], 0,
                         rows[2], rows[5], rows[8], 0, x,       y,       z,       1};
    memcpy(out, m, sizeof m);
}

static const float linear_parts[][9] = {
    {0.36f, 0.48f, -0.8f, -0.8f, 0.6f, 0, 0.48f, 0.64f, 0.6f}, /* a rotation */
    {2, 0, 0, 0, 0.5f, 0, 0, 0, 1},                            /* a stretch */
    {1, 0.7f, 0, 0, 1, -0.4f, 0, 0, 1},                        /* a shear */
    {-1, 0, 0, 0, 1, 0, 0, 0, 1},                              /* a mirror */
    {0.5f, 0, 0.3f, 0.2f, -0.9f, 0, 0, 0.3f, 1.1f},            /* a mirror, sheared */
    {1e-3f, 0, 0, 0, 1e-3f, 0, 0, 0, 1e-3f},                   /* tiny */
    {1e4f, 0, 0, 0, 1e4f, 0, 0, 0, 1e4f},                      /* huge */
};
enum { LINEAR_PARTS = sizeof linear_parts / sizeof *linear_parts };

/* The sphere of radius 2 placed by each, from two sides, with both projections. */
static void transforms_agree_with_rays(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    for (int i = 0; i < 4 * LINEAR_PARTS; ++i) {
        const float *rows = linear_parts[i / 4];
        const float scale = fabsf(rows[4]) + fabsf(rows[0]);
        gtx_camera camera = {.target = {scale, -2 * scale, 0.5f * scale}, .radius = 2.6f * scale};
        camera.azimuth = i & 1 ? 27.0f : 210.0f;
        camera.elevation = i & 1 ? 33.0f : -12.0f;
        camera.distance = 3;
        camera.orthographic = i >> 1 & 1;
        place(shown.instance.transform, rows, camera.target[0], camera.target[1], camera.target[2]);
        const gtx_view view = view_of(&camera);
        expect_agreement(s, &shown, &view, 1500);
    }
    subject_close(s, &shown);
}

static void a_mirrored_view(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    gtx_camera camera = camera_around(shown.asset);
    for (int i = 0; i < 4; ++i) {
        camera.orthographic = i & 1;
        camera.reversed_z = i >> 1;
        gtx_view view = view_of(&camera);
        view.projection[0] = -view.projection[0];
        expect_agreement(s, &shown, &view, 4000);
    }
    subject_close(s, &shown);
}

/* Ninety spheres in one draw, every third mirrored, so that runs of both windings follow. */
static void many_instances(void **state)
{
    STAGE_OR_SKIP(state);
    enum { COUNT = 90 };
    subject shown = subject_open(s, fixture_sphere(2, 48, 8));
    gtx_instance instances[COUNT];
    memset(instances, 0, sizeof instances);
    for (int i = 0; i < COUNT; ++i) {
        const float turn = 0.7f * (float)i, size = 0.15f + 0.05f * (float)(i % 7);
        const float c = size * cosf(turn), d = size * sinf(turn), m = i % 3 ? 1.0f : -1.0f;
        const float rows[9] = {m * c, 0, d, 0, size, 0, -m * d, 0, c};
        instances[i].model = shown.model;
        place(instances[i].transform, rows, (float)(i % 10) - 4.5f, (float)(i / 10) - 4,
              0.8f * sinf((float)i));
    }
    gtx_camera camera = {.radius = 7, .azimuth = 20, .elevation = 15, .distance = 2.6f};
    const gtx_view view = view_of(&camera);
    const agreement a = stage_compare(s, shown.asset, &view, instances, COUNT);
    if (a.wrong || a.hits < 4000 || a.excluded * 100 > a.hits)
        fail_msg("%ld hits, %ld wrong, %ld excluded", a.hits, a.wrong, a.excluded);
    subject_close(s, &shown);
}

static double linear(double srgb_byte)
{
    return pow((srgb_byte / 255 + 0.055) / 1.055, 2.4);
}

/* Near, and so far away that mip levels are read. */
static void normals_follow_the_transform(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    const float squash[9] = {1, 0, 0, 0, 0.5f, 0, 0, 0, -1}; /* mirrored, too */
    place(shown.instance.transform, squash, 0, 0, 0);
    shown.instance.tint[0] = shown.instance.tint[3] = 1; /* red alone */
    for (int far = 0; far < 2; ++far) {
        gtx_camera camera = {.radius = far ? 16 : 4, .distance = 3, .orthographic = 1};
        gtx_view view = view_of(&camera);
        view.light_direction[0] = view.light_direction[1] = view.light_direction[2] = 1;
        stage_draw(s, &view, &shown.instance, 1);
        /* On the ellipsoid x^2 + 4 y^2 + z^2 = 4 the normal is along (x, 4 y, z). */
        long checked = 0;
        for (int i = 0; i < STAGE_PIXELS; ++i) {
            const double span = camera.radius / 0.96 / STAGE_HEIGHT * 2;
            const double x = (i % STAGE_WIDTH + 0.5 - STAGE_WIDTH / 2.0) * span;
            const double y = (STAGE_HEIGHT / 2.0 - i / STAGE_WIDTH - 0.5) * span;
            const double zz = 4 - x * x - 4 * y * y;
            if (zz < (far ? 1.0 : 0.4))
                continue;
            const double z = sqrt(zz), n = sqrt(x * x + 16 * y * y + z * z);
            const double lambert = fmax((x + 4 * y + z) / (n * sqrt(3)), 0);
            const double red = linear(128 + 60 * x); /* as the fixture colours its sphere */
            const double drawn = linear(s->color[4 * i]), expected = red * (0.2 + 0.8 * lambert);
            if (fabs(drawn - expected) > (far ? 0.05 : 0.015))
                fail_msg("at (%g, %g): drawn %g, expected %g", x, y, drawn, expected);
            assert_int_equal(s->color[4 * i + 1], 0);
            ++checked;
        }
        assert_true(checked > (far ? 100 : 2000));
    }
    subject_close(s, &shown);
}

/* A polygon plane through the sphere, drawn before or after: the same picture, and the sphere's cap
 * in front of the plane. */
static void polygons_share_the_depth_buffer(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    const gtx_polygon_vertex corners[4] = {{{-3, -3, 1}, {0, 0, 1}, {255, 0, 255, 255}, {0}},
                                           {{3, -3, 1}, {0, 0, 1}, {255, 0, 255, 255}, {0}},
                                           {{3, 3, 1}, {0, 0, 1}, {255, 0, 255, 255}, {0}},
                                           {{-3, 3, 1}, {0, 0, 1}, {255, 0, 255, 255}, {0}}};
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    gtx_polygons plane;
    gtx_polygon_program program;
    must(gtx_polygon_program_create(&s->gl, &program, &error), &error);
    must(gtx_polygons_create(&s->gl, &(gtx_polygon_data){corners, indices, 4, 6}, &plane, &error),
         &error);
    gtx_camera camera = {.radius = 4, .azimuth = 10, .elevation = 20, .distance = 2.5f};
    const gtx_view view = view_of(&camera);
    gtx_view lit = view;
    lit.light_direction[2] = 1;
    lit.ambient = 0.2f;
    uint8_t *first = malloc(sizeof s->color);
    for (int order = 0; order < 2; ++order) {
        stage_clear(s, &view);
        for (int step = 0; step < 2; ++step)
            if (step == order) {
                s->gl.Enable(GL_DEPTH_TEST);
                s->gl.DepthFunc(GL_LESS);
                gtx_polygons_draw(&s->gl, &program, &plane, NULL, &lit);
            } else {
                must(gtx_draw(s->renderer, &view, &shown.instance, 1, &error), &error);
            }
        gtx_framebuffer_read_color(&s->gl, &s->framebuffer, order ? s->color : first);
    }
    assert_memory_equal(first, s->color, sizeof s->color);

    /* Each pixel by the mathematics: the ray meets the plane and the ball. */
    const matrix back = matrix_inverse(
        matrix_mul(matrix_of(view.projection), matrix_of(view.view)));
    long caps = 0, planes = 0, wrong = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        double a[3], b[3], oo = 0, od = 0, dd = 0;
        const double x = 2 * (i % STAGE_WIDTH + 0.5) / STAGE_WIDTH - 1;
        const double y = 1 - 2 * (i / STAGE_WIDTH + 0.5) / STAGE_HEIGHT;
        matrix_point(back, (double[3]){x, y, -1}, a);
        matrix_point(back, (double[3]){x, y, 1}, b);
        for (int k = 0; k < 3; ++k) {
            oo += a[k] * a[k];
            od += a[k] * (b[k] - a[k]);
            dd += (b[k] - a[k]) * (b[k] - a[k]);
        }
        const double at_plane = (1 - a[2]) / (b[2] - a[2]), disc = od * od - dd * (oo - 4);
        const double px = a[0] + at_plane * (b[0] - a[0]), py = a[1] + at_plane * (b[1] - a[1]);
        const double at_ball = disc > 0 ? (-od - sqrt(disc)) / dd : 1e9;
        if (fabs(px) > 2.9 || fabs(py) > 2.9 || fabs(disc) < 0.05 * dd ||
            fabs(at_ball - at_plane) * sqrt(dd) < 0.05)
            continue; /* near an edge of something */
        const int is_plane = s->color[4 * i] == 255 && s->color[4 * i + 1] == 0;
        wrong += is_plane != (at_plane < at_ball);
        planes += is_plane;
        caps += !is_plane;
    }
    assert_int_equal(wrong, 0);
    assert_true(caps > 1000 && planes > 1000);
    free(first);
    gtx_polygons_destroy(&s->gl, &plane);
    gtx_polygon_program_destroy(&s->gl, &program);
    subject_close(s, &shown);
}

/* The paper's search finds nearly the same pixels. */
static void paper_mode_roughly_agrees(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *assets[2] = {fixture_sphere(2, 64, 8), fixture_bumpy(8, 0)};
    for (int i = 0; i < 2; ++i) {
        subject shown = subject_open(s, assets[i]);
        gtx_camera camera = camera_around(shown.asset);
        gtx_view view = view_of(&camera);
        float *cast = malloc(sizeof s->depth);
        stage_draw(s, &view, &shown.instance, 1);
        memcpy(cast, s->depth, sizeof s->depth);
        view.method = GTX_METHOD_PAPER;
        stage_draw(s, &view, &shown.instance, 1);
        long both = 0, either = 0;
        for (int p = 0; p < STAGE_PIXELS; ++p) {
            both += cast[p] < 1 && s->depth[p] < 1;
            either += cast[p] < 1 || s->depth[p] < 1;
        }
        if (either < 2000 || (double)both < 0.9 * (double)either)
            fail_msg("%ld of %ld pixels", both, either);
        free(cast);
        subject_close(s, &shown);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(transforms_agree_with_rays),
        cmocka_unit_test(a_mirrored_view),
        cmocka_unit_test(many_instances),
        cmocka_unit_test(normals_follow_the_transform),
        cmocka_unit_test(polygons_share_the_depth_buffer),
        cmocka_unit_test(paper_mode_roughly_agrees),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
