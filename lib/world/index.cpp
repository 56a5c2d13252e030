/* The last step, once every tile is there: tileset.json (OGC 3D Tiles 1.1), and tiles.gtw
 * (format/world.md). */
#include "world/facts.hpp"

#include "cook/report.hpp"
#include "stream/index.h"

#include <algorithm>
#include <cmath>

namespace gtx {

namespace {

/* A tile as its parents see it: with what is below. */
struct Entry {
    Vec3d low, high;
    double error = 0;
    bool empty = false;
    MadeFile asset;
    uint64_t memory = 0;
    Beginning beginning;
};

} // namespace

/* Facts of all tiles; boxes hold those below them, and errors do not fall towards the root. */
static Vector<Entry> entries_of(const Plan &plan)
{
    Vector<Entry> entries;
    for (const Tile &tile : plan.tiles) {
        const TileFacts facts = read_facts(plan, tile);
        if (!are_there(plan, tile, facts, false))
            throw Error(GTX_ERROR_READ, "the files of the tile " + tile.name + " are not those "
                                        "that were cooked");
        entries.push_back({facts.low, facts.high, facts.error, facts.empty, facts.asset,
                           facts.memory, facts.beginning});
    }
    for (size_t n = entries.size(); n-- > 1;) {
        Entry &parent = entries[plan.tiles[n].parent];
        parent.error = std::max(parent.error, entries[n].error);
        for (int k = 0; k < 3; ++k) {
            parent.low[k] = std::min(parent.low[k], entries[n].low[k]);
            parent.high[k] = std::max(parent.high[k], entries[n].high[k]);
        }
    }
    return entries;
}

/* +Z is up in a tileset, +Y in the tiles' own files, which readers turn. */
static void write_box(Json &out, const Entry &e)
{
    const Vec3d c = (e.low + e.high) / 2, h = (e.high - e.low) / 2;
    const double box[12] = {c.x, -c.z, c.y, h.x, 0, 0, 0, h.z, 0, 0, 0, h.y};
    gtx_json_begin_object(&out, "boundingVolume");
    gtx_json_begin_array(&out, "box");
    for (double number : box)
        gtx_json_exact(&out, nullptr, number);
    gtx_json_end_array(&out);
    gtx_json_end_object(&out);
}

static void write_unit(Json &out, double unit)
{
    gtx_json_begin_array(&out, "transform");
    for (int i = 0; i < 16; ++i)
        gtx_json_exact(&out, nullptr, i == 15 ? 1 : i % 5 ? 0 : unit);
    gtx_json_end_array(&out);
}

static void write_content(Json &out, const Plan &plan, const Tile &tile)
{
    const std::string name = "tiles/" + tile.name;
    gtx_json_begin_object(&out, "content");
    gtx_json_string(&out, "uri", (name + (plan.glb ? ".glb" : ".gtx")).c_str());
    gtx_json_end_object(&out);
    gtx_json_begin_object(&out, "extras");
    gtx_json_string(&out, "geotex", (name + ".gtx").c_str());
    gtx_json_end_object(&out);
}

/* Trees are at most 22 deep. */
static void write_tile(Json &out, const Plan &plan, const Vector<Entry> &entries, uint32_t number,
                       const char *key)
{
    const Tile &tile = plan.tiles[number];
    gtx_json_begin_object(&out, key);
    write_box(out, entries[number]);
    gtx_json_exact(&out, "geometricError", entries[number].error);
    if (!number) {
        gtx_json_string(&out, "refine", "REPLACE");
        if (plan.unit != 1)
            write_unit(out, plan.unit);
    }
    if (!entries[number].empty)
        write_content(out, plan, tile);
    if (!tile.is_leaf()) {
        gtx_json_begin_array(&out, "children");
        for (uint32_t child : tile.children)
            write_tile(out, plan, entries, child, nullptr);
        gtx_json_end_array(&out);
    }
    gtx_json_end_object(&out);
}

/* As a float that is not less. */
static float no_less(double error)
{
    const float rounded = float(error);
    return double(rounded) < error ? std::nextafter(rounded, INFINITY) : rounded;
}

static std::string index_of(const Plan &plan, const Vector<Entry> &entries)
{
    Vector<gtx_index_tile> tiles;
    for (size_t n = 0; n < entries.size(); ++n) {
        const Entry &e = entries[n];
        gtx_index_tile tile = {};
        if (plan.tiles[n].name.size() >= sizeof tile.name)
            throw Error(GTX_ERROR_INPUT, "the plan is none that gtx world plan wrote");
        for (int k = 0; k < 3; ++k) {
            tile.low[k] = e.low[k];
            tile.high[k] = e.high[k];
        }
        tile.error = no_less(e.error);
        tile.parent = plan.tiles[n].parent;
        tile.whole = {e.asset.size, e.asset.size ? e.asset.hash : 0, e.memory};
        if (e.beginning.file.size) {
            tile.beginning = {e.beginning.file.size, e.beginning.file.hash, e.beginning.memory};
            tile.beginning_error = std::max(no_less(e.beginning.error), tile.error);
        }
        std::copy(plan.tiles[n].name.begin(), plan.tiles[n].name.end(), tile.name);
        tiles.push_back(tile);
    }
    if (tiles.size() > GTX_INDEX_MAX_TILES)
        throw Error(GTX_ERROR_LIMIT, "a world has at most 2^20 tiles: --triangles must allow more");
    std::string out(GTX_INDEX_HEADER + tiles.size() * GTX_INDEX_RECORD, 0);
    gtx_index_write(tiles.data(), uint32_t(tiles.size()), plan.unit,
                    reinterpret_cast<uint8_t *>(&out[0]));
    gtx_error error;
    for (uint32_t n = 0; n < tiles.size(); ++n) /* facts and plan are files that anyone may write */
        if (gtx_index_read(reinterpret_cast<const uint8_t *>(out.data()), &tiles[n], n, &error))
            throw Error(GTX_ERROR_INPUT, std::string(error.message) + ": the plan or the tile's "
                                                                      "facts are none of ours");
    return out;
}

StepReport index_world(const std::string &folder, Task &task)
{
    task.begin("read");
    const Plan plan = read_plan(folder, task);
    const Vector<Entry> entries = entries_of(plan);
    Json out(gtx_allocator{});
    gtx_json_begin_object(&out, nullptr);
    gtx_json_begin_object(&out, "asset");
    gtx_json_string(&out, "version", "1.1");
    gtx_json_string(&out, "generator", "geotex");
    gtx_json_end_object(&out);
    gtx_json_number(&out, "geometricError",
                    plan.unit * length(entries[0].high - entries[0].low));
    write_tile(out, plan, entries, 0, "root");
    gtx_json_end_object(&out);
    check_written(out);
    write_whole(folder + "/tileset.json", std::string(out.text, out.size));
    write_whole(folder + "/" GTX_INDEX_FILE, index_of(plan, entries));
    task.end();
    return {std::to_string(plan.tiles.size()) + " tiles", false};
}

} // namespace gtx
