/* Finding and keeping assets by the keys that they were cooked under. */
#include "cook/cache.hpp"

#include "cook/meta.hpp"

#include "base/output.h"

#include <cinttypes>
#include <cstdio>
#include <filesystem>

namespace fs = std::filesystem;

namespace gtx {

/* Whether an asset is what a cook with these options would make. */
static bool is_cooked(const gtx_asset *asset, const Options &options, uint64_t key,
                      std::bitset<GTX_WARNING_COUNT> &warnings)
{
    uint64_t its_key;
    return read_meta(asset, its_key, warnings) && its_key == key &&
           !(options.strict && (warnings & ~options.allowed).any());
}

Asset find_cooked(const char *path, const Options &options, uint64_t key, const gtx_limits &limits)
{
    Asset none(nullptr, gtx_close);
    if (!options.if_changed || options.charts_ply)
        return none;
    gtx_asset *asset = nullptr;
    gtx_open_desc open = {};
    open.allocator = &options.allocator;
    open.limits = limits;
    gtx_error error;
    gtx_result opened = gtx_open_file(path, &open, &asset, &error);
    if (opened == GTX_ERROR_MEMORY)
        throw Error(error);
    if (opened)
        return none;
    Asset owner(asset, gtx_close);
    std::bitset<GTX_WARNING_COUNT> warnings;
    return is_cooked(asset, options, key, warnings) ? std::move(owner) : std::move(none);
}

static fs::path entry_of(const char *cache, uint64_t key)
{
    char name[32];
    snprintf(name, sizeof name, "%02x/%016" PRIx64 ".gtx", unsigned(key >> 56), key);
    return fs::path(cache) / name;
}

/* Nobody else's file is read or written through a link, and no pipe is waited for. */
static bool is_plain(const fs::path &entry)
{
    std::error_code ignored;
    return fs::symlink_status(entry, ignored).type() == fs::file_type::regular;
}

static bool is_there(const fs::path &entry)
{
    std::error_code ignored;
    return fs::symlink_status(entry, ignored).type() != fs::file_type::not_found;
}

Cached find_in_cache(const Options &options, uint64_t key, const gtx_limits &limits, Task &task)
{
    Cached out;
    if (!options.cache || options.charts_ply)
        return out;
    const fs::path entry = entry_of(options.cache, key);
    if (!is_there(entry))
        return out;
    const char *fault = "it is no regular file";
    try {
        if (is_plain(entry)) {
            fault = "it was cooked under another key";
            out.file = std::make_unique<FileBytes>(entry.c_str(), options.allocator, limits);
            out.asset = open_asset(out.file->view(), options.allocator, limits);
            std::bitset<GTX_WARNING_COUNT> warnings;
            const bool fits = is_cooked(out.asset.get(), options, key, warnings);
            for (size_t kind = 0; fits && kind < warnings.size(); ++kind)
                if (warnings[kind])
                    task.warn(gtx_warning(kind), "when the asset of the cache was cooked");
            if (fits)
                return out;
            uint64_t its_key;
            if (read_meta(out.asset.get(), its_key, warnings) && its_key == key)
                return {}; /* it has warnings that are errors now: cooking tells which */
        }
        task.warn(GTX_WARNING_CACHE, entry.native() + " is not taken and made again: " + fault);
    } catch (const Error &e) {
        if (e.result == GTX_ERROR_MEMORY || e.result == GTX_CANCELLED)
            throw;
        task.warn(GTX_WARNING_CACHE,
                  entry.native() + " is not taken and made again: " + e.message);
    }
    return {};
}

void keep_in_cache(const Options &options, uint64_t key, std::string_view file, Task &task)
{
    if (!options.cache || !key)
        return;
    const fs::path entry = entry_of(options.cache, key);
    std::error_code failed;
    gtx_error error = {};
    if (is_there(entry) && !is_plain(entry))
        return; /* the note is there already */
    fs::create_directories(entry.parent_path(), failed);
    if (!failed && !gtx_write_file(entry.c_str(), file.data(), file.size(), &error))
        return;
    task.warn(GTX_WARNING_CACHE, "the asset is not kept in the cache: " +
                                     (failed ? failed.message() : std::string(error.message)));
}

} // namespace gtx
