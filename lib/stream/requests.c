/* The requests of a frame: the most urgent first, as far as the budgets allow. */
#include "stream/stream.h"

static void request(gtx_stream *s, gtx_tile *tile)
{
    const gtx_index_tile *facts = tile->facts;
    const gtx_tile *beginning = gtx_tile_is_rest(s, tile) ? gtx_tile_parent(s, tile) : NULL;
    gtx_stream_request *out = &s->requests[s->frame.request_count++];
    gtx_tile_ask(s, tile);
    *out = (gtx_stream_request){.id = tile->request, .tile = gtx_tile_index(s, tile),
                                .pixels = tile->value, .bytes = tile->file.bytes,
                                .file_bytes = facts->whole.bytes, .memory = tile->file.memory,
                                .hash = tile->file.hash};
    if (beginning) {
        out->from = beginning->file.bytes;
        out->beginning = beginning->payload;
    }
    gtx_tile_uri(tile, out->uri);
    for (int k = 0; k < 3; ++k) {
        out->low[k] = facts->low[k];
        out->high[k] = facts->high[k];
    }
}

static bool is_missing(const gtx_stream *s, const gtx_tile *tile)
{
    return tile->in_view == s->update && tile->state == GTX_TILE_ABSENT;
}

static uint64_t opening(const gtx_tile *tile)
{
    return tile->file.bytes + tile->file.memory;
}

/* Tiles that together replace a resident one. */
typedef struct group {
    gtx_tile *first;
    uint32_t count;
    const gtx_tile *stands;
    float pixels;             /* the error on screen that they remove */
} group;

/* The children of a tile, or a rest. */
static group group_of(const gtx_stream *s, gtx_tile *wanted)
{
    if (gtx_tile_is_rest(s, wanted))
        return (group){wanted, 1, gtx_tile_parent(s, wanted), wanted->pixels};
    return (group){&s->tiles[wanted->first_child], wanted->child_count, wanted, wanted->pixels};
}

/* The cost of groups that have room already, but wait for a free request. */
typedef struct plan {
    uint64_t cpu, gpu;
} plan;

/* Requests the missing tiles of a group, all or none: only a whole group can be drawn. False when
 * there is no room. */
static bool ask_for_group(gtx_stream *s, const group *g, plan *planned)
{
    uint64_t cpu, gpu, most = 0;
    plan need = *planned;
    for (gtx_tile *tile = g->first; tile < g->first + g->count; ++tile)
        if (is_missing(s, tile)) {
            gtx_tile_cost(s, tile, &cpu, &gpu);
            need.cpu += cpu;
            need.gpu += gpu;
            most = opening(tile) > most ? opening(tile) : most;
        }
    if (!gtx_stream_make_room(s, need.cpu + most, need.gpu, g->pixels))
        return false;
    *planned = need;
    for (gtx_tile *tile = g->first; tile < g->first + g->count; ++tile) {
        if (!is_missing(s, tile) || tile->retry > s->update ||
            s->requested.count == s->desc.max_requests ||
            opening(tile) > s->desc.cpu_bytes - s->cpu)
            continue;
        gtx_tile_cost(s, tile, &cpu, &gpu);
        planned->cpu -= cpu;
        planned->gpu -= gpu;
        request(s, tile);
    }
    return true;
}

/* Coarse tiles come first in the index. */
static int compare(const gtx_tile *a, float a_pixels, const gtx_tile *b, float b_pixels)
{
    return a_pixels != b_pixels ? (a_pixels > b_pixels ? -1 : 1) : a < b ? -1 : a > b;
}

/* Heap sort, which needs no memory and no state beside its arguments. */
void gtx_stream_sort(const gtx_stream *s, uint32_t *tiles, uint32_t count, bool by_value)
{
    for (uint32_t n = count, root = count / 2; n > 1;) {
        uint32_t moved;
        if (root > 0) {
            moved = tiles[--root];
        } else {
            moved = tiles[--n];
            tiles[n] = tiles[0];
        }
        uint32_t at = root;
        for (uint32_t child; (child = 2 * at + 1) < n; at = child) {
            const gtx_tile *t = s->tiles;
#define KEY(i) &t[i], by_value ? t[i].value : t[i].pixels
            if (child + 1 < n && compare(KEY(tiles[child]), KEY(tiles[child + 1])) < 0)
                ++child;
            if (compare(KEY(moved), KEY(tiles[child])) >= 0)
                break;
#undef KEY
            tiles[at] = tiles[child];
        }
        tiles[at] = moved;
    }
}

/* The tiles of an incomplete group without room are not uploaded and may be dropped. */
static void give_way(gtx_stream *s, const group *g)
{
    for (gtx_tile *tile = g->first; tile < g->first + g->count; ++tile) {
        if (tile->in_view != s->update)
            continue;
        tile->wanted = s->update - 1;
        s->frame.without_room +=
            tile->state == GTX_TILE_ABSENT || tile->state == GTX_TILE_DELIVERED;
    }
}

static void ask_for_root(gtx_stream *s)
{
    gtx_tile *root = s->tiles;
    uint64_t cpu, gpu;
    if (root->state != GTX_TILE_ABSENT)
        return;
    gtx_tile_cost(s, root, &cpu, &gpu);
    if (!gtx_stream_make_room(s, opening(root), gpu, 0))
        s->frame.without_room = 1;
    else if (root->retry <= s->update)
        request(s, root);
}

void gtx_stream_ask(gtx_stream *s)
{
    enum { MAX_REFUSALS = 4 };    /* each takes time for all resident tiles */
    uint32_t refusals = 0;
    plan planned = {0, 0};
    s->frame.without_room = 0;
    ask_for_root(s);
    gtx_stream_sort(s, s->wants, s->want_count, false);
    for (uint32_t i = 0; i < s->want_count; ++i) {
        const group g = group_of(s, &s->tiles[s->wants[i]]);
        if (g.stands->state != GTX_TILE_READY) /* it has left for something better */
            continue;
        if (refusals < MAX_REFUSALS && ask_for_group(s, &g, &planned))
            continue;
        ++refusals;
        give_way(s, &g);
    }
}
