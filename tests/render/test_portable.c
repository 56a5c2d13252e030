/* One scene by OpenGL 3.3, the newest OpenGL, OpenGL ES 3.0 and the newest OpenGL ES: one picture.
 *
 * The bound: at most one pixel in a thousand differs by more than one step of colour or by more
 * than a millionth in depth. Mesa gives the same bytes; other drivers may compile the two languages
 * to code that rounds differently. */
#define _DEFAULT_SOURCE
#include "look.h"
#include "lods.h"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PICTURES = 6 };

typedef struct album {
    int drawn;
    char version[80];
    struct {
        uint8_t color[4 * STAGE_PIXELS];
        float depth[STAGE_PIXELS];
    } picture[PICTURES];
} album;

/* Versions that Mesa is told to stop at; others ignore it, and then the newest is drawn twice. */
static const struct context {
    const char *name, *variable, *version;
    int es;
} contexts[] = {{"OpenGL", NULL, NULL, 0},
                {"OpenGL 3.3", "MESA_GL_VERSION_OVERRIDE", "3.3", 0},
                {"OpenGL ES", NULL, NULL, 1},
                {"OpenGL ES 3.0", "MESA_GLES_VERSION_OVERRIDE", "3.0", 1}};
enum { CONTEXTS = sizeof contexts / sizeof *contexts };
/* Of the processes that draw, one a context, for Mesa reads versions once; and one's own. */
static album *albums, *drawing;

static gtx_instance placed(const gtx_model *model, float scale, float x, float y, float z)
{
    return (gtx_instance){.model = model, .transform = {scale, 0, 0, 0, 0, fabsf(scale), 0, 0, 0, 0,
                                                        fabsf(scale), 0, x, y, z, 1}};
}

static void keep(stage *s, album *a, int index)
{
    assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
    gtx_framebuffer_read_color(&s->gl, &s->framebuffer, a->picture[index].color);
    gtx_framebuffer_read_depth(&s->gl, &s->framebuffer, a->picture[index].depth);
    assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
}

/* Patches among polygons: a plane cuts through all. */
static void draw_scene(stage *s, const gtx_view *view, const gtx_instance *instances,
                       uint32_t count)
{
    gtx_error error = {0};
    const gtx_polygon_vertex corners[3] = {
        {{-9, -3, -1.5f}, {0, 0.6f, 0.8f}, {200, 220, 90, 255}, {0}},
        {{9, -3, 1}, {0, 0.6f, 0.8f}, {90, 220, 200, 255}, {0}},
        {{0, 5, 0}, {0, 0.6f, 0.8f}, {220, 90, 200, 255}, {0}}};
    const uint32_t order[3] = {0, 1, 2};
    gtx_view lit = *view;
    lit.light_direction[0] = 0.6f;
    lit.light_direction[2] = 0.8f;
    lit.ambient = 0.3f;
    gtx_polygons plane;
    gtx_polygon_program program;
    must(gtx_polygon_program_create(&s->gl, &program, &error), &error);
    must(gtx_polygons_create(&s->gl, &(gtx_polygon_data){corners, order, 3, 3}, &plane, &error),
         &error);
    stage_clear(s, view);
    s->gl.Enable(GL_DEPTH_TEST);
    s->gl.DepthFunc(view->flags & GTX_VIEW_REVERSED_Z ? GL_GREATER : GL_LESS);
    gtx_polygons_draw(&s->gl, &program, &plane, NULL, &lit);
    must(gtx_draw(s->renderer, view, instances, count, &error), &error);
    gtx_polygons_destroy(&s->gl, &plane);
    gtx_polygon_program_destroy(&s->gl, &program);
}

/* LOD mesh or cast by error, cast coarse and orthographic, the paper's search, reversed depth,
 * after an edit on the GPU, and with the state read back. */
