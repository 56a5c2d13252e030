/* What drawing derives from one patch: corner cells of all levels, its record, and its proxies. */
#include "frame/model.h"

#include "asset/patch.h"
#include "base/alloc.h"
#include "base/error.h"
#include "derive/codes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far, in texels and codes, hulls stand off the height field: rounding in the rasteriser must
 * not cut the height field's rim, and a flat height field must not lie in a face. */
static const float hull_margin = 0.25f;

/* A ray may pass a face of a hull at each of its blocks, and each face casts anew. Patches with a
 * longer side, which no cooker makes, are cast by their boxes instead, once a ray. */
enum { MAX_HULL_SIDE = 512 };

/* The part of a record that is the same for all levels. */
static void fill_frame(gtx_record record, const gtx_patch *patch, uint32_t height_bits)
{
    const gtx_patch_frame frame = gtx_patch_frame_of(patch, height_bits);
    for (int k = 0; k < 4; ++k)
        for (int r = 0; r < 3; ++r)
            record[GTX_RECORD_TO_GRID + r][k] = (float)frame.to_grid[r][k];
    for (int k = 0; k < 3; ++k) {
        record[GTX_RECORD_ORIGIN][k] = (float)frame.origin[k];
        for (int a = 0; a < 3; ++a)
            record[GTX_RECORD_AXIS_X + a][k] = (float)frame.axis[a][k];
    }
    record[GTX_RECORD_PAGE][3] = (float)patch->page;
    record[GTX_RECORD_TWO_SIDED][3] = patch->flags & GTX_PATCH_TWO_SIDED ? 1.0f : 0.0f;
    for (int k = 0; k < 4; ++k)
        record[GTX_RECORD_RECT][k] = patch->rect[k];
}

/* The part that follows from the box, whose vertices begin at `box`. */
static void fill_box(gtx_record record, const gtx_proxy_vertex *box)
{
    const gtx_proxy_vertex *low = box, *high = box + GTX_BOX_VERTICES - 1;
    float *solid = record[GTX_RECORD_SOLID];
    record[GTX_RECORD_LOW_Z][3] = low->z;
    record[GTX_RECORD_HIGH_Z][3] = high->z;
    solid[0] = low->x + hull_margin;
    solid[1] = low->y + hull_margin;
    solid[2] = high->x - hull_margin;
    solid[3] = high->y - hull_margin;
}

/* Enlarges the sphere until the vertices are within. */
static void enclose(float sphere[4], gtx_record record, const gtx_proxies *proxies,
                    uint32_t first)
{
    double most = 0;
    for (uint32_t v = first; v < proxies->vertex_count; ++v) {
        const gtx_proxy_vertex *p = &proxies->vertices[v];
        double square = 0;
        for (int k = 0; k < 3; ++k) {
            const double at = record[GTX_RECORD_ORIGIN][k] +
                              (double)record[GTX_RECORD_AXIS_X][k] * p->x +
                              (double)record[GTX_RECORD_AXIS_Y][k] * p->y +
                              (double)record[GTX_RECORD_AXIS_Z][k] * p->z;
            square += (at - sphere[k]) * (at - sphere[k]);
        }
        most = square > most ? square : most;
    }
    sphere[3] = (float)(fmax(sphere[3], sqrt(most)) * 1.0001);
}

static void fill_slabs(gtx_derived *out, uint32_t level, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        const gtx_slab *slab = &out->slabs[level][i];
        const gtx_slab_texel texel = {slab->slope[0], slab->slope[1], slab->height[0],
                                      slab->height[1]};
        memcpy(out->slab_texels[level][i], texel, sizeof texel);
    }
    out->record[GTX_RECORD_SLABS + level / 4][level % 4] = (float)out->slabs_at[level];
}

/* Whether a cell and all around it are solid. */
static bool is_inner(const gtx_grid *grid, uint32_t i, uint32_t j)
{
    const uint32_t cells_x = grid->nodes_x - 1, cells_y = grid->nodes_y - 1;
    bool inner = i > 0 && j > 0 && i + 1 < cells_x && j + 1 < cells_y;
    for (uint32_t k = 0; inner && k < 9; ++k)
        inner = grid->solid[(size_t)(j + k / 3 - 1) * cells_x + i + k % 3 - 1];
    return inner;
}

/* In the middle a cell's surface is so far from its diagonal, in codes; at outlines that counts
 * more. */
static float most_twist(const gtx_grid *grid)
{
    int32_t most = 0;
    for (uint32_t j = 0; j + 1 < grid->nodes_y; ++j)
        for (uint32_t i = 0; i + 1 < grid->nodes_x; ++i) {
            const uint16_t *c = grid->code + (size_t)j * grid->nodes_x + i;
            int32_t twist = abs(c[0] - c[1] - c[grid->nodes_x] + c[grid->nodes_x + 1]);
            if (twist <= most / GTX_BORDER_COUNTS ||
                !grid->solid[(size_t)j * (grid->nodes_x - 1) + i])
                continue;
            twist *= is_inner(grid, i, j) ? 1 : GTX_BORDER_COUNTS;
            most = twist > most ? twist : most;
        }
    return (float)most / 4;
}

