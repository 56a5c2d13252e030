/* A shadow map for polygons and patches: both cast shadows, both receive them.
 *
 *   shadows ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * Patches are drawn into it by GTX_PASS_DEPTH and read it in a main of the engine's own; `shade` is
 * one function for all. The sun stands still, so its map is drawn once. */
#include "host/program.h"
#include "host/sample.h"
#include "host/shapes.h"
#include "host/target.h"

#include <geotex/render.h>
#include <string.h>

enum { INSTANCES = 3, SIZE = 1024, UNIT = 8 }; /* geotex has units 0..7 */
/* Bias. Of the 4 x 4 texels that are compared the farthest centre lies 2 texels off in x and in y,
 * where a surface that faces the sun at an angle has fallen by 2 sqrt(2) tan(angle) texel widths.
 * One width more is for the map's level of detail, which is half a texel off. At grazing angles the
 * bias is capped: what it would hide is dark without a shadow. */
#define SUN                                                                                        \
    "uniform highp sampler2D shadow_map;\n"                                                        \
    "uniform mat4 sun_clip;\n"                                                                     \
    "uniform vec4 to_sun;\n" /* w: the depth of a texel's width */                                 \
    "layout(location = 0) out vec4 color;\n"                                                       \
    "void shade(vec3 albedo, vec3 point, vec3 n) {\n"                                              \
    "    vec3 q = (sun_clip * vec4(point, 1.0)).xyz * 0.5 + 0.5;\n"                                \
    "    float facing = max(dot(n, to_sun.xyz), 0.0);\n"                                           \
    "    float slope = sqrt(1.0 - min(facing * facing, 1.0)) / max(facing, 0.1);\n"                \
    "    float nearest = min(q.z - to_sun.w * (2.83 * slope + 1.0), 1.0), lit = 0.0;\n"            \
    "    ivec2 size = textureSize(shadow_map, 0);\n"                                               \
    "    ivec2 at = clamp(ivec2(floor(q.xy * vec2(size) - 1.5)), ivec2(0), size - 4);\n"           \
    "    for (int i = 0; i < 16; ++i)\n"                                                           \
    "        lit += step(nearest, texelFetch(shadow_map, at + ivec2(i & 3, i / 4), 0).r);\n"       \
    "    vec3 light = vec3(0.12, 0.14, 0.17) + vec3(1.0, 0.94, 0.84) * (facing * lit / 16.0);\n"   \
    "    color = vec4(sqrt(albedo * light), 1.0);\n"                                               \
    "}\n"

static const char polygon_main[] = SUN
    "in vec3 world_point, world_normal;\n"
    "in vec4 srgb;\n"
    "void main() { shade(srgb.rgb * srgb.rgb, world_point, normalize(world_normal)); }\n";

static const char patch_main[] = SUN
    "void main() {\n"
    "    gtx_surface s;\n"
    "    if (!gtx_find(s)) discard;\n"
    "    shade(gtx_albedo(s).rgb, gtx_world_point(s), gtx_world_normal(s));\n"
    "    gtx_write_depth(s);\n"
    "}\n";

typedef struct world {
    const char *path;
    gtx_polygon_program polygon;
    gtx_polygons solids;
    gtx_renderer *renderer;
    gtx_shading *shading;
    gtx_instance instances[INSTANCES];
} world;

/* Polygons and patches: into the map or into the picture. */
static gtx_result draw_all(const gtx_host_gl *gl, const world *w, const gtx_view *v,
                           const gtx_polygon_program *program, gtx_error *error)
{
    gtx_polygons_draw(gl, program, &w->solids, NULL, v);
    return gtx_draw(w->renderer, v, w->instances, INSTANCES, error);
}

