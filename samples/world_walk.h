/* What samples/world.c walks by: a way around the world, and the ground under it. */
#ifndef GTX_SAMPLES_WORLD_WALK_H
#define GTX_SAMPLES_WORLD_WALK_H

#include "host/camera.h"
#include "host/walk.h"

#include <geotex/stream.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { FRAMES_AROUND = 600 };

/* Of the world's radius: from the middle, and from the eye to the ground. */
static const float WALK_RADIUS = 0.45f, WALK_HEIGHT = 0.12f;

static inline void walk_begin(gtx_camera *camera, const gtx_stream_info *info)
{
    double sum = 0;
    for (int k = 0; k < 3; ++k)
        sum += (info->high[k] - info->low[k]) * (info->high[k] - info->low[k]) / 4;
    camera->radius = (float)sqrt(sum);
    camera->distance = 0;
    camera->elevation = 20;
    camera->azimuth = 90;
    camera->pan[1] = WALK_HEIGHT * camera->radius;
    camera->pan[2] = WALK_RADIUS * camera->radius;
}

/* What lies under the eye, so closely that the beginning of a tile, which has no heights to stand
 * on, is not enough. */
static inline void look_down(const gtx_camera *camera, gtx_stream_view *feet)
{
    gtx_camera down = *camera;
    down.elevation = 90;
    down.field = 1;
    feet->viewport_height = 1 << 14;
    gtx_camera_matrices(&down, 1, feet->view, feet->projection);
}

/* One step along the circle, where ground is known above all that is under the eye or soon will be:
 * at a cliff the eye is above it before the picture's near plane cuts it open. */
static inline void walk_on(gtx_camera *camera, const gtx_scene *ground)
{
    const float turn = 6.2831853f / FRAMES_AROUND, soon = 24;   /* steps: the eye's height */
    const float step[3] = {0, 0, turn * WALK_RADIUS * camera->radius};
    float highest = -INFINITY;
    gtx_walk_move(camera, step, 1);
    camera->azimuth -= 360.0f / FRAMES_AROUND;
    for (int i = 0; i < 2 && ground; ++i) {
        gtx_camera there = *camera;
        gtx_ray down = {.direction = {0, -1, 0}};
        gtx_hit hit = {.t = INFINITY};
        gtx_walk_move(&there, (float[]){0, 0, (float)i * soon * step[2]}, 1);
        gtx_walk_eye(&there, down.origin);
        down.origin[1] = camera->radius; /* from above all */
        gtx_scene_raycast(ground, &down, &hit, NULL, 1, 0);
        highest = fmaxf(highest, down.origin[1] - hit.t);
    }
    if (isfinite(highest))
        gtx_walk_stand(camera, highest, WALK_HEIGHT * camera->radius, 1.0f / 30);
}

/* What a whole way around took. */
typedef struct walk_record {
    double ms[FRAMES_AROUND];     /* of the processors, a frame */
    uint64_t cpu, gpu;            /* bytes: most of both */
    uint64_t first, read;         /* bytes: before the first picture, in all */
    uint64_t requested, released, draws;
} walk_record;

static inline void walk_keep(walk_record *r, int n, clock_t took, const gtx_stream_frame *frame,
                             uint64_t read)
{
    r->ms[n] = 1000.0 * (double)took / CLOCKS_PER_SEC;
    r->cpu = frame->cpu_bytes > r->cpu ? frame->cpu_bytes : r->cpu;
    r->gpu = frame->gpu_bytes > r->gpu ? frame->gpu_bytes : r->gpu;
    r->first = !r->first && frame->draw_count ? read : r->first;
    r->read = read;
    r->requested = frame->requested;
    r->released = frame->released;
    r->draws += frame->draw_count;
}

static inline int walk_compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Of pictures of so many pixels. */
static inline void walk_print(walk_record *r, uint32_t width, uint32_t height)
{
    qsort(r->ms, FRAMES_AROUND, sizeof *r->ms, walk_compare);
    printf("%d frames of %u x %u, %.1f ms in the median, %.1f at most in nine of ten; %.1f tiles "
           "a frame\n"
           "%.1f MB on the CPU and %.1f MB on the GPU at most; %.2f MB read before the first "
           "picture, %.1f in all\n%llu beginnings and rests of tiles read, %llu dropped\n",
           FRAMES_AROUND, width, height, r->ms[FRAMES_AROUND / 2], r->ms[FRAMES_AROUND * 9 / 10],
           (double)r->draws / FRAMES_AROUND, (double)r->cpu / 1e6, (double)r->gpu / 1e6,
           (double)r->first / 1e6, (double)r->read / 1e6, (unsigned long long)r->requested,
           (unsigned long long)r->released);
}

#endif
