/* Streaming worlds: which tiles of a world (`gtx world`) to read, to upload, to draw and to drop.
 *
 * The host does the reading. A stream knows the tree of tiles from the world's index, and which
 * tiles the host has; it holds no assets, starts no thread and makes no GL call. Each frame:
 *
 *     gtx_stream_update(stream, &view, 1, &frame, &error);
 *     for each frame.requests:  start an asynchronous read of the first `bytes` bytes of `uri`
 *     for each frame.uploads:   gtx_model_upload(renderer, model, bytes, &done, &error);
 *                               if (done) gtx_stream_ready(stream, tile, 0);
 *     for each frame.draws:     one gtx_instance of the payload's model
 *
 * When a read has ended: on a worker thread, gtx_stream_open checks and opens the bytes and
 * gtx_model_prepare makes a model; then, on the stream's thread, gtx_stream_deliver hands the model
 * over as the tile's *payload*, or gtx_stream_fail reports that there is none.
 *
 * What is drawn. A tile is refined where its error exceeds `max_error` pixels: all of its children
 * in view replace it at once, as soon as the last of them is ready (3D Tiles: REPLACE). Until then
 * the tile itself is drawn. A tile is kept as long as any of its descendants is: once the root is
 * ready no frame has a hole, wherever the camera jumps. While a read is late, failed, truncated or
 * corrupt the parent is drawn; the failure is reported, and the read tried again a bounded number
 * of times.
 *
 * Beginnings. The first eighth of a tile's file has its LOD meshes and colours, and can be drawn
 * alone, without heights and with coarser normals (gtx_open_prefix). This *beginning* is requested
 * first, then those of its children. The *rest* is requested only where no child replaces the tile
 * and where the beginning's error, too, exceeds `max_error` pixels. It is a payload of its own and
 * is drawn instead of the beginning, which is kept as long as the rest is.
 *
 * Budgets. Requested, delivered and uploaded bytes never exceed cpu_bytes and gpu_bytes, as far as
 * the index and the host give sizes. Room is made by dropping resident tiles that have no resident
 * children: first those out of view, least recently seen first; then those whose error on screen is
 * less than half of that of the tile that needs the room.
 *
 * Coordinates are those of the tiles' assets, +Y up, in object units, with anchors added. The rules
 * of geotex.h apply here too; a stream is used by one thread at a time. */
#ifndef GEOTEX_STREAM_H
#define GEOTEX_STREAM_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The tiles of one world, and which of them are resident. */
typedef struct gtx_stream gtx_stream;

/* A request that failed. */
typedef struct gtx_stream_report {
    uint32_t tile;
    const char *uri;              /* as in gtx_stream_request; valid during the call */
    const gtx_error *error;       /* what gtx_stream_fail was given; READ if it was never answered;
                                     LIMIT if there is no room for what was delivered */
    uint32_t tries_left;          /* 0: given up, until gtx_stream_retry; the parent is drawn */
} gtx_stream_report;

typedef struct gtx_stream_desc {
    const void *index;            /* the bytes of the world's tiles.gtw; not kept */
    size_t index_size;
    uint64_t cpu_bytes;           /* budget for pending requests, payloads and the stream itself;
                                     0 = 1 GiB */
    uint64_t gpu_bytes;           /* 0 = 512 MiB */
    uint64_t upload_bytes;        /* per frame; 0 = 8 MiB */
    float max_error;              /* pixels; 0 = 1 */
    uint32_t max_requests;        /* pending at once, up to 1024; 0 = 8 */
    uint32_t max_tries;           /* per tile; 0 = 4 */
    uint32_t retry_updates;       /* updates until a failed request is repeated; doubles with each
                                     failure; 0 = 30 */
    uint32_t patience_updates;    /* updates until an unanswered request has failed; 0 = 3600 */
    /* `release` takes back a payload, exactly once each, never while it is in the frame's lists. It
     * is called from update, deliver and destroy. Neither callback may call into the stream; both
     * may be NULL. */
    void (*release)(void *payload, void *user);
    void (*report)(const gtx_stream_report *report, void *user);
    void *user;
    const gtx_allocator *allocator;
    uint32_t reserved[6];
} gtx_stream_desc;

/* A view that needs tiles: a camera, or the light of a shadow map. */
typedef struct gtx_stream_view {
    float view[16], projection[16];   /* as in gtx_view, with any depth convention */
    double origin[3];             /* of the matrices' world space, in the tiles' coordinates */
    uint32_t viewport_height;     /* pixels, at least 1 */
    uint32_t reserved[3];
} gtx_stream_view;

enum { GTX_STREAM_URI = 40 };

/* A read to start. A copy may go to any thread. */
typedef struct gtx_stream_request {
    uint64_t id;                  /* unique; for gtx_stream_deliver and gtx_stream_fail */
    char uri[GTX_STREAM_URI];     /* relative to the world's folder, such as "tiles/r07.gtx" */
    uint32_t tile;                /* index of the tile, 0 = the root */
    float pixels;                 /* urgency: the error on screen that the tile would remove */
    uint64_t bytes;               /* number of bytes to read, from the start of the file */
    uint64_t from;                /* how many of these were read before, for the tile's beginning;
                                     a host that kept them needs to read only the others */
    void *beginning;              /* with from > 0, the payload of the beginning; valid until the
                                     next update */
    uint64_t file_bytes;          /* size of the whole file */
    uint64_t memory;              /* most memory that opening the `bytes` bytes takes */
    uint64_t hash;                /* XXH64 of the `bytes` bytes */
    double low[3], high[3];       /* bounding box of the tile and of all its descendants */
} gtx_stream_request;

