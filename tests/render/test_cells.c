/* What drawing costs, in cells that fragments visit: the shaders are made to count them while they
 * are compiled, and fragments add up in the framebuffer. No pixel takes more than gtx_ray_cells of
 * a box or of tiles, and no fragment of a hull more than width and height of its patch. */
#include "render/renderer.h"
#include "stage.h"

#include "common/mad.h"

/* Around the context's own functions, which the counting renderer is given in their place. */
static PFNGLSHADERSOURCEPROC shader_source;
static PFNGLDISABLEPROC disable;
static PFNGLDEPTHFUNCPROC depth_func;

/* Takes the place of the main of a fragment that casts. */
static const char counting_main[] =
    "layout(location = 0) out vec4 gtx_out_counts;\n"
    "void main()\n"
    "{\n"
    "    gtx_surface s;\n"
    "    gtx_find(s);\n"
    "    gtx_out_counts = vec4(gtx_looked.x);\n"
    "    gl_FragDepth = 0.5;\n"
    "}\n";

/* The first text is the version, the last one of a fragment shader its main. */
static void APIENTRY counting_source(GLuint shader, GLsizei count, const GLchar *const *texts,
                                     const GLint *lengths)
{
    const GLchar *all[32];
    const bool casts = strstr(texts[count - 1], "gtx_find(s)");
    assert_null(lengths);
    assert_in_range(count, 2, 31);
    all[0] = texts[0];
    all[1] = casts ? "#define GTX_COUNT\n" : "";
    memcpy(all + 2, texts + 1, (size_t)(count - 1) * sizeof *texts);
    if (casts)
        all[count] = counting_main;
    shader_source(shader, count + 1, all, NULL);
}

static void APIENTRY keep_blending(GLenum what)
{
    if (what != GL_BLEND)
        disable(what);
}

static void APIENTRY always(GLenum function)
{
    (void)function;
    depth_func(GL_ALWAYS);
}

static gtx_gl_proc load_counting(const char *name, void *user)
{
    if (!strcmp(name, "glShaderSource"))
        return (gtx_gl_proc)counting_source;
    if (!strcmp(name, "glDisable"))
        return (gtx_gl_proc)keep_blending;
    if (!strcmp(name, "glDepthFunc"))
        return (gtx_gl_proc)always;
    return gtx_offscreen_load(name, user);
}

typedef enum technique { HULLS, BOXES, TILES } technique;

static gtx_renderer *counting_renderer(technique by)
{
    gtx_renderer *renderer = NULL;
    gtx_error error = {0};
    const gtx_renderer_desc desc = {.load = load_counting, .log = stage_log,
                                    .tiles = by == TILES ? GTX_TILES_ALWAYS : GTX_TILES_NEVER};
    shader_source = (PFNGLSHADERSOURCEPROC)gtx_offscreen_load("glShaderSource", NULL);
    disable = (PFNGLDISABLEPROC)gtx_offscreen_load("glDisable", NULL);
    depth_func = (PFNGLDEPTHFUNCPROC)gtx_offscreen_load("glDepthFunc", NULL);
    must(gtx_renderer_create(&desc, &renderer, &error), &error);
    return renderer;
}

#define GL_FUNCTION(type, name) const type name = (type)gtx_offscreen_load("gl" #name, NULL)

/* The most cells of all fragments of a pixel together, or of one of them alone. */
static double most_visited(stage *s, const gtx_view *view, const gtx_instance *instance,
                           GLenum equation)
{
    static float counts[4 * STAGE_PIXELS];
    GL_FUNCTION(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers);
    GL_FUNCTION(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers);
    GL_FUNCTION(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer);
    GL_FUNCTION(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage);
    GL_FUNCTION(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer);
    GL_FUNCTION(PFNGLBLENDFUNCPROC, BlendFunc);
    GL_FUNCTION(PFNGLBLENDEQUATIONPROC, BlendEquation);
    GL_FUNCTION(PFNGLREADPIXELSPROC, ReadPixels);
    GLuint color;
    gtx_error error = {0};
    gtx_framebuffer_bind(&s->gl, &s->framebuffer);
    GenRenderbuffers(1, &color);
    BindRenderbuffer(GL_RENDERBUFFER, color);
    RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, STAGE_WIDTH, STAGE_HEIGHT);
    FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
    s->gl.ClearColor(0, 0, 0, 0);
    s->gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    s->gl.Enable(GL_BLEND);
    BlendFunc(GL_ONE, GL_ONE);
    BlendEquation(equation);
    must(gtx_draw(s->renderer, view, instance, 1, &error), &error);
    disable(GL_BLEND);
    BlendEquation(GL_FUNC_ADD);
    ReadPixels(0, 0, STAGE_WIDTH, STAGE_HEIGHT, GL_RGBA, GL_FLOAT, counts);
    FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                            s->framebuffer.color);
    DeleteRenderbuffers(1, &color);
    assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
    double most = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i)
        most = fmax(most, (double)counts[4 * i]);
    return most;
}

