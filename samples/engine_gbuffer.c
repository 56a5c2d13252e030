/* An engine's own G-buffer and lights: polygons and patches fill it, one pass shades both.
 *
 *   engine_gbuffer ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * The engine decides what is stored: the main of its polygons and the main that it hands to geotex
 * both call `store`, and nothing behind the G-buffer knows which was which. */
#include "host/program.h"
#include "host/sample.h"
#include "host/shapes.h"
#include "host/target.h"

#include <geotex/render.h>
#include <math.h>
#include <string.h>

#define STORE                                                                                      \
    "layout(location = 0) out vec4 albedo;\n"                                                      \
    "layout(location = 1) out vec4 normal;\n"                                                      \
    "void store(vec3 color, float gloss, vec3 n) {\n"                                              \
    "    albedo = vec4(sqrt(color), gloss);\n"                                                     \
    "    normal = vec4(n * 0.5 + 0.5, 1.0);\n"                                                     \
    "}\n"

static const char polygon_main[] = STORE
    "in vec3 world_normal;\n"
    "in vec4 srgb;\n"
    "void main() { store(srgb.rgb * srgb.rgb, 0.1, normalize(world_normal)); }\n";

static const char patch_main[] = STORE
    "void main() {\n"
    "    gtx_surface s;\n"
    "    if (!gtx_find(s)) discard;\n"
    "    store(gtx_albedo(s).rgb, 0.6, gtx_world_normal(s));\n"
    "    gtx_write_depth(s);\n"
    "}\n";

/* The position of a pixel follows from its depth: true depth is all that the lights need. */
static const char light_main[] =
    "uniform sampler2D albedo_map, normal_map, depth_map;\n"
    "uniform mat4 clip;\n"
    "uniform vec4 lights[8];\n" /* place and reach, then colour, of each */
    "in vec2 at;\n"
    "layout(location = 0) out vec4 color;\n"
    "void main()\n"
    "{\n"
    "    vec4 albedo = texture(albedo_map, at);\n"
    "    vec3 n = normalize(texture(normal_map, at).xyz * 2.0 - 1.0);\n"
    "    float depth = texture(depth_map, at).r;\n"
    "    vec4 p = inverse(clip) * vec4(vec3(at, depth) * 2.0 - 1.0, 1.0);\n"
    "    vec4 q = inverse(clip) * vec4(at * 2.0 - 1.0, -1.0, 1.0);\n" /* on the near plane */
    "    vec3 point = p.xyz / p.w, back = q.xyz / q.w - point, view = normalize(back);\n"
    "    vec3 base = albedo.rgb * albedo.rgb, sum = base * vec3(0.06, 0.07, 0.10);\n"
    "    for (int i = 0; i < 8; i += 2) {\n"
    "        vec3 way = lights[i].xyz - point, l = normalize(way);\n"
    "        float fall = 1.0 / (1.0 + dot(way, way) / (lights[i].w * lights[i].w));\n"
    "        float shine = albedo.a * pow(max(dot(n, normalize(l + view)), 0.0), 60.0);\n"
    "        sum += max(dot(n, l), 0.0) * fall * fall * lights[i + 1].rgb * (base + shine);\n"
    "    }\n"
    "    float haze = depth < 1.0 ? smoothstep(4.0, 12.0, length(back)) : 1.0;\n"
    "    color = vec4(sqrt(mix(sum, vec3(0.02, 0.025, 0.04), haze)), 1.0);\n"
    "}\n";
static const float lights[32] = {
    -1.9f, 1.7f, 1.6f, 2.2f, 3.4f, 1.5f, 0.5f, 0, 2.1f, 0.5f, 1.5f, 1.4f, 0.3f, 1.2f, 3.2f, 0,
    1.6f, 2.6f, -1.2f, 2.0f, 2.2f, 0.5f, 1.9f, 0, -2.2f, 0.4f, -0.9f, 1.3f, 0.3f, 2.4f, 0.9f, 0};

