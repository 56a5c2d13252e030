/* Answers to requests: payloads, failures, uploads. */
#include "stream/stream.h"

#include "base/error.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { TILE_BITS = 21, MAX_DOUBLINGS = 16 };

void gtx_tile_uri(const gtx_tile *tile, char out[GTX_STREAM_URI])
{
    snprintf(out, GTX_STREAM_URI, "tiles/%s.gtx", tile->facts->name);
}

static void give_back(gtx_stream *stream, void *payload)
{
    if (stream->desc.release)
        stream->desc.release(payload, stream->desc.user);
}

void gtx_tile_drop(gtx_stream *stream, gtx_tile *tile)
{
    void *payload = tile->payload;
    gtx_list_remove(stream, &stream->resident, tile);
    gtx_tile_take(stream, tile, 0, 0);
    tile->state = GTX_TILE_ABSENT;
    tile->payload = NULL;
    if (tile != stream->tiles)
        --gtx_tile_parent(stream, tile)->users;
    ++stream->frame.released;
    give_back(stream, payload);
}

void gtx_tile_ask(gtx_stream *stream, gtx_tile *tile)
{
    uint64_t cpu, gpu;
    gtx_tile_cost(stream, tile, &cpu, &gpu);
    gtx_tile_take(stream, tile, tile->file.bytes + tile->file.memory, gpu);
    gtx_list_add(stream, &stream->requested, tile);
    tile->state = GTX_TILE_REQUESTED;
    tile->request = ++stream->serial << TILE_BITS | gtx_tile_number(stream, tile);
    tile->asked = stream->update;
    if (tile != stream->tiles)
        ++gtx_tile_parent(stream, tile)->users;
    ++stream->frame.requested;
}

/* The request is over: its tile takes nothing. */
static void end_request(gtx_stream *stream, gtx_tile *tile)
{
    gtx_list_remove(stream, &stream->requested, tile);
    gtx_tile_take(stream, tile, 0, 0);
    tile->state = GTX_TILE_ABSENT;
    tile->request = 0;
    if (tile != stream->tiles)
        --gtx_tile_parent(stream, tile)->users;
}

void gtx_tile_fail(gtx_stream *stream, gtx_tile *tile, const gtx_error *error, bool counts)
{
    const gtx_stream_desc *desc = &stream->desc;
    char uri[GTX_STREAM_URI];
    end_request(stream, tile);
    const uint32_t doublings = tile->tries < MAX_DOUBLINGS ? tile->tries : MAX_DOUBLINGS;
    tile->retry = stream->update + ((uint64_t)desc->retry_updates << doublings);
    tile->tries += counts;
    if (tile->tries >= desc->max_tries) {
        tile->state = GTX_TILE_GIVEN_UP;
        ++stream->frame.given_up;
    }
    counts ? ++stream->frame.failed : ++stream->frame.refused;
    gtx_tile_uri(tile, uri);
    const gtx_stream_report report = {gtx_tile_index(stream, tile), uri, error,
                                      desc->max_tries - tile->tries};
    if (desc->report)
        desc->report(&report, desc->user);
}

/* NULL, with *result, where the answer is to no request or too late. */
static gtx_tile *find_request(gtx_stream *stream, uint64_t id, gtx_result *result)
{
    const uint32_t number = (uint32_t)(id & ((1u << TILE_BITS) - 1));
    const uint64_t serial = id >> TILE_BITS;
    *result = GTX_ERROR_ARGUMENT;
    if (number >= 2 * stream->info.tiles || serial == 0 || serial > stream->serial)
        return NULL;
    *result = stream->tiles[number].request == id ? GTX_OK : GTX_CANCELLED;
    return *result ? NULL : &stream->tiles[number];
}

gtx_result gtx_stream_deliver(gtx_stream *stream, uint64_t id, void *payload, uint64_t cpu_bytes,
                              uint64_t gpu_bytes)
{
    gtx_result result;
    gtx_error error;
    if (!stream || !payload)
        return GTX_ERROR_ARGUMENT;
    gtx_tile *tile = find_request(stream, id, &result);
    if (!tile) {
        give_back(stream, payload);
        return result;
    }
    gtx_tile_learn(stream, tile, cpu_bytes, gpu_bytes);
    gtx_tile_take(stream, tile, 0, 0);
    if (!gtx_stream_make_room(stream, cpu_bytes, gpu_bytes, 0)) {
        gtx_fail(&error, GTX_ERROR_LIMIT,
                 "the tile takes %" PRIu64 " and %" PRIu64 " bytes, and there is no room",
                 cpu_bytes, gpu_bytes);
        gtx_tile_fail(stream, tile, &error, false);
        give_back(stream, payload);
        return GTX_ERROR_LIMIT;
    }
    gtx_list_remove(stream, &stream->requested, tile);
    gtx_list_add(stream, &stream->resident, tile);
    gtx_tile_take(stream, tile, cpu_bytes, gpu_bytes);
    tile->state = gpu_bytes ? GTX_TILE_DELIVERED : GTX_TILE_READY;
    tile->request = 0;
    tile->tries = 0;
    tile->sent = 0;
    tile->payload = payload;
    ++stream->frame.delivered;
    return GTX_OK;
}

gtx_result gtx_stream_fail(gtx_stream *stream, uint64_t id, const gtx_error *error)
{
    gtx_result result;
    gtx_error none;
    if (!stream)
        return GTX_ERROR_ARGUMENT;
    gtx_tile *tile = find_request(stream, id, &result);
    if (!tile)
        return result;
    if (!error) {
        gtx_fail(&none, GTX_ERROR_READ, "the tile cannot be read");
        error = &none;
    }
    gtx_tile_fail(stream, tile, error, true);
    return GTX_OK;
}

gtx_result gtx_stream_ready(gtx_stream *stream, uint32_t number, uint64_t cpu_bytes)
{
    if (!stream || number >= stream->info.tiles)
        return GTX_ERROR_ARGUMENT;
    gtx_tile *tile = &stream->tiles[number];
    if (tile->state == GTX_TILE_READY && gtx_tile_rest(stream, tile))
        tile = gtx_tile_rest(stream, tile);
    if (tile->state != GTX_TILE_DELIVERED || cpu_bytes > tile->cpu)
        return GTX_ERROR_ARGUMENT;
    gtx_tile_take(stream, tile, cpu_bytes, tile->gpu);
    gtx_tile_learn(stream, tile, cpu_bytes, tile->gpu);
    tile->state = GTX_TILE_READY;
    return GTX_OK;
}

void gtx_stream_retry(gtx_stream *stream)
{
    for (uint32_t i = 0; stream && i < 2 * stream->info.tiles; ++i) {
        gtx_tile *tile = &stream->tiles[i];
        tile->retry = 0;
        tile->tries = 0;
        if (tile->state == GTX_TILE_GIVEN_UP)
            tile->state = GTX_TILE_ABSENT;
    }
    if (stream)
        stream->frame.given_up = 0;
}
