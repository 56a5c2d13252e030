/* An engine with a render hardware interface of its own: geotex says what a frame consists of, the
 * engine uploads and submits it (rhi_submit.h). rhi.h is over OpenGL here; it might be over D3D12,
 * Metal or WebGPU.
 *
 *   rhi ASSET.gtx [--headless OUT.png] [--size WxH] */
#include "host/sample.h"
#include "rhi_submit.h"

#include <string.h>

typedef struct engine {
    const char *path;
    gtx_show show;
    rhi_frames frames;
    gtx_planner *planner;
    gtx_model *model;
    rhi_model uploaded;
} engine;

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    engine *e = user;
    gtx_asset *asset = NULL;
    gtx_result result;
    (void)gl;
    rhi_create(&e->frames.r, loader, NULL);
    e->frames.model = &e->uploaded;
    if ((result = gtx_open_file(e->path, NULL, &asset, error)) ||
        (result = gtx_planner_create(NULL, &e->planner, error)) ||
        (result = gtx_model_prepare(asset, NULL, &e->model, error)))
        return result;
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx_camera_frame(&e->show.camera, info.bounds_min, info.bounds_max);
    gtx_close(asset);
    rhi_upload(&e->frames.r, e->model, &e->uploaded);
    return GTX_OK;
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    engine *e = user;
    gtx_frame frame;
    gtx_view v = {.light_direction = {0.4f, 0.8f, 0.45f}};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    gtx_instance instance = {.model = e->model};
    for (int k = 0; k < 16; k += 5)
        instance.transform[k] = 1;
    gtx_result result = gtx_frame_begin(e->planner, &v, &instance, 1, &frame, error);
    if (result)
        return result;
    gl->Disable(GL_SCISSOR_TEST);
    gl->ClearColor(0.16f, 0.18f, 0.21f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(frame.nearer_is_greater ? GL_GREATER : GL_LESS);
    rhi_fill(&e->frames.r, &e->frames.instances, frame.instances,
             frame.instance_count * sizeof *frame.instances);
    gtx_frame_draws(e->planner, rhi_submit, &e->frames);
    return GTX_OK;
}

int main(int argc, char **argv)
{
    engine e = {.show = {.title = "rhi", .width = 960, .height = 720, .load = load, .draw = draw,
                         .user = &e,
                         .camera = {.azimuth = 30, .elevation = 20, .distance = 1.9f}}};
    return gtx_sample_main(&e.show, argc, argv, &e.path);
}
