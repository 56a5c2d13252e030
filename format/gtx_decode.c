/* Decodes a .gtx file: written from gtx.md alone, in C99, with libc and libzstd.
 *
 *   cc -std=c99 gtx_decode.c -lzstd -lm -o gtx_decode      (-DNO_ZSTD: stored files only)
 *   gtx_decode FILE                 prints what the file holds; exit 0
 *                                   or the number of the rule that it breaks; exit 3
 *
 * Made to be read, not to be fast. Exit 2: FILE cannot be read; 5: no memory, or no zstd. */
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifndef NO_ZSTD
#include <zstd.h>
#endif

enum { HEADER = 192, ENTRY = 64, RECORD = 128, MAX_SECTIONS = 256 };
enum { NO_MEMORY = 1, UNSUPPORTED = 2 }; /* in place of a rule */
enum { LOD_HEADER = 32, MAX_LODS = 8 };
enum { UNKNOWN = 500 };                  /* the order of sections to skip */

typedef unsigned char byte;
struct section {
    char type[5];
    uint32_t flags, level, format, scheme, filter;
    uint64_t offset, stored_size, size, hash;
    uint32_t width, height, texel; /* of an image; else 0 */
    byte *bytes;                   /* decoded; NULL when skipped */
};

struct file {
    const byte *data;
    uint64_t size;
    uint32_t patches, pages, width, height, mips, section_count, bits;
    struct section section[MAX_SECTIONS];
};

static uint64_t load(const byte *p, int count)
{
    uint64_t value = 0;
    while (count-- > 0)
        value = value << 8 | p[count];
    return value;
}

static uint32_t u16(const byte *p) { return (uint32_t)load(p, 2); }
static uint32_t u32(const byte *p) { return (uint32_t)load(p, 4); }
static uint64_t u64(const byte *p) { return load(p, 8); }

static double f32(const byte *p)
{
    uint32_t bits = u32(p);
    float value;
    memcpy(&value, &bits, 4);
    return value;
}

static double f64(const byte *p)
{
    uint64_t bits = u64(p);
    double value;
    memcpy(&value, &bits, 8);
    return value;
}

static uint64_t align64(uint64_t n) { return (n + 63) / 64 * 64; }

static int all_zero(const byte *p, uint64_t count)
{
    while (count-- > 0)
        if (*p++)
            return 0;
    return 1;
}

/* ---- XXH64, seed 0 ---- */

static const uint64_t p1 = 0x9E3779B185EBCA87u, p2 = 0xC2B2AE3D27D4EB4Fu,
                      p3 = 0x165667B19E3779F9u, p4 = 0x85EBCA77C2B2AE63u, p5 = 0x27D4EB2F165667C5u;

static uint64_t rotl(uint64_t v, int bits) { return v << bits | v >> (64 - bits); }

static uint64_t xxh_round(uint64_t acc, uint64_t lane) { return rotl(acc + lane * p2, 31) * p1; }

static uint64_t xxh64(const byte *p, uint64_t size)
{
    uint64_t lane[4] = {p1 + p2, p2, 0, 0 - p1}, acc = p5, left = size;
    for (; left >= 32; left -= 32)
        for (int i = 0; i < 4; ++i, p += 8)
            lane[i] = xxh_round(lane[i], u64(p));
    if (size >= 32) {
        acc = rotl(lane[0], 1) + rotl(lane[1], 7) + rotl(lane[2], 12) + rotl(lane[3], 18);
        for (int i = 0; i < 4; ++i)
            acc = (acc ^ xxh_round(0, lane[i])) * p1 + p4;
    }
    acc += size;
    for (; left >= 8; left -= 8, p += 8)
        acc = rotl(acc ^ xxh_round(0, u64(p)), 27) * p1 + p4;
    for (; left >= 4; left -= 4, p += 4)
        acc = rotl(acc ^ u32(p) * p1, 23) * p2 + p3;
    for (; left; --left, ++p)
        acc = rotl(acc ^ *p * p5, 11) * p1;
    acc = (acc ^ acc >> 33) * p2;
    acc = (acc ^ acc >> 29) * p3;
    return acc ^ acc >> 32;
}

/* ---- 1.1 header ---- */

