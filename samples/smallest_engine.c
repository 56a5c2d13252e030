/* The smallest engine that draws an asset: open, upload, draw.
 *
 *   smallest_engine ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * lib/host stands for what an engine already has: a context, its function loader, a camera. All
 * that geotex needs is in load() and draw(). */
#include "host/sample.h"

#include <geotex/render.h>
#include <string.h>

typedef struct engine {
    const char *path;
    gtx_show show;
    gtx_renderer *renderer;
    gtx_model *model;
} engine;

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    engine *e = user;
    const gtx_renderer_desc desc = {.load = loader};
    gtx_asset *asset = NULL;
    gtx_result result;
    (void)gl;
    if ((result = gtx_open_file(e->path, NULL, &asset, error)) ||
        (result = gtx_renderer_create(&desc, &e->renderer, error)) ||
        (result = gtx_model_create(e->renderer, asset, &e->model, error)))
        return result;
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx_camera_frame(&e->show.camera, info.bounds_min, info.bounds_max);
    gtx_close(asset); /* the model keeps no reference to it */
    return GTX_OK;
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const engine *e = user;
    gl->Disable(GL_SCISSOR_TEST);
    gl->ClearColor(0.16f, 0.18f, 0.21f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

    gtx_view v = {.light_direction = {0.4f, 0.8f, 0.45f}};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    gtx_instance instance = {.model = e->model};
    for (int k = 0; k < 16; k += 5)
        instance.transform[k] = 1;
    return gtx_draw(e->renderer, &v, &instance, 1, error);
}

int main(int argc, char **argv)
{
    engine e = {.show = {.title = "smallest_engine", .width = 960, .height = 720, .load = load,
                         .draw = draw, .user = &e,
                         .camera = {.azimuth = 30, .elevation = 20, .distance = 1.9f}}};
    return gtx_sample_main(&e.show, argc, argv, &e.path);
}
