/* The bytes of a model's files: looked at, read whole, inflated. */
#include "mesh/import/import.hpp"

#include "base/alloc.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>

#define ZLIB_CONST
#include <zlib.h>

namespace gtx {

Bytes read_whole_file(const std::string &path, Task &task, gtx_file_look look, void *user)
{
    gtx_file_bytes file = {};
    gtx_error error;
    file.allocator = gtx_allocator_or_default(nullptr);
    file.limit = task.limits.given().memory;
    file.look = look;
    file.user = user;
    require_ok(gtx_read_file(path.c_str(), "the file", &file, &error), error);
    std::unique_ptr<gtx_file_bytes, void (*)(gtx_file_bytes *)> owner(&file, gtx_free_file);
    task.limits.read(path, file.size);
    TakenMemory taken(file.capacity);
    return Bytes(reinterpret_cast<const char *>(file.data), file.size);
}

Bytes read_file_beside(const std::string &path, Task &task)
{
    std::error_code error;
    const auto type = std::filesystem::status(path, error).type();
    if (type == std::filesystem::file_type::not_found)
        fail(GTX_ERROR_READ, "cannot open the file: %s", std::strerror(ENOENT));
    if (type != std::filesystem::file_type::regular)
        fail(GTX_ERROR_READ, "cannot read the file: it is not a regular one");
    return read_whole_file(path, task);
}

static const char GZIP_MAGIC[] = "\x1f\x8b";

namespace {
/* Who looks at the first bytes of a file, and once more at those that gzip has packed. */
struct Look {
    gtx_file_look look;
    std::string path;

    static gtx_result at_packed(const uint8_t *head, size_t size, uint64_t file_size, void *self,
                                gtx_error *error)
    {
        const bool is_gzip = size >= 2 && !std::memcmp(head, GZIP_MAGIC, 2);
        return is_gzip ? GTX_OK : static_cast<Look *>(self)->at(head, size, file_size, error);
    }
    gtx_result at(const uint8_t *head, size_t size, uint64_t file_size, gtx_error *error)
    {
        return look(head, size, file_size, &path, error);
    }
};
} // namespace

/* All members of a gzip file, one after another; what follows the last is ignored as gzip does. */
static Bytes inflate_gzip(std::string_view packed, Look &look, Task &task)
{
    z_stream stream = {};
    if (inflateInit2(&stream, 15 + 16) != Z_OK)
        fail(GTX_ERROR_MEMORY, "not enough memory to inflate the file");
    std::unique_ptr<z_stream, int (*)(z_stream *)> guard(&stream, inflateEnd);
    Bytes out;
    bool looked = false;
    Vector<char> block(size_t(1) << 14);
    size_t at = 0;
    for (int status = Z_OK; status != Z_STREAM_END || packed.compare(at, 2, GZIP_MAGIC) == 0;) {
        if (status == Z_STREAM_END)
            inflateReset(&stream);
        size_t input = std::min(packed.size() - at, block.size());
        stream.next_in = reinterpret_cast<const Bytef *>(packed.data() + at);
        stream.avail_in = uInt(input);
        stream.next_out = reinterpret_cast<Bytef *>(block.data());
        stream.avail_out = uInt(block.size());
        status = inflate(&stream, Z_NO_FLUSH);
        if (status == Z_MEM_ERROR)
            throw std::bad_alloc();
        if (status == Z_BUF_ERROR)
            fail(GTX_ERROR_INPUT, "the gzip data ends too early");
        if (status != Z_OK && status != Z_STREAM_END)
            fail(GTX_ERROR_INPUT, "the gzip data is damaged at byte %zu", at);
        at += input - stream.avail_in;
        out.append(block.data(), block.size() - stream.avail_out);
        if (!looked && (out.size() >= GTX_FILE_HEAD || status == Z_STREAM_END)) {
            gtx_error error;
            const auto *head = reinterpret_cast<const uint8_t *>(out.data());
            const size_t size = std::min(out.size(), size_t(GTX_FILE_HEAD));
            require_ok(look.at(head, size, 0, &error), error);
            looked = true;
        }
        task.advance(0.1 * double(at) / double(packed.size()));
    }
    return out;
}

ModelFile unpacked_file(Bytes bytes, const std::string &path, Task &task, gtx_file_look first)
{
    Look look = {first, path};
    if (bytes.compare(0, 2, GZIP_MAGIC) == 0)
        bytes = inflate_gzip(bytes, look, task);
    return ModelFile{look.path, std::move(bytes), nullptr};
}

ModelFile read_packed_file(const std::string &path, Task &task, gtx_file_look first)
{
    return within_memory([&] {
        Look look = {first, path};
        return unpacked_file(read_whole_file(path, task, Look::at_packed, &look), path, task,
                             first);
    });
}

} // namespace gtx