static unsigned check_header(struct file *f)
{
    static const byte identifier[12] = {0xAB, 0x47, 0x54, 0x58, 0x20, 0x30,
                                        0x31, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
    const byte *h = f->data;
    if (f->size && memcmp(h, identifier, f->size < 12 ? (size_t)f->size : 12))
        return 100;
    if (f->size < HEADER)
        return 118;
    if (u16(h + 12) != 0 || u16(h + 14) != 7)
        return 101;
    if (u32(h + 16) != HEADER)
        return 102;
    if (u32(h + 20) != 0)
        return 103;
    f->section_count = u32(h + 28);
    if (f->section_count < 4 || f->section_count > MAX_SECTIONS)
        return 104;
    if (f->size < u64(h + 32) || f->size < HEADER + (uint64_t)ENTRY * f->section_count)
        return 118;
    if (f->size > u64(h + 32))
        return 105;
    if (u64(h + 40) != HEADER)
        return 106;
    if (u32(h + 48) != ENTRY)
        return 107;
    return 0;
}

static unsigned check_values(struct file *f)
{
    const byte *h = f->data;
    f->patches = u32(h + 52);
    f->pages = u32(h + 56);
    f->width = u32(h + 60);
    f->height = u32(h + 64);
    f->mips = u32(h + 68);
    if (f->patches < 1 || f->patches > 1u << 20)
        return 108;
    if (f->pages < 1 || f->pages > 2048)
        return 109;
    if (f->mips < 1 || f->mips > 8)
        return 111;
    uint32_t block = 1u << (f->mips - 1);
    if (f->width < 8 || f->width > 16384 || f->width % block || f->height < 8 ||
        f->height > 16384 || f->height % block)
        return 110;
    for (const byte *min = h + 72, *max = h + 84; min < h + 84; min += 4, max += 4)
        if (!isfinite(f32(min)) || !isfinite(f32(max)) || f32(max) < f32(min))
            return 112;
    if (!isfinite(f32(h + 96)) || f32(h + 96) <= 0)
        return 113;
    if (!all_zero(h + 100, 4) || !all_zero(h + 148, 36))
        return 114;
    for (int i = 0; i < 3; ++i)
        if (!isfinite(f64(h + 104 + 8 * i)))
            return 115;
    return 0;
}

static unsigned check_header_hash(struct file *f)
{
    byte copy[184 + ENTRY * MAX_SECTIONS];
    size_t table = (size_t)ENTRY * f->section_count;
    memcpy(copy, f->data, 184);
    memcpy(copy + 184, f->data + HEADER, table);
    return xxh64(copy, 184 + table) == u64(f->data + 184) ? 0 : 117;
}

/* ---- 1.2 and 2: table ---- */

/* In file order, after the coarsest LODM, if there is one; the images from COLR to EMIT may be
 * absent. META is last. */
enum { KNOWN = 8 };
static const char *const types[KNOWN] = {"PTCH", "LODM", "COLR", "MATL",
                                         "EMIT", "HGHT", "TRIM", "NRML"};

static int is_type(const struct section *s, const char *type) { return !strcmp(s->type, type); }

static int order_of(const struct file *f, const struct section *s)
{
    if (s == f->section && is_type(s, "LODM"))
        return 0;
    for (int i = 0; i < KNOWN; ++i)
        if (is_type(s, types[i]))
            return 16 * i + 8 - (int)s->level;
    return is_type(s, "META") ? 1000 : UNKNOWN;
}

static int is_needed(const char *type)
{
    return !strcmp(type, "PTCH") || !strcmp(type, "HGHT") || !strcmp(type, "TRIM") ||
           !strcmp(type, "NRML");
}

/* Sections of a type that there are, if there are any; of LODM, at most. */
static uint32_t levels_of(const struct file *f, const char *type)
{
    static const char *const single[] = {"PTCH", "HGHT", "TRIM", "META"};
    for (int i = 0; i < 4; ++i)
        if (!strcmp(type, single[i]))
            return 1;
    return strcmp(type, "LODM") ? f->mips : MAX_LODS;
}

static unsigned check_known(struct file *f, struct section *s)
{
    if (s->level >= levels_of(f, s->type))
        return 203;
    static const struct {
        const char *type;
        uint32_t format, texel;
    } images[] = {
        {"HGHT", 13, 1}, {"HGHT", 74, 2}, {"TRIM", 9, 1}, {"NRML", 16, 2}, {"COLR", 43, 4},
        {"MATL", 37, 4}, {"EMIT", 29, 3}};
    int image = !is_type(s, "PTCH") && !is_type(s, "LODM") && !is_type(s, "META");
    for (int i = 0; i < 7; ++i)
        if (is_type(s, images[i].type) && s->format == images[i].format)
            s->texel = images[i].texel;
    if (image ? !s->texel : s->format)
        return 204;
    if (is_type(s, "HGHT"))
        f->bits = 8 * s->texel;
    if (is_type(s, "META"))
        return s->size >= 1 && s->size <= 1u << 20 ? 0 : 600;
    if (is_type(s, "LODM"))
        return s->size >= 36 + 4 * (uint64_t)f->patches + 12 + 18 ? 0 : 500;
    s->width = s->texel ? f->width >> s->level : 0;
    s->height = s->texel ? f->height >> s->level : 0;
    uint64_t size = s->texel ? (uint64_t)f->pages * s->width * s->height * s->texel
                             : (uint64_t)RECORD * f->patches;
    return s->size == size ? 0 : 207;
}

static int has_filter(const struct section *s)
{
    if (s->filter == 4)
        return is_type(s, "TRIM") || is_type(s, "NRML");
    if (s->filter >= 5)
        return s->filter == 5 ? is_type(s, "HGHT") : s->filter == 6 && is_type(s, "LODM");
    return s->texel != 0;
}

static unsigned check_entry(struct file *f, uint32_t index, uint64_t *end)
{
    const byte *e = f->data + HEADER + ENTRY * index;
    struct section *s = &f->section[index];
    memcpy(s->type, e, 4);
    s->flags = u32(e + 4);
    s->level = u32(e + 8);
    s->format = u32(e + 12);
    s->offset = u64(e + 16);
    s->stored_size = u64(e + 24);
    s->size = u64(e + 32);
    s->scheme = u32(e + 40);
    s->filter = u32(e + 44);
    s->hash = u64(e + 48);

    if (s->level > 7)
        return 203;
    int order = order_of(f, s), known = order != UNKNOWN;
    if (!known && s->flags & 1)
        return 201;
    if (s->flags != (known && is_needed(s->type) ? 1 : 0))
        return 202;
    if (!known && (s->level || s->format))
        return s->level ? 203 : 204;
    for (uint32_t i = 0; i < index; ++i)
        if (order_of(f, &f->section[i]) > order ||
            (!memcmp(f->section[i].type, s->type, 4) && f->section[i].level == s->level))
            return 200;
    const struct section *first = f->section;
    if (index && is_type(s, "LODM") && (!is_type(first, "LODM") || first->level <= s->level))
        return 200;
    unsigned rule = known ? check_known(f, s) : 0;
    if (rule)
        return rule;
    if (s->offset > f->size || s->stored_size > f->size - s->offset)
        return 206;
    if (s->offset != *end)
        return 205;
    *end = align64(s->offset + s->stored_size);
    if (s->scheme != 2 && (s->scheme != 0 || s->stored_size != s->size))
        return 208;
    if (s->filter && (s->scheme != 2 || !has_filter(s)))
        return 209;
    if (!all_zero(e + 56, 8))
        return 211;
    return 0;
}

static const struct section *find(const struct file *f, const char *type)
{
    uint32_t i = 0;
    while (!is_type(&f->section[i], type))
        ++i;
    return &f->section[i];
}

static uint32_t count_of(const struct file *f, const char *type)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < f->section_count; ++i)
        count += is_type(&f->section[i], type);
    return count;
}

static unsigned check_presence(const struct file *f)
{
    for (int i = 0; i < KNOWN; ++i) {
        uint32_t count = count_of(f, types[i]);
        if (strcmp(types[i], "LODM") && count != levels_of(f, types[i]) &&
            (count || is_needed(types[i])))
            return 214;
    }
    uint32_t lods = count_of(f, "LODM");
    for (uint32_t i = 0; i < f->section_count; ++i)
        if (is_type(&f->section[i], "LODM") && f->section[i].level >= lods)
            return 214;
    double scale = f32(f->data + 144);
    int right = count_of(f, "EMIT") ? isfinite(scale) && scale > 0 : all_zero(f->data + 144, 4);
    return right ? 0 : 119;
}

