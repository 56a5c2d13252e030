/* Editing an asset while it is drawn: somebody walks around on sand, which keeps every step.
 *
 *   footprints ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * A step is a stamp into all patches that it meets; only those are uploaded again, and the next
 * frame shows them. Without a window the picture holds four moments of the walk. */
#include "host/sample.h"

#include <geotex/cook.h>
#include <geotex/edit.h>
#include <geotex/render.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GRID = 121, SOLE = 48, MOMENTS = 4, STEPS = 8, FRAMES_A_STEP = 12 }; /* steps a moment */
static const float SIZE = 4.4f, ROUND = 1.35f, STRIDE = 0.27f, FOOT = 0.2f, DEEP = 0.045f;

typedef struct beach {
    const char *path;
    int still;                /* four moments in one picture */
    gtx_renderer *renderer;
    gtx_asset *sand;          /* open as long as it is being edited */
    gtx_edit *edit;
    gtx_model *models[2];
    gtx_instance instances[2];
    float sole[SOLE * SOLE];
    int frames, steps;
} beach;

static float dunes(float x, float z)
{
    const float wind = 0.006f * sinf(24 * x + 7 * z + 2 * sinf(3 * z));
    return 0.07f * sinf(1.7f * x + 0.8f * sinf(1.3f * z)) + 0.05f * cosf(2.1f * z - x) + wind;
}

/* The sand as the text of an OBJ, cooked in memory. */
static gtx_result make_sand(gtx_asset **out, gtx_error *error)
{
    char *text = malloc((size_t)GRID * GRID * 100);
    size_t size = 0;
    for (int i = 0; text && i < GRID * GRID; ++i) {
        const float x = SIZE * ((float)(i % GRID) / (GRID - 1) - 0.5f);
        const float z = SIZE * ((float)(i / GRID) / (GRID - 1) - 0.5f);
        size += (size_t)sprintf(text + size, "v %.6f %.6f %.6f\n", x, dunes(x, z), z);
    }
    for (int i = 1, n = GRID; text && i < n * (n - 1); i += i % n == n - 1 ? 2 : 1)
        size += (size_t)sprintf(text + size, "f %d %d %d %d\n", i, i + n, i + n + 1, i + 1);
    const gtx_cook_desc desc = {.charts = 30, .resolution = 256, .height_bits = 16};
    gtx_result result = gtx_cook_memory(text, size, "sand.obj", &desc, out, NULL, error);
    free(text);
    return result;
}

/* A ball and a heel, deep in the middle, and what they push up around them. */
static void make_sole(float *sole)
{
    for (int i = 0; i < SOLE * SOLE; ++i) {
        const float x = (i % SOLE + 0.5f) / SOLE * 2 - 1, y = 1 - (i / SOLE + 0.5f) / SOLE * 2;
        const float r = fminf(hypotf(x / 0.34f, (y - 0.25f) / 0.5f),
                              hypotf(x / 0.26f, (y + 0.5f) / 0.32f));
        const float dent = r < 1.15f ? 1 - powf(r / 1.15f, 4) : 0;
        sole[i] = dent - 0.3f * expf(-30 * (r - 1.3f) * (r - 1.3f));
    }
}

static gtx_result step(beach *b, gtx_error *error)
{
    const float angle = 1.2f + (float)b->steps * STRIDE / ROUND;
    const float r = ROUND + (b->steps++ % 2 ? 0.09f : -0.09f) + 0.1f * sinf(3 * angle);
    const float x = r * cosf(angle), z = r * sinf(angle);
    const gtx_edit_stamp_desc stamp = {.centre = {x, dunes(x, z), z}, .radius = FOOT,
                                       .direction = {0, -1, 0}, .depth = DEEP,
                                       .up = {-sinf(angle), 0, cosf(angle)},
                                       .image = {b->sole, SOLE, SOLE}};
    const gtx_asset *edited;
    const uint32_t *patches;
    uint32_t count = 0;
    gtx_result result = gtx_edit_stamp(b->edit, &stamp, error);
    if (!result)
        result = gtx_edit_refresh(b->edit, &edited, &patches, &count, error);
    for (uint32_t i = 0; !result && i < count; ++i)
        result = gtx_model_update(b->renderer, b->models[0], edited, patches[i], error);
    return result;
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    beach *b = user;
    const gtx_renderer_desc desc = {.load = loader};
    gtx_asset *asset = NULL;
    gtx_info info;
    gtx_result result;
    (void)gl;
    if ((result = gtx_open_file(b->path, NULL, &asset, error)) ||
        (result = make_sand(&b->sand, error)) ||
        (result = gtx_edit_begin(b->sand, NULL, &b->edit, error)) ||
        (result = gtx_renderer_create(&desc, &b->renderer, error)) ||
        (result = gtx_model_create(b->renderer, b->sand, &b->models[0], error)) ||
        (result = gtx_model_create(b->renderer, asset, &b->models[1], error)))
        return result;
    gtx_get_info(asset, &info);
    gtx_close(asset);
    make_sole(b->sole);
    gtx_matrix_place(0, 0, 0, 0, 1, b->instances[0].transform);
    const float foot[3] = {0, dunes(0, 0) - 0.08f, 0};
    gtx_matrix_stand(info.bounds_min, info.bounds_max, foot, 20, 1, b->instances[1].transform);
    b->instances[0].model = b->models[0];
    b->instances[1].model = b->models[1];
    memcpy(b->instances[0].tint, (float[4]){0.87f, 0.75f, 0.56f, 1}, 4 * sizeof(float));
    return GTX_OK;
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    beach *b = user;
    gtx_result result = GTX_OK;
    GLint whole[4];
    gl->GetIntegerv(GL_VIEWPORT, whole);
    gl->ClearColor(0.62f, 0.74f, 0.83f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gtx_view v = {.light_direction = {-0.8f, 0.5f, -0.3f}};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    const int cut = b->still ? 2 : 1, w = whole[2] / cut, h = whole[3] / cut;
    for (int i = 0; !result && i < (b->still ? MOMENTS : 1); ++i) {
        int now = b->still ? STEPS * (i > 0) : b->frames++ % FRAMES_A_STEP == 0;
        while (!result && now-- > 0)
            result = step(b, error);
        gl->Viewport(i % 2 * w, (cut - 1 - i / 2) * h, w, h);
        if (!result)
            result = gtx_draw(b->renderer, &v, b->instances, 2, error);
    }
    gl->Viewport(whole[0], whole[1], whole[2], whole[3]);
    return result;
}

int main(int argc, char **argv)
{
    static beach b; /* large */
    gtx_show show = {.title = "footprints", .width = 1280, .height = 960, .load = load,
                     .draw = draw, .user = &b,
                     .camera = {.target = {0, 0.1f, 0.1f}, .radius = 2.2f, .azimuth = 8,
                                .elevation = 42, .distance = 2.1f, .field = 38}};
    for (int i = 1; i < argc; ++i)
        b.still |= !strcmp(argv[i], "--headless");
    return gtx_sample_main(&show, argc, argv, &b.path);
}
