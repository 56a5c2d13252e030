/* The inside of a gtx_stream: tiles and what is known of them, and the room that they take.
 *
 * A tile whose file has a beginning is two nodes: the beginning, where the tree has the tile, and
 * below it the *rest*, which is the tile at its finest and has nothing below. So a beginning stays
 * as long as the rest is there, and as long as a child is. */
#ifndef GTX_STREAM_STREAM_H
#define GTX_STREAM_STREAM_H

#include "stream/frustum.h"
#include "stream/index.h"

enum { GTX_STREAM_MAX_VIEWS = 16, GTX_STREAM_MAX_REQUESTS = 1024 };

typedef enum gtx_tile_state {
    GTX_TILE_ABSENT,
    GTX_TILE_REQUESTED,
    GTX_TILE_DELIVERED,            /* delivered, not yet on the GPU */
    GTX_TILE_READY,           /* may be drawn; of a tile without content from the start */
    GTX_TILE_GIVEN_UP
} gtx_tile_state;

typedef struct gtx_tile {
    const gtx_index_tile *facts;
    gtx_index_part file;      /* what a request brings: first bytes of the file, or all */
    uint32_t first_child, child_count;
    gtx_tile_state state;
    uint32_t users;           /* children, and the rest, that are requested or resident: it is kept
                                 as long */
    uint32_t tries;
    bool known;               /* its cost is known, not estimated */
    bool leaving;             /* chosen to make room */
    uint64_t cpu, gpu;        /* taken of the budgets now */
    uint64_t cost_cpu, cost_gpu;
    uint64_t sent;            /* bytes of its upload so far */
    uint64_t request;         /* id, while requested */
    uint64_t asked, retry;    /* update of the request; earliest update of the next one */
    uint64_t in_view, wanted; /* last update with it in view; that needed it or a descendant */
    float pixels;             /* its error on screen, when last looked at; of a rest, that of the
                                 beginning */
    float value;              /* the error on screen that it removes, its parent's, when last
                                 wanted */
    void *payload;
    uint32_t place;           /* index in the list of its state */
} gtx_tile;

/* Indices of tiles or rests, each of which knows its place. */
typedef struct gtx_tile_list {
    uint32_t *tiles, count;
} gtx_tile_list;

struct gtx_stream {
    gtx_allocator allocator;
    gtx_stream_desc desc;     /* defaults filled in; no index */
    gtx_stream_info info;
    gtx_index_tile *facts;
    gtx_tile *tiles;          /* and behind them as many rests */
    uint64_t own_bytes;
    uint64_t update, serial;
    gtx_stream_frustum frusta[GTX_STREAM_MAX_VIEWS];
    uint32_t frustum_count;
    uint64_t cpu, gpu;        /* taken of the budgets */
    struct {
        uint64_t bytes, cpu, gpu;
    } known[2];               /* sums over tiles that are, over rests: files, and what they cost */
    gtx_tile_list requested, resident;
    uint32_t *stack, *wants, *leaving;
    uint32_t want_count;      /* tiles whose children are missing; rests that are */
    gtx_stream_request *requests;
    gtx_stream_upload *uploads;
    gtx_stream_draw *draws;
    gtx_stream_frame frame;
};

/* ---- budget.c ---- */

/* What a tile will take once it is resident: known, or estimated from others. */
void gtx_tile_cost(const gtx_stream *stream, const gtx_tile *tile, uint64_t *cpu, uint64_t *gpu);
void gtx_tile_learn(gtx_stream *stream, gtx_tile *tile, uint64_t cpu, uint64_t gpu);

/* Sets what a tile takes. */
void gtx_tile_take(gtx_stream *stream, gtx_tile *tile, uint64_t cpu, uint64_t gpu);

/* Makes room for so much more, for what removes an error of `value` pixels; a value of 0 drops
 * nothing that is in view. All or nothing. */
bool gtx_stream_make_room(gtx_stream *stream, uint64_t cpu, uint64_t gpu, float value);

/* ---- answers.c ---- */

/* Gives the payload back. */
void gtx_tile_drop(gtx_stream *stream, gtx_tile *tile);
void gtx_tile_ask(gtx_stream *stream, gtx_tile *tile);
/* Its request failed. `counts`: as one of its tries. */
void gtx_tile_fail(gtx_stream *stream, gtx_tile *tile, const gtx_error *error, bool counts);
void gtx_tile_uri(const gtx_tile *tile, char out[GTX_STREAM_URI]);

/* ---- requests.c ---- */

/* Requests what is wanted and missing, the most urgent first. */
void gtx_stream_ask(gtx_stream *stream);
/* By descending error on screen, that a tile has or, `by_value`, that it removes. */
void gtx_stream_sort(const gtx_stream *stream, uint32_t *tiles, uint32_t count, bool by_value);

/* ---- update.c ---- */

void gtx_list_add(gtx_stream *stream, gtx_tile_list *list, gtx_tile *tile);
void gtx_list_remove(gtx_stream *stream, gtx_tile_list *list, gtx_tile *tile);

/* Of a rest more than any tile's. */
static inline uint32_t gtx_tile_number(const gtx_stream *stream, const gtx_tile *tile)
{
    return (uint32_t)(tile - stream->tiles);
}

static inline bool gtx_tile_is_rest(const gtx_stream *stream, const gtx_tile *tile)
{
    return gtx_tile_number(stream, tile) >= stream->info.tiles;
}

/* NULL where the tile is one node. */
static inline gtx_tile *gtx_tile_rest(const gtx_stream *stream, gtx_tile *tile)
{
    return tile->facts->beginning.bytes ? tile + stream->info.tiles : NULL;
}

static inline gtx_tile *gtx_tile_parent(const gtx_stream *stream, gtx_tile *tile)
{
    return gtx_tile_is_rest(stream, tile) ? tile - stream->info.tiles
                                          : &stream->tiles[tile->facts->parent];
}

/* What the host knows it by. */
static inline uint32_t gtx_tile_index(const gtx_stream *stream, const gtx_tile *tile)
{
    return gtx_tile_number(stream, tile) % stream->info.tiles;
}

#endif
