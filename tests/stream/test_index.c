/* The index's reader takes what format/world.md allows and nothing else; so does opening a tile. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/bytes.h"
#include "common/counter.h"
#include "stream/world.h"

static gtx_result create(const uint8_t *data, size_t size)
{
    const gtx_stream_desc desc = {.index = data, .index_size = size};
    gtx_stream *stream;
    gtx_error error = {0};
    const gtx_result result = gtx_stream_create(&desc, &stream, &error);
    assert_int_equal(result, stream ? GTX_OK : error.result);
    assert_true(stream || strlen(error.message) > 8);
    gtx_stream_destroy(stream);
    return result;
}

static void an_index_is_read(void **state)
{
    (void)state;
    const gtx_stream_desc desc = {.index = world.index, .index_size = sizeof world.index};
    gtx_stream *stream;
    gtx_stream_info info;
    assert_int_equal(gtx_stream_create(&desc, &stream, NULL), GTX_OK);
    gtx_stream_get_info(stream, &info);
    assert_int_equal(info.tiles, MADE_TILES);
    assert_true(info.high[0] == MADE_SIDE && info.low[2] == 0 && info.unit == 1);
    assert_true(info.error == 4 && info.bytes > MADE_TILES * 200);
    gtx_stream_destroy(stream);
    gtx_index_tile one = {.name = "r"}; /* a world of nothing */
    uint8_t bytes[GTX_INDEX_HEADER + GTX_INDEX_RECORD];
    gtx_index_write(&one, 1, 0.5, bytes);
    assert_int_equal(create(bytes, sizeof bytes), GTX_OK);
}

static void a_prefix_is_refused(void **state)
{
    (void)state;
    for (size_t size = 0; size < 400; ++size) {
        uint8_t *part = malloc(size + 1); /* of its own, for the sanitizers */
        assert_non_null(part);
        memcpy(part, world.index, size);
        assert_int_equal(create(part, size), size < 12 ? GTX_ERROR_NOT_GTX : GTX_ERROR_TRUNCATED);
        free(part);
    }
    uint8_t *more = calloc(1, sizeof world.index + 1);
    assert_non_null(more);
    memcpy(more, world.index, sizeof world.index);
    assert_int_equal(create(more, sizeof world.index - 1), GTX_ERROR_TRUNCATED);
    assert_int_equal(create(more, sizeof world.index + 1), GTX_ERROR_CORRUPT);
    free(more);
}

static void a_wrong_bit_is_refused(void **state)
{
    (void)state;
    static uint8_t bytes[sizeof world.index];
    memcpy(bytes, world.index, sizeof bytes);
    for (size_t i = 0; i < 8 * sizeof bytes; i += i < 8000 ? 1 : 97) {
        bytes[i / 8] ^= (uint8_t)(1 << i % 8);
        assert_int_not_equal(create(bytes, sizeof bytes), GTX_OK);
        bytes[i / 8] ^= (uint8_t)(1 << i % 8);
    }
}

