/* Encoding an asset in its one canonical form, and saving the file atomically. */
#include "asset/codec.h"

#include "asset/header.h"
#include "asset/order.h"
#include "base/alloc.h"
#include "base/error.h"
#include "base/jobs.h"
#include "base/output.h"

#include <string.h>

/* Each takes an encoder's memory. The largest map has a fifth of all bytes or more: with more jobs
 * than this, the others would wait for it. */
enum { MAX_JOBS = 4 };

/* A file in the making. */
typedef struct writer {
    const gtx_asset *asset;
    gtx_allocator allocator;
    const gtx_jobs *jobs;
    int level;                    /* of zstd; 0 = stored */
    uint32_t count;
    gtx_section sections[GTX_MAX_KNOWN_SECTIONS];
    uint8_t *coded[GTX_MAX_KNOWN_SECTIONS];
    uint32_t job[GTX_MAX_KNOWN_SECTIONS], job_count;
    gtx_encoder encoders[MAX_JOBS];
    bool done[MAX_JOBS];
    uint8_t *block;               /* of all that encoding takes */
    size_t block_size;
} writer;

/* The filter that made cooked scans and photographic textures smallest, at zstd levels 3 and 19.
 * Emission, black but for a few lights, is smallest as it is. */
static uint32_t filter_of(gtx_section_kind kind)
{
    switch (kind) {
    case GTX_SECTION_HEIGHT: return GTX_FILTER_HEIGHTS;
    case GTX_SECTION_TRIM:
    case GTX_SECTION_NORMAL: return GTX_FILTER_SURFACE;
    case GTX_SECTION_COLOR:
    case GTX_SECTION_MATERIAL: return GTX_FILTER_PLANES_PAETH;
    case GTX_SECTION_LOD: return GTX_FILTER_STEPS;
    default: return GTX_FILTER_NONE;
    }
}

/* Gives every section to a job, the longest first, to the one that has least to do. */
static void share_out(writer *w)
{
    uint64_t work[GTX_MAX_KNOWN_SECTIONS], load[MAX_JOBS] = {0};
    uint32_t order[GTX_MAX_KNOWN_SECTIONS];
    for (uint32_t i = 0; i < w->count; ++i)
        work[i] = w->sections[i].size;
    gtx_longest_first(work, w->count, order);
    w->job_count = w->jobs && w->jobs->run ? MAX_JOBS : 1;
    for (uint32_t i = 0; i < w->count; ++i) {
        uint32_t least = 0;
        for (uint32_t j = 1; j < w->job_count; ++j)
            least = load[j] < load[least] ? j : least;
        load[least] += work[order[i]];
        w->job[order[i]] = least;
    }
}

/* The places of everything in the block, which may be NULL. Returns its size. */
static uint64_t find_rooms(writer *w, uint8_t *block)
{
    uint64_t end = 0;
    for (uint32_t i = 0; i < w->count; ++i) {
        w->coded[i] = block ? block + end : NULL;
        end += gtx_align64(w->sections[i].size);
    }
    for (uint32_t j = 0; j < w->job_count; ++j) {
        uint64_t memory = 0, filtered = 0;
        for (uint32_t i = 0; i < w->count; ++i) {
            const gtx_section *s = &w->sections[i];
            const uint64_t coder = gtx_align64(gtx_encoder_size(w->level, s->size));
            const uint64_t image = gtx_align64(gtx_apply_size(
                s, gtx_section_shape(&w->asset->info, s->kind, s->level)));
            memory = w->job[i] == j && coder > memory ? coder : memory;
            filtered = w->job[i] == j && image > filtered ? image : filtered;
        }
        w->encoders[j] = (gtx_encoder){w->level, block ? block + end : NULL, (size_t)memory,
                                       block ? block + end + memory : NULL};
        end += memory + filtered;
    }
    return end;
}

static void compress(writer *w, uint32_t i, const gtx_encoder *encoder)
{
    gtx_section *section = &w->sections[i];
    const uint8_t *data = gtx_asset_data(w->asset, section->kind, section->level);
    const size_t size = gtx_encode_section(encoder, section, w->asset, data, w->coded[i]);
    if (size) {
        section->scheme = GTX_SCHEME_ZSTD;
        section->stored_size = size;
    } else { /* would not get smaller */
        section->filter = 0;
    }
}

static void compress_share(uint32_t job, void *data)
{
    writer *w = data;
    for (uint32_t i = 0; i < w->count; ++i)
        if (w->job[i] == job)
            compress(w, i, &w->encoders[job]);
    w->done[job] = true;
}

