/* Height fields: what casting needs of one patch, and lookups in its maps. */
#include "trace/caster.h"

#include "asset/patch.h"
#include "base/alloc.h"
#include "base/error.h"
#include "derive/crowd.h"

#include <math.h>
#include <string.h>

static uint32_t min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static uint32_t cells_of(uint32_t texels, uint32_t level)
{
    return (texels - 2 + (1u << level)) >> level;
}

static void add_cell(gtx_block *block, const gtx_grid *grid, uint32_t i, uint32_t j)
{
    block->solid |= (uint64_t)1 << (j % GTX_BLOCK * GTX_BLOCK + i % GTX_BLOCK);
    for (uint32_t k = 0; k < 4; ++k) {
        const uint16_t code = grid->code[(size_t)(j + (k >> 1)) * grid->nodes_x + i + (k & 1)];
        block->low = code < block->low ? code : block->low;
        block->high = code > block->high ? code : block->high;
    }
}

/* The height field's blocks, and their boxes. */
static void fill_blocks(gtx_caster *caster, uint32_t index, const gtx_asset *asset,
                        const gtx_grid *grid, gtx_box *boxes)
{
    const gtx_height_field *field = &caster->fields[index];
    gtx_block *blocks = caster->blocks + field->first_block;
    const uint32_t cells_x = grid->nodes_x - 1, cells_y = grid->nodes_y - 1;
    for (uint32_t b = 0; b < field->blocks_x * gtx_blocks_of(cells_y); ++b)
        blocks[b] = (gtx_block){.field = index,
                                .x = (uint16_t)(b % field->blocks_x * GTX_BLOCK),
                                .y = (uint16_t)(b / field->blocks_x * GTX_BLOCK),
                                .low = UINT16_MAX};
    for (uint32_t j = 0; j < cells_y; ++j)
        for (uint32_t i = 0; i < cells_x; ++i)
            if (grid->solid[(size_t)j * cells_x + i])
                add_cell(&blocks[j / GTX_BLOCK * field->blocks_x + i / GTX_BLOCK], grid, i, j);
    gtx_grid_boxes(asset, index, grid, boxes + field->first_block);
}

static void copy_maps(gtx_height_field *field, const gtx_asset *asset, const gtx_patch *patch)
{
    for (uint32_t y = 0; y < field->height; ++y) {
        size_t row = (size_t)patch->page * asset->info.page_height + patch->rect[1] + y;
        size_t from = row * asset->info.page_width + patch->rect[0];
        size_t to = (size_t)y * field->width;
        memcpy(field->trim + to, asset->trim + from, field->width);
        memcpy(field->normal + 2 * to, asset->normal[0] + 2 * from, 2 * (size_t)field->width);
    }
}

/* How much of the caster's arrays is taken. */
typedef struct cursor {
    size_t code, texel;
    uint32_t block;
} cursor;

/* Takes the height field's share and, once there is memory, points the height field into it. */
static void place_field(const gtx_caster *caster, gtx_height_field *field, cursor *at)
{
    field->nodes_x = cells_of(field->width, field->level) + 1;
    field->nodes_y = cells_of(field->height, field->level) + 1;
    field->first_block = at->block;
    field->blocks_x = gtx_blocks_of(field->nodes_x - 1);
    if (caster->code) {
        field->code = caster->code + at->code;
        field->trim = caster->trim + at->texel;
        field->normal = caster->normal + 2 * at->texel;
    }
    at->code += (size_t)field->nodes_x * field->nodes_y;
    at->texel += (size_t)field->width * field->height;
    at->block += field->blocks_x * gtx_blocks_of(field->nodes_y - 1);
}

static gtx_result fill_field(gtx_caster *caster, const gtx_asset *asset, uint32_t index,
                             gtx_box *boxes, gtx_error *error)
{
    gtx_height_field *field = &caster->fields[index];
    const gtx_patch *patch = &asset->patches[index];
    gtx_grid grid;
    gtx_result result =
        gtx_grid_build(asset, index, field->level, &caster->allocator, &grid, error);
    if (result)
        return result;
    memcpy(field->code, grid.code, (size_t)grid.nodes_x * grid.nodes_y * sizeof *grid.code);
    fill_blocks(caster, index, asset, &grid, boxes);
    gtx_grid_free(&grid, &caster->allocator);
    copy_maps(field, asset, patch);
    const gtx_patch_frame frame = gtx_patch_frame_of(patch, asset->info.height_bits);
    memcpy(field->to_grid, frame.to_grid, sizeof field->to_grid);
    gtx_normal_frame(patch, field->normal_frame);
    field->two_sided = patch->flags & GTX_PATCH_TWO_SIDED;
    return GTX_OK;
}

