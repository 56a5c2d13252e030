/* Encoding an asset on a task's threads. */
#pragma once

#include "cook/options.hpp"

#include "base/alloc.h"
#include "base/output.h"

#include <geotex/frame.h>

#include <string_view>

namespace gtx {

/* Jobs of the C rooms on a task's threads. What ends them early must not pass through C: it is kept
 * for whoever made the call. */
struct TaskJobs {
    Task &task;
    std::exception_ptr thrown = nullptr;

    static void run(uint32_t count, void (*job)(uint32_t, void *), void *data, void *user)
    {
        auto *self = static_cast<TaskJobs *>(user);
        try {
            self->task.parallel(count, [&](size_t i) { job(uint32_t(i), data); });
        } catch (...) {
            self->thrown = std::current_exception();
        }
    }
};

static_assert(GTX_TEXTURES_BC == 1 << GTX_COMPRESS_BC &&
              GTX_TEXTURES_ETC2 == 1 << GTX_COMPRESS_ETC2 &&
              GTX_TEXTURES_BC_SMALL == 1 << GTX_COMPRESS_BC_SMALL, "as cook.h says");

/* Blocks of the asset's maps, as asked for. */
inline void add_textures(gtx_asset *asset, const Options &options, Task &task)
{
    TaskJobs on_task = {task};
    const gtx_jobs jobs = {TaskJobs::run, &on_task};
    gtx_model_desc desc = {};
    desc.allocator = &options.allocator;
    desc.jobs = &jobs;
    desc.limits.memory = UINT64_MAX; /* those of the cook hold */
    desc.compress_normals = options.texture_formats & GTX_TEXTURES_NORMALS;
    for (uint32_t kind = GTX_COMPRESS_BC; kind <= GTX_COMPRESS_BC_SMALL; ++kind) {
        if (!(options.texture_formats >> kind & 1))
            continue;
        gtx_error error;
        desc.compress = gtx_compression(kind);
        const gtx_result result = gtx_add_blocks(asset, &desc, &error);
        if (on_task.thrown)
            std::rethrow_exception(on_task.thrown);
        require_ok(result, error);
    }
}

/* The bytes of a file. */
struct Encoded {
    gtx_allocator allocator;
    void *data = nullptr;
    size_t size = 0;

    Encoded(const gtx_asset *asset, const Options &options, Task &task)
        : allocator(options.allocator)
    {
        TaskJobs on_task = {task};
        const gtx_jobs jobs = {TaskJobs::run, &on_task};
        gtx_encode_desc desc = {};
        desc.allocator = &allocator;
        desc.jobs = &jobs;
        desc.zstd_level = options.zstd ? options.zstd : -1;
        gtx_error error;
        const gtx_result result = gtx_encode(asset, &desc, &data, &size, &error);
        if (on_task.thrown) {
            gtx_free_array(&allocator, data, size, 1);
            std::rethrow_exception(on_task.thrown);
        }
        require_ok(result, error);
    }
    ~Encoded() { gtx_free_array(&allocator, data, size, 1); }
    Encoded(const Encoded &) = delete;
    Encoded &operator=(const Encoded &) = delete;

    std::string_view view() const { return {static_cast<const char *>(data), size}; }
    void save(const char *path) const
    {
        gtx_error error;
        require_ok(gtx_write_file(path, data, size, &error), error);
    }
};

} // namespace gtx
