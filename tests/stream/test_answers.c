/* Requests that fail, answers that come late or are too large, calls that are wrong. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdbool.h>

#include "common/counter.h"
#include "stream/host.h"
#include "stream/world.h"

static void failures_are_bounded(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 4, .retry_updates = 2,
                                             .patience_updates = 50});
    h.view = from_above(5);
    host_run(&h, 3, 10, 0);
    host_update(&h);
    assert_int_equal(h.frame.draw_count, 4);
    h.view = made_view((double[3]){16, 16 + 50, 16}, 0, -pi / 2);
    uint64_t at[4] = {0}, tries = 0;
    gtx_stream_request last = {0};
    for (uint64_t update = 0; update < 55; ++update) {
        host_update(&h);
        for (uint32_t i = 0; i < h.frame.request_count; ++i) {
            const gtx_stream_request request = h.frame.requests[i];
            if (strcmp(request.uri, "tiles/r01.gtx") != 0) {
                host_deliver(&h, &request, 10, 0);
                continue;
            }
            last = request;
            at[tries++] = update;
            const gtx_error error = {.result = GTX_ERROR_READ, .message = "no such file"};
            if (tries != 2)
                assert_int_equal(host_fail(&h, &request, tries == 1 ? &error : NULL), GTX_OK);
            if (tries == 1)
                assert_string_equal(h.last_error.message, "no such file");
        }
    }
    assert_int_equal(tries, 2); /* the second is not answered */
    assert_int_equal(at[1] - at[0], 2);
    assert_int_equal(h.reports, 2);
    assert_int_equal(h.last_error.result, GTX_ERROR_READ);
    assert_int_equal(h.last.tries_left, 1);
    assert_int_equal(host_fail(&h, &last, NULL), GTX_CANCELLED);
    assert_int_equal(host_deliver(&h, &last, 10, 0), GTX_CANCELLED);
    host_run(&h, 1, 10, 0);
    assert_int_equal(h.asked[6].id, 0);
    host_end(&h);
}

static void who_is_given_up_may_come_back(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 4, .retry_updates = 1});
    h.view = from_above(5);
    for (int i = 0; i < 40; ++i) {
        host_update(&h);
        for (uint32_t k = 0; k < h.frame.request_count; ++k)
            if (h.frame.requests[k].tile == 3)
                host_fail(&h, &h.frame.requests[k], NULL);
            else
                host_deliver(&h, &h.frame.requests[k], 10, 0);
    }
    assert_int_equal(h.frame.given_up, 1);
    assert_int_equal(h.frame.pending, 0);
    assert_int_equal(h.last.tries_left, 0);
    assert_int_equal(h.frame.failed, 3);
    assert_int_equal(h.frame.draws[0].tile, 0);
    gtx_stream_retry(h.stream);
    h.fails[3] = 0;
    host_run(&h, 2, 10, 0);
    host_update(&h);
    assert_int_equal(h.frame.given_up, 0);
    assert_int_equal(h.frame.draw_count, 4);
    host_end(&h);
}

/* Where one child is given up its siblings would show nothing: they are not asked for. */
static void siblings_are_not_asked_for_in_vain(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 4, .max_requests = 1, .max_tries = 1});
    h.view = from_above(5);
    host_run(&h, 1, 10, 0);
    for (int i = 0; i < 20; ++i) {
        host_update(&h);
        for (uint32_t k = 0; k < h.frame.request_count; ++k)
            host_fail(&h, &h.frame.requests[k], NULL);
    }
    assert_int_equal(h.frame.requested, 2);
    assert_int_equal(h.frame.given_up, 1);
    assert_int_equal(h.frame.draw_count, 1);
    host_end(&h);
}

