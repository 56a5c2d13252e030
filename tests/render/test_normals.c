/* What normals make of light: those that a mip level has averaged, and those seen from behind. */
#include "stage.h"

#include <stdbool.h>

/* Normals that lean by an angle along x: one way, or one way and the other from texel to texel; all
 * of them, or sixteen columns of 64, none of which is in the middle. */
typedef struct leaning {
    double angle;
    bool alternates, is_rare;
} leaning;

static void leaning_field(const gtx_patch *patch, double x, double y, const void *user,
                          fixture_texel *out)
{
    const leaning *l = user;
    (void)patch;
    (void)y;
    double side = !l->alternates ? 1 : x != floor(x) ? 0 : fmod(x, 2) < 1 ? 1 : -1;
    if (l->is_rare && fmod(x + 32, 64) >= 16)
        side = 0;
    *out = (fixture_texel){.height = 0.5, .trim = -8, .color = {255, 255, 255, 255},
                           .normal = {side * sin(l->angle), 0, cos(l->angle)}};
}

/* A square of the plane z = 0, around the origin. */
static subject sheet_open(stage *s, const leaning *l, uint16_t flags)
{
    enum { SIDE = 256 };
    const double pitch = 1.0 / 64, low = -0.5 * (SIDE - 1) * pitch;
    fixture_patch patch = {fixture_frame((double[]){low, low, -0.5}, SIDE, SIDE, pitch, 1),
                           leaning_field, l};
    patch.frame.flags = flags;
    return subject_open(s, fixture_build(&patch, 1, 8, 4));
}

static double linear_of(int code)
{
    const double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/* Of pixels around the middle, without ambient light. */
static double light_in_the_middle(stage *s, const gtx_view *from, gtx_method method,
                                  const subject *shown, bool tiles)
{
    gtx_view view = *from;
    double sum = 0;
    view.level = 1;
    view.ambient = 1e-6f; /* 0 would be as usual */
    if (tiles || method == GTX_METHOD_GRID) /* which takes mip levels by the pixel's size */
        by_tiles(&view);
    view.method = method;
    stage_draw(s, &view, &shown->instance, 1);
    for (int k = 0; k < 64; ++k) {
        const int x = STAGE_WIDTH / 2 - 4 + k % 8, y = STAGE_HEIGHT / 2 - 4 + k / 8;
        assert_true(s->depth[y * STAGE_WIDTH + x] < 1);
        sum += linear_of(s->color[4 * (y * STAGE_WIDTH + x)]) / 64;
    }
    return sum;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* What facets of both kinds reflect together, each as large as the eye sees it. */
static double light_of_facets(double angle, const double eye[3], const double light[3])
{
    double lit = 0, seen = 0;
    for (int side = -1; side <= 1; side += 2) {
        const double n[3] = {side * sin(angle), 0, cos(angle)};
        lit += fmax(dot(n, eye), 0) * fmax(dot(n, light), 0);
        seen += fmax(dot(n, eye), 0);
    }
    return lit / seen;
}

/* Cast in fragments, cast by tiles, as a displaced grid. */
enum { WAYS = 3 };

static double light_by(stage *s, const gtx_view *view, const subject *shown, int way)
{
    return light_in_the_middle(s, view, way < 2 ? GTX_METHOD_CAST : GTX_METHOD_GRID, shown,
                               way == 1);
}

/* A surface that is rough below a pixel: seen from the front and obliquely, lit from the eye and
 * from elsewhere. */
static void small_facets_are_lit_as_seen(void **state)
{
    STAGE_OR_SKIP(state);
    const leaning rough = {0.5, true, false};
    subject shown = sheet_open(s, &rough, 0);
    for (int i = 0; i < 6; ++i) {
        gtx_camera camera = {.radius = 8, .azimuth = 45, .elevation = 35.2644f, .distance = 2,
                             .orthographic = 1};
        if (i % 3 == 0)
            camera.azimuth = camera.elevation = 0;
        gtx_view view = view_of(&camera);
        double eye[3], light[3];
        for (int k = 0; k < 3; ++k) {
            eye[k] = (double)view.view[4 * k + 2];
            light[k] = i < 3 ? eye[k] : k == 2 ? 0.8 : -sqrt(0.18);
            if (i % 3 == 2)
                light[k] = k == 2 ? 1 : 0;
            view.light_direction[k] = (float)light[k];
        }
        const double wanted = light_of_facets(rough.angle, eye, light);
        for (int way = 0; way < WAYS; ++way) {
            const double lit = light_by(s, &view, &shown, way);
            if (fabs(lit - wanted) > 0.03)
                fail_msg("view %d, way %d: %g, but facets give %g", i, way, lit, wanted);
        }
    }
    subject_close(s, &shown);
}

/* A pane with a few grooves is as smooth between them as one without. */
static void grooves_frost_no_pane(void **state)
{
    STAGE_OR_SKIP(state);
    const leaning grooves = {1.2, true, true};
    subject shown = sheet_open(s, &grooves, 0);
    gtx_camera camera = {.radius = 2, .distance = 4, .orthographic = 1};
    gtx_view view = view_of(&camera);
    const double light[3] = {-0.98, 0, 0.199};
    for (int k = 0; k < 3; ++k)
        view.light_direction[k] = (float)light[k];
    for (int way = 0; way < WAYS; ++way) {
        const double lit = light_by(s, &view, &shown, way);
        if (fabs(lit - light[2]) > 0.01)
            fail_msg("way %d: %g, but a pane has %g", way, lit, light[2]);
    }
    subject_close(s, &shown);
}

/* A two-sided mesh turns its normals round where its back is seen, however obliquely. */
static void backs_have_turned_normals(void **state)
{
    STAGE_OR_SKIP(state);
    const leaning even = {0.3, false, false};
    const double n[3] = {sin(even.angle), 0, cos(even.angle)};
    subject shown = sheet_open(s, &even, GTX_PATCH_TWO_SIDED);
    for (int i = 0; i < 5; ++i) {
        gtx_camera camera = {.radius = 3, .azimuth = 180 - 15 * (float)i, .elevation = 10,
                             .distance = 4};
        gtx_view view = view_of(&camera);
        const double light[3] = {0.6, 0, -0.8};
        for (int k = 0; k < 3; ++k)
            view.light_direction[k] = (float)light[k];
        for (int way = 0; way < WAYS; ++way) {
            const double lit = light_by(s, &view, &shown, way);
            if (fabs(lit + dot(n, light)) > 0.02)
                fail_msg("view %d, way %d: %g, but the mesh has %g", i, way, lit, -dot(n, light));
        }
    }
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(small_facets_are_lit_as_seen),
                                       cmocka_unit_test(grooves_frost_no_pane),
                                       cmocka_unit_test(backs_have_turned_normals)};
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
