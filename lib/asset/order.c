/* Sections as runs of numbers of a width each (format/gtx.md, sections 3 and 6), so that their
 * bytes can be turned around. */
#include "asset/order.h"

#include "asset/lod.h"

#if GTX_BIG_ENDIAN

/* Numbers of so many bytes each. */
typedef struct run {
    uint32_t width;
    uint64_t count;
} run;

enum { RUNS = 3, CHUNK = 1024 };

/* Of a patch record, and of 16-bit height codes; a section has them again and again. */
static const run record[RUNS] = {{4, 17}, {2, 6}, {4, 12}};
static const run codes[RUNS] = {{2, CHUNK}, {2, CHUNK}, {2, CHUNK}};

/* Of an LOD mesh: its header, which is loaded byte by byte; first triangles and indices; positions.
 * Normals, behind them, are bytes. */
static void find_level(const gtx_info *info, const gtx_section *section, const uint8_t *bytes,
                       run out[RUNS])
{
    const bool whole = section->size >= GTX_LOD_HEADER;
    const uint64_t vertices = whole ? gtx_load_u32(bytes + 20) : 0;
    const uint64_t triangles = whole ? gtx_load_u32(bytes + 24) : 0;
    out[0] = (run){1, GTX_LOD_HEADER};
    out[1] = (run){4, (uint64_t)info->patch_count + 1 + 3 * triangles};
    out[2] = (run){2, 3 * vertices};
}

/* What becomes of some bytes: they go into a hash, or to `out`, which may be where they are. */
typedef struct turning {
    gtx_hash *hash;               /* or NULL */
    uint8_t *out;
} turning;

static void turn(turning *t, const uint8_t *bytes, size_t size, uint32_t width)
{
    uint8_t chunk[CHUNK];         /* a multiple of all widths */
    while (size) {
        const size_t part = size < CHUNK ? size : CHUNK;
        for (size_t i = 0; i < part; ++i)
            chunk[i] = bytes[i ^ (width - 1)];
        if (t->hash)
            gtx_hash_add(t->hash, chunk, part);
        else
            t->out = (uint8_t *)memcpy(t->out, chunk, part) + part;
        bytes += part;
        size -= part;
    }
}

/* All of a section. Counts of hostile bytes may be more than it has: their check is to come. */
static void walk(const gtx_asset *asset, const gtx_section *section, const uint8_t *bytes,
                 turning *t)
{
    run level[RUNS];
    const bool once = section->kind == GTX_SECTION_LOD;
    const run *runs = once ? level : section->kind == GTX_SECTION_PATCHES ? record : codes;
    if (once)
        find_level(&asset->info, section, bytes, level);
    size_t left = (size_t)section->size;
    for (size_t i = 0; left && !(once && i == RUNS); ++i) {
        const run *r = &runs[i % RUNS];
        const uint64_t wanted = r->width * r->count;
        const size_t size = wanted < left ? (size_t)wanted : left / r->width * r->width;
        turn(t, bytes, size, r->width);
        bytes += size;
        left -= size;
        if (size < wanted)
            break;
    }
    turn(t, bytes, left, 1);
}

static bool is_turned(const gtx_asset *asset, const gtx_section *section)
{
    return section->kind == GTX_SECTION_PATCHES || section->kind == GTX_SECTION_LOD ||
           (section->kind == GTX_SECTION_HEIGHT && asset->info.height_bits == 16);
}

void gtx_turn_section(const gtx_asset *asset, const gtx_section *section, uint8_t *bytes)
{
    if (is_turned(asset, section))
        walk(asset, section, bytes, &(turning){NULL, bytes});
}

const uint8_t *gtx_bytes_in_file(const gtx_asset *asset, const gtx_section *section,
                                 const uint8_t *data, uint8_t *room)
{
    if (!is_turned(asset, section))
        return data;
    walk(asset, section, data, &(turning){NULL, room});
    return room;
}

uint64_t gtx_hash_section(const gtx_asset *asset, const gtx_section *section, const void *data)
{
    gtx_hash hash;
    gtx_hash_begin(&hash);
    if (is_turned(asset, section))
        walk(asset, section, data, &(turning){&hash, NULL});
    else if (section->size)
        gtx_hash_add(&hash, data, (size_t)section->size);
    return gtx_hash_end(&hash);
}

#endif
