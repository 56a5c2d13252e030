/* Reading an index strictly, and writing one. */
#include "stream/index.h"

#include "base/bytes.h"
#include "base/error.h"
#include "base/hash.h"

#include <math.h>

static const uint8_t identifier[12] = {0xab, 'G', 'T', 'W', ' ', '0', '1', 0xbb,
                                       '\r', '\n', 0x1a, '\n'};
enum { MAJOR = 0, MINOR = 2 };
static const uint64_t MAX_BYTES = (uint64_t)1 << 40;

static uint64_t hash_of(const uint8_t *data, uint32_t count)
{
    gtx_hash hash;
    gtx_hash_begin(&hash);
    gtx_hash_add(&hash, data, GTX_INDEX_HEADER - 8);
    gtx_hash_add(&hash, data + GTX_INDEX_HEADER, (size_t)count * GTX_INDEX_RECORD);
    return gtx_hash_end(&hash);
}

gtx_result gtx_index_check(const uint8_t *data, size_t size, uint32_t *count, double *unit,
                           gtx_error *error)
{
    if (size < sizeof identifier || memcmp(data, identifier, sizeof identifier) != 0)
        return gtx_fail(error, GTX_ERROR_NOT_GTX, "the bytes are not the index of a world");
    if (size < GTX_INDEX_HEADER)
        return gtx_fail(error, GTX_ERROR_TRUNCATED, "the index ends within its header");
    if (gtx_load_u16(data + 12) != MAJOR || gtx_load_u16(data + 14) != MINOR)
        return gtx_fail(error, GTX_ERROR_VERSION, "the index is of version %u.%u, not %d.%d",
                        gtx_load_u16(data + 12), gtx_load_u16(data + 14), MAJOR, MINOR);
    *count = gtx_load_u32(data + 16);
    *unit = gtx_load_f64(data + 24);
    if (*count < 1 || *count > GTX_INDEX_MAX_TILES)
        return gtx_fail(error, GTX_ERROR_CORRUPT, "the index has %u tiles, not 1 to %u",
                        *count, GTX_INDEX_MAX_TILES);
    const uint64_t whole = GTX_INDEX_HEADER + (uint64_t)*count * GTX_INDEX_RECORD;
    if (size < whole)
        return gtx_fail(error, GTX_ERROR_TRUNCATED, "the index of %u tiles ends after %zu bytes",
                        *count, size);
    if (size > whole || gtx_load_u32(data + 20) != 0 || !(*unit > 0) || isinf(*unit))
        return gtx_fail(error, GTX_ERROR_CORRUPT, "the header of the index is invalid");
    if (gtx_load_u64(data + 32) != hash_of(data, *count))
        return gtx_fail(error, GTX_ERROR_CORRUPT, "the index does not match its hash");
    return GTX_OK;
}

/* 'r' and digits, terminated, zeros behind. */
static bool is_name(const char name[GTX_INDEX_NAME])
{
    if (name[0] != 'r' || name[GTX_INDEX_NAME - 1])
        return false;
    const size_t length = strlen(name);
    for (size_t i = 1; i < GTX_INDEX_NAME; ++i)
        if (i < length ? name[i] < '0' || name[i] > '7' : name[i] != 0)
            return false;
    return true;
}

static bool begins_like(const char *name, const char *start)
{
    return strncmp(name, start, strlen(start)) == 0;
}

static bool is_part(const gtx_index_part *part)
{
    return part->bytes <= MAX_BYTES && part->memory <= MAX_BYTES &&
           (part->bytes || (!part->hash && !part->memory));
}

/* Shorter than the whole, and no finer. */
static bool is_beginning(const gtx_index_tile *tile)
{
    if (!tile->beginning.bytes)
        return is_part(&tile->beginning) && tile->beginning_error == 0;
    return is_part(&tile->beginning) && tile->beginning.bytes < tile->whole.bytes &&
           tile->beginning_error >= tile->error && isfinite(tile->beginning_error);
}

