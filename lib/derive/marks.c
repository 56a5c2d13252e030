/* Networks of right triangles: where there are cells and they show, and over which triangles
 * normals and colours are what those of the corners make, so that what they look like there is
 * enough. */
#include "derive/rtin.h"

#include "asset/patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = GTX_RTIN_CELLS };

/* Normals and colours may be so far from what corners make, in codes of 8 bits, of which one is
 * 0.8 % of a unit normal. In ten near views of a bunny grids take 7 % longer at half and 2 % less
 * at double. */
static const float tolerance = 3;

/* A map of a patch's level 0. */
typedef struct texel_map {
    const uint8_t *first;
    size_t row;               /* bytes */
    uint32_t channels;
} texel_map;

/* Normals and colours, and sums of how far they stray, of each node. */
typedef struct search {
    texel_map maps[2];
    uint32_t map_count;
    uint32_t width, height;   /* texels */
    gtx_rtin *rtin;
    const gtx_rtin_node *nodes;
    float *sum;
} search;

/* Half of the longest side that the node is the middle of. */
typedef struct side {
    int32_t x, y;
} side;

static side side_of(uint32_t level, int32_t half, int32_t x, int32_t y)
{
    if (level % 2)
        return y / half % 2 ? (side){0, half} : (side){half, 0};
    const bool other = level && (x / (2 * half) + y / (2 * half)) % 2;
    return (side){other ? -half : half, half};
}

/* How far a texel is from the mean of those at the ends of a side, where channels differ most. */
static int surplus_in(const texel_map *map, side of, int32_t x, int32_t y)
{
    const ptrdiff_t channels = map->channels;
    const uint8_t *m = map->first + (size_t)y * map->row + (size_t)(x * channels);
    const ptrdiff_t away = of.y * (ptrdiff_t)map->row + of.x * channels;
    int most = 0;
    for (ptrdiff_t k = 0; k < channels; ++k) {
        const int here = abs(2 * m[k] - m[k + away] - m[k - away]);
        most = here > most ? here : most;
    }
    return most;
}

static float surplus(const search *s, side of, int32_t x, int32_t y)
{
    if ((uint32_t)(x + abs(of.x)) >= s->width || (uint32_t)(y + of.y) >= s->height)
        return 0;
    int most = 0;
    for (uint32_t k = 0; k < s->map_count; ++k) {
        const int here = surplus_in(&s->maps[k], of, x, y);
        most = here > most ? here : most;
    }
    return 0.5f * (float)most;
}

/* Of the middles of a level: the surplus and the greatest sum of their halves' middles, as errors
 * are gathered. */
static void gather(const search *s, uint32_t level)
{
    static const int32_t around[2][4][2] = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}},
                                            {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
    const int32_t odd = level & 1, half = CELLS >> (level / 2 + 1), away = odd ? half / 2 : half;
    const int32_t width = (int32_t)gtx_rtin_row(s->rtin);
    const int32_t height = (int32_t)s->rtin->rows * CELLS + 1;
    for (int32_t y = odd ? 0 : half; y < height; y += odd ? half : 2 * half)
        for (int32_t x = odd && y / half % 2 ? 0 : half; x < width; x += 2 * half) {
            const int32_t own = y * width + x;
            float most = 0;
            for (int k = 0; level + 1 < GTX_RTIN_LEVELS && k < 4; ++k) {
                const int32_t i = x + away * around[odd][k][0], j = y + away * around[odd][k][1];
                if (i < 0 || j < 0 || i >= width || j >= height || s->sum[j * width + i] <= 0)
                    continue;
                const int32_t rise = abs(s->nodes[own].code - s->nodes[j * width + i].code);
                most = fmaxf(most, s->sum[j * width + i]);
                if (rise > s->rtin->rise[level])
                    s->rtin->rise[level] = (uint16_t)rise;
            }
            s->sum[own] = most + surplus(s, side_of(level, half, x, y), x, y);
        }
}

static void find_outline(const gtx_grid *finest, const uint8_t *trim, size_t row_texels,
                         uint32_t row, gtx_rtin_node *nodes)
{
    const uint8_t limit = (uint8_t)gtx_trim_limit(0);
    const uint32_t cells = finest->nodes_x - 1;
    for (uint32_t y = 0; y < finest->nodes_y; ++y)
        for (uint32_t x = 0; x <= cells; ++x) {
            const bool is_cell = x < cells && y + 1 < finest->nodes_y;
            uint16_t *bits = &nodes[(size_t)y * row + x].bits;
            *bits |= trim[y * row_texels + x] <= limit ? GTX_RTIN_WITHIN : 0;
            *bits |= is_cell && finest->solid[(size_t)y * cells + x] ? GTX_RTIN_SOLID : 0;
        }
}

static void find_rough(const search *s, size_t count, gtx_rtin_node *nodes)
{
    memset(s->sum, 0, count * sizeof *s->sum);
    for (uint32_t level = GTX_RTIN_LEVELS; level-- > 0;)
        gather(s, level);
    for (size_t i = 0; i < count; ++i)
        nodes[i].bits |= s->sum[i] > tolerance ? GTX_RTIN_ROUGH : 0;
}

void gtx_rtin_mark(const gtx_asset *asset, uint32_t patch, const gtx_grid *finest, gtx_rtin *rtin,
                   gtx_rtin_node *nodes, float *scratch)
{
    const gtx_info *info = &asset->info;
    const gtx_patch *p = &asset->patches[patch];
    const size_t row = info->page_width;
    const size_t first = ((size_t)p->page * info->page_height + p->rect[1]) * row + p->rect[0];
    search s = {{{asset->normal[0] + 2 * first, 2 * row, 2}}, 1, p->rect[2], p->rect[3], rtin,
                nodes, scratch};
    if (info->has_color)
        s.maps[s.map_count++] = (texel_map){asset->color[0] + 4 * first, 4 * row, 4};
    find_outline(finest, asset->trim + first, row, gtx_rtin_row(rtin), nodes);
    if (!info->has_material && !info->has_emission)
        find_rough(&s, gtx_rtin_nodes(p), nodes);
}
