/* A frame: which tiles are in view and wanted, which to upload and to draw. */
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

/* Whether any view sees the tile's box; sets its error on screen, and that of its beginning. */
static bool look_at(const gtx_stream *s, gtx_tile *tile)
{
    const gtx_index_tile *facts = tile->facts;
    gtx_tile *rest = gtx_tile_rest(s, tile);
    double most = -1, beginning = -1;
    for (uint32_t i = 0; i < s->frustum_count; ++i) {
        const gtx_stream_frustum *frustum = &s->frusta[i];
        if (!gtx_stream_frustum_sees(frustum, facts->low, facts->high))
            continue;
        most = fmax(most, gtx_stream_frustum_pixels(frustum, facts->low, facts->high,
                                                    (double)facts->error));
        if (rest)
            beginning = fmax(beginning, gtx_stream_frustum_pixels(frustum, facts->low, facts->high,
                                                       (double)facts->beginning_error));
    }
    tile->pixels = (float)most;
    if (rest)
        rest->pixels = (float)beginning;
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
        count.coming += child->state == GTX_TILE_REQUESTED || child->state == GTX_TILE_DELIVERED;
        count.given_up += child->state == GTX_TILE_GIVEN_UP;
    }
    return count;
}

/* A tile that is not refined needs its rest, if its beginning is not fine enough. */
static void want_rest(gtx_stream *s, gtx_tile *tile)
{
    gtx_tile *rest = gtx_tile_rest(s, tile);
    if (!rest || rest->state == GTX_TILE_GIVEN_UP || !(rest->pixels > s->desc.max_error))
        return;
    rest->in_view = rest->wanted = s->update;
    rest->value = rest->pixels;
    s->frame.pending += rest->state != GTX_TILE_READY;
    if (rest->state == GTX_TILE_ABSENT)
        s->wants[s->want_count++] = gtx_tile_number(s, rest);
}

/* Whether children should take a tile's place; they have been looked at. */
static bool is_refined(const gtx_stream *s, const gtx_tile *tile, below *children)
{
    *children = (below){0};
    if (!tile->child_count || !(tile->pixels > s->desc.max_error))
        return false;
    *children = count_children(s, tile);
    return !children->given_up; /* the others alone could not replace it */
}

/* Visits a tile that is ready and in view: finds what should replace it, if anything. */
static void visit(gtx_stream *s, gtx_tile *tile, uint32_t *depth)
{
    below children;
    tile->wanted = s->update;
    for (uint32_t k = 0; k < tile->child_count && tile->pixels > s->desc.max_error; ++k)
        look_at(s, &s->tiles[tile->first_child + k]);
    if (!is_refined(s, tile, &children)) {
        want_rest(s, tile);
        return;
    }
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

static void time_out(gtx_stream *s)
{
    gtx_error error;
    gtx_fail(&error, GTX_ERROR_READ, "the request was not answered in time");
    for (uint32_t i = s->requested.count; i-- > 0;) {
        gtx_tile *tile = &s->tiles[s->requested.tiles[i]];
        if (s->update - tile->asked >= s->desc.patience_updates)
            gtx_tile_fail(s, tile, &error, true);
    }
}

/* ---- uploads and draws ---- */

static void upload(gtx_stream *s)
{
    uint32_t count = 0;
    uint64_t left = s->desc.upload_bytes;
    for (uint32_t i = 0; i < s->resident.count; ++i) {
        const gtx_tile *tile = &s->tiles[s->resident.tiles[i]];
        if (tile->state == GTX_TILE_DELIVERED && tile->wanted == s->update)
            s->stack[count++] = s->resident.tiles[i];
    }
    gtx_stream_sort(s, s->stack, count, true);
    for (uint32_t i = 0; i < count && left > 0; ++i) {
        gtx_tile *tile = &s->tiles[s->stack[i]];
        const uint64_t rest = tile->sent < tile->gpu ? tile->gpu - tile->sent : 1;
        const uint64_t bytes = rest < left ? rest : left;
        tile->sent += bytes;
        left -= bytes;
        s->uploads[s->frame.upload_count++] =
            (gtx_stream_upload){gtx_tile_index(s, tile), tile->payload, bytes};
    }
}

static void draw(gtx_stream *s)
{
    uint32_t depth = 0;
    if (s->tiles->state == GTX_TILE_READY && s->tiles->in_view == s->update)
        s->stack[depth++] = 0;
    while (depth > 0) {
        const uint32_t number = s->stack[--depth];
        gtx_tile *tile = &s->tiles[number], *rest = gtx_tile_rest(s, tile);
        below children;
        if (is_refined(s, tile, &children) && !children.missing && !children.coming) {
            for (uint32_t k = tile->child_count; k-- > 0;)
                if (s->tiles[tile->first_child + k].in_view == s->update)
                    s->stack[depth++] = tile->first_child + k;
            continue;
        }
        const gtx_tile *shown = rest && rest->state == GTX_TILE_READY ? rest : tile;
        if (shown == rest)
            rest->wanted = s->update; /* as long as it is in the list */
        if (shown->payload)
            s->draws[s->frame.draw_count++] = (gtx_stream_draw){
                number, rest && shown == tile ? rest->pixels : tile->pixels, shown->payload};
    }
}

gtx_result gtx_stream_update(gtx_stream *s, const gtx_stream_view *views, uint32_t count,
                             gtx_stream_frame *frame, gtx_error *error)
{
    gtx_stream_frustum frusta[GTX_STREAM_MAX_VIEWS];
    if (!s || !frame || (!views && count) || count > GTX_STREAM_MAX_VIEWS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "an update needs a stream, a frame, and up to %d views",
                        GTX_STREAM_MAX_VIEWS);
    for (uint32_t i = 0; i < count; ++i) {
        gtx_result result = gtx_stream_frustum_of(&views[i], &frusta[i], error);
        if (result)
            return result;
    }
    for (uint32_t i = 0; i < count; ++i)
        s->frusta[i] = frusta[i];
    s->frustum_count = count;
    ++s->update;
    s->frame.request_count = s->frame.upload_count = s->frame.draw_count = 0;
    time_out(s);
    visit_all(s);
    gtx_stream_ask(s);
    upload(s);
    draw(s);
    s->frame.requests = s->requests;
    s->frame.uploads = s->uploads;
    s->frame.draws = s->draws;
    s->frame.resident = s->resident.count;
    s->frame.under_way = s->requested.count;
    s->frame.cpu_bytes = s->cpu;
    s->frame.gpu_bytes = s->gpu;
    *frame = s->frame;
    return GTX_OK;
}