/* Of a tile alone. */
static bool is_sound(const gtx_index_tile *tile)
{
    for (int k = 0; k < 3; ++k)
        if (!isfinite(tile->low[k]) || !isfinite(tile->high[k]) || tile->low[k] > tile->high[k])
            return false;
    return is_name(tile->name) && tile->error >= 0 && isfinite(tile->error) &&
           is_part(&tile->whole) && is_beginning(tile);
}

static bool is_within(const gtx_index_tile *tile, const gtx_index_tile *parent)
{
    for (int k = 0; k < 3; ++k)
        if (tile->low[k] < parent->low[k] || tile->high[k] > parent->high[k])
            return false;
    return tile->error <= parent->error && begins_like(tile->name, parent->name) &&
           strlen(tile->name) > strlen(parent->name);
}

/* Among those before it. */
static bool is_in_place(const gtx_index_tile *tile, uint32_t number)
{
    if (number == 0)
        return tile->parent == 0;
    const gtx_index_tile *before = tile - 1;
    if (tile->parent >= number || tile->parent < before->parent)
        return false;
    if (number > 1 && tile->parent == before->parent &&
        (strcmp(tile->name, before->name) <= 0 || begins_like(tile->name, before->name)))
        return false;
    return is_within(tile, tile - number + tile->parent);
}

static gtx_index_part load_part(const uint8_t *at)
{
    return (gtx_index_part){gtx_load_u64(at), gtx_load_u64(at + 8), gtx_load_u64(at + 16)};
}

static void store_part(uint8_t *at, const gtx_index_part *part)
{
    gtx_store_u64(at, part->bytes);
    gtx_store_u64(at + 8, part->hash);
    gtx_store_u64(at + 16, part->memory);
}

gtx_result gtx_index_read(const uint8_t *data, gtx_index_tile *tile, uint32_t number,
                          gtx_error *error)
{
    const uint8_t *at = data + GTX_INDEX_HEADER + (size_t)number * GTX_INDEX_RECORD;
    for (int k = 0; k < 3; ++k) {
        tile->low[k] = gtx_load_f64(at + 8 * k);
        tile->high[k] = gtx_load_f64(at + 24 + 8 * k);
    }
    tile->error = gtx_load_f32(at + 48);
    tile->parent = gtx_load_u32(at + 52);
    tile->whole = load_part(at + 56);
    tile->beginning = load_part(at + 80);
    tile->beginning_error = gtx_load_f32(at + 104);
    memcpy(tile->name, at + 112, GTX_INDEX_NAME);
    if (gtx_load_u32(at + 108) != 0 || !is_sound(tile) || !is_in_place(tile, number))
        return gtx_fail(error, GTX_ERROR_CORRUPT, "tile %u of the index is invalid", number);
    return GTX_OK;
}

void gtx_index_write(const gtx_index_tile *tiles, uint32_t count, double unit, uint8_t *out)
{
    memset(out, 0, GTX_INDEX_HEADER);
    memcpy(out, identifier, sizeof identifier);
    gtx_store_u16(out + 12, MAJOR);
    gtx_store_u16(out + 14, MINOR);
    gtx_store_u32(out + 16, count);
    gtx_store_f64(out + 24, unit);
    for (uint32_t i = 0; i < count; ++i) {
        uint8_t *at = out + GTX_INDEX_HEADER + (size_t)i * GTX_INDEX_RECORD;
        for (int k = 0; k < 3; ++k) {
            gtx_store_f64(at + 8 * k, tiles[i].low[k]);
            gtx_store_f64(at + 24 + 8 * k, tiles[i].high[k]);
        }
        gtx_store_f32(at + 48, tiles[i].error);
        gtx_store_u32(at + 52, tiles[i].parent);
        store_part(at + 56, &tiles[i].whole);
        store_part(at + 80, &tiles[i].beginning);
        gtx_store_f32(at + 104, tiles[i].beginning_error);
        gtx_store_u32(at + 108, 0);
        memcpy(at + 112, tiles[i].name, GTX_INDEX_NAME);
    }
    gtx_store_u64(out + 32, hash_of(out, count));
}
