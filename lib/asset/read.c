/* One pass over hostile bytes, in the order of format/gtx.md, section 6. */
#include "asset/read.h"

#include "asset/codec.h"
#include "asset/header.h"
#include "base/alloc.h"
#include "base/hash.h"

#include <inttypes.h>
#include <string.h>

typedef struct reader {
    gtx_check *check;
    gtx_read_options options;
    const uint8_t *data;
    gtx_layout layout;
    gtx_codec codec;
    gtx_asset *asset;
    bool heights_known;
    bool frames_known;            /* the patches broke no rule */
    uint64_t patch_offset, height_offset;
    bool height_stored;
    gtx_occupancy occupancy;
} reader;

/* What reading allocates, all of it known before the first allocation. */
typedef struct demand {
    uint64_t bytes;
    uint64_t filtered;            /* the most that undoing a filter takes */
    gtx_sizes sizes;
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
            out.sizes.meta = section->size;
        if (section->kind == GTX_SECTION_SHELL)
            out.sizes.shell[section->level] = section->size;
        out.zstd = out.zstd || section->scheme == GTX_SCHEME_ZSTD;
        uint64_t undo = gtx_undo_size(
            section, gtx_section_shape(&layout->info, section->kind, section->level));
        out.filtered = undo > out.filtered ? undo : out.filtered;
    }
    out.bytes = gtx_asset_bytes(&layout->info, &out.sizes) + gtx_occupancy_size(&layout->info) +
                out.filtered + (out.zstd ? gtx_decoder_size() : 0);
    return out;
}

static void allocate(reader *r)
{
    demand need = demand_of(&r->layout);
    if (need.zstd && !gtx_has_zstd()) {
        gtx_check_fail(r->check, GTX_ERROR_UNSUPPORTED,
                       "the file is compressed and this build has no zstd");
        return;
    }
    if (need.bytes > r->options.limit || need.bytes > SIZE_MAX) {
        gtx_check_fail(r->check, GTX_ERROR_LIMIT,
                       "reading takes %" PRIu64 " bytes, more than the %" PRIu64 " allowed",
                       need.bytes, r->options.limit);
        return;
    }
    r->asset = gtx_asset_new(&r->options.allocator, &r->layout.info, &need.sizes);
    if (!r->asset ||
        (need.zstd &&
         !gtx_decoder_begin(&r->codec, &r->options.allocator, (size_t)need.filtered)))
        gtx_check_fail(r->check, GTX_ERROR_MEMORY, "out of memory for an asset of %" PRIu64
                       " bytes", need.bytes);
}

/* False when the bytes could not be had. */
static bool decode(reader *r, const gtx_section *section, uint64_t entry_offset, uint8_t *out)
{
    const uint8_t *bytes = r->data + section->offset;
    if (section->scheme == GTX_SCHEME_ZSTD) {
        const char *wrong = gtx_decode_section(&r->codec, section, r->asset, bytes, out);
        if (wrong) {
            gtx_break(r->check, GTX_RULE_SECTION_ZSTD, section->offset, "in %s %s",
                      section->name, wrong);
            return false;
        }
    } else {
        memcpy(out, bytes, (size_t)section->size);
    }
    if (!r->options.skip_hash && gtx_hash_bytes(out, (size_t)section->size) != section->hash)
        gtx_break(r->check, GTX_RULE_SECTION_HASH, entry_offset + 48,
                  "that of %s is 0x%016" PRIx64, section->name, section->hash);
    return true;
}

/* What a section's content must obey, once it is there. */
static void check_section(reader *r, const gtx_section *section)
{
    gtx_check *check = r->check;
    gtx_asset *asset = r->asset;
    if (section->kind == GTX_SECTION_PATCHES) {
        r->patch_offset = section->offset;
        uint64_t before = check->broken;
        gtx_check_patches(check, asset, section->offset, &r->occupancy);
        r->frames_known = check->broken == before;
    } else if (section->kind == GTX_SECTION_HEIGHT) {
        r->heights_known = true;
        r->height_offset = section->offset;
        r->height_stored = section->scheme == GTX_SCHEME_STORED;
    } else if (section->kind == GTX_SECTION_SHELL) {
        if (r->frames_known)
            gtx_check_shell(check, asset, section->level, section->offset);
    } else if (section->kind == GTX_SECTION_META) {
        gtx_check_meta(check, asset->meta, asset->meta_size, section->offset);
    }
}

static void read_section(reader *r, uint32_t index)
{
    const gtx_section *section = &r->layout.sections[index];
    bool known = section->filter != GTX_FILTER_SURFACE || (r->occupancy.words && r->heights_known);
    if (section->kind == GTX_SECTION_UNKNOWN || !known)
        return; /* not known: a rule is broken already */
    uint8_t *out = gtx_asset_data(r->asset, section->kind, section->level);
    if (decode(r, section, GTX_HEADER_SIZE + (uint64_t)GTX_ENTRY_SIZE * index, out))
        check_section(r, section);
}

/* In the order of the file, but levels from the largest on: a filter may need the finer one. */
static void read_sections(reader *r)
{
    const gtx_layout *layout = &r->layout;
    for (uint32_t first = 0, end; first < layout->section_count; first = end) {
        end = first + 1 + layout->sections[first].level;
        for (uint32_t i = end; i-- > first && !gtx_check_over(r->check);)
            read_section(r, i);
    }
    if (r->occupancy.words && r->heights_known && !gtx_check_over(r->check))
        gtx_check_maps(r->check, r->asset, &r->occupancy, r->patch_offset,
                       r->height_offset, r->height_stored);
}

gtx_result gtx_read_asset(gtx_check *check, const gtx_read_options *options, const void *data,
                          size_t size, gtx_asset **out)
{
    reader r = {.check = check, .options = *options, .data = data};
    check->in_file = true;
    gtx_check_file(check, data, size, &r.layout);
    if (r.layout.known && !gtx_check_over(check)) {
        allocate(&r);
        if (!gtx_check_over(check))
            read_sections(&r);
        if (r.codec.allocator.free)
            gtx_codec_end(&r.codec);
        gtx_occupancy_free(&r.occupancy, &r.options.allocator);
    }
    if (check->result) {
        gtx_close(r.asset);
        r.asset = NULL;
    }
    *out = r.asset;
    return check->result;
}
