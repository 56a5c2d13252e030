/* Geometry textures among polygons: one light, one depth buffer, one picture.
 *
 *   mixed_scene ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * Columns, crates and a tiled floor are ordinary polygons and cut through instances of the asset.
 * Nothing is sorted and nothing is clipped: both renderers write true depth. */
#include "host/backdrop.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"
#include "host/shapes.h"
#include "host/window.h"
#include "image/image.h"

#include <geotex/render.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { INSTANCES = 5, SUPERSAMPLE = 2 };
static const float light[3] = {-0.47f, 0.73f, 0.496f};

/* x, y, z of the foot; turn in degrees; radius; tint. */
static const float places[INSTANCES][8] = {
    {0.1f, 0.34f, 0, 15, 1.55f, 0.90f, 0.88f, 0.84f},
    {-2.75f, 0, 0.7f, -30, 1.25f, 0.72f, 0.30f, 0.19f},
    {2.75f, 0, 0.6f, 70, 1.2f, 0.20f, 0.45f, 0.40f},
    {-1.2f, -0.25f, -3.2f, 160, 1.4f, 0.70f, 0.50f, 0.16f},
    {1.35f, 0, 2.2f, 215, 0.6f, 0.30f, 0.36f, 0.66f}};

typedef struct world {
    gtx_host_gl gl;
    gtx_polygon_program program;
    gtx_polygons solids;
    gtx_backdrop backdrop;
    gtx_renderer *renderer;
    gtx_model *model;
    gtx_instance instances[INSTANCES];
} world;

static void must(gtx_result result, const gtx_error *error)
{
    if (result) {
        fprintf(stderr, "mixed_scene: %s\n", error->message);
        exit(EXIT_FAILURE);
    }
}

/* Stands the asset on its places, its lowest point at the foot. */
static void place_instances(world *w, const gtx_asset *asset)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    const float *low = info.bounds_min, *high = info.bounds_max;
    const float size[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    const float radius = sqrtf(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]) / 2;
    for (int i = 0; i < INSTANCES; ++i) {
        const float *p = places[i];
        float center[16], place[16];
        gtx_matrix_place(-low[0] - size[0] / 2, -low[1], -low[2] - size[2] / 2, 0, 1, center);
        gtx_matrix_place(p[0], p[1], p[2], p[3], p[4] / radius, place);
        gtx_matrix_multiply(place, center, w->instances[i].transform);
        w->instances[i].model = w->model;
        memcpy(w->instances[i].tint, (float[4]){p[5], p[6], p[7], 1}, 4 * sizeof(float));
    }
}

static void build_solids(world *w, gtx_error *error)
{
    static const gtx_rgb stone = {206, 198, 186}, dark = {126, 121, 116}, wood = {172, 122, 70};
    static const float columns[4][2] = {{-2.95f, 0.5f}, {-1.9f, -3.3f}, {2.2f, -3.0f}, {4.6f, -1.2f}};
    static const float crates[4][5] = {{3.05f, 0.45f, 0.4f, 0.9f, 25},
                                       {4.1f, 0.35f, 1.35f, 0.7f, -12},
                                       {-1.75f, 0.3f, 2.0f, 0.6f, 40},
                                       {1.6f, 0.2f, 2.1f, 0.4f, 15}};
    gtx_shapes s = {0};
    gtx_shapes_cylinder(&s, (float[3]){0, 0, 0}, 1.6f, 1.56f, 0.18f, dark);
    gtx_shapes_cylinder(&s, (float[3]){0, 0.18f, 0}, 1.4f, 1.36f, 0.18f, stone);
    for (int i = 0; i < 4; ++i) {
        const float x = columns[i][0], z = columns[i][1];
        gtx_shapes_box(&s, (float[3]){x, 0.09f, z}, (float[3]){0.8f, 0.18f, 0.8f}, 0, dark);
        gtx_shapes_cylinder(&s, (float[3]){x, 0.18f, z}, 0.27f, 0.22f, 2.7f, stone);
        gtx_shapes_box(&s, (float[3]){x, 2.96f, z}, (float[3]){0.72f, 0.16f, 0.72f}, 0, dark);
    }
    for (int i = 0; i < 4; ++i) {
        const float *c = crates[i];
        gtx_shapes_box(&s, c, (float[3]){c[3], c[3], c[3]}, c[4], wood);
    }
    must(gtx_shapes_finish(&s, &w->gl, &w->solids, error), error);
}