static unsigned check_table(struct file *f)
{
    uint64_t end = HEADER + (uint64_t)ENTRY * f->section_count;
    byte hashes[8 * MAX_SECTIONS];
    uint32_t hash_count = 0;
    for (uint32_t i = 0; i < f->section_count; ++i) {
        unsigned rule = check_entry(f, i, &end);
        if (rule)
            return rule;
        if (!is_type(&f->section[i], "META"))
            memcpy(hashes + 8 * hash_count++, f->data + HEADER + ENTRY * i + 48, 8);
    }
    unsigned rule = check_presence(f);
    if (rule)
        return rule;
    if (end != f->size)
        return 215;
    for (uint32_t i = 0; i < f->section_count; ++i) {
        uint64_t from = f->section[i].offset + f->section[i].stored_size;
        if (!all_zero(f->data + from, align64(from) - from))
            return 212;
    }
    return xxh64(hashes, 8 * hash_count) == u64(f->data + 128) ? 0 : 116;
}

/* ---- sections ---- */

/* The content size and window of a zstd frame (RFC 8878, 3.1.1.1); 0 when there are none. */
static int frame_header(const byte *p, uint64_t size, uint64_t *content, uint64_t *window)
{
    static const int dictionary_bytes[] = {0, 1, 2, 4};
    if (size < 6 || u32(p) != 0xFD2FB528)
        return 0;
    int descriptor = p[4], single = descriptor >> 5 & 1, kind = descriptor >> 6;
    int at = 5 + !single + dictionary_bytes[descriptor & 3];
    int width = kind ? 1 << kind : single;
    if (!width || size < (uint64_t)at + (uint64_t)width)
        return 0;
    *content = load(p + at, width) + (width == 2 ? 256 : 0);
    *window = *content;
    if (!single) {
        uint64_t base = (uint64_t)1 << (10 + (p[5] >> 3));
        *window = base + base / 8 * (p[5] & 7);
    }
    return 1;
}

static unsigned inflate(const byte *in, uint64_t stored, byte *out, uint64_t size)
{
#ifdef NO_ZSTD
    (void)in, (void)stored, (void)out, (void)size;
    return UNSUPPORTED;
#else
    if (ZSTD_findFrameCompressedSize(in, (size_t)stored) != stored ||
        ZSTD_decompress(out, (size_t)size, in, (size_t)stored) != size)
        return 213;
    return 0;
#endif
}

static int paeth(int a, int b, int c)
{
    int p = a + b - c, pa = abs(p - a), pb = abs(p - b), pc = abs(p - c);
    if (pa <= pb && pa <= pc)
        return a;
    return pb <= pc ? b : c;
}

/* `step` bytes lie between a byte and the one to its left. */
static void undo_paeth(byte *image, uint64_t rows, uint64_t row_bytes, uint64_t step)
{
    for (uint64_t y = 0; y < rows; ++y)
        for (uint64_t x = 0; x < row_bytes; ++x) {
            byte *p = image + y * row_bytes + x;
            int a = x >= step ? *(p - step) : 0;
            int b = y ? *(p - row_bytes) : 0;
            int c = x >= step && y ? *(p - row_bytes - step) : 0;
            *p = (byte)(*p + paeth(a, b, c));
        }
}

static uint32_t height_code(const struct file *f, const byte *heights, uint64_t texel)
{
    return f->bits == 8 ? heights[texel] : u16(heights + 2 * texel);
}

static unsigned undo_heights(const struct file *f, struct section *s)
{
    int most = s->texel == 1 ? 255 : 65535;
    uint64_t width = s->width, texels = width * s->height * f->pages;
    byte *out = calloc((size_t)texels, s->texel);
    if (!out)
        return NO_MEMORY;
    for (uint64_t at = 0; at < texels; ++at) {
        int left = at % width != 0, up = at / width % s->height != 0, v = s->bytes[at], p;
        int a = left ? (int)height_code(f, out, at - 1) : 0;
        int b = up ? (int)height_code(f, out, at - width) : 0;
        int c = left && up ? (int)height_code(f, out, at - width - 1) : 0;
        if (a && b && c)
            p = a + b - c < 1 ? 1 : a + b - c > most ? most : a + b - c;
        else
            p = a ? a : b ? b : c ? c : (most + 1) / 2;
        if (s->texel == 2)
            v += 256 * s->bytes[texels + at];
        if (v)
            v = (v - 1 + p - 1) % most + 1;
        for (uint32_t k = 0; k < s->texel; ++k)
            out[s->texel * at + k] = (byte)(v >> 8 * k);
    }
    free(s->bytes);
    s->bytes = out;
    return 0;
}

/* A TRIM or NRML section with filter 4, on its way from `s->bytes` to `out`. */
struct surface {
    const struct file *f;
    const struct section *s;
    byte *out, *ring; /* ring: 1 + that of the texel; 0 where there is none yet */
};

static int occupied(const struct file *f, uint32_t level, uint64_t x, uint64_t y)
{
    const byte *heights = find(f, "HGHT")->bytes;
    for (uint64_t j = y << level; j < (y + 1) << level; ++j)
        for (uint64_t i = x << level; i < (x + 1) << level; ++i)
            if (height_code(f, heights, j * f->width + i))
                return 1;
    return 0;
}

/* sum: A, B, C */
static void add_normal(int sum[3], const byte *code)
{
    int a = 2 * code[0] - 255, b = 2 * code[1] - 255;
    sum[0] += a;
    sum[1] += b;
    sum[2] += 255 - (abs(a) > abs(b) ? abs(a) : abs(b));
}

static void mean_normal(const int sum[3], byte *code)
{
    int s = (abs(sum[0]) > abs(sum[1]) ? abs(sum[0]) : abs(sum[1])) + sum[2];
    for (int k = 0; k < 2; ++k) {
        int value = s ? (256 * s + 255 * sum[k]) / (2 * s) : 128;
        code[k] = (byte)(value > 255 ? 255 : value);
    }
}

static void expect_mean(const struct surface *m, uint64_t x, uint64_t y, byte *expected)
{
    const struct section *finer = m->s + 1; /* levels go from the smallest to the largest */
    int sum[3] = {0, 0, 0};
    for (uint64_t j = 2 * y; j < 2 * y + 2; ++j)
        for (uint64_t i = 2 * x; i < 2 * x + 2; ++i)
            if (occupied(m->f, finer->level, i, j))
                add_normal(sum, finer->bytes + 2 * (j * finer->width + i));
    mean_normal(sum, expected);
}

static int median(int a, int b, int c)
{
    int low = a < b ? a : b, high = a < b ? b : a;
    return c < low ? low : c > high ? high : c;
}

