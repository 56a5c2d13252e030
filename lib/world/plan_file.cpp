/* plan.json, and where the files of a world lie. */
#include "world/plan.hpp"

#include "base/json.h"
#include "base/output.h"
#include "cook/report.hpp"
#include "world/numbers.hpp"

#include <cinttypes>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

namespace gtx {

namespace fs = std::filesystem;
using nlohmann::json;

/* ---- files ---- */

static std::string below(const std::string &folder, const std::string &name)
{
    return (fs::path(folder) / name).native();
}

std::string plan_path(const std::string &folder) { return below(folder, "plan.json"); }
std::string cell_path(const Plan &plan, const Tile &tile)
{
    return below(plan.folder, (tile.is_leaf() ? "work/split/" : "work/merge/") + tile.name);
}
std::string low_path(const Plan &plan, const Tile &tile)
{
    return below(plan.folder, "work/low/" + tile.name);
}
std::string facts_path(const Plan &plan, const Tile &tile)
{
    return below(plan.folder, "work/facts/" + tile.name + ".json");
}
std::string asset_path(const Plan &plan, const Tile &tile)
{
    return below(plan.folder, "tiles/" + tile.name + ".gtx");
}
std::string glb_path(const Plan &plan, const Tile &tile)
{
    return below(plan.folder, "tiles/" + tile.name + ".glb");
}

void make_folder_of(const std::string &path)
{
    std::error_code error;
    const fs::path folder = fs::path(path).parent_path();
    if (!folder.empty())
        fs::create_directories(folder, error);
    if (error)
        throw Error(GTX_ERROR_WRITE, "cannot make the folder " + folder.native() + ": " +
                                         error.message());
}

static bool is_content(const std::string &path, const std::string &text)
{
    std::error_code error;
    if (fs::file_size(path, error) != text.size() || error)
        return false;
    std::ifstream file(path, std::ios::binary);
    std::string there(text.size(), 0);
    return file.read(&there[0], std::streamsize(there.size())) && there == text;
}

void write_whole(const std::string &path, const std::string &text)
{
    gtx_error error;
    make_folder_of(path);
    if (!is_content(path, text))
        require_ok(gtx_write_file(path.c_str(), text.data(), text.size(), &error), error);
}

/* ---- writing ---- */

static void write_tile(Json &out, const Tile &tile)
{
    gtx_json_begin_object(&out, nullptr);
    gtx_json_string(&out, "name", tile.name.c_str());
    gtx_json_integer(&out, "depth", tile.depth);
    gtx_json_integer(&out, "parent", tile.parent);
    gtx_json_hash(&out, "first", tile.first);
    gtx_json_hash(&out, "end", tile.end);
    gtx_json_integer(&out, "triangles", tile.triangles);
    gtx_json_bool(&out, "leaf", tile.is_leaf());
    gtx_json_begin_array(&out, "box");
    for (const Vec3d &corner : {tile.low, tile.high})
        for (int k = 0; k < 3; ++k)
            gtx_json_exact(&out, nullptr, corner[k]);
    gtx_json_end_array(&out);
    gtx_json_end_object(&out);
}

static void write_lattice(Json &out, const Lattice &lattice)
{
    gtx_json_begin_object(&out, "lattice");
    gtx_json_number(&out, "exponent", lattice.exponent);
    gtx_json_begin_array(&out, "low");
    for (int64_t low : lattice.low)
        gtx_json_number(&out, nullptr, double(low));
    gtx_json_end_array(&out);
    gtx_json_end_object(&out);
}

static void write_inputs(Json &out, const Plan &plan)
{
    gtx_json_begin_array(&out, "inputs");
    for (const WorldInput &input : plan.inputs) {
        gtx_json_begin_object(&out, nullptr);
        gtx_json_string(&out, "path", input.path.c_str());
        gtx_json_string(&out, "kind", input.raw ? "raw" : input.grid ? "grid" : "model");
        gtx_json_end_object(&out);
    }
    gtx_json_end_array(&out);
}

void write_plan(const Plan &plan)
{
    Json out(gtx_allocator{});
    gtx_json_begin_object(&out, nullptr);
    gtx_json_hash(&out, "key", plan.key);
    gtx_json_integer(&out, "triangles", plan.total);
    gtx_json_integer(&out, "dropped", plan.dropped);
    gtx_json_integer(&out, "tile_triangles", plan.triangles);
    gtx_json_integer(&out, "memory", plan.memory);
    gtx_json_integer(&out, "work", plan.work);
    gtx_json_bool(&out, "glb", plan.glb);
    gtx_json_bool(&out, "closed", plan.closed);
    gtx_json_string(&out, "up", plan.z_up ? "z" : "y");
    gtx_json_exact(&out, "unit", plan.unit);
    if (!std::isnan(plan.latitude))
        gtx_json_exact(&out, "latitude", plan.latitude);
    if (plan.of_depths)
        gtx_json_bool(&out, "depths", true);
    gtx_json_bool(&out, "doubles", plan.traits.doubles);
    gtx_json_bool(&out, "normals", plan.traits.normals);
    gtx_json_bool(&out, "colors", plan.traits.colors);
    gtx_json_bool(&out, "textured", plan.traits.textured);
    write_lattice(out, plan.lattice);
    write_inputs(out, plan);
    gtx_json_begin_array(&out, "tiles");
    for (const Tile &tile : plan.tiles)
        write_tile(out, tile);
    gtx_json_end_array(&out);
    gtx_json_end_object(&out);
    check_written(out);
    write_whole(plan_path(plan.folder), std::string(out.text, out.size));
}

/* ---- reading ---- */

static uint64_t hash_of(const json &from)
{
    return std::strtoull(from.get_ref<const std::string &>().c_str(), nullptr, 16);
}

static void require_plan(bool fine)
{
    if (!fine)
        throw Error(GTX_ERROR_INPUT, "the plan is none that gtx world plan wrote");
}

/* A name becomes part of paths, and has a digit for each step below the root. */
static constexpr uint64_t MAX_DEPTH = 62;
static bool is_name(const std::string &name)
{
    return !name.empty() && name.size() <= MAX_DEPTH + 1 && name[0] == 'r' &&
           name.find_first_not_of("01234567", 1) == name.npos;
}

static Tile read_tile(const json &from, Plan &plan)
{
    Tile tile;
    const uint32_t number = uint32_t(plan.tiles.size());
    tile.name = from.at("name");
    tile.depth = uint32_t(whole_number(from, "depth", MAX_DEPTH));
    tile.parent = uint32_t(whole_number(from, "parent", UINT32_MAX));
    tile.first = hash_of(from.at("first"));
    tile.end = hash_of(from.at("end"));
    tile.triangles = whole_number(from, "triangles", UINT64_MAX);
    for (size_t k = 0; k < 3; ++k) {
        tile.low[int(k)] = from.at("box").at(k);
        tile.high[int(k)] = from.at("box").at(k + 3);
    }
    require_plan(is_name(tile.name) && tile.name.size() > tile.depth && tile.triangles > 0);
    require_plan(number ? tile.parent < number : tile.parent == 0 && tile.depth == 0);
    if (number) {
        const Tile &parent = plan.tiles[tile.parent]; /* octants between them may have one child */
        require_plan(tile.depth == parent.depth + 1 && tile.depth >= plan.tiles.back().depth &&
                     tile.name.compare(0, parent.name.size(), parent.name) == 0 &&
                     tile.name.size() > parent.name.size());
        plan.tiles[tile.parent].children.push_back(number);
    }
    return tile;
}

static void read_parts(const json &from, Plan &plan)
{
    plan.key = hash_of(from.at("key"));
    plan.total = whole_number(from, "triangles", UINT64_MAX);
    plan.dropped = whole_number(from, "dropped", UINT64_MAX);
    plan.triangles = uint32_t(whole_number(from, "tile_triangles", UINT32_MAX));
    plan.memory = whole_number(from, "memory", UINT64_MAX);
    plan.work = from.contains("work") ? whole_number(from, "work", UINT64_MAX) : 0;
    plan.glb = from.at("glb");
    plan.closed = from.value("closed", false);
    plan.z_up = from.at("up") == "z";
    plan.unit = from.at("unit");
    plan.latitude = from.value("latitude", plan.latitude);
    plan.of_depths = from.value("depths", false);
    plan.traits = {from.at("doubles"), from.at("normals"), from.at("colors"),
                   from.value("textured", false)};
    plan.lattice.exponent = int(whole_of(from.at("lattice").at("exponent"), 1100));
    for (int k = 0; k < 3; ++k)
        plan.lattice.low[k] = whole_of(from.at("lattice").at("low").at(size_t(k)), 1 << 20);
    for (const json &input : from.at("inputs"))
        plan.inputs.push_back({input.at("path"), input.at("kind") == "raw",
                               input.at("kind") == "grid"});
    for (const json &tile : from.at("tiles"))
        plan.tiles.push_back(read_tile(tile, plan));
    require_plan(!plan.tiles.empty() && plan.triangles > 0 && plan.unit > 0);
    for (size_t n = 0; n < plan.tiles.size(); ++n)
        require_plan(from.at("tiles")[n].at("leaf") == plan.tiles[n].is_leaf());
}

Plan read_plan(const std::string &folder, Task &task)
{
    Plan plan;
    plan.folder = folder;
    const std::string path = plan_path(folder);
    std::error_code error;
    const uint64_t size = fs::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file)
        throw Error(GTX_ERROR_READ, "cannot read " + path + ": gtx world plan makes it");
    task.limits.read(path, size);
    TakenMemory taken(16 * size); /* of the parser, about */
    const json root = json::parse(file, nullptr, false);
    try {
        read_parts(root, plan);
    } catch (const json::exception &) {
        require_plan(false);
    }
    return plan;
}

const Tile &Plan::tile(const std::string &name) const
{
    for (const Tile &tile : tiles)
        if (tile.name == name)
            return tile;
    throw Error(GTX_ERROR_ARGUMENT, "the plan has no tile '" + name.substr(0, 40) + "'");
}

} // namespace gtx
