/* Geometry textures among polygons: one light, one depth buffer, one picture.
 *
 *   mixed_scene ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * Columns, crates and a tiled floor are ordinary polygons and cut through instances of the asset.
 * Nothing is sorted and nothing is clipped: both renderers write true depth. */
#include "host/backdrop.h"
#include "host/jobs.h"
#include "host/shapes.h"
#include "host/sample.h"

#include <geotex/render.h>
#include <math.h>
#include <string.h>

enum { INSTANCES = 6 };
static const float light[3] = {-0.47f, 0.73f, 0.496f};

/* x, y, z of the foot; turn in degrees; radius; tint. */
static const float places[INSTANCES][8] = {
    {0.05f, 0, 0, 15, 1.6f, 0.90f, 0.88f, 0.84f},
    {-2.75f, 0, 0.55f, -30, 1.25f, 0.72f, 0.30f, 0.19f},
    {2.75f, 0, 0.6f, 70, 1.2f, 0.20f, 0.45f, 0.40f},
    {2.1f, -0.2f, -2.6f, -50, 1.4f, 0.70f, 0.50f, 0.16f},
    {-2.1f, -0.3f, -3.1f, 120, 1.3f, 0.45f, 0.40f, 0.42f},
    {1.3f, 0, 2.2f, 215, 0.6f, 0.30f, 0.36f, 0.66f}};

typedef struct world {
    const char *path;
    gtx_polygon_program program;
    gtx_polygons solids;
    gtx_backdrop backdrop;
    gtx_renderer *renderer;
    gtx_model *model;
    gtx_instance instances[INSTANCES];
    const gtx_host_gl *gl;
} world;

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

static gtx_result build_solids(world *w, gtx_error *error)
{
    static const gtx_rgb stone = {206, 198, 186}, dark = {126, 121, 116}, wood = {186, 142, 92};
    static const float columns[4][2] = {{-2.95f, 0.4f}, {-1.9f, -3.3f}, {2.2f, -3}, {4.6f, -1.2f}};
    static const float crates[4][5] = {{3.05f, 0.45f, 0.4f, 0.9f, 25},
                                       {4.1f, 0.35f, 1.35f, 0.7f, -12},
                                       {-1.85f, 0.3f, 1.9f, 0.6f, 40},
                                       {1.6f, 0.2f, 2.1f, 0.4f, 15}}; /* centre, side, turn */
    gtx_shapes s = {0};
    for (int i = 0; i < 4; ++i) {
        const float x = columns[i][0], z = columns[i][1], *c = crates[i];
        gtx_shapes_box(&s, (float[3]){x, 0.09f, z}, (float[3]){0.8f, 0.18f, 0.8f}, 0, dark);
        gtx_shapes_cylinder(&s, (float[3]){x, 0.18f, z}, 0.27f, 0.22f, 2.7f, stone);
        gtx_shapes_box(&s, (float[3]){x, 2.96f, z}, (float[3]){0.72f, 0.16f, 0.72f}, 0, dark);
        gtx_shapes_box(&s, c, (float[3]){c[3], c[3], c[3]}, c[4], wood);
    }
    return gtx_shapes_finish(&s, w->gl, &w->solids, error);
}

/* Everything but the floor: for the camera and, once, for the light that shades the floor. */
static gtx_result draw_standing(const float view[16], const float projection[16], void *user,
                                gtx_error *error)
{
    const world *w = user;
    gtx_view v = {.ambient = 0.22f};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    memcpy(v.light_direction, light, sizeof light);
    GLint viewport[4]; /* its height lets each instance have the level that half a pixel allows */
    w->gl->GetIntegerv(GL_VIEWPORT, viewport);
    v.viewport_width = (uint32_t)viewport[2];
    v.viewport_height = (uint32_t)viewport[3];
    gtx_polygons_draw(w->gl, &w->program, &w->solids, NULL, &v);
    return gtx_draw(w->renderer, &v, w->instances, INSTANCES, error);
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const world *w = user;
    gtx_backdrop_draw(gl, &w->program, &w->backdrop, view, projection);
    return draw_standing(view, projection, user, error);
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    world *w = user;
    const gtx_jobs jobs = gtx_host_jobs(0); /* an engine would lend its own threads */
    const gtx_open_desc open = {.jobs = &jobs};
    const gtx_renderer_desc desc = {.load = loader, .jobs = &jobs};
    gtx_asset *asset = NULL;
    gtx_result result;
    w->gl = gl;
    if ((result = gtx_open_file(w->path, &open, &asset, error)) ||
        (result = gtx_polygon_program_create(gl, &w->program, error)) ||
        (result = gtx_renderer_create(&desc, &w->renderer, error)) ||
        (result = gtx_model_create(w->renderer, asset, &w->model, error)) ||
        (result = build_solids(w, error)))
        return result;
    place_instances(w, asset);
    gtx_close(asset); /* a model keeps no reference to it */
    const gtx_backdrop_desc floor = {.side = 24, .light = light, .draw = draw_standing, .user = w};
    return gtx_backdrop_create(gl, &floor, &w->backdrop, error);
}

int main(int argc, char **argv)
{
    world w = {0};
    gtx_show show = {.title = "mixed_scene", .width = 1280, .height = 720, .load = load,
                     .draw = draw, .user = &w};
    show.camera = (gtx_camera){.target = {0.2f, 1.0f, 0}, .radius = 5.5f, .azimuth = 8,
                               .elevation = 15, .distance = 1.5f, .field = 36};
    return gtx_sample_main(&show, argc, argv, &w.path);
}