static void expect_near(const struct surface *m, uint64_t x, uint64_t y, byte *expected)
{
    uint64_t width = m->s->width, at = y * width + x, texel = m->s->texel;
    int left = x > 0, up = y % m->s->height != 0;
    int has_a = left && m->ring[at - 1], has_b = up && m->ring[at - width];
    int has_c = left && up && m->ring[at - width - 1];
    for (uint64_t k = 0; k < texel; ++k) {
        int a = has_a ? m->out[(at - 1) * texel + k] : 0;
        int b = has_b ? m->out[(at - width) * texel + k] : 0;
        int c = has_c ? m->out[(at - width - 1) * texel + k] : 0;
        if (has_a && has_b && has_c)
            expected[k] = (byte)median(a, b, a + b - c);
        else
            expected[k] = (byte)(has_a ? a : has_b ? b : has_c ? c : 128);
    }
}

/* The rectangle of a patch at the level of a section, in rows of all pages. */
struct rectangle {
    uint64_t x0, x1, y0, y1;
};

static struct rectangle rectangle_of(const struct section *s, const byte *r)
{
    uint64_t x = u16(r + 68) >> s->level, y = u16(r + 70) >> s->level;
    y += (uint64_t)u32(r + 64) * s->height;
    return (struct rectangle){x, x + (u16(r + 72) >> s->level), y, y + (u16(r + 74) >> s->level)};
}

/* The mean of the neighbours up to a ring; 0 when there are none. */
static int expect_normal(const struct surface *m, struct rectangle r, uint64_t x, uint64_t y,
                         uint32_t ring)
{
    int sum[3] = {0, 0, 0}, found = 0;
    for (uint64_t j = y > r.y0 ? y - 1 : y; j <= y + 1 && j < r.y1; ++j)
        for (uint64_t i = x > r.x0 ? x - 1 : x; i <= x + 1 && i < r.x1; ++i) {
            uint64_t from = j * m->s->width + i;
            if (!m->ring[from] || m->ring[from] > ring)
                continue;
            found = 1;
            add_normal(sum, m->out + 2 * from);
        }
    if (found)
        mean_normal(sum, m->out + 2 * (y * m->s->width + x));
    return found;
}

static void expect_rings(const struct surface *m, struct rectangle r, uint32_t rings)
{
    int more = 1;
    for (uint32_t ring = 1; more && ring <= rings; ++ring) {
        more = 0;
        for (uint64_t y = r.y0; y < r.y1; ++y)
            for (uint64_t x = r.x0; x < r.x1; ++x) {
                byte *own = &m->ring[y * m->s->width + x];
                if (*own || !expect_normal(m, r, x, y, ring))
                    continue;
                *own = (byte)(ring + 1);
                more = 1;
            }
    }
}

static void lower(const struct surface *m, uint64_t at, uint64_t from, int steps)
{
    if (m->out[from] + steps < m->out[at])
        m->out[at] = (byte)(m->out[from] + steps);
}

static void sweep_trim(const struct surface *m, struct rectangle r, int down)
{
    uint64_t width = m->s->width, rows = r.y1 - r.y0, columns = r.x1 - r.x0;
    for (uint64_t n = 0; n < rows; ++n)
        for (uint64_t k = 0; k < columns; ++k) {
            uint64_t y = down ? r.y0 + n : r.y1 - 1 - n, x = down ? r.x0 + k : r.x1 - 1 - k;
            uint64_t at = y * width + x, before = down ? at - width : at + width;
            if (m->ring[at])
                continue;
            if (k)
                lower(m, at, down ? at - 1 : at + 1, 16);
            if (n)
                lower(m, at, before, 16);
            if (n && x > r.x0)
                lower(m, at, before - 1, 23);
            if (n && x + 1 < r.x1)
                lower(m, at, before + 1, 23);
        }
}

static void expect_empty(const struct surface *m, const byte *record)
{
    struct rectangle r = rectangle_of(m->s, record);
    uint32_t rings = u16(record + 76) >> m->s->level;
    if (m->s->texel == 2) {
        expect_rings(m, r, rings < 1 ? 1 : rings > 128 ? 128 : rings);
    } else {
        sweep_trim(m, r, 1);
        sweep_trim(m, r, 0);
    }
}

static void add_surface(const struct surface *m)
{
    const struct section *s = m->s;
    uint64_t rows = (uint64_t)m->f->pages * s->height, texels = rows * s->width, cursor = 0;
    for (uint64_t at = 0; at < texels; ++at) {
        uint64_t x = at % s->width, y = at / s->width;
        m->ring[at] = (byte)occupied(m->f, s->level, x, y);
        if (!m->ring[at])
            continue;
        if (s->level)
            expect_mean(m, x, y, m->out + 2 * at);
        else
            expect_near(m, x, y, m->out + s->texel * at);
        for (uint64_t k = 0; k < s->texel; ++k)
            m->out[at * s->texel + k] += s->bytes[k * texels + cursor];
        ++cursor;
    }
    for (uint64_t at = 0; at < texels; ++at)
        if (!m->ring[at])
            memset(m->out + at * s->texel, s->texel == 2 ? 128 : 255, s->texel);
    for (uint32_t n = 0; n < m->f->patches; ++n)
        expect_empty(m, find(m->f, "PTCH")->bytes + RECORD * (uint64_t)n);
    for (uint64_t at = 0; at < texels; ++at) {
        for (uint64_t k = 0; k < s->texel && m->ring[at] != 1; ++k)
            m->out[at * s->texel + k] += s->bytes[k * texels + cursor];
        cursor += m->ring[at] != 1;
    }
}

static unsigned undo_surface(const struct file *f, struct section *s)
{
    struct surface m = {f, s, malloc((size_t)s->size), malloc((size_t)(s->size / s->texel))};
    int whole = m.out && m.ring;
    if (whole) {
        add_surface(&m);
        free(s->bytes);
        s->bytes = m.out;
    } else {
        free(m.out);
    }
    free(m.ring);
    return whole ? 0 : NO_MEMORY;
}

static unsigned undo_filter(const struct file *f, struct section *s)
{
    if (s->filter > 3)
        return s->filter == 4 ? undo_surface(f, s) : undo_heights(f, s);
    uint64_t texels = (uint64_t)s->width * s->height, all = texels * f->pages;
    uint32_t step = s->filter == 3 ? 1 : s->texel, images = f->pages * s->texel / step;
    if (s->filter & 1)
        for (uint32_t i = 0; i < images; ++i)
            undo_paeth(s->bytes + i * texels * step, s->height, (uint64_t)s->width * step, step);
    if (s->filter < 2)
        return 0;
    byte *merged = malloc((size_t)s->size);
    if (!merged)
        return NO_MEMORY;
    for (uint64_t i = 0; i < all; ++i)
        for (uint32_t plane = 0; plane < s->texel; ++plane)
            merged[i * s->texel + plane] = s->bytes[plane * all + i];
    free(s->bytes);
    s->bytes = merged;
    return 0;
}

