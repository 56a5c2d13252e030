/* One pass over hostile bytes, in the order of format/gtx.md, section 7. */
#include "asset/read.h"

#include "asset/blocks.h"
#include "asset/decode.h"
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
    gtx_decoding decoding;
    gtx_asset *asset;
    gtx_occupancy occupancy;      /* where rectangles hold */
} reader;

/* Sizes that the table says. */
static gtx_sizes sizes_of(const gtx_layout *layout)
{
    gtx_sizes out = {0};
    for (uint32_t i = 0; i < layout->section_count; ++i) {
        const gtx_section *section = &layout->sections[i];
        if (section->kind == GTX_SECTION_META)
            out.meta = section->size;
        if (section->kind == GTX_SECTION_LOD)
            out.lod[section->level] = section->size;
    }
    return out;
}

/* Whether the asset and the memory for reading it are within what is allowed. */
static bool within_limits(reader *r, uint64_t memory)
{
    const gtx_layout *layout = &r->layout;
    const gtx_info *info = &layout->info;
    const uint64_t page = (uint64_t)info->page_width * info->page_height;
    const struct {
        gtx_limited which;
        uint64_t wanted;
    } wants[] = {{GTX_LIMITED_PATCHES, info->patch_count},
                 {GTX_LIMITED_TEXELS, page * info->page_count},
                 {GTX_LIMITED_MEMORY, memory}};
    for (size_t i = 0; i < sizeof wants / sizeof *wants; ++i) {
        const uint64_t allowed = gtx_limit_of(r->options.limits, wants[i].which, info->file_size);
        if (wants[i].wanted > allowed) {
            gtx_check_limit(r->check, wants[i].which, "the asset", wants[i].wanted, allowed);
            return false;
        }
    }
    return true;
}

/* What reading allocates is known before the first allocation. */
static void allocate(reader *r)
{
    const gtx_layout *layout = &r->layout;
    const gtx_sizes sizes = sizes_of(layout);
    gtx_decoding_plan(&r->decoding, layout->sections, layout->section_count, &layout->info,
                      r->options.jobs);
    r->decoding.hashed = !r->options.skip_hash;
    const uint64_t need = gtx_asset_bytes(&layout->info, &sizes) +
                          gtx_occupancy_size(&layout->info) + r->decoding.size;
    if (r->decoding.zstd && !gtx_has_zstd()) {
        gtx_check_fail(r->check, GTX_ERROR_UNSUPPORTED,
                       "the file is compressed and this build has no zstd");
        return;
    }
    if (!within_limits(r, need + r->options.bytes_held))
        return;
    if (need > SIZE_MAX) {
        gtx_check_fail(r->check, GTX_ERROR_MEMORY, "reading takes %" PRIu64 " bytes", need);
        return;
    }
    r->asset = gtx_asset_new(&r->options.allocator, &layout->info, &sizes, false);
    if (!r->asset || !gtx_decoding_begin(&r->decoding, r->asset, r->data))
        gtx_check_fail(r->check, GTX_ERROR_MEMORY, "out of memory for an asset of %" PRIu64
                       " bytes", need);
}

/* Tells what is wrong with a part as such. False when its bytes could not be had. */
static bool check_part(const reader *r, const gtx_part *part)
{
    const gtx_section *section = part->section;
    if (part->wrong)
        gtx_break(r->check, GTX_RULE_SECTION_ZSTD, section->offset, "in %s %s", section->name,
                  part->wrong);
    else if (r->decoding.hashed && part->hash != section->hash)
        gtx_break(r->check, GTX_RULE_SECTION_HASH,
                  GTX_HEADER_SIZE + (uint64_t)GTX_ENTRY_SIZE * part->index + 48,
                  "that of %s is 0x%016" PRIx64, section->name, section->hash);
    return !part->wrong;
}

