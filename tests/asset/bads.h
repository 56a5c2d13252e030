/* Files that break the rules, made of the golden ones: one for every rule, and more ways. */
#ifndef GTX_TESTS_BADS_H
#define GTX_TESTS_BADS_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/check.h"
#include "asset/codec.h"
#include "asset/golden.h"

#include <inttypes.h>

/* Offsets in the golden files with four sections. */
enum { ENTRY = 192, HGHT = ENTRY + 64, TRIM = ENTRY + 128, NRML = ENTRY + 192, RECORD = 448 };
/* In `zstd`, behind its colours. */
enum { ZSTD_HGHT = ENTRY + 5 * 64, ZSTD_TRIM = ENTRY + 6 * 64 };
/* The smaller and the larger level in `material` and `emission`; in `zstd-material` the largest
 * levels of colour and material, and the smallest of emission. */
enum { SMALL = ENTRY + 64, LARGE = ENTRY + 2 * 64 };
enum { COLR = ENTRY + 4 * 64, MATL = ENTRY + 8 * 64, EMIT = ENTRY + 9 * 64 };

/* The two levels in `lod`; the entries of its finer and of the coarsest in `zstd-lod`. */
enum { COARSE = 576, FINE = 832, LODM = ENTRY + 2 * 64, ZSTD_SHEL = ENTRY };
/* Of the coarser level in `normals`. */
enum { NORMAL_ERROR = COARSE + 96 };

typedef enum rehash {
    NOTHING, HEADER, CONTENT, SECTIONS
} rehash;

/* Writes `width` bytes of `value` at `offset`; `edit` does what one number cannot. */
typedef struct bad {
    uint32_t rule;
    const char *name, *base;
    uint32_t offset, width;
    uint64_t value;
    rehash rehash;
    uint64_t reported;            /* offset that must be reported */
    void (*edit)(bytes *file);
} bad;

static inline void resize(bytes *file, size_t size)
{
    uint8_t *data = need(calloc(size, 1));
    memcpy(data, file->data, size < file->size ? size : file->size);
    free(file->data);
    *file = (bytes){data, size};
}

static inline void truncate_file(bytes *file)
{
    resize(file, file->size - 1);
}

static inline void append_block(bytes *file)
{
    resize(file, file->size + 64);
}

static inline void append_counted_block(bytes *file)
{
    append_block(file);
    gtx_store_u64(file->data + 32, file->size);
}

/* HGHT and TRIM of `minimal` have one size: everything but their offsets changes place. */
static inline void swap_sections(bytes *file)
{
    uint8_t entry[64], *a = file->data + HGHT, *b = file->data + TRIM;
    memcpy(entry, a, 64);
    memcpy(a, b, 64);
    memcpy(b, entry, 64);
    memcpy(b + 16, a + 16, 8);
    memcpy(a + 16, entry + 16, 8);
    uint8_t *from = file->data + gtx_load_u64(a + 16), *to = file->data + gtx_load_u64(b + 16);
    for (int i = 0; i < 64; ++i) {
        uint8_t byte = from[i];
        from[i] = to[i];
        to[i] = byte;
    }
}

/* Makes a section one that readers skip: the last of the file. */
static inline void forget(bytes *file, size_t entry)
{
    const size_t last = ENTRY + 64 * (gtx_load_u32(file->data + 28) - 1);
    const size_t at = gtx_load_u64(file->data + entry + 16);
    const size_t next = entry == last ? file->size : gtx_load_u64(file->data + entry + 80);
    const size_t size = next - at;
    uint8_t kept[64], *block = need(malloc(size));
    memcpy(block, file->data + at, size);
    memmove(file->data + at, file->data + next, file->size - next);
    memcpy(file->data + file->size - size, block, size);
    free(block);
    memcpy(kept, file->data + entry, 64);
    for (; entry < last; entry += 64) {
        memcpy(file->data + entry, file->data + entry + 64, 64);
        gtx_store_u64(file->data + entry + 16, gtx_load_u64(file->data + entry + 16) - size);
    }
    memcpy(kept, "XTRA", 4);
    memset(kept + 4, 0, 12);
    gtx_store_u64(kept + 16, file->size - size);
    memcpy(file->data + last, kept, 64);
}

