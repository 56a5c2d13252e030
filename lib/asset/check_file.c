/* Header, section table and padding of a file (format/gtx.md, section 1). */
#include "asset/check.h"

#include "asset/codec.h"
#include "asset/header.h"
#include "asset/lod.h"
#include "base/bytes.h"

#include <inttypes.h>
#include <string.h>

/* A zstd block holds at most 128 KiB and takes at least 4 bytes: a file that claims more would
 * make its reader allocate for nothing. */
#define ZSTD_MAX_RATIO 32768u

/* Whether the bytes are a .gtx of this version at all. */
static bool check_start(gtx_check *check, const uint8_t *data, uint64_t size)
{
    size_t known = size < sizeof gtx_identifier ? (size_t)size : sizeof gtx_identifier;
    if (known && memcmp(data, gtx_identifier, known)) {
        gtx_break(check, GTX_RULE_IDENTIFIER, 0, "it does not");
        return false;
    }
    if (size < GTX_HEADER_SIZE) {
        gtx_break(check, GTX_RULE_TRUNCATED, 0, "it has %" PRIu64 " bytes", size);
        return false;
    }
    uint32_t major = gtx_load_u16(data + 12), minor = gtx_load_u16(data + 14);
    if (major != GTX_FORMAT_MAJOR || minor != GTX_FORMAT_MINOR) {
        gtx_break(check, GTX_RULE_VERSION, 12, "it is %u.%u", major, minor);
        return false;
    }
    return true;
}

/* False when the table cannot be read. */
static bool check_shape(gtx_check *check, const gtx_header *header, uint64_t size)
{
    if (header->header_size != GTX_HEADER_SIZE)
        gtx_break(check, GTX_RULE_HEADER_SIZE, 16, "it is %u", header->header_size);
    if (header->must_flags)
        gtx_break(check, GTX_RULE_MUST_FLAGS, 20, "it is 0x%08x", header->must_flags);
    uint32_t count = header->section_count;
    bool readable = count >= 4 && count <= GTX_MAX_SECTIONS;
    if (!readable)
        gtx_break(check, GTX_RULE_SECTION_COUNT, 28, "it is %u", count);
    uint64_t least = GTX_HEADER_SIZE + (readable ? (uint64_t)count * GTX_ENTRY_SIZE : 0);
    if (header->file_size > least && !check->beginning)
        least = header->file_size;
    if (size < least) {
        gtx_break(check, GTX_RULE_TRUNCATED, 32, "it has %" PRIu64 " bytes of %" PRIu64, size,
                  least);
        readable = false;
    } else if (header->file_size < size || (header->file_size > size && !check->beginning)) {
        gtx_break(check, GTX_RULE_FILE_SIZE, 32, "it is %" PRIu64 " of %" PRIu64 " bytes",
                  header->file_size, size);
    }
    if (header->section_table != GTX_HEADER_SIZE)
        gtx_break(check, GTX_RULE_TABLE_OFFSET, 40, "it is %" PRIu64, header->section_table);
    if (header->section_stride != GTX_ENTRY_SIZE)
        gtx_break(check, GTX_RULE_TABLE_STRIDE, 48, "it is %u", header->section_stride);
    return readable;
}

static void check_reserved(gtx_check *check, const uint8_t *data)
{
    static const uint32_t ranges[][2] = {{100, 104}, {148, 184}};
    for (uint32_t r = 0; r < 2; ++r) {
        for (uint32_t i = ranges[r][0]; i < ranges[r][1]; ++i) {
            if (data[i]) {
                gtx_break(check, GTX_RULE_HEADER_RESERVED, i, "byte %u is 0x%02x", i, data[i]);
                break;
            }
        }
    }
}

/* A walk over the table. */
typedef struct table_walk {
    gtx_check *check;
    gtx_layout *layout;
    uint64_t size, there;         /* of the file, and of it */
    uint64_t end;                 /* where the next section must start */
    bool chained;                 /* false once an end is unknown */
    uint32_t last_rank;
    uint32_t seen[GTX_SECTION_META + 1];
} table_walk;

/* The place of a section in the file's order: levels go from the smallest image to the largest, and
 * the coarsest LOD mesh is before the patches. */
static uint32_t rank_of(const gtx_section *section, uint32_t index)
{
    const bool coarsest = section->kind == GTX_SECTION_LOD && index == 0;
    return coarsest ? 1 : (uint32_t)section->kind << 8 | (0xFF - section->level);
}

static void check_order(table_walk *walk, uint32_t index, uint64_t at)
{
    const gtx_section *sections = walk->layout->sections, *section = &sections[index];
    uint32_t rank = rank_of(section, index);
    bool unknown = section->kind == GTX_SECTION_UNKNOWN;
    bool wrong = rank < walk->last_rank || (rank == walk->last_rank && !unknown);
    if (section->kind == GTX_SECTION_LOD && index > 0)
        wrong = wrong || sections->kind != section->kind || sections->level <= section->level;
    for (uint32_t i = 0; unknown && i < index; ++i)
        wrong = wrong || !memcmp(sections[i].type, section->type, 4);
    if (wrong)
        gtx_break(walk->check, GTX_RULE_SECTION_ORDER, at, "entry %u, %s, is out of order", index,
                  section->name);
    else
        walk->last_rank = rank;
}