/* Larger than the room that is there: refused, with a report, and not asked for again and again. */
static void what_is_too_large_is_refused(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 4, .gpu_bytes = 5000,
                                             .retry_updates = 1});
    h.view = from_above(5);
    host_run(&h, 2, 10, 1000);
    host_update(&h);
    assert_int_equal(h.frame.request_count, 4);
    uint32_t refused = 0;
    for (int i = 0; i < 50; ++i) {
        for (uint32_t k = 1; k < 5; ++k)
            if (h.asked[k].id) {
                const gtx_stream_request request = h.asked[k];
                refused += host_deliver(&h, &request, 10, 3000) == GTX_ERROR_LIMIT;
            }
        host_update(&h);
    }
    assert_in_range(refused, 1, 4);
    assert_int_equal(h.frame.draws[0].tile, 0);
    assert_int_equal(h.last_error.result, GTX_ERROR_LIMIT);
    host_end(&h);
    gtx_stream *none;
    gtx_stream_desc desc = {.index = world.index, .index_size = sizeof world.index,
                            .cpu_bytes = 10000};
    gtx_error error;
    assert_int_equal(gtx_stream_create(&desc, &none, &error), GTX_ERROR_LIMIT);
    assert_null(none);
}

static void misuse_is_refused(void **state)
{
    (void)state;
    gtx_stream_desc desc = {.index = world.index, .index_size = sizeof world.index};
    gtx_stream *stream;
    gtx_stream_frame frame;
    gtx_stream_view view = from_above(5);
    assert_int_equal(gtx_stream_create(NULL, &stream, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_stream_create(&desc, NULL, NULL), GTX_ERROR_ARGUMENT);
    desc.reserved[5] = 1;
    assert_int_equal(gtx_stream_create(&desc, &stream, NULL), GTX_ERROR_NOT_ZEROED);
    desc.reserved[5] = 0;
    desc.max_error = NAN;
    assert_int_equal(gtx_stream_create(&desc, &stream, NULL), GTX_ERROR_ARGUMENT);
    desc.max_error = 0;
    desc.max_requests = 5000;
    assert_int_equal(gtx_stream_create(&desc, &stream, NULL), GTX_ERROR_ARGUMENT);
    desc.max_requests = 0;
    assert_int_equal(gtx_stream_create(&desc, &stream, NULL), GTX_OK);
    assert_int_equal(gtx_stream_update(stream, NULL, 1, &frame, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_stream_update(stream, &view, 17, &frame, NULL), GTX_ERROR_ARGUMENT);
    view.view[3] = INFINITY;
    assert_int_equal(gtx_stream_update(stream, &view, 1, &frame, NULL), GTX_ERROR_ARGUMENT);
    view = from_above(5);
    view.reserved[2] = 1;
    assert_int_equal(gtx_stream_update(stream, &view, 1, &frame, NULL), GTX_ERROR_NOT_ZEROED);
    view.reserved[2] = 0;
    view.viewport_height = 0;
    assert_int_equal(gtx_stream_update(stream, &view, 1, &frame, NULL), GTX_ERROR_ARGUMENT);
    memset(view.projection, 0, sizeof view.projection);
    view.viewport_height = 1;
    assert_int_equal(gtx_stream_update(stream, &view, 1, &frame, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_stream_update(stream, NULL, 0, &frame, NULL), GTX_OK);
    assert_int_equal(frame.request_count, 1);
    assert_int_equal(gtx_stream_deliver(stream, 77, &view, 1, 1), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_stream_deliver(stream, frame.requests[0].id, NULL, 1, 1),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_stream_fail(stream, 0, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_stream_ready(stream, 0, 0), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_stream_ready(stream, MADE_TILES, 0), GTX_ERROR_ARGUMENT);
    gtx_stream_destroy(stream);
    gtx_stream_destroy(NULL);
    gtx_stream_retry(NULL);
}

static void memory_may_run_out(void **state)
{
    (void)state;
    for (long good = 0;; ++good) {
        counter c = {good, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        const gtx_stream_desc desc = {.index = world.index, .index_size = sizeof world.index,
                                      .allocator = &hooks};
        gtx_stream *stream;
        const gtx_result result = gtx_stream_create(&desc, &stream, NULL);
        assert_int_equal(result, stream ? GTX_OK : GTX_ERROR_MEMORY);
        gtx_stream_destroy(stream);
        assert_int_equal(c.bytes, 0);
        if (!result) {
            assert_int_equal(good, 10);
            break;
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(failures_are_bounded),
        cmocka_unit_test(who_is_given_up_may_come_back),
        cmocka_unit_test(siblings_are_not_asked_for_in_vain),
        cmocka_unit_test(what_is_too_large_is_refused),
        cmocka_unit_test(misuse_is_refused),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, make_world, free_world);
}
