/* Opening the first bytes of a file as an asset of what has arrived, and again with more bytes. */
#include "asset/arrival.h"
#include "asset/preview.h"

#include "asset/decode.h"
#include "asset/header.h"
#include "asset/lod.h"
#include "base/alloc.h"
#include "base/bytes.h"

#include <inttypes.h>

/* Texels for each triangle, at most: fewer blur what lies between vertices. And where vertices have
 * normals, by which the forward pass lights what has neither colours nor materials: other passes
 * alone look these up. */
enum { TEXELS = 4, LIT_TEXELS = 1 };

/* What comes of the first bytes. */
typedef struct beginning {
    gtx_check check;
    const gtx_read_options *options;
    gtx_layout layout;
    gtx_arrival has;
    gtx_decoding decoding;
    gtx_asset *source;
    gtx_occupancy occupancy;
    uint32_t shift;
    gtx_info info;                /* of the preview */
} beginning;

/* ---- memory ---- */

static void *room_for(const gtx_asset *source, uint64_t size)
{
    return size > SIZE_MAX ? NULL : gtx_alloc_raw(&source->allocator, (size_t)size, 1);
}

/* An asset with room for the parts alone. */
static bool make_source(beginning *b)
{
    gtx_asset *source = gtx_alloc_array(&b->options->allocator, 1, sizeof *source);
    b->source = source;
    if (!source)
        return false;
    source->allocator = b->options->allocator;
    source->info = b->layout.info;
    source->info.lod_levels = b->has.lods;
    bool whole = true;
    for (uint32_t i = 0; i < b->has.part_count && whole; ++i) {
        const gtx_section *part = &b->has.parts[i];
        void *room = room_for(source, part->size);
        whole = room != NULL;
        if (part->kind == GTX_SECTION_PATCHES)
            source->patches = room;
        else if (part->kind == GTX_SECTION_LOD)
            source->lod[part->level] = room;
        else
            *gtx_asset_map(source, part->kind, part->level) = room;
        if (part->kind == GTX_SECTION_LOD && whole)
            source->lod_size[part->level] = (size_t)part->size;
    }
    return whole;
}

static bool is_allowed(beginning *b, uint64_t memory)
{
    const gtx_info *info = &b->layout.info;
    const struct {
        gtx_limited which;
        uint64_t wanted;
    } wants[] = {{GTX_LIMITED_PATCHES, info->patch_count},
                 {GTX_LIMITED_TEXELS,
                  (uint64_t)info->page_width * info->page_height * info->page_count},
                 {GTX_LIMITED_MEMORY, memory + b->options->bytes_held}};
    for (size_t i = 0; i < sizeof wants / sizeof *wants; ++i) {
        const uint64_t allowed = gtx_limit_of(b->options->limits, wants[i].which, b->has.size);
        if (wants[i].wanted > allowed) {
            gtx_check_limit(&b->check, wants[i].which, "the asset", wants[i].wanted, allowed);
            return false;
        }
    }
    return true;
}

/* Of all parts as they come out. */
static uint64_t source_bytes(const beginning *b)
{
    uint64_t bytes = sizeof(gtx_asset);
    for (uint32_t i = 0; i < b->has.part_count; ++i)
        bytes += b->has.parts[i].size;
    return bytes;
}

/* ---- decoding ---- */

static bool holds(beginning *b, const gtx_part *part)
{
    const gtx_section *section = part->section;
    if (part->wrong)
        gtx_break(&b->check, GTX_RULE_SECTION_ZSTD, section->offset, "in %s %s", section->name,
                  part->wrong);
    else if (b->decoding.hashed && part->hash != section->hash)
        gtx_break(&b->check, GTX_RULE_SECTION_HASH, section->offset, "that of %s is 0x%016" PRIx64,
                  section->name, section->hash);
    return !gtx_check_over(&b->check);
}

