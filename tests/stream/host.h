/* A host of a stream that keeps its own books: what it was asked for, what it gave, what came back.
 * Needs cmocka before it. */
#ifndef GTX_TESTS_HOST_H
#define GTX_TESTS_HOST_H

#include "stream/made.h"

#include <math.h>

/* Tiles, and behind them their rests. */
enum { MADE_NODES = 2 * MADE_TILES };

typedef struct payload {
    uint32_t node;
    uint64_t cpu, gpu, sent;
    bool ready;
} payload;

typedef struct host {
    const made_world *world;
    gtx_stream *stream;
    gtx_stream_desc desc;
    gtx_stream_frame frame;
    gtx_stream_view view;
    payload *there[MADE_NODES];
    gtx_stream_request asked[MADE_NODES]; /* id 0: not */
    uint64_t own, cpu, gpu;         /* of the stream; of payloads and requests; of payloads */
    uint64_t released, reports;
    uint32_t fails[MADE_NODES];     /* since it came last */
    gtx_stream_report last;
    gtx_error last_error;
} host;

static inline void host_release(void *memory, void *user)
{
    host *h = user;
    payload *p = memory;
    if (h->there[p->node] == p) {
        h->there[p->node] = NULL;
        h->cpu -= p->cpu;
        h->gpu -= p->gpu;
    }
    ++h->released;
    free(p);
}

static inline void host_report(const gtx_stream_report *report, void *user)
{
    host *h = user;
    h->last = *report;
    h->last_error = *report->error;
    ++h->reports;
    assert_true(strlen(report->error->message) > 8);
    assert_memory_equal(report->uri, "tiles/r", 7);
    uint32_t node = report->tile; /* its rest is asked for while it is there */
    node += h->there[node] ? MADE_TILES : 0;
    if (h->asked[node].id) {
        h->cpu -= h->asked[node].bytes + h->asked[node].memory;
        h->asked[node].id = 0;
    }
    if (report->error->result != GTX_ERROR_LIMIT)
        assert_int_equal(report->tries_left, h->desc.max_tries - ++h->fails[node]);
}

/* Bytes of the stream itself: all that it takes, it takes at once. */
static inline void *host_alloc(size_t size, void *user)
{
    ((host *)user)->own += size;
    return malloc(size);
}

static inline void host_free(void *memory, size_t size, void *user)
{
    ((host *)user)->own -= size;
    free(memory);
}

static inline void host_begin(host *h, const made_world *world, gtx_stream_desc desc)
{
    memset(h, 0, sizeof *h);
    const gtx_allocator hooks = {host_alloc, host_free, h};
    gtx_error error;
    desc.index = world->index;
    desc.index_size = sizeof world->index;
    desc.allocator = &hooks;
    desc.release = host_release;
    desc.report = host_report;
    desc.user = h;
    desc.max_tries = desc.max_tries ? desc.max_tries : 3;
    h->world = world;
    if (gtx_stream_create(&desc, &h->stream, &error))
        fail_msg("%s", error.message);
    h->desc = desc;
}

static inline void host_end(host *h)
{
    gtx_stream_destroy(h->stream);
    for (uint32_t i = 0; i < MADE_NODES; ++i)
        assert_null(h->there[i]);
    assert_int_equal(h->own, 0);
    assert_int_equal(h->gpu, 0);
}

static inline bool is_below(const made_world *world, uint32_t tile, uint32_t top)
{
    while (tile > top)
        tile = world->tiles[tile].parent;
    return tile == top;
}

/* No hole, and nothing twice: each leaf has at most one drawn tile above it, and exactly one where
 * its middle is in the picture; but nothing before the root is ready. */
static inline void host_check_draws(const host *h)
{
    static uint32_t covers[MADE_TILES];
    const made_world *world = h->world;
    const bool root = h->there[0] && h->there[0]->ready;
    memset(covers, 0, sizeof covers);
    for (uint32_t i = 0; i < h->frame.draw_count; ++i) {
        const gtx_stream_draw *draw = &h->frame.draws[i];
        const payload *rest = h->there[draw->tile + MADE_TILES];
        const payload *best = rest && rest->ready ? rest : h->there[draw->tile];
        assert_ptr_equal(best, draw->payload);
        assert_true(best->ready);
        covers[draw->tile]++;
    }
    for (uint32_t i = 0; i < MADE_TILES; ++i) {
        const gtx_index_tile *tile = &world->tiles[i];
        covers[i] += i ? covers[tile->parent] : 0;
        double middle[3];
        for (int k = 0; k < 3; ++k)
            middle[k] = (tile->low[k] + tile->high[k]) / 2;
        if (world->first_child[i])
            continue;
        assert_in_range(covers[i], 0, 1);
        if (root && made_sees(&h->view, middle))
            assert_int_equal(covers[i], 1);
    }
}

static inline uint32_t host_node(const gtx_stream_request *request)
{
    return request->tile + (request->from ? MADE_TILES : 0);
}

/* Without what a node would hang in the air. */
static inline uint32_t above(const made_world *world, uint32_t node)
{
    return node < MADE_TILES ? world->tiles[node].parent : node - MADE_TILES;
}