/* Trims a level, and derives its cells, its slabs and its hull. */
static gtx_result derive_level(const gtx_asset *asset, uint32_t patch, gtx_grid *grid,
                               const gtx_allocator *allocator, gtx_derived *out, gtx_error *error)
{
    const uint32_t k = grid->level;
    gtx_proxies *hulls = &out->proxies[1 + k];
    const uint32_t first = hulls->vertex_count;
    gtx_grid_trim(asset, patch, grid);
    gtx_grid_codes(grid, asset->info.height_bits, out->row_texels[k], out->cells[k]);
    gtx_grid_slabs(&asset->patches[patch], grid, out->slabs[k]);
    fill_slabs(out, k, gtx_slab_count(&asset->patches[patch], k));
    if (out->facts.boxed)
        return GTX_OK;
    gtx_result result = gtx_add_hull(asset, patch, grid, hull_margin, allocator, hulls,
                                     &out->record[GTX_RECORD_REACH + k / 4][k % 4], error);
    if (!result)
        enclose(out->facts.hull, out->record, hulls, first);
    return result;
}

/* The planes of the blocks of level 0 as one vector. */
static void fill_area(const gtx_patch *patch, const gtx_derived *d, float area[3])
{
    const float *axis[3] = {d->record[GTX_RECORD_AXIS_X], d->record[GTX_RECORD_AXIS_Y],
                            d->record[GTX_RECORD_AXIS_Z]};
    double cells = 0, tilted[2] = {0, 0}, volume = 0;
    for (uint32_t i = 0; i < gtx_slab_count(patch, 0); ++i) {
        const gtx_slab *s = &d->slabs[0][i];
        if (s->low[0] > s->high[0])
            continue;
        const double size = ((double)s->high[0] - s->low[0]) * ((double)s->high[1] - s->low[1]);
        cells += size;
        tilted[0] += size * s->slope[0];
        tilted[1] += size * s->slope[1];
    }
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        double cross[3];      /* x by y, y by z, z by x */
        for (int i = 0; i < 3; ++i) {
            const float *p = axis[i], *q = axis[(i + 1) % 3];
            cross[i] = (double)p[a] * q[b] - (double)p[b] * q[a];
        }
        area[k] = (float)(cells * cross[0] - tilted[0] * cross[1] - tilted[1] * cross[2]);
        volume += cross[0] * axis[2][k];
    }
    for (int k = 0; k < 3 && volume < 0; ++k)
        area[k] = -area[k];
}

/* Of an asset that has no heights. */
static gtx_result derive_bare(const gtx_asset *asset, uint32_t patch, gtx_derived *out)
{
    const gtx_patch *p = &asset->patches[patch];
    memset(out->record, 0, sizeof out->record);
    memset(&out->facts, 0, sizeof out->facts);
    fill_frame(out->record, p, asset->info.height_bits);
    memcpy(out->facts.sphere, p->sphere, sizeof out->facts.sphere);
    memcpy(out->facts.hull, p->sphere, sizeof out->facts.hull);
    gtx_normal_deviation(asset, patch, NULL, out->record + GTX_RECORD_DEVIATION);
    return GTX_OK;
}

gtx_result gtx_patch_derive(const gtx_asset *asset, uint32_t patch, const gtx_allocator *allocator,
                            gtx_derived *out, gtx_error *error)
{
    if (asset->bare)
        return derive_bare(asset, patch, out);
    const gtx_patch *p = &asset->patches[patch];
    gtx_grid finest = {0}, grid;
    gtx_proxies *boxes = &out->proxies[0];
    float *errors = out->facts.error;
    const float code = p->extent_z / (float)(asset->info.height_bits == 16 ? 65534 : 254);
    gtx_result result = gtx_grid_build(asset, patch, 0, allocator, &finest, error);
    if (!result)
        result = gtx_add_box(patch, &finest, hull_margin, allocator, boxes, error);
    if (!result) {
        memset(out->record, 0, sizeof out->record);
        memset(&out->facts, 0, sizeof out->facts);
        fill_frame(out->record, p, asset->info.height_bits);
        fill_box(out->record, boxes->vertices + boxes->vertex_count - GTX_BOX_VERTICES);
        memcpy(out->facts.sphere, p->sphere, sizeof out->facts.sphere);
        memcpy(out->facts.hull, p->sphere, 3 * sizeof *p->sphere);
        out->facts.boxed = p->rect[2] > MAX_HULL_SIDE || p->rect[3] > MAX_HULL_SIDE;
        if (out->facts.boxed)
            enclose(out->facts.hull, out->record, boxes, boxes->vertex_count - GTX_BOX_VERTICES);
    }
    if (!result)
        gtx_normal_deviation(asset, patch, &finest, out->record + GTX_RECORD_DEVIATION);
    for (uint32_t k = 1; !result && k < asset->info.mip_count; ++k) {
        result = gtx_grid_coarsen(&finest, k, allocator, &grid, error);
        if (result)
            break;
        errors[k] = (float)gtx_grid_error(asset, patch, &finest, &grid);
        if (errors[k] < errors[k - 1])
            errors[k] = errors[k - 1];
        result = derive_level(asset, patch, &grid, allocator, out, error);
        out->facts.twist[k] = fmaxf(out->facts.twist[k - 1], most_twist(&grid) * code);
        gtx_grid_free(&grid, allocator);
    }
    uint16_t *filled = NULL;
    if (!result)
        result = gtx_grid_fill(&finest, asset->info.height_bits, allocator, &filled, error);
    if (!result) /* last, for errors are measured against what is not trimmed */
        result = derive_level(asset, patch, &finest, allocator, out, error);
    const gtx_rtin_source source = {asset, patch, &finest, filled, out->slabs[0]};
    if (!result)
        fill_area(p, out, out->facts.area);
    if (!result)
        result = gtx_rtin_build(&source, allocator, &out->rtin, out->nodes, out->blocks, error);
    gtx_free_array(allocator, filled, (size_t)finest.nodes_x * finest.nodes_y, sizeof *filled);
    gtx_grid_free(&finest, allocator);
    return result;
}
