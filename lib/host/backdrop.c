/* A sky and a tiled floor whose vertices are shaded once, by a depth picture from the light. */
#include "host/backdrop.h"

#include "base/error.h"
#include "host/framebuffer.h"
#include "host/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SHADOW_SIZE = 2048, FLOOR_CELLS = 480, SHADOW_REACH = 7 };

static const float horizon[3] = {222, 219, 212}, zenith[3] = {110, 138, 170};

/* What the light sees. */
typedef struct shadow {
    float clip[16];           /* world -> the picture's clip space */
    float side;               /* of the floor */
    float depth[SHADOW_SIZE * SHADOW_SIZE];
} shadow;

/* Share of the light that reaches a point of the floor, over a neighbourhood: soft edges. */
static float light_at(const shadow *s, float x, float z)
{
    const float *m = s->clip;
    const int px = (int)floorf((m[0] * x + m[8] * z + m[12] + 1) / 2 * SHADOW_SIZE);
    const int py = (int)floorf((1 - m[1] * x - m[9] * z - m[13]) / 2 * SHADOW_SIZE);
    const float depth = (m[2] * x + m[10] * z + m[14] + 1) / 2 - 0.002f;
    int lit = 0, count = 0;
    if (px < SHADOW_REACH || py < SHADOW_REACH || px >= SHADOW_SIZE - SHADOW_REACH ||
        py >= SHADOW_SIZE - SHADOW_REACH)
        return 1;
    for (int j = -SHADOW_REACH; j <= SHADOW_REACH; j += 2)
        for (int i = -SHADOW_REACH; i <= SHADOW_REACH; i += 2, ++count)
            lit += s->depth[(py + j) * SHADOW_SIZE + px + i] >= depth;
    return (float)lit / (float)count;
}

/* Tiles and joints in the light, fading into the horizon. */
static gtx_rgb floor_color(float x, float z, void *user)
{
    const shadow *s = user;
    const float tile = s->side / 20, u = x / tile + 100.5f, v = z / tile + 100.5f;
    const float joint = fminf(fabsf(u - roundf(u)), fabsf(v - roundf(v)));
    const int is_dark = ((int)u + (int)v) & 1;
    const float share = 0.3f + 0.7f * light_at(s, x, z);
    const float fade = fminf(powf(hypotf(x, z) / (0.48f * s->side), 2.5f), 1);
    const float base = joint < 0.022f ? 96 : is_dark ? 138 : 182, tone[3] = {1, 0.975f, 0.93f};
    uint8_t c[3];
    for (int k = 0; k < 3; ++k)
        c[k] = (uint8_t)(base * tone[k] * powf(share, 0.45f) * (1 - fade) + horizon[k] * fade);
    return (gtx_rgb){c[0], c[1], c[2]};
}

static gtx_result draw_shadow(const gtx_host_gl *gl, const gtx_backdrop_desc *desc, shadow *s,
                              gtx_error *error)
{
    const float degrees = 57.2957795f, *light = desc->light;
    const gtx_camera sun = {.radius = s->side / 3, .distance = 2, .orthographic = 1,
                            .azimuth = degrees * atan2f(light[0], light[2]),
                            .elevation = degrees * atan2f(light[1], hypotf(light[0], light[2]))};
    float view[16], projection[16];
    gtx_framebuffer target;
    gtx_result result = gtx_framebuffer_create(gl, SHADOW_SIZE, SHADOW_SIZE, &target, error);
    if (result)
        return result;
    gtx_camera_matrices(&sun, 1, view, projection);
    gtx_matrix_multiply(projection, view, s->clip);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthMask(GL_TRUE);
    gl->ClearDepthf(1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    result = desc->draw(view, projection, desc->user, error);
    gtx_framebuffer_read_depth(gl, &target, s->depth);
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
    gtx_framebuffer_destroy(gl, &target);
    return result;
}

/* A rectangle over the upper half of clip space, darker towards the top. The lower half is cleared
 * to the horizon, into which the floor fades. */
static gtx_result create_sky(const gtx_host_gl *gl, gtx_polygons *out, gtx_error *error)
{
    gtx_polygon_vertex corners[4] = {{{-1, 0, 0}, {0}, {0}, {0}}, {{1, 0, 0}, {0}, {0}, {0}},
                                     {{1, 1, 0}, {0}, {0}, {0}}, {{-1, 1, 0}, {0}, {0}, {0}}};
    static const uint32_t order[6] = {0, 1, 2, 0, 2, 3};
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k)
            corners[i].color[k] = (uint8_t)(i < 2 ? horizon[k] : zenith[k]);
    return gtx_polygons_create(gl, &(gtx_polygon_data){corners, order, 4, 6}, out, error);
}

gtx_result gtx_backdrop_create(const gtx_host_gl *gl, const gtx_backdrop_desc *desc,
                               gtx_backdrop *out, gtx_error *error)
{
    shadow *s = calloc(1, sizeof *s);
    gtx_shapes shapes = {0};
    gtx_backdrop backdrop = {0};
    if (!s)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the shadows of the floor");
    s->side = desc->side;
    gtx_result result = draw_shadow(gl, desc, s, error);
    if (!result) {
        gtx_shapes_grid(&shapes, 0, desc->side, FLOOR_CELLS, floor_color, s);
        result = gtx_shapes_finish(&shapes, gl, &backdrop.floor, error);
    }
    if (!result)
        result = create_sky(gl, &backdrop.sky, error);
    free(s);
    if (result)
        gtx_backdrop_destroy(gl, &backdrop);
    else
        *out = backdrop;
    return result;
}

void gtx_backdrop_destroy(const gtx_host_gl *gl, gtx_backdrop *backdrop)
{
    gtx_polygons_destroy(gl, &backdrop->floor);
    gtx_polygons_destroy(gl, &backdrop->sky);
}

void gtx_backdrop_draw(const gtx_host_gl *gl, const gtx_polygon_program *program,
                       const gtx_backdrop *backdrop, const float view[16],
                       const float projection[16])
{
    static const gtx_view flat = {.view = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                  .projection = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                  .ambient = 1};
    gtx_view v = {.ambient = 1};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    gl->DepthMask(GL_TRUE);
    gl->ClearColor(horizon[0] / 255, horizon[1] / 255, horizon[2] / 255, 1);
    gl->ClearDepthf(1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl->Disable(GL_DEPTH_TEST);
    gtx_polygons_draw(gl, program, &backdrop->sky, NULL, &flat);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_LESS);
    gtx_polygons_draw(gl, program, &backdrop->floor, NULL, &v);
}
