/* Mutators that keep most of an input right: hashes, lengths, checksums. */
#include "fuzz/content.hpp"
#include "fuzz/decoder.h"

#include <algorithm>

#include <zlib.h>

namespace fuzz {

size_t mutate_gtx(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    Random random(seed);
    Content content;
    if (random.chance(16) || !take_apart(data, size, content))
        return mutate_bytes(data, size, most);
    for (uint32_t n = 1 + random.below(3); n > 0; --n)
        change(content, random);
    if (!random.chance(12))
        fit(content);
    Bytes file = put_together(content);
    if (file.size() > most) /* smaller where zstd makes it so */
        for (Section &s : content.sections)
            s.set(SCHEME, 2);
    file = file.size() > most ? put_together(content) : file;
    if (file.size() > most)
        return mutate_bytes(data, size, most);
    decoder_settle(file.data(), file.size(), !random.chance(10));
    if (random.chance(16)) {
        file[random.below(uint32_t(file.size()))] ^= uint8_t(1u << random.below(8));
        decoder_settle(file.data(), file.size(), 0);
    }
    std::copy(file.begin(), file.end(), data);
    return file.size();
}

/* Chunks of a GLB: text and bytes, each with a length that is right. */
size_t mutate_glb(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    Random random(seed);
    if (size < 20 || std::memcmp(data, "glTF", 4) || random.chance(10) || most < size + 128)
        return mutate_bytes(data, size, most);
    const size_t text_size = std::min<size_t>(gtx_load_u32(data + 12), size - 20);
    const size_t next = 20 + text_size;
    Bytes parts[2] = {Bytes(data + 20, data + next), Bytes()};
    if (size >= next + 8)
        parts[1].assign(data + next + 8, data + size);
    Bytes &changed = parts[random.chance(3)];
    const size_t before = changed.size();
    changed.resize(before + 64);
    changed.resize(mutate_bytes(changed.data(), before, before + 64));
    parts[0].resize((parts[0].size() + 3) / 4 * 4, ' ');
    parts[1].resize((parts[1].size() + 3) / 4 * 4);
    size_t end = 12;
    static const uint32_t types[2] = {0x4E4F534A, 0x004E4942};
    for (int i = 0; i < 2; ++i) {
        gtx_store_u32(data + end, uint32_t(parts[i].size()));
        gtx_store_u32(data + end + 4, types[i]);
        std::copy(parts[i].begin(), parts[i].end(), data + end + 8);
        end += 8 + parts[i].size();
    }
    gtx_store_u32(data + 8, uint32_t(end));
    return end;
}

static Bytes inflated(const uint8_t *data, size_t size)
{
    Bytes out(1 << 16);
    z_stream stream = {};
    stream.next_in = const_cast<Bytef *>(data);
    stream.avail_in = uInt(size);
    stream.next_out = out.data();
    stream.avail_out = uInt(out.size());
    inflateInit2(&stream, 15 + 16);
    inflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    inflateEnd(&stream);
    return out;
}

static Bytes deflated(const Bytes &bytes, int level)
{
    Bytes out(bytes.size() + 1000);
    z_stream stream = {};
    deflateInit2(&stream, level, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY);
    stream.next_in = const_cast<Bytef *>(bytes.data());
    stream.avail_in = uInt(bytes.size());
    stream.next_out = out.data();
    stream.avail_out = uInt(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

size_t mutate_gzip(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    Random random(seed);
    if (random.chance(2))
        return mutate_bytes(data, size, most);
    Bytes content = inflated(data, size);
    const size_t before = content.size();
    content.resize(before + 64);
    content.resize(mutate_bytes(content.data(), before, before + 64));
    const Bytes packed = deflated(content, int(random.below(10)));
    if (packed.size() > most)
        return mutate_bytes(data, size, most);
    std::copy(packed.begin(), packed.end(), data);
    return packed.size();
}

} // namespace fuzz