static void check_format(table_walk *walk, gtx_section *section, uint64_t at)
{
    gtx_info *info = &walk->layout->info;
    if (section->kind == GTX_SECTION_HEIGHT) { /* here the file says how many bits it has */
        info->height_bits = 16;
        if (gtx_section_describe(info, section->kind, 0).format != section->format)
            info->height_bits = 8;
    }
    gtx_section right = gtx_section_describe(info, section->kind, section->level);
    if (section->format != right.format)
        gtx_break(walk->check, GTX_RULE_SECTION_FORMAT, at + 12, "that of %s is %u",
                  section->name, section->format);
    if (section->kind == GTX_SECTION_META && (section->size < 1 || section->size > GTX_META_LIMIT))
        gtx_break(walk->check, GTX_RULE_META, at + 32, "it has %" PRIu64 " bytes", section->size);
    bool free_size = section->kind == GTX_SECTION_LOD || section->kind >= GTX_SECTION_UNKNOWN;
    if (section->kind == GTX_SECTION_LOD &&
        section->size < gtx_lod_size(info->patch_count, 3, 1))
        gtx_break(walk->check, GTX_RULE_LOD_SIZE, at + 32, "level %u has %" PRIu64 " bytes",
                  section->level, section->size);
    if (!free_size && section->size != right.size)
        gtx_break(walk->check, GTX_RULE_SECTION_SIZE, at + 32, "that of %s is %" PRIu64
                  " in place of %" PRIu64, section->name, section->size, right.size);
}

static void check_coding(table_walk *walk, const gtx_section *section, uint64_t at)
{
    gtx_check *check = walk->check;
    bool stored = section->scheme == GTX_SCHEME_STORED, zstd = section->scheme == GTX_SCHEME_ZSTD;
    if ((!stored && !zstd) || (stored && section->stored_size != section->size))
        gtx_break(check, GTX_RULE_SECTION_SCHEME, at + 40, "%s has scheme %u, %" PRIu64
                  " of %" PRIu64 " bytes", section->name, section->scheme, section->stored_size,
                  section->size);
    if (!gtx_filter_fits(section->kind, section->filter) || (section->filter && !zstd))
        gtx_break(check, GTX_RULE_SECTION_FILTER, at + 44, "that of %s is %u",
                  section->name, section->filter);
    if (zstd && section->kind != GTX_SECTION_UNKNOWN &&
        section->size / ZSTD_MAX_RATIO > section->stored_size)
        gtx_break(check, GTX_RULE_SECTION_ZSTD, at + 24, "%s cannot hold %" PRIu64 " bytes in %"
                  PRIu64, section->name, section->size, section->stored_size);
}

static void check_place(table_walk *walk, const gtx_section *section, uint64_t at)
{
    if (section->offset > walk->size || section->stored_size > walk->size - section->offset) {
        gtx_break(walk->check, GTX_RULE_SECTION_RANGE, at + 16, "%s has %" PRIu64
                  " bytes at %" PRIu64 " of %" PRIu64, section->name, section->stored_size,
                  section->offset, walk->size);
        walk->chained = false;
    }
    if (!walk->chained)
        return;
    if (section->offset != walk->end)
        gtx_break(walk->check, GTX_RULE_SECTION_OFFSET, at + 16, "%s is at %" PRIu64
                  " in place of %" PRIu64, section->name, section->offset, walk->end);
    walk->end = gtx_align64(walk->end + section->stored_size);
}

/* False when the section cannot be read. */
static bool check_entry(table_walk *walk, const uint8_t *bytes, uint32_t index)
{
    gtx_check *check = walk->check;
    uint64_t at = GTX_HEADER_SIZE + (uint64_t)GTX_ENTRY_SIZE * index, before = check->broken;
    gtx_section *section = &walk->layout->sections[index];
    *section = gtx_entry_load(bytes + at);
    bool unknown = section->kind == GTX_SECTION_UNKNOWN;

    if (unknown && section->flags & 1)
        gtx_break(check, GTX_RULE_SECTION_UNKNOWN, at, "%s is not", section->name);
    if (section->level >= gtx_section_levels(section->kind, walk->layout->info.mip_count)) {
        gtx_break(check, GTX_RULE_SECTION_LEVEL, at + 8, "that of %s is %u", section->name,
                  section->level);
    } else {
        check_order(walk, index, at);
        check_format(walk, section, at);
    }
    check_place(walk, section, at);
    check_coding(walk, section, at);
    ++walk->seen[section->kind];
    bool readable = check->broken == before;

    uint32_t flags = unknown ? section->flags & 1
                             : gtx_section_describe(&walk->layout->info, section->kind, 0).flags;
    if (section->flags != flags)
        gtx_break(check, GTX_RULE_SECTION_FLAGS, at + 4, "those of %s are 0x%08x", section->name,
                  section->flags);
    uint64_t reserved = gtx_load_u64(bytes + at + 56);
    if (reserved)
        gtx_break(check, GTX_RULE_SECTION_RESERVED, at + 56, "%s has 0x%016" PRIx64, section->name,
                  reserved);
    return readable;
}

