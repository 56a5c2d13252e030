/* Assets inside GLB files, and the bytes of files. */
#pragma once

#include "cook/assemble.hpp"

#include "base/file.h"

#include <string_view>

namespace gtx {

/* The asset that a GLB holds; other bytes are returned as they are. Throws Error: EMPTY where the
 * GLB holds none, INPUT, LIMIT, UNSUPPORTED. */
std::string_view asset_in(std::string_view bytes);

/* Throws Error: what gtx_open_memory reports. */
Asset open_asset(std::string_view bytes, const gtx_allocator &allocator, const gtx_limits &limits);

/* The bytes of a file, in memory of an allocator. */
struct FileBytes : gtx_file_bytes {
    FileBytes(const char *path, const gtx_allocator &hooks, const gtx_limits &limits)
        : gtx_file_bytes{}
    {
        allocator = hooks;
        limit = limits.memory;
        gtx_error error;
        require_ok(gtx_read_file(path, path, this, &error), error);
    }
    ~FileBytes() { gtx_free_file(this); }
    FileBytes(const FileBytes &) = delete;
    FileBytes &operator=(const FileBytes &) = delete;
    std::string_view view() const { return {reinterpret_cast<const char *>(data), size}; }
};
} // namespace gtx
