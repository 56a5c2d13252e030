/* Byte order: files are little-endian; of an asset in memory, patches, heights of 16 bits and the
 * arrays of LOD meshes are in the processor's order. Where that is little-endian, nothing is left
 * of this. */
#ifndef GTX_ASSET_ORDER_H
#define GTX_ASSET_ORDER_H

#include "asset/section.h"
#include "base/bytes.h"
#include "base/hash.h"

#if GTX_BIG_ENDIAN

/* Turns a section of the asset, in place, from one order into the other. */
void gtx_turn_section(const gtx_asset *asset, const gtx_section *section, uint8_t *bytes);

/* The bytes that the file has of a section whose bytes in memory are `data`: these, or in `room`,
 * which is as large. */
const uint8_t *gtx_bytes_in_file(const gtx_asset *asset, const gtx_section *section,
                                 const uint8_t *data, uint8_t *room);

/* The hash of these. */
uint64_t gtx_hash_section(const gtx_asset *asset, const gtx_section *section, const void *data);

#else

static inline void gtx_turn_section(const gtx_asset *asset, const gtx_section *section,
                                    uint8_t *bytes)
{
    (void)asset, (void)section, (void)bytes;
}

static inline const uint8_t *gtx_bytes_in_file(const gtx_asset *asset, const gtx_section *section,
                                               const uint8_t *data, uint8_t *room)
{
    (void)asset, (void)section, (void)room;
    return data;
}

static inline uint64_t gtx_hash_section(const gtx_asset *asset, const gtx_section *section,
                                        const void *data)
{
    (void)asset;
    return gtx_hash_bytes(data, (size_t)section->size);
}

#endif
#endif
