/* A made world: a quadtree of tiny tiles over the square 0..64, each a real asset of its own, and
 * its index. Needs cmocka before it. */
#ifndef GTX_TESTS_MADE_H
#define GTX_TESTS_MADE_H

#include "base/hash.h"
#include "stream/index.h"

#include <geotex/stream.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { MADE_LEVELS = 5, MADE_TILES = 1 + 4 + 16 + 64 + 256, MADE_SIDE = 64 };

typedef struct made_world {
    gtx_index_tile tiles[MADE_TILES];
    uint32_t first_child[MADE_TILES]; /* 0: a leaf */
    uint8_t *files[MADE_TILES];
    uint8_t index[GTX_INDEX_HEADER + MADE_TILES * GTX_INDEX_RECORD];
} made_world;

/* One patch of 8 x 8 texels: a flat square whose anchor is the tile's low corner; and an LOD mesh
 * of two triangles. */
static inline void made_asset(const double low[3], double side, uint8_t **data, uint64_t *bytes)
{
    uint8_t height[64], trim[64], normal[128];
    memset(height, 100, sizeof height);
    memset(trim, 100, sizeof trim);
    memset(normal, 128, sizeof normal);
    const uint8_t *normals[1] = {normal};
    const float s = (float)side;
    static const uint32_t first[2] = {0, 2}, indices[6] = {0, 1, 2, 2, 1, 3};
    static const uint16_t corners[12] = {0, 100, 0, 1000, 100, 0, 0, 100, 1000, 1000, 100, 1000};
    const gtx_lod_mesh lod = {.step = s / 1000, .error = s / 100, .vertex_count = 4,
                              .triangle_count = 2, .first = first, .indices = indices,
                              .positions = corners};
    const gtx_patch patch = {.extent_x = s, .axis_x = {1, 0, 0}, .extent_y = s,
                             .axis_y = {0, 0, -1}, .origin = {0, 0, s}, .extent_z = 0.25f * s,
                             .axis_z = {0, 1, 0}, .coverage = 1, .rect = {0, 0, 8, 8},
                             .dilation = 1, .source_triangles = 2,
                             .sphere = {s / 2, 0.1f * s, s / 2, s}};
    const gtx_asset_desc desc = {.patches = &patch, .patch_count = 1, .page_count = 1,
                                 .page_width = 8, .page_height = 8, .mip_count = 1,
                                 .height_bits = 8, .height = height, .trim = trim,
                                 .normal = normals, .bounds_max = {s, 0.25f * s, s},
                                 .anchor = {low[0], low[1], low[2]}, .source_triangles = 2,
                                 .lod = &lod, .lod_levels = 1};
    gtx_asset *asset;
    gtx_error error;
    size_t size;
    if (gtx_create(&desc, &asset, &error))
        fail_msg("%s", error.message);
    const gtx_encode_desc stored = {.zstd_level = -1};
    assert_int_equal(gtx_encode(asset, &stored, (void **)data, &size, NULL), GTX_OK);
    gtx_close(asset);
    *bytes = size;
}

/* Memory that opening a made tile takes, with room to spare for readers of many parts. */
enum { MADE_MEMORY = 8192 };

/* To the end of its LOD mesh. */
static inline gtx_index_part made_beginning(const uint8_t *file)
{
    gtx_index_part part = {.memory = MADE_MEMORY};
    gtx_prefix prefix = {0};
    gtx_asset *asset = NULL;
    while (!asset) {
        part.bytes = prefix.needed;
        assert_int_equal(gtx_open_prefix(file, (size_t)part.bytes, NULL, &prefix, &asset, NULL),
                         GTX_OK);
    }
    gtx_close(asset);
    part.hash = gtx_hash_bytes(file, (size_t)part.bytes);
    return part;
}

/* `beginnings`: files are asked for in two parts, but each seventh. */
static inline void made_begin(made_world *world, bool beginnings)
{
    memset(world, 0, sizeof *world);
    uint32_t count = 1;
    strcpy(world->tiles[0].name, "r");
    for (uint32_t i = 0; i < MADE_TILES; ++i) {
        gtx_index_tile *tile = &world->tiles[i];
        const size_t depth = strlen(tile->name) - 1;
        const double side = MADE_SIDE / (double)(1 << depth);
        for (int k = 0; k < 3; ++k)
            tile->high[k] = tile->low[k] + (k == 1 ? 16 : side);
        tile->error = 4.0f / (float)(1 << depth);
        made_asset(tile->low, side, &world->files[i], &tile->whole.bytes);
        tile->whole.hash = gtx_hash_bytes(world->files[i], (size_t)tile->whole.bytes);
        tile->whole.memory = MADE_MEMORY;
        if (beginnings && i % 7 != 5) {
            tile->beginning = made_beginning(world->files[i]);
            tile->beginning_error = 1.5f * tile->error;
        }
        world->first_child[i] = depth + 1 < MADE_LEVELS ? count : 0;
        for (uint32_t k = 0; k < 4 && depth + 1 < MADE_LEVELS; ++k) {
            gtx_index_tile *child = &world->tiles[count++];
            child->parent = i;
            memcpy(child->name, tile->name, depth + 1);
            child->name[depth + 1] = (char)('0' + k);
            child->low[0] = tile->low[0] + (k & 1 ? side / 2 : 0);
            child->low[2] = tile->low[2] + (k & 2 ? side / 2 : 0);
        }
    }
    assert_int_equal(count, MADE_TILES);
    gtx_index_write(world->tiles, MADE_TILES, 1, world->index);
}

static inline void made_end(made_world *world)
{
    for (uint32_t i = 0; i < MADE_TILES; ++i)
        free(world->files[i]);
}

/* A camera at `eye` that looks along azimuth and elevation (radians; 0, 0: along -Z), 90 degrees
 * wide and high. */
static inline gtx_stream_view made_view(const double eye[3], double azimuth, double elevation)
{
    const double ca = cos(azimuth), sa = sin(azimuth), ce = cos(elevation), se = sin(elevation);
    const double right[3] = {ca, 0, sa}, back[3] = {-sa * ce, -se, ca * ce};
    const double up[3] = {back[1] * right[2] - back[2] * right[1],
                          back[2] * right[0] - back[0] * right[2],
                          back[0] * right[1] - back[1] * right[0]};
    gtx_stream_view view = {.viewport_height = 500};
    for (int k = 0; k < 3; ++k) {
        view.origin[k] = eye[k];
        view.view[4 * k] = (float)right[k];
        view.view[4 * k + 1] = (float)up[k];
        view.view[4 * k + 2] = (float)back[k];
    }
    view.view[15] = 1;
    view.projection[0] = view.projection[5] = 1;
    view.projection[10] = -1;
    view.projection[11] = -1;
    view.projection[14] = -0.1f;
    return view;
}

/* Whether a point is within the picture, by the view's matrices. */
static inline bool made_sees(const gtx_stream_view *view, const double point[3])
{
    double eye[4] = {0, 0, 0, 0}, clip[4] = {0, 0, 0, 0};
    for (int row = 0; row < 4; ++row) {
        eye[row] = view->view[12 + row];
        for (int k = 0; k < 3; ++k)
            eye[row] += view->view[4 * k + row] * (point[k] - view->origin[k]);
    }
    for (int row = 0; row < 4; ++row)
        for (int k = 0; k < 4; ++k)
            clip[row] += view->projection[4 * k + row] * eye[k];
    return clip[3] > 0 && fabs(clip[0]) < 0.999 * clip[3] && fabs(clip[1]) < 0.999 * clip[3];
}

#endif