/* What each rule forbids, with the right hash. */
typedef void (*spoiler)(gtx_index_tile *tiles);
static void nan_box(gtx_index_tile *t) { t[9].low[1] = NAN; }
static void turned_box(gtx_index_tile *t) { t[9].low[0] = t[9].high[0] + 1; }
static void outside(gtx_index_tile *t) { t[9].high[2] += 100; }
static void negative_error(gtx_index_tile *t) { t[200].error = -1; }
static void infinite_error(gtx_index_tile *t) { t[0].error = INFINITY; }
static void larger_error(gtx_index_tile *t) { t[9].error = 100; }
static void root_with_parent(gtx_index_tile *t) { t[0].parent = 1; }
static void own_parent(gtx_index_tile *t) { t[9].parent = 9; }
static void later_parent(gtx_index_tile *t) { t[9].parent = 40; }
static void earlier_parent(gtx_index_tile *t) { t[9].parent = 0; }
static void huge_file(gtx_index_tile *t) { t[9].whole.bytes = UINT64_MAX; }
static void huge_memory(gtx_index_tile *t) { t[9].whole.memory = UINT64_MAX - 7; }
static void hash_of_nothing(gtx_index_tile *t) { t[5].whole.bytes = 0; }
static void beginning_of_all(gtx_index_tile *t) { t[9].beginning.bytes = t[9].whole.bytes; }
static void finer_beginning(gtx_index_tile *t) { t[9].beginning_error = 0.9f * t[9].error; }
static void infinite_beginning(gtx_index_tile *t) { t[9].beginning_error = INFINITY; }
static void huge_opening(gtx_index_tile *t) { t[9].beginning.memory = UINT64_MAX; }
static void error_of_none(gtx_index_tile *t) { t[5].beginning_error = 9; }
static void memory_of_none(gtx_index_tile *t) { t[5].beginning.memory = 1; }
static void no_name(gtx_index_tile *t) { memset(t[9].name, 0, GTX_INDEX_NAME); }
static void path_name(gtx_index_tile *t) { memcpy(t[9].name, "r0/../x", 7); }
static void long_name(gtx_index_tile *t) { memset(t[9].name + 1, '0', GTX_INDEX_NAME - 1); }
static void rest_behind(gtx_index_tile *t) { t[9].name[20] = '1'; }
static void other_branch(gtx_index_tile *t) { t[9].name[1] = '7'; }
static void same_name(gtx_index_tile *t) { memcpy(t[10].name, t[9].name, GTX_INDEX_NAME); }
static void begins_alike(gtx_index_tile *t) { memcpy(t[10].name, "r100", 4); }
static void parents_name(gtx_index_tile *t) { memcpy(t[9].name, t[2].name, GTX_INDEX_NAME); }

static void rules_hold(void **state)
{
    (void)state;
    static const spoiler all[] = {nan_box, turned_box, outside, negative_error, infinite_error,
                                  larger_error, root_with_parent, own_parent, later_parent,
                                  earlier_parent, huge_file, huge_memory, hash_of_nothing,
                                  beginning_of_all, finer_beginning, infinite_beginning,
                                  huge_opening, error_of_none, memory_of_none,
                                  no_name, path_name, long_name, rest_behind, other_branch,
                                  same_name, begins_alike, parents_name};
    static made_world copy;
    assert_string_equal(world.tiles[9].name, "r10");
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        memcpy(&copy, &world, sizeof copy);
        all[i](copy.tiles);
        gtx_index_write(copy.tiles, MADE_TILES, 1, copy.index);
        if (create(copy.index, sizeof copy.index) != GTX_ERROR_CORRUPT)
            fail_msg("spoiler %zu is not refused", i);
    }
    const double units[] = {0, -1, NAN, INFINITY};
    for (size_t i = 0; i < 4; ++i) {
        gtx_index_write(world.tiles, MADE_TILES, units[i], copy.index);
        assert_int_equal(create(copy.index, sizeof copy.index), GTX_ERROR_CORRUPT);
    }
    for (size_t at = 12; at < 24; at += 4) { /* versions, count, reserved */
        gtx_index_write(world.tiles, MADE_TILES, 1, copy.index);
        copy.index[at] += 2;
        assert_int_not_equal(create(copy.index, sizeof copy.index), GTX_OK);
    }
}

/* ---- tiles ---- */

static gtx_stream_request request_of(uint32_t tile)
{
    const gtx_index_tile *t = &world.tiles[tile];
    gtx_stream_request request = {.tile = tile, .bytes = t->whole.bytes,
                                  .file_bytes = t->whole.bytes, .memory = t->whole.memory,
                                  .hash = t->whole.hash};
    memcpy(request.low, t->low, sizeof t->low);
    memcpy(request.high, t->high, sizeof t->high);
    return request;
}

static gtx_result open_tile(const gtx_stream_request *request, uint32_t file,
                            const gtx_allocator *hooks)
{
    gtx_asset *asset;
    gtx_error error = {0};
    uint64_t held = 0;
    const gtx_open_desc desc = {.allocator = hooks};
    const gtx_result result =
        gtx_stream_open(request, world.files[file],
                        (size_t)(request->bytes < request->file_bytes
                                     ? request->bytes
                                     : world.tiles[file].whole.bytes),
                        &desc, &asset, &held, &error);
    assert_int_equal(!asset, result != GTX_OK);
    assert_int_equal(error.result, result);
    if (hooks && asset)
        assert_int_equal(held, ((counter *)hooks->user)->bytes);
    gtx_close(asset);
    return result;
}

