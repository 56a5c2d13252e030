/* A file read in blocks, of which a bounded number stays in memory. Internal to lib/mesh. */
#pragma once

#include "mesh/import/import.hpp"
#include "mesh/stream.hpp"

#include <fstream>

namespace gtx {

class PagedFile {
public:
    /* Throws Error: READ. */
    PagedFile(const std::string &path, Task &task);

    uint64_t size() const { return size_; }
    /* Copies bytes [at, at + count). Throws Error: INPUT past the end, READ, CANCELLED. */
    void read(uint64_t at, void *to, size_t count)
    {
        const uint64_t block = at / BLOCK, in = at % BLOCK;
        Slot &slot = slots_[block % SLOTS];
        if (slot.block == block && in + count <= slot.size)
            std::char_traits<char>::copy(static_cast<char *>(to), slot.bytes.data() + in, count);
        else
            read_across(at, static_cast<char *>(to), count);
    }

private:
    static constexpr uint64_t BLOCK = 1 << 16, SLOTS = 1 << 10, NONE = UINT64_MAX;
    struct Slot {
        uint64_t block = NONE;
        size_t size = 0;
        Bytes bytes;
    };
    void read_across(uint64_t at, char *to, size_t count);
    const Slot &load(uint64_t block);

    std::ifstream file_;
    uint64_t size_ = 0;
    Vector<Slot> slots_;
};

/* Null where the file is not one that can be read in pieces. */
std::unique_ptr<TriangleStream> open_ply_stream(const std::string &path, Task &task);
std::unique_ptr<TriangleStream> open_stl_stream(const std::string &path, Task &task);
std::unique_ptr<TriangleStream> open_glb_stream(const std::string &path, Task &task);

} // namespace gtx
