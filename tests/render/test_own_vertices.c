/* An engine's own colours of vertices, by LOD meshes and displaced grids: those of its main, where
 * triangles are fine or even and albedo is all that a model has. */
#include "parts.h"

static int open_for_grids(void **state)
{
    return open_stage_as(state, false);
}

/* A shading of two expressions: at vertices, of normal, eye, albedo and deviation; and of a
 * fragment's surface s. */
#define SHADING(functions, at_vertex, at_fragment)                                                 \
    "#pragma geotex vertices\n" functions                                                          \
    "#ifdef GTX_OWN_VERTICES\n"                                                                    \
    "vec4 gtx_at_vertex(vec3 point, vec3 normal, vec3 eye, vec4 albedo, float deviation)\n"        \
    "{\n"                                                                                          \
    "    return " at_vertex ";\n"                                                                  \
    "}\n"                                                                                          \
    "#else\n"                                                                                      \
    "layout(location = 0) out vec4 color;\n"                                                       \
    "void main()\n"                                                                                \
    "{\n"                                                                                          \
    "    gtx_surface s;\n"                                                                         \
    "    if (!gtx_find(s))\n"                                                                      \
    "        discard;\n"                                                                           \
    "    color = " at_fragment ";\n"                                                               \
    "    gtx_write_depth(s);\n"                                                                    \
    "}\n"                                                                                          \
    "#endif\n"

/* The stock shading, lit from the side. */
static const char like_stock[] = SHADING(
    "vec4 shown(vec4 albedo, vec3 n, vec3 eye, float deviation)\n"
    "{\n"
    "    float light = gtx_diffuse(n, eye, vec3(0.48, 0.6, 0.64), deviation);\n"
    "    return vec4(gtx_to_srgb(albedo.rgb * (0.2 + 0.8 * light)), albedo.a);\n"
    "}\n",
    "shown(albedo, normal, eye, deviation)",
    "shown(gtx_albedo(s), gtx_world_normal(s), -gtx_world_ray(s), s.deviation)");

/* Blue at vertices, else red. */
static const char telling[] = SHADING("", "vec4(0.0, 0.0, 1.0, 1.0)", "vec4(1.0, 0.0, 0.0, 1.0)");

static gtx_shading *shading_of(stage *s, const char *text)
{
    gtx_error error = {0};
    gtx_shading *shading;
    must(gtx_shading_create(s->renderer, text, &shading, &error), &error);
    return shading;
}

/* Turned by `turn`, near or far, and lit as above. */
static gtx_view view_around(const gtx_asset *asset, int turn)
{
    gtx_camera camera = camera_around(asset);
    camera.azimuth = 61.0f * (float)turn;
    camera.elevation = 15.0f * (float)(turn - 2);
    camera.distance = turn % 2 ? 2.6f : 1.7f;
    gtx_view view = view_of(&camera);
    memcpy(view.light_direction, (float[3]){0.48f, 0.6f, 0.64f}, sizeof view.light_direction);
    view.ambient = 0.2f;
    view.viewport_height = STAGE_HEIGHT;
    view.max_error = 0.1f;
    view.level = 1;
    return view;
}

static void as_the_stock_shading(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_shading *shading = shading_of(s, like_stock);
    for (int i = 0; i < 6; ++i) {
        const lod_looks looks = i < 3 ? LOD_PLAIN : LOD_COLORED;
        gtx_asset *asset = i % 3 == 0 ? fixture_sphere(radius, TEXELS, 8)
                                      : fixture_sphere_without(radius, TEXELS, 8, 5);
        subject shown = subject_open(
            s, with_lod_as(asset, radius, 2, i % 3 == 2 ? GTX_PATCH_TWO_SIDED : 0, looks));
        shown.instance.tint[0] = shown.instance.tint[3] = 1;
        shown.instance.tint[1] = 0.4f;
        for (int turn = 0; turn < 12; ++turn) {
            const gtx_method method = turn < 6 ? GTX_METHOD_GRID : GTX_METHOD_LOD;
            gtx_view view = view_around(shown.asset, turn % 6);
            view.level = method == GTX_METHOD_GRID ? 0 : 1;
            draw(s, &view, method, &shown.instance, 1, &first);
            view.shading = shading;
            draw(s, &view, method, &shown.instance, 1, &second);
            const difference d = compare(&first, &second);
            /* Backs of LOD meshes an own main lights by pixels, the stock shading at vertices. */
            const int most = i % 3 == 2 && method == GTX_METHOD_LOD ? 40 : 1;
            if (d.both < 2000 || d.either > d.both || d.mean > 0.1 || d.worst > most)
                fail_msg("%d, %d: %ld of %ld pixels, colours differ by %g, %g at most", i, turn,
                         d.both, d.either, d.mean, d.worst);
        }
        subject_close(s, &shown);
    }
    gtx_shading_destroy(s->renderer, shading);
}

static long count_blue(const picture *p)
{
    long count = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i)
        count += covers(p, i % STAGE_WIDTH, i / STAGE_WIDTH) && p->color[4 * i + 2] == 255;
    return count;
}

static void where_albedo_is_all(void **state)
{
    STAGE_OR_SKIP(state);
    static const struct {
        lod_looks looks;
        gtx_method method;
        bool blue;
    } cases[] = {{LOD_PLAIN, GTX_METHOD_LOD, true},   {LOD_PLAIN, GTX_METHOD_GRID, true},
                 {LOD_COLORED, GTX_METHOD_LOD, false}, {LOD_COLORED, GTX_METHOD_GRID, true},
                 {LOD_EVEN, GTX_METHOD_LOD, false},   {LOD_EVEN, GTX_METHOD_GRID, false},
                 {LOD_SHINY, GTX_METHOD_LOD, false},  {LOD_SHINY, GTX_METHOD_GRID, false},
                 {LOD_PLAIN, GTX_METHOD_CAST, false}};
    gtx_shading *shading = shading_of(s, telling);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        subject shown = subject_open(s, with_lod_as(fixture_sphere(radius, TEXELS, 8), radius, 2,
                                                    0, cases[i].looks));
        gtx_view view = view_around(shown.asset, 1);
        view.shading = shading;
        draw(s, &view, cases[i].method, &shown.instance, 1, &first);
        const long blue = count_blue(&first);
        if ((blue > 0) != cases[i].blue)
            fail_msg("%zu: %ld pixels are blue", i, blue);
        subject_close(s, &shown);
    }
    gtx_shading_destroy(s->renderer, shading);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_the_stock_shading),
        cmocka_unit_test(where_albedo_is_all),
    };
    return cmocka_run_group_tests(tests, open_for_grids, stage_close);
}