static void draw_album(void **state)
{
    static const look steel = {{150, 160, 200, 255}, {230, 90, 200, 255}, {40, 10, 0}};
    static const look brick = {{190, 70, 50, 255}, {255, 200, 0, 255}, {0, 60, 20}};
    STAGE_OR_SKIP(state);
    album *a = drawing;
    gtx_error error = {0};
    subject ball = subject_open(s, with_lod(fixture_sphere(2, 64, 8), 2, 3, 0));
    subject deep = subject_open(s, fixture_sphere(2, 48, 16));
    subject field = subject_open(s, fixture_bumpy(8, GTX_PATCH_TWO_SIDED));
    subject shiny = subject_open(s, repaint(fixture_sphere(2, 48, 8), &steel));
    gtx_asset *edited = repaint(fixture_sphere(2, 48, 8), &brick);
    const gtx_instance instances[] = {
        placed(ball.model, 0.9f, -2.5f, 1, 0),   placed(ball.model, -0.5f, 2.6f, -1.6f, 1),
        placed(shiny.model, 0.8f, 0, -1, 0),     placed(field.model, 0.7f, -1, 1.5f, -0.5f),
        placed(deep.model, 0.3f, 3, 2, 0.5f),    placed(ball.model, 0.12f, -1, -2.5f, 2.2f)};
    for (int i = 0; i < PICTURES; ++i) {
        const gtx_camera camera = {.radius = 4.5f, .azimuth = 20, .elevation = 15, .distance = 2.2f,
                                   .orthographic = i == 1, .reversed_z = i == 3};
        gtx_view view = view_of(&camera);
        view.viewport_height = STAGE_HEIGHT;
        view.level = i == 1 ? 3 : 0;
        view.method = i == 2 ? GTX_METHOD_PAPER : i == 0 ? GTX_METHOD_AUTO : GTX_METHOD_CAST;
        view.flags |= i == 5 ? GTX_VIEW_RESTORE_STATE : 0;
        for (uint32_t patch = 0; i == 4 && patch < 6; patch += 2)
            must(gtx_model_update(s->renderer, shiny.model, edited, patch, &error), &error);
        draw_scene(s, &view, instances, sizeof instances / sizeof *instances);
        keep(s, a, i);
    }
    snprintf(a->version, sizeof a->version, "%s", (const char *)s->gl.GetString(GL_VERSION));
    a->drawn = 1;
    gtx_close(edited);
    subject_close(s, &ball);
    subject_close(s, &deep);
    subject_close(s, &field);
    subject_close(s, &shiny);
}

/* The pictures of a context, drawn in a process of its own. Returns its exit status. */
static int draw_elsewhere(int which)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(draw_album)};
    const struct context *c = &contexts[which];
    int status = -1;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        if (c->variable)
            setenv(c->variable, c->version, 1);
        if (c->es)
            setenv("GEOTEX_ES", "1", 1);
        else
            unsetenv("GEOTEX_ES");
        drawing = &albums[which];
        const int failed = cmocka_run_group_tests_name(c->name, tests, stage_open, stage_close);
        fflush(NULL);
        _exit(failed);
    }
    return child > 0 && waitpid(child, &status, 0) == child ? status : -1;
}

static int differs(const album *a, const album *b, int picture, int pixel)
{
    const uint8_t *p = &a->picture[picture].color[4 * pixel];
    const uint8_t *q = &b->picture[picture].color[4 * pixel];
    int far = fabsf(a->picture[picture].depth[pixel] - b->picture[picture].depth[pixel]) > 1e-6f;
    for (int c = 0; c < 4; ++c)
        far |= abs(p[c] - q[c]) > 1;
    return far;
}

static void all_draw_the_same(void **state)
{
    (void)state;
    if (!albums[0].drawn || !albums[2].drawn)
        skip();
    for (int k = 0; k < CONTEXTS; ++k) {
        print_message("# %s: %s\n", contexts[k].name, albums[k].version);
        assert_true(albums[k].drawn);
        for (int i = 0; i < PICTURES; ++i) {
            long covered = 0, different = 0;
            for (int p = 0; p < STAGE_PIXELS; ++p) {
                covered += albums[0].picture[i].color[4 * p + 3] > 0;
                different += differs(&albums[0], &albums[k], i, p);
            }
            if (different * 1000 > covered || covered < STAGE_PIXELS / 4)
                fail_msg("%s, picture %d: %ld of %ld pixels differ", contexts[k].name, i, different,
                         covered);
        }
    }
}

/* What the pictures show is not one and the same, but for the last one: state read back and put
 * there again changes nothing. */
static void pictures_differ_from_each_other(void **state)
{
    (void)state;
    if (!albums[0].drawn)
        skip();
    const size_t size = sizeof albums[0].picture[0];
    for (int i = 0; i + 2 < PICTURES; ++i)
        assert_memory_not_equal(&albums[0].picture[i], &albums[0].picture[i + 1], size);
    assert_memory_equal(&albums[0].picture[4], &albums[0].picture[5], size);
}

static void every_context_draws(void **state)
{
    const int *statuses = *state;
    for (int k = 0; k < CONTEXTS; ++k)
        assert_int_equal(statuses[k], 0);
}

int main(void)
{
    static int statuses[CONTEXTS];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(every_context_draws, statuses),
        cmocka_unit_test(all_draw_the_same),
        cmocka_unit_test(pictures_differ_from_each_other),
    };
    albums = mmap(NULL, CONTEXTS * sizeof *albums, PROT_READ | PROT_WRITE,
                  MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (albums == MAP_FAILED)
        return 1;
    for (int k = 0; k < CONTEXTS; ++k)
        statuses[k] = draw_elsewhere(k);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