/* Send up to `bytes` of the payload to the GPU. The sum over a frame is at most upload_bytes. */
typedef struct gtx_stream_upload {
    uint32_t tile;
    void *payload;
    uint64_t bytes;               /* at least 1 */
} gtx_stream_upload;

typedef struct gtx_stream_draw {
    uint32_t tile;
    float pixels;                 /* upper bound on its error on screen */
    void *payload;
} gtx_stream_draw;

/* One frame. The lists belong to the stream, start with the most urgent entry, and are valid until
 * the next update. */
typedef struct gtx_stream_frame {
    const gtx_stream_request *requests;
    const gtx_stream_upload *uploads;
    const gtx_stream_draw *draws;
    uint32_t request_count, upload_count, draw_count;
    uint32_t pending;             /* beginnings and rests that the views need and that are not
                                     ready; 0: the frame is complete */
    uint32_t without_room;        /* how many of these wait for room in the budgets; if equal to
                                     `pending`, nothing more will come */
    uint32_t given_up;            /* beginnings and rests without tries left, in the whole world */
    uint32_t resident, under_way; /* numbers of payloads, of pending requests */
    uint64_t cpu_bytes, gpu_bytes;    /* what these two take of the budgets */
    /* Totals since the stream was made. A request is delivered, failed or refused (LIMIT), or is
     * still under way. */
    uint64_t requested, delivered, failed, refused;
    uint64_t released;            /* payloads */
} gtx_stream_frame;

/* Makes a stream of a world's index (format/world.md). Allocates all memory that the stream will
 * ever use, some 550 bytes per tile, from the descriptor's allocator; free it with
 * gtx_stream_destroy.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (the root is larger than cpu_bytes), NOT_GTX,
 * VERSION, TRUNCATED, CORRUPT. */
GTX_API gtx_result gtx_stream_create(const gtx_stream_desc *desc, gtx_stream **out,
                                     gtx_error *error);
/* Releases all payloads and frees the stream. Pending requests need no answer. NULL is fine. */
GTX_API void gtx_stream_destroy(gtx_stream *stream);

typedef struct gtx_stream_info {
    uint32_t tiles;
    float unit;                   /* metres per object unit */
    double low[3], high[3];       /* bounding box of the world */
    float error;                  /* of the root tile, object units */
    uint64_t bytes;               /* of all files together */
} gtx_stream_info;
GTX_API void gtx_stream_get_info(const gtx_stream *stream, gtx_stream_info *out);

/* Plans the next frame for `count` views, 0..16. Never waits and allocates nothing. Takes time in
 * proportion to the tiles in view, and for each tile that it drops, to the resident tiles: tenths
 * of a millisecond with a thousand of them.
 * Errors: ARGUMENT (a view is not finite, or has no inverse), NOT_ZEROED: nothing has changed. */
GTX_API gtx_result gtx_stream_update(gtx_stream *stream, const gtx_stream_view *views,
                                     uint32_t count, gtx_stream_frame *frame, gtx_error *error);

/* Opens what was read for a request, on any thread. Checks that `data` are the request's bytes: by
 * length and hash, by the format's rules, and by the memory and the bounding box that the request
 * states. *held (may be NULL) gets the number of bytes that the asset holds of the descriptor's
 * allocator until gtx_close. `desc` may be NULL; its limits apply too. Errors: as gtx_open_memory;
 * TRUNCATED and CORRUPT also if the bytes are not those of the tile. */
GTX_API gtx_result gtx_stream_open(const gtx_stream_request *request, const void *data, size_t size,
                                   const gtx_open_desc *desc, gtx_asset **out, uint64_t *held,
                                   gtx_error *error);

/* Answers a request with its payload, which is whatever the host draws a tile with. The payload
 * takes cpu_bytes now, and gpu_bytes once it is uploaded; with gpu_bytes 0 it is ready at once. The
 * stream owns it from now on: if the result is not GTX_OK, `release` has been called with it.
 * Errors: ARGUMENT (no such request, or a NULL payload), CANCELLED (the answer comes too late),
 * LIMIT (larger than expected, and there is no room). */
GTX_API gtx_result gtx_stream_deliver(gtx_stream *stream, uint64_t id, void *payload,
                                      uint64_t cpu_bytes, uint64_t gpu_bytes);

/* Answers a request that failed; `error` (may be NULL) is passed on to `report`.
 * Errors: ARGUMENT, CANCELLED, as for gtx_stream_deliver. */
GTX_API gtx_result gtx_stream_fail(gtx_stream *stream, uint64_t id, const gtx_error *error);

/* A tile of frame.uploads is completely on the GPU; it may be drawn from the next update on.
 * `cpu_bytes` is what its payload still takes on the CPU. Errors: ARGUMENT (the tile does not wait
 * for an upload, or cpu_bytes is more than was delivered). */
GTX_API gtx_result gtx_stream_ready(gtx_stream *stream, uint32_t tile, uint64_t cpu_bytes);

/* Lets all tiles be requested again at once, also those given up: for when a server is back. */
GTX_API void gtx_stream_retry(gtx_stream *stream);

#ifdef __cplusplus
}
#endif
#endif