/* ---- 6: the LOD mesh ---- */

#define NONE 0xffffffu

struct edge {
    uint32_t from, to, across;
};

struct steps {
    const byte *steps, *numbers;  /* of triangles, of positions */
    byte *indices, *positions;
    uint32_t vertices, triangles, met, edges;
    uint64_t words;
    uint32_t *after, *before;     /* of each vertex, along the boundary */
    struct edge latest[16];
};

/* Number i of `width` bytes that lie in planes of `count`. */
static uint32_t from_planes(const byte *p, uint64_t count, uint64_t i, int width)
{
    uint32_t value = 0;
    while (width-- > 0)
        value = value << 8 | p[(uint64_t)width * count + i];
    return value;
}

static void meet(struct steps *s, uint32_t vertex, const uint32_t *near)
{
    if (vertex != s->met || vertex >= s->vertices)
        return;
    int known = near && near[0] < vertex && near[1] < vertex && near[2] < vertex;
    for (uint64_t k = 0; k < 3; ++k) {
        const byte *at = s->positions + 2 * k;
        uint32_t expected = vertex ? u16(at + 6 * ((uint64_t)vertex - 1)) : 0;
        if (known)
            expected = u16(at + 6 * (uint64_t)near[0]) + u16(at + 6 * (uint64_t)near[1]) -
                       u16(at + 6 * (uint64_t)near[2]);
        uint64_t count = s->vertices;
        uint32_t d = from_planes(s->numbers + k * count, 3 * count, vertex, 2);
        uint32_t value = expected + (d & 1 ? ~(d >> 1) : d >> 1);
        byte *out = s->positions + 6 * (uint64_t)vertex + 2 * k;
        out[0] = (byte)value;
        out[1] = (byte)(value >> 8);
    }
    ++s->met;
}

static uint32_t told(struct steps *s)
{
    const byte *words = s->steps + s->triangles;
    return (s->met - from_planes(words, 3 * (uint64_t)s->triangles, s->words++, 3)) & NONE;
}

static uint32_t link_of(const struct steps *s, const uint32_t *links, uint32_t vertex)
{
    return vertex < s->vertices ? links[vertex] : NONE;
}

static void drop_edge(struct steps *s, uint32_t from, uint32_t to)
{
    for (uint32_t i = s->edges; i-- > 0;) {
        if (s->latest[i].from != from || s->latest[i].to != to)
            continue;
        for (--s->edges; i < s->edges; ++i)
            s->latest[i] = s->latest[i + 1];
        return;
    }
}

/* The oldest edge stands first. */
static void put_edge(struct steps *s, struct edge e)
{
    for (uint32_t i = 1; s->edges == 16 && i < 16; ++i)
        s->latest[i - 1] = s->latest[i];
    s->edges -= s->edges == 16;
    s->latest[s->edges++] = e;
}

static void add_triangle(struct steps *s, const uint32_t v[3], int joined)
{
    int meets[3];
    for (int k = 0; k < 3; ++k)
        if (v[k] >= s->vertices)
            return;
    for (int k = 0; k < 3; ++k)
        meets[k] = s->after[v[k]] == v[(k + 1) % 3];
    for (int k = 0; k < 3; ++k)
        if (meets[k])
            s->after[v[k]] = s->before[v[(k + 1) % 3]] = NONE;
    for (int k = 0; k < 3; ++k) {
        uint32_t from = v[k], to = v[(k + 1) % 3];
        if (meets[k] || (joined && k == 0)) {
            drop_edge(s, from, to);
        } else {
            struct edge e = {to, from, v[(k + 2) % 3]};
            s->after[to] = from;
            s->before[from] = to;
            put_edge(s, e);
        }
    }
}

static void undo_triangle(struct steps *s, uint64_t t)
{
    uint32_t v[3], near[3], start = s->steps[t] / 4, kind = s->steps[t] % 4;
    int joined = start < s->edges;
    if (joined) {
        struct edge e = s->latest[s->edges - 1 - start];
        near[0] = v[0] = e.from;
        near[1] = v[1] = e.to;
        near[2] = e.across;
    } else {
        v[0] = told(s);
        meet(s, v[0], NULL);
        near[0] = near[1] = near[2] = v[0];
        v[1] = start == 16 ? link_of(s, s->after, v[0]) : told(s);
        meet(s, v[1], near);
        near[0] = near[1] = near[2] = v[1];
    }
    if (kind == 0)
        v[2] = s->met;
    else if (kind == 1)
        v[2] = link_of(s, s->after, v[1]);
    else
        v[2] = kind == 2 ? link_of(s, s->before, v[0]) : told(s);
    meet(s, v[2], near);
    for (int k = 0; k < 12; ++k)
        s->indices[12 * t + (uint64_t)k] = (byte)(v[k / 4] >> k % 4 * 8);
    add_triangle(s, v, joined);
}

static int64_t absolute(int64_t n)
{
    return n < 0 ? -n : n;
}

static byte unorm_of(int64_t v, int64_t size)
{
    int64_t code = size ? (256 * size + 255 * v) / (2 * size) : 128;
    return (byte)(code < 255 ? code : 255);
}

static void normal_of_triangle(const struct steps *s, uint64_t t, int64_t out[3])
{
    int64_t p[3][3] = {{0}};
    for (int c = 0; c < 3; ++c) {
        uint32_t v = u32(s->indices + 12 * t + 4 * c);
        for (int k = 0; k < 3 && v < s->vertices; ++k)
            p[c][k] = u16(s->positions + 6 * (uint64_t)v + 2 * k);
        if (v >= s->vertices) {
            out[0] = out[1] = out[2] = 0;
            return;
        }
    }
    for (int k = 0; k < 3; ++k) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) -
                 (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
    }
}

