/* Levels of the height field, derived by the rule of format/gtx.md, section 5. */
#include "derive/derive.h"

#include "base/alloc.h"
#include "base/error.h"

#include <stdbool.h>
#include <string.h>

/* What a fold over rectangles of texels keeps at hand: a row, and what is read beyond its end. */
enum { MAX_STEP = 1 << (GTX_MAX_MIPS - 1), ROW_ROOM = GTX_MAX_PAGE_SIDE + 2 * MAX_STEP };

static uint32_t min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* Two texels at most 2^level away from a node, along one axis. */
static void reach_of(uint32_t at, uint32_t level, uint32_t texels, uint32_t out[2])
{
    const uint32_t reach = 1u << level;
    out[0] = at > reach ? at - reach : 0;
    out[1] = min_u32(at + reach, texels - 1);
}

static void load_codes(const gtx_asset *asset, const gtx_patch *patch, gtx_grid *grid)
{
    const size_t width = grid->nodes_x, size = asset->info.height_bits / 8;
    for (uint32_t y = 0; y < grid->nodes_y; ++y) {
        const size_t line = (size_t)patch->page * asset->info.page_height + patch->rect[1] + y;
        const uint8_t *from =
            asset->height + (line * asset->info.page_width + patch->rect[0]) * size;
        uint16_t *to = grid->code + y * width;
        if (size == 2)
            memcpy(to, from, width * size);
        for (size_t x = 0; size == 1 && x < width; ++x)
            to[x] = from[x];
    }
}

static void find_solid(gtx_grid *grid)
{
    const size_t width = grid->nodes_x;
    for (size_t y = 0; y + 1 < grid->nodes_y; ++y) {
        const uint16_t *row = grid->code + y * width, *next = row + width;
        uint8_t *solid = grid->solid + y * (width - 1);
        for (size_t x = 0; x + 1 < width; ++x)
            solid[x] = (row[x] != 0) & (row[x + 1] != 0) & (next[x] != 0) & (next[x + 1] != 0);
    }
}

/* What is under a node row's means: sums and counts, column by column, of the codes around it. */
typedef struct columns {
    uint32_t *sum, *count;
} columns;

static void sum_columns(const gtx_grid *finest, uint32_t y, uint32_t level, const columns *out)
{
    const size_t width = finest->nodes_x;
    uint32_t reach[2];
    reach_of(y, level, finest->nodes_y, reach);
    memset(out->sum, 0, width * sizeof *out->sum);
    memset(out->count, 0, width * sizeof *out->count);
    for (uint32_t j = reach[0]; j <= reach[1]; ++j) {
        const uint16_t *row = finest->code + j * width;
        uint32_t *sum = out->sum, *count = out->count;
        for (size_t x = 0; x < width; ++x) {
            sum[x] += row[x];
            count[x] += row[x] != 0;
        }
    }
}

/* The mean of the codes at most 2^level texels away, rounded half up; 0 if there is none. */
static uint16_t mean_code(const columns *around, uint32_t x, uint32_t level, uint32_t width)
{
    uint32_t reach[2];
    reach_of(x, level, width, reach);
    uint64_t sum = 0, count = 0;
    for (uint32_t i = reach[0]; i <= reach[1]; ++i) {
        sum += around->sum[i];
        count += around->count[i];
    }
    return (uint16_t)(count ? (2 * sum + count) / (2 * count) : 0);
}

static void coarsen_codes(const gtx_grid *finest, gtx_grid *grid, const columns *around)
{
    const uint32_t level = grid->level, width = finest->nodes_x;
    for (uint32_t j = 0; j < grid->nodes_y; ++j) {
        const uint32_t y = min_u32(j << level, finest->nodes_y - 1);
        const uint16_t *from = finest->code + (size_t)y * width;
        uint16_t *to = grid->code + (size_t)j * grid->nodes_x;
        bool summed = false;
        for (uint32_t i = 0; i < grid->nodes_x; ++i) {
            const uint32_t x = min_u32(i << level, width - 1);
            to[i] = from[x];
            if (to[i])
                continue;
            if (!summed)
                sum_columns(finest, y, level, around);
            summed = true;
            to[i] = mean_code(around, x, level, width);
        }
    }
}

/* A cell is solid when one of its cells of level 0 is. */
static void coarsen_solid(const gtx_grid *finest, gtx_grid *grid)
{
    uint8_t any[ROW_ROOM];
    const size_t width = finest->nodes_x - 1, height = finest->nodes_y - 1;
    const size_t cells_x = grid->nodes_x - 1, step = (size_t)1 << grid->level;
    for (size_t j = 0; j + 1 < grid->nodes_y; ++j) {
        memset(any, 0, width + step);
        for (size_t y = j * step; y < (j + 1) * step && y < height; ++y) {
            const uint8_t *solid = finest->solid + y * width;
            for (size_t x = 0; x < width; ++x)
                any[x] |= solid[x];
        }
        for (size_t reach = 1; reach < step; reach *= 2)
            for (size_t x = 0; x < width; ++x)
                any[x] |= any[x + reach];
        for (size_t i = 0; i < cells_x; ++i)
            grid->solid[j * cells_x + i] = any[i * step];
    }
}

