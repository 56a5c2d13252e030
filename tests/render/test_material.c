/* Materials: what metallic, roughness, occlusion, emission and unlit do to a sphere. */
#include "render/renderer.h"
#include "look.h"

/* What a sphere of that look shows: the middle of the picture (facing the light), its brightest
 * pixel, and the mean over the sphere. */
typedef struct shown {
    int middle[3], brightest;
    double mean;
} shown;

static shown draw_sphere(stage *s, look l, float ambient)
{
    subject sphere = subject_open(s, repaint(fixture_sphere(2, 48, 8), &l));
    gtx_camera camera = camera_around(sphere.asset);
    gtx_view view = view_of(&camera); /* the light is at the camera */
    view.ambient = ambient;
    stage_draw(s, &view, &sphere.instance, 1);
    subject_close(s, &sphere);
    shown out = {.mean = 0};
    double sum = 0;
    long count = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        const uint8_t *p = &s->color[4 * i];
        const int value = p[0] + p[1] + p[2];
        sum += p[3] ? value : 0;
        count += p[3] > 0;
        out.brightest = value > out.brightest ? value : out.brightest;
    }
    out.mean = sum / (double)count;
    for (int c = 0; c < 3; ++c)
        out.middle[c] = s->color[4 * (STAGE_HEIGHT / 2 * STAGE_WIDTH + STAGE_WIDTH / 2) + c];
    return out;
}

static const look clay = {{180, 120, 60, 255}, {255, 255, 0, 255}, {0, 0, 0}};

static void rough_looks_like_its_colour(void **state)
{
    STAGE_OR_SKIP(state);
    const shown clay_shown = draw_sphere(s, clay, 0.2f);
    for (int c = 0; c < 3; ++c) /* a little more by the specular reflection of a rough wall */
        assert_in_range(clay_shown.middle[c], clay.color[c] - 4, clay.color[c] + 24);
}

static void smooth_has_a_highlight(void **state)
{
    STAGE_OR_SKIP(state);
    look smooth = clay;
    smooth.material[1] = 60;
    const shown a = draw_sphere(s, clay, 0.2f), b = draw_sphere(s, smooth, 0.2f);
    assert_true(b.brightest > a.brightest + 150);
    assert_true(b.mean < a.mean + 30); /* small */
}

static void metal_is_dark_but_for_its_tinted_highlight(void **state)
{
    STAGE_OR_SKIP(state);
    look metal = clay;
    metal.material[1] = 90;
    metal.material[2] = 255;
    const shown a = draw_sphere(s, clay, 0.05f), b = draw_sphere(s, metal, 0.05f);
    assert_true(b.mean < 0.8 * a.mean);
    assert_true(b.brightest > a.brightest);
    assert_true(b.middle[0] > b.middle[2] + 20); /* the colour of the metal, not of the light */
}

static void occlusion_darkens_what_no_light_reaches(void **state)
{
    STAGE_OR_SKIP(state);
    look hidden = clay;
    hidden.material[0] = 0;
    const shown a = draw_sphere(s, clay, 1), b = draw_sphere(s, hidden, 1);
    for (int c = 0; c < 3; ++c) {
        assert_in_range(a.middle[c], clay.color[c] - 4, clay.color[c] + 24);
        assert_in_range(b.middle[c], 0, 3);
    }
}

static void unlit_shows_its_colour_everywhere(void **state)
{
    STAGE_OR_SKIP(state);
    look unlit = clay;
    unlit.material[3] = 0;
    const shown a = draw_sphere(s, unlit, 0.2f);
    for (int c = 0; c < 3; ++c)
        assert_in_range(a.middle[c], unlit.color[c] - 1, unlit.color[c] + 1);
    assert_true(fabs(a.mean - (180 + 120 + 60)) < 3);
}

static void emission_shines_in_the_dark(void **state)
{
    STAGE_OR_SKIP(state);
    look lamp = clay;
    memset(lamp.color, 0, 3);
    memcpy(lamp.emission, (uint8_t[3]){20, 200, 90}, 3);
    const shown a = draw_sphere(s, lamp, 0.2f);
    assert_in_range(a.middle[1], 196, 215);
    assert_in_range(a.middle[2], 86, 125);
    assert_true(a.mean > 20 + 200 + 90 - 6);
}

/* With parallel rays the half vector is the eye's direction itself, up to rounding. */
static void a_headlight_leaves_no_dark_specks(void **state)
{
    STAGE_OR_SKIP(state);
    subject sphere = subject_open(s, repaint(fixture_sphere(2, 48, 8), &clay));
    for (int i = 0; i < 8; ++i) {
        gtx_camera camera = camera_around(sphere.asset);
        camera.azimuth = 11.0f * (float)i;
        camera.orthographic = 1;
        gtx_view view = view_of(&camera);
        view.ambient = 0.5f;
        stage_draw(s, &view, &sphere.instance, 1);
        for (int p = 0; p < STAGE_PIXELS; ++p)
            assert_true(!s->color[4 * p + 3] || s->color[4 * p] > 100);
    }
    subject_close(s, &sphere);
}

