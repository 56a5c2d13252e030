/* An operation of your own: a cellular automaton grows over the surface and becomes its relief.
 *
 *   cellular ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * The operation is the first 40 lines of code. It runs patch by patch and also reads texels past
 * the patch's outline: those are borrowed from its neighbours, and follow them after every call. */
#include "host/sample.h"

#include <geotex/edit.h>
#include <geotex/render.h>
#include <string.h>

/* What the sum of a texel and its eight neighbours becomes: the majority, except that close
 * votes are reversed, so that borders keep moving (Vichniac 1984). */
static const float vote[10] = {0, 0, 0, 0, 1, 0, 1, 1, 1, 1};

static int around(const gtx_edit_field *s, uint32_t t, float *sum)
{
    *sum = 0;
    for (int k = 0; k < 9; ++k) {
        const uint32_t other = t + (uint32_t)(k / 3) * s->width + (uint32_t)(k % 3) - s->width - 1;
        if (other >= s->width * s->height || s->kind[other] == GTX_TEXEL_NONE)
            return 0;
        *sum += s->value[other];
    }
    return 1;
}

static void seed(const gtx_edit_field *s, void *user)
{
    uint32_t random = s->patch * 2654435761u + 1;
    (void)user;
    for (uint32_t t = 0; t < s->width * s->height; ++t) {
        random = random * 1664525u + 1013904223u;
        s->next[t] = (float)(random >> 31);
    }
}

static void grow(const gtx_edit_field *s, void *user)
{
    const float *blend = user; /* 0: vote; 1: take the mean, which rounds the steps off */
    float sum;
    for (uint32_t t = 0; t < s->width * s->height; ++t)
        if (s->kind[t] == GTX_TEXEL_OWN && around(s, t, &sum))
            s->next[t] = *blend > 0 ? sum / 9 : vote[(int)(sum + 0.5f)];
}

static void raise(const gtx_edit_field *s, void *height)
{
    for (uint32_t t = 0; t < s->width * s->height; ++t)
        for (int k = 0; k < 3 && s->kind[t] == GTX_TEXEL_OWN; ++k)
            s->point[t][k] += *(const float *)height * s->value[t] * s->normal[t][k];
}

static gtx_result pattern(gtx_edit *edit, gtx_error *error)
{
    float vote_only = 0, mean = 1, height = gtx_edit_texel_size(edit);
    gtx_result result = gtx_edit_apply(edit, seed, NULL, error);
    for (int i = 0; !result && i < 24; ++i)
        result = gtx_edit_apply(edit, grow, i < 22 ? &vote_only : &mean, error);
    return result ? result : gtx_edit_apply(edit, raise, &height, error);
}

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
    gtx_asset *asset = NULL, *grown = NULL;
    gtx_edit *edit = NULL;
    gtx_result result;
    (void)gl;
    if ((result = gtx_open_file(e->path, NULL, &asset, error)) ||
        (result = gtx_edit_begin(asset, NULL, &edit, error)) ||
        (result = pattern(edit, error)) || (result = gtx_edit_finish(edit, &grown, error)) ||
        (result = gtx_renderer_create(&desc, &e->renderer, error)) ||
        (result = gtx_model_create(e->renderer, grown, &e->model, error)))
        return result;
    gtx_info info;
    gtx_get_info(grown, &info);
    gtx_camera_frame(&e->show.camera, info.bounds_min, info.bounds_max);
    gtx_edit_end(edit);
    gtx_close(grown);
    gtx_close(asset);
    return GTX_OK;
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const engine *e = user;
    gl->ClearColor(0.16f, 0.18f, 0.21f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gtx_view v = {.light_direction = {0.4f, 0.8f, 0.45f}};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    const gtx_instance instance = {
        .model = e->model, .transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    return gtx_draw(e->renderer, &v, &instance, 1, error);
}

int main(int argc, char **argv)
{
    engine e = {.show = {.title = "cellular", .width = 960, .height = 720, .load = load,
                         .draw = draw, .user = &e,
                         .camera = {.azimuth = 30, .elevation = 20, .distance = 1.9f}}};
    return gtx_sample_main(&e.show, argc, argv, &e.path);
}
