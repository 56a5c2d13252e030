/* Height grids -> the maps of one asset, tile by tile, without a mesh between. */
#pragma once

#include "bake/bake.hpp"
#include "grid/grid.hpp"

namespace gtx {

/* One surface: heights in object units along +Y, and colours. */
struct GridLayer {
    const HeightGrid *heights;
    Vector<std::array<uint8_t, 3>> colors;      /* sRGB, a node each; empty: none has any */
};

struct TileOptions {
    BakeOptions bake;
    unsigned tile = 128;     /* most texels along a side, 16..512 */
    double vertical = 1;     /* what heights are multiplied by; negative: they are depths */
};

struct TileReport {
    uint64_t nodes = 0, triangles = 0; /* nodes with a value; two triangles a whole cell */
    double rms = 0, max = 0;           /* how far codes are from the values, object units */
};

/* The grid's x goes along +X, its y along -Z. Large grids are cut into tiles, each with a step of
 * heights of its own that fits its relief: the common nodes of neighbours are rounded to the
 * coarser of their steps, so that both have them at the same height. A tile reaches a texel beyond
 * its border. Normals follow from the values at full precision. The height fields are seen from
 * both sides. Deterministic for any thread count. Stages of `task`: "bake", "pack".
 * Throws Error: INPUT, EMPTY, LIMIT. */
Maps bake_tiles(const Vector<GridLayer> &layers, const TileOptions &options,
                TileReport &report, Task &task);

} // namespace gtx