/* How far the picture of the displaced grid is from that of the cast sphere, in the mean and at
 * most; and what share of its triangles look maps up. */
static double compare_grid(stage *s, look l, int *most, double *mapped)
{
    subject sphere = subject_open(s, repaint(fixture_sphere(2, 48, 8), &l));
    gtx_camera camera = camera_around(sphere.asset);
    gtx_view view = view_of(&camera);
    uint8_t *cast = malloc(sizeof s->color);
    const uint32_t *corners = s->renderer->planner.grids.index_count;
    double all = 0, looked_up = 0, sum = 0;
    view.method = GTX_METHOD_CAST;
    stage_draw(s, &view, &sphere.instance, 1);
    memcpy(cast, s->color, sizeof s->color);
    view.method = GTX_METHOD_GRID;
    stage_draw(s, &view, &sphere.instance, 1);
    for (uint32_t k = 0; k < GTX_GRID_LOOKS; ++k) {
        all += corners[k];
        looked_up += k & GTX_GRID_MAPPED ? corners[k] : 0;
    }
    *most = 0;
    *mapped = looked_up / all;
    for (int i = 0; i < 4 * STAGE_PIXELS; ++i) {
        const int off = cast[i | 3] && s->color[i | 3] ? abs(s->color[i] - cast[i]) : 0;
        *most = off > *most ? off : *most;
        sum += off;
    }
    free(cast);
    subject_close(s, &sphere);
    return sum / (4.0 * STAGE_PIXELS);
}

/* Where nothing gleams, the light at corners is enough, whatever the material. */
static void corners_have_what_maps_have(void **state)
{
    STAGE_OR_SKIP(state);
    look glossy = clay, lamp = clay;
    int most;
    double mapped;
    memcpy(lamp.emission, (uint8_t[3]){20, 200, 90}, 3);
    lamp.material[0] = 100;
    lamp.material[1] = 150;
    glossy.material[1] = 90;
    bool *on_gpu = &s->renderer->planner.on_gpu, usual = *on_gpu;
    *on_gpu = false; /* there are grids, whatever the driver is */
    assert_true(compare_grid(s, clay, &most, &mapped) < 0.02 && most < 24 && mapped == 0);
    assert_true(compare_grid(s, lamp, &most, &mapped) < 0.02 && most < 24 && mapped == 0);
    assert_true(compare_grid(s, glossy, &most, &mapped) < 0.02 && most < 24 && mapped == 1);
    *on_gpu = usual;
}

/* Models with and without materials in one draw, in any order, are as each alone. */
static void programs_change_within_a_draw(void **state)
{
    STAGE_OR_SKIP(state);
    look smooth = clay;
    smooth.material[1] = 60;
    subject plain = subject_open(s, fixture_sphere(2, 48, 8));
    subject shiny = subject_open(s, repaint(fixture_sphere(2, 48, 8), &smooth));
    gtx_camera camera = camera_around(plain.asset);
    camera.distance = 6;
    const gtx_view view = view_of(&camera);
    gtx_instance both[3] = {plain.instance, shiny.instance, plain.instance};
    both[0].transform[12] = -3;
    both[1].transform[12] = 3;
    both[2].transform[13] = 5;
    uint8_t *first = malloc(sizeof s->color);
    stage_draw(s, &view, both, 3);
    memcpy(first, s->color, sizeof s->color);
    const gtx_instance turned[3] = {both[1], both[2], both[0]};
    stage_draw(s, &view, turned, 3);
    assert_memory_equal(first, s->color, sizeof s->color);
    stage_draw(s, &view, both, 1); /* what the plain one alone shows is in the picture of all */
    long same = 0, covered = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        covered += s->color[4 * i + 3] > 0;
        same += s->color[4 * i + 3] > 0 && !memcmp(&first[4 * i], &s->color[4 * i], 4);
    }
    assert_true(covered > 500 && same > covered * 9 / 10);
    free(first);
    subject_close(s, &plain);
    subject_close(s, &shiny);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rough_looks_like_its_colour),
        cmocka_unit_test(smooth_has_a_highlight),
        cmocka_unit_test(metal_is_dark_but_for_its_tinted_highlight),
        cmocka_unit_test(occlusion_darkens_what_no_light_reaches),
        cmocka_unit_test(unlit_shows_its_colour_everywhere),
        cmocka_unit_test(emission_shines_in_the_dark),
        cmocka_unit_test(a_headlight_leaves_no_dark_specks),
        cmocka_unit_test(corners_have_what_maps_have),
        cmocka_unit_test(programs_change_within_a_draw),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