static bool compress_all(writer *w)
{
    bool whole = true;
    for (uint32_t i = 0; i < w->count; ++i)
        w->sections[i].filter = filter_of(w->sections[i].kind);
    share_out(w);
    const uint64_t size = find_rooms(w, NULL);
    w->block = size > SIZE_MAX ? NULL : gtx_alloc_raw(&w->allocator, (size_t)size, 1);
    if (!w->block)
        return false;
    w->block_size = (size_t)size;
    find_rooms(w, w->block);
    gtx_run_jobs(w->jobs, w->job_count, compress_share, w);
    for (uint32_t j = 0; j < w->job_count; ++j)
        whole = whole && w->done[j]; /* a host may have stopped */
    return whole;
}

/* Gives every section its place; returns the size of the file. */
static uint64_t place(writer *w)
{
    uint64_t end = GTX_HEADER_SIZE + (uint64_t)GTX_ENTRY_SIZE * w->count;
    for (uint32_t i = 0; i < w->count; ++i) {
        gtx_section *section = &w->sections[i];
        if (section->scheme == GTX_SCHEME_STORED)
            section->stored_size = section->size;
        section->offset = end;
        end = gtx_align64(end + section->stored_size);
    }
    return end;
}

static void emit(const writer *w, uint8_t *bytes, uint64_t size)
{
    gtx_header_store(bytes, &w->asset->info, w->sections, w->count, size);
    for (uint32_t i = 0; i < w->count; ++i) {
        const gtx_section *section = &w->sections[i];
        const void *data = section->scheme == GTX_SCHEME_ZSTD
                               ? w->coded[i]
                               : gtx_asset_data(w->asset, section->kind, section->level);
        memcpy(bytes + section->offset, data, (size_t)section->stored_size);
        if (section->scheme == GTX_SCHEME_STORED)
            gtx_turn_section(w->asset, section, bytes + section->offset);
    }
}

static gtx_result write_all(writer *w, void **data, size_t *size, gtx_error *error)
{
    w->count = gtx_asset_sections(w->asset, w->sections);
    if (w->level && !compress_all(w))
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory for compressing");
    uint64_t total = place(w);
    uint8_t *bytes = total > SIZE_MAX ? NULL
                                      : gtx_alloc_array(&w->allocator, (size_t)total, 1);
    if (!bytes)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory for the bytes of a file");
    emit(w, bytes, total);
    *data = bytes;
    *size = (size_t)total;
    return GTX_OK;
}

/* Bunny and dragon: 3 % fewer bytes than at 3, zstd's own, for 1 % of a cook's time; 1 % fewer yet
 * at 9, for twice that time. */
enum { DEFAULT_LEVEL = 6 };

gtx_result gtx_encode(const gtx_asset *asset, const gtx_encode_desc *desc, void **data,
                      size_t *size, gtx_error *error)
{
    static const gtx_encode_desc defaults = {0};
    if (!desc)
        desc = &defaults;
    if (!asset || !data || !size)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "gtx_encode needs an asset and a result");
    gtx_result result = gtx_check_reserved(desc->reserved, 5, error);
    if (result)
        return result;
    if (desc->zstd_level < -1 || desc->zstd_level > 19)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "zstd_level is -1..19, not %d",
                        desc->zstd_level);
    if (desc->zstd_level > 0 && !gtx_has_zstd())
        return gtx_fail(error, GTX_ERROR_UNSUPPORTED, "this build has no zstd");

    writer w = {.asset = asset,
                .allocator = gtx_allocator_or_default(desc->allocator),
                .jobs = desc->jobs,
                .level = desc->zstd_level < 0  ? 0
                         : desc->zstd_level    ? desc->zstd_level
                         : gtx_has_zstd()      ? DEFAULT_LEVEL
                                               : 0};
    result = write_all(&w, data, size, error);
    gtx_free_array(&w.allocator, w.block, w.block_size, 1);
    return result;
}

gtx_result gtx_save_file(const gtx_asset *asset, const char *path, const gtx_encode_desc *desc,
                         gtx_error *error)
{
    if (!path)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the path to save to is NULL");
    void *data;
    size_t size;
    gtx_result result = gtx_encode(asset, desc, &data, &size, error);
    if (result)
        return result;
    gtx_allocator allocator = gtx_allocator_or_default(desc ? desc->allocator : NULL);
    result = gtx_write_file(path, data, size, error);
    gtx_free_array(&allocator, data, size, 1);
    return result;
}
