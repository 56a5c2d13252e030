/* Horizons: height grids stacked, coloured by a property, among polygons (paper, section 6.2).
 *
 *   horizons own|FOLDER|ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * `own` makes four grids, FOLDER holds those of the table below, and an asset is one that
 * `gtx horizons` has made. A well path and a cutting plane are polygons in the same depth buffer.
 * If it has LOD meshes, made from the maps, they draw the right half of the picture. */
#include "horizons.h"
#include "host/sample.h"
#include "host/text.h"

#include <geotex/render.h>

typedef struct world {
    const char *path;
    gtx_polygon_program program;
    gtx_polygons solids;
    gtx_renderer *renderer;
    gtx_instance instance;
    gtx_info info;
    double range[2]; /* of the colours */
} world;

/* The values at the ends of the colours, as `gtx horizons` leaves them in META. */
static void read_color_range(const gtx_asset *asset, double range[2])
{
    char text[512] = "";
    size_t size;
    const char *meta = gtx_meta(asset, &size), *keys[2] = {"\"color_low\":", "\"color_high\":"};
    if (meta && size < sizeof text)
        memcpy(text, meta, size);
    for (int k = 0; k < 2; ++k) {
        const char *at = strstr(text, keys[k]);
        range[k] = at ? strtod(at + strlen(keys[k]), NULL) : 0;
    }
}

static gtx_result make_asset(world *w, gtx_asset **asset, gtx_error *error)
{
    gtx_result result = GTX_OK;
    if (strstr(w->path, ".gtx")) {
        if (!(result = gtx_open_file(w->path, NULL, asset, error)))
            read_color_range(*asset, w->range);
        return result;
    }
    gtx_height_grid grids[LAYERS];
    const int own = !strcmp(w->path, "own");
    gtx_horizons_desc desc = {
        .depths = 1, .vertical = 4, .lod_levels = own ? 0 : GTX_LOD_LEVELS_NONE};
    gtx_horizons_result made;
    for (int k = 0; k < LAYERS && !result; ++k)
        result = own ? make_layer(k, &grids[k]) : read_layer(w->path, k, &grids[k], error);
    if (result || (result = gtx_horizons(grids, LAYERS, &desc, asset, &made, error)))
        return result;
    memcpy(w->range, made.color_range, sizeof w->range);
    return GTX_OK;
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    static const float well[][3] = {
        {-0.25f, 0.5f, 0.4f}, {-0.25f, 0.2f, 0.4f}, {-0.23f, 0.1f, 0.41f}, {-0.17f, 0, 0.43f},
        {-0.05f, -0.08f, 0.47f}, {0.15f, -0.14f, 0.52f}, {0.75f, -0.22f, 0.6f}};
    world *w = user;
    const gtx_renderer_desc desc = {.load = loader};
    gtx_asset *asset = NULL;
    gtx_model *model;
    gtx_shapes s = {0};
    gtx_result result;
    if ((result = make_asset(w, &asset, error)) ||
        (result = gtx_polygon_program_create(gl, &w->program, error)) ||
        (result = gtx_renderer_create(&desc, &w->renderer, error)) ||
        (result = gtx_model_create(w->renderer, asset, &model, error)))
        return result;
    gtx_get_info(asset, &w->info);
    const float *low = w->info.bounds_min, *high = w->info.bounds_max;
    float center[16], scale[16]; /* to a scene two wide */
    gtx_matrix_place(-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -(low[2] + high[2]) / 2, 0,
                     1, center);
    gtx_matrix_place(0, 0, 0, 0, 2 / fmaxf(high[0] - low[0], high[2] - low[2]), scale);
    gtx_matrix_multiply(scale, center, w->instance.transform);
    w->instance.model = model;
    gtx_close(asset);
    gtx_shapes_tube(&s, well, sizeof well / sizeof *well, 0.012f, (gtx_rgb){224, 60, 44});
    gtx_shapes_box(&s, (float[3]){0.3f, 0.04f, -0.2f}, (float[3]){0.006f, 0.7f, 1.5f}, -35,
                   (gtx_rgb){196, 200, 206});
    return gtx_shapes_finish(&s, gl, &w->solids, error);
}

/* A scale of colours with the values at its ends, and what each half of the picture is. */
static gtx_result draw_legend(const gtx_host_gl *gl, const world *w, int width, int height,
                              gtx_error *error)
{
    gtx_shapes s = {0};
    char text[32];
    const float dot = (float)height / 360, bar = 90 * dot, x = 12 * dot;
    const float y = (float)height - x - bar;
    const gtx_text_style style = {dot, {32, 36, 44}, {237, 240, 245}};
    for (int i = 0; i < 64; ++i) {
        uint8_t c[3];
        gtx_color(GTX_COLORS_VIRIDIS, i / 63.0, c);
        gtx_text_rectangle(&s, x, y + bar * (float)(63 - i) / 64, 10 * dot, bar / 64 + 1,
                           (gtx_rgb){c[0], c[1], c[2]});
    }
    for (int k = 0; k < 2; ++k) {
        snprintf(text, sizeof text, "%.1f m", w->range[k]);
        gtx_text_add(&s, x + 14 * dot, y + (k ? 0 : bar - 7 * dot), &style, text);
    }
    gtx_text_add(&s, x, y - 14 * dot, &style, "thickness");
    gtx_text_add(&s, x, x, &style, "cast");
    if (w->info.lod_levels)
        gtx_text_add(&s, (float)width / 2 + x, x, &style, "lod");
    return gtx_text_draw(gl, &w->program, &s, width, height, error);
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    world *w = user;
    GLint box[4];
    gl->GetIntegerv(GL_VIEWPORT, box);
    gl->Disable(GL_SCISSOR_TEST);
    gl->ClearColor(0.93f, 0.94f, 0.96f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl->Enable(GL_DEPTH_TEST);
    gtx_view v = {.light_direction = {-0.4f, 0.8f, 0.35f}, .ambient = 0.3f,
                  .viewport_height = (uint32_t)box[3]};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    gtx_polygons_draw(gl, &w->program, &w->solids, NULL, &v);
    gtx_result result = GTX_OK;
    const int halves = w->info.lod_levels ? 2 : 1;
    for (int half = 0; half < halves && !result; ++half) {
        v.method = half ? GTX_METHOD_LOD : GTX_METHOD_CAST;
        gl->Enable(GL_SCISSOR_TEST);
        gl->Scissor(half ? box[2] / 2 : 0, 0, half || halves < 2 ? box[2] : box[2] / 2, box[3]);
        result = gtx_draw(w->renderer, &v, &w->instance, 1, error);
    }
    gl->Disable(GL_SCISSOR_TEST);
    return result ? result : draw_legend(gl, w, box[2], box[3], error);
}

int main(int argc, char **argv)
{
    world w = {0};
    gtx_show show = {.title = "horizons", .width = 1280, .height = 720, .load = load, .draw = draw,
                     .user = &w};
    show.camera = (gtx_camera){.radius = 1.15f, .azimuth = 20, .elevation = 20, .distance = 2};
    return gtx_sample_main(&show, argc, argv, &w.path);
}
