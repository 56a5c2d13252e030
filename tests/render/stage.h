/* What the tests of drawing share: a context, a framebuffer and a renderer. */
#ifndef GTX_TESTS_STAGE_H
#define GTX_TESTS_STAGE_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

#include "common/counter.h"
#include "common/fixture.h"
#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"
#include "host/polygons.h"

#include <geotex/render.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STAGE_WIDTH = 240, STAGE_HEIGHT = 180, STAGE_PIXELS = STAGE_WIDTH * STAGE_HEIGHT };

typedef struct stage {
    gtx_offscreen *offscreen;
    gtx_host_gl gl;
    gtx_framebuffer framebuffer;
    gtx_renderer *renderer;
    uint8_t color[4 * STAGE_PIXELS];
    float depth[STAGE_PIXELS];
} stage;

static stage the_stage;

static inline void stage_log(const char *message, void *user)
{
    (void)user;
    fprintf(stderr, "%s\n", message);
}

static inline int stage_open(void **state)
{
    stage *s = &the_stage;
    gtx_error error = {0};
    const gtx_renderer_desc desc = {.load = gtx_offscreen_load, .log = stage_log};
    *state = s;
    const int es = getenv("GEOTEX_ES") != NULL; /* every test of drawing, by OpenGL ES */
    if ((es ? gtx_offscreen_create_es : gtx_offscreen_create)(&s->offscreen, &error))
        return 0; /* the tests skip */
    if (gtx_host_gl_init(&s->gl, gtx_offscreen_load, NULL, &error) ||
        gtx_framebuffer_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT, &s->framebuffer, &error) ||
        gtx_renderer_create(&desc, &s->renderer, &error)) {
        fprintf(stderr, "%s\n", error.message);
        return -1;
    }
    return 0;
}

static inline int stage_close(void **state)
{
    stage *s = *state;
    if (!s->offscreen)
        return 0;
    gtx_renderer_destroy(s->renderer);
    gtx_framebuffer_destroy(&s->gl, &s->framebuffer);
    const int clean = s->gl.GetError() == GL_NO_ERROR;
    gtx_offscreen_destroy(s->offscreen);
    return clean ? 0 : -1;
}

#define STAGE_OR_SKIP(state)                                                                       \
    stage *s = *(state);                                                                           \
    if (!s->offscreen)                                                                             \
        skip()

static inline void must(gtx_result result, const gtx_error *error)
{
    if (result)
        fail_msg("%s", error->message);
}

static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static inline gtx_view view_of(const gtx_camera *camera)
{
    gtx_view view = {.flags = (camera->reversed_z ? GTX_VIEW_REVERSED_Z : 0u) |
                              (camera->zero_to_one ? GTX_VIEW_DEPTH_ZERO_TO_ONE : 0u)};
    gtx_camera_matrices(camera, (float)STAGE_WIDTH / STAGE_HEIGHT, view.view, view.projection);
    return view;
}

/* Lets the view be cast by tiles, where the context can. It must name its level. */
static inline void by_tiles(gtx_view *view)
{
    view->viewport_width = STAGE_WIDTH;
    view->viewport_height = STAGE_HEIGHT;
}

/* Around the asset's bounds, from an angle that no frame is aligned with. */
static inline gtx_camera camera_around(const gtx_asset *asset)
{
    gtx_info info;
    gtx_camera camera = {.azimuth = 27, .elevation = 33, .distance = 3.1f};
    gtx_get_info(asset, &info);
    for (int k = 0; k < 3; ++k) {
        const float half = (info.bounds_max[k] - info.bounds_min[k]) / 2;
        camera.target[k] = info.bounds_min[k] + half;
        camera.radius += half * half;
    }
    camera.radius = sqrtf(camera.radius);
    return camera;
}

