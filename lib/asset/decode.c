/* Stages of decoding: first sections that depend on no other, then texels with a height of maps
 * that are coded against heights, then the rest of these, patch by patch. */
#include "asset/decode.h"

#include "asset/check.h"
#include "asset/order.h"
#include "base/alloc.h"
#include "base/jobs.h"

#include <string.h>

/* Patches of a job. */
enum { PATCHES = 16 };

/* Bytes for a part while it is decoded: none where its place in the asset will do. */
static uint64_t room_of(const gtx_section *section, const gtx_info *info)
{
    const bool in_place = section->filter == GTX_FILTER_HEIGHTS && info->height_bits == 8;
    return in_place ? 0 : gtx_align64(gtx_coded_size(section));
}

/* The places of everything in the block, which may be NULL. Returns its size. Where one part comes
 * after another, they share what they need for a moment. */
static uint64_t place(gtx_decoding *d, const gtx_info *info, uint8_t *block)
{
    const bool apart = d->jobs && d->jobs->run;
    const uint64_t decoder = gtx_align64(gtx_decoder_size());
    uint64_t at = 0, shared = 0, texels = 0;
    for (uint32_t i = 0; i < d->part_count; ++i) {
        gtx_part *part = &d->parts[i];
        if (part->section->scheme != GTX_SCHEME_ZSTD)
            continue;
        part->decoder = block ? block + (apart ? at : 0) : NULL;
        at = apart || !at ? at + decoder : at;
    }
    const uint64_t first = at;
    for (uint32_t i = 0; i < d->part_count && !apart; ++i) {
        const gtx_section *section = d->parts[i].section;
        const uint64_t size = room_of(section, info);
        if (section->filter != GTX_FILTER_SURFACE && size > shared)
            shared = size;
    }
    at += shared;
    for (uint32_t i = 0; i < d->part_count; ++i) {
        gtx_part *part = &d->parts[i];
        const uint64_t size = room_of(part->section, info);
        const bool own = apart || part->section->filter == GTX_FILTER_SURFACE;
        part->coded = size && block ? block + (own ? at : first) : NULL;
        at += own ? size : 0;
        if (part->section->filter == GTX_FILTER_SURFACE)
            texels = (uint64_t)info->page_count * info->page_width * info->page_height;
    }
    d->marks = block && texels ? block + at : NULL;
    for (uint32_t k = 0; k < info->mip_count; ++k)
        at += texels >> 2 * k;
    d->holds = block ? block + at : NULL;
    return at + info->patch_count;
}

void gtx_decoding_plan(gtx_decoding *out, const gtx_section *sections, uint32_t count,
                       const gtx_info *info, const gtx_jobs *jobs)
{
    *out = (gtx_decoding){.jobs = jobs};
    for (uint32_t i = 0; i < count; ++i) {
        if (sections[i].kind == GTX_SECTION_UNKNOWN)
            continue;
        out->parts[out->part_count++] = (gtx_part){.index = i, .section = &sections[i]};
        out->zstd = out->zstd || sections[i].scheme == GTX_SCHEME_ZSTD;
    }
    if (out->part_count > 1 && out->parts[1].section->kind == GTX_SECTION_PATCHES) {
        const gtx_part coarsest = out->parts[0];
        out->parts[0] = out->parts[1];
        out->parts[1] = coarsest;
    }
    out->size = place(out, info, NULL);
}

/* The marks of a level. */
static uint8_t *marks_of(const gtx_decoding *d, uint32_t level)
{
    uint8_t *marks = d->marks;
    for (uint32_t k = 0; k < level; ++k)
        marks += gtx_page_texels(d->asset, k) * d->asset->info.page_count;
    return marks;
}

bool gtx_decoding_begin(gtx_decoding *d, gtx_asset *asset, const uint8_t *data)
{
    d->block = gtx_alloc_raw(&asset->allocator, (size_t)d->size, 1);
    if (!d->block)
        return false;
    d->asset = asset;
    place(d, &asset->info, d->block);
    for (uint32_t i = 0; i < d->part_count; ++i) {
        gtx_part *part = &d->parts[i];
        const gtx_section *section = part->section;
        part->bytes = data + section->offset;
        part->out = gtx_asset_data(asset, section->kind, section->level);
        if (section->filter != GTX_FILTER_SURFACE)
            continue;
        part->layer = gtx_layer_of(asset, section, marks_of(d, section->level),
                                   section->level ? marks_of(d, section->level - 1) : NULL);
    }
    return true;
}

void gtx_decoding_end(gtx_decoding *d, const gtx_allocator *allocator)
{
    gtx_free_array(allocator, d->block, (size_t)d->size, 1);
    d->block = NULL;
}

/* Marks of all levels: where there are heights. */
static void mark_levels(const gtx_decoding *d)
{
    for (uint32_t k = 0; k < d->asset->info.mip_count; ++k)
        gtx_mark_level(d->asset, k, k ? marks_of(d, k - 1) : NULL, marks_of(d, k));
}

static void hash_part(const gtx_decoding *d, gtx_part *part)
{
    if (d->hashed && !part->wrong)
        part->hash = gtx_hash_bytes(part->out, (size_t)part->section->size);
}

