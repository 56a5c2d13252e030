/* A frame: what is in view and what is wanted of it; what to ask for, to upload, to draw. */
#include "stream/stream.h"

#include "base/error.h"

#include <math.h>
#include <stdbool.h>

void gtx_list_add(gtx_stream *stream, gtx_tile_list *list, gtx_tile *tile)
{
    tile->place = list->count;
    list->tiles[list->count++] = gtx_tile_number(stream, tile);
}

void gtx_list_remove(gtx_stream *stream, gtx_tile_list *list, gtx_tile *tile)
{
    const uint32_t last = list->tiles[--list->count];
    list->tiles[tile->place] = last;
    stream->tiles[last].place = tile->place;
}

/* ---- what is in view ---- */

/* Whether any eye sees the tile's box; sets its error on screen. */
static bool look_at(const gtx_stream *s, gtx_tile *tile)
{
    const gtx_index_tile *facts = tile->facts;
    double most = -1;
    for (uint32_t i = 0; i < s->eye_count; ++i)
        if (gtx_eye_sees(&s->eyes[i], facts->low, facts->high))
            most = fmax(most, gtx_eye_pixels(&s->eyes[i], facts->low, facts->high,
                                             (double)facts->error));
    tile->pixels = (float)most;
    if (most >= 0)
        tile->in_view = s->update;
    return most >= 0;
}

typedef struct below {
    uint32_t ready, missing, coming, given_up; /* children in view, by their state */
} below;

static below count_children(const gtx_stream *s, const gtx_tile *tile)
{
    below count = {0};
    for (uint32_t k = 0; k < tile->child_count; ++k) {
        const gtx_tile *child = &s->tiles[tile->first_child + k];
        if (child->in_view != s->update)
            continue;
        count.ready += child->state == GTX_TILE_READY;
        count.missing += child->state == GTX_TILE_ABSENT;
        count.coming += child->state == GTX_TILE_ASKED || child->state == GTX_TILE_HELD;
        count.given_up += child->state == GTX_TILE_GIVEN_UP;
    }
    return count;
}

/* A tile that is ready and in view: what should take its place, if anything. */
static void visit(gtx_stream *s, gtx_tile *tile, uint32_t *depth)
{
    tile->wanted = s->update;
    if (!(tile->pixels > s->desc.max_error))
        return;
    for (uint32_t k = 0; k < tile->child_count; ++k)
        look_at(s, &s->tiles[tile->first_child + k]);
    const below children = count_children(s, tile);
    if (children.given_up) /* it stands, and the others would be in vain */
        return;
    for (uint32_t k = 0; k < tile->child_count; ++k) {
        gtx_tile *child = &s->tiles[tile->first_child + k];
        if (child->in_view != s->update)
            continue;
        child->wanted = s->update;
        child->value = tile->pixels;
        if (!children.missing && !children.coming)
            s->stack[(*depth)++] = tile->first_child + k;
    }
    s->frame.pending += children.missing + children.coming;
    if (children.missing)
        s->wants[s->want_count++] = gtx_tile_number(s, tile);
}

static void visit_all(gtx_stream *s)
{
    uint32_t depth = 0;
    s->frame.pending = s->want_count = 0;
    s->tiles->wanted = s->update;
    s->tiles->value = INFINITY;
    if (s->tiles->state != GTX_TILE_READY) {
        s->frame.pending = s->tiles->state != GTX_TILE_GIVEN_UP;
        return;
    }
    if (look_at(s, s->tiles))
        s->stack[depth++] = 0;
    while (depth > 0)
        visit(s, &s->tiles[s->stack[--depth]], &depth);
}

/* ---- requests ---- */

