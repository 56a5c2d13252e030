/* The last step: tileset.json (OGC 3D Tiles 1.1), once every tile is there. */
#include "world/facts.hpp"

#include "cook/report.hpp"

#include <algorithm>

namespace gtx {

namespace {

/* A tile as its parents see it: with what is below. */
struct Entry {
    Vec3d low, high;
    double error = 0;
    bool empty = false;
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
        entries.push_back({facts.low, facts.high, facts.error, facts.empty});
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
        gtx_json_number(&out, nullptr, number);
    gtx_json_end_array(&out);
    gtx_json_end_object(&out);
}

static void write_unit(Json &out, double unit)
{
    gtx_json_begin_array(&out, "transform");
    for (int i = 0; i < 16; ++i)
        gtx_json_number(&out, nullptr, i == 15 ? 1 : i % 5 ? 0 : unit);
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
    gtx_json_number(&out, "geometricError", entries[number].error);
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
    task.end();
    return {std::to_string(plan.tiles.size()) + " tiles", false};
}

} // namespace gtx
