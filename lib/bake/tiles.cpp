/* Height grids cut into tiles that agree where they meet. */
#include "bake/tiles.hpp"
#include "base/exact.h"

#include "bake/field/shade.hpp"
#include "bake/pages.hpp"
#include "mesh/material/srgb.hpp"

#include <algorithm>

namespace gtx::baking {

/* Steps of heights are halves of halves of the coarsest, so often at most: a limit,
 * half changes a few bytes. */
constexpr int MAX_HALVINGS = 12;
/* Turns of a short loop, that take as long as a node. */
constexpr size_t NODE_TURNS = 64;

/* Nodes of a layer: from..to are the tile's own, borders included; low..high are stored. */
struct Tile {
    uint32_t layer;
    int from[2], to[2], low[2], high[2];
    int halvings = 0;            /* of the layer's coarsest step */
    double bottom = 0, top = 0;  /* of its rounded heights */
    bool whole_cells = false;
};

/* A layer while it is cut: heights, and what they are rounded to. */
struct LayerHeights {
    const HeightGrid *grid;
    double vertical, step;       /* step: the coarsest */
    Vector<uint8_t> halvings;      /* of a node's step: the coarsest of the tiles that have it */

    bool has(int i, int j) const
    {
        return i >= 0 && j >= 0 && i < int(grid->nx) && j < int(grid->ny) &&
               !std::isnan(grid->at(uint32_t(i), uint32_t(j)));
    }
    double height(int i, int j) const { return vertical * grid->at(uint32_t(i), uint32_t(j)); }
    double rounded(int i, int j) const
    {
        const double to = std::ldexp(step, -int(halvings[size_t(j) * grid->nx + i]));
        return std::floor(height(i, j) / to + 0.5) * to;
    }
    bool has_cell(int i, int j) const
    {
        return has(i, j) && has(i + 1, j) && has(i, j + 1) && has(i + 1, j + 1);
    }
};

/* Cuts the grid evenly into as few tiles as the side allows. */
static void cut(const LayerHeights &layer, uint32_t index, unsigned side, Vector<Tile> &tiles)
{
    const int size[2] = {int(layer.grid->nx), int(layer.grid->ny)};
    int count[2];
    for (int k = 0; k < 2; ++k)
        count[k] = std::max(1, (size[k] - 1 + int(side) - 4) / (int(side) - 3));
    for (int y = 0; y < count[1]; ++y)
        for (int x = 0; x < count[0]; ++x) {
            Tile tile = {};
            tile.layer = index;
            const int at[2] = {x, y};
            for (int k = 0; k < 2; ++k) {
                tile.from[k] = int(int64_t(size[k] - 1) * at[k] / count[k]);
                tile.to[k] = int(int64_t(size[k] - 1) * (at[k] + 1) / count[k]);
                tile.low[k] = std::max(tile.from[k] - 1, 0);
                tile.high[k] = std::min(tile.to[k] + 1, size[k] - 1);
            }
            for (int j = tile.from[1]; j < tile.to[1] && !tile.whole_cells; ++j)
                for (int i = tile.from[0]; i < tile.to[0] && !tile.whole_cells; ++i)
                    tile.whole_cells = layer.has_cell(i, j);
            if (tile.whole_cells)
                tiles.push_back(tile);
        }
}

/* Calls with every node of the tile that has a value. */
template <class Body> static void for_nodes(const Tile &tile, const LayerHeights &layer, Body body)
{
    for (int j = tile.low[1]; j <= tile.high[1]; ++j)
        for (int i = tile.low[0]; i <= tile.high[0]; ++i)
            if (layer.has(i, j))
                body(i, j);
}

static void find_range(const LayerHeights &layer, bool rounded, Tile &tile)
{
    tile.bottom = INFINITY;
    tile.top = -INFINITY;
    for_nodes(tile, layer, [&](int i, int j) {
        const double height = rounded ? layer.rounded(i, j) : layer.height(i, j);
        tile.bottom = std::min(tile.bottom, height);
        tile.top = std::max(tile.top, height);
    });
}

/* Texels of a rectangle of so many nodes: all of its mip levels are whole. */
static int to_grain(int nodes, const TileOptions &options)
{
    const int grain = 1 << (options.bake.mips - 1);
    return (nodes + grain - 1) / grain * grain;
}

/* Gives each tile the finest step that its codes can tell its relief in once nodes are rounded to
 * the steps of all tiles that have them. A layer's first tile is tiles[0]. */
static void choose_steps(Vector<Tile *> &tiles, const TileOptions &options,
                         LayerHeights &layer, Task &task)
{
    const double top = gtx_height_steps(options.bake.height_bits);
    auto ranges = [&](bool rounded) {
        task.parallel(tiles.size(), [&](size_t t) { find_range(layer, rounded, *tiles[t]); }, 0, 0);
    };
    ranges(false);
    double most = 0, side = 0;
    for (const Tile *tile : tiles)
        most = std::max(most, tile->top - tile->bottom);
    for (double pitch : layer.grid->step)
        side = std::max(side, pitch * to_grain(int(options.tile), options));
    const double least = side / 4096 / top; /* a patch is never flatter than that */
    layer.step = std::max(most / (top - 2), least);
    for (Tile *tile : tiles) {
        const double range = std::max(tile->top - tile->bottom, least);
        tile->halvings = std::clamp(int(std::floor(gtx_log2(layer.step * (top - 2) / range))), 0,
                                    std::min(MAX_HALVINGS,
                                             int(std::floor(gtx_log2(layer.step / least)))));
    }
    for (bool again = true; again;) {
        layer.halvings.assign(layer.grid->count(), MAX_HALVINGS);
        for (const Tile *tile : tiles)
            for_nodes(*tile, layer, [&](int i, int j) {
                uint8_t &node = layer.halvings[size_t(j) * layer.grid->nx + i];
                node = std::min<uint8_t>(node, uint8_t(tile->halvings));
            });
        ranges(true);
        again = false;
        for (Tile *tile : tiles) {
            const double step = std::ldexp(layer.step, -tile->halvings);
            if (tile->halvings && (tile->top - tile->bottom) / step > top + 0.5) {
                --tile->halvings;
                again = true;
            }
        }
    }
}

/* ---- the maps of a tile ---- */

/* The frame of all tiles of a grid: along x, along y, up. */
struct GridFrame {
    Vec3d x, y, z{0, 1, 0};

