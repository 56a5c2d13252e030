/* What a Draco stream claims to hold, read before a decoder takes memory for it (Draco bitstream
 * specification, sections "Decode header", "Decode metadata", "Decode connectivity"). */
#include "mesh/import/draco.hpp"

#include "base/bytes.h"

namespace gtx {

namespace {

/* Numbers of a stream; all zero once it has ended. */
class Stream {
public:
    explicit Stream(std::string_view bytes) : bytes_(bytes) {}

    uint32_t byte()
    {
        if (bytes_.empty())
            return 0;
        const auto value = uint8_t(bytes_.front());
        bytes_.remove_prefix(1);
        return value;
    }
    uint32_t word()
    {
        uint32_t value = 0;
        for (int shift = 0; shift < 32; shift += 8)
            value |= byte() << shift;
        return value;
    }
    uint32_t varint()
    {
        uint64_t value = 0;
        for (int shift = 0; shift < 35; shift += 7) {
            const uint32_t next = byte();
            value |= uint64_t(next & 0x7f) << shift;
            if (next < 0x80)
                break;
        }
        return uint32_t(value);
    }
    void skip(size_t count) { bytes_.remove_prefix(std::min(count, bytes_.size())); }
    bool ended() const { return bytes_.empty(); }

private:
    std::string_view bytes_;
};

} // namespace

/* Names and values, and the same below them; the decoder finds fault with what is damaged. */
static void skip_metadata(Stream &stream)
{
    constexpr uint32_t METADATA_DEPTH = 64;
    uint32_t left[METADATA_DEPTH], depth = 0;
    const auto enter = [&] {
        for (uint32_t entries = stream.varint(); entries > 0 && !stream.ended(); --entries) {
            stream.skip(stream.byte());
            stream.skip(stream.varint());
        }
        left[depth++] = stream.varint();
    };
    enter();
    while (depth > 0 && !stream.ended()) {
        if (left[depth - 1] == 0) {
            --depth;
        } else if (depth == METADATA_DEPTH) {
            fail(GTX_ERROR_INPUT, "the Draco metadata is nested more than %u levels deep",
                 METADATA_DEPTH);
        } else {
            --left[depth - 1];
            stream.skip(stream.byte());
            enter();
        }
    }
}

DracoClaims draco_claims(std::string_view bytes)
{
    constexpr uint32_t EDGEBREAKER = 1, HAS_METADATA = 0x8000;
    Stream stream(bytes);
    stream.skip(5); /* "DRACO" */
    const uint32_t major = stream.byte(), minor = stream.byte(), version = major << 8 | minor;
    stream.skip(1); /* a mesh, as the caller knows */
    const uint32_t method = stream.byte(), low = stream.byte(), flags = low | stream.byte() << 8;
    if (version >= 0x103 && flags & HAS_METADATA) {
        for (uint32_t attributes = stream.varint(); attributes > 0 && !stream.ended();
             --attributes) {
            stream.varint();
            skip_metadata(stream);
        }
        skip_metadata(stream);
    }

    const bool fixed = method == EDGEBREAKER ? version < 0x200 : version < 0x202;
    const auto number = [&] { return fixed ? stream.word() : stream.varint(); };
    DracoClaims claims;
    if (method != EDGEBREAKER) {
        claims.faces = number();
        claims.points = number();
        return claims;
    }
    stream.skip(1); /* how it was traversed */
    if (version < 0x202)
        number(); /* new vertices */
    claims.points = number();
    claims.faces = number();
    stream.skip(1); /* attributes */
    number();       /* symbols */
    claims.points += number(); /* splits of vertices */
    return claims;
}

} // namespace gtx