static inline void rename_normals(bytes *file)
{
    forget(file, NRML);
}

static inline void rename_large_level(bytes *file)
{
    forget(file, LARGE);
}

static inline void rename_fine_lod(bytes *file)
{
    forget(file, LODM);
}

/* As files of 0.6 were. */
static inline void patches_before_lods(bytes *file)
{
    enum { PTCH = ENTRY + 64, COARSE_SIZE = 128, PTCH_SIZE = 128 };
    uint8_t entry[64], section[COARSE_SIZE], *first = file->data + COARSE;
    memcpy(entry, file->data + ENTRY, 64);
    memcpy(file->data + ENTRY, file->data + PTCH, 64);
    memcpy(file->data + PTCH, entry, 64);
    gtx_store_u64(file->data + ENTRY + 16, COARSE);
    gtx_store_u64(file->data + PTCH + 16, COARSE + PTCH_SIZE);
    memcpy(section, first, COARSE_SIZE);
    memcpy(first, first + COARSE_SIZE, PTCH_SIZE);
    memcpy(first + PTCH_SIZE, section, COARSE_SIZE);
}

/* Colour and material have one size: only the names change place. */
static inline void material_before_color(bytes *file)
{
    for (size_t level = 0; level < 4; ++level) {
        memcpy(file->data + COLR - 64 * level, "MATL", 4);
        memcpy(file->data + MATL - 64 * level, "COLR", 4);
        gtx_store_u32(file->data + COLR - 64 * level + 12, 37);
        gtx_store_u32(file->data + MATL - 64 * level + 12, 43);
    }
}

static inline void dirty_last_byte(bytes *file)
{
    file->data[file->size - 1] = 1;
}

/* The frame of the heights of `zstd` loses its first byte. */
static inline void break_frame(bytes *file)
{
    file->data[gtx_load_u64(file->data + ZSTD_HGHT + 16)] ^= 1;
}

