/* Smoothing a surface: Gaussians of 2, 4 and 8 texels, as in the paper's Figure 10.
 *
 *   filters ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * In the top row patches know their neighbours; in the bottom row each is blurred by itself, as in
 * the paper: it flattens, and its seams open. */
#include "host/sample.h"
#include "host/text.h"

#include <geotex/edit.h>
#include <geotex/render.h>
#include <math.h>
#include <string.h>

enum { COLUMNS = 4, ROWS = 2 };
static const float radii[COLUMNS] = {0, 2, 4, 8};
static const char *const labels[ROWS][COLUMNS] = {
    {"source", "2 texels", "4 texels", "8 texels"},
    {"alone", "2 texels", "4 texels", "8 texels"}};

typedef struct gallery {
    const char *path;
    gtx_show show;
    gtx_renderer *renderer;
    gtx_polygon_program program;
    gtx_model *models[ROWS][COLUMNS];
} gallery;

static gtx_result filter(const gtx_asset *asset, float radius, uint32_t flags, gtx_asset **out,
                         gtx_error *error)
{
    const gtx_edit_blur blur = {.radius = radius, .flags = flags};
    gtx_edit *edit = NULL;
    gtx_result result = gtx_edit_begin(asset, NULL, &edit, error);
    if (!result && radius > 0)
        result = gtx_edit_gaussian(edit, &blur, error);
    if (!result)
        result = gtx_edit_finish(edit, out, error);
    gtx_edit_end(edit);
    return result;
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    gallery *g = user;
    const gtx_renderer_desc desc = {.load = loader};
    gtx_asset *asset = NULL;
    gtx_result result;
    if ((result = gtx_open_file(g->path, NULL, &asset, error)) ||
        (result = gtx_polygon_program_create(gl, &g->program, error)) ||
        (result = gtx_renderer_create(&desc, &g->renderer, error)))
        return result;
    for (int i = 0; !result && i < ROWS * COLUMNS; ++i) {
        const int row = i / COLUMNS, column = i % COLUMNS;
        gtx_asset *smooth = NULL;
        result = filter(asset, radii[column], row ? GTX_EDIT_ALONE : 0, &smooth, error);
        if (!result)
            result = gtx_model_create(g->renderer, smooth, &g->models[row][column], error);
        gtx_close(smooth);
    }
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx_camera_frame(&g->show.camera, info.bounds_min, info.bounds_max);
    gtx_close(asset);
    return result;
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const gallery *g = user;
    GLint whole[4];
    gtx_result result = GTX_OK;
    gl->GetIntegerv(GL_VIEWPORT, whole);
    const int width = whole[2] / COLUMNS, height = whole[3] / ROWS;
    gl->ClearColor(0.16f, 0.18f, 0.21f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

    gtx_view v = {.light_direction = {0.3f, 0.8f, 0.5f}, .viewport_height = (uint32_t)height};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    v.projection[0] *= (float)COLUMNS / ROWS; /* it was made for the whole window */
    gtx_shapes text = {0};
    const float dot = fmaxf(1, (float)whole[2] / 900);
    const gtx_text_style style = {dot, {255, 255, 255}, {30, 34, 40}};
    for (int i = 0; !result && i < ROWS * COLUMNS; ++i) {
        const int row = i / COLUMNS, column = i % COLUMNS;
        const gtx_instance instance = {
            .model = g->models[row][column],
            .transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
        gl->Viewport(column * width, (ROWS - 1 - row) * height, width, height);
        result = gtx_draw(g->renderer, &v, &instance, 1, error);
        gtx_text_add(&text, (float)(column * width) + 6 * dot, (float)(row * height) + 6 * dot,
                     &style, labels[row][column]);
    }
    gl->Viewport(whole[0], whole[1], whole[2], whole[3]);
    if (!result)
        result = gtx_text_draw(gl, &g->program, &text, whole[2], whole[3], error);
    return result;
}

int main(int argc, char **argv)
{
    gallery g = {.show = {.title = "filters", .width = 1600, .height = 900, .load = load,
                          .draw = draw, .user = &g,
                          .camera = {.azimuth = 30, .elevation = 15, .distance = 2.5f}}};
    return gtx_sample_main(&g.show, argc, argv, &g.path);
}
