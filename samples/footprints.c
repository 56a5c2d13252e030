/* Editing while it is drawn: somebody walks over the surface, and every step stays.
 *
 *   footprints ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * A step is a stamp on the surface, across all patches that it meets; those alone are sent to the GPU
 * again, and the next frame shows them. Without a window the picture holds four moments of the walk. */
#include "host/sample.h"

#include <geotex/edit.h>
#include <geotex/render.h>
#include <math.h>
#include <string.h>

enum { MOMENTS = 4, STEPS_A_MOMENT = 7, SOLE = 48, FRAMES_A_STEP = 20 };

typedef struct walk {
    const char *path;
    gtx_show show;
    int still;                /* four moments in one picture */
    gtx_renderer *renderer;
    gtx_model *model;
    gtx_asset *asset;
    gtx_caster *caster;       /* of the ground as it was: it tells where to step */
    gtx_edit *edit;
    float sole[SOLE * SOLE];
    float at[3], up[3], ahead[3];
    int frames, steps;
} walk;

/* A heel and a ball, deep in the middle, and the ground that they push up around them. */
static void draw_sole(float *sole)
{
    for (int i = 0; i < SOLE * SOLE; ++i) {
        const float x = ((float)(i % SOLE) + 0.5f) / SOLE * 2 - 1;
        const float y = 1 - ((float)i / SOLE + 0.5f) / SOLE * 2;
        const float ball = hypotf(x / 0.34f, (y - 0.25f) / 0.5f);
        const float heel = hypotf(x / 0.26f, (y + 0.5f) / 0.32f);
        const float r = fminf(ball, heel);
        const float dent = r < 1.15f ? 1 - powf(r / 1.15f, 4) : 0;
        sole[i] = dent - 0.3f * expf(-30 * (r - 1.3f) * (r - 1.3f));
    }
}

static void cross(const float a[3], const float b[3], float out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Goes a stride on, turning a little, with the ground under it. Returns 0 where there is none. */
static int go(walk *w, float stride)
{
    float side[3], length = 0, along = 0;
    cross(w->up, w->ahead, side);
    gtx_ray ray = {.t_max = 6 * stride};
    for (int k = 0; k < 3; ++k) {
        w->ahead[k] += 0.14f * side[k];
        ray.origin[k] = w->at[k] + stride * w->ahead[k] + 3 * stride * w->up[k];
        ray.direction[k] = -w->up[k];
    }
    gtx_hit hit;
    gtx_raycast(w->caster, &ray, &hit, 1, 0);
    if (isinf(hit.t))
        return 0;
    for (int k = 0; k < 3; ++k) {
        w->at[k] = ray.origin[k] + hit.t * ray.direction[k];
        w->up[k] = 0.5f * w->up[k] + 0.5f * hit.normal[k];
        along += w->ahead[k] * w->up[k];
    }
    for (int k = 0; k < 3; ++k) {
        w->ahead[k] -= along * w->up[k];
        length += w->ahead[k] * w->ahead[k];
    }
    for (int k = 0; k < 3; ++k)
        w->ahead[k] /= sqrtf(length);
    return 1;
}

/* One step: the stamp, and the patches that it changed to the GPU. */
static gtx_result step(walk *w, gtx_error *error)
{
    const float texel = gtx_edit_texel_size(w->edit);
    gtx_edit_stamp_desc stamp = {.radius = 11 * texel, .depth = 2.2f * texel,
                                 .image = {w->sole, SOLE, SOLE}};
    const gtx_asset *edited;
    const uint32_t *patches;
    uint32_t count;
    float side[3];
    if (!go(w, 13 * texel))
        return GTX_OK;
    cross(w->up, w->ahead, side);
    for (int k = 0; k < 3; ++k) {
        stamp.centre[k] = w->at[k] + (w->steps % 2 ? 5.5f : -5.5f) * texel * side[k];
        stamp.direction[k] = -w->up[k];
        stamp.up[k] = w->ahead[k];
    }
    ++w->steps;
    gtx_result result = gtx_edit_stamp(w->edit, &stamp, error);
    if (!result)
        result = gtx_edit_refresh(w->edit, &edited, &patches, &count, error);
    for (uint32_t i = 0; !result && i < count; ++i)
        result = gtx_model_update(w->renderer, w->model, edited, patches[i], error);
    return result;
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    walk *w = user;
    const gtx_renderer_desc desc = {.load = loader};
    gtx_info info;
    gtx_result result;
    (void)gl;
    if ((result = gtx_open_file(w->path, NULL, &w->asset, error)) ||
        (result = gtx_renderer_create(&desc, &w->renderer, error)) ||
        (result = gtx_model_create(w->renderer, w->asset, &w->model, error)) ||
        (result = gtx_caster_create(w->asset, NULL, &w->caster, error)) ||
        (result = gtx_edit_begin(w->asset, NULL, &w->edit, error)))
        return result;
    gtx_get_info(w->asset, &info);
    draw_sole(w->sole);
    gtx_camera *camera = &w->show.camera;
    for (int k = 0; k < 3; ++k)
        camera->target[k] = (info.bounds_min[k] + info.bounds_max[k]) / 2;
    camera->radius = (info.bounds_max[0] - info.bounds_min[0]) / 2;
    *camera = (gtx_camera){.target = {camera->target[0], camera->target[1], camera->target[2]},
                           .radius = camera->radius, .azimuth = 10, .elevation = 40, .distance = 2};
    /* The walk starts in the middle of the picture. */
    gtx_ray ray = {.t_max = 0};
    gtx_hit hit;
    float right[3], above[3], back[3];
    gtx_camera_axes(camera, right, above, back);
    for (int k = 0; k < 3; ++k) {
        ray.origin[k] = camera->target[k] + 4 * camera->radius * back[k];
        ray.direction[k] = -back[k];
    }
    gtx_raycast(w->caster, &ray, &hit, 1, 0);
    for (int k = 0; k < 3 && !isinf(hit.t); ++k) {
        w->at[k] = ray.origin[k] + hit.t * ray.direction[k];
        w->up[k] = hit.normal[k];
        w->ahead[k] = right[k];
    }
    return GTX_OK;
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    walk *w = user;
    GLint whole[4];
    gtx_result result = GTX_OK;
    gl->GetIntegerv(GL_VIEWPORT, whole);
    gl->ClearColor(0.16f, 0.18f, 0.21f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gtx_view v = {.light_direction = {-0.6f, 0.7f, 0.2f}};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    const gtx_instance instance = {
        .model = w->model, .transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    for (int moment = 0; !result && moment < (w->still ? MOMENTS : 1); ++moment) {
        const int steps = w->still ? STEPS_A_MOMENT * (moment > 0) : w->frames++ % FRAMES_A_STEP == 0;
        for (int i = 0; !result && i < steps; ++i)
            result = step(w, error);
        const int half = w->still ? 2 : 1;
        gl->Viewport(moment % 2 * whole[2] / 2, (w->still ? 1 - moment / 2 : 0) * whole[3] / 2,
                     whole[2] / half, whole[3] / half);
        if (!result)
            result = gtx_draw(w->renderer, &v, &instance, 1, error);
    }
    gl->Viewport(whole[0], whole[1], whole[2], whole[3]);
    return result;
}

int main(int argc, char **argv)
{
    static walk w; /* large */
    w.show = (gtx_show){.title = "footprints", .width = 1280, .height = 960, .load = load,
                        .draw = draw, .user = &w};
    for (int i = 1; i < argc; ++i)
        w.still |= !strcmp(argv[i], "--headless");
    return gtx_sample_main(&w.show, argc, argv, &w.path);
}