/* The coarsest level whose height field is within `max_error` of the finest, as those below it
 * are. */
static gtx_result choose_level(const gtx_asset *asset, uint32_t patch, double max_error,
                               const gtx_allocator *hooks, uint32_t *level, gtx_error *error)
{
    gtx_grid finest, grid;
    gtx_result result = gtx_grid_build(asset, patch, 0, hooks, &finest, error);
    if (result)
        return result;
    for (uint32_t k = 1; k < asset->info.mip_count; ++k) {
        result = gtx_grid_coarsen(&finest, k, hooks, &grid, error);
        if (result)
            break;
        const bool close = gtx_grid_error(asset, patch, &finest, &grid) <= max_error;
        gtx_grid_free(&grid, hooks);
        if (!close)
            break;
        *level = k;
    }
    gtx_grid_free(&finest, hooks);
    return result;
}

/* Bytes of all arrays, and while the hierarchy is built of its boxes and their order. */
static uint64_t bytes_of(const gtx_caster *caster, const cursor *total)
{
    const uint64_t block = sizeof(gtx_block) + sizeof(gtx_box) + sizeof(uint32_t) +
                           2 * sizeof(gtx_node);
    return sizeof *caster->fields * (uint64_t)caster->field_count +
           sizeof *caster->code * (uint64_t)total->code + 3 * (uint64_t)total->texel +
           block * total->block;
}

gtx_result gtx_fields_build(gtx_caster *caster, const gtx_asset *asset,
                            const gtx_caster_desc *desc, gtx_error *error)
{
    const gtx_allocator *hooks = &caster->allocator;
    cursor total = {0}, at = {0};
    caster->fields = gtx_alloc_array(hooks, caster->field_count, sizeof *caster->fields);
    for (uint32_t i = 0; caster->fields && i < caster->field_count; ++i) {
        gtx_height_field *field = &caster->fields[i];
        field->width = asset->patches[i].rect[2];
        field->height = asset->patches[i].rect[3];
        field->level = desc->level;
        if (desc->max_error > 0) {
            gtx_result chosen =
                choose_level(asset, i, desc->max_error, hooks, &field->level, error);
            if (chosen)
                return chosen;
        }
        field->trim_limit = gtx_trim_limit(field->level);
        place_field(caster, field, &total);
    }
    gtx_result result = gtx_check_derived(total.texel, &desc->limits, "a caster",
                                          bytes_of(caster, &total), error);
    if (result)
        return result;
    caster->code_count = total.code;
    caster->block_count = total.block;
    caster->texel_count = total.texel;
    caster->code = gtx_alloc_array(hooks, total.code, sizeof *caster->code);
    caster->blocks = gtx_alloc_array(hooks, total.block, sizeof *caster->blocks);
    caster->trim = gtx_alloc_array(hooks, total.texel, 1);
    caster->normal = gtx_alloc_array(hooks, total.texel, 2);
    gtx_box *boxes = gtx_alloc_array(hooks, total.block, sizeof *boxes);
    if (!caster->fields || !caster->code || !caster->blocks || !caster->trim || !caster->normal ||
        !boxes)
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory to cast into %u patches",
                          caster->field_count);
    for (uint32_t i = 0; !result && i < caster->field_count; ++i) {
        place_field(caster, &caster->fields[i], &at);
        result = fill_field(caster, asset, i, boxes, error);
    }
    if (!result)
        result = gtx_hierarchy_build(boxes, total.block, hooks, &caster->tree, error);
    gtx_free_array(hooks, boxes, total.block, sizeof *boxes);
    return result;
}

void gtx_fields_free(gtx_caster *caster)
{
    const gtx_allocator *hooks = &caster->allocator;
    gtx_free_array(hooks, caster->code, caster->code_count, sizeof *caster->code);
    gtx_free_array(hooks, caster->blocks, caster->block_count, sizeof *caster->blocks);
    gtx_free_array(hooks, caster->trim, caster->texel_count, 1);
    gtx_free_array(hooks, caster->normal, caster->texel_count, 2);
    gtx_free_array(hooks, caster->fields, caster->field_count, sizeof *caster->fields);
    gtx_hierarchy_free(&caster->tree, hooks);
}

