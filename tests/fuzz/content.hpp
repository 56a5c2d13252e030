/* A `.gtx` file taken apart: header, table and what the sections hold once zstd is undone. */
#pragma once

#include "fuzz/fuzz.hpp"

#include "asset/section.h"
#include "base/bytes.h"

#include <array>
#include <cstring>

namespace fuzz {

struct Section {
    std::array<uint8_t, GTX_ENTRY_SIZE> entry{};
    Bytes bytes; /* filters are not undone */

    bool is(const char *type) const { return !std::memcmp(entry.data(), type, 4); }
    uint32_t field(int at) const { return gtx_load_u32(&entry[at]); }
    void set(int at, uint32_t value) { gtx_store_u32(&entry[at], value); }
};

struct Content {
    std::array<uint8_t, GTX_HEADER_SIZE> header{};
    std::vector<Section> sections;

    uint32_t field(int at) const { return gtx_load_u32(&header[at]); }
    void set(int at, uint32_t value) { gtx_store_u32(&header[at], value); }
    uint64_t texels(uint32_t level) const
    {
        return uint64_t(field(56)) * (field(60) >> level) * (field(64) >> level);
    }
    Section *find(const char *type, uint32_t level = 0);
};

/* Where fields of the header and of entries lie. */
enum { PATCHES = 52, PAGES = 56, WIDTH = 60, HEIGHT = 64, MIPS = 68 };
enum { FLAGS = 4, LEVEL = 8, FORMAT = 12, SCHEME = 40, FILTER = 44 };

/* False where the bytes are not even that much of a file. */
bool take_apart(const uint8_t *data, size_t size, Content &out);

/* Lays sections out, with counts, sizes and offsets as they must be. */
Bytes put_together(const Content &content);

/* Gives every section the size that the header asks for, and the header the sections that its mip
 * levels ask for. */
void fit(Content &content);

/* One change of something that the content means. */
void change(Content &content, Random &random);

} // namespace fuzz