/* Everything but the floor, for the camera and, once, for the light. */
static gtx_result draw_standing(const float view[16], const float projection[16], void *user,
                                gtx_error *error)
{
    const world *w = user;
    gtx_view v = {.ambient = 0.22f};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    memcpy(v.light_direction, light, sizeof light);
    gtx_polygons_draw(&w->gl, &w->program, &w->solids, NULL, view, projection, light, v.ambient);
    return gtx_draw(w->renderer, &v, w->instances, INSTANCES, error);
}

static void draw_world(world *w, const gtx_camera *camera, int width, int height, gtx_error *error)
{
    float view[16], projection[16];
    gtx_camera_matrices(camera, (float)width / (float)height, view, projection);
    w->gl.Viewport(0, 0, width, height);
    gtx_backdrop_draw(&w->gl, &w->program, &w->backdrop, view, projection);
    must(draw_standing(view, projection, w, error), error);
}

static void load(world *w, const char *path, gtx_host_load loader, gtx_error *error)
{
    const gtx_renderer_desc desc = {.load = loader};
    gtx_asset *asset;
    must(gtx_open_file(path, NULL, &asset, error), error);
    must(gtx_host_gl_init(&w->gl, loader, NULL, error), error);
    must(gtx_polygon_program_create(&w->gl, &w->program, error), error);
    must(gtx_renderer_create(&desc, &w->renderer, error), error);
    must(gtx_model_create(w->renderer, asset, &w->model, error), error);
    place_instances(w, asset);
    gtx_close(asset); /* a model keeps no reference to it */
    build_solids(w, error);
    must(gtx_backdrop_create(&w->gl, 24, light, draw_standing, w, &w->backdrop, error), error);
}

static void write_still(const char *asset, const gtx_camera *camera, int width, int height,
                        const char *path)
{
    const int n = SUPERSAMPLE;
    world w = {0};
    gtx_error error;
    gtx_offscreen *context;
    gtx_framebuffer target;
    must(gtx_offscreen_create(&context, &error), &error);
    load(&w, asset, gtx_offscreen_load, &error);
    must(gtx_framebuffer_create(&w.gl, n * width, n * height, &target, &error), &error);
    draw_world(&w, camera, n * width, n * height, &error);
    uint8_t *pixels = calloc((size_t)width * height, (size_t)4 * n * n);
    if (!pixels)
        exit(EXIT_FAILURE);
    gtx_framebuffer_read_color(&w.gl, &target, pixels);
    gtx_average_down(pixels, width, height, n);
    must(gtx_image_write_png(path, (uint32_t)width, (uint32_t)height, 4, pixels, &error), &error);
    free(pixels);
    gtx_offscreen_destroy(context);
}

static void show_window(const char *asset, gtx_camera *camera, int width, int height)
{
    world w = {0};
    gtx_error error;
    gtx_window *window;
    must(gtx_window_create("mixed scene", width, height, camera, &window, &error), &error);
    load(&w, asset, gtx_window_load, &error);
    while (gtx_window_next(window, &width, &height))
        draw_world(&w, camera, width, height, &error);
    gtx_window_destroy(window);
}

int main(int argc, char **argv)
{
    gtx_camera camera = {.target = {0.2f, 1.05f, 0}, .radius = 5.5f, .azimuth = 8,
                         .elevation = 14, .distance = 1.5f, .field = 36};
    const char *asset = NULL, *still = NULL;
    int width = 1280, height = 720, bad = 0;
    for (int i = 1; i < argc; ++i)
        if (strcmp(argv[i], "--headless") == 0 && i + 1 < argc)
            still = argv[++i];
        else if (strcmp(argv[i], "--size") == 0 && i + 1 < argc)
            bad |= sscanf(argv[++i], "%dx%d", &width, &height) != 2;
        else if (argv[i][0] != '-' && !asset)
            asset = argv[i];
        else
            bad = 1;
    if (!asset || bad || width < 1 || height < 1 || width > 8192 || height > 8192) {
        fprintf(stderr, "usage: mixed_scene ASSET.gtx [--headless OUT.png] [--size WxH]\n");
        return 1;
    }
    if (still)
        write_still(asset, &camera, width, height, still);
    else
        show_window(asset, &camera, width, height);
    return 0;
}
