/* Networks of right triangles: which cells exist and are inside the trim, and over which triangles
 * the maps are close enough to the interpolation of the corners. */
#include "derive/rtin.h"

#include "asset/patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = GTX_RTIN_CELLS };

/* Maps may be so far from what corners make, in codes of 8 bits, of which one is
 * 0.8 % of a unit normal. In ten near views of a bunny grids take 7 % longer at half and 2 % less
 * at double. */
static const float tolerance = 3;

/* The brightest highlight of a patch that is lit at its corners, of what a white wall shows; what
 * is brighter may hide between them. Without metal that is a roughness of 0.5. In a hall of that
 * (samples/sculpt) PSNR to 2x2 samples is 34.6 dB instead of 34.9 by maps; at double, of 0.4, 31.9
 * instead of 32.4. At half it is by maps, which take 2.5 times as long. */
static const float most_gloss = 0.16f;

/* A map of a patch's level 0. */
typedef struct texel_map {
    const uint8_t *first;
    size_t row;               /* bytes */
    uint32_t channels;
} texel_map;

/* Maps, the first of which are normals, and sums of how far they stray, of each node. */
typedef struct search {
    texel_map maps[4];
    uint32_t map_count;
    uint32_t width, height;   /* texels */
    gtx_rtin *rtin;
    const gtx_rtin_node *nodes;
    float *sum;
    float bend;               /* of highlights, by the square of how normals turn, in codes */
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

/* How much darker a highlight in the middle of a side may be as its ends have it, in codes of 8
 * bits. */
static float highlight_in(const search *s, side of, int32_t x, int32_t y)
{
    const texel_map *map = &s->maps[0];
    const uint8_t *m = map->first + (size_t)y * map->row + (size_t)x * 2;
    const ptrdiff_t away = of.y * (ptrdiff_t)map->row + of.x * 2;
    const int turn[2] = {m[away] - m[-away], m[away + 1] - m[1 - away]};
    return s->bend * (float)(turn[0] * turn[0] + turn[1] * turn[1]);
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
    return 0.5f * (float)most + (s->bend > 0 ? highlight_in(s, of, x, y) : 0);
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
            s->sum[own] += most + surplus(s, side_of(level, half, x, y), x, y);
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

/* Of 2x2 cells only a part of which shows, all triangles are rough: outlines cross halves of cells
 * alone, others of which need no map, nor those of which all shows the trim. */
static void start_at_outline(const search *s, const gtx_rtin_node *nodes)
{
    const size_t row = gtx_rtin_row(s->rtin);
    for (size_t y = 0; y < s->rtin->rows * CELLS; y += 2)
        for (size_t x = 0; x + 1 < row; x += 2) {
            const size_t middle = (y + 1) * row + x + 1;
            uint32_t some = 0, whole = GTX_RTIN_SOLID | GTX_RTIN_WITHIN;
            for (size_t k = 0; k < 9; ++k) {
                const uint32_t bits = nodes[(y + k / 3) * row + x + k % 3].bits;
                const bool cell = k / 3 < 2 && k % 3 < 2;
                some |= cell ? bits : 0;
                whole &= cell ? bits : bits | GTX_RTIN_SOLID;
            }
            if (!(some & GTX_RTIN_SOLID) || whole == (GTX_RTIN_SOLID | GTX_RTIN_WITHIN))
                continue;
            s->sum[middle - row] = s->sum[middle - 1] = s->sum[middle] = s->sum[middle + 1] =
                s->sum[middle + row] = 2 * tolerance;
        }
}

static void find_rough(const search *s, size_t count, gtx_rtin_node *nodes)
{
    memset(s->sum, 0, count * sizeof *s->sum);
    start_at_outline(s, nodes);
    for (uint32_t level = GTX_RTIN_LEVELS; level-- > 0;)
        gather(s, level);
    for (size_t i = 0; i < count; ++i)
        nodes[i].bits |= s->sum[i] > tolerance ? GTX_RTIN_ROUGH : 0;
}

/* Looks for the brightest highlight, of materials as geotex_material.glsl has them, and for the one
 * that bends most. One is f0 / 4 a^2 where a is the square of the roughness, by (1 + x^2 / a^2)^-2
 * at a slope of x: between ends that lie `turn` apart a line is off by f0 turn^2 / 8 a^4. */
static void find_highlights(search *s, gtx_rtin *rtin)
{
    const texel_map *map = &s->maps[s->map_count - 1];
    float most = 0;
    for (uint32_t y = 0; y < s->height; ++y)
        for (uint32_t x = 0; x < s->width; ++x) {
            const uint8_t *m = map->first + y * map->row + (size_t)x * map->channels;
            const float rough = fmaxf((float)m[1] / 255, 0.05f), a2 = rough * rough * rough * rough;
            const float f0 = (0.04f + 0.96f * (float)m[2] / 255) * (float)m[3] / 255;
            most = fmaxf(most, f0 / (4 * a2));
            s->bend = fmaxf(s->bend, f0 / (8 * a2 * a2) * 255 / (127 * 127));
        }
    rtin->glossy = most > most_gloss;
}

/* Of every fifth node, so that all levels have their share: looking at all takes a 25th of the time
 * in which a model is prepared. */
static void count_halved(gtx_rtin *rtin, const gtx_rtin_node *nodes, size_t count)
{
    enum { EVERY = 5 };
    for (size_t i = 0; i < count; i += EVERY) {
        const uint32_t error = nodes[i].bits & GTX_RTIN_MAX_ERROR;
        const uint32_t upper = 7 * (error > 127), rest = error >> upper;
        if (error && nodes[i].bits & GTX_RTIN_WITHIN)
            rtin->halved[upper + (rest > 1) + (rest > 3) + (rest > 7) + (rest > 15) +
                         (rest > 31) + (rest > 63)] += EVERY;
    }
    for (uint32_t k = GTX_RTIN_ERRORS - 1; k-- > 0;)
        rtin->halved[k] += rtin->halved[k + 1];
}

void gtx_rtin_mark(const gtx_rtin_source *source, gtx_rtin *rtin, gtx_rtin_node *nodes,
                   float *scratch)
{
    const gtx_asset *asset = source->asset;
    const gtx_info *info = &asset->info;
    const gtx_patch *p = &asset->patches[source->patch];
    const size_t row = info->page_width;
    const size_t first = ((size_t)p->page * info->page_height + p->rect[1]) * row + p->rect[0];
    search s = {{{asset->normal[0] + 2 * first, 2 * row, 2}}, 1, p->rect[2], p->rect[3], rtin,
                nodes, scratch, 0};
    if (info->has_color)
        s.maps[s.map_count++] = (texel_map){asset->color[0] + 4 * first, 4 * row, 4};
    if (info->has_emission)
        s.maps[s.map_count++] = (texel_map){asset->emission[0] + 3 * first, 3 * row, 3};
    if (info->has_material) {
        s.maps[s.map_count++] = (texel_map){asset->material[0] + 4 * first, 4 * row, 4};
        find_highlights(&s, rtin);
    }
    find_outline(source->finest, asset->trim + first, row, gtx_rtin_row(rtin), nodes);
    if (!rtin->glossy)
        find_rough(&s, gtx_rtin_nodes(p), nodes);
    count_halved(rtin, nodes, gtx_rtin_nodes(p));
}
