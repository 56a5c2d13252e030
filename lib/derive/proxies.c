/* Proxies: closed hulls around the solid cells of every patch, to be rasterised. */
#include "derive/derive.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>

enum { BOX_VERTICES = 8, BOX_INDICES = 36 };

/* Texels and codes of the solid cells of a patch, both ends included; none when max[0] is 0. */
typedef struct extent {
    uint32_t min[3], max[3];
} extent;

static void include(extent *e, uint32_t x, uint32_t y, uint32_t code)
{
    const uint32_t p[3] = {x, y, code};
    for (int a = 0; a < 3; ++a) {
        e->min[a] = p[a] < e->min[a] ? p[a] : e->min[a];
        e->max[a] = p[a] > e->max[a] ? p[a] : e->max[a];
    }
}

static extent solid_extent(const gtx_asset *asset, const gtx_patch *patch)
{
    extent e = {{UINT32_MAX, UINT32_MAX, UINT32_MAX}, {0, 0, 0}};
    for (uint32_t y = 0; y + 1 < patch->rect[3]; ++y)
        for (uint32_t x = 0; x + 1 < patch->rect[2]; ++x) {
            uint32_t corner[4];
            for (uint32_t k = 0; k < 4; ++k)
                corner[k] = gtx_height_code(asset, patch, x + (k & 1), y + (k >> 1));
            if (corner[0] && corner[1] && corner[2] && corner[3])
                for (uint32_t k = 0; k < 4; ++k)
                    include(&e, x + (k & 1), y + (k >> 1), corner[k]);
        }
    /* Coarse nodes take the codes of texels, with a cell or not, or their means. */
    for (uint32_t y = 0; e.max[0] && y < patch->rect[3]; ++y)
        for (uint32_t x = 0; x < patch->rect[2]; ++x) {
            const uint32_t code = gtx_height_code(asset, patch, x, y);
            if (code && code < e.min[2])
                e.min[2] = code;
            if (code > e.max[2])
                e.max[2] = code;
        }
    return e;
}

/* Appends the box: vertex k takes the far side along axis a where bit a of k is set; triangles are
 * counter-clockwise seen from outside. */
static void append_box(gtx_proxies *out, uint32_t patch, const extent *e, float grow)
{
    static const uint8_t corner[BOX_INDICES] = {
        0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, /* x- x+ */
        0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, /* y- y+ */
        0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6  /* z- z+ */
    };
    for (uint32_t k = 0; k < BOX_INDICES; ++k)
        out->indices[out->index_count++] = out->vertex_count + corner[k];
    for (uint32_t k = 0; k < BOX_VERTICES; ++k) {
        float p[3];
        for (int a = 0; a < 3; ++a)
            p[a] = k >> a & 1 ? (float)e->max[a] + grow : (float)e->min[a] - grow;
        out->vertices[out->vertex_count++] = (gtx_proxy_vertex){p[0], p[1], p[2], patch};
    }
}

gtx_result gtx_derive_boxes(const gtx_asset *asset, float grow, const gtx_allocator *allocator,
                            gtx_proxies *out, gtx_error *error)
{
    if (!asset || !out || !(grow >= 0) || isinf(grow))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "boxes need an asset and a finite growth >= 0");
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    uint32_t patches = asset->info.patch_count, boxes = 0;
    gtx_proxies proxies = {.patch_count = patches};
    extent *extents = gtx_alloc_array(&hooks, patches, sizeof *extents);
    proxies.first_index = gtx_alloc_array(&hooks, (size_t)patches + 1, sizeof(uint32_t));
    for (uint32_t i = 0; extents && i < patches; ++i) {
        extents[i] = solid_extent(asset, &asset->patches[i]);
        boxes += extents[i].max[0] > 0;
    }
    proxies.vertex_count = boxes * BOX_VERTICES;
    proxies.index_count = boxes * BOX_INDICES;
    proxies.vertices = gtx_alloc_array(&hooks, proxies.vertex_count, sizeof *proxies.vertices);
    proxies.indices = gtx_alloc_array(&hooks, proxies.index_count, sizeof *proxies.indices);

    int failed = !extents || !proxies.first_index ||
                 (boxes && (!proxies.vertices || !proxies.indices));
    if (failed) {
        gtx_proxies_free(&proxies, &hooks);
    } else {
        proxies.vertex_count = proxies.index_count = 0;
        for (uint32_t i = 0; i < patches; ++i) {
            if (extents[i].max[0] > 0)
                append_box(&proxies, i, &extents[i], grow);
            proxies.first_index[i + 1] = proxies.index_count;
        }
        *out = proxies;
    }
    gtx_free_array(&hooks, extents, patches, sizeof *extents);
    return failed ? gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the boxes of %u patches",
                             patches)
                  : GTX_OK;
}

void gtx_proxies_free(gtx_proxies *proxies, const gtx_allocator *allocator)
{
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    gtx_free_array(&hooks, proxies->vertices, proxies->vertex_count, sizeof *proxies->vertices);
    gtx_free_array(&hooks, proxies->indices, proxies->index_count, sizeof *proxies->indices);
    gtx_free_array(&hooks, proxies->first_index, (size_t)proxies->patch_count + 1,
                   sizeof *proxies->first_index);
    *proxies = (gtx_proxies){0};
}
