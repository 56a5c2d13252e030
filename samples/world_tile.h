/* What samples/world.c draws a tile by, and how it comes from a file: on any thread. */
#ifndef GTX_SAMPLES_WORLD_TILE_H
#define GTX_SAMPLES_WORLD_TILE_H

#include <geotex/render.h>
#include <geotex/stream.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where tiles lie, what frees their models, and the origin of all that is drawn. */
typedef struct tile_source {
    const char *folder;
    gtx_renderer *renderer;
    double middle[3];
} tile_source;

/* The first `most` bytes of a file of a folder, or all, from malloc; the first `from` of them are
 * not read but copied from `before`. NULL when it cannot be read. */
static inline void *read_file(const char *folder, const char *name, uint64_t most,
                              const void *before, uint64_t from, size_t *size)
{
    char path[4096];
    void *bytes = NULL;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    *size = 0;
    if (file && !fseek(file, 0, SEEK_END) && ftell(file) > 0) {
        const uint64_t all = (uint64_t)ftell(file), wanted = most < all ? most : all;
        bytes = malloc((size_t)wanted);
        if (bytes && from <= wanted && !fseek(file, (long)from, SEEK_SET)) {
            if (from)
                memcpy(bytes, before, (size_t)from);
            *size = (size_t)from + fread((char *)bytes + from, 1, (size_t)(wanted - from), file);
        }
    }
    if (file)
        fclose(file);
    return bytes;
}

/* The payload of a tile, and the bytes that its parts take on the CPU. */
typedef struct tile {
    gtx_stream_request request;
    const tile_source *source;
    gtx_asset *asset;
    gtx_model *model;
    gtx_caster *caster;           /* NULL for a beginning: it has no heights */
    void *file;                   /* of a beginning, for the rest of it */
    uint64_t bytes;
    float transform[16];
    gtx_error error;
} tile;

static inline void *take(size_t size, void *user)
{
    ((tile *)user)->bytes += size;
    return malloc(size);
}

static inline void give(void *memory, size_t size, void *user)
{
    ((tile *)user)->bytes -= size;
    free(memory);
}

/* On the worker's thread. */
static inline void load_tile(void *item, void *user)
{
    tile *t = item;
    const tile_source *source = user;
    const gtx_allocator hooks = {take, give, t};
    const gtx_open_desc open = {.allocator = &hooks};
    const gtx_model_desc model = {.allocator = &hooks, .borrow = 1};
    const gtx_caster_desc caster = {.allocator = &hooks, .level = 2};
    const int whole = t->request.bytes == t->request.file_bytes;
    size_t size;
    void *bytes = read_file(source->folder, t->request.uri, t->request.bytes, t->file,
                            t->request.from, &size);
    gtx_info info;
    free(t->file);
    t->file = NULL;
    if (!gtx_stream_open(&t->request, bytes, size, &open, &t->asset, NULL, &t->error) &&
        !gtx_model_prepare(t->asset, &model, &t->model, &t->error) &&
        (!whole || !gtx_caster_create(t->asset, &caster, &t->caster, &t->error))) {
        gtx_get_info(t->asset, &info);
        for (int k = 0; k < 3; ++k)
            t->transform[12 + k] = (float)(info.anchor[k] - source->middle[k]);
        t->transform[0] = t->transform[5] = t->transform[10] = t->transform[15] = 1;
    }
    if (whole || t->error.result) {
        free(bytes);
        return;
    }
    t->file = bytes;
    t->bytes += size;
}

static inline void release_tile(void *payload, void *user)
{
    tile *t = payload;
    (void)user;
    gtx_model_destroy(t->source->renderer, t->model);
    gtx_caster_destroy(t->caster);
    gtx_close(t->asset);
    free(t->file);
    free(t);
}

static inline void report_tile(const gtx_stream_report *r, void *user)
{
    (void)user;
    fprintf(stderr, "%s: %s%s\n", r->uri, r->error->message, r->tries_left ? "" : ", given up");
}

static inline tile *ask_tile(const tile_source *source, const gtx_stream_request *request)
{
    tile *t = calloc(1, sizeof *t);
    t->request = *request;
    t->source = source;
    if (request->beginning) { /* it may leave while the rest is read */
        t->file = malloc((size_t)request->from);
        memcpy(t->file, ((tile *)request->beginning)->file, (size_t)request->from);
    }
    return t;
}

/* Tells the stream what became of a request. */
static inline void answer_tile(gtx_stream *stream, tile *t)
{
    const gtx_model_size size = gtx_model_gpu_size(t->model);
    if (!t->error.result) {
        gtx_stream_deliver(stream, t->request.id, t, t->bytes, size.geometry + size.color);
        return;
    }
    gtx_stream_fail(stream, t->request.id, &t->error);
    release_tile(t, NULL);
}

static inline gtx_result upload_tile(gtx_stream *stream, const gtx_stream_upload *part,
                                     gtx_error *error)
{
    tile *t = part->payload;
    uint32_t done = 0;
    const gtx_result result =
        gtx_model_upload(t->source->renderer, t->model, part->bytes, &done, error);
    if (done) {
        gtx_close(t->asset); /* neither model nor caster needs it any more */
        t->asset = NULL;
        gtx_stream_ready(stream, part->tile, t->bytes);
    }
    return result;
}

/* For drawing, and for rays: how many of them can meet it. */
static inline uint32_t show_tile(const tile *t, gtx_instance *drawn, gtx_scene_instance *ground)
{
    *drawn = (gtx_instance){.model = t->model, .tint = {0.8f, 0.74f, 0.62f, 1}};
    *ground = (gtx_scene_instance){.caster = t->caster};
    for (int i = 0; i < 16; ++i)
        drawn->transform[i] = ground->transform[i] = t->transform[i];
    return t->caster != NULL;
}

#endif