gtx_line gtx_field_line(const gtx_height_field *field, const gtx_line *ray)
{
    gtx_line line = {.t_min = ray->t_min, .t_max = ray->t_max};
    for (int r = 0; r < 3; ++r) {
        const double *row = field->to_grid[r], *o = ray->origin, *d = ray->direction;
        line.origin[r] = row[0] * o[0] + row[1] * o[1] + row[2] * o[2] + row[3];
        line.direction[r] = row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
    }
    return line;
}

gtx_cell gtx_field_cell(const gtx_height_field *field, uint32_t i, uint32_t j)
{
    const uint32_t level = field->level;
    const uint16_t *row = field->code + (size_t)j * field->nodes_x + i;
    const uint16_t *next = row + field->nodes_x;
    return (gtx_cell){.x0 = i << level,
                      .x1 = min_u32((i + 1) << level, field->width - 1),
                      .y0 = j << level,
                      .y1 = min_u32((j + 1) << level, field->height - 1),
                      .c = row[0],
                      .cx = row[1] - row[0],
                      .cy = next[0] - row[0],
                      .cxy = next[1] - next[0] - row[1] + row[0]};
}

bool gtx_field_solid(const gtx_caster *caster, const gtx_height_field *field, uint32_t i,
                     uint32_t j)
{
    const uint32_t block = j / GTX_BLOCK * field->blocks_x + i / GTX_BLOCK;
    const uint32_t bit = j % GTX_BLOCK * GTX_BLOCK + i % GTX_BLOCK;
    return caster->blocks[field->first_block + block].solid >> bit & 1;
}

/* Four weights and the texel of the first for a bilinear lookup at (x, y), clamped to the map. */
static size_t bilinear(const gtx_height_field *field, double x, double y, double weight[4])
{
    double right = field->width - 1, top = field->height - 1;
    x = x > 0 ? (x < right ? x : right) : 0;
    y = y > 0 ? (y < top ? y : top) : 0;
    uint32_t i = min_u32((uint32_t)x, field->width - 2);
    uint32_t j = min_u32((uint32_t)y, field->height - 2);
    double u = x - i, v = y - j;
    weight[0] = (1 - u) * (1 - v);
    weight[1] = u * (1 - v);
    weight[2] = (1 - u) * v;
    weight[3] = u * v;
    return (size_t)j * field->width + i;
}

double gtx_field_trim(const gtx_height_field *field, double x, double y)
{
    double weight[4];
    const uint8_t *row = field->trim + bilinear(field, x, y, weight);
    const uint8_t *next = row + field->width;
    return weight[0] * row[0] + weight[1] * row[1] + weight[2] * next[0] + weight[3] * next[1];
}

bool gtx_field_shows(const gtx_height_field *field, double x, double y)
{
    return gtx_field_trim(field, x, y) <= field->trim_limit;
}

void gtx_field_normal(const gtx_height_field *field, double x, double y, float out[3])
{
    double weight[4];
    size_t texel = bilinear(field, x, y, weight);
    const size_t corner[4] = {texel, texel + 1, texel + field->width, texel + field->width + 1};
    double a = -1, b = -1;
    for (int k = 0; k < 4; ++k) {
        a += weight[k] * field->normal[2 * corner[k]] / 127.5;
        b += weight[k] * field->normal[2 * corner[k] + 1] / 127.5;
    }
    const double px = (a + b) / 2, py = (a - b) / 2, pz = 1 - fabs(px) - fabs(py);
    const double length = sqrt(px * px + py * py + pz * pz);
    for (int k = 0; k < 3; ++k)
        out[k] = (float)((px * field->normal_frame[0][k] + py * field->normal_frame[1][k] +
                          pz * field->normal_frame[2][k]) / length);
}

void gtx_field_facet(const gtx_height_field *field, const gtx_cell *cell, double x, double y,
                     float out[3])
{
    const double u = (x - cell->x0) / (cell->x1 - cell->x0);
    const double v = (y - cell->y0) / (cell->y1 - cell->y0);
    const double slope_x = (cell->cx + cell->cxy * v) / (cell->x1 - cell->x0);
    const double slope_y = (cell->cy + cell->cxy * u) / (cell->y1 - cell->y0);
    double n[3];
    for (int k = 0; k < 3; ++k)
        n[k] = field->to_grid[2][k] - slope_x * field->to_grid[0][k] -
               slope_y * field->to_grid[1][k];
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; ++k)
        out[k] = (float)(n[k] / length);
}
