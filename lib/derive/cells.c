/* What kernels on the GPU take of a level: corner cells, the four codes of a cell in one texel, and
 * how far the level's sheet lies from the finest one. */
#include "derive/derive.h"

#include <math.h>
#include <stdbool.h>
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

/* A level's sheet over texel (x, y): its height in codes, and its slopes in codes a texel. */
typedef struct gtx_surface {
    double z, dx, dy;
} gtx_surface;

static gtx_surface surface_at(const gtx_grid *grid, const gtx_patch *patch, uint32_t x, uint32_t y)
{
    const uint32_t last[2] = {patch->rect[2] - 1u, patch->rect[3] - 1u}, at[2] = {x, y};
    const uint32_t cells[2] = {grid->nodes_x - 1, grid->nodes_y - 1};
    uint32_t cell[2];
    double f[2], width[2];
    for (int a = 0; a < 2; ++a) {
        cell[a] = at[a] >> grid->level < cells[a] ? at[a] >> grid->level : cells[a] - 1;
        const uint32_t low = cell[a] << grid->level, step = 1u << grid->level;
        width[a] = low + step < last[a] ? step : last[a] - low;
        f[a] = (at[a] - low) / width[a];
    }
    const uint16_t *row = grid->code + (size_t)cell[1] * grid->nodes_x + cell[0];
    const uint16_t *next = row + grid->nodes_x;
    const double low = (1 - f[0]) * row[0] + f[0] * row[1];
    const double high = (1 - f[0]) * next[0] + f[0] * next[1];
    const double dx = (1 - f[1]) * (row[1] - row[0]) + f[1] * (next[1] - next[0]);
    return (gtx_surface){(1 - f[1]) * low + f[1] * high, dx / width[0], (high - low) / width[1]};
}

/* Whether texel (x, y) is a corner of a solid cell of level 0. */
static bool is_corner(const gtx_grid *finest, uint32_t x, uint32_t y)
{
    const uint32_t width = finest->nodes_x - 1, height = finest->nodes_y - 1;
    for (uint32_t j = y ? y - 1 : 0; j <= y && j < height; ++j)
        for (uint32_t i = x ? x - 1 : 0; i <= x && i < width; ++i)
            if (finest->solid[(size_t)j * width + i])
                return true;
    return false;
}

/* Of a code along the frame's Z in object space, square to the sheet: the share of the step that
 * leads away from the plane of its tangents. */
static double square_to(const gtx_surface *s, const double step[3], const gtx_patch *p)
{
    double u[3], v[3], along = 0, length = 0;
    for (int k = 0; k < 3; ++k) {
        u[k] = step[0] * p->axis_x[k] + s->dx * step[2] * p->axis_z[k];
        v[k] = step[1] * p->axis_y[k] + s->dy * step[2] * p->axis_z[k];
    }
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const double n = u[a] * v[b] - u[b] * v[a];
        along += n * p->axis_z[k];
        length += n * n;
    }
    return fabs(along) * step[2] / sqrt(length);
}

/* From a texel inside the outline on, distances count this many times: neighbours drawn at levels
 * of their own part by the sum of their errors. */
static const double border_counts = 4;
static const uint32_t border_code = 128 - 16;

double gtx_grid_error(const gtx_asset *asset, uint32_t patch, const gtx_grid *finest,
                      const gtx_grid *grid)
{
    const gtx_patch *p = &asset->patches[patch];
    const double step[3] = {(double)p->extent_x / p->rect[2], (double)p->extent_y / p->rect[3],
                            p->extent_z / (asset->info.height_bits == 8 ? 254.0 : 65534.0)};
    /* What the wider limit of the trim lets stick out. */
    double greatest = 0.3 * ((1u << grid->level) - 1) * fmax(step[0], step[1]);
    /* The difference of two bilinear sheets is greatest at a corner of the finer cells. */
    for (uint32_t y = 0; y < finest->nodes_y; ++y)
        for (uint32_t x = 0; x < finest->nodes_x; ++x) {
            const gtx_surface s = surface_at(grid, p, x, y);
            const bool border = gtx_trim_code(asset, p, x, y) > border_code;
            const double codes = fabs(s.z - finest->code[(size_t)y * finest->nodes_x + x]) *
                                 (border ? border_counts : 1);
            /* or it cannot be greater square to the sheet */
            if (codes * step[2] > greatest && is_corner(finest, x, y))
                greatest = fmax(greatest, codes * square_to(&s, step, p));
        }
    return greatest;
}
