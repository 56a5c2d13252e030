/* Opening and validating: one pass over hostile bytes, in the order of format/gtx.md, section 6. */
#include "asset/check.h"

#include "asset/codec.h"
#include "asset/header.h"
#include "base/alloc.h"
#include "base/hash.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define DEFAULT_LIMIT ((uint64_t)4 << 30)

typedef struct reader {
    gtx_check check;
    gtx_allocator allocator;
    uint64_t limit;               /* bytes that may be allocated */
    bool skip_hash;
    const uint8_t *data;
    gtx_layout layout;
    gtx_codec codec;
    gtx_asset *asset;
    bool heights_known;
    uint64_t patch_offset, height_offset;
    bool height_stored;
    gtx_occupancy occupancy;
} reader;

/* What reading allocates, all of it known before the first allocation. */
typedef struct demand {
    uint64_t bytes;
    uint64_t filtered;            /* the largest image that is decoded through a buffer */
    size_t meta;
    bool zstd;
} demand;

static demand demand_of(const gtx_layout *layout)
{
    demand out = {0};
    for (uint32_t i = 0; i < layout->section_count; ++i) {
        const gtx_section *section = &layout->sections[i];
        if (section->kind == GTX_SECTION_UNKNOWN)
            continue;
        if (section->kind == GTX_SECTION_META)
            out.meta = (size_t)section->size;
        out.zstd = out.zstd || section->scheme == GTX_SCHEME_ZSTD;
        if (section->filter & GTX_FILTER_PLANES && section->size > out.filtered)
            out.filtered = section->size;
    }
    out.bytes = gtx_asset_bytes(&layout->info, out.meta) + gtx_occupancy_size(&layout->info) +
                out.filtered + (out.zstd ? gtx_decoder_size() : 0);
    return out;
}

static void allocate(reader *r)
{
    demand need = demand_of(&r->layout);
    if (need.zstd && !gtx_has_zstd()) {
        gtx_check_fail(&r->check, GTX_ERROR_UNSUPPORTED,
                       "the file is compressed and this build has no zstd");
        return;
    }
    if (need.bytes > r->limit || need.bytes > SIZE_MAX) {
        gtx_check_fail(&r->check, GTX_ERROR_LIMIT,
                       "reading takes %" PRIu64 " bytes, more than the %" PRIu64 " allowed",
                       need.bytes, r->limit);
        return;
    }
    r->asset = gtx_asset_new(&r->allocator, &r->layout.info, need.meta);
    if (!r->asset ||
        (need.zstd &&
         !gtx_decoder_begin(&r->codec, &r->allocator, (size_t)need.filtered)))
        gtx_check_fail(&r->check, GTX_ERROR_MEMORY, "out of memory for an asset of %" PRIu64
                       " bytes", need.bytes);
}

/* False when the bytes could not be had. */
static bool decode(reader *r, const gtx_section *section, uint64_t entry_offset, uint8_t *out)
{
    const uint8_t *bytes = r->data + section->offset;
    if (section->scheme == GTX_SCHEME_ZSTD) {
        gtx_map_shape image = gtx_section_shape(&r->layout.info, section->kind, section->level);
        const char *wrong = gtx_decode_section(&r->codec, section, image, bytes, out);
        if (wrong) {
            gtx_break(&r->check, GTX_RULE_SECTION_ZSTD, section->offset, "in %s %s",
                      section->name, wrong);
            return false;
        }
    } else {
        memcpy(out, bytes, (size_t)section->size);
    }
    if (!r->skip_hash && gtx_hash_bytes(out, (size_t)section->size) != section->hash)
        gtx_break(&r->check, GTX_RULE_SECTION_HASH, entry_offset + 48,
                  "that of %s is 0x%016" PRIx64, section->name, section->hash);
    return true;
}

/* What a section's content must obey, once it is there. */
static void check_section(reader *r, const gtx_section *section)
{
    gtx_check *check = &r->check;
    gtx_asset *asset = r->asset;
    if (section->kind == GTX_SECTION_PATCHES) {
        r->patch_offset = section->offset;
        gtx_check_patches(check, asset, section->offset, &r->occupancy);
    } else if (section->kind == GTX_SECTION_HEIGHT) {
        r->heights_known = true;
        r->height_offset = section->offset;
        r->height_stored = section->scheme == GTX_SCHEME_STORED;
    } else if (section->kind == GTX_SECTION_META) {
        gtx_check_meta(check, asset->meta, asset->meta_size, section->offset);
    }
}

static void read_sections(reader *r)
{
    const gtx_layout *layout = &r->layout;
    for (uint32_t i = 0; i < layout->section_count && !gtx_check_over(&r->check); ++i) {
        const gtx_section *section = &layout->sections[i];
        if (section->kind == GTX_SECTION_UNKNOWN)
            continue;
        uint8_t *out = gtx_asset_data(r->asset, section->kind, section->level);
        if (decode(r, section, GTX_HEADER_SIZE + (uint64_t)GTX_ENTRY_SIZE * i, out))
            check_section(r, section);
    }
    if (r->occupancy.words && r->heights_known && !gtx_check_over(&r->check))
        gtx_check_maps(&r->check, r->asset, &r->occupancy, r->patch_offset,
                       r->height_offset, r->height_stored);
}

