/* KTX 2.0: header, level index, a descriptor of the format, key and value, and the levels, of which
 * the coarsest lies first. Sections are those of the specification. */
#include "export/ktx2.hpp"

#include "base/bytes.h"
#include "export/uastc_encode.hpp"
#include "mesh/material/srgb.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#ifdef GTX_ZSTD
#include <zstd.h>
#endif

namespace gtx {

namespace {

constexpr size_t HEADER = 80, LEVEL = 24, DESCRIPTOR = 44;
constexpr uint32_t ZSTD_SCHEME = 2;

struct Level {
    uint32_t width, height;
    Vector<uint8_t> texels;
};

/* ---- coarser levels ---- */

void average(TexelKind kind, const uint8_t *const from[4], uint8_t *to)
{
    float mean[3] = {0, 0, 0};
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 4; ++k)
            mean[c] += kind == TexelKind::COLOR     ? srgb_to_linear(from[k][c]) / 4
                       : kind == TexelKind::NORMALS ? (float(from[k][c]) - 127.5f) / 4
                                                    : float(from[k][c]) / 4;
    }
    const float size = std::sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
    for (int c = 0; c < 3; ++c) {
        const float unit = size > 0 ? mean[c] / size : float(c == 2);
        to[c] = kind == TexelKind::COLOR     ? linear_to_srgb(mean[c])
                : kind == TexelKind::NUMBERS ? uint8_t(mean[c] + 0.5f)
                                             : uint8_t(127.5f + 127.5f * unit + 0.5f - 1e-4f);
    }
}

/* A texel is the mean of four; of an odd side the last one is left out. */
Level coarser(const Level &from, TexelKind kind)
{
    Level out = {std::max(from.width / 2, 1u), std::max(from.height / 2, 1u), {}};
    out.texels.resize(3 * size_t(out.width) * out.height);
    for (uint32_t y = 0; y < out.height; ++y)
        for (uint32_t x = 0; x < out.width; ++x) {
            const uint8_t *four[4];
            for (uint32_t k = 0; k < 4; ++k) {
                const uint32_t i = std::min(2 * x + k % 2, from.width - 1);
                const uint32_t j = std::min(2 * y + k / 2, from.height - 1);
                four[k] = &from.texels[3 * (size_t(j) * from.width + i)];
            }
            average(kind, four, &out.texels[3 * (size_t(y) * out.width + x)]);
        }
    return out;
}

/* ---- blocks ---- */

/* Beyond the edge of a small level its last texels go on. */
UastcTexels block_at(const Level &level, uint32_t column, uint32_t row)
{
    UastcTexels out;
    for (uint32_t k = 0; k < UASTC_TEXELS; ++k) {
        const uint32_t x = std::min(4 * column + k % 4, level.width - 1);
        const uint32_t y = std::min(4 * row + k / 4, level.height - 1);
        std::copy_n(&level.texels[3 * (size_t(y) * level.width + x)], 3, out[k].begin());
    }
    return out;
}

Bytes blocks_of(const Level &level, Task &task)
{
    const uint32_t columns = (level.width + 3) / 4, rows = (level.height + 3) / 4;
    Bytes out(size_t(UASTC_BYTES) * columns * rows, '\0');
    task.parallel(rows, [&](size_t row) {
        cancel_point(columns);
        for (uint32_t column = 0; column < columns; ++column) {
            const UastcBlock block = encode_uastc(block_at(level, column, uint32_t(row)));
            std::memcpy(&out[UASTC_BYTES * (row * columns + column)], block.data(), UASTC_BYTES);
        }
    });
    return out;
}

/* The blocks as they are where there is no zstd. */
Bytes packed(const Bytes &blocks)
{
#ifdef GTX_ZSTD
    constexpr int STRENGTH = 9; /* 15 takes four times as long, for 2 % of the bytes */
    Bytes out(ZSTD_compressBound(blocks.size()), '\0');
    const size_t size = ZSTD_compress(out.data(), out.size(), blocks.data(), blocks.size(),
                                      STRENGTH);
    if (ZSTD_isError(size))
        throw Error(GTX_ERROR_MEMORY, "zstd has no memory for a texture");
    out.resize(size);
    return out;
#else
    return blocks;
#endif
}