/* Adds what is expected to the differences in `planes`. */
static unsigned undo_normals(const struct steps *s, const byte *planes, byte *out)
{
    uint64_t count = s->vertices;
    uint32_t *sums = calloc((size_t)(count ? count : 1), 3 * sizeof *sums);
    int64_t most = 0, n[3], part = 1;
    if (!sums)
        return NO_MEMORY;
    for (uint64_t t = 0; t < s->triangles; ++t) {
        normal_of_triangle(s, t, n);
        for (int k = 0; k < 3; ++k)
            most = absolute(n[k]) > most ? absolute(n[k]) : most;
    }
    while (most >= (part << 24))
        part *= 2;
    for (uint64_t t = 0; t < s->triangles; ++t) {
        normal_of_triangle(s, t, n);
        for (int c = 0; c < 3; ++c) {
            uint32_t v = u32(s->indices + 12 * t + 4 * c);
            for (int k = 0; k < 3 && v < count; ++k) {
                int64_t down = n[k] % part < 0;
                sums[3 * (uint64_t)v + k] += (uint32_t)(n[k] / part - down);
            }
        }
    }
    for (uint64_t v = 0; v < count; ++v) {
        int64_t x = (int32_t)sums[3 * v], y = (int32_t)sums[3 * v + 1];
        int64_t z = (int32_t)sums[3 * v + 2], size = absolute(x) + absolute(y) + absolute(z);
        int64_t from[2] = {x, y};
        if (z < 0) {
            from[0] = (size - absolute(y)) * (x < 0 ? -1 : 1);
            from[1] = (size - absolute(x)) * (y < 0 ? -1 : 1);
        }
        for (uint64_t k = 0; k < 2; ++k)
            out[2 * v + k] = (byte)(planes[k * count + v] + unorm_of(from[k], size));
    }
    memcpy(out + 2 * count, planes + 2 * count, 4);
    free(sums);
    return 0;
}

static unsigned undo_steps(struct section *s)
{
    struct steps steps = {.vertices = u32(s->bytes + 20), .triangles = u32(s->bytes + 24)};
    uint64_t arrays = 6 * (uint64_t)steps.vertices + 12 * (uint64_t)steps.triangles;
    uint64_t left = s->size - LOD_HEADER;
    int normals = u32(s->bytes + 28) & 2 ? 1 : 0;
    if (normals)
        arrays += 2 * (uint64_t)steps.vertices + 4;
    if (arrays > left || (left - arrays) % 4 || steps.vertices > NONE ||
        (normals && steps.vertices > 2 * (uint64_t)steps.triangles))
        return 213;
    byte *out = malloc((size_t)s->size);
    steps.after = malloc(((size_t)steps.vertices + 1) * 2 * sizeof *steps.after);
    if (!out || !steps.after) {
        free(out);
        free(steps.after);
        return NO_MEMORY;
    }
    steps.before = steps.after + steps.vertices;
    for (uint64_t i = 0; i < 2 * (uint64_t)steps.vertices; ++i)
        steps.after[i] = NONE;
    memcpy(out, s->bytes, LOD_HEADER);
    uint64_t firsts = (left - arrays) / 4, indices = LOD_HEADER + 4 * firsts;
    uint32_t first = 0;
    for (uint64_t i = 0; i < firsts; ++i) {
        first += from_planes(s->bytes + LOD_HEADER, firsts, i, 4);
        for (int k = 0; k < 4; ++k)
            out[LOD_HEADER + 4 * i + (uint64_t)k] = (byte)(first >> 8 * k);
    }
    steps.steps = s->bytes + indices;
    steps.indices = out + indices;
    steps.numbers = steps.steps + 12 * (uint64_t)steps.triangles;
    steps.positions = steps.indices + 12 * (uint64_t)steps.triangles;
    for (uint64_t t = 0; t < steps.triangles; ++t)
        undo_triangle(&steps, t);
    while (steps.met < steps.vertices)
        meet(&steps, steps.met, NULL);
    free(steps.after);
    unsigned rule = 0;
    if (normals)
        rule = undo_normals(&steps, steps.numbers + 6 * (uint64_t)steps.vertices,
                            steps.positions + 6 * (uint64_t)steps.vertices);
    free(s->bytes);
    s->bytes = out;
    return rule;
}

static unsigned decode_section(const struct file *f, struct section *s)
{
    const byte *stored = f->data + s->offset;
    uint64_t content, window;
    if (s->scheme == 2 &&
        (!frame_header(stored, s->stored_size, &content, &window) || content != s->size ||
         window > (uint64_t)1 << 27 || s->size / 32768 > s->stored_size))
        return 213;
    s->bytes = malloc((size_t)s->size);
    if (!s->bytes)
        return NO_MEMORY;
    unsigned rule = 0;
    if (s->scheme == 2)
        rule = inflate(stored, s->stored_size, s->bytes, s->size);
    else
        memcpy(s->bytes, stored, (size_t)s->size);
    if (!rule && s->filter)
        rule = is_type(s, "LODM") ? undo_steps(s) : undo_filter(f, s);
    if (!rule && xxh64(s->bytes, s->size) != s->hash)
        rule = 210;
    return rule;
}

/* ---- 3: patches ---- */

static double dot(const byte *a, const byte *b)
{
    return f32(a) * f32(b) + f32(a + 4) * f32(b + 4) + f32(a + 8) * f32(b + 8);
}

static double determinant(const byte *x, const byte *y, const byte *z)
{
    double xy[3];
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        xy[i] = f32(x + 4 * j) * f32(y + 4 * k) - f32(x + 4 * k) * f32(y + 4 * j);
    }
    return xy[0] * f32(z) + xy[1] * f32(z + 4) + xy[2] * f32(z + 8);
}

static unsigned check_record(const struct file *f, const byte *r)
{
    for (int i = 0; i < 96; i += 4)
        if ((i < 64 || i >= 80) && !isfinite(f32(r + i)))
            return 300;
    double ex = f32(r + 12), ey = f32(r + 28), ez = f32(r + 44);
    if (!(ex > 0 && ey > 0 && ez > 0 && ez >= fmax(ex, ey) / 4096 * 0.999))
        return 301;
    for (int i = 16; i <= 48; i += 16)
        if (fabs(sqrt(dot(r + i, r + i)) - 1) > 1e-3)
            return 302;
    if (determinant(r + 16, r + 32, r + 48) < 0.099)
        return 303;
    if (!(f32(r + 92) > 0))
        return 308;
    if (u32(r + 64) >= f->pages)
        return 305;
    uint32_t x = u16(r + 68), y = u16(r + 70), w = u16(r + 72), h = u16(r + 74);
    uint32_t block = 1u << (f->mips - 1);
    if (w < 2 || h < 2 || x + w > f->width || y + h > f->height || x % block || y % block ||
        w % block || h % block)
        return 306;
    if (u16(r + 78) & ~0x100u)
        return 307;
    if (!all_zero(r + 100, 28))
        return 309;
    return 0;
}

/* The position in a page-sized map of texel (i, j) of a patch. */
static uint64_t texel_at(const struct file *f, const byte *r, uint32_t i, uint32_t j)
{
    return ((uint64_t)u32(r + 64) * f->height + u16(r + 70) + j) * f->width + u16(r + 68) + i;
}