/* All that a part can do without others: filter 4 is left. */
static void decode_alone(const gtx_decoding *d, gtx_part *part)
{
    const gtx_section *section = part->section;
    const size_t size = (size_t)section->size;
    uint8_t *coded = part->coded ? part->coded : part->out;
    if (part->decoder)
        part->wrong = gtx_decompress(part->decoder, section, part->bytes, coded);
    else
        memcpy(part->out, part->bytes, size);
    if (section->filter == GTX_FILTER_SURFACE && !part->wrong)
        return;
    if (!part->wrong)
        part->wrong = gtx_undo_filter(d->asset, section, coded, part->out);
    if (part->wrong)
        memset(part->out, 0, size);
    hash_part(d, part);
    gtx_turn_section(d->asset, section, part->out);
    if (section->kind == GTX_SECTION_HEIGHT && d->marks)
        mark_levels(d);
}

void gtx_decode_patches(gtx_decoding *d)
{
    decode_alone(d, &d->parts[0]);
}

/* ---- the stages, as jobs ---- */

/* About how long a part takes alone: heights are predicted and marked. */
static uint64_t work_of(const gtx_part *part)
{
    return part->section->size * (part->section->kind == GTX_SECTION_HEIGHT ? 4 : 1);
}

/* All parts but the patches, which are there. */
typedef struct apart {
    gtx_decoding *d;
    uint32_t order[GTX_MAX_KNOWN_SECTIONS]; /* of those behind the patches */
} apart;

static void alone(uint32_t index, void *data)
{
    const apart *a = data;
    decode_alone(a->d, &a->d->parts[1 + a->order[index]]);
}

static void decode_all_alone(gtx_decoding *d)
{
    apart a = {.d = d};
    uint64_t work[GTX_MAX_KNOWN_SECTIONS];
    for (uint32_t i = 1; i < d->part_count; ++i)
        work[i - 1] = work_of(&d->parts[i]);
    gtx_longest_first(work, d->part_count - 1, a.order);
    gtx_run_jobs(d->jobs, d->part_count - 1, alone, &a);
}

/* Levels of normals one after the other, from the finest on. */
static void undo_normals(gtx_decoding *d)
{
    const uint32_t mips = d->asset->info.mip_count;
    for (uint32_t k = 0; k < mips; ++k) {
        for (uint32_t i = 0; i < d->part_count; ++i) {
            gtx_part *part = &d->parts[i];
            const gtx_section *section = part->section;
            if (section->kind == GTX_SECTION_NORMAL && section->level == k &&
                section->filter == GTX_FILTER_SURFACE && !part->wrong)
                gtx_surface_undo_occupied(&part->layer, part->coded, part->out);
        }
    }
}

/* Normals in the place of the patches, which are there; trim; LOD meshes. */
typedef struct together {
    gtx_decoding *d;
    bool surfaces, lods;
} together;

static void occupied(uint32_t index, void *data)
{
    const together *t = data;
    gtx_part *part = &t->d->parts[index];
    const gtx_section *section = part->section;
    if (t->surfaces && t->d->marks && index == 0) {
        undo_normals(t->d);
    } else if (t->surfaces && section->kind == GTX_SECTION_TRIM &&
               section->filter == GTX_FILTER_SURFACE && !part->wrong) {
        gtx_surface_undo_occupied(&part->layer, part->coded, part->out);
    } else if (t->lods && section->kind == GTX_SECTION_LOD && !part->wrong) {
        gtx_check quiet = {0};
        gtx_check_lod(&quiet, t->d->asset, section->level, 0);
        part->holds = !quiet.broken;
    }
}

/* Trim, which is before normals in the file, finds the marks that these make into rings. */
static void patches(uint32_t index, void *data)
{
    gtx_decoding *d = data;
    const uint32_t count = d->asset->info.patch_count, first = index * PATCHES;
    for (uint32_t p = first; p < count && p < first + PATCHES; ++p) {
        for (uint32_t i = 0; i < d->part_count; ++i)
            if (d->parts[i].section->filter == GTX_FILTER_SURFACE && !d->parts[i].wrong)
                gtx_surface_undo_patch(&d->parts[i].layer, p, d->parts[i].out);
        d->holds[p] = gtx_patch_holds(d->asset, p);
    }
}

static void rest(uint32_t index, void *data)
{
    const gtx_decoding *d = data;
    gtx_part *part = (gtx_part *)&d->parts[index];
    if (part->section->filter != GTX_FILTER_SURFACE || part->wrong)
        return;
    gtx_surface_undo_rest(&part->layer, part->coded, part->out);
    hash_part(d, part);
}

static bool heights_known(const gtx_decoding *d)
{
    for (uint32_t i = 0; i < d->part_count; ++i)
        if (d->parts[i].section->kind == GTX_SECTION_HEIGHT)
            return !d->parts[i].wrong;
    return false;
}

bool gtx_part_known(const gtx_decoding *d, const gtx_part *part, bool rectangles_hold)
{
    return part->section->filter != GTX_FILTER_SURFACE || (rectangles_hold && heights_known(d));
}

void gtx_decode_rest(gtx_decoding *d, bool rectangles_hold, bool patches_hold)
{
    decode_all_alone(d);
    const bool surfaces = rectangles_hold && heights_known(d);
    gtx_run_jobs(d->jobs, d->part_count, occupied, &(together){d, surfaces, patches_hold});
    if (!surfaces)
        return;
    gtx_run_jobs(d->jobs, (d->asset->info.patch_count + PATCHES - 1) / PATCHES, patches, d);
    gtx_run_jobs(d->jobs, d->part_count, rest, d);
}