    explicit GridFrame(const HeightGrid &grid)
    {
        const double turn = grid.rotation * std::acos(-1.0) / 180;
        x = {gtx_cos(turn), 0, -gtx_sin(turn)};
        y = {-gtx_sin(turn), 0, -gtx_cos(turn)};
    }
};

static Vec3f normal_at(const LayerHeights &layer, const GridFrame &frame, int i, int j)
{
    double slope[2];
    for (int k = 0; k < 2; ++k) {
        const int dx = k == 0, dy = k == 1;
        const bool before = layer.has(i - dx, j - dy), after = layer.has(i + dx, j + dy);
        const double low = before ? layer.height(i - dx, j - dy) : layer.height(i, j);
        const double high = after ? layer.height(i + dx, j + dy) : layer.height(i, j);
        slope[k] = (high - low) / (std::max(1, before + after) * layer.grid->step[k]);
    }
    return Vec3f(normalize(frame.z - frame.x * slope[0] - frame.y * slope[1]));
}

/* A border between tiles is an outline; one of the grid is none, for nothing is beyond. */
static float outside(const Tile &tile, const HeightGrid &grid, int i, int j)
{
    const int at[2] = {i, j}, size[2] = {int(grid.nx), int(grid.ny)};
    double most = -INFINITY;
    for (int k = 0; k < 2; ++k) {
        if (tile.from[k] > 0)
            most = std::max(most, double(tile.from[k] - at[k]));
        if (tile.to[k] < size[k] - 1)
            most = std::max(most, double(at[k] - tile.to[k]));
    }
    return float(most - CUT_OVERLAP);
}

static gtx_patch make_record(const Tile &tile, const LayerHeights &layer, const Vec3d &anchor,
                             const TileOptions &options)
{
    const HeightGrid &grid = *layer.grid;
    const GridFrame frame(grid);
    gtx_patch record = {};
    for (int k = 0; k < 2; ++k)
        record.rect[2 + k] = uint16_t(to_grain(tile.high[k] - tile.low[k] + 1, options));
    const std::array<double, 2> corner = grid.place(tile.low[0] - 0.5, tile.low[1] - 0.5);
    store(record.origin, Vec3d(corner[0], tile.bottom, -corner[1]) - anchor);
    store(record.axis_x, frame.x);
    store(record.axis_y, frame.y);
    store(record.axis_z, frame.z);
    record.extent_x = float(record.rect[2] * grid.step[0]);
    record.extent_y = float(record.rect[3] * grid.step[1]);
    record.extent_z = float(std::ldexp(layer.step, -tile.halvings) *
                            gtx_height_steps(options.bake.height_bits));
    const unsigned dilation = options.bake.dilation;
    record.dilation = uint16_t(dilation ? dilation : 1u << (options.bake.mips - 1));
    record.flags = GTX_PATCH_TWO_SIDED;
    for (int j = tile.from[1]; j < tile.to[1]; ++j)
        for (int i = tile.from[0]; i < tile.to[0]; ++i)
            record.source_triangles += 2 * layer.has_cell(i, j);
    return record;
}

/* The sum of squared roundings, and the greatest. */
struct Rounding {
    double squares = 0, most = 0;
    uint64_t nodes = 0;
};

static PatchMaps bake_tile(const Tile &tile, const LayerHeights &layer, const GridLayer &source,
                           const Vec3d &anchor, const TileOptions &options, Rounding &rounding)
{
    PatchMaps maps;
    maps.record = make_record(tile, layer, anchor, options);
    const int w = maps.record.rect[2], h = maps.record.rect[3];
    const double step = std::ldexp(layer.step, -tile.halvings);
    const GridFrame frame(*layer.grid);
    AppearanceNeeds needs;
    needs.color = !source.colors.empty();
    Shades shades(w, h, needs.color ? COLOR_CHANNELS : 0);
    maps.height.assign(size_t(w) * h, 0);
    maps.trim.assign(maps.height.size(), 255);
    cancel_point(NODE_TURNS * maps.height.size());
    for_nodes(tile, layer, [&](int i, int j) {
        const size_t at = size_t(j - tile.low[1]) * w + size_t(i - tile.low[0]);
        const double height = layer.rounded(i, j);
        maps.height[at] =
            uint16_t(gtx_nearest_code((height - tile.bottom) / step, options.bake.height_bits));
        maps.trim[at] = trim_code(outside(tile, *layer.grid, i, j));
        shades.occupied[at] = 1;
        shades.normal[at] = normal_at(layer, frame, i, j);
        if (needs.color) {
            const auto &rgb = source.colors[size_t(j) * layer.grid->nx + i];
            float *to = &shades.values[at * COLOR_CHANNELS];
            for (int c = 0; c < 3; ++c)
                to[c] = srgb_to_linear(rgb[c]);
            to[3] = 1;
        }
        const double off = height - layer.height(i, j);
        rounding.squares += off * off;
        rounding.most = std::max(rounding.most, std::fabs(off));
        ++rounding.nodes;
    });
    fill_trim(maps);
    measure_patch(options.bake.height_bits, maps);
    build_mips(std::move(shades), options.bake.mips, needs, maps);
    return maps;
}

static Vec3d anchor_of(const Vector<LayerHeights> &layers, const Vector<Tile> &tiles)
{
    Vec3d low(INFINITY, INFINITY, INFINITY), high = -low;
    for (const Tile &tile : tiles)
        for (int k = 0; k < 8; ++k) {
            const auto corner = layers[tile.layer].grid->place(k & 1 ? tile.to[0] : tile.from[0],
                                                               k & 2 ? tile.to[1] : tile.from[1]);
            const Vec3d p(corner[0], k & 4 ? tile.top : tile.bottom, -corner[1]);
            for (int a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], p[a]);
                high[a] = std::max(high[a], p[a]);
            }
        }
    return find_anchor(low, high, "the grids are");
}

} // namespace gtx::baking