/* ---- the file ---- */

void put32(Bytes &to, size_t at, uint32_t value)
{
    gtx_store_u32(reinterpret_cast<uint8_t *>(&to[at]), value);
}

void put64(Bytes &to, size_t at, uint64_t value)
{
    put32(to, at, uint32_t(value));
    put32(to, at + 4, uint32_t(value >> 32));
}

/* Basic data format descriptor (3.10): one sample of 128 bits. */
void put_descriptor(Bytes &to, size_t at, TexelKind kind)
{
    constexpr uint32_t VERSION = 2, UASTC = 166, BT709 = 1, LINEAR = 1, SRGB = 2;
    const uint32_t transfer = kind == TexelKind::COLOR ? SRGB : LINEAR;
    const uint32_t words[] = {DESCRIPTOR, 0, VERSION | (DESCRIPTOR - 4) << 16,
                              UASTC | BT709 << 8 | transfer << 16, 3 | 3 << 8, UASTC_BYTES, 0,
                              127 << 16, 0, 0, 0xffffffffu};
    for (size_t k = 0; k < std::size(words); ++k)
        put32(to, at + 4 * k, words[k]);
}

/* Keys in their order (3.11): rows from the top, and who wrote it. */
Bytes key_values()
{
    static const char *const pairs[][2] = {{"KTXorientation", "rd"}, {"KTXwriter", "geotex"}};
    Bytes out;
    for (const auto &pair : pairs) {
        const Bytes text = Bytes(pair[0]) + '\0' + pair[1] + '\0';
        const size_t at = out.size();
        out.resize(at + 4 + (text.size() + 3) / 4 * 4, '\0');
        put32(out, at, uint32_t(text.size()));
        std::copy(text.begin(), text.end(), out.begin() + ptrdiff_t(at + 4));
    }
    return out;
}

} // namespace

Bytes encode_ktx2(uint32_t width, uint32_t height, const uint8_t *texels, TexelKind kind,
                  Task &task)
{
    static const char IDENTIFIER[] = "\xabKTX 20\xbb\r\n\x1a\n";
    Level level = {width, height, {}};
    level.texels.assign(texels, texels + 3 * size_t(width) * height);
    Vector<Bytes> levels;
    Vector<uint64_t> sizes;
    for (bool last = false; !last; level = coarser(level, kind)) {
        const Bytes blocks = blocks_of(level, task);
        sizes.push_back(blocks.size());
        levels.push_back(packed(blocks));
        last = level.width == 1 && level.height == 1;
    }
    const Bytes pairs = key_values();
    const size_t descriptor = HEADER + LEVEL * levels.size();
    Bytes out(descriptor + DESCRIPTOR, '\0');
    std::memcpy(&out[0], IDENTIFIER, sizeof IDENTIFIER - 1);
    put32(out, 16, 1); /* of a type of bytes */
    put32(out, 20, width);
    put32(out, 24, height);
    put32(out, 36, 1); /* a face */
    put32(out, 40, uint32_t(levels.size()));
#ifdef GTX_ZSTD
    put32(out, 44, ZSTD_SCHEME);
#endif
    put32(out, 48, uint32_t(descriptor));
    put32(out, 52, DESCRIPTOR);
    put32(out, 56, uint32_t(out.size()));
    put32(out, 60, uint32_t(pairs.size()));
    put_descriptor(out, descriptor, kind);
    out += pairs;
    for (size_t k = levels.size(); k-- > 0;) {
        out.resize((out.size() + UASTC_BYTES - 1) / UASTC_BYTES * UASTC_BYTES, '\0');
        put64(out, HEADER + LEVEL * k, out.size());
        put64(out, HEADER + LEVEL * k + 8, levels[k].size());
        put64(out, HEADER + LEVEL * k + 16, sizes[k]);
        out += levels[k];
    }
    return out;
}

} // namespace gtx
