/* Measures a world against its source: the tiles are assets that are shown together. */
#include "world/compare.hpp"

#include "cook/compare.hpp"
#include "cook/embedded.hpp"
#include "cook/meta.hpp"
#include "world/facts.hpp"

#include "base/alloc.h"
#include "base/hash.h"
#include "stream/index.h"

#include <cstdlib>
#include <map>
#include <mutex>

namespace gtx {

/* What a stream refines a tile at by default (gtx_stream_desc.max_error). */
static const double TILE_PIXELS = 1;

namespace {

/* Memory hooks by which what assets and casters take counts as the job's. */
class CountedMemory {
public:
    const gtx_allocator hooks = {take, give, this};
    /* Why memory was refused, where it was. */
    void throw_refusal()
    {
        if (refusal_)
            std::rethrow_exception(refusal_);
    }

private:
    static void *take(size_t size, void *user) noexcept
    {
        try {
            take_memory(size);
        } catch (...) {
            auto *self = static_cast<CountedMemory *>(user);
            const std::lock_guard<std::mutex> lock(self->mutex_);
            if (!self->refusal_)
                self->refusal_ = std::current_exception();
            return nullptr;
        }
        void *memory = std::malloc(size);
        if (!memory)
            give_memory(size);
        return memory;
    }
    static void give(void *memory, size_t size, void *)
    {
        if (memory)
            give_memory(size);
        std::free(memory);
    }
    std::mutex mutex_;
    std::exception_ptr refusal_;
};

/* The tiles of an index, each opened once one wants it. */
class Tiles {
public:
    Tiles(const std::string &folder, Task &task, std::string &about);

    /* Those that stand for the whole surface with no error above this; leaves where it is 0. */
    Assets within(double error);
    uint32_t levels() const { return levels_; }
    void throw_refusal() { memory_.throw_refusal(); }

private:
    const gtx_asset *open(uint32_t number);

    const std::string &folder_;
    Task &task_;
    std::string &about_;             /* the file that is read */
    CountedMemory memory_;
    Vector<gtx_index_tile> tiles_;
    Vector<uint8_t> has_children_;
    std::map<uint32_t, Asset> opened_;
    uint32_t levels_ = 1;            /* of the height fields, of any that was opened */
};

} // namespace

Tiles::Tiles(const std::string &folder, Task &task, std::string &about)
    : folder_(folder), task_(task), about_(about)
{
    about_ = folder + "/" GTX_INDEX_FILE;
    const FileBytes bytes(about_.c_str(), memory_.hooks, task.limits.given());
    task.limits.read(about_, bytes.size);
    uint32_t count = 0;
    double unit;
    gtx_error error;
    require_ok(gtx_index_check(bytes.data, bytes.size, &count, &unit, &error), error);
    tiles_.resize(count);
    has_children_.resize(count);
    for (uint32_t n = 0; n < count; ++n) {
        cancel_point();
        require_ok(gtx_index_read(bytes.data, &tiles_[n], n, &error), error);
        if (n)
            has_children_[tiles_[n].parent] = 1;
    }
}

const gtx_asset *Tiles::open(uint32_t number)
{
    const auto found = opened_.find(number);
    if (found != opened_.end())
        return found->second.get();
    const gtx_index_tile &tile = tiles_[number];
    about_ = folder_ + "/tiles/" + tile.name + ".gtx";
    const FileBytes bytes(about_.c_str(), memory_.hooks, task_.limits.given());
    task_.limits.read(about_, bytes.size);
    if (bytes.size != tile.whole.bytes || gtx_hash_bytes(bytes.data, bytes.size) != tile.whole.hash)
        throw Error(GTX_ERROR_INPUT, "the tile is not the one that the world's index describes");
    Asset asset = open_asset(bytes.view(), memory_.hooks, task_.limits.given());
    gtx_info info;
    gtx_get_info(asset.get(), &info);
    levels_ = std::max(levels_, info.mip_count);
    return opened_.emplace(number, std::move(asset)).first->second.get();
}

Assets Tiles::within(double error)
{
    Vector<uint8_t> refined(tiles_.size());
    Assets out;
    for (uint32_t n = 0; n < tiles_.size(); ++n) {
        cancel_point();
        if (n && !refined[tiles_[n].parent])
            continue;
        refined[n] = has_children_[n] && !(error > 0 && double(tiles_[n].error) <= error);
        if (!refined[n] && tiles_[n].whole.bytes)
            out.push_back(open(n));
    }
    if (out.empty())
        throw Error(GTX_ERROR_EMPTY, "the world shows nothing");
    return out;
}

void compare_world(const std::string &folder, const char *model, double tile_error,
                   const gtx_compare_desc &desc, gtx_compare_result *result, gtx_report *report,
                   std::string &about)
{
    CompareTask task(desc);
    task.begin("import");
    Tiles tiles(folder, task, about);
    try {
        const bool closed = was_closed(tiles.within(tile_error)[0]);
        const std::string source = desc.more_count ? "gtx compare" : model;
        about = source;
        Models models = read_compared(model, desc, task);
        const ShownAt shown = [&](double pixel) {
            Assets assets = tiles.within(std::max(tile_error, TILE_PIXELS * pixel));
            about = source;
            return assets;
        };
        compare_models(shown, tiles.levels(), closed, models, desc, task, result, report);
    } catch (...) {
        tiles.throw_refusal();
        throw;
    }
}

} // namespace gtx
