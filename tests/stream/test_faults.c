/* A million requests to a source that delays, drops, truncates and lies: nothing is lost, nothing
 * is leaked, budgets hold in every frame, and no frame has a hole. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdbool.h>
#include <stdio.h>

#include "stream/host.h"
#include "stream/world.h"

enum { MAX_UNDER_WAY = 48, MAX_DELAY = 12, QUEUE = 4096 };

typedef enum fault {
    FAULT_NONE,
    FAULT_ERROR,                    /* the read fails */
    FAULT_SHORT,                    /* the file ends early */
    FAULT_LONG,
    FAULT_FLIP,                     /* a bit is wrong */
    FAULT_OTHER,                    /* the bytes are those of another tile */
    FAULT_SILENCE,                  /* no answer */
    FAULT_TWICE,                    /* answered twice */
    FAULT_LATE,                     /* after the stream's patience */
    FAULT_LARGE,                    /* takes more than expected */
    FAULTS
} fault;

/* What is under way: a ring by the update at which it is answered. */
typedef struct answer {
    gtx_stream_request request;
    uint64_t at;
    fault fault;
} answer;

static answer queue[QUEUE];
static uint32_t queued;
static uint64_t seed = 1, faults[FAULTS], opened, lies;

static uint32_t below(uint32_t n)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((seed >> 33) % n);
}

static double unit(void)
{
    return below(1 << 20) / (double)(1 << 20);
}

/* Walks, turns, and now and then jumps. */
static void move(gtx_stream_view *view)
{
    static double eye[3] = {32, 24, 32}, azimuth, elevation;
    if (below(60) == 0) {
        eye[0] = 64 * unit();
        eye[2] = 64 * unit();
        azimuth = 7 * unit();
    }
    eye[0] += unit() - 0.5;
    eye[1] = 17 + 8 * unit();
    eye[2] += unit() - 0.5;
    azimuth += 0.2 * (unit() - 0.5);
    elevation = -0.3 - unit();
    *view = made_view(eye, azimuth, elevation);
}

static void queue_request(const host *h, const gtx_stream_request *request, uint64_t now)
{
    const fault f = below(3) ? FAULT_NONE : (fault)below(FAULTS);
    assert_true(queued < QUEUE);
    ++faults[f];
    if (f != FAULT_SILENCE)
        queue[queued++] = (answer){*request, now + below(MAX_DELAY) +
                                   (f == FAULT_LATE ? h->desc.patience_updates : 0), f};
}

/* The bytes as the source gives them, opened as a host does. */
static bool open_bytes(const answer *a, gtx_error *error)
{
    static uint8_t bytes[1 << 16];
    const uint32_t from = a->fault == FAULT_OTHER ? (a->request.tile + 1) % MADE_TILES
                                                  : a->request.tile;
    size_t size = (size_t)world.tiles[from].whole.bytes;
    memcpy(bytes, world.files[from], size);
    size = a->request.bytes < size ? (size_t)a->request.bytes : size;
    if (a->fault == FAULT_FLIP)
        bytes[below((uint32_t)size)] ^= (uint8_t)(1 << below(8));
    size = a->fault == FAULT_SHORT ? below((uint32_t)size) : size + (a->fault == FAULT_LONG);
    gtx_asset *asset;
    uint64_t held;
    const gtx_result result = gtx_stream_open(&a->request, bytes, size, NULL, &asset, &held, error);
    ++opened;
    if (a->fault == FAULT_SHORT || a->fault == FAULT_LONG || a->fault == FAULT_FLIP ||
        a->fault == FAULT_OTHER) {
        assert_int_equal(result, a->fault == FAULT_SHORT ? GTX_ERROR_TRUNCATED
                                                         : GTX_ERROR_CORRUPT);
        assert_null(asset);
        ++lies;
    } else {
        assert_int_equal(result, GTX_OK);
        assert_in_range(held, 1, a->request.memory);
    }
    gtx_close(asset);
    return result == GTX_OK;
}

static void give(host *h, const answer *a)
{
    gtx_error error = {.result = GTX_ERROR_READ, .message = "the disk is on fire"};
    const bool current = h->asked[host_node(&a->request)].id == a->request.id;
    if (a->fault == FAULT_ERROR || !open_bytes(a, &error)) {
        assert_int_equal(host_fail(h, &a->request, &error), current ? GTX_OK : GTX_CANCELLED);
        return;
    }
    const uint64_t size = 200 + 10 * (a->request.tile % 7);
    for (int n = 0; n < (a->fault == FAULT_TWICE ? 2 : 1); ++n)
        host_deliver(h, &a->request, a->fault == FAULT_LARGE ? 60000 : size,
                     a->request.tile % 5 ? 3 * size : 0);
}

static void answer_what_is_due(host *h, uint64_t now)
{
    for (uint32_t i = 0; i < queued;)
        if (queue[i].at <= now) {
            const answer due = queue[i];
            queue[i] = queue[--queued];
            give(h, &due);
        } else {
            ++i;
        }
}

static void a_million_requests(void **state)
{
    (void)state;
    const uint64_t most = 1000000;
    static host h;
    gtx_stream_desc desc = {.max_error = 5, .upload_bytes = 4000, .gpu_bytes = 60000,
                            .max_requests = MAX_UNDER_WAY, .retry_updates = 1, .max_tries = 3,
                            .patience_updates = 40};
    host_begin(&h, &world, desc);
    const uint64_t own = h.own;
    host_end(&h);
    desc.cpu_bytes = own + 250000;
    host_begin(&h, &world, desc);
    uint64_t now = 0, most_cpu = 0, most_gpu = 0, drawn = 0;
    for (; h.frame.requested < most; ++now) {
        move(&h.view);
        host_update(&h);
        for (uint32_t i = 0; i < h.frame.request_count; ++i)
            queue_request(&h, &h.frame.requests[i], now);
        host_finish_uploads(&h, 50);
        answer_what_is_due(&h, now);
        if (now % 1000 == 999) { /* the source is mended */
            gtx_stream_retry(h.stream);
            memset(h.fails, 0, sizeof h.fails);
        }
        most_cpu = h.frame.cpu_bytes > most_cpu ? h.frame.cpu_bytes : most_cpu;
        most_gpu = h.frame.gpu_bytes > most_gpu ? h.frame.gpu_bytes : most_gpu;
        drawn += h.frame.draw_count;
    }
    host_update(&h);
    const gtx_stream_frame *f = &h.frame;
    printf("    %llu requests in %llu frames: %llu delivered, %llu failed, %llu refused, %u "
           "under way; %llu lies\n    at most %llu and %llu bytes, of %llu and %llu; %.1f tiles a "
           "frame\n",
           (unsigned long long)f->requested, (unsigned long long)now,
           (unsigned long long)f->delivered, (unsigned long long)f->failed,
           (unsigned long long)f->refused, f->under_way, (unsigned long long)lies,
           (unsigned long long)(most_cpu - own), (unsigned long long)most_gpu, 250000ull, 60000ull,
           (double)drawn / (double)now);
    for (int i = 0; i < FAULTS; ++i)
        assert_true(faults[i] > most / 100);
    assert_true(f->delivered > most / 3 && f->refused > 0 && f->released > most / 4);
    assert_int_equal(h.reports, f->failed + f->refused);
    host_end(&h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_million_requests),
    };
    return cmocka_run_group_tests(tests, make_world_with_beginnings, free_world);
}
