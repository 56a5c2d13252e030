/* A world larger than memory: a walk through it while its tiles are read.
 *
 *   world DIR [--headless OUT.png] [--size WxH]
 *
 * DIR is what `gtx world` makes. A stream says what to read, beginnings of files first, to upload
 * and to draw; a thread reads, opens and prepares; rays over what is there find the ground. Without
 * a window a whole way around is walked, in pictures of twice WxH; its last is kept at WxH, and its
 * cost is told. */
#include "host/sample.h"
#include "host/worker.h"

#include <string.h>

#include "world_tile.h"
#include "world_walk.h"

enum { SAMPLES = 2 };             /* a side of a pixel, without a window */

typedef struct world {
    int still;                    /* no window */
    gtx_show show;
    tile_source source;
    gtx_stream *stream;
    gtx_worker *worker;
    uint64_t read;                /* bytes */
    gtx_instance *instances;
    gtx_scene_instance *ground;
} world;

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    world *w = user;
    size_t size;
    void *index = read_file(w->source.folder, "tiles.gtw", UINT64_MAX, NULL, 0, &size);
    const gtx_renderer_desc renderer = {.load = loader};
    const gtx_stream_desc desc = {.index = index, .index_size = size, .release = release_tile,
                                  .report = report_tile, .cpu_bytes = 768 << 20};
    gtx_stream_info info;
    gtx_result result;
    (void)gl;
    if ((result = gtx_stream_create(&desc, &w->stream, error)) ||
        (result = gtx_renderer_create(&renderer, &w->source.renderer, error)) ||
        (result = gtx_worker_create(load_tile, &w->source, &w->worker, error)))
        return result;
    free(index);
    w->read = size;
    gtx_stream_get_info(w->stream, &info);
    for (int k = 0; k < 3; ++k)
        w->source.middle[k] = (info.low[k] + info.high[k]) / 2;
    w->instances = calloc(info.tiles, sizeof *w->instances);
    w->ground = calloc(info.tiles, sizeof *w->ground);
    walk_begin(&w->show.camera, &info);
    return GTX_OK;
}

/* Requests go to the worker, which has room for more than max_requests; what it has done, to the
 * stream. */
static void exchange(world *w, const gtx_stream_frame *frame, int wait)
{
    for (uint32_t i = 0; i < frame->request_count; ++i)
        gtx_worker_push(w->worker, ask_tile(&w->source, &frame->requests[i]));
    for (tile *t; (t = gtx_worker_pop(w->worker, wait));) {
        w->read += t->request.bytes - t->request.from;
        answer_tile(w->stream, t);
    }
}

/* One frame: draws what is there, and walks a step over it. */
static gtx_result step(world *w, const gtx_host_gl *gl, int walks, gtx_stream_frame *frame,
                       gtx_error *error)
{
    const uint32_t samples = w->still ? SAMPLES : 1;
    gtx_view view = {.light_direction = {0.8f, 0.4f, 0.3f},
                     .viewport_width = samples * (uint32_t)w->show.width,
                     .viewport_height = samples * (uint32_t)w->show.height};
    gtx_stream_view eyes[2] = {{.viewport_height = (uint32_t)w->show.height}}; /* ahead, down */
    gtx_scene *ground = NULL;
    uint32_t grounds = 0;
    gtx_camera_matrices(&w->show.camera, (float)w->show.width / (float)w->show.height, view.view,
                        view.projection);
    memcpy(eyes[0].view, view.view, sizeof view.view);
    memcpy(eyes[0].projection, view.projection, sizeof view.projection);
    look_down(&w->show.camera, &eyes[1]);
    for (int i = 0; i < 2; ++i)
        memcpy(eyes[i].origin, w->source.middle, sizeof eyes[i].origin);
    gtx_result result = gtx_stream_update(w->stream, eyes, 2, frame, error);
    for (uint32_t i = 0; i < frame->upload_count && !result; ++i)
        result = upload_tile(w->stream, &frame->uploads[i], error);
    for (uint32_t i = 0; i < frame->draw_count && !result; ++i)
        grounds += show_tile(frame->draws[i].payload, &w->instances[i], &w->ground[grounds]);
    gl->ClearColor(0.62f, 0.74f, 0.86f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (!result)
        result = gtx_draw(w->source.renderer, &view, w->instances, frame->draw_count, error);
    if (walks && !result &&
        (!grounds || !gtx_scene_create(w->ground, grounds, NULL, &ground, NULL)))
        walk_on(&w->show.camera, ground);
    gtx_scene_destroy(ground);
    return result;
}

/* A window shows one frame after another; a picture is the last of a whole way around, once all
 * that it wants is there. */
static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    world *w = user;
    gtx_stream_frame frame = {0};
    walk_record record = {0};
    gtx_result result = GTX_OK;
    (void)view;
    (void)projection;
    for (int n = 0; n < (w->still ? FRAMES_AROUND : 1) && !result; ++n) {
        const clock_t start = clock();
        result = step(w, gl, n > 0 || !w->still, &frame, error);
        gl->Finish();
        walk_keep(&record, n, clock() - start, &frame, w->read);
        exchange(w, &frame, w->still);
    }
    while (w->still && !result && frame.pending > frame.without_room) {
        result = step(w, gl, 0, &frame, error);
        exchange(w, &frame, 1);
    }
    if (w->still && !result)
        walk_print(&record, SAMPLES * (uint32_t)w->show.width,
                   SAMPLES * (uint32_t)w->show.height);
    return result;
}

int main(int argc, char **argv)
{
    static world w;
    w.show = (gtx_show){.title = "world", .width = 1280, .height = 720, .load = load,
                        .draw = draw, .user = &w};
    for (int i = 1; i < argc; ++i)
        w.still = w.still || strcmp(argv[i], "--headless") == 0;
    return gtx_sample_main(&w.show, argc, argv, &w.source.folder);
}
