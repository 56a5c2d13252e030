/* Picking: the ray through the mouse, cast into the asset on the CPU, and a pin where it hits.
 *
 *   picking ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * The caster sees the surface that the GPU draws: no read-back, no frame of delay. */
#include "host/sample.h"
#include "host/shapes.h"

#include <geotex/render.h>
#include <math.h>
#include <string.h>

typedef struct picker {
    const char *path;
    gtx_show show;
    gtx_renderer *renderer;
    gtx_model *model;
    gtx_caster *caster;
    gtx_polygon_program program;
    gtx_polygons pin; /* along +Y, its tip at the origin, one unit long */
} picker;

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    picker *p = user;
    const gtx_renderer_desc desc = {.load = loader};
    const gtx_rgb steel = {190, 195, 205}, red = {214, 44, 38};
    gtx_asset *asset = NULL;
    gtx_info info;
    gtx_shapes s = {0};
    gtx_result result;
    gtx_shapes_cylinder(&s, (float[3]){0, 0, 0}, 0.005f, 0.03f, 1, steel);
    gtx_shapes_cylinder(&s, (float[3]){0, 1, 0}, 0.16f, 0.16f, 0.12f, red);
    if ((result = gtx_open_file(p->path, NULL, &asset, error)) ||
        (result = gtx_renderer_create(&desc, &p->renderer, error)) ||
        (result = gtx_model_create(p->renderer, asset, &p->model, error)) ||
        (result = gtx_caster_create(asset, NULL, &p->caster, error)) ||
        (result = gtx_polygon_program_create(gl, &p->program, error)) ||
        (result = gtx_shapes_finish(&s, gl, &p->pin, error)))
        return result;
    gtx_get_info(asset, &info);
    gtx_close(asset); /* neither model nor caster keeps a reference to it */
    gtx_camera *camera = &p->show.camera;
    gtx_camera_frame(camera, info.bounds_min, info.bounds_max);
    camera->azimuth = -20;
    camera->elevation = 25;
    camera->distance = 2.2f;
    return GTX_OK;
}

/* The world ray through a point of clip space. A view matrix turns and moves, so its inverse is its
 * transpose; a perspective projection is diagonal but for the depth. */
static gtx_ray mouse_ray(const float view[16], const float projection[16], const float at[2])
{
    const float eye[3] = {at[0] / projection[0], at[1] / projection[5], -1};
    gtx_ray ray = {.t_max = 0}; /* 0: infinity */
    for (int k = 0; k < 3; ++k) {
        const float *column = view + 4 * k;
        ray.direction[k] = column[0] * eye[0] + column[1] * eye[1] + column[2] * eye[2];
        ray.origin[k] = -(column[0] * view[12] + column[1] * view[13] + column[2] * view[14]);
    }
    return ray;
}

/* Stands the pin on the hit, along the normal. */
static void place_pin(const gtx_ray *ray, const gtx_hit *hit, float size, float out[16])
{
    const float *n = hit->normal;
    const float side[3] = {fabsf(n[0]) < 0.8f, 0, fabsf(n[0]) >= 0.8f};
    float x[3] = {n[1] * side[2] - n[2] * side[1], n[2] * side[0] - n[0] * side[2],
                  n[0] * side[1] - n[1] * side[0]};
    const float length = sqrtf(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    memset(out, 0, 16 * sizeof *out);
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = size * x[k] / length;
        out[4 + k] = size * n[k];
        out[8 + k] = size * (x[i] * n[j] - x[j] * n[i]) / length;
        out[12 + k] = ray->origin[k] + hit->t * ray->direction[k];
    }
    out[15] = 1;
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const picker *p = user;
    const float light[3] = {0.40f, 0.80f, 0.45f};
    gl->ClearColor(0.16f, 0.18f, 0.21f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

    gtx_view v = {.ambient = 0.25f};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    memcpy(v.light_direction, light, sizeof light);
    const gtx_instance instance = {
        .model = p->model, .transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    gtx_result result = gtx_draw(p->renderer, &v, &instance, 1, error);

    const gtx_ray ray = mouse_ray(view, projection, p->show.pointer);
    gtx_hit hit;
    gtx_raycast(p->caster, &ray, &hit, 1, 0); /* the asset stands untransformed in the world */
    if (!isinf(hit.t)) {
        float pin[16];
        place_pin(&ray, &hit, 0.2f * p->show.camera.radius, pin);
        gtx_polygons_draw(gl, &p->program, &p->pin, pin, &v);
    }
    return result;
}

int main(int argc, char **argv)
{
    picker p = {.show = {.title = "picking", .width = 960, .height = 720, .load = load,
                         .draw = draw, .user = &p}};
    p.show.pointer[0] = -0.15f; /* where a picture without a mouse picks */
    p.show.pointer[1] = 0.05f;
    return gtx_sample_main(&p.show, argc, argv, &p.path);
}