/* `taken` has a byte a texel of all pages. */
static unsigned check_patches(const struct file *f, const byte *records, byte *taken)
{
    for (uint32_t n = 0; n < f->patches; ++n) {
        unsigned rule = check_record(f, records + RECORD * (uint64_t)n);
        if (rule)
            return rule;
    }
    for (uint32_t n = 0; n < f->patches; ++n) {
        const byte *r = records + RECORD * (uint64_t)n;
        for (uint32_t j = 0; j < u16(r + 74); ++j)
            for (uint32_t i = 0; i < u16(r + 72); ++i)
                if (taken[texel_at(f, r, i, j)]++)
                    return 310;
    }
    return 0;
}

static unsigned check_points(const struct file *f, const byte *r, const byte *heights)
{
    uint32_t w = u16(r + 72), h = u16(r + 74);
    double levels = f->bits == 8 ? 254 : 65534, diagonal = 0, coded = 0;
    unsigned sphere = 0, bounds = 0;
    for (int i = 0; i < 3; ++i)
        diagonal += pow(f32(f->data + 84 + 4 * i) - f32(f->data + 72 + 4 * i), 2);
    diagonal = sqrt(diagonal);
    for (uint32_t j = 0; j < h; ++j) {
        for (uint32_t i = 0; i < w; ++i) {
            uint32_t code = height_code(f, heights, texel_at(f, r, i, j));
            if (!code)
                continue;
            ++coded;
            double distance = 0;
            for (int k = 0; k < 3; ++k) {
                double p = f32(r + 4 * k) + (i + 0.5) / w * f32(r + 12) * f32(r + 16 + 4 * k) +
                           (j + 0.5) / h * f32(r + 28) * f32(r + 32 + 4 * k) +
                           (code - 1) / levels * f32(r + 44) * f32(r + 48 + 4 * k);
                distance += pow(p - f32(r + 80 + 4 * k), 2);
                if (p < f32(f->data + 72 + 4 * k) - 1e-4 * diagonal ||
                    p > f32(f->data + 84 + 4 * k) + 1e-4 * diagonal)
                    bounds = 311;
            }
            if (sqrt(distance) > f32(r + 92) * 1.001)
                sphere = 308;
        }
    }
    if (fabs(coded / ((double)w * h) - f32(r + 60)) > 1e-4)
        return 304;
    return sphere ? sphere : bounds;
}

static unsigned check_maps(const struct file *f, const byte *records, const byte *heights,
                           const byte *taken)
{
    for (uint32_t n = 0; n < f->patches; ++n) {
        unsigned rule = check_points(f, records + RECORD * (uint64_t)n, heights);
        if (rule)
            return rule;
    }
    for (uint64_t i = 0; i < (uint64_t)f->pages * f->width * f->height; ++i)
        if (!taken[i] && height_code(f, heights, i))
            return 400;
    return 0;
}

/* Whether a corner is at most a texel beside the rectangle of record `r`. */
static int is_beside(const byte *lod, const byte *position, const byte *r)
{
    double p[3], det = determinant(r + 16, r + 32, r + 48);
    for (int k = 0; k < 3; ++k)
        p[k] = f32(lod + 4 * k) + f32(lod + 12) * u16(position + 2 * k) - f32(r + 4 * k);
    for (int axis = 0; axis < 2; ++axis) {
        const byte *a = r + (axis ? 48 : 32), *b = r + (axis ? 16 : 48);
        double at = 0, size = u16(r + 72 + 2 * axis);
        for (int k = 0; k < 3; ++k) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            at += p[k] * (f32(a + 4 * i) * f32(b + 4 * j) - f32(a + 4 * j) * f32(b + 4 * i));
        }
        at *= size / (det * f32(r + 12 + 16 * axis));
        if (!(at >= -1 && at <= size + 1))
            return 0;
    }
    return 1;
}

static unsigned check_triangles(const struct file *f, const struct section *s, const byte *records)
{
    const byte *h = s->bytes, *first = h + LOD_HEADER, *index = first + 4 * (f->patches + 1);
    uint32_t vertices = u32(h + 20), triangles = u32(h + 24), met = 0;
    const byte *positions = index + 12 * (uint64_t)triangles;
    for (uint64_t t = 0; t < triangles; ++t) {
        uint32_t v[3];
        for (int k = 0; k < 3; ++k) {
            v[k] = u32(index + 12 * t + 4 * k);
            if (v[k] > met || v[k] >= vertices)
                return 504;
            met += v[k] == met;
        }
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
            return 504;
    }
    if (met != vertices)
        return 504;
    int far = u32(h + 28) & 1; /* corners may lie anywhere */
    for (uint32_t n = 0; !far && n < f->patches; ++n)
        for (uint64_t i = 3 * (uint64_t)u32(first + 4 * n);
             i < 3 * (uint64_t)u32(first + 4 * n + 4); ++i)
            if (!is_beside(h, positions + 6 * (uint64_t)u32(index + 4 * i),
                           records + RECORD * (uint64_t)n))
                return 505;
    return 0;
}

/* `finer` is the level after it in the file, or NULL. */
static unsigned check_lod(const struct file *f, const struct section *s,
                          const struct section *finer, const byte *records)
{
    const byte *h = s->bytes, *first = h + LOD_HEADER;
    uint64_t vertices = u32(h + 20), triangles = u32(h + 24);
    int normals = u32(h + 28) & 2 ? 1 : 0;
    if (!triangles || vertices > NONE ||
        s->size != 36 + 4 * (uint64_t)f->patches + 12 * triangles + 6 * vertices +
                       (normals ? 2 * vertices + 4 : 0))
        return 500;
    for (int i = 0; i < 20; i += 4)
        if (!isfinite(f32(h + i)) || (i == 12 && f32(h + i) <= 0) || (i == 16 && f32(h + i) < 0))
            return 501;
    if (u32(h + 28) > 3)
        return 501;
    if (normals && (vertices > 2 * triangles || !(f32(h + s->size - 4) >= 0) ||
                    f32(h + s->size - 4) > 2))
        return 506;
    if (finer && f32(finer->bytes + 16) > f32(h + 16))
        return 502;
    if (u32(first) != 0 || u32(first + 4 * f->patches) != triangles)
        return 503;
    for (uint32_t n = 0; n < f->patches; ++n)
        if (u32(first + 4 * n) > u32(first + 4 * n + 4))
            return 503;
    return check_triangles(f, s, records);
}

