/* Shadows by ray beside a shadow map: one scene, lit in four ways in one picture.
 *
 *   ray_shadows ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * Top left, a shadow map; top right, a ray to the sun from each pixel; bottom left, rays to a disc;
 * bottom right, those and rays to the sky. Patches and polygons call the same
 * functions of geotex_rays.glsl, and no bias has to be tuned. */
#include "host/program.h"
#include "host/sample.h"
#include "host/shapes.h"
#include "host/target.h"
#include "ray_shadows_shaders.h"

#include <geotex/render.h>
#include <stdio.h>
#include <string.h>

enum { INSTANCES = 3, SIZE = 1024, UNIT = 8 };

typedef struct world {
    const char *path;
    gtx_polygon_program plain, polygon;
    gtx_polygons ground;
    gtx_renderer *renderer;
    gtx_shading *shading;
    gtx_instance instances[INSTANCES];
    uint32_t programs[1 + GTX_SHADING_PROGRAMS], program_count;
} world;

/* Draws the map and binds it for the programs. */
static gtx_result shine(const gtx_host_gl *gl, world *w, gtx_error *error)
{
    const gtx_camera sun = {.target = {0, 0.8f, 0}, .radius = 5, .azimuth = -60, .elevation = 24,
                            .distance = 2, .orthographic = 1};
    gtx_view v = {.pass = GTX_PASS_DEPTH, .viewport_height = SIZE};
    float clip[16], right[3], up[3], to_sun[4];
    gtx_target map;
    gtx_camera_matrices(&sun, 1, v.view, v.projection);
    gtx_matrix_multiply(v.projection, v.view, clip);
    gtx_camera_axes(&sun, right, up, to_sun);
    to_sun[3] = -v.projection[10] / v.projection[0] / SIZE; /* 2 / width, -2 / depth of its box */
    gtx_result result = gtx_target_create(gl, SIZE, SIZE, NULL, &map, error);
    if (result)
        return result;
    gtx_target_begin(gl, &map);
    gtx_polygons_draw(gl, &w->plain, &w->ground, NULL, &v);
    result = gtx_draw(w->renderer, &v, w->instances, INSTANCES, error);
    for (uint32_t i = 0; i < w->program_count; ++i) {
        gl->UseProgram(w->programs[i]);
        gtx_set_matrix(gl, w->programs[i], "sun_clip", clip);
        gtx_set_vector(gl, w->programs[i], "to_sun", to_sun);
        gtx_set_texture(gl, w->programs[i], "shadow_map", UNIT, map.depth);
    }
    return result;
}

/* The instances for rays: one asset, three places. */
static gtx_result make_rays(world *w, const gtx_asset *asset, gtx_error *error)
{
    const gtx_rays_desc desc = {.assets = &asset, .asset_count = 1, .max_instances = INSTANCES};
    gtx_ray_instance placed[INSTANCES] = {{0}};
    gtx_rays *rays;
    gtx_result result = gtx_rays_create(w->renderer, &desc, &rays, error);
    for (int i = 0; i < INSTANCES; ++i)
        memcpy(placed[i].transform, w->instances[i].transform, sizeof placed[i].transform);
    if (!result)
        result = gtx_rays_place(w->renderer, rays, placed, INSTANCES, error);
    for (uint32_t i = 0; !result && i < w->program_count; ++i)
        gtx_rays_bind(w->renderer, rays, w->programs[i]);
    return result;
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    static const float places[INSTANCES][4] = { /* x, z of the foot; turn; height */
        {0.2f, 0, -15, 2.2f}, {-1.9f, 0.9f, 60, 1.1f}, {2.0f, 0.6f, 200, 1.3f}};
    world *w = user;
    const gtx_renderer_desc desc = {.load = loader};
    static char patch_text[8192], polygon_text[32768];
    gtx_shapes s = {0};
    gtx_asset *asset;
    gtx_model *model;
    gtx_info info;
    gtx_result result;
    gtx_shapes_box(&s, (float[3]){0, -0.1f, 0}, (float[3]){30, 0.2f, 30}, 0,
                   (gtx_rgb){222, 214, 200});
    snprintf(patch_text, sizeof patch_text, "%s%s", lighting, patch_main);
    snprintf(polygon_text, sizeof polygon_text, "%s%s%s%s%s%s",
             gtx_shader_source("geotex_dialect.glsl"), gtx_shader_source("geotex_records.glsl"),
             gtx_shader_source("geotex_height_field.glsl"),
             gtx_shader_source("geotex_rays.glsl"), lighting, polygon_main);
    if ((result = gtx_open_file(w->path, NULL, &asset, error)) ||
        (result = gtx_renderer_create(&desc, &w->renderer, error)) ||
        (result = gtx_model_create(w->renderer, asset, &model, error)) ||
        (result = gtx_shading_create(w->renderer, patch_text, &w->shading, error)) ||
        (result = gtx_polygon_program_create(gl, &w->plain, error)) ||
        (result = gtx_polygon_program_create_with(gl, polygon_text, &w->polygon, error)) ||
        (result = gtx_shapes_finish(&s, gl, &w->ground, error)))
        return result;
    gtx_get_info(asset, &info);
    for (int i = 0; i < INSTANCES; ++i) {
        const float foot[3] = {places[i][0], 0, places[i][1]};
        w->instances[i].model = model;
        gtx_matrix_stand(info.bounds_min, info.bounds_max, foot, places[i][2], places[i][3],
                         w->instances[i].transform);
    }
    w->programs[0] = w->polygon.program;
    w->program_count = 1 + gtx_shading_programs(w->shading, w->programs + 1);
    result = make_rays(w, asset, error);
    gtx_close(asset);
    return result ? result : shine(gl, w, error);
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const world *w = user;
    gtx_view v = {.shading = w->shading};
    gtx_result result = GTX_OK;
    GLint port[4];
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    gl->GetIntegerv(GL_VIEWPORT, port);
    gl->ClearColor(0.62f, 0.72f, 0.82f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl->Enable(GL_DEPTH_TEST);
    for (int way = 0; !result && way < 4; ++way) {
        for (uint32_t i = 0; i < w->program_count; ++i) {
            gl->UseProgram(w->programs[i]);
            gtx_set_vector(gl, w->programs[i], "way", (float[4]){(float)way});
        }
        gl->Viewport(way % 2 * port[2] / 2, (1 - way / 2) * port[3] / 2, port[2] / 2, port[3] / 2);
        gtx_polygons_draw(gl, &w->polygon, &w->ground, NULL, &v);
        result = gtx_draw(w->renderer, &v, w->instances, INSTANCES, error);
    }
    gl->Viewport(port[0], port[1], port[2], port[3]);
    return result;
}

int main(int argc, char **argv)
{
    world w = {.path = NULL};
    gtx_show show = {.title = "ray_shadows", .width = 1280, .height = 720, .load = load,
                     .draw = draw, .user = &w,
                     .camera = {.target = {0.1f, 0.75f, 0}, .radius = 3, .azimuth = 16,
                                .elevation = 26, .distance = 1.9f, .field = 40}};
    return gtx_sample_main(&show, argc, argv, &w.path);
}
