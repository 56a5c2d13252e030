/* Streaming worlds: which tiles of a world (`gtx world`) to read, to upload, to draw and to drop.
 *
 * The host reads, geotex asks. A stream knows the tree of tiles from the world's index, and of each
 * tile whether the host has it; it holds no asset, no thread and no GL. Each frame:
 *
 *     gtx_stream_update(stream, &view, 1, &frame, &error);
 *     for each frame.requests:  start to read `uri`, in any way, for any length of time: its first
 *                               `bytes` bytes
 *     for each frame.uploads:   gtx_model_upload(renderer, model, bytes, &done, &error);
 *                               if (done) gtx_stream_ready(stream, tile, 0);
 *     for each frame.draws:     one gtx_instance of the payload's model
 *
 * and when a read has ended, on a worker: gtx_stream_open checks and opens the bytes,
 * gtx_model_prepare makes a model, and then, where the stream is used, gtx_stream_deliver hands it
 * over as the tile's *payload*, or gtx_stream_fail tells why there is none.
 *
 * What is drawn. A tile is refined where its error is more than `max_error` pixels: all of its
 * children in view take its place at once, when the last of them is ready (3D Tiles: REPLACE).
 * Until then it stands. A tile stays as long as one below it is there: once the root is ready no
 * frame has a hole, wherever the camera jumps. Late, failing, truncated and lying reads leave the
 * parent standing; they are reported, and tried again a bounded number of times.
 *
 * Beginnings. A tile's file begins with its LOD meshes and colours: an eighth of it that is a tile
 * already, without heights and with coarser normals (gtx_open_prefix). It is asked for first, and
 * its children after it. The rest is wanted only where no child takes its place, and where the
 * beginning's error is more than `max_error` pixels too; it is a payload of its own, and is drawn
 * instead of the beginning, which stays while the rest is there.
 *
 * Budgets. What is asked for, held, and ready is never more than cpu_bytes and gpu_bytes, as far as
 * the index and the host tell sizes. Room is made by dropping leaves of what is there: those not in
 * view, the one longest unseen first; then those that are worth less than half of what is wanted.
 *
 * Coordinates are those of the tiles' assets, +Y up, in object units, before any anchor is taken
 * off. The rules of geotex.h hold here too; a stream is used by one thread at a time. */
#ifndef GEOTEX_STREAM_H
#define GEOTEX_STREAM_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The tiles of one world, and which of them are there. */
typedef struct gtx_stream gtx_stream;

/* What became of a request that brought no tile. */
typedef struct gtx_stream_report {
    uint32_t tile;
    const char *uri;              /* as in gtx_stream_request; during the call */
    const gtx_error *error;       /* what gtx_stream_fail was told; READ for one never answered;
                                     LIMIT for one that is larger than the room that is left */
    uint32_t tries_left;          /* 0: given up, until gtx_stream_retry; its parent stands */
} gtx_stream_report;

typedef struct gtx_stream_desc {
    const void *index;            /* the bytes of the world's tiles.gtw; not kept */
    size_t index_size;
    uint64_t cpu_bytes;           /* of requests under way, payloads, and the stream itself;
                                     0 = 1 GiB */
    uint64_t gpu_bytes;           /* 0 = 512 MiB */
    uint64_t upload_bytes;        /* a frame; 0 = 8 MiB */
    float max_error;              /* pixels; 0 = 1 */
    uint32_t max_requests;        /* under way at once, up to 1024; 0 = 8 */
    uint32_t max_tries;           /* of a tile; 0 = 4 */
    uint32_t retry_updates;       /* until a tile is asked for again; doubled each time; 0 = 30 */
    uint32_t patience_updates;    /* until a request without an answer has failed; 0 = 3600 */
    /* Takes a payload back, exactly once each: out of update, deliver and destroy, never while it
     * is in the frame's lists. Neither calls into the stream. Both may be NULL. */
    void (*release)(void *payload, void *user);
    void (*report)(const gtx_stream_report *report, void *user);
    void *user;
    const gtx_allocator *allocator;
    uint32_t reserved[6];
} gtx_stream_desc;

/* What somebody sees: a camera, or the light of a shadow map. */
typedef struct gtx_stream_view {
    float view[16], projection[16];   /* as in gtx_view, of any depth convention */
    double origin[3];             /* in the tiles' coordinates: the matrices' 0, 0, 0 */
    uint32_t viewport_height;     /* pixels, at least 1 */
    uint32_t reserved[3];
} gtx_stream_view;

enum { GTX_STREAM_URI = 40 };

/* Read this. A copy may go to any thread. */
typedef struct gtx_stream_request {
    uint64_t id;                  /* for the answer, of this request alone */
    char uri[GTX_STREAM_URI];     /* relative to the world's folder: "tiles/r07.gtx" */
    uint32_t tile;                /* number in the index, 0 = the root */
    float pixels;                 /* error on screen that it would mend: what is most urgent */
    uint64_t bytes;               /* wanted: so many first bytes of the file, or all */
    uint64_t from;                /* of these the first ones that have been read already, for the
                                     tile's beginning: who has kept them reads the others alone */
    void *beginning;              /* its payload then; no longer than the frame */
    uint64_t file_bytes;          /* size of the file */
    uint64_t memory;              /* that opening them takes, at most */
    uint64_t hash;                /* XXH64 of them */
    double low[3], high[3];       /* box of it and all below it */
} gtx_stream_request;

