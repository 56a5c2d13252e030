/* Mains of the engine's own, by casting and on the LOD mesh, without a word from the context. */
#include "lods.h"
#include "witness.h"

/* Object and world positions in the colour; a uniform of the engine's own scales them. */
static void a_main_of_the_engines_own(void **state)
{
    STAGE_OR_SKIP(state);
    static const char text[] =
        "#pragma geotex tiles\n"
        "uniform vec4 scale;\n"
        "layout(location = 0) out vec4 color;\n"
        "void main()\n"
        "{\n"
        "    gtx_surface s;\n"
        "    if (!gtx_find(s))\n"
        "        discard;\n"
        "    vec3 at = scale.w > 0.0 ? gtx_world_point(s) : gtx_object_point(s);\n"
        "    color = vec4(at * scale.x + 0.5, float(gtx_id) / 255.0);\n"
        "    gtx_write_depth(s);\n"
        "}\n";
    gtx_error error = {0};
    gtx_shading *shading;
    subject shown = subject_open(s, with_lod(fixture_sphere(2, 64, 8), 2, 2, 0));
    gtx_instance instance = shown.instance;
    const float linear[9] = {0, 0.8f, 0.1f, -0.7f, 0, 0, 0, 0.2f, 0.9f};
    const float move[3] = {0.3f, -0.2f, 0.5f};
    for (int i = 0; i < 9; ++i)
        instance.transform[i / 3 * 4 + i % 3] = linear[i];
    memcpy(instance.transform + 12, move, sizeof move);
    instance.id = 77;
    const gtx_camera camera = {.radius = 2.5f, .azimuth = 25, .elevation = 20, .distance = 2.5f};
    gtx_view view = view_of(&camera);
    must(gtx_shading_create(s->renderer, text, &shading, &error), &error);
    view.shading = shading;
    const matrix back = matrix_inverse(
        matrix_mul(matrix_of(view.projection), matrix_of(view.view)));
    const matrix to_object = matrix_inverse(matrix_of(instance.transform));
    uint32_t programs[GTX_SHADING_PROGRAMS];
    const uint32_t count = gtx_shading_programs(shading, programs);
    for (int i = 0; i < 8; ++i) { /* from 4 on by tiles, or as patches are chosen */
        const int world = i % 2;
        const float scale[4] = {0.2f, 0, 0, (float)world};
        long checked = 0;
        static const gtx_method methods[] = {GTX_METHOD_CAST, GTX_METHOD_LOD, GTX_METHOD_CAST,
                                             GTX_METHOD_GRID};
        view.method = methods[i / 2];
        view.flags |= GTX_VIEW_SHADING_BY_TILES;
        by_tiles(&view);
        view.viewport_width = i < 4 ? 0 : STAGE_WIDTH;
        for (uint32_t k = 0; k < count; ++k) {
            s->gl.UseProgram(programs[k]);
            s->gl.Uniform4fv(s->gl.GetUniformLocation(programs[k], "scale"), 1, scale);
        }
        stage_draw(s, &view, &instance, 1);
        for (int p = 0; p < STAGE_PIXELS; ++p) {
            if (s->depth[p] == 1)
                continue;
            double at[3];
            matrix_point(back, (double[3]){2 * (p % STAGE_WIDTH + 0.5) / STAGE_WIDTH - 1,
                                           1 - 2 * (p / STAGE_WIDTH + 0.5) / STAGE_HEIGHT,
                                           2 * (double)s->depth[p] - 1}, at);
            if (!world)
                matrix_point(to_object, at, at);
            for (int k = 0; k < 3; ++k)
                assert_true(fabs(255 * (0.2 * at[k] + 0.5) - s->color[4 * p + k]) < 0.6);
            assert_int_equal(s->color[4 * p + 3], 77);
            ++checked;
        }
        assert_true(checked > 5000);
    }
    view.method = GTX_METHOD_PAPER;
    assert_int_equal(gtx_draw(s->renderer, &view, &instance, 1, NULL), GTX_ERROR_ARGUMENT);
    view.method = GTX_METHOD_CAST;
    view.pass = GTX_PASS_DEPTH;
    assert_int_equal(gtx_draw(s->renderer, &view, &instance, 1, NULL), GTX_ERROR_ARGUMENT);
    gtx_shading_destroy(s->renderer, shading);
    subject_close(s, &shown);
}