static void decode(beginning *b)
{
    gtx_decoding *d = &b->decoding;
    const gtx_section *first = d->parts[0].section;
    gtx_decode_patches(d);
    if (!holds(b, &d->parts[0]))
        return;
    if (first->kind == GTX_SECTION_LOD) {
        gtx_check_lod(&b->check, b->source, first->level, first->offset);
        return;
    }
    gtx_check_patches(&b->check, b->source, first->offset, &b->occupancy);
    gtx_occupancy_free(&b->occupancy, &b->options->allocator);
    if (gtx_check_over(&b->check))
        return;
    gtx_decode_rest(d, b->has.normals, true);
    for (uint32_t i = d->part_count; i-- > 1;) { /* the finest first */
        const gtx_part *part = &d->parts[i];
        if (!holds(b, part))
            return;
        if (part->section->kind == GTX_SECTION_LOD && !part->holds)
            gtx_check_lod(&b->check, b->source, part->section->level, part->section->offset);
        if (gtx_check_over(&b->check))
            return;
    }
}

/* Of patches that are laid, for they have not come. */
static uint64_t laid_bytes(const beginning *b)
{
    return b->has.patches ? 0 : sizeof(gtx_patch) * (uint64_t)b->layout.info.patch_count;
}

/* Patches for an LOD mesh that came without. False where there are none whose floats are fine
 * enough: then the file's own are waited for. */
static bool sketch(beginning *b)
{
    gtx_check quiet = {0};
    if (!is_allowed(b, source_bytes(b) + laid_bytes(b) + gtx_occupancy_size(&b->layout.info)))
        return false;
    if (gtx_sketch_patches(b->source))
        gtx_check_patches(&quiet, b->source, 0, &b->occupancy);
    gtx_occupancy_free(&b->occupancy, &b->options->allocator);
    if (!b->source->patches || quiet.failed)
        gtx_check_fail(&b->check, GTX_ERROR_MEMORY, "out of memory for the beginning of a file");
    else if (!quiet.broken)
        gtx_check_lod(&quiet, b->source, 0, 0);
    return !gtx_check_over(&quiet) && !gtx_check_over(&b->check);
}

/* The preview's, and what making it takes. */
static uint64_t preview_bytes(const beginning *b, const gtx_lod_mesh *mesh)
{
    gtx_sizes sizes = {0};
    for (uint32_t k = 0; k < b->has.lods; ++k)
        sizes.lod[k] = b->source->lod_size[k];
    const uint64_t marks =
        b->has.normals ? (uint64_t)b->info.page_width * b->info.page_height * b->info.page_count
                       : 0;
    return gtx_asset_bytes(&b->info, &sizes) + marks +
           gtx_preview_scratch(&b->info, mesh->vertex_count);
}

static void shape_preview(beginning *b, uint32_t shift)
{
    b->shift = shift;
    b->info = gtx_preview_info(&b->layout.info, shift, b->has.normals);
    b->info.lod_levels = b->has.lods;
    b->info.has_color = b->has.images[GTX_SECTION_COLOR] >= 0;
    b->info.has_material = b->has.images[GTX_SECTION_MATERIAL] >= 0;
    b->info.has_emission = b->has.images[GTX_SECTION_EMISSION] >= 0;
    b->info.emission_scale = b->info.has_emission ? b->info.emission_scale : 0;
    b->info.file_size = b->has.size;
}

static gtx_asset *preview(beginning *b)
{
    gtx_lod_mesh mesh;
    gtx_get_lod_mesh(b->source, 0, &mesh);
    const bool images = b->info.has_color || b->info.has_material || b->info.has_emission;
    if (mesh.normals && !images && !b->has.normals)
        shape_preview(b, gtx_preview_shift(&b->layout.info, LIT_TEXELS * mesh.triangle_count));
    if (!is_allowed(b, source_bytes(b) + laid_bytes(b) + preview_bytes(b, &mesh)))
        return NULL;
    gtx_asset *out = gtx_preview_new(b->source, &b->info, b->shift, b->has.images);
    if (!out)
        gtx_check_fail(&b->check, GTX_ERROR_MEMORY, "out of memory for the beginning of an asset");
    return out;
}

