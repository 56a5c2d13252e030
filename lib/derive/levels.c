/* Levels of the height sheet, derived by the rule of format/gtx.md, section 5. */
#include "derive/derive.h"

#include "base/alloc.h"
#include "base/error.h"

static uint32_t min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* The mean of the codes at most 2^level texels away from (x, y), rounded half up; 0 if there is
 * none. */
static uint32_t mean_code(const gtx_asset *asset, const gtx_patch *patch, uint32_t x, uint32_t y,
                          uint32_t level)
{
    uint32_t reach = 1u << level;
    uint32_t x0 = x > reach ? x - reach : 0, x1 = min_u32(x + reach, patch->rect[2] - 1u);
    uint32_t y0 = y > reach ? y - reach : 0, y1 = min_u32(y + reach, patch->rect[3] - 1u);
    uint64_t sum = 0, count = 0;
    for (uint32_t j = y0; j <= y1; ++j)
        for (uint32_t i = x0; i <= x1; ++i) {
            uint32_t code = gtx_height_code(asset, patch, i, j);
            sum += code;
            count += code != 0;
        }
    return count ? (uint32_t)((2 * sum + count) / (2 * count)) : 0;
}

static void fill_codes(const gtx_asset *asset, const gtx_patch *patch, gtx_grid *grid)
{
    for (uint32_t j = 0; j < grid->nodes_y; ++j)
        for (uint32_t i = 0; i < grid->nodes_x; ++i) {
            uint32_t x = min_u32(i << grid->level, patch->rect[2] - 1u);
            uint32_t y = min_u32(j << grid->level, patch->rect[3] - 1u);
            uint32_t code = gtx_height_code(asset, patch, x, y);
            if (!code && grid->level)
                code = mean_code(asset, patch, x, y, grid->level);
            grid->code[(size_t)j * grid->nodes_x + i] = (uint16_t)code;
        }
}

/* A cell is solid when one of its cells of level 0 is. */
static void fill_solid(const gtx_asset *asset, const gtx_patch *patch, gtx_grid *grid)
{
    for (uint32_t y = 0; y + 1 < patch->rect[3]; ++y) {
        uint8_t *row = grid->solid + (size_t)(y >> grid->level) * (grid->nodes_x - 1);
        int left = gtx_height_code(asset, patch, 0, y) && gtx_height_code(asset, patch, 0, y + 1);
        for (uint32_t x = 0; x + 1 < patch->rect[2]; ++x) {
            int right = gtx_height_code(asset, patch, x + 1, y) &&
                        gtx_height_code(asset, patch, x + 1, y + 1);
            if (left && right)
                row[x >> grid->level] = 1;
            left = right;
        }
    }
}

void gtx_grid_trim(const gtx_asset *asset, uint32_t patch, gtx_grid *grid)
{
    enum { SOLID = 1, SHOWN = 2 };
    const gtx_patch *p = &asset->patches[patch];
    const uint32_t width = grid->nodes_x - 1, height = grid->nodes_y - 1, level = grid->level;
    const uint32_t limit = 128 + (48u << level) / 10;
    for (uint32_t y = 0; y < p->rect[3]; ++y) {
        uint8_t *before = grid->solid + (size_t)((y ? y - 1 : 0) >> level) * width;
        uint8_t *row = grid->solid + (size_t)min_u32(y >> level, height - 1) * width;
        for (uint32_t x = 0; x < p->rect[2]; ++x) {
            if (gtx_trim_code(asset, p, x, y) > limit)
                continue;
            const uint32_t left = (x ? x - 1 : 0) >> level, at = min_u32(x >> level, width - 1);
            before[left] |= SHOWN, before[at] |= SHOWN;
            row[left] |= SHOWN, row[at] |= SHOWN;
        }
    }
    for (size_t c = 0; c < (size_t)width * height; ++c)
        grid->solid[c] = grid->solid[c] == (SOLID | SHOWN);
}

gtx_result gtx_grid_build(const gtx_asset *asset, uint32_t patch, uint32_t level,
                          const gtx_allocator *allocator, gtx_grid *out, gtx_error *error)
{
    if (!asset || !out || patch >= asset->info.patch_count || level >= GTX_MAX_MIPS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "no such patch or level");
    const gtx_patch *record = &asset->patches[patch];
    const gtx_allocator hooks = gtx_allocator_or_default(allocator);
    uint32_t step = 1u << level;
    gtx_grid grid = {.level = level,
                     .nodes_x = (record->rect[2] - 2u + step) / step + 1,
                     .nodes_y = (record->rect[3] - 2u + step) / step + 1};
    size_t nodes = (size_t)grid.nodes_x * grid.nodes_y;
    size_t cells = (size_t)(grid.nodes_x - 1) * (grid.nodes_y - 1);
    grid.code = gtx_alloc_array(&hooks, nodes, sizeof *grid.code);
    grid.solid = gtx_alloc_array(&hooks, cells, sizeof *grid.solid);
    if (!grid.code || !grid.solid) {
        gtx_grid_free(&grid, &hooks);
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for level %u of patch %u", level,
                        patch);
    }
    fill_codes(asset, record, &grid);
    fill_solid(asset, record, &grid);
    *out = grid;
    return GTX_OK;
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
