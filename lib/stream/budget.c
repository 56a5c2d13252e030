/* Budgets: what tiles take of them, and which are dropped to make room. */
#include "stream/stream.h"

#include <math.h>

/* A tile in view is dropped only for one that removes an error so many times larger. With 1, two
 * tiles of equal value would replace each other forever; the larger, the longer the picture stays
 * uneven where the budgets are too small. */
static const float WORTH = 2;

void gtx_tile_cost(const gtx_stream *stream, const gtx_tile *tile, uint64_t *cpu, uint64_t *gpu)
{
    *cpu = tile->cost_cpu;
    *gpu = tile->cost_gpu;
    if (tile->known)
        return;
    const bool rest = gtx_tile_is_rest(stream, tile);
    const uint64_t bytes = stream->known[rest].bytes;
    const double share = bytes ? (double)tile->file.bytes / (double)bytes : 0;
    *cpu = bytes ? (uint64_t)(share * (double)stream->known[rest].cpu) : tile->file.memory;
    *gpu = (uint64_t)(share * (double)stream->known[rest].gpu);
}

void gtx_tile_learn(gtx_stream *stream, gtx_tile *tile, uint64_t cpu, uint64_t gpu)
{
    const bool rest = gtx_tile_is_rest(stream, tile);
    if (tile->known) {
        stream->known[rest].bytes -= tile->file.bytes;
        stream->known[rest].cpu -= tile->cost_cpu;
        stream->known[rest].gpu -= tile->cost_gpu;
    }
    tile->known = true;
    tile->cost_cpu = cpu;
    tile->cost_gpu = gpu;
    stream->known[rest].bytes += tile->file.bytes;
    stream->known[rest].cpu += cpu;
    stream->known[rest].gpu += gpu;
}

void gtx_tile_take(gtx_stream *stream, gtx_tile *tile, uint64_t cpu, uint64_t gpu)
{
    stream->cpu = stream->cpu - tile->cpu + cpu;
    stream->gpu = stream->gpu - tile->gpu + gpu;
    tile->cpu = cpu;
    tile->gpu = gpu;
}

static bool fits(uint64_t taken, uint64_t freed, uint64_t more, uint64_t budget)
{
    const uint64_t left = taken - freed;
    return left <= budget && more <= budget - left;
}

static bool may_leave(const gtx_stream *stream, const gtx_tile *tile, float value)
{
    if (tile->leaving || tile->users) /* its descendants would be unreachable */
        return false;
    return tile->wanted < stream->update || WORTH * tile->value < value;
}

static bool leaves_before(const gtx_tile *a, const gtx_tile *b)
{
    if (a->wanted != b->wanted)
        return a->wanted < b->wanted;
    return a->value != b->value ? a->value < b->value : a > b;
}

static gtx_tile *next_to_leave(const gtx_stream *stream, float value)
{
    gtx_tile *best = NULL;
    for (uint32_t i = 0; i < stream->resident.count; ++i) {
        gtx_tile *tile = &stream->tiles[stream->resident.tiles[i]];
        if (may_leave(stream, tile, value) && (!best || leaves_before(tile, best)))
            best = tile;
    }
    return best;
}

bool gtx_stream_make_room(gtx_stream *stream, uint64_t cpu, uint64_t gpu, float value)
{
    const gtx_stream_desc *desc = &stream->desc;
    uint64_t freed_cpu = 0, freed_gpu = 0;
    uint32_t count = 0;
    bool enough = true;
    while (!fits(stream->cpu, freed_cpu, cpu, desc->cpu_bytes) ||
           !fits(stream->gpu, freed_gpu, gpu, desc->gpu_bytes)) {
        gtx_tile *tile = next_to_leave(stream, value);
        enough = tile != NULL;
        if (!enough)
            break;
        tile->leaving = true;
        --gtx_tile_parent(stream, tile)->users;
        freed_cpu += tile->cpu;
        freed_gpu += tile->gpu;
        stream->leaving[count++] = gtx_tile_number(stream, tile);
    }
    for (uint32_t i = 0; i < count; ++i) {
        gtx_tile *tile = &stream->tiles[stream->leaving[i]];
        tile->leaving = false;
        ++gtx_tile_parent(stream, tile)->users;
    }
    for (uint32_t i = 0; i < count && enough; ++i)
        gtx_tile_drop(stream, &stream->tiles[stream->leaving[i]]);
    return enough;
}