/* Each of a row's bytes becomes the lesser of itself and the one so far ahead. */
static void fold_least(uint8_t *row, size_t width, size_t ahead)
{
    for (size_t x = 0; x < width; ++x)
        row[x] = row[x + ahead] < row[x] ? row[x + ahead] : row[x];
}

void gtx_grid_trim(const gtx_asset *asset, uint32_t patch, gtx_grid *grid)
{
    uint8_t least[ROW_ROOM];
    const gtx_patch *p = &asset->patches[patch];
    const size_t width = p->rect[2], cells_x = grid->nodes_x - 1, step = (size_t)1 << grid->level;
    const uint32_t limit = (uint32_t)gtx_trim_limit(grid->level);
    const uint8_t *first = asset->trim + ((size_t)p->page * asset->info.page_height + p->rect[1]) *
                                             asset->info.page_width + p->rect[0];
    for (size_t j = 0; j + 1 < grid->nodes_y; ++j) {
        memset(least, UINT8_MAX, width + 2 * step);
        for (size_t y = j * step; y <= (j + 1) * step && y < p->rect[3]; ++y) {
            const uint8_t *row = first + y * asset->info.page_width;
            for (size_t x = 0; x < width; ++x)
                least[x] = row[x] < least[x] ? row[x] : least[x];
        }
        for (size_t reach = 1; reach < step; reach *= 2)
            fold_least(least, width, reach);
        fold_least(least, width, 1); /* both ends of a cell are its own */
        uint8_t *solid = grid->solid + j * cells_x;
        for (size_t i = 0; i < cells_x; ++i)
            solid[i] &= least[i * step] <= limit;
    }
}

/* A grid of the level with room, still to be written. */
static gtx_result new_grid(const uint32_t texels[2], uint32_t level, const gtx_allocator *hooks,
                           gtx_grid *out, gtx_error *error)
{
    const uint32_t step = 1u << level;
    *out = (gtx_grid){.level = level, .nodes_x = (texels[0] - 2u + step) / step + 1,
                      .nodes_y = (texels[1] - 2u + step) / step + 1};
    const size_t nodes = (size_t)out->nodes_x * out->nodes_y;
    const size_t cells = (size_t)(out->nodes_x - 1) * (out->nodes_y - 1);
    out->code = gtx_alloc_raw(hooks, nodes, sizeof *out->code);
    out->solid = gtx_alloc_raw(hooks, cells, sizeof *out->solid);
    if (out->code && out->solid)
        return GTX_OK;
    gtx_grid_free(out, hooks);
    return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for level %u of a patch", level);
}

gtx_result gtx_grid_coarsen(const gtx_grid *finest, uint32_t level, const gtx_allocator *allocator,
                            gtx_grid *out, gtx_error *error)
{
    if (!finest || finest->level || !out || level == 0 || level >= GTX_MAX_MIPS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "levels above 0 are made of a patch's level 0");
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    const uint32_t texels[2] = {finest->nodes_x, finest->nodes_y};
    gtx_result result = new_grid(texels, level, &hooks, out, error);
    if (result)
        return result;
    columns around;
    around.sum = gtx_alloc_array(&hooks, 2 * (size_t)texels[0], sizeof *around.sum);
    if (!around.sum) {
        gtx_grid_free(out, &hooks);
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for level %u of a patch", level);
    }
    around.count = around.sum + texels[0];
    coarsen_codes(finest, out, &around);
    coarsen_solid(finest, out);
    gtx_free_array(&hooks, around.sum, 2 * (size_t)texels[0], sizeof *around.sum);
    return GTX_OK;
}

gtx_result gtx_grid_build(const gtx_asset *asset, uint32_t patch, uint32_t level,
                          const gtx_allocator *allocator, gtx_grid *out, gtx_error *error)
{
    if (!asset || !out || patch >= asset->info.patch_count || level >= GTX_MAX_MIPS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "no such patch or level");
    const gtx_patch *record = &asset->patches[patch];
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    const uint32_t texels[2] = {record->rect[2], record->rect[3]};
    gtx_grid finest;
    gtx_result result = new_grid(texels, 0, &hooks, &finest, error);
    if (result)
        return result;
    load_codes(asset, record, &finest);
    find_solid(&finest);
    if (level == 0) {
        *out = finest;
        return GTX_OK;
    }
    result = gtx_grid_coarsen(&finest, level, &hooks, out, error);
    gtx_grid_free(&finest, &hooks);
    return result;
}

void gtx_grid_free(gtx_grid *grid, const gtx_allocator *allocator)
{
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    size_t nodes = (size_t)grid->nodes_x * grid->nodes_y;
    size_t cells = nodes ? (size_t)(grid->nodes_x - 1) * (grid->nodes_y - 1) : 0;
    gtx_free_array(&hooks, grid->code, nodes, sizeof *grid->code);
    gtx_free_array(&hooks, grid->solid, cells, sizeof *grid->solid);
    *grid = (gtx_grid){0};
}
