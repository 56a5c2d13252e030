/* What a stream asks for, uploads, draws and drops: the source answers as the test likes. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdbool.h>

#include "stream/host.h"
#include "stream/world.h"

static void the_root_comes_first(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.upload_bytes = 100});
    h.view = from_above(5);
    host_update(&h);
    assert_int_equal(h.frame.request_count, 1);
    const gtx_stream_request request = h.frame.requests[0];
    assert_string_equal(request.uri, "tiles/r.gtx");
    assert_int_equal(request.bytes, world.tiles[0].whole.bytes);
    assert_true(request.high[0] == MADE_SIDE && request.low[1] == 0);
    host_update(&h);
    assert_int_equal(h.frame.request_count + h.frame.draw_count, 0); /* it is asked for once */
    assert_int_equal(h.frame.pending, 1);
    host_deliver(&h, &request, 1000, 250);
    for (int i = 0; i < 3; ++i) {
        host_update(&h);
        assert_int_equal(h.frame.draw_count, 0);
        assert_int_equal(h.frame.uploads[0].bytes, i < 2 ? 100 : 50);
    }
    host_finish_uploads(&h, 10);
    host_update(&h);
    assert_int_equal(h.frame.draw_count, 1);
    assert_true(fabsf(h.frame.draws[0].pixels - 5) < 0.01f);
    host_end(&h);
    assert_int_equal(h.released, 1);
}

static void a_parent_stands_until_all_are_there(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 4});
    h.view = from_above(5);
    host_run(&h, 2, 10, 10);
    host_update(&h);
    assert_int_equal(h.frame.request_count, 4);
    gtx_stream_request children[4];
    memcpy(children, h.frame.requests, sizeof children);
    for (uint32_t k = 0; k < 4; ++k) {
        host_deliver(&h, &children[k], 10, 10);
        host_update(&h);
        assert_int_equal(h.frame.draws[0].tile, 0);
        if (k < 3)
            host_finish_uploads(&h, 10);
    }
    host_finish_uploads(&h, 10);
    host_update(&h);
    assert_int_equal(h.frame.draw_count, 4);
    assert_int_equal(h.frame.pending, 0);
    h.view = from_above(3); /* good enough from afar: the children stay, the root is drawn */
    host_update(&h);
    assert_int_equal(h.frame.draw_count, 1);
    assert_int_equal(h.frame.resident, 5);
    host_end(&h);
    assert_int_equal(h.released, 5);
}

/* Nothing is asked for any more where all that a view wants is there; what is drawn is as fine as
 * wanted, and no finer. */
static void a_view_is_served(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 2});
    h.view = made_view((double[3]){10, 20, 70}, 0.2, -0.4);
    host_run(&h, 60, 10, 10);
    assert_int_equal(h.frame.pending + h.frame.under_way, 0);
    const uint64_t requested = h.frame.requested;
    host_run(&h, 10, 10, 10);
    assert_int_equal(h.frame.requested, requested);
    for (uint32_t i = 0; i < h.frame.draw_count; ++i) {
        const gtx_stream_draw *draw = &h.frame.draws[i];
        assert_true(draw->pixels <= 2 || !world.first_child[draw->tile]);
    }
    assert_true(h.frame.draw_count > 20);
    host_end(&h);
}

/* Budgets for 160 tiles of 1,000 bytes; corners are looked at in turn. */
static void the_longest_unseen_leaves(void **state)
{
    (void)state;
    host h;
    uint64_t seen[MADE_TILES] = {0}, now = 0;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 6, .gpu_bytes = 160000});
    const double corners[][2] = {{8, 8}, {56, 56}, {8, 56}, {56, 8}, {8, 8}, {32, 32}};
    for (size_t c = 0; c < sizeof corners / sizeof *corners; ++c) {
        h.view = made_view((double[3]){corners[c][0], 20, corners[c][1]}, 0, -pi / 2);
        for (int i = 0; i < 40; ++i, ++now) {
            payload *before[MADE_TILES];
            memcpy(before, h.there, sizeof before);
            host_update(&h);
            for (uint32_t t = 1; t < MADE_TILES; ++t) {
                if (before[t] && !h.there[t] && c < 5) /* it left: no leaf was unseen longer */
                    for (uint32_t u = 1; u < MADE_TILES; ++u)
                        if (h.there[u] && h.world->first_child[u] == 0)
                            assert_true(seen[u] >= seen[t]);
            }
            for (uint32_t d = 0; d < h.frame.draw_count; ++d)
                for (uint32_t t = h.frame.draws[d].tile;; t = world.tiles[t].parent) {
                    seen[t] = now;
                    if (!t)
                        break;
                }
            host_serve(&h, 10, 1000);
            for (uint32_t t = 0; t < MADE_TILES; ++t)
                if (h.there[t] && !h.there[t]->ready)
                    seen[t] = now; /* on its way */
        }
        assert_true(h.frame.draw_count > 3);
        assert_int_equal(h.frame.under_way, 0);
    }
    assert_true(h.released > 100);
    host_end(&h);
}

/* Tiles that are drawn, and those above them. */
static uint32_t count_useful(const host *h)
{
    bool useful[MADE_TILES] = {false};
    uint32_t count = 0;
    for (uint32_t i = 0; i < h->frame.draw_count; ++i)
        for (uint32_t t = h->frame.draws[i].tile; !useful[t]; t = world.tiles[t].parent) {
            useful[t] = true;
            ++count;
        }
    return count;
}

/* A group of which a part has come, and the rest turns out to have no room, waits no more. */
static void parts_of_groups_come_to_rest(void **state)
{
    (void)state;
    host h;
    host_begin(&h, &world, (gtx_stream_desc){.max_error = 4, .gpu_bytes = 3000});
    h.view = from_above(5);
    host_run(&h, 2, 10, 100);
    host_update(&h);
    assert_int_equal(h.frame.request_count, 4);
    for (uint32_t k = 0; k < 4; ++k)
        host_deliver(&h, &h.frame.requests[k], 10, 1200);
    for (int i = 0; i < 200; ++i) { /* the first two are held */
        host_update(&h);
        host_serve(&h, 10, 1200);
    }
    assert_int_equal(h.frame.draws[0].tile, 0);
    assert_int_equal(h.frame.refused, 2);
    assert_true(h.frame.pending > 0);
    assert_int_equal(h.frame.pending, h.frame.without_room);
    host_end(&h);
}

/* With budgets that are too small for the view nobody takes turns, and little is there in vain. */
static void small_budgets_come_to_rest(void **state)
{
    (void)state;
    for (uint64_t tiles = 1; tiles < 120; tiles += 1 + tiles / 4) {
        host h;
        host_begin_small(&h, &world, tiles);
        assert_true(8 * count_useful(&h) >= 7 * h.frame.resident);
        host_end(&h);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_root_comes_first),
        cmocka_unit_test(a_parent_stands_until_all_are_there),
        cmocka_unit_test(a_view_is_served),
        cmocka_unit_test(the_longest_unseen_leaves),
        cmocka_unit_test(parts_of_groups_come_to_rest),
        cmocka_unit_test(small_budgets_come_to_rest),
    };
    return cmocka_run_group_tests(tests, make_world, free_world);
}