static unsigned check_meta(const struct section *meta)
{
    for (uint64_t i = 0; i < meta->size;) {
        const byte *p = meta->bytes + i;
        int more = *p < 0x80 ? 0 : *p >= 0xC0 && *p < 0xE0 ? 1 : *p >= 0xE0 && *p < 0xF0 ? 2 : 3;
        static const uint32_t least[] = {0, 0x80, 0x800, 0x10000};
        static const byte mask[] = {0x7F, 0x1F, 0x0F, 0x07};
        if ((*p >= 0x80 && *p < 0xC0) || *p >= 0xF8 || meta->size - i <= (uint64_t)more)
            return 600;
        uint32_t code = *p & mask[more];
        for (int k = 1; k <= more; ++k) {
            if (p[k] >> 6 != 2)
                return 600;
            code = code << 6 | (p[k] & 0x3F);
        }
        if (code < least[more] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000))
            return 600;
        i += 1 + (uint64_t)more;
    }
    return 0;
}

/* ---- 7: all of it ---- */

static unsigned decode_content(struct file *f, byte *taken)
{
    struct section *patches = &f->section[is_type(f->section, "LODM")];
    unsigned rule = decode_section(f, patches);
    if (!rule)
        rule = check_patches(f, patches->bytes, taken);
    if (rule)
        return rule;
    for (uint32_t n = 0; n < 8 * f->section_count; ++n) { /* level 0 of all sections first */
        struct section *s = &f->section[n % f->section_count];
        if (order_of(f, s) == UNKNOWN || s->level != n / f->section_count || s == patches)
            continue;
        rule = decode_section(f, s);
        if (!rule && is_type(s, "LODM"))
            rule = check_lod(f, s, s->level ? s == f->section ? s + 2 : s + 1 : NULL,
                             patches->bytes);
        if (!rule && is_type(s, "META"))
            rule = check_meta(s);
        if (rule)
            return rule;
    }
    return check_maps(f, patches->bytes, find(f, "HGHT")->bytes, taken);
}

/* Returns 0, or the rule that is broken. `f` is to be freed with release in either case. */
static unsigned decode(const byte *data, uint64_t size, struct file *f)
{
    static unsigned (*const steps[])(struct file *) = {check_header, check_values,
                                                       check_header_hash, check_table};
    memset(f, 0, sizeof *f);
    f->data = data;
    f->size = size;
    for (int i = 0; i < 4; ++i) {
        unsigned rule = steps[i](f);
        if (rule)
            return rule;
    }
    byte *taken = calloc((size_t)f->pages * f->width, f->height);
    if (!taken)
        return NO_MEMORY;
    unsigned rule = decode_content(f, taken);
    free(taken);
    return rule;
}

static void release(struct file *f)
{
    for (uint32_t i = 0; i < f->section_count && i < MAX_SECTIONS; ++i)
        free(f->section[i].bytes);
}

#ifndef GTX_DECODE_NO_MAIN

static void print_floats(const char *name, const byte *p, int count)
{
    printf(" %s", name);
    for (int i = 0; i < count; ++i)
        printf("%c%.9g", i ? ',' : ' ', f32(p + 4 * i));
}

static void print_patch(uint32_t index, const byte *r)
{
    printf("patch %" PRIu32 ":", index);
    print_floats("frame", r, 16);
    print_floats("sphere", r + 80, 4);
    printf(" page %" PRIu32 " rect %" PRIu32 ",%" PRIu32 " %" PRIu32 "x%" PRIu32, u32(r + 64),
           u16(r + 68), u16(r + 70), u16(r + 72), u16(r + 74));
    printf(" dilation %" PRIu32 " flags 0x%04" PRIx32 " triangles %" PRIu32 "\n", u16(r + 76),
           u16(r + 78), u32(r + 96));
}

static void print_section(const struct section *s)
{
    const byte *t = (const byte *)s->type;
    printf("section %02x%02x%02x%02x level %" PRIu32 " size %" PRIu64 " scheme %" PRIu32
           " filter %" PRIu32, t[0], t[1], t[2], t[3], s->level, s->size, s->scheme, s->filter);
    if (s->bytes)
        printf(" %s xxh64 0x%016" PRIx64 "\n", s->type, xxh64(s->bytes, s->size));
    else
        printf(" skipped\n");
}

static void print_file(struct file *f)
{
    const byte *h = f->data;
    printf("gtx %" PRIu32 ".%" PRIu32 ", %" PRIu64 " bytes\n", u16(h + 12), u16(h + 14), f->size);
    printf("patches %" PRIu32 ", pages %" PRIu32 " of %" PRIu32 "x%" PRIu32 ", mips %" PRIu32
           ", bits %" PRIu32 "\n", f->patches, f->pages, f->width, f->height, f->mips, f->bits);
    printf("header:");
    print_floats("bounds and unit", h + 72, 7);
    printf(" anchor %.17g,%.17g,%.17g", f64(h + 104), f64(h + 112), f64(h + 120));
    printf(" emission scale %.9g content 0x%016" PRIx64 " triangles %" PRIu64 "\n", f32(h + 144),
           u64(h + 128), u64(h + 136));
    for (uint32_t n = 0; n < f->patches; ++n)
        print_patch(n, find(f, "PTCH")->bytes + RECORD * (uint64_t)n);
    for (uint32_t i = 0; i < f->section_count; ++i)
        print_section(&f->section[i]);
}

/* All bytes of a file that can be sought in; NULL when it cannot be read. */
static byte *read_whole(const char *path, uint64_t *size)
{
    FILE *in = fopen(path, "rb");
    if (!in)
        return NULL;
    long end = fseek(in, 0, SEEK_END) ? -1 : ftell(in);
    byte *data = end >= 0 && end < LONG_MAX ? malloc((size_t)end + 1) : NULL;
    rewind(in);
    if (data && fread(data, 1, (size_t)end, in) != (size_t)end) {
        free(data);
        data = NULL;
    }
    fclose(in);
    *size = (uint64_t)end;
    return data;
}

int main(int argc, char **argv)
{
    static struct file file;
    uint64_t size;
    if (argc != 2) {
        fprintf(stderr, "usage: gtx_decode FILE\n");
        return 1;
    }
    byte *data = read_whole(argv[1], &size);
    if (!data) {
        fprintf(stderr, "%s: cannot be read\n", argv[1]);
        return 2;
    }
    unsigned rule = decode(data, size, &file);
    if (!rule)
        print_file(&file);
    else
        printf("%s: %s %u\n", argv[1], rule >= 100 ? "breaks rule" : "not decoded, code", rule);
    release(&file);
    free(data);
    return !rule ? 0 : rule >= 100 ? 3 : 5;
}

#endif