static void a_tile_is_what_was_asked_for(void **state)
{
    (void)state;
    gtx_stream_request request = request_of(9);
    counter c = {-1, 0};
    const gtx_allocator hooks = {counted_alloc, counted_free, &c};
    assert_int_equal(open_tile(&request, 9, &hooks), GTX_OK);
    assert_int_equal(c.bytes, 0);
    assert_int_equal(open_tile(&request, 10, NULL), GTX_ERROR_CORRUPT);
    request.high[0] -= 0.5; /* the index and the file lie together: the box does not hold it */
    assert_int_equal(open_tile(&request, 9, NULL), GTX_ERROR_CORRUPT);
    request = request_of(9);
    request.low[1] = NAN;
    assert_int_equal(open_tile(&request, 9, NULL), GTX_ERROR_CORRUPT);
    request = request_of(9);
    request.memory = 500;
    assert_int_equal(open_tile(&request, 9, NULL), GTX_ERROR_LIMIT);
    request.memory = 0;
    assert_int_equal(open_tile(&request, 9, NULL), GTX_ERROR_LIMIT);
    request = request_of(9);
    for (long good = 0;; ++good) {
        c = (counter){good, 0};
        const gtx_result result = open_tile(&request, 9, &hooks);
        assert_int_equal(c.bytes, 0);
        if (!result)
            break;
        assert_int_equal(result, GTX_ERROR_MEMORY);
    }
    gtx_asset *asset;
    assert_int_equal(gtx_stream_open(NULL, "", 0, NULL, &asset, NULL, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_stream_open(&request, NULL, 1, NULL, &asset, NULL, NULL),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_stream_open(&request, "", 0, NULL, NULL, NULL, NULL), GTX_ERROR_ARGUMENT);
}

static void a_beginning_is_what_was_asked_for(void **state)
{
    (void)state;
    counter c = {-1, 0};
    const gtx_allocator hooks = {counted_alloc, counted_free, &c};
    const gtx_index_tile *tile = &world.tiles[9];
    gtx_stream_request request = request_of(9);
    request.bytes = tile->beginning.bytes;
    request.hash = tile->beginning.hash;
    request.memory = tile->beginning.memory;
    const gtx_stream_request good = request;
    assert_int_equal(open_tile(&request, 9, &hooks), GTX_OK);
    assert_int_equal(open_tile(&request, 10, NULL), GTX_ERROR_CORRUPT);
    request.hash = world.tiles[10].beginning.hash; /* a lie of the index */
    assert_int_equal(open_tile(&request, 10, NULL), GTX_ERROR_CORRUPT);
    request = good;
    ++request.file_bytes;
    assert_int_equal(open_tile(&request, 9, NULL), GTX_ERROR_CORRUPT);
    request = good;
    request.bytes -= 1; /* shows nothing */
    request.hash = gtx_hash_bytes(world.files[9], (size_t)request.bytes);
    assert_int_equal(open_tile(&request, 9, NULL), GTX_ERROR_CORRUPT);
    request = good;
    request.memory = 500;
    assert_int_equal(open_tile(&request, 9, NULL), GTX_ERROR_LIMIT);
    gtx_asset *asset;
    assert_int_equal(gtx_stream_open(&good, world.files[9], (size_t)good.bytes - 1, NULL, &asset,
                                     NULL, NULL), GTX_ERROR_TRUNCATED);
    assert_int_equal(gtx_stream_open(&good, world.files[9], (size_t)good.bytes + 1, NULL, &asset,
                                     NULL, NULL), GTX_ERROR_CORRUPT);
    for (long calls = 0;; ++calls) {
        c = (counter){calls, 0};
        const gtx_result result = open_tile(&good, 9, &hooks);
        assert_int_equal(c.bytes, 0);
        if (!result)
            break;
        assert_int_equal(result, GTX_ERROR_MEMORY);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_index_is_read),
        cmocka_unit_test(a_prefix_is_refused),
        cmocka_unit_test(a_wrong_bit_is_refused),
        cmocka_unit_test(rules_hold),
        cmocka_unit_test(a_tile_is_what_was_asked_for),
        cmocka_unit_test(a_beginning_is_what_was_asked_for),
    };
    return cmocka_run_group_tests(tests, make_world_with_beginnings, free_world);
}
