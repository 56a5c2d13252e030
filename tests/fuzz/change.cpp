/* Changes of what a `.gtx` file means: numbers, frames, maps, meshes, sections. */
#include "fuzz/content.hpp"

#include <algorithm>
#include <cmath>

namespace fuzz {

static void put(uint8_t *at, float value)
{
    std::memcpy(at, &value, sizeof value);
}

static float get(const uint8_t *at)
{
    float value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

static uint32_t some_integer(Random &random)
{
    static const uint32_t some[] = {0, 1, 2, 3, 7, 8, 16, 17, 255, 256, 65535, 65536, 1u << 20,
                                    0x7fffffff, 0x80000000, 0xffffffff};
    return random.chance(2) ? random.below(20) : some[random.below(16)];
}

static void change_header(Content &content, Random &random)
{
    static const int integers[] = {12, 16, 20, 24, 28, 40, 48, 52, 56, 60, 64, 68, 100, 136, 148};
    static const int floats[] = {72, 76, 80, 84, 88, 92, 96, 144};
    uint8_t *h = content.header.data();
    switch (random.below(4)) {
    case 0: content.set(integers[random.below(15)], some_integer(random)); break;
    case 1: put(h + floats[random.below(8)], random.number()); break;
    case 2: {
        const double anchor = random.number();
        std::memcpy(h + 104 + 8 * random.below(3), &anchor, sizeof anchor);
        break;
    }
    default: /* all that it shows, larger or smaller */
        for (int at = 72; at < 96; at += 4)
            put(h + at, get(h + at) * std::fabs(random.number()));
    }
}

static uint8_t *record_of(Content &content, Random &random)
{
    Section *s = content.find("PTCH");
    const size_t count = s ? s->bytes.size() / 128 : 0;
    return count ? &s->bytes[128 * random.below(uint32_t(count))] : nullptr;
}

/* Three axes of length 1, right-handed; x and y may tilt against z. */
static void turn_frame(uint8_t *r, Random &random)
{
    const bool tilted = random.chance(2);
    double axis[3][3], length = 0;
    for (double &v : axis[2])
        v = random.unit() - 0.5;
    for (double v : axis[2])
        length += v * v;
    for (double &v : axis[2])
        v /= std::max(std::sqrt(length), 1e-3);
    const double *z = axis[2], s = z[2] >= 0 ? 1 : -1, a = -1 / (s + z[2]), b = z[0] * z[1] * a;
    const double x[3] = {1 + s * z[0] * z[0] * a, s * b, -s * z[0]};
    const double y[3] = {b, s + z[1] * z[1] * a, -z[1]};
    for (int which = 0; which < 2; ++which) {
        const double tilt = tilted ? 3 * (random.unit() - 0.5) : 0;
        for (int k = 0; k < 3; ++k)
            axis[which][k] = ((which ? y : x)[k] + tilt * z[k]) / std::sqrt(1 + tilt * tilt);
    }
    for (int which = 0; which < 3; ++which)
        for (int k = 0; k < 3; ++k)
            put(r + 16 + 16 * which + 4 * k, float(axis[which][k]));
}

static void resize_frame(uint8_t *r, Random &random)
{
    const float scale = std::fabs(random.number());
    for (int at : {12, 28, 44})
        put(r + at, random.chance(3) ? std::fabs(random.number()) : get(r + at) * scale);
    put(r + 44, std::max(get(r + 44), std::max(get(r + 12), get(r + 28)) / 4096));
}

static void change_record(Content &content, Random &random)
{
    uint8_t *r = record_of(content, random);
    if (!r)
        return;
    const uint32_t block = 1u << ((content.field(MIPS) - 1) & 3);
    switch (random.below(8)) {
    case 0: turn_frame(r, random); break;
    case 1: resize_frame(r, random); break;
    case 2: put(r + 4 * random.below(3), random.number()); break;
    case 3: gtx_store_u16(r + 76, uint16_t(some_integer(random))); break;
    case 4: gtx_store_u16(r + 78, random.chance(8) ? uint16_t(random.below(65536))
                                                   : uint16_t(random.below(2) << 8)); break;
    case 5: gtx_store_u16(r + 68 + 2 * random.below(4), uint16_t(block * random.below(9))); break;
    case 6: gtx_store_u32(r + 96, some_integer(random)); break;
    default: put(r + 4 * random.below(25), random.number());
    }
}

/* A patch more, or fewer; rectangles side by side in a grid over all pages. */
static void deal_rectangles(Content &content, Random &random)
{
    Section *s = content.find("PTCH");
    if (!s || s->bytes.size() < 128 || content.field(MIPS) - 1 > 3)
        return;
    const uint32_t block = std::max(2u, 1u << (content.field(MIPS) - 1));
    const uint32_t columns = 1 + random.below(3), rows = 1 + random.below(3);
    const uint32_t w = content.field(WIDTH) / columns / block * block;
    const uint32_t h = content.field(HEIGHT) / rows / block * block, old = 128;
    const uint32_t most = std::min(columns * rows * std::min(content.field(PAGES), 3u), 12u);
    if (!w || !h || !most)
        return;
    Bytes records(old * (1 + random.below(most)));
    for (size_t i = 0; i < records.size() / old; ++i) {
        const size_t from = old * (i % (s->bytes.size() / old)), cell = i % (columns * rows);
        std::copy_n(&s->bytes[from], old, &records[old * i]);
        uint8_t *r = &records[old * i];
        const size_t rectangle[] = {cell % columns * w, cell / columns * h, w, h};
        gtx_store_u32(r + 64, uint32_t(i / (columns * rows)));
        for (int k = 0; k < 4; ++k)
            gtx_store_u16(r + 68 + 2 * k, uint16_t(rectangle[k]));
        if (random.chance(2))
            put(r + 4 * random.below(3), random.number());
    }
    s->bytes = records;
    content.set(PATCHES, uint32_t(records.size() / old));
}

/* Codes of a rectangle of a page: all alike, noise, a ramp, none, or a few holes. */
static void change_map(Content &content, Random &random)
{
    static const char *const types[] = {"HGHT", "HGHT", "HGHT", "TRIM", "TRIM", "NRML", "COLR",
                                        "MATL", "EMIT"};
    Section *s = content.find(types[random.below(9)], random.chance(4) ? random.below(4) : 0);
    if (!s || s->bytes.empty() || !content.texels(0))
        return;
    const uint64_t all = content.texels(s->field(LEVEL) & 7), width = content.field(WIDTH);
    const size_t texel = all ? std::max<size_t>(s->bytes.size() / all, 1) : 1;
    const uint32_t how = random.below(6), level = s->field(LEVEL) & 7;
    const size_t from = random.below(uint32_t(s->bytes.size()));
    const size_t row = std::max<size_t>((width >> level) * texel, 1);
    const size_t across = 1 + random.below(uint32_t(row)), down = 1 + random.below(16);
    const uint8_t value = uint8_t(random.below(256));
    for (size_t y = 0; y < down; ++y)
        for (size_t x = 0; x < across; ++x) {
            const size_t at = from + y * row + x;
            if (at >= s->bytes.size())
                return;
            uint8_t &b = s->bytes[at];
            switch (how) {
            case 0: b = value; break;
            case 1: b = uint8_t(random.below(256)); break;
            case 2: b = uint8_t(value + x + 3 * y); break;
            case 3: b = 0; break;
            case 4: b = random.chance(4) ? uint8_t(0) : b; break;
            default: b = uint8_t(b + random.below(5) - 2);
            }
        }
}

static void change_meta(Content &content, Random &random)
{
    Section *s = content.find("META");
    if (!s)
        return;
    const size_t before = s->bytes.size();
    s->bytes.resize(before + 64);
    s->bytes.resize(std::max<size_t>(mutate_bytes(s->bytes.data(), before, before + 64), 1));
    (void)random;
}

/* A square of 2 side^2 triangles over the first patch, in the order that its numbers must have. */
static Section square_mesh(Content &content, uint32_t level, Random &random)
{
    const uint32_t side = 1 + random.below(3), triangles = 2 * side * side;
    const uint32_t patches = content.field(PATCHES), owner = random.below(std::min(patches, 16u));
    std::vector<uint32_t> words(8), name((side + 1) * (side + 1), UINT32_MAX);
    std::vector<uint16_t> positions;
    for (uint32_t p = 0; p <= patches && p < 4096; ++p)
        words.push_back(p > owner ? triangles : 0);
    for (uint32_t i = 0; i < 3 * triangles; ++i) {
        static const uint32_t corners[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0, 1}, {1, 0}, {1, 1}};
        const uint32_t cell = i / 6, x = cell % side + corners[i % 6][0];
        const uint32_t y = cell / side + corners[i % 6][1];
        uint32_t &n = name[y * (side + 1) + x];
        if (n == UINT32_MAX) {
            n = uint32_t(positions.size() / 3);
            for (uint32_t q : {x * 1000 / side, y * 1000 / side, random.below(500)})
                positions.push_back(uint16_t(q));
        }
        words.push_back(n);
    }
    words[5] = uint32_t(positions.size() / 3);
    words[6] = triangles;
    words[7] = random.below(2);
    Section s;
    std::memcpy(s.entry.data(), "LODM", 4);
    s.set(LEVEL, level);
    s.bytes.resize(4 * words.size() + 2 * positions.size());
    for (size_t i = 0; i < words.size(); ++i)
        gtx_store_u32(&s.bytes[4 * i], words[i]);
    for (size_t i = 0; i < positions.size(); ++i)
        gtx_store_u16(&s.bytes[4 * words.size() + 2 * i], positions[i]);
    put(&s.bytes[12], 1.0f / 1024);
    put(&s.bytes[16], float(level) * 0.25f);
    return s;
}

static void change_mesh(Content &content, Random &random)
{
    uint32_t levels = 0;
    while (content.find("LODM", levels))
        ++levels;
    Section *s = levels ? content.find("LODM", random.below(levels)) : nullptr;
    const uint32_t how = random.below(6);
    if (!s || s->bytes.size() < 36 || how == 0) {
        content.sections.push_back(square_mesh(content, std::min(levels, 7u), random));
    } else if (how == 1) {
        *s = square_mesh(content, s->field(LEVEL), random);
    } else if (how == 2) {
        put(&s->bytes[4 * random.below(5)], random.number());
    } else {
        const size_t header = how == 3 ? 32 : s->bytes.size() / 4 * 4;
        uint8_t *word = &s->bytes[4 * random.below(uint32_t(header / 4))];
        gtx_store_u32(word, random.chance(3) ? some_integer(random)
                                             : gtx_load_u32(word) + random.below(5) - 2);
    }
}

static void add_or_remove(Content &content, Random &random)
{
    static const char *const types[] = {"COLR", "MATL", "EMIT", "LODM", "META", "XTRA"};
    const char *type = types[random.below(6)];
    const size_t before = content.sections.size();
    auto gone = std::remove_if(content.sections.begin(), content.sections.end(),
                               [&](const Section &s) { return s.is(type); });
    content.sections.erase(gone, content.sections.end());
    if (type == std::string("EMIT"))
        put(&content.header[144], content.sections.size() == before ? 2.5f : 0.0f);
    if (content.sections.size() != before)
        return;
    if (type == std::string("LODM"))
        return content.sections.push_back(square_mesh(content, 0, random));
    Section s;
    std::memcpy(s.entry.data(), type, 4);
    static const uint8_t colour[] = {43, 37, 29};
    for (int k = 0; k < 3; ++k)
        if (s.is(types[k]))
            s.set(FORMAT, colour[k]);
    s.bytes.assign(type[0] == 'M' || type[0] == 'X' ? 2 : 0, '{');
    content.sections.push_back(s);
}

static void change_coding(Content &content, Random &random)
{
    Section &s = content.sections[random.below(uint32_t(content.sections.size()))];
    static const uint32_t own[] = {0, 5, 4, 4, 3, 3, 1, 6, 0};
    static const char *const types[] = {"PTCH", "HGHT", "TRIM", "NRML", "COLR", "MATL", "EMIT",
                                        "LODM", "META"};
    uint32_t filter = random.below(random.chance(8) ? 8 : 4);
    for (int i = 0; i < 9; ++i)
        if (s.is(types[i]) && random.chance(2))
            filter = own[i];
    const bool stored = random.chance(3);
    s.set(SCHEME, stored ? 0 : 2);
    s.set(FILTER, stored || s.is("PTCH") || s.is("META") ? 0 : filter);
    if (random.chance(16))
        s.set(4 + 4 * int(random.below(15)), some_integer(random));
}

static void change_pages(Content &content, Random &random)
{
    switch (random.below(4)) {
    case 0: content.set(PAGES, 1 + random.below(3)); break;
    case 1: content.set(WIDTH, 8 * (1 + random.below(4))); break;
    case 2: content.set(HEIGHT, 8 * (1 + random.below(4))); break;
    default: content.set(MIPS, 1 + random.below(4));
    }
    if (Section *s = content.find("HGHT"))
        if (random.chance(3))
            s->set(FORMAT, random.chance(2) ? 13 : 74);
    deal_rectangles(content, random);
}

void change(Content &content, Random &random)
{
    static void (*const changes[])(Content &, Random &) = {
        change_header, change_record, change_record, change_record, change_map,
        change_map,    change_map,    change_map,    change_mesh,   change_mesh,
        change_meta,   add_or_remove, change_coding, change_coding, change_pages,
        deal_rectangles};
    changes[random.below(16)](content, random);
}

} // namespace fuzz