static const bad bads[] = {
    {100, "identifier", "minimal", 1, 1, 'X', NOTHING, 0, NULL},
    {101, "version", "minimal", 14, 2, 2, HEADER, 12, NULL},
    {102, "header-size", "minimal", 16, 4, 256, HEADER, 16, NULL},
    {103, "must-flags", "minimal", 20, 4, 1, HEADER, 20, NULL},
    {104, "section-count", "minimal", 28, 4, 3, HEADER, 28, NULL},
    {105, "file-size", "minimal", 0, 0, 0, NOTHING, 32, append_block},
    {106, "table-offset", "minimal", 40, 8, 256, HEADER, 40, NULL},
    {107, "table-stride", "minimal", 48, 4, 72, HEADER, 48, NULL},
    {108, "patch-count", "minimal", 52, 4, 0, HEADER, 52, NULL},
    {109, "page-count", "minimal", 56, 4, 2049, HEADER, 56, NULL},
    {110, "page-size", "color", 60, 4, 18, HEADER, 60, NULL},
    {111, "mip-count", "minimal", 68, 4, 33, HEADER, 68, NULL},
    {112, "bounds", "minimal", 84, 4, 0xC0000000, HEADER, 84, NULL},        /* -2 */
    {113, "unit", "minimal", 96, 4, 0, HEADER, 96, NULL},
    {114, "header-reserved", "minimal", 150, 1, 1, HEADER, 150, NULL},
    {115, "anchor", "minimal", 112, 8, 0x7FF0000000000000, HEADER, 112, NULL}, /* infinity */
    {116, "content-hash", "minimal", 128, 8, 1, HEADER, 128, NULL},
    {117, "header-hash", "minimal", 136, 1, 1, NOTHING, 184, NULL},
    {118, "truncated", "minimal", 0, 0, 0, NOTHING, 32, truncate_file},
    {119, "emission-scale", "emission", 144, 4, 0, HEADER, 144, NULL},
    {200, "section-order", "minimal", 0, 0, 0, CONTENT, TRIM, swap_sections},
    {201, "section-unknown", "unknown", ENTRY + 4 * 64 + 4, 4, 1, HEADER, ENTRY + 4 * 64, NULL},
    {202, "section-flags", "minimal", HGHT + 4, 4, 0, HEADER, HGHT + 4, NULL},
    {203, "section-level", "minimal", NRML + 8, 4, 1, HEADER, NRML + 8, NULL},
    {204, "section-format", "minimal", HGHT + 12, 4, 9, HEADER, HGHT + 12, NULL},
    {205, "section-offset", "minimal", HGHT + 16, 8, 640, HEADER, HGHT + 16, NULL},
    {206, "section-range", "minimal", NRML + 16, 8, 0xFFFFFFFFFFFFFFC0, HEADER, NRML + 16, NULL},
    {207, "section-size", "zstd", ZSTD_HGHT + 32, 8, 4095, HEADER, ZSTD_HGHT + 32, NULL},
    {208, "section-scheme", "minimal", HGHT + 40, 4, 1, HEADER, HGHT + 40, NULL},
    {209, "section-filter", "minimal", HGHT + 44, 4, 1, HEADER, HGHT + 44, NULL},
    {210, "section-hash", "minimal", TRIM + 48, 8, 1, CONTENT, TRIM + 48, NULL},
    {211, "section-reserved", "minimal", TRIM + 60, 4, 1, HEADER, TRIM + 56, NULL},
    {212, "padding", "color", 0, 0, 0, NOTHING, 3711, dirty_last_byte},
    {213, "section-zstd", "zstd", 0, 0, 0, NOTHING, 0, break_frame},
    {214, "section-missing", "minimal", 0, 0, 0, CONTENT, ENTRY, rename_normals},
    {215, "file-end", "minimal", 0, 0, 0, HEADER, 832, append_counted_block},
    {300, "patch-finite", "minimal", RECORD, 4, 0x7FC00000, SECTIONS, RECORD, NULL}, /* NaN */
    {301, "patch-extent", "minimal", RECORD + 44, 4, 0x38D1B717, SECTIONS, RECORD + 44, NULL},
    {302, "patch-axis-unit", "minimal", RECORD + 16, 4, 0x3F8147AE, SECTIONS, RECORD + 16, NULL},
    {303, "patch-handedness", "minimal", RECORD + 56, 4, 0xBF800000, SECTIONS, RECORD + 16, NULL},
    {304, "patch-coverage", "minimal", RECORD + 60, 4, 0x3F000000, SECTIONS, RECORD + 60, NULL},
    {305, "patch-page", "minimal", RECORD + 64, 4, 1, SECTIONS, RECORD + 64, NULL},
    {306, "patch-rectangle", "minimal", RECORD + 68, 2, 1, SECTIONS, RECORD + 68, NULL},
    {307, "patch-flags", "minimal", RECORD + 78, 2, 1, SECTIONS, RECORD + 78, NULL},
    {308, "patch-sphere", "minimal", RECORD + 92, 4, 0x3E000000, SECTIONS, RECORD + 80, NULL},
    {309, "patch-reserved", "minimal", RECORD + 124, 4, 1, SECTIONS, RECORD + 124, NULL},
    {310, "patch-overlap", "two-pages", RECORD + 128 + 68, 2, 7, SECTIONS, RECORD + 128 + 68, NULL},
    {311, "patch-bounds", "minimal", 84, 4, 0x3F000000, HEADER, RECORD, NULL},       /* 0.5 */
    {400, "height-outside", "two-pages", 1347, 1, 9, SECTIONS, 1347, NULL},
    {500, "lod-size", "lod", COARSE + 24, 4, 3, SECTIONS, COARSE + 20, NULL},
    {501, "lod-header", "lod", COARSE + 12, 4, 0, SECTIONS, COARSE + 12, NULL},
    {502, "lod-order", "lod", FINE + 16, 4, 0x3F800000, SECTIONS, COARSE + 16, NULL},
    {503, "lod-first", "lod", COARSE + 36, 4, 1, SECTIONS, COARSE + 36, NULL},
    {504, "lod-index", "lod", COARSE + 40, 4, 1, SECTIONS, COARSE + 40, NULL},
    {505, "lod-place", "lod", COARSE + 64, 2, 3000, SECTIONS, COARSE + 40, NULL},
    {506, "lod-normals", "normals", NORMAL_ERROR, 4, 0x40400000, SECTIONS, NORMAL_ERROR, NULL},
    {600, "meta", "color", 3648, 1, 0xFF, SECTIONS, 3648, NULL},
};
enum { BAD_COUNT = sizeof bads / sizeof bads[0] };

