/* The step that reads all inputs once: counts triangles, plans tiles, and writes the build files.
 * */
#include "world/cell.hpp"
#include "world/materials.hpp"

#include "base/output.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace gtx {

namespace fs = std::filesystem;

/* Raised with every change that makes other tiles of the same triangles and options; the cooker has
 * one of its own. */
constexpr uint32_t WORLD_REVISION = 3;

/* Standard input can be read once, and the steps read twice. */
static void keep_stdin(const std::string &path, Task &task)
{
    make_folder_of(path);
    const std::string temporary = path + ".part";
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    Vector<char> block(1 << 20);
    uint64_t total = 0;
    while (size_t size = fread(block.data(), 1, block.size(), stdin)) {
        out.write(block.data(), std::streamsize(size));
        total += size;
        task.advance(0);
        task.limits.require(GTX_LIMITED_TRIANGLES, "standard input", total / 36);
        task.limits.read("stdin " + std::to_string(total), size);
    }
    out.close();
    std::error_code error;
    if (out && !ferror(stdin))
        fs::rename(temporary, path, error);
    if (!out || ferror(stdin) || error) {
        fs::remove(temporary, error);
        throw Error(out ? GTX_ERROR_READ : GTX_ERROR_WRITE,
                    out ? "standard input cannot be read" : "cannot write " + path);
    }
}

static void add_number(gtx_hash &hash, uint64_t number)
{
    gtx_hash_add(&hash, &number, sizeof number);
}

/* Of all that tiles depend on but the cooker. */
static uint64_t key_of(const Plan &plan, uint64_t triangles)
{
    gtx_hash hash;
    uint64_t unit;
    std::copy_n(reinterpret_cast<const char *>(&plan.unit), sizeof unit,
                reinterpret_cast<char *>(&unit));
    gtx_hash_begin(&hash);
    for (uint64_t number : {uint64_t(WORLD_REVISION), triangles, uint64_t(plan.triangles), unit,
                            uint64_t(plan.glb)})
        add_number(hash, number);
    return gtx_hash_end(&hash);
}

static void count(Plan &plan, Sides sides, Task &task)
{
    CellCounts cells;
    Boundary boundary;
    gtx_hash hash;
    gtx_hash_begin(&hash);
    const size_t bytes = 3 * plan.traits.bytes();
    Vector<uint8_t> block(bytes);
    double reach = 0;
    plan.dropped = read_inputs(plan, task, [&](const Corners3 &c) {
        const Vec3d middle = (c[0].position + c[1].position + c[2].position) / 3;
        cells.add(middle);
        for (const Corner &corner : c)
            for (int k = 0; k < 3; ++k)
                reach = std::max(reach, std::fabs(corner.position[k] - middle[k]));
        boundary.add(c);
        encode_triangle(plan.traits, c, block.data());
        gtx_hash_add(&hash, block.data(), bytes);
        ++plan.total;
    }, [&](const Appearance &look) { hash_appearance(hash, look); });
    if (!plan.total)
        throw Error(GTX_ERROR_EMPTY, "there is no triangle");
    plan.closed = sides == Sides::AUTO ? boundary.closed() : sides == Sides::FRONT;
    const Vector<CountedCell> counted = cells.finish(plan.lattice);
    plan.tiles = make_tiles(counted, plan.triangles);
    make_boxes(plan.lattice, counted, reach, plan.tiles);
    plan.key = key_of(plan, gtx_hash_end(&hash));
}

StepReport plan_world(const PlanOptions &options, Task &task)
{
    task.begin("read");
    Plan plan;
    plan.folder = options.folder;
    plan.triangles = options.triangles;
    plan.memory = options.memory;
    plan.work = options.work;
    plan.glb = options.glb;
    plan.z_up = options.z_up;
    plan.unit = options.unit;
    plan.of_depths = options.depths;
    plan.inputs = find_inputs(options);
    for (const WorldInput &input : plan.inputs)
        if (input.raw)
            keep_stdin(input.path, task);
    if (options.local_metres)
        plan.latitude = input_latitude(plan, task);
    plan.traits = input_traits(plan, task);
    count(plan, options.sides, task);
    if (plan.dropped)
        task.warn(GTX_WARNING_NON_FINITE,
                  std::to_string(plan.dropped) + " triangles with corners that are not finite, or "
                                                 "farther than 1e60, were dropped");
    write_plan(plan);
    write_engine(plan, options.engine, options.command);
    task.end();
    size_t leaves = 0;
    for (const Tile &tile : plan.tiles)
        leaves += tile.is_leaf();
    char line[160];
    snprintf(line, sizeof line, "%llu triangles%s, %zu leaves, %zu tiles, %u levels",
             (unsigned long long)plan.total, plan.closed ? " seen from the front" : "", leaves,
             plan.tiles.size(), plan.depths());
    return {line, false};
}

} // namespace gtx
