/* Results of cooking a tile, as a small JSON file. */
#include "world/facts.hpp"

#include "base/hash.h"
#include "cook/report.hpp"
#include "world/numbers.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

namespace gtx {

using nlohmann::json;

void TileFacts::add(const Vec3d &p)
{
    for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
    }
}

MadeFile made_of(const std::string &bytes)
{
    return {bytes.size(), gtx_hash_bytes(bytes.data(), bytes.size())};
}

static void write_file(Json &out, const char *name, const MadeFile &file)
{
    gtx_json_begin_object(&out, name);
    gtx_json_integer(&out, "size", file.size);
    gtx_json_hash(&out, "xxh64", file.hash);
    gtx_json_end_object(&out);
}

static void write_point(Json &out, const char *name, const Vec3d &p)
{
    gtx_json_begin_array(&out, name);
    for (int k = 0; k < 3; ++k)
        gtx_json_exact(&out, nullptr, p[k]);
    gtx_json_end_array(&out);
}

void write_facts(const Plan &plan, const Tile &tile, const TileFacts &facts)
{
    Json out(gtx_allocator{});
    gtx_json_begin_object(&out, nullptr);
    gtx_json_hash(&out, "key", facts.key);
    gtx_json_integer(&out, "triangles", facts.triangles);
    gtx_json_integer(&out, "lod_triangles", facts.lod_triangles);
    write_point(out, "low", facts.low);
    write_point(out, "high", facts.high);
    gtx_json_exact(&out, "error", facts.error);
    gtx_json_bool(&out, "empty", facts.empty);
    write_file(out, "asset", facts.asset);
    write_file(out, "glb", facts.glb);
    write_file(out, "low_surface", facts.low_surface);
    gtx_json_integer(&out, "memory", facts.memory);
    write_file(out, "beginning", facts.beginning.file);
    gtx_json_integer(&out, "beginning_memory", facts.beginning.memory);
    gtx_json_exact(&out, "beginning_error", facts.beginning.error);
    gtx_json_end_object(&out);
    check_written(out);
    write_whole(facts_path(plan, tile), std::string(out.text, out.size));
}

static MadeFile read_file(const json &from)
{
    const auto &hash = from.at("xxh64").get_ref<const std::string &>();
    return {whole_number(from, "size", UINT64_MAX), std::strtoull(hash.c_str(), nullptr, 16)};
}

TileFacts read_facts(const Plan &plan, const Tile &tile)
{
    const std::string path = facts_path(plan, tile);
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw Error(GTX_ERROR_READ, "cannot read " + path + ": the tile " + tile.name +
                                        " is not cooked");
    const json root = json::parse(file, nullptr, false);
    TileFacts facts;
    try {
        facts.key = std::strtoull(root.at("key").get_ref<const std::string &>().c_str(), nullptr,
                                  16);
        facts.triangles = whole_number(root, "triangles", UINT64_MAX);
        facts.lod_triangles = whole_number(root, "lod_triangles", UINT64_MAX);
        for (int k = 0; k < 3; ++k) {
            facts.low[k] = root.at("low").at(size_t(k));
            facts.high[k] = root.at("high").at(size_t(k));
        }
        facts.error = root.at("error");
        facts.empty = root.at("empty");
        facts.asset = read_file(root.at("asset"));
        facts.glb = read_file(root.at("glb"));
        facts.low_surface = read_file(root.at("low_surface"));
        facts.memory = root.at("memory");
        facts.beginning.file = read_file(root.at("beginning"));
        facts.beginning.memory = root.at("beginning_memory");
        facts.beginning.error = root.at("beginning_error");
    } catch (const json::exception &) {
        throw Error(GTX_ERROR_INPUT, path + " is none that gtx world cook wrote");
    }
    return facts;
}

static bool is_there(const std::string &path, const MadeFile &file, bool content)
{
    std::error_code error;
    if (!file.size)
        return true;
    if (std::filesystem::file_size(path, error) != file.size || error)
        return false;
    if (!content)
        return true;
    char bytes[1 << 14]; /* in pieces: facts may tell of any size */
    gtx_hash hash;
    gtx_hash_begin(&hash);
    std::ifstream from(path, std::ios::binary);
    while (from.read(bytes, sizeof bytes) || from.gcount()) {
        cancel_point();
        gtx_hash_add(&hash, bytes, size_t(from.gcount()));
    }
    return gtx_hash_end(&hash) == file.hash;
}

bool are_there(const Plan &plan, const Tile &tile, const TileFacts &facts, bool content)
{
    return is_there(asset_path(plan, tile), facts.asset, content) &&
           is_there(glb_path(plan, tile), facts.glb, content) &&
           is_there(low_path(plan, tile), facts.low_surface, content);
}

} // namespace gtx