/* The most of some views, one of which skims the patches. */
static double most_of_views(stage *s, const gtx_asset *asset, technique by, GLenum equation)
{
    gtx_model *model = NULL;
    gtx_error error = {0};
    const gtx_model_desc desc = {.limits.cells = UINT64_MAX};
    must(gtx_model_prepare(asset, &desc, &model, &error), &error);
    must(gtx_model_upload(s->renderer, model, 0, NULL, &error), &error);
    gtx_instance instance = {.model = model};
    memcpy(instance.transform, identity, sizeof identity);
    const float angles[][2] = {{27, 33}, {90, 0}, {90, 6}, {0, 0}, {118, 12}};
    double most = 0;
    for (size_t i = 0; i < sizeof angles / sizeof *angles; ++i) {
        gtx_camera camera = camera_around(asset);
        camera.azimuth = angles[i][0];
        camera.elevation = angles[i][1];
        camera.distance = i % 2 ? 0.8f : 2;
        gtx_view view = view_of(&camera);
        view.method = GTX_METHOD_CAST;
        view.level = 1;
        if (by == TILES)
            by_tiles(&view);
        most = fmax(most, most_visited(s, &view, &instance, equation));
    }
    gtx_model_destroy(s->renderer, model);
    return most;
}

static void expect_share(gtx_asset *asset, technique by, double least, double greatest)
{
    stage *s = &the_stage;
    gtx_renderer *own = s->renderer;
    s->renderer = counting_renderer(by);
    const uint64_t before = s->renderer->planner.tiles.draws, bound = gtx_ray_cells(asset);
    const double most = most_of_views(s, asset, by, GL_FUNC_ADD);
    const bool tiled = s->renderer->planner.tiles.draws > before;
    gtx_renderer_destroy(s->renderer);
    s->renderer = own;
    assert_int_equal(tiled, by == TILES);
    if (most > greatest * (double)bound || most < least * (double)bound)
        fail_msg("a pixel visits %g cells, at most %llu", most, (unsigned long long)bound);
    gtx_close(asset);
}

static void expect_at_most(gtx_asset *asset, technique by, double least_share)
{
    expect_share(asset, by, least_share, 1);
}

/* Sides over 512 texels are cast by their boxes. */
static void boxes_are_cast_once(void **state)
{
    STAGE_OR_SKIP(state);
    if (s->renderer->gl.es)
        skip();
    expect_at_most(mad_asset(1, 576, MAD_STACK, MAD_GAUZE), BOXES, 0.4);
    expect_at_most(mad_asset(4, 520, MAD_STACK, MAD_GAUZE), BOXES, 0.4);
    expect_at_most(mad_asset(1, 576, MAD_STACK, MAD_NEEDLES), BOXES, 0);
}

/* Above and below what is in a block, a ray looks at none of its cells. */
static void boxes_are_skipped_through(void **state)
{
    STAGE_OR_SKIP(state);
    if (s->renderer->gl.es)
        skip();
    expect_share(mad_asset(1, 4096, MAD_STACK, MAD_RIDGES), BOXES, 0, 0.3);
}

static void tiles_look_at_each_cell_once(void **state)
{
    STAGE_OR_SKIP(state);
    if (s->renderer->gl.es)
        skip();
    expect_at_most(fixture_sphere(2, 64, 8), TILES, 0);
    expect_at_most(mad_asset(60, 32, MAD_STACK, MAD_GAUZE), TILES, 0.4);
    expect_at_most(mad_asset(1, 576, MAD_STACK, MAD_GAUZE), TILES, 0.4);
}

/* A fragment of a hull stays in its patch; a ray may pass a face for each of its blocks. */
static void hulls_are_cast_from_each_face(void **state)
{
    STAGE_OR_SKIP(state);
    if (s->renderer->gl.es)
        skip();
    gtx_asset *assets[] = {fixture_sphere(2, 64, 8), mad_asset(60, 32, MAD_STACK, MAD_GAUZE),
                           mad_asset(1, 512, MAD_STACK, MAD_RIDGES)};
    gtx_renderer *own = s->renderer;
    s->renderer = counting_renderer(HULLS);
    for (int i = 0; i < 3; ++i) {
        const gtx_patch *p = gtx_patches(assets[i]);
        const double cells = (double)p->rect[2] + p->rect[3], faces = 2 + cells / 16;
        const double alone = most_of_views(s, assets[i], HULLS, GL_MAX);
        const double all = most_of_views(s, assets[i], HULLS, GL_FUNC_ADD);
            if (!(alone > 0) || alone > cells || all > faces * (double)gtx_ray_cells(assets[i]))
            fail_msg("asset %d: %g of %g cells alone, %g of %g together", i, alone, cells, all,
                     faces * (double)gtx_ray_cells(assets[i]));
        gtx_close(assets[i]);
    }
    gtx_renderer_destroy(s->renderer);
    s->renderer = own;
}

/* Slabs that all reach across the picture would be listed in every tile. */
static void needles_are_left_to_fragments(void **state)
{
    STAGE_OR_SKIP(state);
    if (s->renderer->gl.es)
        skip();
    gtx_renderer *own = s->renderer;
    gtx_asset *asset = mad_asset(1, 1024, MAD_STACK, MAD_NEEDLES);
    s->renderer = counting_renderer(TILES);
    assert_true(most_of_views(s, asset, TILES, GL_FUNC_ADD) > 0);
    assert_int_equal(s->renderer->planner.tiles.draws, 0);
    assert_true(s->renderer->planner.tiles.lists.size < 8 * STAGE_PIXELS);
    gtx_renderer_destroy(s->renderer);
    s->renderer = own;
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_cast_once),
        cmocka_unit_test(boxes_are_skipped_through),
        cmocka_unit_test(tiles_look_at_each_cell_once),
        cmocka_unit_test(hulls_are_cast_from_each_face),
        cmocka_unit_test(needles_are_left_to_fragments),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
