/* Tiles in two parts: the beginning of a file first, the rest where it is looked at closely. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdbool.h>

#include "stream/host.h"
#include "stream/world.h"

/* Beginnings have an error half as large again as the tile's. */
static void the_rest_comes_after(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 6});
    h.view = from_above(5);
    host_update(&h);
    assert_int_equal(h.frame.request_count, 1);
    gtx_stream_request request = h.frame.requests[0];
    assert_int_equal(request.bytes, world.tiles[0].beginning.bytes);
    assert_int_equal(request.hash, world.tiles[0].beginning.hash);
    assert_int_equal(request.file_bytes, world.tiles[0].whole.bytes);
    assert_true(request.from == 0 && !request.beginning);
    host_deliver(&h, &request, 10, 0);
    const payload *beginning = h.there[0];
    host_update(&h);
    assert_true(fabsf(h.frame.draws[0].pixels - 7.5f) < 0.01f);
    assert_int_equal(h.frame.request_count, 1);
    request = h.frame.requests[0];
    assert_int_equal(request.from, world.tiles[0].beginning.bytes);
    assert_int_equal(request.bytes, world.tiles[0].whole.bytes);
    assert_int_equal(request.hash, world.tiles[0].whole.hash);
    assert_true(fabsf(request.pixels - 7.5f) < 0.01f);
    assert_int_equal(h.frame.pending, 1);
    host_deliver(&h, &request, 10, 20);
    host_update(&h);
    assert_ptr_equal(h.frame.draws[0].payload, beginning);
    host_finish_uploads(&h, 10);
    host_update(&h);
    assert_int_equal(h.frame.draw_count, 1);
    assert_true(h.frame.draws[0].payload == h.there[MADE_TILES] &&
                fabsf(h.frame.draws[0].pixels - 5) < 0.01f);
    assert_int_equal(h.frame.resident, 2);
    assert_int_equal(h.frame.pending, 0);
    host_end(&h);
    assert_int_equal(h.released, 2);
}

/* From far away it is enough. */
static void a_rest_may_not_be_needed(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 6});
    h.view = from_above(3.9);
    host_run(&h, 5, 10, 10);
    assert_int_equal(h.frame.requested, 1);
    assert_int_equal(h.frame.pending, 0);
    host_end(&h);
}

/* On the way down beginnings stand, and only the tiles that a view ends at are whole. */
static void the_way_down_is_short(void **state)
{
    (void)state;
    host h;
    uint64_t bytes = 0, whole = 0;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 2});
    h.view = made_view((double[3]){10, 20, 70}, 0.2, -0.4);
    for (int i = 0; i < 80; ++i) {
        host_update(&h);
        for (uint32_t k = 0; k < h.frame.request_count; ++k) {
            bytes += h.frame.requests[k].bytes - h.frame.requests[k].from;
            whole += h.frame.requests[k].from ? 0 : h.frame.requests[k].file_bytes;
        }
        host_serve(&h, 10, 10);
    }
    assert_int_equal(h.frame.pending + h.frame.under_way, 0);
    for (uint32_t t = 0; t < MADE_TILES; ++t) {
        bool drawn = false;
        for (uint32_t i = 0; i < h.frame.draw_count; ++i)
            drawn = drawn || h.frame.draws[i].tile == t;
        assert_true(drawn || !h.there[MADE_TILES + t]);
    }
    assert_true(bytes < whole && h.frame.draw_count > 20);
    host_end(&h);
}

static void a_beginning_stands_where_the_rest_fails(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 6, .retry_updates = 1});
    h.view = from_above(5);
    host_run(&h, 1, 10, 0);
    for (int i = 0; i < 40; ++i) {
        host_update(&h);
        assert_int_equal(h.frame.draw_count, 1);
        for (uint32_t k = 0; k < h.frame.request_count; ++k)
            host_fail(&h, &h.frame.requests[k], NULL);
    }
    assert_int_equal(h.frame.failed, h.desc.max_tries);
    assert_int_equal(h.frame.given_up, 1);
    assert_int_equal(h.frame.pending, 0);
    assert_string_equal(h.last_error.message, "the tile cannot be read");
    h.view = from_above(13); /* its children come all the same */
    host_run(&h, 3, 10, 0);
    assert_true(h.frame.draw_count >= 4);
    gtx_stream_retry(h.stream);
    memset(h.fails, 0, sizeof h.fails);
    h.view = from_above(5);
    host_run(&h, 3, 10, 0);
    assert_non_null(h.there[MADE_TILES]);
    host_end(&h);
}

/* Nobody takes turns where budgets hold little. */
static void small_budgets_come_to_rest(void **state)
{
    (void)state;
    for (uint64_t tiles = 1; tiles < 120; tiles += 1 + tiles / 4) {
        host h;
        host_begin_small(&h, &world, tiles);
        host_end(&h);
    }
}

/* What is in a frame's list stays for the frame, whatever comes. */
static void a_drawn_rest_does_not_leave(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 6, .gpu_bytes = 6500});
    h.view = from_above(5);
    host_run(&h, 4, 10, 1000);
    h.view = from_above(7); /* the children are wanted; the whole root is drawn until they come */
    host_update(&h);
    assert_int_equal(h.frame.request_count, 4);
    const payload *rest = h.there[MADE_TILES];
    assert_non_null(rest);
    assert_ptr_equal(h.frame.draws[0].payload, rest);
    for (uint32_t k = 0; k < 4; ++k)
        host_deliver(&h, &h.frame.requests[k], 10, 1600);
    assert_ptr_equal(h.there[MADE_TILES], rest);
    host_run(&h, 60, 10, 1600);
    host_end(&h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rest_comes_after),
        cmocka_unit_test(a_rest_may_not_be_needed),
        cmocka_unit_test(the_way_down_is_short),
        cmocka_unit_test(a_beginning_stands_where_the_rest_fails),
        cmocka_unit_test(small_budgets_come_to_rest),
        cmocka_unit_test(a_drawn_rest_does_not_leave),
    };
    return cmocka_run_group_tests(tests, make_world_with_beginnings, free_world);
}