/* As many triangles as the bytes of the finest LOD mesh that is there may hold, for the shift is
 * chosen before it is decoded. */
static uint64_t most_triangles(const beginning *b)
{
    for (uint32_t i = 0; i < b->has.part_count; ++i)
        if (b->has.parts[i].kind == GTX_SECTION_LOD && b->has.parts[i].level == 0)
            return b->has.parts[i].size / 15;
    return 0;
}

static gtx_asset *read_parts(beginning *b)
{
    if (!b->has.patches)
        b->layout.info = gtx_sketch_info(&b->layout.info);
    b->shift = b->has.normals ? 0
                              : gtx_preview_shift(&b->layout.info, TEXELS * most_triangles(b));
    gtx_arrival_choose(&b->has, b->shift);
    shape_preview(b, b->shift);
    gtx_decoding_plan(&b->decoding, b->has.parts, b->has.part_count, &b->layout.info,
                      b->options->jobs);
    b->decoding.hashed = !b->options->skip_hash;
    if (b->decoding.zstd && !gtx_has_zstd())
        gtx_check_fail(&b->check, GTX_ERROR_UNSUPPORTED,
                       "the file is compressed and this build has no zstd");
    const uint64_t checked = b->has.patches ? gtx_occupancy_size(&b->layout.info) : 0;
    if (gtx_check_over(&b->check) ||
        !is_allowed(b, source_bytes(b) + b->decoding.size + checked))
        return NULL;
    gtx_asset *out = NULL;
    if (!make_source(b) || !gtx_decoding_begin(&b->decoding, b->source, b->has.data))
        gtx_check_fail(&b->check, GTX_ERROR_MEMORY, "out of memory for the beginning of a file");
    else {
        for (uint32_t i = 0; i < b->decoding.part_count; ++i) {
            gtx_part *part = &b->decoding.parts[i];
            part->bytes = gtx_arrived_bytes(&b->has, part->section);
        }
        decode(b);
    }
    gtx_decoding_end(&b->decoding, &b->options->allocator);
    if (!gtx_check_over(&b->check) && (b->has.patches || sketch(b)))
        out = preview(b);
    gtx_close(b->source);
    return out;
}

gtx_result gtx_read_prefix(gtx_error *error, const gtx_read_options *options, const void *data,
                           size_t size, const gtx_file_part *pieces, uint32_t piece_count,
                           gtx_prefix *prefix, gtx_asset **out)
{
    beginning b = {.check = {.error = error, .in_file = true, .beginning = true},
                   .options = options,
                   .has = {.data = data, .size = size, .pieces = pieces,
                           .piece_count = piece_count}};
    *prefix = (gtx_prefix){.needed = GTX_HEADER_SIZE};
    gtx_check quiet = {0};
    gtx_check_head(&quiet, data, size, 0);
    if (quiet.result == GTX_ERROR_TRUNCATED)
        return GTX_OK;
    const uint32_t count = quiet.result ? 0 : gtx_load_u32(b.has.data + 28);
    const bool counted = count >= 4 && count <= GTX_MAX_SECTIONS;
    const uint64_t table = GTX_HEADER_SIZE + (uint64_t)GTX_ENTRY_SIZE * count;
    prefix->needed = table;
    if (counted && size < table)
        return GTX_OK;
    gtx_check_file(&b.check, data, size, &b.layout);
    if (b.check.result)
        return b.check.result;
    prefix->file_size = b.layout.info.file_size;
    prefix->needed = 0;
    if (size == prefix->file_size) {
        gtx_check whole = {.error = error};
        return gtx_read_asset(&whole, options, data, size, out);
    }
    prefix->needed = gtx_arrival_needed(&b.layout, size);
    gtx_arrival_find(&b.has, &b.layout);
    if (b.has.lods)
        *out = read_parts(&b);
    return b.check.result;
}
