/* What becomes of requests: payloads, failures, uploads; and opening what was read. */
#include "stream/stream.h"

#include "asset/section.h"
#include "base/error.h"
#include "base/hash.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { TILE_BITS = 20, MAX_DOUBLINGS = 16 };

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
    gtx_list_remove(stream, &stream->there, tile);
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
    gtx_tile_take(stream, tile, tile->facts->bytes + tile->facts->memory, gpu);
    gtx_list_add(stream, &stream->asked, tile);
    tile->state = GTX_TILE_ASKED;
    tile->request = ++stream->serial << TILE_BITS | gtx_tile_number(stream, tile);
    tile->asked = stream->update;
    if (tile != stream->tiles)
        ++gtx_tile_parent(stream, tile)->users;
    ++stream->frame.requested;
}

/* The request is over: its tile takes nothing. */
static void end_request(gtx_stream *stream, gtx_tile *tile)
{
    gtx_list_remove(stream, &stream->asked, tile);
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
    const gtx_stream_report report = {gtx_tile_number(stream, tile), uri, error,
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
    if (number >= stream->info.tiles || serial == 0 || serial > stream->serial)
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
    gtx_list_remove(stream, &stream->asked, tile);
    gtx_list_add(stream, &stream->there, tile);
    gtx_tile_take(stream, tile, cpu_bytes, gpu_bytes);
    tile->state = gpu_bytes ? GTX_TILE_HELD : GTX_TILE_READY;
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
    if (tile->state != GTX_TILE_HELD || cpu_bytes > tile->cpu)
        return GTX_ERROR_ARGUMENT;
    gtx_tile_take(stream, tile, cpu_bytes, tile->gpu);
    gtx_tile_learn(stream, tile, cpu_bytes, tile->gpu);
    tile->state = GTX_TILE_READY;
    return GTX_OK;
}

void gtx_stream_retry(gtx_stream *stream)
{
    for (uint32_t i = 0; stream && i < stream->info.tiles; ++i) {
        gtx_tile *tile = &stream->tiles[i];
        tile->retry = 0;
        tile->tries = 0;
        if (tile->state == GTX_TILE_GIVEN_UP)
            tile->state = GTX_TILE_ABSENT;
    }
    if (stream)
        stream->frame.given_up = 0;
}

/* ---- opening ---- */

static bool is_in_box(const gtx_stream_request *request, const gtx_info *info)
{
    for (int k = 0; k < 3; ++k)
        if (!(info->anchor[k] + (double)info->bounds_min[k] >= request->low[k] &&
              info->anchor[k] + (double)info->bounds_max[k] <= request->high[k]))
            return false;
    return true;
}

static uint64_t held_by(const gtx_asset *asset)
{
    gtx_sizes sizes = {.meta = asset->meta_size};
    for (uint32_t k = 0; k < GTX_MAX_LODS; ++k)
        sizes.lod[k] = asset->lod_size[k];
    return gtx_asset_bytes(&asset->info, &sizes);
}

gtx_result gtx_stream_open(const gtx_stream_request *request, const void *data, size_t size,
                           const gtx_open_desc *desc, gtx_asset **out, uint64_t *held,
                           gtx_error *error)
{
    if (out)
        *out = NULL;
    if (!request || !out || (!data && size))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "opening a tile needs its request, bytes, and a place for the asset");
    if (size < request->bytes)
        return gtx_fail(error, GTX_ERROR_TRUNCATED, "the tile ends after %zu of %" PRIu64
                        " bytes", size, request->bytes);
    if (size > request->bytes || gtx_hash_bytes(data, size) != request->hash)
        return gtx_fail(error, GTX_ERROR_CORRUPT, "the bytes are not those of the tile");
    gtx_open_desc open = desc ? *desc : (gtx_open_desc){0};
    if (!open.limits.memory || open.limits.memory > request->memory)
        open.limits.memory = request->memory ? request->memory : 1;
    gtx_result result = gtx_open_memory(data, size, &open, out, error);
    if (result)
        return result;
    gtx_info info;
    gtx_get_info(*out, &info);
    if (!is_in_box(request, &info)) {
        gtx_close(*out);
        *out = NULL;
        return gtx_fail(error, GTX_ERROR_CORRUPT, "the tile is not within its box");
    }
    if (held)
        *held = held_by(*out);
    return GTX_OK;
}
