/* Taking a `.gtx` file apart and putting it together again. */
#include "fuzz/content.hpp"

#include <algorithm>

#ifdef GTX_ZSTD
#include <zstd.h>
#endif

namespace fuzz {

/* Beyond this a mutation would take too long. */
constexpr uint64_t MAX_SECTION = 1 << 20;

Section *Content::find(const char *type, uint32_t level)
{
    for (Section &s : sections)
        if (s.is(type) && s.field(LEVEL) == level)
            return &s;
    return nullptr;
}

static bool decompress(const uint8_t *data, size_t stored, size_t size, Bytes &out)
{
#ifdef GTX_ZSTD
    out.resize(size);
    return ZSTD_decompress(out.data(), size, data, stored) == size;
#else
    return false;
#endif
}

bool take_apart(const uint8_t *data, size_t size, Content &out)
{
    if (size < GTX_HEADER_SIZE)
        return false;
    std::copy_n(data, GTX_HEADER_SIZE, out.header.begin());
    const uint32_t count = out.field(28);
    if (count > 64 || size < GTX_HEADER_SIZE + count * GTX_ENTRY_SIZE)
        return false;
    for (uint32_t i = 0; i < count; ++i) {
        Section s;
        std::copy_n(data + GTX_HEADER_SIZE + i * GTX_ENTRY_SIZE, GTX_ENTRY_SIZE, s.entry.begin());
        const uint64_t offset = gtx_load_u64(&s.entry[16]), stored = gtx_load_u64(&s.entry[24]);
        const uint64_t whole = gtx_load_u64(&s.entry[32]);
        if (offset > size || stored > size - offset || whole > MAX_SECTION)
            return false;
        if (s.field(SCHEME) != 2)
            s.bytes.assign(data + offset, data + offset + stored);
        else if (!decompress(data + offset, stored, whole, s.bytes))
            return false;
        out.sections.push_back(std::move(s));
    }
    return count > 0;
}

static Bytes stored_bytes(const Section &s)
{
#ifdef GTX_ZSTD
    if (s.field(SCHEME) == 2) {
        Bytes out(ZSTD_compressBound(s.bytes.size()));
        out.resize(ZSTD_compress(out.data(), out.size(), s.bytes.data(), s.bytes.size(), 1));
        return out;
    }
#endif
    return s.bytes;
}

Bytes put_together(const Content &content)
{
    const size_t count = content.sections.size();
    Bytes out(GTX_HEADER_SIZE + count * GTX_ENTRY_SIZE);
    std::copy(content.header.begin(), content.header.end(), out.begin());
    for (size_t i = 0; i < count; ++i) {
        const Section &s = content.sections[i];
        const Bytes stored = stored_bytes(s);
        uint8_t *entry = &out[GTX_HEADER_SIZE + i * GTX_ENTRY_SIZE];
        std::copy(s.entry.begin(), s.entry.end(), entry);
        gtx_store_u64(entry + 16, out.size());
        gtx_store_u64(entry + 24, stored.size());
        gtx_store_u64(entry + 32, s.bytes.size());
        out.insert(out.end(), stored.begin(), stored.end());
        out.resize(gtx_align64(out.size()));
    }
    gtx_store_u32(&out[28], uint32_t(count));
    gtx_store_u64(&out[32], out.size());
    return out;
}

/* In file order, but that the coarsest LODM is first; what may be absent has no level there. */
static const struct Kind {
    const char *type;
    uint32_t format, texel, must;
    bool levels;
} kinds[] = {{"PTCH", 0, 0, 1, false},  {"LODM", 0, 0, 0, false},  {"COLR", 43, 4, 0, true},
             {"MATL", 37, 4, 0, true},  {"EMIT", 29, 3, 0, true},  {"HGHT", 13, 1, 1, false},
             {"TRIM", 9, 1, 1, false},  {"NRML", 16, 2, 1, true},  {"META", 0, 0, 0, false}};

static int order_of(const Section &s)
{
    for (int i = 0; i < 9; ++i)
        if (s.is(kinds[i].type))
            return 1000 * (i + (i == 8)) - int(std::min(s.field(LEVEL), 100u));
    return 1000 * 8;
}

/* Texels that are new repeat those that were there. */
static void resize(Bytes &bytes, uint64_t size)
{
    const size_t before = bytes.size();
    bytes.resize(size_t(size));
    for (size_t i = before; i < bytes.size(); ++i)
        bytes[i] = before ? bytes[i % before] : 128;
}

static void fit_images(Content &content, const Kind &kind)
{
    const uint32_t mips = kind.levels ? content.field(MIPS) : 1;
    for (uint32_t level = 0; level < mips; ++level) {
        Section *s = content.find(kind.type, level);
        if (!s) {
            Section fresh;
            std::memcpy(fresh.entry.data(), kind.type, 4);
            fresh.set(FLAGS, kind.must);
            fresh.set(LEVEL, level);
            fresh.set(FORMAT, kind.format);
            content.sections.push_back(fresh);
            s = &content.sections.back();
        }
        const uint32_t texel = kind.format == 13 && s->field(FORMAT) == 74 ? 2 : kind.texel;
        resize(s->bytes, content.texels(level) * texel);
    }
}

void fit(Content &content)
{
    uint32_t mips = std::clamp(content.field(MIPS), 1u, 4u), block = 1u << (mips - 1);
    content.set(MIPS, mips);
    content.set(PAGES, std::clamp(content.field(PAGES), 1u, 3u));
    for (int at : {WIDTH, HEIGHT})
        content.set(at, std::clamp(content.field(at) / block * block, 8u, 64u));
    for (size_t i = content.sections.size(); i-- > 0;) {
        const Section &s = content.sections[i];
        const uint32_t levels = s.is("LODM") ? 8 : order_of(s) < 7500 ? mips : 1;
        if (s.field(LEVEL) >= levels)
            content.sections.erase(content.sections.begin() + long(i));
    }
    for (const Kind &kind : kinds) {
        const bool there = content.find(kind.type) || kind.must;
        if (there && kind.texel)
            fit_images(content, kind);
    }
    if (Section *s = content.find("PTCH")) {
        s->bytes.resize(std::clamp<size_t>(s->bytes.size() / 128, 1, 16) * 128);
        content.set(PATCHES, uint32_t(s->bytes.size() / 128));
    }
    std::stable_sort(content.sections.begin(), content.sections.end(),
                     [](const Section &a, const Section &b) { return order_of(a) < order_of(b); });
    const auto coarsest = std::find_if(content.sections.begin(), content.sections.end(),
                                       [](const Section &s) { return s.is("LODM"); });
    if (coarsest != content.sections.end())
        std::rotate(content.sections.begin(), coarsest, coarsest + 1);
}

} // namespace fuzz
