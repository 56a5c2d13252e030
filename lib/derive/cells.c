/* What kernels on the GPU take of a level: corner cells, the four codes of a cell in one texel, and
 * how far the level's sheet lies from the finest one. */
#include "derive/derive.h"

#include <math.h>
#include <string.h>

void gtx_grid_cells(const gtx_grid *grid, uint32_t height_bits, size_t row_texels, void *out)
{
    const size_t code_size = height_bits / 8, cells_x = grid->nodes_x - 1;
    for (size_t j = 0; j + 1 < grid->nodes_y; ++j) {
        const uint16_t *row = grid->code + j * grid->nodes_x, *next = row + grid->nodes_x;
        uint8_t *texel = (uint8_t *)out + j * row_texels * 4 * code_size;
        for (size_t i = 0; i < cells_x; ++i, texel += 4 * code_size) {
            const uint16_t corner[4] = {row[i], row[i + 1], next[i], next[i + 1]};
            if (!grid->solid[j * cells_x + i])
                memset(texel, 0, 4 * code_size);
            else if (code_size == 2)
                memcpy(texel, corner, sizeof corner);
            else
                for (int k = 0; k < 4; ++k)
                    texel[k] = (uint8_t)corner[k];
        }
    }
}

/* The height of a level's sheet over texel (x, y), in codes. */
static double height_at(const gtx_grid *grid, const gtx_patch *patch, uint32_t x, uint32_t y)
{
    const uint32_t last[2] = {patch->rect[2] - 1u, patch->rect[3] - 1u}, at[2] = {x, y};
    const uint32_t cells[2] = {grid->nodes_x - 1, grid->nodes_y - 1};
    uint32_t cell[2];
    double f[2];
    for (int a = 0; a < 2; ++a) {
        cell[a] = at[a] >> grid->level < cells[a] ? at[a] >> grid->level : cells[a] - 1;
        const uint32_t low = cell[a] << grid->level, step = 1u << grid->level;
        f[a] = (double)(at[a] - low) / (low + step < last[a] ? step : last[a] - low);
    }
    const uint16_t *row = grid->code + (size_t)cell[1] * grid->nodes_x + cell[0];
    const uint16_t *next = row + grid->nodes_x;
    return (1 - f[1]) * ((1 - f[0]) * row[0] + f[0] * row[1]) +
           f[1] * ((1 - f[0]) * next[0] + f[0] * next[1]);
}

/* The difference of two bilinear sheets is greatest at a corner of the finer cells. */
static double greatest_difference(const gtx_asset *asset, const gtx_patch *patch,
                                  const gtx_grid *grid)
{
    double greatest = 0;
    for (uint32_t y = 0; y + 1 < patch->rect[3]; ++y)
        for (uint32_t x = 0; x + 1 < patch->rect[2]; ++x) {
            uint32_t corner[4];
            for (uint32_t k = 0; k < 4; ++k)
                corner[k] = gtx_height_code(asset, patch, x + (k & 1), y + (k >> 1));
            if (!corner[0] || !corner[1] || !corner[2] || !corner[3])
                continue;
            for (uint32_t k = 0; k < 4; ++k)
                greatest = fmax(greatest, fabs(height_at(grid, patch, x + (k & 1), y + (k >> 1)) -
                                               corner[k]));
        }
    return greatest;
}

double gtx_grid_error(const gtx_asset *asset, uint32_t patch, const gtx_grid *grid)
{
    const gtx_patch *p = &asset->patches[patch];
    if (grid->level == 0)
        return 0;
    const double steps = asset->info.height_bits == 8 ? 254 : 65534;
    const double pitch = fmax(p->extent_x / (double)p->rect[2], p->extent_y / (double)p->rect[3]);
    const double overhang = 0.3 * ((1u << grid->level) - 1) * pitch;
    return fmax(greatest_difference(asset, p, grid) * p->extent_z / steps, overhang);
}