static inline void stage_clear(stage *s, const gtx_view *view)
{
    gtx_framebuffer_bind(&s->gl, &s->framebuffer);
    s->gl.DepthMask(GL_TRUE);
    s->gl.ClearColor(0, 0, 0, 0);
    s->gl.ClearDepthf(view->flags & GTX_VIEW_REVERSED_Z ? 0 : 1);
    s->gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

/* Clears, draws and reads back. */
static inline void stage_draw(stage *s, const gtx_view *view, const gtx_instance *instances,
                              uint32_t count)
{
    gtx_error error = {0};
    stage_clear(s, view);
    must(gtx_draw(s->renderer, view, instances, count, &error), &error);
    assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
    gtx_framebuffer_read_color(&s->gl, &s->framebuffer, s->color);
    gtx_framebuffer_read_depth(&s->gl, &s->framebuffer, s->depth);
}

/* ---- 4x4 matrices in double, column-major ------------------------------------------------ */

typedef struct matrix {
    double m[16];
} matrix;

static inline matrix matrix_of(const float *m)
{
    matrix out;
    for (int i = 0; i < 16; ++i)
        out.m[i] = m[i];
    return out;
}

static inline matrix matrix_mul(matrix a, matrix b)
{
    matrix out = {{0}};
    for (int i = 0; i < 64; ++i)
        out.m[4 * (i / 16) + i % 4] += a.m[4 * (i / 4 % 4) + i % 4] * b.m[4 * (i / 16) + i / 4 % 4];
    return out;
}

/* Gauss-Jordan with pivoting. */
static inline matrix matrix_inverse(matrix a)
{
    matrix b = matrix_of(identity);
    for (int i = 0; i < 4; ++i) {
        int pivot = i;
        for (int r = i + 1; r < 4; ++r)
            if (fabs(a.m[4 * i + r]) > fabs(a.m[4 * i + pivot]))
                pivot = r;
        for (int c = 0; c < 4; ++c) {
            double t = a.m[4 * c + i];
            a.m[4 * c + i] = a.m[4 * c + pivot];
            a.m[4 * c + pivot] = t;
            t = b.m[4 * c + i];
            b.m[4 * c + i] = b.m[4 * c + pivot];
            b.m[4 * c + pivot] = t;
        }
        const double scale = 1 / a.m[4 * i + i];
        for (int c = 0; c < 4; ++c) {
            a.m[4 * c + i] *= scale;
            b.m[4 * c + i] *= scale;
        }
        for (int r = 0; r < 4; ++r) {
            const double factor = r == i ? 0 : a.m[4 * i + r];
            for (int c = 0; c < 4; ++c) {
                a.m[4 * c + r] -= factor * a.m[4 * c + i];
                b.m[4 * c + r] -= factor * b.m[4 * c + i];
            }
        }
    }
    return b;
}

/* m * (p, 1), divided by its w, which is returned. */
static inline double matrix_point(matrix m, const double p[3], double out[3])
{
    double r[4];
    for (int i = 0; i < 4; ++i)
        r[i] = m.m[i] * p[0] + m.m[4 + i] * p[1] + m.m[8 + i] * p[2] + m.m[12 + i];
    for (int i = 0; i < 3; ++i)
        out[i] = r[i] / r[3];
    return r[3];
}

/* An asset, its model, and one instance of it that is placed by the identity. */
typedef struct subject {
    gtx_asset *asset;
    gtx_model *model;
    gtx_instance instance;
} subject;

static inline subject subject_open(stage *s, gtx_asset *asset)
{
    gtx_error error = {0};
    subject out = {.asset = asset};
    must(gtx_model_create(s->renderer, asset, &out.model, &error), &error);
    out.instance.model = out.model;
    memcpy(out.instance.transform, identity, sizeof identity);
    return out;
}

/* The program that casts. */
static inline GLuint cast_program(const gtx_shading *shading)
{
    uint32_t programs[GTX_SHADING_PROGRAMS];
    gtx_shading_programs(shading, programs);
    return programs[0];
}

static inline void subject_close(stage *s, subject *shown)
{
    gtx_model_destroy(s->renderer, shown->model);
    gtx_close(shown->asset);
}

#endif
