/* Packs the rectangles of patches into pages, on shelves, tallest first. The cooker packs a tenth
 * tighter, but takes longer than an edit may. */
#include "edit/edit.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <stdlib.h>

static const uint32_t MAX_SIDE = 4096, MIN_SIDE = 8;
/* Of a square page, as a multiple of the rectangles' area: shelves leave some of it empty. */
static const double ROOM = 1.05;

typedef struct item {
    uint32_t patch, width, height;
} item;

static int by_height(const void *a, const void *b)
{
    const item *p = a, *q = b;
    if (p->height != q->height)
        return p->height > q->height ? -1 : 1;
    if (p->width != q->width)
        return p->width > q->width ? -1 : 1;
    return p->patch < q->patch ? -1 : p->patch > q->patch;
}

typedef struct shelf {
    uint32_t page, y, height, used;
} shelf;

/* The first shelf with room, or a new one below the last. */
static shelf *find_shelf(shelf *shelves, uint32_t *count, const item *i, uint32_t page_width,
                         uint32_t most)
{
    for (uint32_t s = 0; s < *count; ++s)
        if (shelves[s].used + i->width <= page_width && shelves[s].height >= i->height)
            return &shelves[s];
    shelf *added = &shelves[*count];
    *added = (shelf){.height = i->height};
    if (*count) {
        const shelf *last = added - 1;
        const bool fits = last->y + last->height + i->height <= most;
        added->page = fits ? last->page : last->page + 1;
        added->y = fits ? last->y + last->height : 0;
    }
    ++*count;
    return added;
}

gtx_result gtx_edit_place(gtx_patch *patches, const gtx_allocator *hooks, gtx_info *info,
                          gtx_error *error)
{
    const uint32_t n = info->patch_count, grain = 1u << (info->mip_count - 1);
    item *items = gtx_alloc_array(hooks, n, sizeof *items);
    shelf *shelves = gtx_alloc_array(hooks, n, sizeof *shelves);
    gtx_result result = GTX_OK;
    if (!items || !shelves)
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory to lay out %u patches", n);
    double area = 0;
    uint32_t widest = MIN_SIDE, most = MAX_SIDE, count = 0;
    for (uint32_t p = 0; !result && p < n; ++p) {
        items[p] = (item){p, patches[p].rect[2], patches[p].rect[3]};
        area += (double)items[p].width * items[p].height;
        widest = items[p].width > widest ? items[p].width : widest;
        most = items[p].height > most ? items[p].height : most;
    }
    if (!result) {
        qsort(items, n, sizeof *items, by_height);
        uint32_t width = (uint32_t)fmin(sqrt(area * ROOM), MAX_SIDE);
        width = width > widest ? width : widest;
        width = (width + grain - 1) / grain * grain;
        uint32_t used = MIN_SIDE > grain ? MIN_SIDE : grain, pages = 1;
        for (uint32_t k = 0; k < n; ++k) {
            shelf *s = find_shelf(shelves, &count, &items[k], width, most);
            gtx_patch *p = &patches[items[k].patch];
            p->page = s->page;
            p->rect[0] = (uint16_t)s->used;
            p->rect[1] = (uint16_t)s->y;
            s->used += items[k].width;
            used = s->y + s->height > used ? s->y + s->height : used;
            pages = s->page + 1 > pages ? s->page + 1 : pages;
        }
        if (pages > GTX_MAX_PAGES)
            result = gtx_fail(error, GTX_ERROR_LIMIT, "the patches take %u pages", pages);
        info->page_count = pages;
        info->page_width = width;
        info->page_height = (used + grain - 1) / grain * grain;
    }
    gtx_free_array(hooks, items, n, sizeof *items);
    gtx_free_array(hooks, shelves, n, sizeof *shelves);
    return result;
}