/* A main that reads a varying of proxies does not say that it can: it is drawn without tiles. */
static void not_all_mains_have_tiles(void **state)
{
    STAGE_OR_SKIP(state);
    static const char text[] =
        "layout(location = 0) out vec4 color;\n"
        "void main()\n"
        "{\n"
        "    gtx_surface s;\n"
        "    if (!gtx_find(s))\n"
        "        discard;\n"
        "#ifdef GTX_LOD\n"
        "    color = vec4(1.0);\n"
        "#else\n"
        "    color = vec4(fract(gtx_point), 1.0);\n"
        "#endif\n"
        "    gtx_write_depth(s);\n"
        "}\n";
    gtx_error error = {0};
    gtx_shading *shading;
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    const gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    must(gtx_shading_create(s->renderer, text, &shading, &error), &error);
    view.shading = shading;
    view.method = GTX_METHOD_CAST;
    view.flags |= GTX_VIEW_SHADING_BY_TILES;
    by_tiles(&view);
    stage_draw(s, &view, &shown.instance, 1);
    int covered = 0;
    for (int p = 0; p < STAGE_PIXELS; ++p)
        covered += s->color[4 * p + 3] == 255;
    assert_true(covered > 5000);
    gtx_shading_destroy(s->renderer, shading);
    subject_close(s, &shown);
}

static void keep_log(const char *message, void *user)
{
    snprintf(user, 256, "%s", message);
}

static void bad_mains_are_refused(void **state)
{
    STAGE_OR_SKIP(state);
    char log[256] = "";
    counter c = {-1, 0};
    const gtx_allocator hooks = {counted_alloc, counted_free, &c};
    const gtx_renderer_desc desc = {.load = gtx_offscreen_load, .log = keep_log, .log_user = log,
                                    .allocator = &hooks};
    gtx_renderer *renderer;
    gtx_shading *shading = NULL;
    gtx_error error = {0};
    must(gtx_renderer_create(&desc, &renderer, &error), &error);
    assert_int_equal(gtx_shading_create(renderer, "void main() { nonsense(); }", &shading, &error),
                     GTX_ERROR_SHADER);
    assert_non_null(strstr(log, "nonsense"));
    /* By the engine's own line. */
    assert_int_equal(gtx_shading_create(renderer, "void main()\n{\n\n\n\n    nonsense();\n}\n",
                                        &shading, &error), GTX_ERROR_SHADER);
    if (!strstr(log, ":6") && !strstr(log, "(6)")) /* drivers write lines so or so */
        fail_msg("%s", log);
    assert_null(shading);
    assert_int_equal(gtx_shading_create(renderer, NULL, &shading, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_shading_create(NULL, "", &shading, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_shading_create(renderer, "", NULL, NULL), GTX_ERROR_ARGUMENT);
    c.until_failure = 0;
    assert_int_equal(gtx_shading_create(renderer, "void main() {}", &shading, NULL),
                     GTX_ERROR_MEMORY);
    gtx_shading_destroy(renderer, NULL);
    gtx_renderer_destroy(renderer);
    assert_int_equal(c.bytes, 0);
    (void)s;
}

static void nobody_complained(void **state)
{
    STAGE_OR_SKIP(state);
    expect_no_complaint(s, 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_main_of_the_engines_own),
        cmocka_unit_test(not_all_mains_have_tiles),
        cmocka_unit_test(nobody_complained),
        cmocka_unit_test(bad_mains_are_refused),
    };
    return cmocka_run_group_tests(tests, open_watched, stage_close);
}