static void request(gtx_stream *s, gtx_tile *tile)
{
    const gtx_index_tile *facts = tile->facts;
    gtx_stream_request *out = &s->requests[s->frame.request_count++];
    gtx_tile_ask(s, tile);
    *out = (gtx_stream_request){.id = tile->request, .tile = gtx_tile_number(s, tile),
                                .pixels = tile->value, .bytes = facts->bytes,
                                .memory = facts->memory, .hash = facts->hash};
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

/* What is planned already, but waits for a free request. */
typedef struct plan {
    uint64_t cpu, gpu;
} plan;

/* Asks for the children of a tile that are missing, all or none: some alone would show nothing.
 * False when there is no room. */
static bool ask_for_children(gtx_stream *s, gtx_tile *tile, plan *planned)
{
    gtx_tile *children = &s->tiles[tile->first_child];
    uint64_t cpu, gpu, most = 0;
    plan need = *planned;
    for (uint32_t k = 0; k < tile->child_count; ++k)
        if (is_missing(s, &children[k])) {
            const uint64_t opening = children[k].facts->bytes + children[k].facts->memory;
            gtx_tile_cost(s, &children[k], &cpu, &gpu);
            need.cpu += cpu;
            need.gpu += gpu;
            most = opening > most ? opening : most;
        }
    if (!gtx_stream_make_room(s, need.cpu + most, need.gpu, tile->pixels))
        return false;
    *planned = need;
    for (uint32_t k = 0; k < tile->child_count; ++k) {
        gtx_tile *child = &children[k];
        const uint64_t opening = child->facts->bytes + child->facts->memory;
        if (!is_missing(s, child) || child->retry > s->update ||
            s->asked.count == s->desc.max_requests || opening > s->desc.cpu_bytes - s->cpu)
            continue;
        gtx_tile_cost(s, child, &cpu, &gpu);
        planned->cpu -= cpu;
        planned->gpu -= gpu;
        request(s, child);
    }
    return true;
}

/* The larger the error that they mend the sooner; coarse tiles come first in the index. */
static int compare(const gtx_tile *a, float a_pixels, const gtx_tile *b, float b_pixels)
{
    return a_pixels != b_pixels ? (a_pixels > b_pixels ? -1 : 1) : a < b ? -1 : a > b;
}

/* Heap sort, which needs no memory and no state beside its arguments. */
static void sort(const gtx_stream *s, uint32_t *tiles, uint32_t count, bool by_value)
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

/* What of an incomplete group is there shows nothing, is not uploaded, and may leave. */
static void give_way(gtx_stream *s, const gtx_tile *parent)
{
    for (uint32_t k = 0; k < parent->child_count; ++k) {
        gtx_tile *child = &s->tiles[parent->first_child + k];
        if (child->in_view != s->update)
            continue;
        child->wanted = s->update - 1;
        s->frame.without_room +=
            child->state == GTX_TILE_ABSENT || child->state == GTX_TILE_HELD;
    }
}

static void ask_for_root(gtx_stream *s)
{
    gtx_tile *root = s->tiles;
    uint64_t cpu, gpu;
    if (root->state != GTX_TILE_ABSENT)
        return;
    gtx_tile_cost(s, root, &cpu, &gpu);
    if (!gtx_stream_make_room(s, root->facts->bytes + root->facts->memory, gpu, 0))
        s->frame.without_room = 1;
    else if (root->retry <= s->update)
        request(s, root);
}

static void ask(gtx_stream *s)
{
    enum { MAX_REFUSALS = 4 };    /* each looks through all that is there */
    uint32_t refusals = 0;
    plan planned = {0, 0};
    s->frame.without_room = 0;
    ask_for_root(s);
    sort(s, s->wants, s->want_count, false);
    for (uint32_t i = 0; i < s->want_count; ++i) {
        gtx_tile *tile = &s->tiles[s->wants[i]];
        if (tile->state != GTX_TILE_READY) /* it has left for something better */
            continue;
        if (refusals < MAX_REFUSALS && ask_for_children(s, tile, &planned))
            continue;
        ++refusals;
        give_way(s, tile);
    }
}

static void time_out(gtx_stream *s)
{
    gtx_error error;
    gtx_fail(&error, GTX_ERROR_READ, "the request was not answered in time");
    for (uint32_t i = s->asked.count; i-- > 0;) {
        gtx_tile *tile = &s->tiles[s->asked.tiles[i]];
        if (s->update - tile->asked >= s->desc.patience_updates)
            gtx_tile_fail(s, tile, &error, true);
    }
}

/* ---- uploads and draws ---- */

static void upload(gtx_stream *s)
{
    uint32_t count = 0;
    uint64_t left = s->desc.upload_bytes;
    for (uint32_t i = 0; i < s->there.count; ++i) {
        const gtx_tile *tile = &s->tiles[s->there.tiles[i]];
        if (tile->state == GTX_TILE_HELD && tile->wanted == s->update)
            s->stack[count++] = s->there.tiles[i];
    }
    sort(s, s->stack, count, true);
    for (uint32_t i = 0; i < count && left > 0; ++i) {
        gtx_tile *tile = &s->tiles[s->stack[i]];
        const uint64_t rest = tile->sent < tile->gpu ? tile->gpu - tile->sent : 1;
        const uint64_t bytes = rest < left ? rest : left;
        tile->sent += bytes;
        left -= bytes;
        s->uploads[s->frame.upload_count++] =
            (gtx_stream_upload){s->stack[i], tile->payload, bytes};
    }
}

static void draw(gtx_stream *s)
{
    uint32_t depth = 0;
    if (s->tiles->state == GTX_TILE_READY && s->tiles->in_view == s->update)
        s->stack[depth++] = 0;
    while (depth > 0) {
        const uint32_t number = s->stack[--depth];
        const gtx_tile *tile = &s->tiles[number];
        if (tile->pixels > s->desc.max_error && tile->child_count) {
            const below children = count_children(s, tile);
            if (!children.missing && !children.coming && !children.given_up) {
                for (uint32_t k = tile->child_count; k-- > 0;)
                    if (s->tiles[tile->first_child + k].in_view == s->update)
                        s->stack[depth++] = tile->first_child + k;
                continue;
            }
        }
        if (tile->payload)
            s->draws[s->frame.draw_count++] =
                (gtx_stream_draw){number, tile->pixels, tile->payload};
    }
}

gtx_result gtx_stream_update(gtx_stream *s, const gtx_stream_view *views, uint32_t count,
                             gtx_stream_frame *frame, gtx_error *error)
{
    gtx_eye eyes[GTX_STREAM_MAX_VIEWS];
    if (!s || !frame || (!views && count) || count > GTX_STREAM_MAX_VIEWS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an update needs a stream, a frame, and up to %d views",
                        GTX_STREAM_MAX_VIEWS);
    for (uint32_t i = 0; i < count; ++i) {
        gtx_result result = gtx_eye_of(&views[i], &eyes[i], error);
        if (result)
            return result;
    }
    for (uint32_t i = 0; i < count; ++i)
        s->eyes[i] = eyes[i];
    s->eye_count = count;
    ++s->update;
    s->frame.request_count = s->frame.upload_count = s->frame.draw_count = 0;
    time_out(s);
    visit_all(s);
    ask(s);
    upload(s);
    draw(s);
    s->frame.requests = s->requests;
    s->frame.uploads = s->uploads;
    s->frame.draws = s->draws;
    s->frame.resident = s->there.count;
    s->frame.under_way = s->asked.count;
    s->frame.cpu_bytes = s->cpu;
    s->frame.gpu_bytes = s->gpu;
    *frame = s->frame;
    return GTX_OK;
}
