/* What all fuzz targets share: counted memory, small limits, scratch files, numbers. */
#include "fuzz/fuzz.hpp"

#include "base/hash.h"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace fuzz {

void found(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    std::fprintf(stderr, "FOUND: ");
    std::vfprintf(stderr, format, args);
    std::fprintf(stderr, "\n");
    va_end(args);
    std::abort();
}

static void *counted_alloc(size_t size, void *user)
{
    Counted *c = static_cast<Counted *>(user);
    void *memory = std::malloc(size + !size);
    c->bytes += size;
    c->most = c->bytes > c->most ? c->bytes : c->most;
    ++c->blocks;
    return memory;
}

static void counted_free(void *memory, size_t size, void *user)
{
    Counted *c = static_cast<Counted *>(user);
    REQUIRE(memory && size <= c->bytes, "%zu bytes come back of %zu", size, c->bytes);
    c->bytes -= size;
    --c->blocks;
    std::free(memory);
}

gtx_allocator Counted::hooks()
{
    return {counted_alloc, counted_free, this};
}

Counted::~Counted()
{
    REQUIRE(!bytes && !blocks, "%zu bytes in %ld blocks do not come back", bytes, blocks);
}

gtx_limits small_limits()
{
    gtx_limits limits = {};
    limits.memory = 64 << 20;
    limits.triangles = 20000;
    limits.texels = limits.pixels = 1 << 20;
    limits.patches = 4096;
    return limits;
}

uint64_t choices(const uint8_t *data, size_t size)
{
    return gtx_hash_bytes(data, size);
}

namespace {
struct Folder {
    std::string path;
    Folder()
    {
        path = (std::filesystem::temp_directory_path() / "geotex-fuzz-XXXXXX").string();
        REQUIRE(mkdtemp(path.data()), "there is no folder for scratch files");
    }
    ~Folder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
};
} // namespace

std::string scratch(const char *name)
{
    static const Folder folder;
    return folder.path + "/" + name;
}

void write_scratch(const char *name, const void *data, size_t size)
{
    FILE *file = std::fopen(scratch(name).c_str(), "wb");
    REQUIRE(file && std::fwrite(data, 1, size, file) == size, "a scratch file cannot be written");
    std::fclose(file);
}

uint32_t Random::below(uint32_t n)
{
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return n ? uint32_t((state_ * 0x9E3779B97F4A7C15u) >> 33) % n : 0;
}

float Random::number()
{
    static const float some[] = {0, -0.0f, 1, -1, 0.5f, 1e-30f, 1e-38f, 1e-45f, 1e30f, 3.4e38f,
                                 -1e30f, 1e10f, 1e-10f, 65536, 2147483648.0f, 1e-3f};
    const uint32_t kind = below(8);
    if (kind < 4)
        return (unit() - 0.5f) * 4;
    if (kind < 7)
        return some[below(sizeof some / sizeof *some)];
    const uint32_t bits = below(1u << 31) * 2u + below(2);
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

} // namespace fuzz
