/* Assets that need not be cooked again: the output of an earlier cook, or one in a cache. */
#pragma once

#include "cook/embedded.hpp"
#include "cook/options.hpp"

#include <memory>

namespace gtx {

/* The asset at `path` when cooking would only make it again, or an empty one. */
Asset find_cooked(const char *path, const Options &options, uint64_t key, const gtx_limits &limits);

/* An asset of a cache, and the bytes of its file. */
struct Cached {
    Asset asset = Asset(nullptr, gtx_close);
    std::unique_ptr<FileBytes> file;
};

/* A cache is a folder with an asset for each key: DIR/01/0123456789abcdef.gtx. Machines may share
 * it: entries appear whole. They are taken only if they keep to every rule of the format, hashes
 * included, and hold their key; others are made again, with a note. Warnings that an asset had when
 * it was cooked are told again. */
Cached find_in_cache(const Options &options, uint64_t key, const gtx_limits &limits, Task &task);

/* A cache that cannot be written to is told of by a note. */
void keep_in_cache(const Options &options, uint64_t key, std::string_view file, Task &task);

} // namespace gtx