/* Leaves an asset in the reader when nothing was wrong. */
static gtx_result read_all(reader *r, const void *data, size_t size)
{
    gtx_check *check = &r->check;
    check->in_file = true;
    r->data = data;
    gtx_check_file(check, data, size, &r->layout);
    if (r->layout.known && !gtx_check_over(check)) {
        allocate(r);
        if (!gtx_check_over(check))
            read_sections(r);
        if (r->codec.allocator.free)
            gtx_codec_end(&r->codec);
        gtx_occupancy_free(&r->occupancy, &r->allocator);
    }
    if (check->result) {
        gtx_close(r->asset);
        r->asset = NULL;
    }
    return check->result;
}

static gtx_result check_open(const gtx_open_desc *desc, gtx_asset **out, gtx_error *error)
{
    if (!out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "opening needs a place for the asset");
    *out = NULL;
    if (!desc)
        return GTX_OK;
    if (desc->flags & ~(uint32_t)GTX_OPEN_SKIP_HASH)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "unknown flags 0x%08x", desc->flags);
    return gtx_check_reserved(desc->reserved, 5, error);
}

static uint64_t limit_of(const gtx_open_desc *desc)
{
    return desc && desc->max_bytes ? desc->max_bytes : DEFAULT_LIMIT;
}

static gtx_result open_bytes(const void *data, size_t size, const gtx_open_desc *desc,
                             uint64_t limit, gtx_asset **out, gtx_error *error)
{
    reader r = {
        .check = {.error = error},
        .allocator = gtx_allocator_or_default(desc ? desc->allocator : NULL),
        .limit = limit,
        .skip_hash = desc && desc->flags & GTX_OPEN_SKIP_HASH,
    };
    gtx_result result = read_all(&r, data, size);
    *out = r.asset;
    return result;
}

gtx_result gtx_open_memory(const void *data, size_t size, const gtx_open_desc *desc,
                           gtx_asset **out, gtx_error *error)
{
    gtx_result result = check_open(desc, out, error);
    if (result)
        return result;
    if (!data && size)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the bytes to open are NULL");
    return open_bytes(data, size, desc, limit_of(desc), out, error);
}

/* The size of a file, which is then read from its start. */
static gtx_result measure(FILE *file, const char *path, uint64_t *size, gtx_error *error)
{
    /* The first read tells a directory, which opens and has a "size" on some systems. */
    if (fgetc(file) == EOF && ferror(file))
        return gtx_fail(error, GTX_ERROR_READ, "cannot read %s", path);
    long end = -1;
    if (!fseek(file, 0, SEEK_END))
        end = ftell(file);
    if (end < 0 || fseek(file, 0, SEEK_SET))
        return gtx_fail(error, GTX_ERROR_READ, "cannot find the size of %s", path);
    *size = (uint64_t)end;
    return GTX_OK;
}

static gtx_result open_stream(FILE *file, const char *path, const gtx_open_desc *desc,
                              gtx_asset **out, gtx_error *error)
{
    uint64_t size = 0, limit = limit_of(desc);
    gtx_result result = measure(file, path, &size, error);
    if (result)
        return result;
    if (size == 0)
        return open_bytes(NULL, 0, desc, limit, out, error);
    if (size > limit || size > SIZE_MAX)
        return gtx_fail(error, GTX_ERROR_LIMIT, "%s has %" PRIu64 " bytes, more than the %" PRIu64
                        " allowed", path, size, limit);
    gtx_allocator allocator = gtx_allocator_or_default(desc ? desc->allocator : NULL);
    void *data = gtx_alloc_array(&allocator, (size_t)size, 1);
    if (!data)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory for %s", path);
    if (fread(data, 1, (size_t)size, file) == size)
        result = open_bytes(data, (size_t)size, desc, limit - size, out, error);
    else
        result = gtx_fail(error, GTX_ERROR_READ, "cannot read %s to its end", path);
    gtx_free_array(&allocator, data, (size_t)size, 1);
    return result;
}

gtx_result gtx_open_file(const char *path, const gtx_open_desc *desc, gtx_asset **out,
                         gtx_error *error)
{
    gtx_result result = check_open(desc, out, error);
    if (result)
        return result;
    if (!path)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the path to open is NULL");
    FILE *file = fopen(path, "rb");
    if (!file)
        return gtx_fail(error, GTX_ERROR_READ, "cannot open %s", path);
    result = open_stream(file, path, desc, out, error);
    fclose(file);
    return result;
}

gtx_result gtx_validate(const void *data, size_t size, gtx_issue_fn fn, void *user,
                        gtx_error *error)
{
    if (!data && size)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the bytes to validate are NULL");
    reader r = {
        .check = {.fn = fn, .user = user, .error = error, .keep_going = true},
        .allocator = gtx_allocator_or_default(NULL),
        .limit = DEFAULT_LIMIT,
    };
    gtx_result result = read_all(&r, data, size);
    gtx_close(r.asset);
    return result;
}
