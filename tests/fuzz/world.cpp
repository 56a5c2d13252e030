/* Worlds: plans, facts and cell files that anyone may have made, taken through all steps. */
#include "fuzz/fuzz.hpp"

#include "world/cell.hpp"
#include "world/facts.hpp"

#include "base/bytes.h"

#include <algorithm>
#include <filesystem>
#include <functional>

namespace fuzz {

namespace fs = std::filesystem;

/* Of a cell file; cooks of triangles that cross each other take seconds, with sanitizers. */
constexpr size_t MAX_TRIANGLES = 8;
/* Of a plan that is taken through the steps. */
constexpr size_t MAX_TILES = 6;

static bool expected(gtx_result result)
{
    return result == GTX_ERROR_INPUT || result == GTX_ERROR_EMPTY || result == GTX_ERROR_LIMIT ||
           result == GTX_ERROR_READ || result == GTX_ERROR_ARGUMENT ||
           result == GTX_ERROR_UNSUPPORTED || result == GTX_ERROR_MEMORY;
}

static bool passes(const char *step, const std::function<void(gtx::Task &)> &body)
{
    gtx::Task task(1, nullptr, nullptr, {}, {}, small_limits());
    try {
        body(task);
        return true;
    } catch (const gtx::Error &e) {
        REQUIRE(expected(e.result) && e.message.size() > 8, "%s: %d %s", step, e.result,
                e.message.c_str());
        return false;
    }
}

static void write_below(const std::string &path, const std::string &text)
{
    const fs::path folder = fs::path(scratch("world"));
    REQUIRE(fs::path(path).lexically_normal().native().rfind(folder.native(), 0) == 0,
            "a file outside the world's folder: %s", path.c_str());
    gtx::write_whole(path, text);
}

/* A cell file of these bytes as triangles, whose header is right but for what `how` breaks. */
static std::string cell_of(const gtx::Plan &plan, const std::string &bytes, uint64_t how)
{
    gtx::CellHeader header;
    header.traits = plan.traits;
    const size_t triangle = 3 * header.traits.bytes();
    header.count = std::min(bytes.size() / triangle, MAX_TRIANGLES);
    std::string body = bytes.substr(0, header.count * triangle);
    header.hash = gtx_hash_bytes(body.data(), body.size());
    gtx::Corners3 corners;
    gtx::CellHeader bounds;
    for (size_t i = 0; i < header.count; ++i) {
        gtx::decode_triangle(header.traits, reinterpret_cast<uint8_t *>(&body[i * triangle]),
                             corners);
        bounds.add(corners);
    }
    header.low = bounds.low;
    header.high = bounds.high;
    header.count += how % 32 == 1;
    header.deviation = how % 32 == 2 ? NAN : how % 32 == 3 ? 1e300 : 0;
    if (how % 32 == 4)
        body += "x";
    return header.bytes() + body;
}

/* The first part is plan.json, the second triangles, the third the facts of a tile. */
static const char MARK[] = "\n#part\n";

static std::string part_of(const std::string &bytes, int number)
{
    size_t from = 0;
    for (; number > 0; --number) {
        const size_t mark = bytes.find(MARK, from);
        if (mark == bytes.npos)
            return {};
        from = mark + sizeof MARK - 1;
    }
    return bytes.substr(from, std::min(bytes.find(MARK, from), bytes.size()) - from);
}

void run_world(const uint8_t *data, size_t size)
{
    const std::string bytes(reinterpret_cast<const char *>(data), size), folder = scratch("world");
    const uint64_t how = choices(data, size);
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    write_below(gtx::plan_path(folder), part_of(bytes, 0));
    gtx::Plan plan;
    if (!passes("plan", [&](gtx::Task &task) { plan = gtx::read_plan(folder, task); }) ||
        plan.tiles.size() > MAX_TILES)
        return;
    const std::string facts = part_of(bytes, 2);
    for (const gtx::Tile &tile : plan.tiles) {
        if (tile.is_leaf())
            write_below(gtx::cell_path(plan, tile), cell_of(plan, part_of(bytes, 1), how));
        if (!facts.empty())
            write_below(gtx::facts_path(plan, tile), facts);
    }
    for (auto tile = plan.tiles.rbegin(); tile != plan.tiles.rend(); ++tile) {
        if (!tile->is_leaf())
            passes("merge", [&](gtx::Task &task) { gtx::merge_tile(folder, tile->name, task); });
        if (how >> 8 & 1)
            passes("cook", [&](gtx::Task &task) { gtx::cook_tile(folder, tile->name, task); });
    }
    passes("index", [&](gtx::Task &task) { gtx::index_world(folder, task); });
    fs::remove_all(folder, ignored);
}

} // namespace fuzz
