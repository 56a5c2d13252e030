/* What planning a frame costs, without any graphics interface.
 *
 *   plan ASSET.gtx
 *
 * 1280 x 720, 45 degrees, from outside and from just above the surface, by 36 azimuths each. The
 * time is the processor's, the median over the azimuths of the least of 20 frames. */
#include "host/camera.h"

#include <geotex/frame.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { AZIMUTHS = 36, FRAMES = 20, WIDTH = 1280, HEIGHT = 720 };

typedef struct totals {
    uint64_t draws, ranges, triangles;
} totals;

static void count(const gtx_frame_draw *draw, void *user)
{
    totals *t = user;
    ++t->draws;
    t->ranges += draw->range_count;
    for (uint32_t i = 0; i < draw->range_count; ++i)
        t->triangles += (uint64_t)draw->ranges[i].count / 3 *
                        (draw->vertices == GTX_BUFFER_BLOCKS ? draw->instance_count : 1);
}

static void must(gtx_result result, const gtx_error *error)
{
    if (result == GTX_OK)
        return;
    fprintf(stderr, "plan: error: %s\n", error->message);
    exit(1);
}

static double microseconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The least time of several frames of a view. */
static double time_of(gtx_planner *planner, const gtx_view *view, const gtx_instance *instance,
                      totals *out)
{
    gtx_error error;
    gtx_frame frame;
    double least = INFINITY;
    for (int i = 0; i < FRAMES; ++i) {
        memset(out, 0, sizeof *out);
        const double start = microseconds();
        must(gtx_frame_begin(planner, view, instance, 1, &frame, &error), &error);
        gtx_frame_draws(planner, count, out);
        least = fmin(least, microseconds() - start);
    }
    return least;
}

static void measure(gtx_planner *planner, gtx_view *view, const gtx_instance *instance,
                    gtx_camera *camera, const char *place, const char *method)
{
    double times[AZIMUTHS];
    totals all = {0, 0, 0}, one;
    for (int i = 0; i < AZIMUTHS; ++i) {
        camera->azimuth = 10.0f * (float)i;
        gtx_camera_matrices(camera, (float)WIDTH / HEIGHT, view->view, view->projection);
        times[i] = time_of(planner, view, instance, &one);
        all.draws += one.draws;
        all.ranges += one.ranges;
        all.triangles += one.triangles;
    }
    qsort(times, AZIMUTHS, sizeof *times, compare);
    printf("| %-7s | %-9s | %9.1f | %9.1f | %6.1f | %6.0f | %9.0f |\n", place, method,
           times[AZIMUTHS / 2], times[AZIMUTHS - 1], (double)all.draws / AZIMUTHS,
           (double)all.ranges / AZIMUTHS, (double)all.triangles / AZIMUTHS);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        gtx_method method;
        uint32_t on_gpu;
    } methods[] = {{"cast", GTX_METHOD_CAST, 0},     {"lod", GTX_METHOD_LOD, 0},
                   {"auto", GTX_METHOD_AUTO, 0},     {"grid", GTX_METHOD_GRID, 0},
                   {"auto, GPU", GTX_METHOD_AUTO, 1}, {"grid, GPU", GTX_METHOD_GRID, 1}};
    gtx_error error;
    gtx_asset *asset;
    gtx_planner *planners[2];
    gtx_model *model;
    gtx_info info;
    gtx_camera camera = {.elevation = 20};
    gtx_view view = {.viewport_height = HEIGHT};
    if (argc != 2) {
        fputs("usage: plan ASSET.gtx\n", stderr);
        return 1;
    }
    must(gtx_open_file(argv[1], NULL, &asset, &error), &error);
    must(gtx_model_prepare(asset, NULL, &model, &error), &error);
    for (uint32_t on_gpu = 0; on_gpu < 2; ++on_gpu)
        must(gtx_planner_create(&(gtx_planner_desc){.on_gpu = on_gpu}, &planners[on_gpu], &error),
             &error);
    gtx_get_info(asset, &info);
    gtx_model_uploaded(model);
    gtx_instance instance = {.model = model};
    for (int k = 0; k < 16; k += 5)
        instance.transform[k] = 1;
    printf("%u patches\n"
           "| view    | method    | us median | us most   | draws  | ranges | triangles |\n"
           "|---|---|---|---|---|---|---|\n", info.patch_count);
    gtx_camera_frame(&camera, info.bounds_min, info.bounds_max);
    for (int near = 0; near < 2; ++near)
        for (size_t m = 0; m < sizeof methods / sizeof *methods; ++m) {
            camera.distance = near ? 0.7f : 2.8f;
            view.method = methods[m].method;
            if (view.method != GTX_METHOD_LOD || info.lod_levels)
                measure(planners[methods[m].on_gpu], &view, &instance, &camera,
                        near ? "near" : "outside", methods[m].name);
        }
    for (int i = 0; i < 2; ++i)
        gtx_planner_destroy(planners[i]);
    gtx_model_free(model);
    gtx_close(asset);
    return 0;
}