/* False when one is missing. */
static bool check_presence(const table_walk *walk)
{
    const gtx_info *info = &walk->layout->info;
    for (gtx_section_kind kind = GTX_SECTION_PATCHES; kind <= GTX_SECTION_LAST_IMAGE; ++kind) {
        uint32_t needed = kind == GTX_SECTION_PATCHES ? 1 : gtx_map_levels(info, kind);
        if (walk->seen[kind] >= needed)
            continue;
        gtx_break(walk->check, GTX_RULE_SECTION_MISSING, GTX_HEADER_SIZE, "%u of %u %.4s are there",
                  walk->seen[kind], needed, gtx_section_describe(info, kind, 0).type);
        return false;
    }
    for (uint32_t i = 0; i < walk->layout->section_count; ++i) {
        const gtx_section *section = &walk->layout->sections[i];
        if (section->kind == GTX_SECTION_LOD && section->level >= info->lod_levels) {
            gtx_break(walk->check, GTX_RULE_SECTION_MISSING, GTX_HEADER_SIZE,
                      "LODM has level %u, but only %u in all", section->level, info->lod_levels);
            return false;
        }
    }
    return true;
}

static void check_padding(const table_walk *walk, const uint8_t *data)
{
    for (uint32_t s = 0; s < walk->layout->section_count; ++s) {
        const gtx_section *section = &walk->layout->sections[s];
        uint64_t end = section->offset + section->stored_size, next = gtx_align64(end);
        for (uint64_t i = end; i < next && i < walk->there; ++i) {
            if (data[i]) {
                gtx_break(walk->check, GTX_RULE_PADDING, i, "byte %" PRIu64 " is 0x%02x", i,
                          data[i]);
                break;
            }
        }
    }
}

static void check_table(gtx_check *check, const uint8_t *data, uint64_t size, uint64_t there,
                        gtx_layout *layout)
{
    table_walk walk = {.check = check, .layout = layout, .size = size, .there = there,
                       .chained = true};
    walk.end = GTX_HEADER_SIZE + (uint64_t)GTX_ENTRY_SIZE * layout->section_count;
    bool readable = true;
    for (uint32_t i = 0; i < layout->section_count; ++i)
        readable = check_entry(&walk, data, i) && readable;
    layout->info.has_color = walk.seen[GTX_SECTION_COLOR] > 0;
    layout->info.has_material = walk.seen[GTX_SECTION_MATERIAL] > 0;
    layout->info.has_emission = walk.seen[GTX_SECTION_EMISSION] > 0;
    layout->info.lod_levels = walk.seen[GTX_SECTION_LOD];
    if (readable)
        readable = check_presence(&walk);
    gtx_check_emission(check, &layout->info);
    if (walk.chained && walk.end != size)
        gtx_break(check, GTX_RULE_FILE_END, walk.end < size ? walk.end : size,
                  "it has %" PRIu64 " bytes in place of %" PRIu64, size, walk.end);
    layout->known = readable;
    if (readable)
        check_padding(&walk, data);
}

void gtx_check_head(gtx_check *check, const uint8_t *data, size_t size, uint64_t file_size)
{
    gtx_header header;
    gtx_info info;
    if (!check_start(check, data, size) || !file_size)
        return;
    gtx_header_load(data, &header, &info);
    check_shape(check, &header, file_size);
}

void gtx_check_file(gtx_check *check, const uint8_t *data, uint64_t size, gtx_layout *out)
{
    *out = (gtx_layout){0};
    if (!check_start(check, data, size))
        return;
    gtx_header header;
    gtx_header_load(data, &header, &out->info);
    bool readable = check_shape(check, &header, size);
    bool sized = gtx_check_info(check, &out->info);
    check_reserved(check, data);
    if (!readable || gtx_check_over(check))
        return;
    if (header.header_hash != gtx_header_hash(data, header.section_count))
        gtx_break(check, GTX_RULE_HEADER_HASH, 184, "it is 0x%016" PRIx64, header.header_hash);
    if (!sized || gtx_check_over(check))
        return;

    out->section_count = header.section_count;
    check_table(check, data, header.file_size, size, out);
    if (out->known && out->info.content_hash != gtx_content_hash(out->sections, out->section_count))
        gtx_break(check, GTX_RULE_CONTENT_HASH, 128, "it is 0x%016" PRIx64, out->info.content_hash);
}