typedef struct engine {
    const char *path;
    gtx_polygon_program polygon;
    gtx_polygons solids;
    gtx_renderer *renderer;
    gtx_model *model;
    gtx_shading *shading;
    gtx_instance instance;
    gtx_target target;
    GLuint light;
} engine;

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    engine *e = user;
    const gtx_renderer_desc desc = {.load = loader};
    const gtx_rgb stone = {190, 184, 176};
    gtx_shapes s = {0};
    gtx_asset *asset;
    gtx_info info;
    gtx_result result;
    gtx_shapes_box(&s, (float[3]){0, -0.1f, 0}, (float[3]){24, 0.2f, 24}, 0, stone);
    gtx_shapes_cylinder(&s, (float[3]){0, 0, 0}, 1.1f, 1.0f, 0.25f, stone);
    for (int i = 0; i < 6; ++i) {
        const float turn = 1.0472f * (float)i + 0.9f;
        gtx_shapes_cylinder(&s, (float[3]){2.5f * sinf(turn), 0, 2.5f * cosf(turn) - 0.6f}, 0.2f,
                            0.16f, cosf(turn) < 0 ? 2.6f : 0.7f, stone);
    }
    if ((result = gtx_open_file(e->path, NULL, &asset, error)) ||
        (result = gtx_renderer_create(&desc, &e->renderer, error)) ||
        (result = gtx_model_create(e->renderer, asset, &e->model, error)) ||
        (result = gtx_shading_create(e->renderer, patch_main, &e->shading, error)) ||
        (result = gtx_polygon_program_create_with(gl, polygon_main, &e->polygon, error)) ||
        (result = gtx_host_program_create(gl, gtx_screen_vertex, light_main, &e->light, error)) ||
        (result = gtx_shapes_finish(&s, gl, &e->solids, error)))
        return result;
    gtx_get_info(asset, &info);
    gtx_close(asset);
    gtx_matrix_stand(info.bounds_min, info.bounds_max, (float[3]){0, 0.25f, 0}, 0, 2,
                     e->instance.transform);
    e->instance.model = e->model;
    return GTX_OK;
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    engine *e = user;
    float clip[16];
    GLuint screen;
    gtx_result result = gtx_target_fit(gl, (GLenum[]){GL_RGBA8, GL_RGB10_A2, 0}, &e->target,
                                       &screen, error);
    if (result)
        return result;
    gtx_view v = {.shading = e->shading, .viewport_height = (uint32_t)e->target.height};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    gtx_target_begin(gl, &e->target);
    gtx_polygons_draw(gl, &e->polygon, &e->solids, NULL, &v);
    result = gtx_draw(e->renderer, &v, &e->instance, 1, error);

    gl->BindFramebuffer(GL_FRAMEBUFFER, screen);
    gl->Disable(GL_DEPTH_TEST);
    gl->UseProgram(e->light);
    gtx_matrix_multiply(projection, view, clip);
    gtx_set_matrix(gl, e->light, "clip", clip);
    gl->Uniform4fv(gl->GetUniformLocation(e->light, "lights"), 8, lights);
    gtx_set_texture(gl, e->light, "albedo_map", 0, e->target.colors[0]);
    gtx_set_texture(gl, e->light, "normal_map", 1, e->target.colors[1]);
    gtx_set_texture(gl, e->light, "depth_map", 2, e->target.depth);
    gtx_screen_draw(gl);
    return result;
}

int main(int argc, char **argv)
{
    engine e = {.path = NULL};
    gtx_show show = {.title = "engine_gbuffer", .width = 1280, .height = 720, .load = load,
                     .draw = draw, .user = &e,
                     .camera = {.target = {0, 1.05f, 0}, .radius = 2.6f, .azimuth = 20,
                                .elevation = 16, .distance = 2, .field = 40}};
    return gtx_sample_main(&show, argc, argv, &e.path);
}
