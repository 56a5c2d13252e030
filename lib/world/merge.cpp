/* The step that merges the simplified surfaces of a tile's children. */
#include "world/surface.hpp"

#include <algorithm>

namespace gtx {

/* A whole file that was made from these. */
static bool is_there(const Plan &plan, const Tile &tile, uint64_t key)
{
    try {
        return CellReader(cell_path(plan, tile)).header().key == key;
    } catch (const Error &) {
        return false;
    }
}

static uint64_t key_of(const Plan &plan, const Tile &tile)
{
    gtx_hash hash;
    gtx_hash_begin(&hash);
    gtx_hash_add(&hash, &plan.triangles, sizeof plan.triangles);
    for (uint32_t child : tile.children) {
        const CellHeader header = CellReader(low_path(plan, plan.tiles[child])).header();
        gtx_hash_add(&hash, &header.hash, sizeof header.hash);
        gtx_hash_add(&hash, &header.deviation, sizeof header.deviation);
    }
    return gtx_hash_end(&hash);
}

static CellWriter joined(const Plan &plan, const Tile &tile)
{
    CellWriter out(low_traits(plan.traits));
    for (uint32_t child : tile.children) {
        CellReader cell(low_path(plan, plan.tiles[child]));
        Corners3 corners;
        while (cell.next(corners))
            out.add(corners);
        out.header.deviation = std::max(out.header.deviation, cell.header().deviation);
    }
    return out;
}

StepReport merge_tile(const std::string &folder, const std::string &name, Task &task)
{
    task.begin("read");
    const Plan plan = read_plan(folder, task);
    const Tile &tile = plan.tile(name);
    if (tile.is_leaf())
        throw Error(GTX_ERROR_ARGUMENT, "the tile '" + name + "' is a leaf, which split makes");
    const uint64_t key = key_of(plan, tile);
    const std::string path = cell_path(plan, tile);
    const bool unchanged = is_there(plan, tile, key);
    if (!unchanged) {
        CellWriter cell = joined(plan, tile);
        if (cell.header.count > plan.triangles) { /* borders took more than their share */
            write_whole(path, cell.finish()); /* without a key: it is nobody's yet */
            const TileSurface surface = load_cell(path);
            NearSurface near(surface, task);
            cell = simplify_surface(surface, near, plan.triangles, task).cell;
        }
        cell.header.key = key;
        write_whole(path, cell.finish());
    }
    task.end();
    return {std::to_string(CellReader(path).header().count) + " triangles of " +
                std::to_string(tile.children.size()) + " tiles", unchanged};
}

} // namespace gtx