/* Draws the map and binds it for all programs. */
static gtx_result shine(const gtx_host_gl *gl, const world *w, gtx_error *error)
{
    const gtx_camera sun = {.target = {0, 0.8f, 0}, .radius = 5, .azimuth = -52, .elevation = 38,
                            .distance = 2, .orthographic = 1};
    gtx_view v = {.pass = GTX_PASS_DEPTH, .viewport_height = SIZE};
    float clip[16], right[3], up[3], to_sun[4];
    gtx_polygon_program plain;
    gtx_target map;
    gtx_result result;
    gtx_camera_matrices(&sun, 1, v.view, v.projection);
    gtx_matrix_multiply(v.projection, v.view, clip);
    gtx_camera_axes(&sun, right, up, to_sun);
    to_sun[3] = -v.projection[10] / v.projection[0] / SIZE; /* 2 / width, -2 / depth of its box */
    if ((result = gtx_polygon_program_create(gl, &plain, error)) ||
        (result = gtx_target_create(gl, SIZE, SIZE, NULL, &map, error)))
        return result;
    gtx_target_begin(gl, &map);
    result = draw_all(gl, w, &v, &plain, error);
    uint32_t programs[1 + GTX_SHADING_PROGRAMS] = {w->polygon.program};
    const uint32_t count = 1 + gtx_shading_programs(w->shading, programs + 1);
    for (uint32_t i = 0; i < count; ++i) {
        const GLuint p = programs[i];
        gl->UseProgram(p);
        gtx_set_matrix(gl, p, "sun_clip", clip);
        gtx_set_vector(gl, p, "to_sun", to_sun);
        gtx_set_texture(gl, p, "shadow_map", UNIT, map.depth);
    }
    return result;
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    static const float places[INSTANCES][5] = { /* x, y, z of the foot; turn; height */
        {0.3f, 0, 0, -15, 2.2f}, {-2.3f, 0, 0.9f, 60, 1.2f}, {2.2f, 0.7f, -1.3f, 200, 1.3f}};
    const gtx_rgb stone = {222, 214, 200}, wood = {206, 164, 112};
    world *w = user;
    const gtx_renderer_desc desc = {.load = loader};
    gtx_shapes s = {0};
    gtx_asset *asset;
    gtx_model *model;
    gtx_info info;
    gtx_result result;
    gtx_shapes_box(&s, (float[3]){0, -0.1f, 0}, (float[3]){30, 0.2f, 30}, 0, stone);
    gtx_shapes_box(&s, (float[3]){2.2f, 0.35f, -1.3f}, (float[3]){1.2f, 0.7f, 1.2f}, 20, wood);
    gtx_shapes_cylinder(&s, (float[3]){-1.9f, 0, -0.9f}, 0.2f, 0.16f, 2.8f, stone);
    if ((result = gtx_open_file(w->path, NULL, &asset, error)) ||
        (result = gtx_renderer_create(&desc, &w->renderer, error)) ||
        (result = gtx_model_create(w->renderer, asset, &model, error)) ||
        (result = gtx_shading_create(w->renderer, patch_main, &w->shading, error)) ||
        (result = gtx_polygon_program_create_with(gl, polygon_main, &w->polygon, error)) ||
        (result = gtx_shapes_finish(&s, gl, &w->solids, error)))
        return result;
    gtx_get_info(asset, &info);
    gtx_close(asset);
    for (int i = 0; i < INSTANCES; ++i) {
        w->instances[i].model = model;
        gtx_matrix_stand(info.bounds_min, info.bounds_max, places[i], places[i][3], places[i][4],
                         w->instances[i].transform);
    }
    return shine(gl, w, error);
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const world *w = user;
    gtx_view v = {.shading = w->shading};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    gl->ClearColor(0.62f, 0.72f, 0.82f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl->Enable(GL_DEPTH_TEST);
    return draw_all(gl, w, &v, &w->polygon, error);
}

int main(int argc, char **argv)
{
    world w = {.path = NULL};
    gtx_show show = {.title = "shadows", .width = 1280, .height = 720, .load = load, .draw = draw,
                     .user = &w, .camera = {.target = {0.1f, 0.75f, 0}, .radius = 3, .azimuth = 16,
                                            .elevation = 26, .distance = 1.9f, .field = 40}};
    return gtx_sample_main(&show, argc, argv, &w.path);
}