/* In the order of the file, but levels from the largest on. */
static void check_rest(const reader *r, bool patches_hold)
{
    const gtx_decoding *d = &r->decoding;
    const gtx_asset *asset = r->asset;
    const gtx_part *height = NULL;
    for (uint32_t first = 1, end; first < d->part_count; first = end) {
        end = first + 1 + d->parts[first].section->level;
        for (uint32_t i = end; i-- > first && !gtx_check_over(r->check);) {
            const gtx_part *part = &d->parts[i];
            const gtx_section *section = part->section;
            if (!gtx_part_known(d, part, r->occupancy.words) || !check_part(r, part))
                continue; /* a rule is broken already */
            if (section->kind == GTX_SECTION_HEIGHT)
                height = part;
            else if (section->kind == GTX_SECTION_LOD && patches_hold && !part->holds)
                gtx_check_lod(r->check, asset, section->level, section->offset);
            else if (section->kind == GTX_SECTION_META)
                gtx_check_meta(r->check, asset->meta, asset->meta_size, section->offset);
        }
    }
    if (height && r->occupancy.words && !gtx_check_over(r->check)) {
        const gtx_map_places places = {d->parts[0].section->offset, height->section->offset,
                                       height->section->scheme == GTX_SCHEME_STORED};
        gtx_check_maps(r->check, asset, &r->occupancy, d->holds, &places);
    }
}

static void read_sections(reader *r)
{
    gtx_check *check = r->check;
    const gtx_part *patches = &r->decoding.parts[0];
    gtx_decode_patches(&r->decoding);
    bool hold = check_part(r, patches);
    if (hold && !gtx_check_over(check)) {
        const uint64_t before = check->broken;
        gtx_check_patches(check, r->asset, patches->section->offset, &r->occupancy);
        hold = check->broken == before;
    }
    if (gtx_check_over(check))
        return;
    gtx_decode_rest(&r->decoding, r->occupancy.words, hold);
    check_rest(r, hold);
}

/* A section that this reader can use, if it is there and what the asset may take allows. */
static const gtx_section *find_blocks(const reader *r, size_t *decoder)
{
    const gtx_layout *layout = &r->layout;
    const gtx_sizes sizes = sizes_of(layout);
    for (uint32_t i = 0; i < layout->section_count; ++i) {
        const gtx_section *s = &layout->sections[i];
        if (s->kind != GTX_SECTION_UNKNOWN || memcmp(s->type, "BLKS", 4) != 0)
            continue;
        *decoder = s->scheme == GTX_SCHEME_ZSTD ? gtx_decoder_size() : 0;
        const uint64_t held = gtx_asset_bytes(&layout->info, &sizes) + r->options.bytes_held;
        const bool fits = s->size <= gtx_blocks_most(&layout->info) && s->size <= SIZE_MAX &&
                          (s->scheme == GTX_SCHEME_STORED || gtx_has_zstd()) &&
                          held + s->size + *decoder <=
                              gtx_limit_of(r->options.limits, GTX_LIMITED_MEMORY,
                                           layout->info.file_size);
        return fits ? s : NULL;
    }
    return NULL;
}

/* Whatever is wrong with them, texels are there: then it is as if there were none. */
static void read_blocks(const reader *r)
{
    gtx_block_map maps[GTX_MAX_BLOCK_MAPS];
    size_t decoder_size = 0;
    const gtx_section *s = find_blocks(r, &decoder_size);
    if (!s)
        return;
    const gtx_allocator *hooks = &r->asset->allocator;
    const size_t size = (size_t)s->size;
    uint8_t *bytes = gtx_alloc_raw(hooks, size, 1);
    void *decoder = decoder_size ? gtx_alloc_raw(hooks, decoder_size, 1) : NULL;
    bool holds = bytes && (decoder || !decoder_size);
    if (holds && decoder)
        holds = !gtx_decompress(decoder, s, r->data + s->offset, bytes);
    else if (holds)
        memcpy(bytes, r->data + s->offset, size);
    holds = holds && gtx_hash_bytes(bytes, size) == s->hash &&
            gtx_blocks_load(&r->asset->info, bytes, size, maps);
    gtx_free_array(hooks, decoder, decoder_size, 1);
    if (!holds)
        gtx_free_array(hooks, bytes, size, 1);
    gtx_keep_blocks(r->asset, holds ? bytes : NULL, size);
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
        gtx_decoding_end(&r.decoding, &r.options.allocator);
        gtx_occupancy_free(&r.occupancy, &r.options.allocator);
    }
    if (r.asset && !check->result)
        read_blocks(&r);
    if (check->result) {
        gtx_close(r.asset);
        r.asset = NULL;
    }
    *out = r.asset;
    return check->result;
}