namespace gtx {

using namespace baking;

static void check(const Vector<GridLayer> &layers, const TileOptions &options)
{
    if (options.tile < 16 || options.tile > 512)
        throw Error(GTX_ERROR_ARGUMENT, "a tile has 16 to 512 texels along a side");
    if (!(std::fabs(options.vertical) > 0 && std::fabs(options.vertical) < 1e9))
        throw Error(GTX_ERROR_ARGUMENT, "the vertical factor is 0 or not finite");
    for (const GridLayer &layer : layers) {
        const HeightGrid &grid = *layer.heights;
        if (grid.nx < 2 || grid.ny < 2)
            throw Error(GTX_ERROR_INPUT, "a grid of " + std::to_string(grid.nx) + " x " +
                                             std::to_string(grid.ny) +
                                             " nodes is no surface: it takes 2 x 2 at least");
        if (std::max(grid.nx, grid.ny) > MAX_SIDE || grid.values.size() != grid.count())
            throw Error(GTX_ERROR_LIMIT, "a grid has more than 2^24 nodes along a side");
    }
}

Maps bake_tiles(const Vector<GridLayer> &layers, const TileOptions &options,
                TileReport &report, Task &task)
{
    check(layers, options);
    task.begin("bake");
    Vector<LayerHeights> heights;
    Vector<Tile> tiles;
    for (uint32_t n = 0; n < layers.size(); ++n) {
        const HeightGrid *grid = layers[n].heights;
        heights.push_back({grid, options.vertical, 0, {}});
        const size_t first = tiles.size();
        cut(heights[n], n, options.tile, tiles);
        if (tiles.size() == first)
            throw Error(GTX_ERROR_EMPTY, "a grid has no four neighbouring nodes with values");
        Vector<Tile *> own;
        for (size_t t = first; t < tiles.size(); ++t)
            own.push_back(&tiles[t]);
        choose_steps(own, options, heights[n], task);
    }
    const Vec3d anchor = anchor_of(heights, tiles);
    Vector<PatchMaps> patches(tiles.size());
    Vector<Rounding> rounding(tiles.size());
    task.parallel(tiles.size(), [&](size_t t) {
        const uint32_t n = tiles[t].layer;
        patches[t] = bake_tile(tiles[t], heights[n], layers[n], anchor, options, rounding[t]);
    });
    double squares = 0;
    uint64_t nodes = 0;
    for (size_t t = 0; t < tiles.size(); ++t) {
        squares += rounding[t].squares;
        nodes += rounding[t].nodes;
        report.max = std::max(report.max, rounding[t].most);
        report.triangles += patches[t].record.source_triangles;
    }
    report.rms = std::sqrt(squares / double(nodes));
    for (const GridLayer &layer : layers)
        for (float value : layer.heights->values)
            report.nodes += !std::isnan(value);

    task.begin("pack");
    Maps maps = place_on_pages(patches, anchor, options.bake, task.limits);
    for (uint32_t t = 0; t < tiles.size(); ++t)
        maps.charts.push_back(t);
    return maps;
}

} // namespace gtx