/* An update, and all that must hold whatever the source does. */
static inline void host_update(host *h)
{
    gtx_error error;
    if (gtx_stream_update(h->stream, &h->view, 1, &h->frame, &error))
        fail_msg("%s", error.message);
    const gtx_stream_frame *f = &h->frame;
    for (uint32_t i = 0; i < f->request_count; ++i) {
        const gtx_stream_request *r = &f->requests[i];
        const uint32_t node = host_node(r);
        assert_int_equal(h->asked[node].id, 0);
        assert_null(h->there[node]);
        if (node)
            assert_true(h->there[above(h->world, node)]->ready);
        assert_ptr_equal(r->beginning, r->from ? h->there[r->tile] : NULL);
        h->asked[node] = *r;
        h->cpu += r->bytes + r->memory;
    }
    for (uint32_t i = 1; i < MADE_NODES; ++i)
        if (h->there[i] || h->asked[i].id)
            assert_non_null(h->there[above(h->world, i)]);
    uint64_t sent = 0;
    for (uint32_t i = 0; i < f->upload_count; ++i) {
        payload *p = f->uploads[i].payload;
        assert_ptr_equal(h->there[p->node], p);
        assert_int_equal(f->uploads[i].tile, p->node % MADE_TILES);
        assert_false(p->ready);
        p->sent += f->uploads[i].bytes;
        sent += f->uploads[i].bytes;
    }
    if (h->desc.upload_bytes)
        assert_in_range(sent, 0, h->desc.upload_bytes);
    if (h->desc.cpu_bytes)
        assert_in_range(h->own + h->cpu, 0, h->desc.cpu_bytes);
    if (h->desc.gpu_bytes)
        assert_in_range(h->gpu, 0, h->desc.gpu_bytes);
    assert_int_equal(f->cpu_bytes, h->own + h->cpu);
    assert_true(f->gpu_bytes >= h->gpu);
    assert_int_equal(f->requested, f->delivered + f->failed + f->refused + f->under_way);
    assert_int_equal(f->resident, f->delivered - f->released);
    host_check_draws(h);
}

/* Answers a request with a payload of so many bytes. */
static inline gtx_result host_deliver(host *h, const gtx_stream_request *request, uint64_t cpu,
                                      uint64_t gpu)
{
    const uint32_t node = host_node(request);
    gtx_stream_request *asked = &h->asked[node];
    payload *p = calloc(1, sizeof *p);
    assert_non_null(p);
    *p = (payload){.node = node, .cpu = cpu, .gpu = gpu, .ready = gpu == 0};
    const bool current = asked->id == request->id;
    const uint64_t reserved = asked->bytes + asked->memory;
    if (current) {
        asked->id = 0;
        h->cpu -= reserved;
    }
    const gtx_result result = gtx_stream_deliver(h->stream, request->id, p, cpu, gpu);
    assert_true(current ? result == GTX_OK || result == GTX_ERROR_LIMIT
                        : result == GTX_CANCELLED);
    if (result == GTX_OK) {
        assert_null(h->there[node]);
        h->there[node] = p;
        h->cpu += cpu;
        h->gpu += gpu;
        h->fails[node] = 0;
    }
    return result;
}

static inline gtx_result host_fail(host *h, const gtx_stream_request *request,
                                   const gtx_error *error)
{
    return gtx_stream_fail(h->stream, request->id, error);
}

/* Tells what is uploaded; payloads then take `cpu` bytes. */
static inline void host_finish_uploads(host *h, uint64_t cpu)
{
    for (uint32_t i = 0; i < h->frame.upload_count; ++i) {
        payload *p = h->frame.uploads[i].payload;
        if (p->sent < p->gpu)
            continue;
        assert_int_equal(gtx_stream_ready(h->stream, p->node % MADE_TILES, cpu), GTX_OK);
        h->cpu -= p->cpu - cpu;
        p->cpu = cpu;
        p->ready = true;
    }
}

/* A source without fault: all is there at once. */
static inline void host_serve(host *h, uint64_t cpu, uint64_t gpu)
{
    for (uint32_t i = 0; i < h->frame.request_count; ++i)
        host_deliver(h, &h->frame.requests[i], cpu, gpu);
    host_finish_uploads(h, cpu);
}

static inline void host_run(host *h, int updates, uint64_t cpu, uint64_t gpu)
{
    for (int i = 0; i < updates; ++i) {
        host_update(h);
        host_serve(h, cpu, gpu);
    }
}

static const double pi = 3.14159265358979;

/* High above the middle, straight down: the error of the root is `pixels`. */
static inline gtx_stream_view from_above(double pixels)
{
    return made_view((double[3]){32, 16 + 4 * 250 / pixels, 32}, 0, -pi / 2);
}

/* A host with room for so many tiles, which are too few for its view: it has come to rest. */
static inline void host_begin_small(host *h, const made_world *world, uint64_t tiles)
{
    host_begin(h, world, (gtx_stream_desc){.max_error = 1, .gpu_bytes = 1000 * tiles + 7});
    h->view = made_view((double[3]){30, 6, 62}, 0.1, -0.2);
    host_run(h, 400, 10, 1000);
    const uint64_t requested = h->frame.requested;
    host_run(h, 200, 10, 1000);
    assert_int_equal(h->frame.requested, requested);
    assert_true(h->frame.without_room > 0 && h->frame.draw_count > 0);
    assert_int_equal(h->frame.pending, h->frame.without_room);
    assert_true(tiles < 10 || h->frame.resident > tiles / 2);
}

#endif
