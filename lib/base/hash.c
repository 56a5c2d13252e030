/* XXH64 after the xxHash specification 0.1.1 (Y. Collet), seed 0. */
#include "base/hash.h"

#include "base/bytes.h"

#define PRIME_1 0x9E3779B185EBCA87u
#define PRIME_2 0xC2B2AE3D27D4EB4Fu
#define PRIME_3 0x165667B19E3779F9u
#define PRIME_4 0x85EBCA77C2B2AE63u
#define PRIME_5 0x27D4EB2F165667C5u

static uint64_t rotate(uint64_t v, int bits)
{
    return v << bits | v >> (64 - bits);
}

static uint64_t mix_lane(uint64_t lane, uint64_t input)
{
    return rotate(lane + input * PRIME_2, 31) * PRIME_1;
}

static void add_stripe(gtx_hash *hash, const uint8_t *stripe)
{
    for (int i = 0; i < 4; ++i)
        hash->lane[i] = mix_lane(hash->lane[i], gtx_load_u64(stripe + 8 * i));
}

void gtx_hash_begin(gtx_hash *hash)
{
    *hash = (gtx_hash){.lane = {PRIME_1 + PRIME_2, PRIME_2, 0, 0 - PRIME_1}};
}

void gtx_hash_add(gtx_hash *hash, const void *data, size_t size)
{
    const uint8_t *p = data;
    hash->total += size;
    if (hash->pending_size) {
        size_t take = 32 - hash->pending_size < size ? 32 - hash->pending_size : size;
        memcpy(hash->pending + hash->pending_size, p, take);
        hash->pending_size += take;
        p += take;
        size -= take;
        if (hash->pending_size < 32)
            return;
        add_stripe(hash, hash->pending);
        hash->pending_size = 0;
    }
    for (; size >= 32; p += 32, size -= 32)
        add_stripe(hash, p);
    if (size)
        memcpy(hash->pending, p, size);
    hash->pending_size = size;
}

uint64_t gtx_hash_end(const gtx_hash *hash)
{
    const uint64_t *lane = hash->lane;
    uint64_t h = PRIME_5;
    if (hash->total >= 32) {
        h = rotate(lane[0], 1) + rotate(lane[1], 7) + rotate(lane[2], 12) + rotate(lane[3], 18);
        for (int i = 0; i < 4; ++i)
            h = (h ^ mix_lane(0, lane[i])) * PRIME_1 + PRIME_4;
    }
    h += hash->total;

    const uint8_t *p = hash->pending;
    size_t left = hash->pending_size;
    for (; left >= 8; p += 8, left -= 8)
        h = rotate(h ^ mix_lane(0, gtx_load_u64(p)), 27) * PRIME_1 + PRIME_4;
    if (left >= 4) {
        h = rotate(h ^ gtx_load_u32(p) * PRIME_1, 23) * PRIME_2 + PRIME_3;
        p += 4;
        left -= 4;
    }
    for (; left; ++p, --left)
        h = rotate(h ^ *p * PRIME_5, 11) * PRIME_1;

    h = (h ^ h >> 33) * PRIME_2;
    h = (h ^ h >> 29) * PRIME_3;
    return h ^ h >> 32;
}

uint64_t gtx_hash_bytes(const void *data, size_t size)
{
    gtx_hash hash;
    gtx_hash_begin(&hash);
    if (size)
        gtx_hash_add(&hash, data, size);
    return gtx_hash_end(&hash);
}
