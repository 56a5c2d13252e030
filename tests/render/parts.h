/* Views from near a sphere, and which level of the LOD mesh AUTO draws each part of it by. */
#ifndef GTX_TESTS_PARTS_H
#define GTX_TESTS_PARTS_H

#include "render/renderer.h"
#include "pictures.h"

/* As open_stage, and whatever the driver is: height fields are displaced by the GPU; or they are
 * grids, and rays are cast by tiles. */
static inline int open_stage_as(void **state, bool on_gpu)
{
    const int result = stage_open(state);
    stage *s = *state;
    const gtx_renderer_desc desc = {
        .load = gtx_offscreen_load, .log = stage_log, .costs = {0, 0, 1, 1},
        .tiles = on_gpu ? GTX_TILES_NEVER : GTX_TILES_ALWAYS};
    if (result || !s->offscreen)
        return result;
    gtx_renderer_destroy(s->renderer);
    if (gtx_renderer_create(&desc, &s->renderer, NULL))
        return -1;
    s->renderer->planner.on_gpu = on_gpu;
    return 0;
}

/* The eye near the surface of the sphere, looking along it; the near plane as close. */
static inline gtx_view standing(float way)
{
    const gtx_camera around = {.radius = (float)radius, .azimuth = 37 * way,
                               .elevation = 11 * fmodf(way, 5) - 20, .distance = 1.08f};
    gtx_view view = view_of(&around);
    const float near = 0.01f, far = 8;
    view.projection[10] = -(far + near) / (far - near);
    view.projection[14] = -2 * near * far / (far - near);
    /* Turned up by 55 degrees: the horizon is in the picture. */
    const double c = cos(0.96), n = sin(0.96);
    const gtx_view flat = view;
    for (int k = 0; k < 4; ++k) {
        view.view[4 * k + 1] = (float)(c * flat.view[4 * k + 1] + n * flat.view[4 * k + 2]);
        view.view[4 * k + 2] = (float)(c * flat.view[4 * k + 2] - n * flat.view[4 * k + 1]);
    }
    view.viewport_height = STAGE_HEIGHT;
    return view;
}

/* Grids with triangles over each cell show what is cast, but for their twist. */
static inline void expect_as_cast(stage *s, const gtx_view *view, const gtx_instance *instance)
{
    draw(s, view, GTX_METHOD_CAST, instance, 1, &first);
    draw(s, view, GTX_METHOD_GRID, instance, 1, &second);
    const difference d = compare(&first, &second), back = compare(&second, &first);
    const double iou = (double)d.both / (double)d.either;
    /* The diagonal of a twisted cell may stand out by more than a pixel. */
    if (d.both < 200 || iou < 0.85 || d.holes || back.holes > 4 || d.mean > 4)
        fail_msg("%ld pixels, IoU %g, %ld and %ld holes, colours differ by %g", d.both, iou,
                 d.holes, back.holes, d.mean);
}

/* What AUTO draws each patch by: n for level n - 1, 0 for its height field, -1: out of view. */
static inline void parts_of(stage *s, const gtx_view *view, const gtx_instance *instance,
                            int levels[6])
{
    const gtx_planner *planner = &s->renderer->planner;
    draw(s, view, GTX_METHOD_AUTO, instance, 1, &first);
    const uint8_t whole = planner->ways[0];
    for (int p = 0; p < 6; ++p) {
        const int way = planner->plan.ways[p];
        levels[p] = whole == GTX_DRAW_CAST       ? 0
                    : whole != GTX_DRAW_PATCHES  ? whole
                    : way >= GTX_BY_LOD          ? way - GTX_BY_LOD + 1
                    : way == GTX_BY_HEIGHT_FIELD ? 0
                                                 : -1;
    }
}

#endif
