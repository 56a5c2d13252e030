/* Streaming worlds for world.js, which knows payloads by numbers above 0. Built by emscripten
 * alone; see web.mk. */
#include "web/core.h"

#include <geotex/stream.h>

#include <emscripten/emscripten.h>

#include <stdlib.h>
#include <string.h>

#define WEB_API EMSCRIPTEN_KEEPALIVE

EM_JS(void, tile_released, (uint32_t world, uint32_t payload),
      { Module['worlds'].get(world).released(payload); });
EM_JS(void, tile_reported,
      (uint32_t world, const char *uri, int result, const char *message, uint32_t tries), {
          Module['worlds'].get(world).reported(UTF8ToString(uri), result, UTF8ToString(message),
                                               tries);
      });

static void release(void *payload, void *user)
{
    tile_released((uint32_t)(uintptr_t)user, (uint32_t)(uintptr_t)payload);
}

static void report(const gtx_stream_report *told, void *user)
{
    const gtx_error none = {0}, *error = told->error ? told->error : &none;
    tile_reported((uint32_t)(uintptr_t)user, told->uri, (int)error->result, error->message,
                  told->tries_left);
}

/* `world`: its number in Module.worlds; `limits`: bytes on CPU and GPU, bytes sent a frame, pixels
 * of error, requests at once; 0 for the defaults. */
WEB_API gtx_stream *gtxw_world_create(const void *index, size_t size, uint32_t world,
                                      const float *limits)
{
    const gtx_stream_desc desc = {
        .index = index, .index_size = size, .cpu_bytes = (uint64_t)limits[0],
        .gpu_bytes = (uint64_t)limits[1], .upload_bytes = (uint64_t)limits[2],
        .max_error = limits[3], .max_requests = (uint32_t)limits[4], .release = release,
        .report = report, .user = (void *)(uintptr_t)world};
    gtx_stream *stream = NULL;
    gtx_stream_create(&desc, &stream, gtxw_begin());
    return stream;
}

WEB_API void gtxw_world_destroy(gtx_stream *stream)
{
    gtx_stream_destroy(stream);
}

/* Tiles, metres a unit, both corners, error of the root, bytes of all files. Valid until the next
 * call. */
WEB_API const double *gtxw_world_info(const gtx_stream *stream)
{
    static double out[10];
    gtx_stream_info i;
    gtx_stream_get_info(stream, &i);
    const double numbers[] = {i.tiles, (double)i.unit, i.low[0], i.low[1], i.low[2], i.high[0],
                              i.high[1], i.high[2], (double)i.error, (double)i.bytes};
    memcpy(out, numbers, sizeof out);
    return out;
}

enum { COUNTS = 11, OF_A_REQUEST = 6, OF_AN_UPLOAD = 3, OF_A_DRAW = 2 };

/* `seen`: view and projection, then the viewport's height; `origin`: theirs in the world. Gives
 * numbers of requests, uploads and draws, pending, without room, given up, resident, under way,
 * bytes on CPU and GPU, bytes of a request; then of each request id, first byte, bytes, the
 * beginning's payload, whether there is more than these bytes, and where it lies; of each upload
 * tile, payload and bytes; of each draw tile and payload. 0 for an error. */
WEB_API const double *gtxw_world_update(gtx_stream *stream, const float *seen, double x, double y,
                                        double z)
{
    static double *out;
    static size_t room;
    gtx_stream_view view = {.origin = {x, y, z}, .viewport_height = (uint32_t)seen[32]};
    gtx_stream_frame f;
    memcpy(view.view, seen, sizeof view.view);
    memcpy(view.projection, seen + 16, sizeof view.projection);
    if (gtx_stream_update(stream, &view, 1, &f, gtxw_begin()))
        return NULL;
    const size_t need = COUNTS + OF_A_REQUEST * (size_t)f.request_count +
                        OF_AN_UPLOAD * (size_t)f.upload_count + OF_A_DRAW * (size_t)f.draw_count;
    if (need > room) {
        double *larger = realloc(out, 2 * need * sizeof *out);
        if (!larger)
            return NULL;
        out = larger;
        room = 2 * need;
    }
    const double counts[COUNTS] = {
        f.request_count, f.upload_count, f.draw_count, f.pending, f.without_room, f.given_up,
        f.resident, f.under_way, (double)f.cpu_bytes, (double)f.gpu_bytes,
        sizeof(gtx_stream_request)};
    memcpy(out, counts, sizeof counts);
    double *next = out + COUNTS;
    for (const gtx_stream_request *r = f.requests; r < f.requests + f.request_count; ++r) {
        const double row[OF_A_REQUEST] = {
            (double)r->id, (double)r->from, (double)r->bytes, (uint32_t)(uintptr_t)r->beginning,
            r->bytes < r->file_bytes, (uint32_t)(uintptr_t)r};
        memcpy(next, row, sizeof row);
        next += OF_A_REQUEST;
    }
    for (const gtx_stream_upload *u = f.uploads; u < f.uploads + f.upload_count; ++u) {
        const double row[OF_AN_UPLOAD] = {u->tile, (uint32_t)(uintptr_t)u->payload,
                                          (double)u->bytes};
        memcpy(next, row, sizeof row);
        next += OF_AN_UPLOAD;
    }
    for (const gtx_stream_draw *d = f.draws; d < f.draws + f.draw_count; ++d) {
        *next++ = d->tile;
        *next++ = (uint32_t)(uintptr_t)d->payload;
    }
    return out;
}

WEB_API const char *gtxw_world_uri(const gtx_stream_request *request)
{
    return request->uri;
}

/* In a worker: what was read for a request, whose bytes lie at `request`. */
WEB_API gtx_asset *gtxw_world_open(const gtx_stream_request *request, const void *data, size_t size)
{
    gtx_asset *asset = NULL;
    gtx_stream_open(request, data, size, NULL, &asset, NULL, gtxw_begin());
    return asset;
}

WEB_API int gtxw_world_deliver(gtx_stream *stream, double id, uint32_t payload, double cpu_bytes,
                               double gpu_bytes)
{
    return (int)gtx_stream_deliver(stream, (uint64_t)id, (void *)(uintptr_t)payload,
                                   (uint64_t)cpu_bytes, (uint64_t)gpu_bytes);
}

WEB_API int gtxw_world_fail(gtx_stream *stream, double id, int result, const char *message)
{
    gtx_error error = {.result = (gtx_result)result};
    strncpy(error.message, message, sizeof error.message - 1);
    return (int)gtx_stream_fail(stream, (uint64_t)id, &error);
}

WEB_API int gtxw_world_ready(gtx_stream *stream, uint32_t tile, double cpu_bytes)
{
    return (int)gtx_stream_ready(stream, tile, (uint64_t)cpu_bytes);
}
