/* Making a stream from an index: allocates all memory at once. */
#include "stream/stream.h"

#include "base/alloc.h"
#include "base/limits.h"

#include <math.h>
#include <string.h>

/* Arrays of a stream that are as long as the world has tiles. */
enum { ARRAYS = 9 };
typedef struct array {
    void **memory;
    size_t count, size;
} array;

static void arrays_of(gtx_stream *s, array out[ARRAYS])
{
    const size_t n = s->info.tiles, most = s->desc.max_requests;
    const array all[ARRAYS] = {
        {(void **)&s->facts, n, sizeof *s->facts},
        {(void **)&s->tiles, 2 * n, sizeof *s->tiles},
        {(void **)&s->requested.tiles, most, sizeof *s->requested.tiles},
        {(void **)&s->resident.tiles, 2 * n, sizeof *s->resident.tiles},
        {(void **)&s->stack, 2 * n, sizeof *s->stack},
        {(void **)&s->wants, 3 * n, sizeof *s->wants}, /* and those that leave */
        {(void **)&s->requests, most, sizeof *s->requests},
        {(void **)&s->uploads, 2 * n, sizeof *s->uploads},
        {(void **)&s->draws, n, sizeof *s->draws}};
    memcpy(out, all, sizeof all);
}

static gtx_result check_desc(const gtx_stream_desc *desc, gtx_error *error)
{
    if (!desc || (!desc->index && desc->index_size))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a stream needs the bytes of an index");
    if (!(desc->max_error >= 0) || isinf(desc->max_error))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "max_error is not finite and >= 0");
    if (desc->max_requests > GTX_STREAM_MAX_REQUESTS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "max_requests is beyond %d",
                        GTX_STREAM_MAX_REQUESTS);
    return gtx_check_reserved(desc->reserved, 6, error);
}

static void fill_defaults(gtx_stream_desc *desc)
{
    desc->index = NULL;
    desc->index_size = 0;
    desc->allocator = NULL;
    desc->cpu_bytes = desc->cpu_bytes ? desc->cpu_bytes : (uint64_t)1 << 30;
    desc->gpu_bytes = desc->gpu_bytes ? desc->gpu_bytes : (uint64_t)1 << 29;
    desc->upload_bytes = desc->upload_bytes ? desc->upload_bytes : (uint64_t)8 << 20;
    desc->max_error = desc->max_error > 0 ? desc->max_error : 1;
    desc->max_requests = desc->max_requests ? desc->max_requests : 8;
    desc->max_tries = desc->max_tries ? desc->max_tries : 4;
    desc->retry_updates = desc->retry_updates ? desc->retry_updates : 30;
    desc->patience_updates = desc->patience_updates ? desc->patience_updates : 3600;
}

/* One allocation after another; false when memory is out. */
static bool take_memory(gtx_stream *s)
{
    array arrays[ARRAYS];
    arrays_of(s, arrays);
    bool whole = true;
    for (int i = 0; i < ARRAYS && whole; ++i) {
        *arrays[i].memory = gtx_alloc_array(&s->allocator, arrays[i].count, arrays[i].size);
        whole = *arrays[i].memory != NULL;
        s->own_bytes += arrays[i].count * arrays[i].size;
    }
    s->leaving = whole ? s->wants + s->info.tiles : NULL;
    return whole;
}

/* Children are a run: gtx_index_read saw to that. */
static gtx_result read_tiles(gtx_stream *s, const uint8_t *data, gtx_error *error)
{
    for (uint32_t i = 0; i < s->info.tiles; ++i) {
        gtx_result result = gtx_index_read(data, &s->facts[i], i, error);
        if (result)
            return result;
        gtx_tile *tile = &s->tiles[i];
        const gtx_index_tile *facts = &s->facts[i];
        tile->facts = tile[s->info.tiles].facts = facts;
        tile->file = facts->beginning.bytes ? facts->beginning : facts->whole;
        tile[s->info.tiles].file = facts->whole;
        tile->state = facts->whole.bytes ? GTX_TILE_ABSENT : GTX_TILE_READY;
        s->info.bytes += facts->whole.bytes;
        if (i) {
            gtx_tile *parent = gtx_tile_parent(s, tile);
            parent->first_child = parent->child_count++ ? parent->first_child : i;
        }
    }
    memcpy(s->info.low, s->facts->low, sizeof s->info.low);
    memcpy(s->info.high, s->facts->high, sizeof s->info.high);
    s->info.error = s->facts->error;
    return GTX_OK;
}

static gtx_result fill(gtx_stream *s, const uint8_t *data, gtx_error *error)
{
    if (!take_memory(s))
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory for a stream of %u tiles",
                        s->info.tiles);
    gtx_result result = read_tiles(s, data, error);
    if (result)
        return result;
    s->cpu = s->own_bytes;
    const uint64_t least = s->own_bytes + s->tiles->file.bytes + s->tiles->file.memory;
    if (least > s->desc.cpu_bytes)
        return gtx_fail_limit(error, GTX_LIMITED_MEMORY, "the root of the world", least,
                              s->desc.cpu_bytes);
    return GTX_OK;
}

gtx_result gtx_stream_create(const gtx_stream_desc *desc, gtx_stream **out, gtx_error *error)
{
    uint32_t count;
    double unit;
    if (!out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "gtx_stream_create needs a result");
    *out = NULL;
    gtx_result result = check_desc(desc, error);
    if (!result)
        result = gtx_index_check(desc->index, desc->index_size, &count, &unit, error);
    if (result)
        return result;
    const gtx_allocator allocator = gtx_allocator_or_default(desc->allocator);
    gtx_stream *s = gtx_alloc_array(&allocator, 1, sizeof *s);
    if (!s)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory for a stream");
    s->allocator = allocator;
    s->desc = *desc;
    fill_defaults(&s->desc);
    s->info.tiles = count;
    s->info.unit = (float)unit;
    s->own_bytes = sizeof *s;
    result = fill(s, desc->index, error);
    if (result)
        gtx_stream_destroy(s);
    else
        *out = s;
    return result;
}

void gtx_stream_destroy(gtx_stream *s)
{
    array arrays[ARRAYS];
    if (!s)
        return;
    for (uint32_t i = 0; i < s->resident.count; ++i)
        if (s->desc.release)
            s->desc.release(s->tiles[s->resident.tiles[i]].payload, s->desc.user);
    arrays_of(s, arrays);
    for (int i = 0; i < ARRAYS; ++i)
        gtx_free_array(&s->allocator, *arrays[i].memory, arrays[i].count, arrays[i].size);
    gtx_allocator allocator = s->allocator;
    gtx_free_array(&allocator, s, 1, sizeof *s);
}

void gtx_stream_get_info(const gtx_stream *stream, gtx_stream_info *out)
{
    *out = stream->info;
}