/* Other ways to break a rule; not kept as files. */
static const bad variants[] = {
    {104, "section-count", "minimal", 28, 4, 257, HEADER, 28, NULL},
    {108, "patch-count", "minimal", 52, 4, (1u << 20) + 1, HEADER, 52, NULL},
    {109, "page-count", "minimal", 56, 4, 0, HEADER, 56, NULL},
    {110, "page-size", "minimal", 60, 4, 7, HEADER, 60, NULL},
    {110, "page-size", "minimal", 64, 4, 16385, HEADER, 64, NULL},
    {111, "mip-count", "minimal", 68, 4, 0, HEADER, 68, NULL},
    {111, "mip-count", "minimal", 68, 4, 9, HEADER, 68, NULL},
    {112, "bounds", "minimal", 72, 4, 0x7FC00000, HEADER, 72, NULL},           /* NaN */
    {113, "unit", "minimal", 96, 4, 0x7F800000, HEADER, 96, NULL},             /* infinity */
    {114, "header-reserved", "minimal", 100, 4, 1, HEADER, 100, NULL},
    {114, "header-reserved", "minimal", 148, 1, 1, HEADER, 148, NULL},
    {114, "header-reserved", "minimal", 183, 1, 1, HEADER, 183, NULL},
    {119, "emission-scale", "emission", 144, 4, 0x7FC00000, HEADER, 144, NULL}, /* NaN */
    {119, "emission-scale", "emission", 144, 4, 0x7F800000, HEADER, 144, NULL}, /* infinity */
    {119, "emission-scale", "emission", 144, 4, 0xBF800000, HEADER, 144, NULL}, /* -1 */
    {119, "emission-scale", "minimal", 144, 4, 0x3F800000, HEADER, 144, NULL},  /* 1 */
    {119, "emission-scale", "minimal", 144, 4, 0x80000000, HEADER, 144, NULL},  /* -0 */
    {200, "section-order", "zstd-material", 0, 0, 0, HEADER, ENTRY + 5 * 64,
     material_before_color},
    {202, "section-flags", "material", SMALL + 4, 4, 1, HEADER, SMALL + 4, NULL},
    {202, "section-flags", "emission", LARGE + 4, 4, 2, HEADER, LARGE + 4, NULL},
    {203, "section-level", "emission", SMALL + 8, 4, 2, HEADER, SMALL + 8, NULL},
    {204, "section-format", "material", SMALL + 12, 4, 43, HEADER, SMALL + 12, NULL},
    {204, "section-format", "emission", LARGE + 12, 4, 23, HEADER, LARGE + 12, NULL},
    {205, "section-offset", "minimal", HGHT + 16, 8, 577, HEADER, HGHT + 16, NULL},
    {207, "section-size", "zstd-material", EMIT + 32, 8, 383, HEADER, EMIT + 32, NULL},
    {208, "section-scheme", "minimal", TRIM + 24, 8, 63, HEADER, TRIM + 40, NULL},
    {209, "section-filter", "zstd", ZSTD_HGHT + 44, 4, 4, HEADER, ZSTD_HGHT + 44, NULL},
    {209, "section-filter", "zstd", ZSTD_HGHT + 44, 4, 6, HEADER, ZSTD_HGHT + 44, NULL},
    {209, "section-filter", "zstd", ZSTD_TRIM + 44, 4, 5, HEADER, ZSTD_TRIM + 44, NULL},
    {209, "section-filter", "minimal", NRML + 44, 4, 4, HEADER, NRML + 44, NULL},
    {209, "section-filter", "zstd-material", EMIT + 44, 4, 4, HEADER, EMIT + 44, NULL},
    {209, "section-filter", "zstd", ENTRY + 44, 4, 1, HEADER, ENTRY + 44, NULL},
    {210, "section-hash", "emission", LARGE + 48, 8, 1, CONTENT, LARGE + 48, NULL},
    {214, "section-missing", "material", 0, 0, 0, CONTENT, ENTRY, rename_large_level},
    {214, "section-missing", "emission", 0, 0, 0, CONTENT, ENTRY, rename_large_level},
    {301, "patch-extent", "minimal", RECORD + 12, 4, 0, SECTIONS, RECORD + 12, NULL},
    {306, "patch-rectangle", "minimal", RECORD + 72, 2, 1, SECTIONS, RECORD + 68, NULL},
    {308, "patch-sphere", "minimal", RECORD + 92, 4, 0xBF800000, SECTIONS, RECORD + 92, NULL},
    {200, "section-order", "lod", LODM + 8, 4, 1, HEADER, LODM, NULL},
    {200, "section-order", "lod", ENTRY + 8, 4, 0, HEADER, LODM, NULL},
    {200, "section-order", "lod", 0, 0, 0, CONTENT, ENTRY + 64, patches_before_lods},
    {203, "section-level", "lod", LODM + 8, 4, 8, HEADER, LODM + 8, NULL},
    {209, "section-filter", "zstd-lod", ZSTD_SHEL + 44, 4, 1, HEADER, ZSTD_SHEL + 44, NULL},
    {214, "section-missing", "lod", 0, 0, 0, CONTENT, ENTRY, rename_fine_lod},
    {500, "lod-size", "zstd-lod", ZSTD_SHEL + 32, 8, 81, HEADER, ZSTD_SHEL + 32, NULL},
    {500, "lod-size", "lod", COARSE + 20, 4, 0xFFFFFFFF, SECTIONS, COARSE + 20, NULL},
    {501, "lod-header", "lod", COARSE + 4, 4, 0x7FC00000, SECTIONS, COARSE + 4, NULL}, /* NaN */
    {501, "lod-header", "lod", FINE + 16, 4, 0xBF800000, SECTIONS, FINE + 16, NULL},       /* -1 */
    {501, "lod-header", "lod", COARSE + 28, 4, 4, SECTIONS, COARSE + 28, NULL},
    {500, "lod-size", "lod", COARSE + 28, 4, 2, SECTIONS, COARSE + 20, NULL},
    {500, "lod-size", "normals", COARSE + 28, 4, 0, SECTIONS, COARSE + 20, NULL},
    {500, "lod-size", "normals", COARSE + 20, 4, 3, SECTIONS, COARSE + 20, NULL},
    {506, "lod-normals", "normals", NORMAL_ERROR, 4, 0x7FC00000, SECTIONS, NORMAL_ERROR, NULL},
    {506, "lod-normals", "normals", NORMAL_ERROR, 4, 0xBF800000, SECTIONS, NORMAL_ERROR, NULL},
    {503, "lod-first", "lod", COARSE + 32, 4, 1, SECTIONS, COARSE + 32, NULL},
    {504, "lod-index", "lod", COARSE + 40, 4, 3, SECTIONS, COARSE + 40, NULL},
    {504, "lod-index", "lod", COARSE + 52, 4, 0xFFFFFFFF, SECTIONS, COARSE + 52, NULL},
};
enum { VARIANT_COUNT = sizeof variants / sizeof variants[0] };

static const bad *bad_at(int index)
{
    return index < BAD_COUNT ? &bads[index] : &variants[index - BAD_COUNT];
}

static inline void path_of(const bad *b, char path[256])
{
    snprintf(path, 256, BAD "%u-%s.gtx", b->rule, b->name);
}

static inline bytes make_bad(const bad *b)
{
    bytes file = read_golden(b->base);
    if (b->edit)
        b->edit(&file);
    for (uint32_t i = 0; i < b->width; ++i)
        file.data[b->offset + i] = (uint8_t)(b->value >> 8 * i);
    if (b->rehash == SECTIONS)
        rehash_sections(file);
    else if (b->rehash != NOTHING)
        rehash_header(file, b->rehash == CONTENT);
    return file;
}

#endif