/* Send up to `bytes` of the payload to the GPU; all of a frame are upload_bytes at most. */
typedef struct gtx_stream_upload {
    uint32_t tile;
    void *payload;
    uint64_t bytes;               /* at least 1 */
} gtx_stream_upload;

typedef struct gtx_stream_draw {
    uint32_t tile;
    float pixels;                 /* its error on screen, at most */
    void *payload;
} gtx_stream_draw;

/* One frame. The lists are the stream's, the most urgent first; valid until the next update. */
typedef struct gtx_stream_frame {
    const gtx_stream_request *requests;
    const gtx_stream_upload *uploads;
    const gtx_stream_draw *draws;
    uint32_t request_count, upload_count, draw_count;
    uint32_t pending;             /* tiles in view and rests that are wanted and not ready; 0: all
                                     is there */
    uint32_t without_room;        /* of these, those that wait for room in the budgets: no more is
                                     going to come where it is as many */
    uint32_t given_up;            /* tiles and rests whose tries have ended, of the whole world */
    uint32_t resident, under_way; /* payloads, requests */
    uint64_t cpu_bytes, gpu_bytes;    /* taken of the budgets, by both */
    /* Since the stream was made. Every request ends as one of these four, or is under way. */
    uint64_t requested, delivered, failed, refused;
    uint64_t released;            /* payloads */
} gtx_stream_frame;

/* Reads an index (format/world.md). Takes all memory that it will ever take, some 550 bytes a tile,
 * from the descriptor's allocator; gtx_stream_destroy frees it.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (the root is larger than cpu_bytes), NOT_GTX,
 * VERSION, TRUNCATED, CORRUPT. */
GTX_API gtx_result gtx_stream_create(const gtx_stream_desc *desc, gtx_stream **out,
                                     gtx_error *error);
/* Releases all payloads. Requests under way need no answer any more. NULL is fine. */
GTX_API void gtx_stream_destroy(gtx_stream *stream);

typedef struct gtx_stream_info {
    uint32_t tiles;
    float unit;                   /* metres per object unit */
    double low[3], high[3];       /* box of everything */
    float error;                  /* of the root, object units */
    uint64_t bytes;               /* of all files */
} gtx_stream_info;
GTX_API void gtx_stream_get_info(const gtx_stream *stream, gtx_stream_info *out);

/* Decides for the next frame, seen by `count` views (up to 16; none: nothing is in view). Never
 * waits, takes no memory, and takes time in proportion to the tiles in view, and to those there for
 * each that it drops: tenths of a millisecond where a thousand are there.
 * Errors: ARGUMENT (a view is not finite, or has no inverse), NOT_ZEROED: nothing has changed. */
GTX_API gtx_result gtx_stream_update(gtx_stream *stream, const gtx_stream_view *views,
                                     uint32_t count, gtx_stream_frame *frame, gtx_error *error);

/* Opens what was read for a request, on any thread, if it is that tile: `data` are the first
 * request->bytes of its file, of their hash, an asset (or its beginning) that keeps every rule and
 * takes no more memory than said, within its box. *held (may be
 * NULL) gets the bytes that the asset takes from the descriptor's allocator until gtx_close. `desc`
 * may be NULL; its limits hold too. Errors: those of gtx_open_memory; TRUNCATED and CORRUPT too
 * where the bytes are not the tile's. */
GTX_API gtx_result gtx_stream_open(const gtx_stream_request *request, const void *data, size_t size,
                                   const gtx_open_desc *desc, gtx_asset **out, uint64_t *held,
                                   gtx_error *error);

/* Hands over what became of a request: the payload, whatever the host draws a tile by, and the
 * bytes that it takes on the CPU, and on the GPU once uploaded. With gpu_bytes 0 it is ready at
 * once. The payload is the stream's from now on: `release` has had it unless the result is OK.
 * Errors: ARGUMENT (no such request, or a NULL payload), CANCELLED (its answer is too late), LIMIT
 * (larger than expected, and there is no room). */
GTX_API gtx_result gtx_stream_deliver(gtx_stream *stream, uint64_t id, void *payload,
                                      uint64_t cpu_bytes, uint64_t gpu_bytes);

/* Tells that a request failed: `error` (may be NULL) is what the report says.
 * Errors: ARGUMENT, CANCELLED as above. */
GTX_API gtx_result gtx_stream_fail(gtx_stream *stream, uint64_t id, const gtx_error *error);

/* A tile of frame.uploads is on the GPU: from the next update on it may be drawn. `cpu_bytes` is
 * what its payload still takes on the CPU. Errors: ARGUMENT (no such tile waits for that, or
 * cpu_bytes is more than was delivered). */
GTX_API gtx_result gtx_stream_ready(gtx_stream *stream, uint32_t tile, uint64_t cpu_bytes);

/* All tiles may be asked for again at once, those given up too: the source has come back. */
GTX_API void gtx_stream_retry(gtx_stream *stream);

#ifdef __cplusplus
}
#endif
#endif
