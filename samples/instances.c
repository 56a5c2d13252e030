/* Many instances: one model, one array of transforms and tints, one call.
 *
 *   instances ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * The cost of an instance follows the pixels it covers: those far away are nearly free. */
#include "host/backdrop.h"
#include "host/sample.h"

#include <geotex/render.h>
#include <math.h>
#include <string.h>

enum { ROWS = 20, COUNT = ROWS * ROWS };
static const float light[3] = {-0.45f, 0.75f, 0.48f};

typedef struct field {
    const char *path;
    gtx_renderer *renderer;
    gtx_model *model;
    gtx_instance instances[COUNT];
    gtx_polygon_program program;
    gtx_backdrop backdrop;
} field;

/* 0..1, the same for the same index in every run. */
static float scatter(int i, float k)
{
    const float s = sinf((float)(i + 1) * k) * 43758.5f;
    return s - floorf(s);
}

static void place(field *f, const gtx_asset *asset)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    for (int i = 0; i < COUNT; ++i) {
        const float x = (float)(i % ROWS) - ROWS / 2 + 0.3f * scatter(i, 12.9f);
        const float z = (float)(i / ROWS) - ROWS / 2 + 0.3f * scatter(i, 78.2f);
        const float size = 0.45f + 0.3f * scatter(i, 37.7f);
        gtx_instance *instance = &f->instances[i];
        gtx_matrix_stand(info.bounds_min, info.bounds_max, (float[3]){1.3f * x, 0, 1.3f * z},
                         360 * scatter(i, 4.1f), size, instance->transform);
        instance->model = f->model; /* a run of the same model is one draw call */
        for (int k = 0; k < 3; ++k)
            instance->tint[k] = 0.35f + 0.65f * scatter(i, 9.7f + (float)k);
        instance->tint[3] = 1;
    }
}

static gtx_result draw_field(const float view[16], const float projection[16], void *user,
                             gtx_error *error)
{
    const field *f = user;
    gtx_view v = {.ambient = 0.22f};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    memcpy(v.light_direction, light, sizeof light);
    return gtx_draw(f->renderer, &v, f->instances, COUNT, error);
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    field *f = user;
    const gtx_renderer_desc desc = {.load = loader};
    gtx_asset *asset = NULL;
    gtx_result result;
    if ((result = gtx_open_file(f->path, NULL, &asset, error)) ||
        (result = gtx_polygon_program_create(gl, &f->program, error)) ||
        (result = gtx_renderer_create(&desc, &f->renderer, error)) ||
        (result = gtx_model_create(f->renderer, asset, &f->model, error)))
        return result;
    place(f, asset);
    gtx_close(asset);
    const gtx_backdrop_desc floor = {.side = 30, .light = light, .draw = draw_field, .user = f};
    return gtx_backdrop_create(gl, &floor, &f->backdrop, error);
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const field *f = user;
    gtx_backdrop_draw(gl, &f->program, &f->backdrop, view, projection);
    return draw_field(view, projection, user, error);
}

int main(int argc, char **argv)
{
    static field f; /* large */
    gtx_show show = {.title = "instances", .width = 1280, .height = 720, .load = load,
                     .draw = draw, .user = &f};
    show.camera = (gtx_camera){.target = {0, 0.2f, 6}, .radius = 12, .azimuth = 24,
                               .elevation = 16, .distance = 0.62f, .field = 40};
    return gtx_sample_main(&show, argc, argv, &f.path);
}
