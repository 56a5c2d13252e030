/* The step that sorts triangles into leaf tiles: writes cell files in bounded memory. */
#include "world/cell.hpp"
#include "world/materials.hpp"

#include "base/bytes.h"

#include <algorithm>
#include <filesystem>

#include <unistd.h>

namespace gtx {

namespace fs = std::filesystem;

/* What all cells together hold back; then the fullest are written. One file is open at a time. */
constexpr size_t BUFFERED = size_t(96) << 20;
/* Bytes. Cells that hold less, or less than the mean, wait: writing them would take many calls. */
constexpr size_t FULL = 1 << 16;

static void require_planned(bool fine)
{
    if (!fine)
        throw Error(GTX_ERROR_INPUT, "the models are not those of the plan");
}

namespace {

struct Cell {
    const Tile *tile;
    Vector<uint8_t> bytes;           /* not yet in the file */
    CellHeader header;
    gtx_hash hash;
};

/* The cell files in a folder of their own, which gets its name once all are whole. */
class Cells {
public:
    Cells(const Plan &plan, const fs::path &folder);
    void add(const Corners3 &corners);
    void finish();

private:
    fs::path path(const Cell &cell) const { return folder_ / cell.tile->name; }
    void write(Cell &cell);
    void write_fullest();
    void write_header(Cell &cell);

    const Plan &plan_;
    const fs::path folder_;
    const size_t triangle_;
    Vector<Cell> cells_;             /* in the order of their places */
    Vector<uint64_t> first_;
    size_t held_ = 0;
};

Cells::Cells(const Plan &plan, const fs::path &folder)
    : plan_(plan), folder_(folder), triangle_(3 * plan.traits.bytes())
{
    for (const Tile &tile : plan.tiles)
        if (tile.is_leaf())
            cells_.push_back({&tile, {}, {}, {}});
    std::sort(cells_.begin(), cells_.end(), [](const Cell &a, const Cell &b) {
        return a.tile->first < b.tile->first;
    });
    for (Cell &cell : cells_) {
        first_.push_back(cell.tile->first);
        gtx_hash_begin(&cell.hash);
        std::ofstream out(path(cell), std::ios::binary);
        out << CellHeader().bytes();
        if (!out.flush())
            throw Error(GTX_ERROR_WRITE, "cannot write " + path(cell).native());
    }
}

void Cells::add(const Corners3 &corners)
{
    const Vec3d centroid = (corners[0].position + corners[1].position + corners[2].position) / 3;
    const uint64_t place = plan_.lattice.place(centroid);
    const auto after = std::upper_bound(first_.begin(), first_.end(), place);
    const size_t at = size_t(std::max(after - first_.begin(), std::ptrdiff_t(1)) - 1);
    Cell &cell = cells_[at];
    cell.bytes.resize(cell.bytes.size() + triangle_);
    encode_triangle(plan_.traits, corners, &cell.bytes[cell.bytes.size() - triangle_]);
    cell.header.add(corners);
    held_ += triangle_;
    if (held_ >= BUFFERED)
        write_fullest();
}

void Cells::write(Cell &cell)
{
    std::ofstream out(path(cell), std::ios::binary | std::ios::app);
    out.write(reinterpret_cast<const char *>(cell.bytes.data()),
              std::streamsize(cell.bytes.size()));
    if (!out.flush())
        throw Error(GTX_ERROR_WRITE, "cannot write " + path(cell).native());
    gtx_hash_add(&cell.hash, cell.bytes.data(), cell.bytes.size());
    held_ -= cell.bytes.size();
    Vector<uint8_t>().swap(cell.bytes);
}

void Cells::write_fullest()
{
    const size_t mean = held_ / cells_.size();
    for (Cell &cell : cells_)
        if (cell.bytes.size() >= std::max(mean, std::min(FULL, BUFFERED / cells_.size())))
            write(cell);
}

void Cells::write_header(Cell &cell)
{
    cell.header.traits = plan_.traits;
    cell.header.hash = gtx_hash_end(&cell.hash);
    std::fstream out(path(cell), std::ios::binary | std::ios::in | std::ios::out);
    out << cell.header.bytes();
    if (!out.flush())
        throw Error(GTX_ERROR_WRITE, "cannot write " + path(cell).native());
}

void Cells::finish()
{
    for (Cell &cell : cells_) {
        cancel_point();
        write(cell);
        write_header(cell);
        require_planned(cell.header.count == cell.tile->triangles);
    }
}

} // namespace

/* Holds the plan's key; made last. */
static fs::path stamp_of(const fs::path &folder)
{
    return folder / "whole";
}

static bool is_there(const Plan &plan, const fs::path &folder, const std::string &key)
{
    std::ifstream file(stamp_of(folder));
    std::string line;
    if (!std::getline(file, line) || line != key)
        return false;
    for (const Tile &tile : plan.tiles)
        if (tile.is_leaf() && !fs::exists(folder / tile.name))
            return false;
    return true;
}

StepReport split_world(const std::string &folder, Task &task)
{
    task.begin("read");
    const Plan plan = read_plan(folder, task);
    const std::string key = std::to_string(plan.key);
    const fs::path target = fs::path(folder) / "work/split";
    const std::string summary = std::to_string(plan.total) + " triangles in cells";
    if (is_there(plan, target, key))
        return {summary, true};
    const fs::path temporary = fs::path(folder) / ("work/split-" + std::to_string(getpid()));
    try {
        std::error_code ignored;
        fs::remove_all(temporary, ignored);
        make_folder_of(stamp_of(temporary).native());
        Cells cells(plan, temporary);
        MaterialWriter materials(temporary.native());
        uint64_t count = 0;
        read_inputs(plan, task, [&](const Corners3 &corners) {
            require_planned(++count <= plan.total);
            cells.add(corners);
        }, [&](const Appearance &look) { materials.add(look); });
        cells.finish();
        materials.finish();
        write_whole(stamp_of(temporary).native(), key + "\n");
        fs::remove_all(target, ignored);
        fs::rename(temporary, target);
    } catch (...) {
        std::error_code ignored;
        fs::remove_all(temporary, ignored);
        throw;
    }
    task.end();
    return {summary, false};
}

} // namespace gtx
